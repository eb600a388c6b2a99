//! Where a picture is taken from.

use glam::{DMat3, DVec2, DVec3};

use super::asset::Lens;
use super::stage::Eye;
use crate::geometry::number::{Bounds, cos_degrees, hypot, sin_cos, sin_cos_degrees, tan_degrees};

/// How space becomes a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Projection {
    /// What is far away is smaller.
    #[default]
    Perspective,
    /// Parallel lines stay parallel.
    Orthographic,
}

/// From where: degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Turned around the vertical from the front (z), towards the right side (x).
    pub azimuth: f64,
    /// Raised above the horizon, -90 to 90.
    pub elevation: f64,
}

impl View {
    /// Views with names.
    pub const NAMED: [(&'static str, Self); 7] = [
        ("front", Self { azimuth: 0.0, elevation: 0.0 }),
        ("right", Self { azimuth: 90.0, elevation: 0.0 }),
        ("back", Self { azimuth: 180.0, elevation: 0.0 }),
        ("left", Self { azimuth: 270.0, elevation: 0.0 }),
        ("top", Self { azimuth: 0.0, elevation: 90.0 }),
        ("bottom", Self { azimuth: 0.0, elevation: -90.0 }),
        ("corner", Self { azimuth: 35.0, elevation: 22.0 }),
    ];
}

/// A camera: looks along its own -z, its x goes to the right of the picture and its y up.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    projection: Projection,
    /// Its axes, in space.
    axes: DMat3,
    /// Where it stands; for an orthographic one a point of the middle of its picture.
    eye: DVec3,
    /// Pixels of the picture for one unit at distance 1, or for one meter when orthographic.
    scale: f64,
    /// The middle of the picture, in pixels.
    center: DVec2,
    /// The nearest and the farthest that is seen; `None` where everything lies before the eye.
    range: Option<(f64, f64)>,
}

/// Half of the angle that a perspective picture spans where it is narrower, in degrees.
const HALF_ANGLE: f64 = 15.0;

/// Share of the picture that stays free around what is shown.
const MARGIN: f64 = 0.06;

/// How far beyond its borders a picture through a camera of a file keeps what it is made of, times its half size.
const BEYOND: f64 = 1.25;

/// Where the eye stands in a box, the share of that box's size from which on pixels are measured.
const NEAREST: f64 = 0.01;

/// Corners of the polygon that stands for a circle.
const RIM: u32 = 64;

/// A place in a picture: pixels from the upper left corner, and how far away, growing with distance. Straight lines
/// in space are straight in these three.
pub(super) type Projected = DVec3;

impl Camera {
    /// A camera that looks from `view` and has all `points` as large in its picture of `size` pixels as they fit, with a
    /// margin.
    #[must_use]
    pub fn around(
        view: View,
        projection: Projection,
        points: impl Iterator<Item = DVec3> + Clone,
        size: (u32, u32),
    ) -> Self {
        let axes = axes(view);
        let pixels = DVec2::new(size.0.into(), size.1.into());
        let free = pixels * (1.0 - 2.0 * MARGIN);
        let center = pixels / 2.0;
        let own = points.map(|point| axes.transpose() * point);
        match projection {
            Projection::Orthographic => {
                let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
                own.for_each(|point| (low, high) = (low.min(point.truncate()), high.max(point.truncate())));
                if low.x > high.x {
                    (low, high) = (DVec2::NEG_ONE, DVec2::ONE);
                }
                let extent = high - low;
                let fits = (free / extent.max(DVec2::splat(f64::MIN_POSITIVE))).min_element();
                let scale = if fits.is_finite() { fits } else { free.min_element() };
                let eye = axes * ((low + high) / 2.0).extend(0.0);
                Self { projection, axes, eye, scale, center, range: None }
            }
            Projection::Perspective => {
                let scale = free.min_element() / 2.0 / tan_degrees(HALF_ANGLE);
                // Everything lies within four planes through the eye.
                let half = free / 2.0 / scale;
                let (mut left, mut right, mut down, mut up) =
                    (f64::INFINITY, f64::INFINITY, f64::INFINITY, f64::INFINITY);
                let mut near = f64::NEG_INFINITY;
                own.for_each(|point| {
                    left = left.min(point.x - point.z * half.x);
                    right = right.min(-point.x - point.z * half.x);
                    down = down.min(point.y - point.z * half.y);
                    up = up.min(-point.y - point.z * half.y);
                    near = near.max(point.z);
                });
                if !near.is_finite() {
                    (left, right, down, up, near) = (-1.0, -1.0, -1.0, -1.0, 0.0);
                }
                // An eye at (x, y, z) sees a point if |px - x| <= (z - pz) half; the nearest eye by both is taken.
                let back = (-(left + right) / (2.0 * half.x)).max(-(down + up) / (2.0 * half.y));
                let eye = DVec3::new((left - right) / 2.0, (down - up) / 2.0, back);
                let room = (back - near).max(0.0);
                // What is flat and stands on edge must not touch the eye.
                let eye = eye + DVec3::Z * if room > 0.0 { 0.0 } else { 1.0 };
                Self { projection, axes, eye: axes * eye, scale, center, range: None }
            }
        }
    }

    /// A turntable's camera: it looks at the middle of a box, from a distance at which all of it is in the picture from
    /// every side.
    #[must_use]
    pub fn turning(bounds: &Bounds, view: View, projection: Projection, size: (u32, u32)) -> Self {
        // The box, turned about its middle, stays within a cylinder; that is seen alike from all sides.
        let middle = bounds.center();
        let half = (bounds.max - bounds.min) / 2.0;
        let radius = hypot(half.x, half.z);
        let rim = move |k: u32| {
            let (sine, cosine) = sin_cos_degrees(360.0 / f64::from(RIM) * f64::from(k) + view.azimuth);
            // Corners of the polygon around the circle.
            let out = radius / cos_degrees(180.0 / f64::from(RIM));
            DVec3::new(sine * out, 0.0, cosine * out) + middle
        };
        let points = (0..RIM).flat_map(move |k| [rim(k) - DVec3::Y * half.y, rim(k) + DVec3::Y * half.y]);
        Self::around(view, projection, points, size)
    }

    /// A camera of a file, as a picture of `size` pixels sees through it: its upright angle fills the height. `None` where its
    /// node has no size, or its lens sees nothing.
    #[must_use]
    pub fn through(eye: &Eye, size: (u32, u32)) -> Option<Self> {
        let back = eye.world.z_axis.truncate().try_normalize()?;
        let up = eye.world.y_axis.truncate().reject_from_normalized(back).try_normalize()?;
        let pixels = DVec2::new(size.0.into(), size.1.into());
        let (projection, half, near, far) = match eye.lens {
            Lens::Perspective { upright, near, far } => {
                let (sine, cosine) = sin_cos(upright / 2.0);
                (Projection::Perspective, sine / cosine, near, far.unwrap_or(f64::INFINITY))
            }
            Lens::Orthographic { half, near, far } => (Projection::Orthographic, half.abs(), near, far),
        };
        let perspective = projection == Projection::Perspective;
        let sees = half > 0.0 && half.is_finite() && far > near && (near > 0.0 || !perspective);
        sees.then(|| Self {
            projection,
            axes: DMat3::from_cols(up.cross(back), up, back),
            eye: eye.world.w_axis.truncate(),
            scale: pixels.y / 2.0 / half,
            center: pixels / 2.0,
            range: Some((near, far)),
        })
    }

    /// What is seen of a polygon, as its corners; of a line, its ends. All of it for a camera that has everything before it.
    /// Polygons that share an edge share what is left of it.
    ///
    /// Source: I. Sutherland, G. Hodgman, Reentrant Polygon Clipping, CACM 1974.
    #[must_use]
    pub(super) fn seen(&self, points: &[DVec3]) -> Vec<DVec3> {
        let Some((near, far)) = self.range else { return points.to_vec() };
        let mut own: Vec<DVec3> =
            points.iter().map(|&point| self.axes.transpose() * (point - self.eye)).collect();
        // A polygon is cut off a little beyond the borders, so that borders show no cuts.
        let half = self.center / self.scale * BEYOND;
        let side = |along: f64, half: f64, away: f64| match self.projection {
            Projection::Perspective => half * away - along,
            Projection::Orthographic => half - along,
        };
        let planes: [&dyn Fn(DVec3) -> f64; 6] = [
            &|point| -point.z - near,
            &|point| far - -point.z,
            &|point| side(point.x, half.x, -point.z),
            &|point| side(-point.x, half.x, -point.z),
            &|point| side(point.y, half.y, -point.z),
            &|point| side(-point.y, half.y, -point.z),
        ];
        for plane in planes {
            let mut kept = Vec::with_capacity(own.len() + 1);
            for (number, &point) in own.iter().enumerate() {
                let next = own[(number + 1) % own.len()];
                let (here, there) = (plane(point), plane(next));
                if here >= 0.0 {
                    kept.push(point);
                }
                if (here >= 0.0) != (there >= 0.0) {
                    // From the end inside to that outside, whichever way the edge runs.
                    let (a, b, inside, outside) =
                        if here >= 0.0 { (point, next, here, there) } else { (next, point, there, here) };
                    kept.push(a + (b - a) * (inside / (inside - outside)));
                }
            }
            own = kept;
        }
        own.into_iter().map(|point| self.eye + self.axes * point).collect()
    }

    /// The place of a point; `None` behind the eye, or too near to it.
    #[must_use]
    pub(super) fn project(&self, point: DVec3) -> Option<Projected> {
        let own = self.axes.transpose() * (point - self.eye);
        match self.projection {
            Projection::Orthographic => {
                let plane = DVec2::new(own.x, -own.y) * self.scale + self.center;
                Some(plane.extend(-own.z))
            }
            Projection::Perspective => {
                let away = -own.z;
                // Behind the eye, or where digits end.
                if away <= 0.0 || away < 1e-9 * own.length() {
                    return None;
                }
                let plane = DVec2::new(own.x, -own.y) * (self.scale / away) + self.center;
                // Planes of space are planes in -1 / distance.
                Some(plane.extend(-1.0 / away))
            }
        }
    }

    /// How far away a point is: meters along the way the camera looks when orthographic, else -1 / that. Infinite behind
    /// the eye.
    #[must_use]
    pub fn depth(&self, point: DVec3) -> f64 {
        self.project(point).map_or(f64::INFINITY, |place| place.z)
    }

    /// The point that is seen at a place of the picture, as far away as its third number says.
    #[must_use]
    pub fn point(&self, place: DVec3) -> DVec3 {
        let (start, along) = self.sight(place.truncate());
        let away = match self.projection {
            Projection::Orthographic => place.z,
            // The depth counts along the middle of the picture.
            Projection::Perspective => -1.0 / place.z / -along.dot(self.axes.z_axis),
        };
        start + along * away
    }

    /// The line of sight through a place of the picture: a point on it, and its direction of length 1.
    #[must_use]
    pub fn sight(&self, place: DVec2) -> (DVec3, DVec3) {
        let plane = (place - self.center) / self.scale;
        let across = DVec2::new(plane.x, -plane.y);
        match self.projection {
            Projection::Orthographic => (self.eye + self.axes * across.extend(0.0), -self.axes.z_axis),
            Projection::Perspective => (self.eye, self.axes * across.extend(-1.0).normalize()),
        }
    }

    /// How space becomes its picture.
    #[must_use]
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// Where it stands; of an orthographic one a point in the middle of what it sees.
    pub(super) fn eye(&self) -> DVec3 {
        self.eye
    }

    /// How far a line of sight lies beside the middle one, at distance 1 where they meet in the eye.
    pub(super) fn plane(&self, place: DVec2) -> DVec3 {
        let plane = (place - self.center) / self.scale;
        self.axes * DVec3::new(plane.x, -plane.y, 0.0)
    }

    /// How far away a point is along the way the camera looks.
    pub(super) fn away(&self, point: DVec3) -> f64 {
        -self.axes.z_axis.dot(point - self.eye)
    }

    /// The distances along that way that are seen.
    pub(super) fn seen_range(&self) -> (f64, f64) {
        self.range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY))
    }

    /// The least length that a pixel spans on what is in a box, before the camera.
    #[must_use]
    pub fn pixel(&self, bounds: &Bounds) -> f64 {
        match self.projection {
            Projection::Orthographic => 1.0 / self.scale,
            Projection::Perspective => {
                let nearest = bounds
                    .corners()
                    .map(|corner| self.away(corner))
                    .into_iter()
                    .fold(f64::INFINITY, f64::min);
                let (near, _) = self.seen_range();
                nearest.max(near).max(NEAREST * bounds.diagonal()) / self.scale
            }
        }
    }

    /// Towards the eye from a point, of length 1.
    #[must_use]
    pub fn towards(&self, point: DVec3) -> DVec3 {
        match self.projection {
            Projection::Orthographic => self.axes.z_axis,
            Projection::Perspective => (self.eye - point).normalize_or(self.axes.z_axis),
        }
    }

    /// Its axes in space: right, up, and back towards the eye.
    #[must_use]
    pub fn axes(&self) -> DMat3 {
        self.axes
    }
}

fn axes(view: View) -> DMat3 {
    let ((sine, cosine), (up, out)) = (sin_cos_degrees(view.azimuth), sin_cos_degrees(view.elevation));
    let right = DVec3::new(cosine, 0.0, -sine);
    let back = DVec3::new(sine * out, up, cosine * out);
    DMat3::from_cols(right, back.cross(right), back)
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DVec2, DVec3};

    use super::{Camera, MARGIN, Projection, View};
    use crate::geometry::number::{Bounds, sin_cos};
    use crate::preview::asset::Lens;
    use crate::preview::{Eye, Stage, Vertex, depths};

    fn corners() -> Vec<DVec3> {
        (0..8).map(|k| DVec3::new((k & 1) as f64, (k >> 1 & 1) as f64 * 3.0, (k >> 2) as f64 * 0.5)).collect()
    }

    #[test]
    fn everything_is_in_the_picture_and_touches_its_margin() {
        let size = (400, 300);
        for projection in [Projection::Perspective, Projection::Orthographic] {
            for (name, view) in View::NAMED {
                let camera = Camera::around(view, projection, corners().into_iter(), size);
                let places: Vec<DVec3> =
                    corners().into_iter().map(|point| camera.project(point).unwrap()).collect();
                let free = |total: u32| {
                    let total = f64::from(total);
                    (total * MARGIN, total * (1.0 - MARGIN))
                };
                let (across, down) = (free(size.0), free(size.1));
                let low = places.iter().fold(DVec2::INFINITY, |low, place| low.min(place.truncate()));
                let high = places.iter().fold(DVec2::NEG_INFINITY, |high, place| high.max(place.truncate()));
                let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
                assert!(low.x > across.0 - 1e-9 && high.x < across.1 + 1e-9, "{name}: {low} {high}");
                assert!(low.y > down.0 - 1e-9 && high.y < down.1 + 1e-9, "{name}: {low} {high}");
                let fills = near(low.x, across.0) && near(high.x, across.1)
                    || near(low.y, down.0) && near(high.y, down.1);
                assert!(fills, "{name}: {low} {high}");
            }
        }
    }

    #[test]
    fn a_line_of_sight_goes_through_what_is_seen_there() {
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let view = View { azimuth: 35.0, elevation: 22.0 };
            let camera = Camera::around(view, projection, corners().into_iter(), (640, 480));
            for point in corners() {
                let place = camera.project(point).unwrap();
                let (start, along) = camera.sight(place.truncate());
                let off = (point - start).reject_from_normalized(along).length();
                assert!(off < 1e-9, "{off}");
                assert!((camera.towards(point) + along).length() < 1e-9);
                assert!(camera.point(place).distance(point) < 1e-9);
            }
        }
    }

    #[test]
    fn the_front_is_seen_from_z_and_right_is_x() {
        let camera =
            Camera::around(View::NAMED[0].1, Projection::Orthographic, corners().into_iter(), (100, 100));
        let at = |point: DVec3| camera.project(point).unwrap();
        assert!(at(DVec3::X).x > at(DVec3::ZERO).x, "x goes to the right");
        assert!(at(DVec3::Y).y < at(DVec3::ZERO).y, "y goes up");
        assert!(at(DVec3::Z).z < at(DVec3::ZERO).z, "z comes nearer");
    }

    /// A file's camera at the origin of a scene turned about y by `turn` degrees.
    fn eye(lens: Lens, turn: f64) -> Eye {
        Eye { name: "eye".to_owned(), world: DMat4::from_rotation_y(turn.to_radians()), lens }
    }

    #[test]
    fn the_lens_of_a_file_spans_the_height_of_the_picture() {
        let lens = Lens::Perspective { upright: 1.2, near: 0.1, far: None };
        let camera = Camera::through(&eye(lens, 90.0), (300, 200)).unwrap();
        // It looks along -x; z runs to the left.
        let (sine, cosine) = sin_cos(0.6);
        let half = sine / cosine;
        let at = |point: DVec3| camera.project(point).unwrap().truncate();
        assert!(at(DVec3::new(-5.0, 5.0 * half, 0.0)).distance(DVec2::new(150.0, 0.0)) < 1e-9);
        assert!(at(DVec3::new(-5.0, 0.0, 7.5 * half)).distance(DVec2::new(0.0, 100.0)) < 1e-9);
        let lens = Lens::Orthographic { half: 2.0, near: 0.1, far: 10.0 };
        let camera = Camera::through(&eye(lens, 0.0), (300, 200)).unwrap();
        let at = |point: DVec3| camera.project(point).unwrap().truncate();
        assert!(at(DVec3::new(3.0, -2.0, -5.0)).distance(DVec2::new(300.0, 200.0)) < 1e-9);
        let flat = Eye { world: DMat4::from_scale(DVec3::new(1.0, 1.0, 0.0)), ..eye(lens, 0.0) };
        assert!(Camera::through(&flat, (300, 200)).is_none());
    }

    #[test]
    fn a_ground_that_reaches_behind_the_eye_is_seen_to_the_horizon() {
        // Two triangles a kilometer wide, a meter below the eye.
        let corner = |x: f64, z: f64| Vertex {
            point: DVec3::new(x, -1.0, z),
            normal: DVec3::Y,
            tangent: [0.0; 4],
            uvs: [[0.0; 2]; 2],
            color: [1.0; 4],
        };
        let stage = Stage {
            vertices: vec![
                corner(-500.0, -500.0),
                corner(500.0, -500.0),
                corner(500.0, 500.0),
                corner(-500.0, 500.0),
            ],
            triangles: vec![[0, 2, 1], [0, 3, 2]],
            lines: Vec::new(),
            pieces: Vec::new(),
            materials: Vec::new(),
            bounds: Bounds::of_points([]),
            heat: None,
            eyes: Vec::new(),
        };
        let (upright, near, far) = (1.0, 0.5, 40.0);
        for turn in [0.0, 33.0, 200.0] {
            let lens = Lens::Perspective { upright, near, far: Some(far) };
            let camera = Camera::through(&eye(lens, turn), (80, 60)).unwrap();
            let depths = depths(&stage, &camera, (80, 60));
            let (sine, cosine) = sin_cos(upright / 2.0);
            let slope = sine / cosine / 30.0;
            for row in 0..60_u8 {
                let down = (f64::from(row) + 0.5 - 30.0) * slope;
                let away = 1.0 / down;
                for column in 0..80_usize {
                    let found = f64::from(depths[usize::from(row) * 80 + column]);
                    if down > 0.0 && away > near && away < far {
                        // Places are rounded to 1/256 of a pixel.
                        assert!(
                            (-1.0 / found - away).abs() < away * 0.02,
                            "{turn} {row} {column}: {found} {away}"
                        );
                    } else {
                        assert!(found.is_infinite(), "{turn} {row} {column}: {found} {away}");
                    }
                }
            }
        }
    }
}
