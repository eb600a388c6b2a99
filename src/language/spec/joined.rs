//! Surfaces of several shapes as one skin.

use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::patch::SpokenContinuity;
use crate::language::spec::reference::ShapeReference;
use crate::language::spec::spanned::Sp;

table! {
    /// Surfaces of several shapes as one skin without cracks: sides that run along one line are cut once for all who share
    /// it, and where the skin closes it is a solid. Each surface must share a side with another one, from end to end.
    "joined" pub Joined {
        /// The surfaces: patches, Bezier triangles, Hermite, B-spline, NURBS, Coons, Gordon, ruled, translational and loft
        /// surfaces, of any mixture, each where its own `scale`, `rotate` and `at` put it and of its own material.
        of: Vec<ShapeReference> => Check::items(2);
        /// How smoothly they must join; an error names the shapes whose sides do not.
        continuity: Option<Sp<SpokenContinuity>>;
        /// How many degrees tangent planes may differ under `continuity`, and derivatives by the same share.
        continuity_angle: Sp<f64> = 0.01 => Check::within(0.0, 90.0);
    }
}
