//! Shapes from height maps.

use glam::{DVec2, DVec3};
use serde_json::Value as Json;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::height_base::{HeightBase, Projection};
use crate::language::spec::point::Segments;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::reference::MapReference;
use crate::language::spec::scalar::finite;
use crate::language::spec::schema::{Schemas, any_of};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value, show_number};

table! {
    /// Ground by a map of heights, over a flat rectangle in the x, z plane about the origin: columns of the map go to +x,
    /// its first row lies at -z. With `on` the heights stand on a curved base instead, along its normals. The surface is
    /// defined between the samples too, as the `interpolation` of the map says, and the mesh lies within the tolerance of
    /// it, with few triangles where the ground is flat. Neighbouring maps of the same `tolerance` and scale that repeat each
    /// other's border samples meet without a crack.
    "height map" pub HeightMap {
        /// The heights: the name of a map, or a map in place.
        map: MapReference;
        /// What the heights stand on, when it is not the plane: `{ sphere = { radius = 1 } }`, `{ cylinder = { ... } }`,
        /// `{ ellipsoid = { ... } }` or `{ surface = { of = "vase" } }`. Surfaces that would run through themselves are errors.
        on: Option<HeightBase>;
        /// Lengths along x and z, in the document's unit; of a map on the plane.
        size: Option<Sp<DVec2>> => Check::above(0.0);
        /// The heights of the values 0 and 1 of the map, in the document's unit. With `[0, 1]` the values of the map are
        /// the heights; `[0, 0.2]` makes white pixels stand 0.2 above black ones; `[1, 0]` turns it upside down.
        range: Sp<DVec2> = DVec2::new(0.0, 1.0);
        /// Where the tolerance holds.
        bound: Sp<HeightBound> = HeightBound::Surface;
        /// How it is closed.
        close: Sp<HeightClose> = HeightClose::None;
        /// With `close = "base"`: how high the flat bottom lies, or with `on` how far out of the base the lower skin. No
        /// height may lie below it.
        base: Option<Sp<f64>>;
        /// With `close = "thickness"`: how far the lower sheet lies below the upper one, measured along the heights.
        depth: Option<Sp<f64>> => Check::above(0.0);
        /// Draws the normals of the heights at full resolution into a normal map of the shape's material: its width and height
        /// in pixels, or one number for both. Few triangles then look like many: write a coarser `tolerance` with it. It is
        /// for the upper side, where the shape is shown by itself.
        bake_normal_map: Option<Sp<Segments>> => Check::within(1.0, 16384.0);
        /// What is kept of the ground: the places where all of these hold. It ends along the exact lines where the maps
        /// pass their thresholds, in as many parts and with as many holes as that gives, and walls follow them when it is
        /// closed. Masks that keep opposite sides of one threshold meet along the same points. Samples at the threshold
        /// count on both sides.
        mask: Vec<Mask> = Vec::new();
    }
    checked check
}

table! {
    /// A condition on the places that are kept: a map within thresholds.
    "mask" pub Mask {
        /// What is held against the thresholds: the name of a map, or a map in place. It is stretched over the ground, and
        /// its values are taken as they stand, whatever `range` says.
        map: MapReference;
        /// Kept is where the map has at least this value: a number, or another map, which is taken at the samples of the
        /// first.
        at_least: Option<Sp<Level>>;
        /// Kept is where the map has at most this value: a number, or another map.
        at_most: Option<Sp<Level>>;
    }
    checked check
}

/// A threshold.
#[derive(Clone, Debug, PartialEq)]
pub enum Level {
    /// The same everywhere.
    Number(f64),
    /// Another map.
    Map(MapReference),
}

choices! {
    /// Where the tolerance of a height map holds.
    HeightBound {
        /// Everywhere, between the samples too.
        Surface = "surface";
        /// At the samples.
        Samples = "samples";
        /// Every sample becomes a corner of the mesh, whatever the tolerance.
        Dense = "dense";
    }
}

choices! {
    /// How a height map is closed.
    HeightClose {
        /// It stays an open sheet.
        None = "none";
        /// By walls and a flat bottom.
        Base = "base";
        /// By walls and a second sheet below.
        Thickness = "thickness";
        /// By flat ends across the axis: on a cylinder that it goes all around.
        Ends = "ends";
    }
}

impl Mask {
    fn check(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        let report = match (&self.at_least, &self.at_most) {
            (None, None) => {
                Diagnostic::error(Code::MissingField, "missing field `at-least` or `at-most` of mask")
                    .at(span, "no threshold")
                    .help("write `at-least = 0.5`")
            }
            (Some(least), Some(most)) => match (&least.value, &most.value) {
                (Level::Number(low), Level::Number(high)) if low > high => {
                    let (low, high) = (show_number(*low), show_number(*high));
                    let message =
                        format!("`at-least` is {low} and `at-most` is {high}: nothing lies between them");
                    Diagnostic::error(Code::OutOfRange, message)
                        .at(most.span, "less than `at-least`")
                        .help(format!("write `at-least = {high}` and `at-most = {low}`"))
                }
                _ => return true,
            },
            _ => return true,
        };
        reader.report(report);
        false
    }
}

impl Read for Level {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        match &value.data {
            Data::String(_) | Data::Table(_) => MapReference::read(value, reader).map(Self::Map),
            _ if value.number().is_some() => finite(value, reader).map(Self::Number),
            _ => {
                reader.mismatch(value, "a number, or a map");
                None
            }
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        any_of(vec![f64::schema(schemas), MapReference::schema(schemas)])
    }
}

impl HeightMap {
    /// A size that is missing or means nothing.
    fn misplaced(&self, span: Span) -> Option<Diagnostic> {
        match (&self.on, self.size) {
            (None, None) => Some(
                Diagnostic::error(Code::MissingField, "missing field `size` of height map")
                    .at(span, "how large?")
                    .help("write `size = [1, 1]`, or `on = { sphere = { radius = 1 } }` for a curved base"),
            ),
            (Some(_), Some(size)) => Some(
                Diagnostic::error(Code::Conflict, "`size` is that of a map on the plane")
                    .at(size.span, "no effect with `on`")
                    .help("leave it out: the base says how large the map is"),
            ),
            _ => None,
        }
    }

    /// Ends of what has none, or none that are flat.
    fn endless(&self) -> Option<Diagnostic> {
        if self.close.value != HeightClose::Ends {
            return None;
        }
        let whole = |base: &crate::language::spec::CylinderBase| {
            let [from, to] = base.longitude.value.to_array();
            base.projection.value == Projection::Cylindrical && to - from == 360.0
        };
        let fault = match &self.on {
            Some(HeightBase::Cylinder(base)) if whole(base) && self.mask.is_empty() => return None,
            Some(HeightBase::Cylinder(_)) => "a map that goes all around and has no masks",
            _ => "a map on a cylinder",
        };
        let message = format!("`close = \"ends\"` closes {fault}");
        let report = Diagnostic::error(Code::Conflict, message).at(self.close.span, "no flat ends here");
        Some(report.help("write `close = \"base\"`, `\"thickness\"` or `\"none\"`"))
    }

    fn check(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        let close = self.close.value;
        let idle = |field: Option<Span>, name: &str, needs: HeightClose| {
            let at = field.filter(|_| close != needs)?;
            let message = format!("`{name}` has no effect with `close = \"{}\"`", close.text());
            let help = format!("write `close = \"{}\"`", needs.text());
            Some(Diagnostic::error(Code::Conflict, message).at(at, "no effect").help(help))
        };
        let base = idle(self.base.map(|base| base.span), "base", HeightClose::Base);
        let depth = idle(self.depth.map(|depth| depth.span), "depth", HeightClose::Thickness);
        let missing = (close == HeightClose::Thickness && self.depth.is_none()).then(|| {
            let place = if self.close.span.is_none() { span } else { self.close.span };
            Diagnostic::error(Code::MissingField, "missing field `depth` of height map")
                .at(place, "how thick?")
                .help("write `depth = 0.1`")
        });
        let reports = [base, depth, missing, self.misplaced(span), self.endless()];
        let reports: Vec<Diagnostic> = reports.into_iter().flatten().collect();
        let good = reports.is_empty();
        reports.into_iter().for_each(|report| reader.report(report));
        good
    }
}

table! {
    /// A body of parts on split planes: each part is solid between its plane and a height map over it, and all of them
    /// together are the shape. Two parts on one plane that look away from each other meet there without a wall between
    /// them: a bust by a map of its face and one of the back of its head. Their maps may have different numbers of samples.
    /// Parts on other planes are joined in their order, by union where no other `operation` is written.
    "split" pub Split {
        /// Lengths of the rectangle of each part, in the document's unit.
        size: Sp<DVec2> => Check::above(0.0);
        /// Conditions on the places that all parts keep.
        mask: Vec<Mask> = Vec::new();
        /// The parts.
        part: Sp<Vec<SplitPart>> => Check::items(1);
    }
}

table! {
    /// A part of a split body: solid from its plane up to the heights of its map.
    "split part" pub SplitPart {
        /// The heights: the name of a map, or a map in place. None may be below the plane where the part is kept.
        map: MapReference;
        /// The heights of the values 0 and 1 of the map, in the document's unit.
        range: Sp<DVec2> = DVec2::new(0.0, 1.0);
        /// Where the part looks from its plane. Along +y columns go to +x and rows to +z, as for a height map; a part
        /// that looks the opposite way lies over the same places, as if seen through the plane.
        normal: Sp<DVec3> = DVec3::Y => Check::ANY;
        /// The middle of the rectangle.
        point: Sp<DVec3> = DVec3::ZERO;
        /// What the part does to all those before it. The first part has none before it.
        operation: Sp<SplitOperation> = SplitOperation::Union;
        /// Whether columns run the other way: for the picture of a back as who looks at it sees it.
        mirror: Sp<bool> = false;
        /// Conditions on the places that this part keeps, besides those of all parts.
        mask: Vec<Mask> = Vec::new();
    }
    checked check
}

choices! {
    /// What a part of a split body does to those before it.
    SplitOperation {
        /// It is added.
        Union = "union";
        /// It is taken away.
        Difference = "difference";
        /// Only what lies in it stays.
        Intersection = "intersection";
    }
}

impl SplitPart {
    fn check(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        if self.normal.value != DVec3::ZERO {
            return true;
        }
        let place = if self.normal.span.is_none() { span } else { self.normal.span };
        let report = Diagnostic::error(Code::OutOfRange, "the normal of a plane must not be [0, 0, 0]")
            .at(place, "looks nowhere")
            .help("write `normal = [0, 1, 0]`");
        reader.report(report);
        false
    }
}
