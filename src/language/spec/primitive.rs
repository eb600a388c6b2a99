//! Shapes of elementary geometry.

use glam::{DVec2, DVec3};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::reader::Reader;
use crate::language::spec::spanned::Sp;
use crate::language::value::show_number;

table! {
    /// A box, with flat sides or rounded edges and corners.
    "box" pub BoxShape {
        /// Width along x, height along y and depth along z, in the document's unit.
        size: Sp<DVec3> => Check::above(0.0);
        /// Radius of its edges and corners: quarters of cylinders and eighths of balls. At most half the least side,
        /// where flat sides vanish: a box of three equal sides is a ball then. With `segments`, each eighth of a turn
        /// has that many pieces.
        radius: Sp<f64> = 0.0 => Check::at_least(0.0);
        /// The middle.
        center: Sp<DVec3> = DVec3::ZERO;
    }
    checked check
}

table! {
    /// A ball.
    "sphere" pub Sphere {
        /// Radius, in the document's unit.
        radius: Sp<f64> => Check::above(0.0);
        /// The middle.
        center: Sp<DVec3> = DVec3::ZERO;
    }
}

table! {
    /// A cylinder that stands along the y axis, closed at both ends.
    "cylinder" pub Cylinder {
        /// Radius, in the document's unit.
        radius: Sp<f64> => Check::above(0.0);
        /// Height along y, in the document's unit.
        height: Sp<f64> => Check::above(0.0);
        /// The middle.
        center: Sp<DVec3> = DVec3::ZERO;
    }
}

table! {
    /// A cone that stands along the y axis, closed at its ends; with two radii it is cut off before its tip.
    "cone" pub Cone {
        /// Radius of the lower end, in the document's unit; 0 for a tip.
        radius: Sp<f64> => Check::at_least(0.0);
        /// Radius of the upper end; 0 for a tip.
        top_radius: Sp<f64> = 0.0 => Check::at_least(0.0);
        /// Height along y, in the document's unit.
        height: Sp<f64> => Check::above(0.0);
        /// The middle of the axis, at half of the height.
        center: Sp<DVec3> = DVec3::ZERO;
    }
    checked check
}

table! {
    /// A cylinder with half a ball on each end, along the y axis.
    "capsule" pub Capsule {
        /// Radius, in the document's unit.
        radius: Sp<f64> => Check::above(0.0);
        /// Height along y from end to end, at least twice the radius: then it is a ball.
        height: Sp<f64> => Check::above(0.0);
        /// The middle.
        center: Sp<DVec3> = DVec3::ZERO;
    }
    checked check
}

table! {
    /// A ring that lies in the x, z plane.
    "torus" pub Torus {
        /// Radius of the circle in the middle of the ring, in the document's unit.
        radius: Sp<f64> => Check::above(0.0);
        /// Radius of the ring's section, less than `radius`.
        tube_radius: Sp<f64> => Check::above(0.0);
        /// The middle.
        center: Sp<DVec3> = DVec3::ZERO;
    }
    checked check
}

table! {
    /// A pipe along the y axis: a cylinder with a round hole through it.
    "tube" pub Tube {
        /// Radius of the outside, in the document's unit.
        radius: Sp<f64> => Check::above(0.0);
        /// Radius of the hole, less than `radius`.
        inner_radius: Sp<f64> => Check::above(0.0);
        /// Height along y, in the document's unit.
        height: Sp<f64> => Check::above(0.0);
        /// The middle.
        center: Sp<DVec3> = DVec3::ZERO;
    }
    checked check
}

table! {
    /// A flat disk in the x, z plane that looks up, without thickness; with `inner-radius` a flat ring, with `angle` a
    /// slice of it.
    "disk" pub Disk {
        /// Radius, in the document's unit.
        radius: Sp<f64> => Check::above(0.0);
        /// Radius of the hole in the middle, less than `radius`.
        inner_radius: Sp<f64> = 0.0 => Check::at_least(0.0);
        /// How far it goes around, in degrees.
        angle: Sp<f64> = 360.0 => Check::above(0.0).up_to(360.0);
        /// Where it begins, in degrees from +x.
        start: Sp<f64> = 0.0 => Check::within(-360.0, 360.0);
        /// The middle.
        center: Sp<DVec3> = DVec3::ZERO;
    }
    checked check
}

table! {
    /// A flat rectangle in the x, z plane that looks up, without thickness; with `segments` a grid.
    "flat plane" pub PlaneShape {
        /// Width along x and depth along z, in the document's unit.
        size: Sp<DVec2> => Check::above(0.0);
        /// The middle.
        center: Sp<DVec3> = DVec3::ZERO;
    }
}

table! {
    /// A Platonic solid, with one of `radius`, `edge` and `inradius`. Each face shows the whole texture, upright.
    "polyhedron" pub Polyhedron {
        /// Which of the five.
        solid: Sp<Solid>;
        /// Distance from the middle to each corner, in the document's unit.
        radius: Option<Sp<f64>> => Check::above(0.0);
        /// Length of each edge.
        edge: Option<Sp<f64>> => Check::above(0.0);
        /// Distance from the middle to each face.
        inradius: Option<Sp<f64>> => Check::above(0.0);
        /// What of it is lowest.
        pose: Sp<Pose> = Pose::Axes;
        /// The middle.
        center: Sp<DVec3> = DVec3::ZERO;
    }
    checked check
}

table! {
    /// A ball of nearly equal triangles: the faces of a Platonic solid, divided and blown up. With
    /// `smoothing = "flat"` a dome or a cut gem.
    "geodesic" pub Geodesic {
        /// Radius, in the document's unit; every corner has this distance from the middle.
        radius: Sp<f64> => Check::above(0.0);
        /// The solid that is divided: the more faces it has, the more equal are the triangles.
        base: Sp<Base> = Base::Icosahedron;
        /// Into how many pieces each edge of the solid is divided; when it is not written, as many as the tolerance asks.
        frequency: Option<Sp<u32>> => Check::within(1.0, 1000.0);
        /// How the faces are divided.
        class: Sp<GeodesicClass> = GeodesicClass::Alternate;
        /// The middle.
        center: Sp<DVec3> = DVec3::ZERO;
    }
}

choices! {
    /// A Platonic solid.
    Solid {
        /// Four triangles.
        Tetrahedron = "tetrahedron";
        /// Six squares.
        Cube = "cube";
        /// Eight triangles.
        Octahedron = "octahedron";
        /// Twelve pentagons.
        Dodecahedron = "dodecahedron";
        /// Twenty triangles.
        Icosahedron = "icosahedron";
    }
}

choices! {
    /// What of a solid is lowest.
    Pose {
        /// Its axes of symmetry lie along x, y and z.
        Axes = "axes";
        /// A face lies below, as when it rests on a table.
        Face = "face";
        /// An edge lies below, along x.
        Edge = "edge";
        /// A corner points down.
        Vertex = "vertex";
    }
}

choices! {
    /// A solid of triangles that can be divided.
    Base {
        /// Four triangles.
        Tetrahedron = "tetrahedron";
        /// Eight triangles.
        Octahedron = "octahedron";
        /// Twenty triangles.
        Icosahedron = "icosahedron";
    }
}

choices! {
    /// How the faces of a geodesic ball are divided.
    GeodesicClass {
        /// Along the edges of the solid: `frequency` squared triangles for each face (class I).
        Alternate = "alternate";
        /// Across the edges of the solid: three times as many (class II).
        Triacon = "triacon";
    }
}

/// What a measure computed by an expression may be off by, relative.
const ROUNDING: f64 = 1e-12;

/// Reports a measure that does not fit another; true when it does.
fn fits(
    holds: bool,
    (field, found): (&str, &Sp<f64>),
    demand: &str,
    help: &str,
    reader: &mut Reader<'_>,
) -> bool {
    if !holds {
        let message = format!("`{field}` must be {demand}, found {}", show_number(found.value));
        let report = Diagnostic::error(Code::DoesNotFit, message).at(found.span, format!("not {demand}"));
        reader.report(report.help(help));
    }
    holds
}

impl BoxShape {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let most = self.size.min_element() / 2.0;
        let demand = format!("at most {}, half the least side", show_number(most));
        let help = "make the radius smaller or the box larger";
        let holds = self.radius.value <= most * (1.0 + ROUNDING);
        fits(holds, ("radius", &self.radius), &demand, help, reader)
    }
}

impl Cone {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let thick = self.radius.value > 0.0 || self.top_radius.value > 0.0;
        let help = "give the lower end, the upper end or both a radius";
        fits(thick, ("radius", &self.radius), "greater than 0 where `top-radius` is 0", help, reader)
    }
}

impl Capsule {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let least = 2.0 * self.radius.value;
        let demand = format!("at least {}, twice the radius", show_number(least));
        let help = "`height` goes from end to end, the round ends included";
        let holds = self.height.value >= least * (1.0 - ROUNDING);
        fits(holds, ("height", &self.height), &demand, help, reader)
    }
}

impl Torus {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let demand = format!("less than {}, the radius", show_number(self.radius.value));
        let help = "a thicker ring would cross itself in the middle; to close the hole, turn a profile with `revolve`";
        let holds = self.tube_radius.value < self.radius.value;
        fits(holds, ("tube-radius", &self.tube_radius), &demand, help, reader)
    }
}

impl Tube {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let demand = format!("less than {}, the radius", show_number(self.radius.value));
        let help = "`radius` is that of the outside";
        let holds = self.inner_radius.value < self.radius.value;
        fits(holds, ("inner-radius", &self.inner_radius), &demand, help, reader)
    }
}

impl Disk {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let demand = format!("less than {}, the radius", show_number(self.radius.value));
        let help = "`radius` is that of the outer rim";
        let holds = self.inner_radius.value < self.radius.value;
        fits(holds, ("inner-radius", &self.inner_radius), &demand, help, reader)
    }
}

impl Polyhedron {
    fn check(&self, table: Span, reader: &mut Reader<'_>) -> bool {
        let sizes = [("radius", &self.radius), ("edge", &self.edge), ("inradius", &self.inradius)];
        let written: Vec<_> =
            sizes.iter().filter_map(|(name, size)| size.map(|size| (*name, size.span))).collect();
        let report = match written.as_slice() {
            [_] => return true,
            [] => Diagnostic::error(Code::MissingField, "a polyhedron needs a size")
                .at(table, "needs one of `radius`, `edge` and `inradius`"),
            [(one, first), (other, second), ..] => {
                let message = format!("`{one}` and `{other}` both say how large the polyhedron is");
                Diagnostic::error(Code::Conflict, message)
                    .at(*second, "the second size")
                    .also(*first, "the first size")
            }
        };
        reader.report(report.help("write one of `radius`, `edge` and `inradius`"));
        false
    }
}
