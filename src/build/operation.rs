//! Operations on flat curves of a document.

use super::Builder;
use super::profile::{place, show};
use crate::geometry::curve::AnyCurve;
use crate::geometry::planar::SetOperation;
use crate::geometry::profile::{self, CornerFault, CornerShape, ProfileError};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{Chamfer, CurveReference, Fillet, Offset, OffsetCorner, ProfileSet, Sp};

impl Builder<'_> {
    /// The outlines of a closed curve, moved.
    pub(super) fn offset(&mut self, offset: &Offset, span: Span) -> Option<Vec<AnyCurve>> {
        let parts = self.closed_parts(&offset.of, "outline", "outline's part")?;
        self.apart(&parts, offset.of.span())?;
        let curves: Vec<AnyCurve> = parts.into_iter().map(|part| part.curve).collect();
        let corner = match offset.corner.value {
            OffsetCorner::Round => profile::OffsetCorner::Round,
            OffsetCorner::Miter => profile::OffsetCorner::Miter(offset.miter_limit.value),
            OffsetCorner::Bevel => profile::OffsetCorner::Bevel,
        };
        let made = profile::offset(&curves, offset.distance.value, corner);
        self.result(made, span, |report| {
            report.also(offset.distance.span, "moved this far").help("move it less far inward")
        })
    }

    /// What closed curves enclose, put together.
    pub(super) fn profile_set(
        &mut self,
        set: &ProfileSet,
        operation: SetOperation,
        span: Span,
    ) -> Option<Vec<AnyCurve>> {
        // All are built, so that no fault hides.
        let named = set.of.iter().enumerate();
        let regions: Vec<_> = named
            .map(|(index, of)| {
                let name = format!("curve `of[{index}]`");
                let parts = self.closed_parts(of, &name, &format!("{name}, part"))?;
                Some(parts.into_iter().map(|part| part.curve).collect::<Vec<_>>())
            })
            .collect();
        let regions: Option<Vec<_>> = regions.into_iter().collect();
        let help = match operation {
            SetOperation::Union | SetOperation::Xor => "curves that are equal leave nothing between them",
            SetOperation::Difference => "the first curve lies inside the others",
            SetOperation::Intersection => "the curves have nothing in common",
        };
        self.result(profile::combine(&regions?, operation), span, |report| report.help(help))
    }

    /// A curve with rounded corners.
    pub(super) fn fillet(&mut self, fillet: &Fillet, span: Span) -> Option<Vec<AnyCurve>> {
        let shape = CornerShape::Round(fillet.radius.value);
        self.corners(&fillet.of, shape, &fillet.corners, (span, fillet.radius.span))
    }

    /// A curve with corners cut off.
    pub(super) fn chamfer(&mut self, chamfer: &Chamfer, span: Span) -> Option<Vec<AnyCurve>> {
        let shape = CornerShape::Cut(chamfer.distance.value);
        self.corners(&chamfer.of, shape, &chamfer.corners, (span, chamfer.distance.span))
    }

    fn corners(
        &mut self,
        of: &CurveReference,
        shape: CornerShape,
        chosen: &[Sp<u32>],
        (span, measure): (Span, Span),
    ) -> Option<Vec<AnyCurve>> {
        let parts = self.parts_of(of)?;
        let mut flat = Vec::new();
        for part in parts {
            flat.push(self.profile_of(part, "curve", of.span())?.curve);
        }
        let counts: Vec<usize> = flat.iter().map(|part| profile::corners(part).len()).collect();
        let all: usize = counts.iter().sum();
        self.check_corners(all, chosen, (span, of.span()))?;
        let mut made = Vec::new();
        let mut first = 0;
        for (part, count) in flat.into_iter().zip(counts) {
            let own: Vec<usize> = (chosen.iter().map(|corner| corner.value as usize))
                .filter(|corner| (first..first + count).contains(corner))
                .map(|corner| corner - first)
                .collect();
            let untouched = count == 0 || (own.is_empty() && !chosen.is_empty());
            match profile::cut_corners(&part, shape, &own) {
                _ if untouched => made.push(part),
                Ok(cut) => made.extend(cut),
                Err(fault) => return self.no_room(&fault, first, shape, measure),
            }
            first += count;
        }
        Some(made)
    }

    fn check_corners(&mut self, all: usize, chosen: &[Sp<u32>], (span, of): (Span, Span)) -> Option<()> {
        if all == 0 {
            let report = Diagnostic::error(Code::NoCorner, "this curve has no corner")
                .at(of, "smooth everywhere")
                .help("use the curve as it is");
            self.report(report.also(span, "asked for here"));
            return None;
        }
        let Some(beyond) = chosen.iter().find(|corner| corner.value as usize >= all) else { return Some(()) };
        let corners = if all == 1 { "1 corner".to_owned() } else { format!("{all} corners") };
        let message =
            format!("there is no corner {}: this curve has {corners}, counted from 0", beyond.value);
        let report = Diagnostic::error(Code::NoCorner, message).at(beyond.span, format!("0 to {}", all - 1));
        self.report(report.also(of, corners));
        None
    }

    fn no_room<T>(
        &mut self,
        fault: &CornerFault,
        first: usize,
        shape: CornerShape,
        measure: Span,
    ) -> Option<T> {
        let (what, asked) = match shape {
            CornerShape::Round(radius) => ("radius", radius),
            CornerShape::Cut(distance) => ("distance", distance),
        };
        let message = format!(
            "a {what} of {} does not fit corner {} at {}",
            show(asked),
            fault.corner + first,
            place(fault.place)
        );
        let report = Diagnostic::error(Code::NoRoom, message).at(measure, "too large");
        let report = if fault.largest > 0.0 {
            report.help(format!("the largest that fits there is {}", show(rounded_down(fault.largest))))
        } else {
            report.help("its sides leave no room for any: choose others with `corners`")
        };
        self.report(report);
        None
    }

    fn result(
        &mut self,
        made: Result<Vec<AnyCurve>, ProfileError>,
        span: Span,
        nothing: impl FnOnce(Diagnostic) -> Diagnostic,
    ) -> Option<Vec<AnyCurve>> {
        let error = match made {
            Ok(curves) => return Some(curves),
            Err(error) => error,
        };
        let report = match &error {
            ProfileError::Nothing => nothing(
                Diagnostic::error(Code::NothingLeft, "nothing is left of this profile").at(span, "empty"),
            ),
            ProfileError::Touch(point) => {
                let message = format!(
                    "two outlines touch near {}; whether they cross there cannot be told",
                    place(*point)
                );
                Diagnostic::error(Code::UnclearContact, message)
                    .at(span, "unclear")
                    .help("move one of them a little, so that they cross or stand apart")
            }
            ProfileError::Intricate(_) => {
                Diagnostic::error(Code::LimitPassed, error.to_string()).at(span, "too many bends")
            }
        };
        self.report(report);
        None
    }
}

/// A number to six digits that is not greater, but for rounding: what is told to fit does fit.
fn rounded_down(number: f64) -> f64 {
    let text = format!("{number:.5e}");
    let rounded: f64 = text.parse().unwrap_or(number);
    if rounded <= number * (1.0 + 1e-12) {
        return rounded;
    }
    let exponent: i32 = text.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0);
    let step: f64 = format!("1e{}", exponent - 5).parse().unwrap_or(0.0);
    rounded - step
}
