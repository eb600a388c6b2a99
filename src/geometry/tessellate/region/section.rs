//! Where a plane cuts a quadric: conics, known by their equation alone.
//!
//! The point of a conic furthest from a chord lies on the diameter through the middle of the chord, whose direction is
//! conjugate to the chord's: so what a chord leaves out is known exactly, with one square root, whatever the conic is.
//! Source: Apollonius of Perga, Conics I and II; in coordinates G. Salmon, A Treatise on Conic Sections, 6th ed. 1879,
//! ch. X. Centers and axes serve only to tell in which order points lie on it.

use glam::{DVec2, DVec3};

use super::line::Line;
use crate::geometry::field::quadric::roots;
use crate::geometry::field::{Field, Quadric};
use crate::geometry::number::{asinh, atan2, sin_cos};

/// A plane and a quadric that it cuts.
#[derive(Clone, Copy, Debug)]
pub(in crate::geometry::tessellate) struct PlaneSection {
    pub(in crate::geometry::tessellate) quadric: Quadric,
    /// Unit normal of the plane.
    pub(in crate::geometry::tessellate) normal: DVec3,
    /// Distance of the plane from the origin along the normal.
    pub(in crate::geometry::tessellate) offset: f64,
}

/// A part of a conic between two of its points, or all of a closed one.
#[derive(Clone, Debug)]
pub(in crate::geometry::tessellate) struct Arc {
    /// Indices of the points where it begins and ends; `None` for a closed one.
    pub(in crate::geometry::tessellate) ends: Option<[usize; 2]>,
    /// Points along it, its ends included (for a closed one the first is the last), close enough for halving.
    pub(in crate::geometry::tessellate) stops: Vec<DVec3>,
}

/// Coordinates along the axes of a conic: what branch a point lies on and how far along it.
enum Order {
    /// An ellipse: angles about its center.
    Around { center: DVec2, axes: [DVec2; 2], half: DVec2 },
    /// A hyperbola: branches to both sides of its center.
    Branches { center: DVec2, axes: [DVec2; 2], half: DVec2 },
    /// Lines that cross: four rays.
    Rays { center: DVec2, axes: [DVec2; 2], half: DVec2 },
    /// A parabola or a line: one branch.
    Along(DVec2),
    /// Parallel lines to both sides of another.
    Sides { middle: DVec2, across: DVec2 },
    /// A point or nothing.
    Nothing,
}

/// The polynomial in the plane: p . A p + b . p + c.
struct Flat {
    a: [f64; 3],
    b: DVec2,
    c: f64,
}

impl PlaneSection {
    fn basis(&self) -> (DVec3, DVec3, DVec3) {
        let x = self.normal.any_orthonormal_vector();
        (x, self.normal.cross(x), self.normal * self.offset)
    }

    /// A point put into the plane.
    fn flattened(&self, point: DVec3) -> DVec3 {
        point - self.normal * (self.normal.dot(point) - self.offset)
    }

    fn flat(&self, around: DVec3) -> (Flat, [DVec3; 3]) {
        let (x, y, _) = self.basis();
        let origin = self.flattened(around);
        let moved = self.quadric.around(origin);
        let (ax, ay) = (moved.a * x, moved.a * y);
        let flat = Flat {
            a: [x.dot(ax), x.dot(ay), y.dot(ay)],
            b: DVec2::new(moved.b.dot(x), moved.b.dot(y)),
            c: moved.c,
        };
        (flat, [x, y, origin])
    }

    /// The arcs between points that lie on the conic, within about `size` of `around`; without any points the whole
    /// of an ellipse. Arcs end where one point follows the other; of a line or branch nothing beyond the last point.
    pub(in crate::geometry::tessellate) fn arcs(
        &self,
        points: &[(usize, DVec3)],
        around: DVec3,
        size: f64,
    ) -> Vec<Arc> {
        let (flat, [x, y, origin]) = self.flat(around);
        let order = flat.order(size);
        let local = |point: DVec3| DVec2::new((point - origin).dot(x), (point - origin).dot(y));
        let world = |place: DVec2| self.settled(origin + x * place.x + y * place.y);
        if points.is_empty() {
            return order
                .circuit()
                .map(|places| Arc { ends: None, stops: closed(places.map(world).to_vec()) })
                .into_iter()
                .collect();
        }
        let mut placed: Vec<(i32, f64, usize, DVec3)> = Vec::new();
        for (index, point) in points {
            let (branch, along) = order.of(local(*point));
            placed.push((branch, along, *index, *point));
            // Where two lines cross is a point of both.
            if let Order::Rays { center, .. } = &order
                && local(*point).distance(*center) <= 1e-9 * size
            {
                placed.push((1 - branch, along, *index, *point));
            }
        }
        placed.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut arcs = Vec::new();
        for branch in placed.chunk_by(|a, b| a.0 == b.0) {
            for pair in branch.windows(2) {
                arcs.push(self.arc(&order, &pair[0], &pair[1], 0.0, &world));
            }
            if let Order::Around { .. } = order {
                let turn = 2.0 * core::f64::consts::PI;
                arcs.push(self.arc(&order, &branch[branch.len() - 1], &branch[0], turn, &world));
            }
        }
        arcs
    }

    fn arc(
        &self,
        order: &Order,
        from: &(i32, f64, usize, DVec3),
        to: &(i32, f64, usize, DVec3),
        beyond: f64,
        world: &dyn Fn(DVec2) -> DVec3,
    ) -> Arc {
        let mut stops = vec![from.3];
        stops.extend(order.between(from.1, to.1 + beyond).into_iter().map(world));
        stops.push(to.3);
        Arc { ends: Some([from.2, to.2]), stops }
    }
}

fn closed(mut points: Vec<DVec3>) -> Vec<DVec3> {
    points.push(points[0]);
    points
}

impl Line for PlaneSection {
    fn bulge(&self, from: DVec3, to: DVec3) -> (DVec3, f64) {
        let chord = to - from;
        let middle = (from + to) / 2.0;
        let pull = self.quadric.a * chord;
        let direction = self.normal.cross(pull);
        let length = direction.length();
        let straight = (middle, 0.0);
        let bent = self.quadric.bent(chord);
        // A chord on a straight line of the quadric has its own direction as the conjugate one: nothing is left out.
        let flat = bent.abs() <= 1e-13 * pull.length() * chord.length();
        if flat || length <= 1e-14 * pull.length() || chord == DVec3::ZERO {
            return straight;
        }
        let direction = direction / length;
        let (a, b) = (self.quadric.bent(direction), self.quadric.gradient(middle).dot(direction));
        // At the middle the value is that of the chord alone: both ends lie on the conic.
        let c = -bent / 4.0;
        let found = roots(a, b, c).into_iter().min_by(|s, t| s.abs().total_cmp(&t.abs()));
        let Some(step) = found else { return straight };
        let top = middle + direction * step;
        let along = chord.normalize();
        let away = top - middle;
        (top, (away - along * away.dot(along)).length())
    }

    fn settled(&self, point: DVec3) -> DVec3 {
        let mut point = self.flattened(point);
        for _ in 0..4 {
            let gradient = self.quadric.gradient(point);
            let within = gradient - self.normal * gradient.dot(self.normal);
            let length = within.length();
            if length == 0.0 {
                break;
            }
            let direction = within / length;
            let all = roots(self.quadric.bent(direction), length, self.quadric.value(point));
            let Some(step) = all.into_iter().min_by(|s, t| s.abs().total_cmp(&t.abs())) else { break };
            let next = self.flattened(point + direction * step);
            if next == point {
                break;
            }
            point = next;
        }
        point
    }
}

/// Shares of a size below which coefficients of a conic are zero, as for quadrics.
const VANISHES: f64 = 1e-9;

impl Flat {
    fn order(&self, size: f64) -> Order {
        let [xx, xy, yy] = self.a;
        // Principal axes in the plane.
        let turn = 0.5 * atan2(2.0 * xy, xx - yy);
        let (sin, cos) = sin_cos(turn);
        let axes = [DVec2::new(cos, sin), DVec2::new(-sin, cos)];
        let value = |axis: DVec2| xx * axis.x * axis.x + 2.0 * xy * axis.x * axis.y + yy * axis.y * axis.y;
        let l = axes.map(value);
        let most = l[0].abs().max(l[1].abs());
        let terms = (most * size * size).max(self.b.length() * size);
        let flat = l.map(|l| l.abs() * size * size <= VANISHES * terms);
        match flat {
            [false, false] => self.central(axes, l, size),
            [true, true] => Order::Along(DVec2::new(-self.b.y, self.b.x).normalize_or(DVec2::X)),
            [first, _] => {
                // One square, along `across`.
                let (across, along, square) =
                    if first { (axes[1], axes[0], l[1]) } else { (axes[0], axes[1], l[0]) };
                if (self.b.dot(along) * size).abs() > VANISHES * terms {
                    return Order::Along(across);
                }
                let middle = across * (-self.b.dot(across) / (2.0 * square));
                Order::Sides { middle, across }
            }
        }
    }

    fn central(&self, axes: [DVec2; 2], l: [f64; 2], size: f64) -> Order {
        let shift = [0, 1].map(|k| -self.b.dot(axes[k]) / (2.0 * l[k]));
        let center = axes[0] * shift[0] + axes[1] * shift[1];
        let n = self.c + self.b.dot(center) / 2.0;
        let half = |k: usize| (n / l[k]).abs().sqrt();
        if l[0] * l[1] > 0.0 {
            let half = DVec2::new(half(0), half(1));
            return if n * l[0] < 0.0 { Order::Around { center, axes, half } } else { Order::Nothing };
        }
        let terms =
            self.c.abs() + self.b.length() * center.length() + l[0].abs().max(l[1].abs()) * size * size;
        if n.abs() <= 1e-14 * terms {
            let half = DVec2::new(l[1].abs().sqrt(), l[0].abs().sqrt());
            return Order::Rays { center, axes, half };
        }
        // The first axis goes through the branches.
        let k = usize::from(n * l[0] > 0.0);
        Order::Branches { center, axes: [axes[k], axes[1 - k]], half: DVec2::new(half(k), half(1 - k)) }
    }
}

impl Order {
    /// The branch of a place near the conic and how far along it that is.
    fn of(&self, place: DVec2) -> (i32, f64) {
        let local = |center: &DVec2, axes: &[DVec2; 2], half: &DVec2| {
            DVec2::new((place - *center).dot(axes[0]), (place - *center).dot(axes[1])) / *half
        };
        match self {
            Self::Around { center, axes, half } => {
                let at = local(center, axes, half);
                (0, atan2(at.y, at.x))
            }
            Self::Branches { center, axes, half } => {
                let at = local(center, axes, half);
                (if at.x < 0.0 { -1 } else { 1 }, asinh(at.y))
            }
            Self::Rays { center, axes, half } => {
                let at = local(center, axes, half);
                // Along the two lines y = x and y = -x, from end to end through the center.
                if at.x * at.y >= 0.0 { (0, at.x + at.y) } else { (1, at.x - at.y) }
            }
            Self::Along(along) => (0, place.dot(*along)),
            Self::Sides { middle, across } => {
                let along = DVec2::new(-across.y, across.x);
                (if (place - *middle).dot(*across) < 0.0 { -1 } else { 1 }, place.dot(along))
            }
            Self::Nothing => (0, 0.0),
        }
    }

    /// Places between two that halving cannot find by itself: on an ellipse one for each quarter turn or less.
    fn between(&self, from: f64, to: f64) -> Vec<DVec2> {
        let Self::Around { center, axes, half } = self else { return Vec::new() };
        let pieces =
            crate::geometry::number::floor_count(((to - from) / core::f64::consts::FRAC_PI_2).ceil()).max(1);
        let at = |k: u32| {
            let (sin, cos) = sin_cos(from + (to - from) * f64::from(k) / f64::from(pieces));
            *center + axes[0] * (cos * half.x) + axes[1] * (sin * half.y)
        };
        (1..pieces).map(at).collect()
    }

    /// Four places around an ellipse.
    fn circuit(&self) -> Option<[DVec2; 4]> {
        let Self::Around { center, axes, half } = self else { return None };
        let (x, y) = (axes[0] * half.x, axes[1] * half.y);
        Some([*center + x, *center + y, *center - x, *center - y])
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::PlaneSection;
    use crate::geometry::field::{Field, Quadric};
    use crate::geometry::tessellate::region::line::{Cut, Line, stations};

    fn unit_sphere() -> Quadric {
        Quadric::new(DVec3::ONE, DVec3::ZERO, DVec3::ZERO, -1.0)
    }

    #[test]
    fn what_a_chord_leaves_out_is_exact() {
        let section = PlaneSection { quadric: unit_sphere(), normal: DVec3::Z, offset: 0.6 };
        let (a, b) = (DVec3::new(0.8, 0.0, 0.6), DVec3::new(0.0, 0.8, 0.6));
        let (top, out) = section.bulge(a, b);
        assert!((out - 0.8 * (1.0 - core::f64::consts::FRAC_1_SQRT_2)).abs() < 1e-15);
        assert!(unit_sphere().value(top).abs() < 1e-15 && (top.z - 0.6).abs() < 1e-15);
    }

    #[test]
    fn stations_stay_on_the_conic_and_within_the_tolerance() {
        let cone = Quadric::new(DVec3::new(1.0, 2.0, -1.0), DVec3::new(0.3, 0.0, 0.1), DVec3::ZERO, 0.0);
        let normals = [
            DVec3::Z,
            DVec3::X,
            DVec3::new(1.0, 0.2, 1.0).normalize(),
            DVec3::new(0.3, 1.0, -0.4).normalize(),
        ];
        for normal in normals {
            let section = PlaneSection { quadric: cone, normal, offset: 0.7 };
            // Points of the conic where lines in the plane meet it.
            let x = normal.any_orthonormal_vector();
            let y = normal.cross(x);
            let mut points = Vec::new();
            for k in -2..=2 {
                let origin = normal * 0.7 + y * (0.31 * f64::from(k) + 0.02);
                points.extend(cone.on_line(origin, x).into_iter().map(|t| origin + x * t));
            }
            let indexed: Vec<_> =
                points.iter().copied().enumerate().filter(|(_, p)| p.length() < 4.0).collect();
            for arc in section.arcs(&indexed, DVec3::ZERO, 4.0) {
                for tolerance in [1e-2, 1e-4] {
                    let found = stations(&section, &arc.stops, Cut::Within(tolerance), 1 << 20).unwrap();
                    for pair in found.windows(2) {
                        assert!(
                            cone.value(pair[0]).abs() < 1e-13 && (normal.dot(pair[0]) - 0.7).abs() < 1e-13
                        );
                        let (top, out) = section.bulge(pair[0], pair[1]);
                        assert!(out <= tolerance && cone.value(top).abs() < 1e-12, "{normal} {out}");
                    }
                    let fewest = found.len() as f64 - 1.0;
                    let sum: f64 = stations(&section, &arc.stops, Cut::Within(tolerance / 100.0), 1 << 20)
                        .unwrap()
                        .windows(2)
                        .map(|pair| section.bulge(pair[0], pair[1]).1.sqrt())
                        .sum();
                    assert!(
                        fewest <= 1.1 * sum / tolerance.sqrt() + 2.0,
                        "{fewest} for {}",
                        sum / tolerance.sqrt()
                    );
                }
            }
        }
    }
}
