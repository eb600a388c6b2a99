//! Height maps of a document into recipes.

use std::sync::Arc;

use super::Builder;
use crate::geometry::tessellate::{Closing, HeightBound as Bound, HeightMap as Heights};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::{HeightBound, HeightClose, HeightMap, ShapeOptions};
use crate::model::Recipe;

impl Builder<'_> {
    pub(super) fn height_map(&mut self, written: &HeightMap, options: &ShapeOptions) -> Option<Recipe> {
        let field = self.map_of(&written.map)?;
        if let Some(segments) = options.segments {
            let report = Diagnostic::error(Code::Conflict, "a height map is not cut into `segments`")
                .at(segments.span, "no effect")
                .help("write a `tolerance`, or `bound = \"dense\"` for all samples");
            self.report(report);
            return None;
        }
        let [low, high] = written.range.value.to_array();
        let field = if (low, high) == (0.0, 1.0) { field } else { Arc::new(field.scaled(high - low, low)) };
        let bound = match written.bound.value {
            HeightBound::Surface => Bound::Surface,
            HeightBound::Samples => Bound::Samples,
            HeightBound::Dense => Bound::Dense,
        };
        let close = match written.close.value {
            HeightClose::None => Closing::None,
            HeightClose::Base => Closing::Base(written.base.map_or(0.0, |base| base.value)),
            HeightClose::Thickness => Closing::Thickness(written.depth?.value),
        };
        Some(Recipe::Height(Heights { field, size: written.size.value, bound, close }))
    }
}
