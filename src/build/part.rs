//! Curves by name, and curves of several parts.

use super::{Builder, placement, svg};
use crate::geometry::curve::{AnyCurve, Reversed, Transformed};
use crate::geometry::planar::SetOperation;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{Curve, CurveReference, Part};

impl Builder<'_> {
    /// The parts of the curve of a name, built at its first use.
    pub(super) fn named_parts(&mut self, name: &str) -> Option<Vec<AnyCurve>> {
        if let Some(known) = self.curves.get(name) {
            return known.clone();
        }
        let definition = self.spec.curves.get(name)?;
        let outside = self.within.replace((name.to_owned(), false));
        let built = self.parts(&definition.value, definition.span);
        self.within = outside;
        self.curves.insert(name.to_owned(), built.clone());
        built
    }

    /// All parts of the curve that a field asks for; at least one.
    pub(super) fn parts_of(&mut self, reference: &CurveReference) -> Option<Vec<AnyCurve>> {
        match reference {
            CurveReference::Named(name) => self.named_parts(&name.value),
            CurveReference::Inline(curve) => {
                let outside = self.within.clone();
                if let Some((_, inline)) = &mut self.within {
                    *inline = true;
                }
                let built = self.parts(&curve.value, curve.span);
                self.within = outside;
                built
            }
        }
    }

    /// The curve that a field asks for, where it cannot have several parts.
    pub(super) fn curve_of(&mut self, reference: &CurveReference) -> Option<AnyCurve> {
        let mut parts = self.parts_of(reference)?;
        if parts.len() == 1 {
            return parts.pop();
        }
        let count = parts.len();
        let (of, message) = match reference {
            CurveReference::Named(name) => (
                format!("\"{}\"", name.value),
                format!("curve `{}` has {count} parts; here one is needed", name.value),
            ),
            CurveReference::Inline(_) => {
                ("...".to_owned(), format!("this curve has {count} parts; here one is needed"))
            }
        };
        let report = Diagnostic::error(Code::ManyParts, message)
            .at(reference.span(), format!("{count} parts"))
            .help(format!("take one of them: {{ part = {{ of = {of}, index = 0 }} }}"));
        self.report(report);
        None
    }

    fn parts(&mut self, curve: &Curve, span: Span) -> Option<Vec<AnyCurve>> {
        match curve {
            Curve::Svg(written) => Some(svg::svg(written)),
            Curve::Dxf(written) => self.dxf(written, span),
            Curve::Group(group) => {
                // All are built, so that no fault hides.
                let parts: Vec<_> = group.of.iter().map(|one| self.parts_of(one)).collect();
                let parts: Option<Vec<_>> = parts.into_iter().collect();
                Some(parts?.concat())
            }
            Curve::Part(part) => self.part(part).map(|curve| vec![curve]),
            Curve::Implicit(implicit) => self.implicit(implicit, span),
            Curve::Offset(offset) => self.offset(offset, span),
            Curve::Union(set) => self.profile_set(set, SetOperation::Union, span),
            Curve::Difference(set) => self.profile_set(set, SetOperation::Difference, span),
            Curve::Intersection(set) => self.profile_set(set, SetOperation::Intersection, span),
            Curve::Xor(set) => self.profile_set(set, SetOperation::Xor, span),
            Curve::Fillet(fillet) => self.fillet(fillet, span),
            Curve::Chamfer(chamfer) => self.chamfer(chamfer, span),
            Curve::Reverse(reverse) => {
                let parts = self.parts_of(&reverse.of)?;
                Some(parts.into_iter().map(|part| AnyCurve::Reversed(Reversed::new(part))).collect())
            }
            Curve::Transform(transform) => {
                let parts = self.parts_of(&transform.of)?;
                let map = placement(transform.scale.0, transform.rotate.value, transform.at.value);
                Some(
                    parts
                        .into_iter()
                        .map(|part| AnyCurve::Transformed(Transformed::new(part, map)))
                        .collect(),
                )
            }
            _ => self.curve(curve, span).map(|curve| vec![curve]),
        }
    }

    fn part(&mut self, part: &Part) -> Option<AnyCurve> {
        let parts = self.parts_of(&part.of)?;
        let (index, count) = (part.index.value, parts.len());
        let found = parts.into_iter().nth(index as usize);
        if found.is_none() {
            let parts = if count == 1 { "1 part".to_owned() } else { format!("{count} parts") };
            let message = format!("there is no part {index}: this curve has {parts}, counted from 0");
            let report = Diagnostic::error(Code::NoPart, message)
                .at(part.index.span, format!("0 to {}", count - 1))
                .also(part.of.span(), parts);
            self.report(report);
        }
        found
    }
}
