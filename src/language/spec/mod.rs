//! What a document can say: one file for each construct, read, checked and resolved.

mod arc;
mod assertion;
mod bspline;
mod check;
mod combine;
mod conic;
mod construct;
mod cubic;
mod curve;
mod document;
mod formula;
mod import;
mod kind;
mod limit;
mod material;
mod mesh;
mod name;
mod node;
mod page;
mod path;
mod point;
mod primitive;
mod profile;
mod reader;
mod reference;
mod resolve;
mod ruled;
mod scalar;
mod schema;
mod section;
mod shape;
mod spanned;
mod spline;
mod spline_end;
mod subdivision_curve;
mod tangent;
mod whole;

pub use crate::language::suggest::closest;
pub use arc::{Arc, CenterArc};
pub use assertion::{Assertion, Demand, Expected};
pub use bspline::{BSpline, KnotRule, Nurbs};
pub use combine::{Array, Copy, Group, Mirror, Plane};
pub use conic::{Conic, ConicForm, Hyperbola, Parabola};
pub use cubic::{Basis, BetaSpline, Border, Cubic};
pub use curve::{Circle, Curve, Ellipse, Helix, Line, Polyline, Reverse, Transform};
pub use document::{Asset, Definition, Spec, Unit};
pub use formula::{Formula, FormulaCurve, FormulaForm};
pub use import::{FilePath, Import, Up};
pub use limit::Limits;
pub use material::{Alpha, Color, Filter, Material, Texture, Wrap};
pub use mesh::Mesh;
pub use node::Node;
pub use page::reference;
pub use path::{ArcSegment, Joint, Path, Segment};
pub use point::{Count, Point, Scale, Segments};
pub use primitive::{
    Base, BoxShape, Capsule, Cone, Cylinder, Disk, Geodesic, GeodesicClass, PlaneShape, Polyhedron, Pose,
    Solid, Sphere, Torus, Tube,
};
pub use profile::{Extrude, Frame, Revolve, Sweep};
pub use reference::{CurveReference, Family, MaterialName, NodeName, ShapeName, ShapeReference};
pub use ruled::{End, Ruled, Translational};
pub use shape::{Shape, ShapeDefinition, ShapeOptions, Smoothing, Uv};
pub use spanned::Sp;
pub use spline::{Bezier, NaturalSpline, Parameters};
pub use spline_end::{FunctionSpline, Spline, SplineEnd};
pub use subdivision_curve::{CurveScheme, SubdivisionCurve};
pub use tangent::{Cardinal, CatmullRom, ChordPower, EndRule, Hermite, KochanekBartels, PerPoint};
pub use whole::schema;

pub(crate) use name::check_name;
pub(crate) use reader::backtick;
pub(crate) use section::{default_text, read_spec};
