//! The nearest point of a surface near known parameters.

use glam::DVec3;

use super::Window;
use crate::geometry::curve::{Domain, Side};
use crate::geometry::number::Bounds;
use crate::geometry::surface::{AnySurface, Rim, Surface, SurfaceJet, closed_directions};

/// A surface with what the search for its nearest points needs to know of it.
#[derive(Clone, Debug)]
pub(super) struct Field {
    surface: Box<AnySurface>,
    u: Domain,
    v: Domain,
    /// Where tangents jump, with both ends of the domain.
    stops: (Vec<f64>, Vec<f64>),
    /// Whether opposite rims of u, and of v, are one line.
    closed: [bool; 2],
    /// Points along each side, evenly in its parameter, and a box around all of them.
    rims: [[DVec3; RIM_POINTS]; 4],
    reach: Bounds,
}

/// Points along a side: between two of them a side is taken to come near a place only once.
const RIM_POINTS: usize = 17;

/// Share of a patch's size within which a written vertex lies on a side: some units of single precision.
const ON_RIM: f64 = 3e-6;

/// A rectangle of parameters on which a surface is smooth.
struct Piece {
    u: Domain,
    v: Domain,
}

impl Piece {
    /// The surface as this piece sees it.
    fn jet(&self, surface: &AnySurface, u: f64, v: f64) -> SurfaceJet {
        let side = |t: f64, end: f64| if t >= end { Side::Before } else { Side::After };
        surface.sided((u, side(u, self.u.end)), (v, side(v, self.v.end)))
    }
}

/// Corners on both sides of a seam: those after it count from the end of the domain on.
fn unwrapped(values: [f64; 3], domain: Domain, closed: bool) -> [f64; 3] {
    let low = values.into_iter().fold(f64::INFINITY, f64::min);
    let high = values.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let half = domain.span() / 2.0;
    if !closed || high - low <= half {
        return values;
    }
    values.map(|value| if value < domain.start + half { value + domain.span() } else { value })
}

fn wrap(value: f64, domain: Domain) -> f64 {
    if value > domain.end { value - domain.span() } else { value }
}

impl Field {
    pub(super) fn new(surface: &AnySurface) -> Self {
        let (u, v) = (surface.domain_u(), surface.domain_v());
        let rims = [[DVec3::ZERO; RIM_POINTS]; 4];
        let with_ends = |joints: Vec<f64>, domain: Domain| {
            let mut stops = vec![domain.start];
            stops.extend(joints);
            stops.push(domain.end);
            stops
        };
        let stops = (with_ends(surface.joints_u(), u), with_ends(surface.joints_v(), v));
        let surface = Box::new(surface.clone());
        let closed = closed_directions(&surface);
        let mut field = Self { surface, u, v, stops, closed, rims, reach: Bounds::EMPTY };
        field.rims = Rim::ALL
            .map(|rim| std::array::from_fn(|k| field.rim_point(rim, k as f64 / (RIM_POINTS - 1) as f64)));
        field.reach = Bounds::of_points(field.rims.iter().flatten().copied());
        field
    }

    fn rim_uv(&self, rim: Rim, share: f64) -> (f64, f64) {
        let (x, y) = rim.place(share);
        (self.u.at(x), self.v.at(y))
    }

    fn rim_point(&self, rim: Rim, share: f64) -> DVec3 {
        let (u, v) = self.rim_uv(rim, share);
        self.jet(u, v).point
    }

    /// The surface.
    pub(super) fn surface(&self) -> &AnySurface {
        &self.surface
    }

    /// Whether u, and v, come round.
    pub(super) fn closed(&self) -> [bool; 2] {
        self.closed
    }

    /// Whether parameters are those of a side.
    pub(super) fn on_rim(&self, (u, v): (f64, f64)) -> bool {
        [self.u.start, self.u.end].contains(&u) || [self.v.start, self.v.end].contains(&v)
    }

    /// Parameters of a point that lies on a side but for rounding.
    pub(super) fn rim_place(&self, point: DVec3) -> Option<(f64, f64)> {
        let size = self.reach.diagonal();
        // Between their points sides bulge by less than a tenth of their size, or come back.
        let beyond = (self.reach.min - point).max(point - self.reach.max).max_element();
        if beyond > 0.1 * size {
            return None;
        }
        let nearest = Rim::ALL.into_iter().zip(&self.rims).map(|(rim, points)| {
            let share = self.nearest_share(rim, points, point);
            (self.rim_point(rim, share).distance(point), self.rim_uv(rim, share))
        });
        let (away, place) = nearest.min_by(|a, b| a.0.total_cmp(&b.0))?;
        (away <= ON_RIM * size.max(point.length())).then_some(place)
    }

    /// The share of a side nearest to a point: by golden sections from the nearest of its points.
    fn nearest_share(&self, rim: Rim, points: &[DVec3; RIM_POINTS], point: DVec3) -> f64 {
        const GOLDEN: f64 = 0.618_033_988_749_895;
        let last = (RIM_POINTS - 1) as f64;
        let best = (0..RIM_POINTS)
            .min_by(|a, b| points[*a].distance_squared(point).total_cmp(&points[*b].distance_squared(point)));
        let best = best.unwrap_or(0) as f64;
        let (mut low, mut high) = ((best - 1.0).max(0.0) / last, (best + 1.0).min(last) / last);
        let away = |share: f64| self.rim_point(rim, share).distance_squared(point);
        for _ in 0..40 {
            let (a, b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
            if away(a) <= away(b) {
                high = b;
            } else {
                low = a;
            }
        }
        let middle = f64::midpoint(low, high);
        [low, high].into_iter().fold(middle, |best, next| if away(next) < away(best) { next } else { best })
    }

    /// Distance from a point to the nearest point found on the surface around the parameters of a triangle. Never
    /// less than the distance to the whole surface.
    pub(super) fn distance(&self, point: DVec3, window: &Window) -> f64 {
        let corners_u = unwrapped(window.u, self.u, self.closed[0]);
        let corners_v = unwrapped(window.v, self.v, self.closed[1]);
        let middle = |values: [f64; 3]| values.iter().sum::<f64>() / 3.0;
        // The middle leads there but for triangles across an edge of the surface.
        let starts = [
            (middle(corners_u), middle(corners_v)),
            (corners_u[0], corners_v[0]),
            (corners_u[1], corners_v[1]),
            (corners_u[2], corners_v[2]),
        ];
        let mut best = f64::INFINITY;
        // A triangle lies in one smooth piece, and its corners on the borders of that one.
        let own = self.piece(wrap(starts[0].0, self.u), wrap(starts[0].1, self.v));
        for (u, v) in starts {
            let (u, v) = (wrap(u, self.u), wrap(v, self.v));
            best = best.min(self.descend(point, (u, v), &own));
            for (u, v) in self.across_seams(u, v) {
                best = best.min(self.descend(point, (u, v), &self.piece(u, v)));
            }
        }
        best
    }

    fn jet(&self, u: f64, v: f64) -> SurfaceJet {
        (Piece { u: self.u, v: self.v }).jet(&self.surface, u, v)
    }

    /// The smooth piece around a place.
    fn piece(&self, u: f64, v: f64) -> Piece {
        let around = |stops: &[f64], value: f64| {
            let next = stops.partition_point(|stop| *stop <= value).clamp(1, stops.len() - 1);
            Domain { start: stops[next - 1], end: stops[next] }
        };
        Piece { u: around(&self.stops.0, u), v: around(&self.stops.1, v) }
    }

    /// Starts at the other side of a seam, for places near it.
    fn across_seams(&self, u: f64, v: f64) -> Vec<(f64, f64)> {
        /// Share of the domain that is near.
        const NEAR: f64 = 0.02;
        let mut starts = Vec::new();
        let across = |value: f64, domain: Domain| {
            let margin = NEAR * domain.span();
            if value <= domain.start + margin {
                Some(domain.end)
            } else if value >= domain.end - margin {
                Some(domain.start)
            } else {
                None
            }
        };
        if let Some(u) = across(u, self.u).filter(|_| self.closed[0]) {
            starts.push((u, v));
        }
        if let Some(v) = across(v, self.v).filter(|_| self.closed[1]) {
            starts.push((u, v));
        }
        starts
    }

    /// Gauss and Newton's method, inside a piece: on a rim the other parameter goes its own way.
    fn descend(&self, point: DVec3, (u, v): (f64, f64), piece: &Piece) -> f64 {
        let mut best = f64::INFINITY;
        let clamp = |value: f64, domain: Domain| value.clamp(domain.start, domain.end);
        let (mut u, mut v) = (clamp(u, piece.u), clamp(v, piece.v));
        for _ in 0..12 {
            let jet = piece.jet(&self.surface, u, v);
            let away = point - jet.point;
            let found = away.length();
            if found >= best * (1.0 - 1e-9) {
                return best.min(found);
            }
            best = found;
            let (a, b, c) = (jet.du.length_squared(), jet.du.dot(jet.dv), jet.dv.length_squared());
            let (x, y) = (away.dot(jet.du), away.dot(jet.dv));
            let determinant = a * c - b * b;
            if determinant <= 1e-18 * a * c {
                // At a pole only one parameter moves the point.
                if a >= c && a > 0.0 {
                    u = clamp(u + x / a, piece.u);
                } else if c > 0.0 {
                    v = clamp(v + y / c, piece.v);
                }
                continue;
            }
            let next = (u + (x * c - y * b) / determinant, v + (y * a - x * b) / determinant);
            let inside = (clamp(next.0, piece.u), clamp(next.1, piece.v));
            (u, v) = match (inside.0 == next.0, inside.1 == next.1) {
                (true, false) => (clamp(u + (x - b * (inside.1 - v)) / a, piece.u), inside.1),
                (false, true) => (inside.0, clamp(v + (y - b * (inside.0 - u)) / c, piece.v)),
                _ => inside,
            };
        }
        best
    }
}

/// After which parameters u and v of a surface come round again; infinite where they do not.
pub(super) fn periods(surface: &AnySurface) -> (f64, f64) {
    let field = Field::new(surface);
    let round = |closed: bool, domain: Domain| if closed { domain.span() } else { f64::INFINITY };
    (round(field.closed[0], field.u), round(field.closed[1], field.v))
}
