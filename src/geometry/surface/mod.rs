//! Surfaces: points, tangents and normals over two parameters.
//!
//! Promise: each surface is continuous over its domain, its tangents are the derivatives of its points, and
//! its normal is the unit cross product of the tangents, or at a pole the limit. Not promised: that the
//! surface does not cross itself.

mod any;
mod closed;
pub mod coons;
mod deformation;
mod deformed_path;
mod extruded;
mod formula;
mod frame;
mod joint;
mod limit;
mod lofted;
mod matching;
mod measure;
mod placed;
mod revolved;
mod rim;
mod ruled;
mod second;
mod swept;
pub mod tensor;
mod thick;
mod translational;
pub mod triangle;

pub use any::AnySurface;
pub use closed::closed_directions;
pub use deformation::{AxialDeformation, AxialKind, Deformation, Warped};
pub use deformed_path::{Line, PathDeformation};
pub use extruded::ExtrudedSurface;
pub use formula::{Closing, FormulaSurface, SurfaceFault};
pub use frame::{Carry, Frame, FrameField, FrameRule};
pub use joint::{PatchContinuity, Smoothness, SurfaceJoint, SurfaceJoints, SurfaceLine, joints};
pub use lofted::{Across, CrossEnd, LoftedSurface};
pub use matching::{MatchError, Matching, matched};
pub use measure::{SurfaceMeasures, measure};
pub use placed::PlacedSurface;
pub use revolved::RevolvedSurface;
pub use rim::Rim;
pub use ruled::{RuledSurface, gathered};
pub use second::{SecondJet, SecondRange};
pub use swept::{
    Carrier, Change, Law, Matched, Mix, Outline, Plane, Screw, Section, SectionPoint, Slope, Spot, Stand,
    Stations, SweptSurface, SweptWall,
};
pub use thick::{ThickSide, thickened};
pub use translational::TranslationalSurface;

use glam::DVec3;

use super::curve::{Domain, Side};

/// Point and first derivatives of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceJet {
    /// Position, metres.
    pub point: DVec3,
    /// Derivative by u.
    pub du: DVec3,
    /// Derivative by v.
    pub dv: DVec3,
    /// Unit normal, outward.
    pub normal: DVec3,
}

/// A parametric surface.
pub trait Surface: Send + Sync {
    /// Interval of u.
    fn domain_u(&self) -> Domain;

    /// Interval of v.
    fn domain_v(&self) -> Domain;

    /// Point, tangents and normal from one side in each parameter: they differ where the surface has an edge or a
    /// seam. Parameters outside the domain are taken as the nearer end.
    fn sided(&self, u: (f64, Side), v: (f64, Side)) -> SurfaceJet;

    /// The same with the sides after the parameters, at the ends of the domain before them.
    #[inline]
    fn evaluate(&self, u: f64, v: f64) -> SurfaceJet {
        let side = |t: f64, domain: Domain| if t >= domain.end { Side::Before } else { Side::After };
        self.sided((u, side(u, self.domain_u())), (v, side(v, self.domain_v())))
    }

    /// Second derivatives from one side in each parameter. Where a surface knows no better, differences of its
    /// tangents, good to about five digits.
    fn second(&self, u: (f64, Side), v: (f64, Side)) -> SecondJet {
        second::by_differences(self, u, v)
    }

    /// Boxes that hold the second derivatives everywhere on a rectangle of parameters, for proofs; none where no
    /// bound is known. No joint may cross the inside of the rectangle.
    fn second_range(&self, _u: (f64, f64), _v: (f64, f64)) -> Option<SecondRange> {
        None
    }

    /// Jets wherever one of the places `u` crosses one of `v`, row by row: first all `u` at the first `v`. Where the cost
    /// of a surface lies in its lines, the places on a line share it.
    fn lattice(&self, u: &[(f64, Side)], v: &[(f64, Side)]) -> Vec<SurfaceJet> {
        v.iter().flat_map(|v| u.iter().map(|u| self.sided(*u, *v))).collect()
    }

    /// [`Surface::second_range`] of all rectangles between intervals `u` and intervals `v`, row by row in the same way;
    /// none where one of them has none.
    fn second_ranges(&self, u: &[(f64, f64)], v: &[(f64, f64)]) -> Option<Vec<SecondRange>> {
        v.iter().flat_map(|v| u.iter().map(|u| self.second_range(*u, *v))).collect()
    }

    /// Values of u strictly inside the domain, increasing, where tangents may jump: lines of u = constant that a
    /// mesh must keep as edges.
    fn joints_u(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The same for v.
    fn joints_v(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Values of u strictly inside the domain, increasing, where pieces meet: the joints, and where higher
    /// derivatives may jump.
    fn breaks_u(&self) -> Vec<f64> {
        self.joints_u()
    }

    /// The same for v.
    fn breaks_v(&self) -> Vec<f64> {
        self.joints_v()
    }
}
