//! Lines of sight in the space of a surface: where a place of the picture is, so far away.

use glam::{DAffine3, DVec2, DVec3};

use crate::geometry::number::Bounds;
use crate::preview::camera::{Camera, Projection};

/// Lines of sight under a map. A point is linear in the place, and in how far away it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rays {
    origin: DVec3,
    /// Of length 1 in space: how far away counts along the way that the camera looks.
    ahead: DVec3,
    /// For one pixel, at distance 1 where lines meet in the eye.
    across: DVec3,
    down: DVec3,
    meet: bool,
}

/// A part of the picture, in pixels, over an interval of distances.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub(super) low: DVec2,
    pub(super) high: DVec2,
    pub(super) near: f64,
    pub(super) far: f64,
}

impl Rays {
    /// Those of a camera under a map from space.
    pub(super) fn new(camera: &Camera, back: &DAffine3) -> Self {
        let (origin, [ahead, across, down], meet) = camera.lines();
        let turned = |vector: DVec3| back.transform_vector3(vector);
        Self {
            origin: back.transform_point3(origin),
            ahead: turned(ahead),
            across: turned(across),
            down: turned(down),
            meet,
        }
    }

    fn side(&self, place: DVec2) -> DVec3 {
        self.across * place.x + self.down * place.y
    }

    /// The line through a place: its point at distance 0, and what is added for a distance of 1.
    pub(super) fn line(&self, place: DVec2) -> (DVec3, DVec3) {
        let side = self.side(place);
        if self.meet { (self.origin, self.ahead + side) } else { (self.origin + side, self.ahead) }
    }

    /// Boxes around the points of a block, and around what is added to them for a distance of 1.
    pub(super) fn around(&self, block: &Block) -> (Bounds, Bounds) {
        let (low, high) = (block.low, block.high);
        let corners = [low, DVec2::new(high.x, low.y), DVec2::new(low.x, high.y), high];
        let (mut points, mut ways) = (Bounds::EMPTY, Bounds::EMPTY);
        for (start, way) in corners.map(|corner| self.line(corner)) {
            points = points.with_point(start + way * block.near).with_point(start + way * block.far);
            ways = ways.with_point(way);
        }
        (points, ways)
    }

    /// Bounds on how much a value changes from the middle of a pixel to any place in it, at no more than a distance, by bounds on
    /// the sizes of its derivatives.
    pub(super) fn beside(&self, slopes: DVec3, far: f64) -> f64 {
        let far = if self.meet { far } else { 1.0 };
        0.5 * far * (self.across.abs() + self.down.abs()).dot(slopes) * (1.0 + 1e-12)
    }

    /// What [`Camera::depth`] says of a distance.
    pub(super) fn depth(&self, away: f64) -> f64 {
        if self.meet { -1.0 / away } else { away }
    }

    /// The size of a block across, and along the lines.
    pub(super) fn size(&self, block: &Block) -> (f64, f64) {
        let far = if self.meet { block.far } else { 1.0 };
        let extent = block.high - block.low;
        let across = (self.across.length() * extent.x).max(self.down.length() * extent.y) * far;
        (across, self.ahead.length() * (block.far - block.near))
    }
}

impl Camera {
    /// A point of its lines of sight, and what is added to it: ahead, and for one pixel to the right and down; whether lines
    /// meet in that point, so that all three count for a distance of 1.
    fn lines(&self) -> (DVec3, [DVec3; 3], bool) {
        let meet = self.projection() == Projection::Perspective;
        let at = |x: f64, y: f64| self.plane(DVec2::new(x, y));
        let (corner, right, below) = (at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0));
        let (across, down) = (right - corner, below - corner);
        let ahead = -self.axes().z_axis;
        if meet {
            (self.eye(), [ahead + corner, across, down], true)
        } else {
            (self.eye() + corner, [ahead, across, down], false)
        }
    }
}
