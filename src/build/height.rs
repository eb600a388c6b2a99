//! Height maps of a document into recipes.

use std::sync::Arc;

use glam::DVec2;

use super::Builder;
use super::profile::show;
use crate::geometry::map::GridField;
use crate::geometry::tessellate::{
    BasedMap, Closing, HeightBound as Bound, HeightMap as Heights, Mask, MaskSide,
};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::{self, HeightBound, HeightClose, HeightMap, Level, ShapeOptions, Sp};
use crate::model::Recipe;

impl Builder<'_> {
    pub(super) fn height_map(
        &mut self,
        name: &str,
        written: &HeightMap,
        options: &ShapeOptions,
    ) -> Option<Recipe> {
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
            HeightClose::Ends => Closing::Ends,
        };
        let masks = self.masks(&written.mask)?;
        let size = written.size.map_or(DVec2::ONE, |size| size.value);
        let heights = Heights { field, size, bound, close, masks };
        match &written.on {
            None => Some(Recipe::Height(heights)),
            Some(base) => {
                let base = self.height_base(name, base)?;
                self.note_poles(&base, &heights, written.map.span());
                Some(Recipe::Based(Box::new(BasedMap::new(base, heights))))
            }
        }
    }

    pub(super) fn masks(&mut self, written: &[spec::Mask]) -> Option<Vec<Mask>> {
        /// Each mask has bits of its own in the lines of the mesh.
        const MOST: usize = 8;
        if let Some(first) = written.get(MOST) {
            let message = format!("a height map has {} masks, and the limit is {MOST}", written.len());
            let report = Diagnostic::error(Code::LimitPassed, message)
                .at(first.map.span(), "one too many")
                .help("join maps by `combine` with `operation = \"min\"` or `\"max\"`");
            self.report(report);
            return None;
        }
        let masks: Vec<Option<Vec<Mask>>> = written.iter().map(|mask| self.mask(mask)).collect();
        masks.into_iter().collect::<Option<Vec<_>>>().map(|masks| masks.concat())
    }

    /// One or two sides of thresholds.
    fn mask(&mut self, written: &spec::Mask) -> Option<Vec<Mask>> {
        let field = self.map_of(&written.map)?;
        let sides = [(&written.at_least, MaskSide::AtLeast), (&written.at_most, MaskSide::AtMost)];
        let mut masks = Vec::new();
        for (level, side) in sides {
            let Some(level) = level else { continue };
            let mask = match &level.value {
                Level::Number(threshold) => Mask { field: field.clone(), threshold: *threshold, side },
                Level::Map(other) => {
                    let other = self.map_of(other)?;
                    Mask { field: Arc::new(field.minus(&other)), threshold: 0.0, side }
                }
            };
            if let Some(report) = holds_nowhere(&mask, level) {
                self.report(report);
                return None;
            }
            masks.push(mask);
        }
        Some(masks)
    }
}

/// A mask that cannot hold anywhere.
fn holds_nowhere(mask: &Mask, level: &Sp<Level>) -> Option<Diagnostic> {
    let (least, most) = reached(&mask.field);
    let (reach, word, missed) = match mask.side {
        MaskSide::AtLeast => (most, "greatest", most < mask.threshold),
        MaskSide::AtMost => (least, "least", least > mask.threshold),
    };
    if !missed {
        return None;
    }
    let report = match &level.value {
        Level::Number(threshold) => {
            let message = format!(
                "this mask leaves nothing: the {word} value of the map is {}, and the threshold is {}",
                show(reach),
                show(*threshold)
            );
            Diagnostic::error(Code::NothingKept, message).help(format!(
                "write a threshold between {} and {}",
                show(least),
                show(most)
            ))
        }
        Level::Map(_) => {
            let message =
                format!("this mask leaves nothing: the {word} difference of both maps is {}", show(reach));
            Diagnostic::error(Code::NothingKept, message)
        }
    };
    Some(report.at(level.span, "never reached"))
}

/// The least and greatest value, samples without a value left out.
fn reached(field: &GridField) -> (f64, f64) {
    if !field.has_gaps() {
        return field.range();
    }
    let known = (0..field.rows()).flat_map(|j| (0..field.columns()).map(move |i| (i, j)));
    let known =
        known.filter(|(i, j)| field.is_known(*i, *j)).map(|(i, j)| field.samples()[j * field.columns() + i]);
    let (low, high) = known
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    let (least, most) = field.range();
    // A spline may swing beyond its samples; its range holds what stands in for the missing ones too.
    if field.net(0, 0).is_some() { (least, most) } else { (low, high) }
}
