//! What a document can say: one file for each construct, read, checked and resolved.

mod arc;
mod assertion;
mod attribute;
mod baked;
mod bezier_triangle;
mod bspline;
mod check;
mod clip;
mod collider;
mod combine;
mod conic;
mod construct;
mod coons;
mod cubic;
mod curve;
mod deform;
mod displace;
mod document;
mod dxf;
mod field;
mod formula;
mod grid;
mod height;
mod height_base;
mod implicit;
mod import;
mod joined;
mod kind;
mod knots;
mod limit;
mod lod;
mod loft;
mod map;
mod material;
mod mesh;
mod morph;
mod name;
mod node;
mod nurbs_surface;
mod operation;
mod optics;
mod output;
mod page;
mod parametric;
mod part;
mod patch;
mod path;
mod perturbed;
mod point;
mod polygon;
mod primitive;
mod profile;
mod project;
mod quadric;
mod reach;
mod reader;
mod reference;
mod resolve;
mod ruled;
mod scalar;
mod scaling;
mod schema;
mod section;
mod shape;
mod skeleton;
mod skin;
mod solid;
mod solid_expression;
mod spanned;
mod spline;
mod spline_end;
mod subdivide;
mod subdivision_curve;
mod svg;
mod sweep;
mod tangent;
mod trimmed;
mod vertex_color;
mod view;
mod whole;
mod wire;

pub use crate::language::suggest::closest;
pub use arc::{Arc, CenterArc};
pub use assertion::{Assertion, Demand, Expected};
pub use attribute::{Attribute, AttributeForm, Attributes, Components};
pub use baked::{Lightmap, Occlusion};
pub use bezier_triangle::BezierTriangles;
pub use bspline::{BSpline, Nurbs};
pub use clip::{
    AngleOrder, Between as KeyBetween, Clip, ClipEvent, ClipTrack, Direction, Formulas, KeyValue, LimitRule,
    MotionImport, MotionKey, MotionPath, RotationWay,
};
pub use collider::{Collider, ColliderFit, ColliderForm};
pub use combine::{Array, Copy, Group, Mirror, Plane};
pub use conic::{Conic, ConicForm, Hyperbola, Parabola};
pub use coons::{Coons, CoonsBlend, CoonsSide, CoonsSideFields, CoonsTwist, Cross, Gordon, GordonBlend};
pub use cubic::{Basis, BetaSpline, Border, Cubic};
pub use curve::{Circle, Curve, Ellipse, Helix, Line, Polyline, Reverse, Transform};
pub use deform::{Along, Bend, CoordinateAxis, Taper, Twist};
pub use displace::{Displace, DisplaceProjection};
pub use document::{Asset, Definition, Spec, Unit};
pub use dxf::Dxf;
pub use field::{
    BumpField, FallOff, Field, FieldDefinition, FieldFormula, FieldJoin, FieldOptions, FieldQuadric,
    FieldSum, HalfSpaceField, ImplicitShape, JoinMethod, PerturbedField, ShapeField, SkeletonElement,
    SkeletonField,
};
pub use formula::{Formula, FormulaCurve, FormulaForm};
pub use grid::{Degrees, Directions, Rows};
pub use height::{HeightBound, HeightClose, HeightMap, Level, Mask, Split, SplitOperation, SplitPart};
pub use height_base::{CylinderBase, EllipsoidBase, HeightBase, Projection, ShapeBase, SphereBase};
pub use implicit::Implicit;
pub use import::{FilePath, Frames, Import, Sequences, Up};
pub use joined::Joined;
pub use knots::KnotRule;
pub use limit::Limits;
#[cfg(feature = "cli")]
pub(crate) use limit::parse_bytes;
pub use lod::{Lod, LodForm};
pub use loft::{Across, Loft, LoftEnd, Matching, PlacedProfile, Profile};
pub use map::{
    Between, Map, MapCombine, MapDefinition, MapFormula, MapGrid, MapImage, MapNoise, MapOperation,
    MapOptions, MapPoints, MapRaw, NoData, RawNumber, Scatter,
};
pub use material::{Alpha, Color, Filter, Material, Texture, Wrap};
pub use mesh::Mesh;
pub use morph::{DriverAxis, Morph, MorphDriver, MorphName, Morphs, ParameterValue};
pub use node::{Node, SceneImport};
pub use nurbs_surface::{BSplineSurface, NurbsSurface};
pub use operation::{Chamfer, Fillet, Offset, OffsetCorner, ProfileSet};
pub use optics::{Anisotropy, Clearcoat, Iridescence, Sheen, Specular, Transmission, Volume};
pub use output::{ByProfile, Forward, Output, OutputProfile, OutputScale, Pivot, TextureSize, Textures};
pub use page::reference;
pub use parametric::Parametric;
pub use part::{CurveGroup, Part};
pub use patch::{HermiteSurface, Patches, SpokenContinuity};
pub use path::{ArcSegment, Joint, Path, Segment};
pub use perturbed::{PatchBump, PerturbedPatches};
pub use point::{Count, Point, Scale, Segments};
pub use polygon::{Face, Polygon, Sheet};
pub use primitive::{
    Base, BoxShape, Capsule, Cone, Cylinder, Disk, Geodesic, GeodesicClass, PlaneShape, Polyhedron, Pose,
    Solid, Sphere, Torus, Tube,
};
pub use profile::{Axis, Bevel, BevelEnds, BevelForm, Extrude, Fill, Revolve};
pub use project::project_schema;
pub use quadric::{Quadric, QuadricClip, QuadricWithin, Within};
pub use reach::{Reach, ReachRule};
pub use reference::{
    CurveReference, Family, FieldReference, Link, MapReference, MaterialName, NodeName, ShapeName,
    ShapeReference, SkeletonName,
};
pub use ruled::{End, Ruled, Translational};
pub use scaling::{Blend, Factor, ScaleStation, Scaling};
pub use shape::{Shape, ShapeDefinition, ShapeOptions, Smoothing, Uv, UvMapping};
pub use skeleton::{AxisRanges, Chain, Joint as SkeletonJoint, MirrorAxis, Skeleton, SkeletonImport, Socket};
pub use skin::{Skin, SkinBump, SkinWeight, WeightRule};
pub use solid::{Cut, Hull, Keep, MinkowskiRound, Shell, SolidFormula, SolidSet, WallSide};
pub use solid_expression::SolidExpression;
pub use spanned::Sp;
pub use spline::{Bezier, NaturalSpline, Parameters};
pub use spline_end::{FunctionSpline, Spline, SplineEnd};
pub use subdivide::{CageBorder, Sharpness, Subdivide, SubdivideCorner, SubdivideCrease, SubdivisionScheme};
pub use subdivision_curve::{CurveScheme, SubdivisionCurve};
pub use svg::{Subpath, Svg, SvgArc, SvgPath, SvgSegment};
pub use sweep::{Frame, ProfileStation, Sweep};
pub use tangent::{Cardinal, CatmullRom, ChordPower, EndRule, Hermite, KochanekBartels, PerPoint};
pub use trimmed::Trimmed;
pub use vertex_color::{VertexColor, VertexColorFormulas};
pub use view::{Aim, Camera, Light, LightKind};
pub use whole::schema;
pub use wire::Wire;

pub(crate) use name::{check_name, kebab};
pub(crate) use project::{InnerPath, Project};
pub(crate) use reader::{backtick, read_whole};
pub(crate) use section::{default_text, read_spec};
