//! Shapes: what is common to all kinds, and the kinds.

use glam::{DVec2, DVec3};
use serde_json::Value as Json;

use crate::language::spec::attribute::Attributes;
use crate::language::spec::baked::{Lightmap, Occlusion};
use crate::language::spec::bezier_triangle::BezierTriangles;
use crate::language::spec::check::Check;
use crate::language::spec::combine::{Array, Copy, Group, Mirror};
use crate::language::spec::construct::{choices, kinds, table};
use crate::language::spec::coons::{Coons, Gordon};
use crate::language::spec::deform::{Along, Bend, Taper, Twist};
use crate::language::spec::displace::Displace;
use crate::language::spec::field::ImplicitShape;
use crate::language::spec::height::{HeightMap, Split};
use crate::language::spec::import::Import;
use crate::language::spec::joined::Joined;
use crate::language::spec::kind::{Kinds, take_kind};
use crate::language::spec::loft::Loft;
use crate::language::spec::mesh::Mesh;
use crate::language::spec::nurbs_surface::{BSplineSurface, NurbsSurface};
use crate::language::spec::parametric::Parametric;
use crate::language::spec::patch::{HermiteSurface, Patches};
use crate::language::spec::perturbed::PerturbedPatches;
use crate::language::spec::point::{Scale, Segments};
use crate::language::spec::polygon::{Polygon, Sheet};
use crate::language::spec::primitive::{
    BoxShape, Capsule, Cone, Cylinder, Disk, Geodesic, PlaneShape, Polyhedron, Sphere, Torus, Tube,
};
use crate::language::spec::profile::{Extrude, Revolve};
use crate::language::spec::quadric::Quadric;
use crate::language::spec::reader::{Fields, Read, Reader};
use crate::language::spec::reference::MaterialName;
use crate::language::spec::ruled::{Ruled, Translational};
use crate::language::spec::schema::Schemas;
use crate::language::spec::solid::{Cut, Hull, MinkowskiRound, Shell, SolidFormula, SolidSet};
use crate::language::spec::spanned::Sp;
use crate::language::spec::subdivide::Subdivide;
use crate::language::spec::sweep::Sweep;
use crate::language::spec::trimmed::Trimmed;
use crate::language::spec::vertex_color::VertexColor;
use crate::language::spec::wire::Wire;
use crate::language::value::Value;

/// A shape: its kind and the fields that all kinds have.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeDefinition {
    /// What is common to all kinds.
    pub options: ShapeOptions,
    /// What it is.
    pub kind: Shape,
}

table! {
    /// Fields of every shape, beside the table of its kind.
    "shape" pub ShapeOptions {
        /// How far the mesh may lie from the true surface, in the document's unit. When it is not written, the
        /// document's `tolerance` holds, else the diagonal of the bounding box / 2000.
        tolerance: Option<Sp<f64>> => Check::above(0.0);
        /// A fixed grid instead of a tolerance: so many pieces in both directions, or `[u, v]`.
        segments: Option<Sp<Segments>> => Check::at_least(1.0);
        /// Where the surface looks smooth.
        smoothing: Sp<Smoothing> = Smoothing::Auto;
        /// Edges that bend by more than this many degrees look sharp.
        crease_angle: Sp<f64> = 30.0 => Check::within(0.0, 180.0);
        /// When texture coordinates are written.
        uv: Sp<Uv> = Uv::Auto;
        /// How a texture lies on it, before `scale`, `rotate` and `at`.
        uv_mapping: Sp<UvMapping> = UvMapping::Surface;
        /// How often a texture repeats along u and v.
        uv_scale: Sp<DVec2> = DVec2::ONE => Check::nonzero();
        /// Colors of its vertices, which multiply that of the material and those that its parts or its file have: `"#rrggbb"`,
        /// linear `[r, g, b]`, or a table of formulas.
        vertex_color: Option<Sp<VertexColor>>;
        /// Darkens the colors of vertices by what hides the sky over them.
        occlusion: Option<Sp<Occlusion>>;
        /// Second texture coordinates, by which no two places of the shape share a place of a picture: for light that is baked.
        lightmap: Option<Sp<Lightmap>>;
        /// Attributes of vertices that games read themselves, by their names: an underscore and capital letters, as in
        /// `_WIND = "= y / 2"`. A formula, a list of up to four, or a table. Only of shapes that nodes show.
        attributes: Attributes;
        /// The name of its material.
        material: Option<Sp<MaterialName>>;
        /// Factor of size: a number, or one for each axis. Applied before `rotate` and `at`.
        scale: Sp<Scale> = Scale(DVec3::ONE) => Check::nonzero();
        /// Degrees about the x axis, then the y axis, then the z axis.
        rotate: Sp<DVec3> = DVec3::ZERO;
        /// How far it is moved, in the document's unit.
        at: Sp<DVec3> = DVec3::ZERO;
    }
}

choices! {
    /// Where the surface of a shape looks smooth.
    Smoothing {
        /// Smooth but for corners of the profile, edges beyond `crease-angle` and borders of smoothing groups.
        Auto = "auto";
        /// Every facet is flat.
        Flat = "flat";
        /// Smooth everywhere.
        Smooth = "smooth";
    }
}

choices! {
    /// How a texture lies on a shape.
    UvMapping {
        /// As the surface goes: along its two parameters, or as its file or its list of `uvs` says.
        Surface = "surface";
        /// Onto each triangle from that of the six sides which it faces most, upright and unmirrored; one picture is as wide and as
        /// high as the document's unit.
        Box = "box";
        /// Once around the y axis, with the middle of the picture in front, and up along it, one picture as high as the
        /// document's unit; onto what faces up or down as with "box".
        Cylinder = "cylinder";
        /// Once around the y axis, with the middle of the picture in front, and once from top to bottom, as a map of the world.
        Sphere = "sphere";
    }
}

choices! {
    /// When texture coordinates are written.
    Uv {
        /// When the material has a texture.
        Auto = "auto";
        /// Always.
        Always = "always";
        /// Never.
        None = "none";
    }
}

kinds! {
    /// A shape of one kind.
    "shape" Shape {
        /// A box, with flat sides or rounded edges.
        Box(BoxShape) = "box";
        /// A ball.
        Sphere(Sphere) = "sphere";
        /// A cylinder that stands along the y axis.
        Cylinder(Cylinder) = "cylinder";
        /// A cone, whole or cut off.
        Cone(Cone) = "cone";
        /// A cylinder with round ends.
        Capsule(Capsule) = "capsule";
        /// A ring.
        Torus(Torus) = "torus";
        /// A pipe.
        Tube(Tube) = "tube";
        /// A flat disk, ring or slice.
        Disk(Disk) = "disk";
        /// A flat rectangle.
        Plane(PlaneShape) = "plane";
        /// One of the five Platonic solids.
        Polyhedron(Polyhedron) = "polyhedron";
        /// A ball of nearly equal triangles.
        Geodesic(Geodesic) = "geodesic";
        /// A profile turned about the y axis.
        Revolve(Revolve) = "revolve";
        /// A flat profile drawn out along the z axis.
        Extrude(Extrude) = "extrude";
        /// A profile drawn along a curve.
        Sweep(Sweep) = "sweep";
        /// Straight lines between two curves.
        Ruled(Ruled) = "ruled";
        /// A surface through a row of profiles.
        Loft(Loft) = "loft";
        /// A curve moved along another.
        Translational(Translational) = "translational";
        /// The flat face inside a closed curve.
        Sheet(Sheet) = "sheet";
        /// Flat polygons with holes, written out.
        Polygon(Polygon) = "polygon";
        /// Curves as lines.
        Wire(Wire) = "wire";
        /// Curved patches by control points.
        Patches(Patches) = "patches";
        /// Curved triangles by control points.
        BezierTriangles(BezierTriangles) = "bezier-triangles";
        /// A surface through points with given tangents.
        Hermite(HermiteSurface) = "hermite";
        /// A B-spline surface.
        BSpline(BSplineSurface) = "b-spline";
        /// A NURBS surface.
        Nurbs(NurbsSurface) = "nurbs";
        /// A smooth patch over its sides.
        Coons(Coons) = "coons";
        /// A surface through a network of curves.
        Gordon(Gordon) = "gordon";
        /// A surface by an equation of the second degree.
        Quadric(Quadric) = "quadric";
        /// A part of a surface inside lines of its parameters.
        Trimmed(Trimmed) = "trimmed";
        /// Surfaces of several shapes as one skin.
        Joined(Joined) = "joined";
        /// Ground by a map of heights.
        HeightMap(HeightMap) = "height-map";
        /// Parts on split planes.
        Split(Split) = "split";
        /// A surface by formulas of u and v.
        Parametric(Parametric) = "parametric";
        /// Polygons with bumps.
        Perturbed(PerturbedPatches) = "perturbed";
        /// Where a field is zero.
        Implicit(ImplicitShape) = "implicit";
        /// Points and faces, written out.
        Mesh(Mesh) = "mesh";
        /// A model from a file.
        Import(Import) = "import";
        /// Another shape, thinner or thicker along an axis.
        Taper(Taper) = "taper";
        /// Another shape, turned about an axis more and more.
        Twist(Twist) = "twist";
        /// Another shape, its axis bent into an arc.
        Bend(Bend) = "bend";
        /// Another shape, laid along a curve.
        Along(Along) = "along";
        /// Another shape, its points moved along their normals.
        Displace(Displace) = "displace";
        /// Another shape again.
        Copy(Copy) = "copy";
        /// Another shape and its mirror image.
        Mirror(Mirror) = "mirror";
        /// Another shape many times.
        Array(Array) = "array";
        /// Several shapes as one mesh; each keeps its material.
        Group(Group) = "group";
        /// Everything that is in any of several solids.
        Union(SolidSet) = "union";
        /// A solid without others.
        Difference(SolidSet) = "difference";
        /// Everything that is in all of several solids.
        Intersection(SolidSet) = "intersection";
        /// Solids put together by an expression.
        Solid(SolidFormula) = "solid";
        /// A shape cut by a plane.
        Cut(Cut) = "cut";
        /// The smallest convex body around shapes and points.
        Hull(Hull) = "hull";
        /// A solid grown or shrunk by a ball.
        MinkowskiRound(MinkowskiRound) = "minkowski-round";
        /// A solid hollowed out.
        Shell(Shell) = "shell";
        /// A coarse shape made smooth.
        Subdivide(Subdivide) = "subdivide";
    }
}

impl Read for ShapeDefinition {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let mut fields = Fields::open(value, "shape", reader)?;
        let options = ShapeOptions::take(&mut fields, reader);
        let kind = take_kind::<Shape>(&mut fields, reader);
        let closed = fields.close(reader);
        match (options, kind, closed) {
            (Some(options), Some(kind), true) => Some(Self { options, kind }),
            _ => None,
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        let doc = "A shape: one kind, and beside it the fields that every shape has.";
        schemas.object("shape", doc, |object, schemas| {
            ShapeOptions::describe(object, schemas);
            Shape::describe_kinds(object, schemas);
        })
    }
}
