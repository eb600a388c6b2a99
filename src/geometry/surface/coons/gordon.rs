//! Surfaces through networks of curves.
//!
//! Sources: W. J. Gordon, Spline-blended surface interpolation through curve networks, J. Math. Mech. 18 (1969);
//! L. Piegl, W. Tiller, The NURBS Book, 2nd ed. 1997, section 10.5. Curves of one family seldom meet the others at
//! equal parameters; each is run through under a smooth parameter that does.

use glam::DVec3;
use thiserror::Error;

use super::blends::Blends;
use super::crossing::{Crossing, Sampled};
use super::rail::Rail;
use super::ring::size_of;
use super::transfinite::TransfiniteSurface;
use crate::geometry::curve::{AnyCurve, Curve};

/// How the surface goes on from curve to curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GordonBlend {
    /// Straight: a crease at each curve.
    Linear,
    /// By natural cubic splines, around a closed family by periodic ones: smooth across the curves.
    Spline,
}

/// Which family a curve belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Curves along u.
    U,
    /// Curves along v.
    V,
}

/// Why curves make no network.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum GordonError {
    /// Too few curves of a family.
    #[error("a network needs at least {least} curves of each family, found {found}")]
    Few {
        /// The family.
        family: Family,
        /// Least number.
        least: usize,
        /// Number given.
        found: usize,
    },
    /// Closed and open curves in one family.
    #[error("curve {first} is closed and curve {second} is open")]
    Mixed {
        /// The family.
        family: Family,
        /// Index of a closed curve.
        first: usize,
        /// Index of an open one.
        second: usize,
    },
    /// Curves of both families are closed.
    #[error("the curves of both families are closed")]
    BothClosed,
    /// Two curves pass each other.
    #[error("curves {u} and {v} do not meet: they pass at a distance of {distance}")]
    Apart {
        /// Index along u.
        u: usize,
        /// Index along v.
        v: usize,
        /// Least distance found, metres.
        distance: f64,
    },
    /// A curve meets the others in another order than they are given.
    #[error("curve {index} meets the curves of the other family in another order")]
    Order {
        /// The family of the curve.
        family: Family,
        /// Its index.
        index: usize,
        /// Index of the curve of the other family that is met too early.
        early: usize,
    },
}

/// Curves nearer than this share of the size of the network meet: room for curves that were fitted through common
/// points. What is left is shared out smoothly.
const MEETS: f64 = 1e-6;

/// The surface through curves along u and curves along v, each of which meets all of the other family in the order
/// in which they are given. What sticks out beyond the first and the last is left out.
///
/// # Errors
/// Where the curves are no network.
pub fn gordon(
    along_u: &[AnyCurve],
    along_v: &[AnyCurve],
    blend: GordonBlend,
) -> Result<TransfiniteSurface, GordonError> {
    let around_u = all_closed(along_u, Family::U)?;
    let around_v = all_closed(along_v, Family::V)?;
    if around_u && around_v {
        return Err(GordonError::BothClosed);
    }
    // The stations along u are the curves along v.
    few(along_v, Family::V, around_u)?;
    few(along_u, Family::U, around_v)?;
    let crossings = crossings(along_u, along_v)?;
    let places_u: Vec<Vec<f64>> =
        crossings.iter().map(|row| row.iter().map(|crossing| crossing.first).collect()).collect();
    let places_v: Vec<Vec<f64>> =
        (0..along_v.len()).map(|i| crossings.iter().map(|row| row[i].second).collect()).collect();
    let (stations_u, rails_u) = lay(along_u, &places_u, around_u, Family::U)?;
    let (stations_v, rails_v) = lay(along_v, &places_v, around_v, Family::V)?;
    let net: Vec<DVec3> =
        (0..along_v.len()).flat_map(|i| crossings.iter().map(move |row| row[i].point)).collect();
    let blends = (blends(&stations_u, around_u, blend), blends(&stations_v, around_v, blend));
    Ok(TransfiniteSurface::new(blends, net, rails_u, rails_v))
}

fn all_closed(curves: &[AnyCurve], family: Family) -> Result<bool, GordonError> {
    let closed = curves.iter().position(Curve::is_closed);
    let open = curves.iter().position(|curve| !curve.is_closed());
    match (closed, open) {
        (Some(first), Some(second)) => Err(GordonError::Mixed { family, first, second }),
        (closed, _) => Ok(closed.is_some()),
    }
}

fn few(curves: &[AnyCurve], family: Family, around: bool) -> Result<(), GordonError> {
    let least = if around { 3 } else { 2 };
    let found = curves.len();
    if found < least { Err(GordonError::Few { family, least, found }) } else { Ok(()) }
}

fn crossings(along_u: &[AnyCurve], along_v: &[AnyCurve]) -> Result<Vec<Vec<Crossing>>, GordonError> {
    let all: Vec<AnyCurve> = along_u.iter().chain(along_v).cloned().collect();
    let size = size_of(&all);
    let sampled: Vec<Sampled<'_>> = along_v.iter().map(Sampled::new).collect();
    let mut rows = Vec::with_capacity(along_u.len());
    for (u, curve) in along_u.iter().enumerate() {
        let own = Sampled::new(curve);
        let mut row = Vec::with_capacity(along_v.len());
        for (v, other) in sampled.iter().enumerate() {
            let crossing = own.nearest(other);
            if crossing.distance > MEETS * size {
                return Err(GordonError::Apart { u, v, distance: crossing.distance });
            }
            row.push(crossing);
        }
        rows.push(row);
    }
    Ok(rows)
}

/// A family of curves run through from station to station.
type Laid = (Vec<f64>, Vec<Option<Rail>>);

/// Common stations of a family from 0 to 1, and its curves under parameters that meet them.
fn lay(curves: &[AnyCurve], places: &[Vec<f64>], around: bool, family: Family) -> Result<Laid, GordonError> {
    let mut own: Vec<(AnyCurve, Vec<f64>)> = Vec::with_capacity(curves.len());
    for (index, (curve, places)) in curves.iter().zip(places).enumerate() {
        let laid = if around { once_around(curve, places) } else { from_end_to_end(curve, places) };
        own.push(laid.map_err(|early| GordonError::Order { family, index, early })?);
    }
    let count = own[0].1.len();
    let share = |places: &[f64], k: usize| (places[k] - places[0]) / (places[count - 1] - places[0]);
    let mean = |k: usize| own.iter().map(|(_, places)| share(places, k)).sum::<f64>() / own.len() as f64;
    let mut stations: Vec<f64> = (0..count).map(mean).collect();
    stations[0] = 0.0;
    stations[count - 1] = 1.0;
    let rail = |(curve, places): (AnyCurve, Vec<f64>)| {
        // A curve that meets the stations as it is keeps its own parameter.
        let even = (0..count).all(|k| (share(&places, k) - stations[k]).abs() <= 1e-9);
        let ends = [(0.0, places[0]), (1.0, places[count - 1])];
        let stops: Vec<(f64, f64)> = stations.iter().copied().zip(places).collect();
        Some(Rail::through(curve, if even { &ends } else { &stops }))
    };
    let rails = own.into_iter().map(rail).collect();
    Ok((stations, rails))
}

/// Increasing places of an open curve, turned around where they decrease; the index of the first out of order.
fn from_end_to_end(curve: &AnyCurve, places: &[f64]) -> Result<(AnyCurve, Vec<f64>), usize> {
    let falls = places[places.len() - 1] < places[0];
    let domain = curve.domain();
    let turned = |t: &f64| domain.start + (domain.end - t);
    let (curve, places) = if falls {
        (super::ring::reversed(curve.clone()), places.iter().map(turned).collect())
    } else {
        (curve.clone(), places.to_vec())
    };
    match places.windows(2).position(|pair| pair[1] <= pair[0]) {
        Some(before) => Err(before + 1),
        None => Ok((curve, places)),
    }
}

/// Increasing places around a closed curve, the first again at the end.
fn once_around(curve: &AnyCurve, places: &[f64]) -> Result<(AnyCurve, Vec<f64>), usize> {
    let domain = curve.domain();
    let span = domain.span();
    let unrolled = |places: &[f64]| {
        let start = places[0];
        let ahead = |t: &f64| if *t < start { t + span } else { *t };
        let mut all: Vec<f64> = places.iter().map(ahead).collect();
        all.push(start + span);
        all
    };
    let early = |all: &[f64]| all.windows(2).position(|pair| pair[1] <= pair[0]).map(|before| before + 1);
    let forward = unrolled(places);
    let Some(first) = early(&forward) else { return Ok((curve.clone(), forward)) };
    let mirrored: Vec<f64> = places.iter().map(|t| domain.start + (domain.end - t)).collect();
    let backward = unrolled(&mirrored);
    match early(&backward) {
        None => Ok((super::ring::reversed(curve.clone()), backward)),
        Some(_) => Err(first.min(places.len() - 1)),
    }
}

fn blends(stations: &[f64], around: bool, blend: GordonBlend) -> Blends {
    let smooth = match (blend, around) {
        (GordonBlend::Linear, _) => None,
        (GordonBlend::Spline, false) => Blends::spline(stations),
        (GordonBlend::Spline, true) => Blends::closed_spline(stations),
    };
    smooth.unwrap_or_else(|| if around { Blends::closed_chords(stations) } else { Blends::chords(stations) })
}
