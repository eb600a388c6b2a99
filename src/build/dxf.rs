//! Curves of drawings into curves of the kernel.

use glam::{DAffine3, DVec3, DVec4};

use super::Builder;
use crate::geometry::curve::control::{BSpline, Knots};
use crate::geometry::curve::{
    AnyCurve, EllipseArc, Parametrization, Path, Polyline, RationalSpline, Reversed, interpolate, parameters,
};
use crate::import::dxf::{self, Drawn, DxfFault, Piece};
use crate::import::{self, ImportError};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::Dxf;

impl Builder<'_> {
    /// The curves of a drawing.
    pub(super) fn dxf(&mut self, written: &Dxf, span: Span) -> Option<Vec<AnyCurve>> {
        let file = &written.file;
        let bytes = self.bytes_of(file)?;
        let read = dxf::drawing(&bytes).map_err(|fault| match import::recognize(&bytes) {
            Some(foreign) if fault == DxfFault::NotDxf => ImportError::Foreign(foreign),
            _ => fault.into(),
        });
        let drawing = read.map_err(|error| self.refused(file, &error)).ok()?;
        if let Some(layer) = written.layer.as_ref().filter(|layer| !drawing.layers.contains(&layer.value)) {
            let error = ImportError::UnknownGroup { group: layer.value.clone(), known: drawing.layers };
            self.refused(file, &error);
            return None;
        }
        let layer = written.layer.as_ref().map(|layer| layer.value.as_str());
        let (drawn, notes) = drawing.curves(layer, written.join.value);
        self.tell_notes(file, &notes);
        let scale = DAffine3::from_scale(DVec3::splat(written.scale.value));
        let map = scale * DAffine3::from_translation(-written.origin.value.extend(0.0));
        let mut parts = Vec::new();
        for one in &drawn {
            parts.push(self.drawn(one, &map, span)?);
        }
        if parts.is_empty() {
            let message = format!("{} draws no line or curve", file.value.written);
            let report = Diagnostic::error(Code::UnknownPart, message).at(file.span, "nothing to follow");
            self.report(report.help("import its faces with `[shape.NAME.import]`"));
            return None;
        }
        Some(parts)
    }

    fn drawn(&mut self, drawn: &Drawn, map: &DAffine3, span: Span) -> Option<AnyCurve> {
        let mut curves = Vec::with_capacity(drawn.pieces.len());
        for (piece, back) in &drawn.pieces {
            let curve = self.piece(piece, map, span)?;
            curves.push(if *back { AnyCurve::Reversed(Reversed::new(curve)) } else { curve });
        }
        if let ([_], false) | ([AnyCurve::Ellipse(_)], true) = (curves.as_slice(), drawn.closed) {
            return curves.pop();
        }
        let path = if drawn.closed { Path::closed(curves) } else { Path::new(curves) };
        path.map(AnyCurve::Path)
    }

    fn piece(&mut self, piece: &Piece, map: &DAffine3, span: Span) -> Option<AnyCurve> {
        let point = |point: &DVec3| map.transform_point3(*point);
        match piece {
            Piece::Line(from, to) => {
                Polyline::new(vec![point(from), point(to)], false).map(AnyCurve::Polyline)
            }
            Piece::Arc { center, x, y, angles } => Some(AnyCurve::Ellipse(EllipseArc {
                center: point(center),
                x: map.transform_vector3(*x),
                y: map.transform_vector3(*y),
                from: angles.x,
                to: angles.y,
            })),
            Piece::Spline { degree, knots, points, weights } => {
                let knots = match Knots::new(*degree, knots.clone()) {
                    Ok(knots) => knots,
                    Err(error) => return self.degenerate(&error.to_string(), span),
                };
                let weighted = points.iter().map(point).zip(weights);
                let points: Vec<DVec4> =
                    weighted.map(|(point, weight)| RationalSpline::homogeneous(point, *weight)).collect();
                match BSpline::new(knots, points) {
                    Some(spline) => {
                        let (points, breaks) = spline.to_bezier();
                        self.rational(*degree, points, breaks, span)
                    }
                    None => self.degenerate("a spline of the drawing has too few points", span),
                }
            }
            Piece::Through(points) => {
                let points: Vec<DVec3> = points.iter().map(point).collect();
                match parameters(&points, false, Parametrization::Chordal) {
                    Ok(numbers) => self.made(interpolate(&points, &numbers), span),
                    Err(error) => self.degenerate(&error.to_string(), span),
                }
            }
        }
    }
}
