//! SVG paths of a document into curves of the kernel.

use glam::{DMat2, DVec2, DVec3};

use crate::geometry::curve::{AnyCurve, BezierSpline, EllipseArc, Path, Polyline};
use crate::geometry::number::{atan2, sin_cos_degrees};
use crate::language::spec::{Subpath, Svg, SvgArc, SvgSegment};

/// The parts of an SVG path, in the order of the text.
pub(super) fn svg(svg: &Svg) -> Vec<AnyCurve> {
    let up = if svg.y_up.value { 1.0 } else { -1.0 };
    let drawing = Drawing { origin: svg.origin.value, scale: DVec2::new(1.0, up) * svg.scale.value };
    svg.d.subpaths.iter().filter_map(|subpath| drawing.subpath(subpath)).collect()
}

/// From the coordinates of the drawing to those of the document.
struct Drawing {
    origin: DVec2,
    scale: DVec2,
}

impl Drawing {
    fn point(&self, point: DVec2) -> DVec3 {
        ((point - self.origin) * self.scale).extend(0.0)
    }

    fn vector(&self, vector: DVec2) -> DVec3 {
        (vector * self.scale).extend(0.0)
    }

    fn subpath(&self, subpath: &Subpath) -> Option<AnyCurve> {
        let mut current = subpath.start;
        let mut curves = Vec::new();
        for segment in &subpath.segments {
            curves.extend(self.segment(current, segment));
            current = segment.end();
        }
        let path = if subpath.closed { Path::closed(curves) } else { Path::new(curves) };
        path.map(AnyCurve::Path)
    }

    fn segment(&self, start: DVec2, segment: &SvgSegment) -> Option<AnyCurve> {
        let bezier = |points: &[DVec2]| {
            let mut all = vec![self.point(start)];
            all.extend(points.iter().map(|point| self.point(*point)));
            BezierSpline::new(points.len(), all).ok().map(AnyCurve::Bezier)
        };
        match segment {
            SvgSegment::Line(end) => {
                Polyline::new(vec![self.point(start), self.point(*end)], false).map(AnyCurve::Polyline)
            }
            SvgSegment::Quadratic(points) => bezier(points),
            SvgSegment::Cubic(points) => bezier(points),
            SvgSegment::Arc(arc) => Some(AnyCurve::Ellipse(self.arc(start, arc))),
        }
    }

    /// The arc by its center: W3C, SVG 2, 2018, appendix B.2.4, in a frame in which the ellipse is the unit circle.
    fn arc(&self, start: DVec2, arc: &SvgArc) -> EllipseArc {
        let (sin, cos) = sin_cos_degrees(arc.rotation);
        let turn = DMat2::from_cols(DVec2::new(cos, sin), DVec2::new(-sin, cos));
        // Half the way back from the end to the start, as seen from the ellipse.
        let half = turn.transpose() * (start - arc.end) / (2.0 * arc.radii);
        let reach = half.length();
        // Radii that do not reach are stretched until they just do: then the center is in the middle.
        let stretch = reach.max(1.0);
        let half = half / stretch;
        // Rounding under the root would move that center by the root of it.
        let away =
            if reach >= 1.0 { 0.0 } else { (1.0 - half.length_squared()).max(0.0).sqrt() / half.length() };
        let side = if arc.large == arc.sweep { -1.0 } else { 1.0 };
        let center = DVec2::new(half.y, -half.x) * (away * side);
        let angle = |place: DVec2| atan2(place.y, place.x).to_degrees();
        let (from, to) = (angle(half - center), angle(-half - center));
        let mut sweep = to - from;
        if arc.sweep && sweep <= 0.0 {
            sweep += 360.0;
        } else if !arc.sweep && sweep >= 0.0 {
            sweep -= 360.0;
        }
        let radii = arc.radii * stretch;
        let middle = (start + arc.end) / 2.0 + turn * (center * radii);
        EllipseArc {
            center: self.point(middle),
            x: self.vector(turn.x_axis * radii.x),
            y: self.vector(turn.y_axis * radii.y),
            from,
            to: from + sweep,
        }
    }
}
