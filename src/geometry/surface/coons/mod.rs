//! Surfaces through whole curves: Coons patches with four sides and fewer, Gordon surfaces over networks.
//!
//! Promise: the surface holds its curves, each to rounding; derivatives are exact; bounds on second derivatives
//! are proved where those of the curves are. Not promised: that a patch does not fold, which depends on its curves.

mod blends;
mod crossing;
mod gordon;
mod gregory;
mod rail;
mod ring;
mod sided;
#[cfg(test)]
mod tests;
mod three;
mod transfinite;

pub use gordon::{Family, GordonBlend, GordonError, gordon};
pub use rail::Rail;
pub use ring::{Gap, ring};
pub use sided::{CoonsBlend, CoonsError, CoonsSide, CoonsSides, Twist, coons};
pub use three::ThreeSidedSurface;
pub use transfinite::TransfiniteSurface;
