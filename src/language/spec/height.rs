//! Shapes from height maps.

use glam::DVec2;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::reader::Reader;
use crate::language::spec::reference::MapReference;
use crate::language::spec::spanned::Sp;

table! {
    /// Ground by a map of heights, over a flat rectangle in the x, z plane about the origin: columns of the map go to +x,
    /// its first row lies at -z. The surface is defined between the samples too, as the `interpolation` of the map says,
    /// and the mesh lies within the tolerance of it, with few triangles where the ground is flat. Neighbouring maps of the
    /// same `tolerance` and scale that repeat each other's border samples meet without a crack.
    "height map" pub HeightMap {
        /// The heights: the name of a map, or a map in place.
        map: MapReference;
        /// Lengths along x and z, in the document's unit.
        size: Sp<DVec2> => Check::above(0.0);
        /// The heights of the values 0 and 1 of the map, in the document's unit. With `[0, 1]` the values of the map are
        /// the heights; `[0, 0.2]` makes white pixels stand 0.2 above black ones; `[1, 0]` turns it upside down.
        range: Sp<DVec2> = DVec2::new(0.0, 1.0);
        /// Where the tolerance holds.
        bound: Sp<HeightBound> = HeightBound::Surface;
        /// How it is closed.
        close: Sp<HeightClose> = HeightClose::None;
        /// With `close = "base"`: how high the flat bottom lies. No height may lie below it.
        base: Option<Sp<f64>>;
        /// With `close = "thickness"`: how far the lower sheet lies below the upper one, measured upright.
        depth: Option<Sp<f64>> => Check::above(0.0);
    }
    checked check
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
    }
}

impl HeightMap {
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
        let reports: Vec<Diagnostic> = [base, depth, missing].into_iter().flatten().collect();
        let good = reports.is_empty();
        reports.into_iter().for_each(|report| reader.report(report));
        good
    }
}
