//! Outlines pushed along z into solids with flat ends.
//!
//! The walls are straight along z, so the deviation of the solid is that of its outlines' chords: the whole
//! tolerance goes into them and the bound is proved.

use glam::{DVec2, DVec3};

use super::bevel::{EdgeProfile, bevel};
use super::cap::{CapLoop, Facing, add_cap, twice_area};
use super::discretize::{Density, Station, arc_lengths, discretize};
use super::ring::{Row, RowKind, stitch};
use super::{Detail, Deviation, Evidence, SurfaceDensity, TessellateError, Tessellation};
use crate::geometry::curve::AnyCurve;
use crate::geometry::mesh;
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex};

/// Closed outlines in the xy plane with holes, pushed from z = `bottom` to `bottom` + `height`.
#[derive(Clone, Debug, PartialEq)]
pub struct Extrusion {
    /// For each island its outline, then its holes; any sense of turning.
    pub outlines: Vec<AnyCurve>,
    /// How many of the outlines belong to each island, in order.
    pub islands: Vec<usize>,
    /// Least z, metres.
    pub bottom: f64,
    /// Height, more than zero.
    pub height: f64,
    /// Whether the two flat ends are made.
    pub caps: bool,
    /// How the walls lean, where they do; its heights are those of the extrusion.
    pub edge: Option<EdgeProfile>,
}

/// One outline, cut and turned so that the outside is to its right.
pub(super) struct Outline {
    pub(super) stations: Vec<Station>,
    pub(super) along: Vec<f64>,
}

/// Pushes outlines into triangles. Anchor sources: wall k is k, the lower end comes after the walls, then the
/// upper end.
///
/// # Errors
/// When the limit would be passed, an outline encloses no area, or an end cannot be triangulated.
pub fn extrude(shape: &Extrusion, detail: &Detail) -> Result<Tessellation, TessellateError> {
    if let Some(profile) = &shape.edge {
        return bevel(shape, profile, detail);
    }
    let layers = match detail.density {
        SurfaceDensity::Grid { v, .. } => v.max(1),
        SurfaceDensity::Tolerance(_) => 1,
    };
    if let SurfaceDensity::Grid { u, v } = detail.density {
        detail.allow(2 * u64::from(u) * u64::from(v) * shape.outlines.len() as u64)?;
    }
    let mut outlines = Vec::new();
    let mut needed = 0;
    let firsts = firsts(&shape.islands);
    for (index, curve) in shape.outlines.iter().enumerate() {
        let outline = cut(curve, !firsts.contains(&index), detail)?;
        needed += 2 * (outline.stations.len() as u64 - 1) * (u64::from(layers) + 1);
        if needed > detail.triangle_limit {
            return Err(TessellateError::TooMany { needed, limit: detail.triangle_limit });
        }
        outlines.push(outline);
    }
    let mut mesh = Mesh::default();
    let mut ends = (Vec::new(), Vec::new());
    for (source, outline) in outlines.iter().enumerate() {
        let points =
            wall(&mut mesh, shape, outline, &WallDetail { layers, source: mesh::index(source), detail });
        let place: Vec<DVec2> = flat(&outline.stations);
        ends.0.push(CapLoop { place: place.clone(), points: points.0 });
        ends.1.push(CapLoop { place, points: points.1 });
    }
    if shape.caps {
        let source = mesh::index(outlines.len());
        let (down, up) =
            (Facing { normal: DVec3::NEG_Z, mirrored: true }, Facing { normal: DVec3::Z, mirrored: false });
        for (first, count) in firsts.iter().zip(&shape.islands) {
            let island = *first..first + count;
            add_cap(&mut mesh, &ends.0[island.clone()], down, source, detail.uv)?;
            add_cap(&mut mesh, &ends.1[island], up, source + 1, detail.uv)?;
        }
    }
    mesh.runs = vec![Run { origin: 0, end: mesh::index(mesh.triangles.len()) }];
    let stations = outlines.iter().flat_map(|outline| &outline.stations);
    let bound = stations.map(|station| station.deviation).fold(0.0, f64::max);
    let evidence = if bound == 0.0 { Evidence::Exact } else { Evidence::Proved };
    Ok(Tessellation { mesh, deviation: Deviation { bound, evidence } })
}

/// Where each island begins among the outlines.
pub(super) fn firsts(islands: &[usize]) -> Vec<usize> {
    let mut next = 0;
    let begin = |count: &usize| {
        next += count;
        next - count
    };
    islands.iter().map(begin).collect()
}

pub(super) fn flat(stations: &[Station]) -> Vec<DVec2> {
    stations[..stations.len() - 1].iter().map(|station| station.point.truncate()).collect()
}

pub(super) fn cut(curve: &AnyCurve, hole: bool, detail: &Detail) -> Result<Outline, TessellateError> {
    let density = match detail.density {
        SurfaceDensity::Tolerance(tolerance) => Density::Tolerance(tolerance),
        SurfaceDensity::Grid { u, .. } => Density::Count(u.max(3)),
    };
    let mut stations = discretize(curve, density, detail.triangle_limit)?;
    let area = twice_area(&flat(&stations));
    if stations.len() < 4 || area == 0.0 {
        return Err(TessellateError::NoArea);
    }
    let lengths = if detail.uv { arc_lengths(curve, &stations) } else { vec![0.0; stations.len()] };
    let whole = lengths[lengths.len() - 1].max(f64::MIN_POSITIVE);
    let mut along: Vec<f64> = lengths.iter().map(|length| length / whole).collect();
    if (area < 0.0) != hole {
        reverse(&mut stations);
        along = along.iter().rev().map(|length| 1.0 - length).collect();
    }
    Ok(Outline { stations, along })
}

pub(super) fn reverse(stations: &mut [Station]) {
    stations.reverse();
    let deviations: Vec<f64> =
        stations.iter().skip(1).map(|station| station.deviation).chain([0.0]).collect();
    for (station, deviation) in stations.iter_mut().zip(deviations) {
        (station.before, station.after) = (-station.after, -station.before);
        station.deviation = deviation;
    }
}

struct WallDetail<'a> {
    layers: u32,
    source: u32,
    detail: &'a Detail,
}

/// Makes the wall of one outline; gives the points of its lower and upper end.
fn wall(
    mesh: &mut Mesh,
    shape: &Extrusion,
    outline: &Outline,
    wall: &WallDetail<'_>,
) -> (Vec<PointIndex>, Vec<PointIndex>) {
    let count = mesh::index(outline.stations.len()) - 1;
    let base = mesh::index(mesh.points.len());
    let height = |layer: u32| f64::from(layer) / f64::from(wall.layers);
    for layer in 0..=wall.layers {
        let z = shape.bottom + shape.height * height(layer);
        mesh.points.extend(outline.stations[..count as usize].iter().map(|s| s.point.truncate().extend(z)));
    }
    for run in smooth_runs(outline, wall.detail) {
        let mut below: Option<Row> = None;
        for layer in 0..=wall.layers {
            let row = Row { base: mesh::index(mesh.vertices.len()), steps: run.steps(), kind: run.kind };
            for k in run.from..=run.to - u32::from(run.kind == RowKind::Round) {
                let station = &outline.stations[k as usize];
                let part = height(layer);
                mesh.vertices.push(Vertex {
                    point: PointIndex(base + layer * count + k % count),
                    normal: run.normal(station, k),
                    uv: if wall.detail.uv {
                        DVec2::new(outline.along[k as usize], 1.0 - part)
                    } else {
                        DVec2::ZERO
                    },
                    color: Color::WHITE,
                    anchor: Anchor { source: wall.source, u: station.t, v: shape.height * part },
                });
            }
            if let Some(lower) = below {
                stitch(&lower, &row, &mut mesh.triangles);
            }
            below = Some(row);
        }
    }
    let ring = |layer: u32| (0..count).map(|k| PointIndex(base + layer * count + k)).collect();
    (ring(0), ring(wall.layers))
}

/// Stations between two hard edges; their wall shares its vertices.
struct SmoothRun {
    from: u32,
    to: u32,
    kind: RowKind,
    hard: (bool, bool),
}

impl SmoothRun {
    fn steps(&self) -> u32 {
        self.to - self.from
    }

    fn normal(&self, station: &Station, k: u32) -> DVec3 {
        let outward = |direction: DVec3| DVec3::new(direction.y, -direction.x, 0.0);
        let direction = if k == self.from && self.hard.0 {
            station.after
        } else if k == self.to && self.hard.1 {
            station.before
        } else {
            (station.before + station.after).normalize_or(station.after)
        };
        outward(direction).normalize_or(DVec3::X)
    }
}

/// Splits a closed outline at its hard edges, and without texture coordinates nowhere else.
fn smooth_runs(outline: &Outline, detail: &Detail) -> Vec<SmoothRun> {
    let last = mesh::index(outline.stations.len()) - 1;
    let hard = |k: u32| outline.stations[k as usize].turn() > detail.crease_angle;
    let mut stops: Vec<u32> = (1..last).filter(|k| hard(*k)).collect();
    if stops.is_empty() && !hard(0) && !detail.uv {
        return vec![SmoothRun { from: 0, to: last, kind: RowKind::Round, hard: (false, false) }];
    }
    stops.insert(0, 0);
    stops.push(last);
    let run = |pair: &[u32]| SmoothRun {
        from: pair[0],
        to: pair[1],
        kind: RowKind::Open,
        hard: (hard(pair[0]), hard(pair[1])),
    };
    stops.windows(2).map(run).collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{Extrusion, extrude};
    use crate::geometry::curve::{AnyCurve, EllipseArc, Polyline};
    use crate::geometry::tessellate::{Detail, SurfaceDensity};

    #[test]
    fn square_with_a_round_hole_has_the_expected_counts() {
        let corners = [(0.0, 0.0), (0.0, 2.0), (2.0, 2.0), (2.0, 0.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
        let shape = Extrusion {
            outlines: vec![
                AnyCurve::Polyline(Polyline::new(corners.to_vec(), true).unwrap()),
                AnyCurve::Ellipse(EllipseArc::full(DVec3::new(1.0, 1.0, 0.0), 0.5, 0.5)),
            ],
            islands: vec![2],
            bottom: 0.0,
            height: 1.0,
            caps: true,
            edge: None,
        };
        let detail = Detail {
            density: SurfaceDensity::Tolerance(0.01),
            crease_angle: 30.0,
            uv: false,
            triangle_limit: 1 << 20,
        };
        let made = extrude(&shape, &detail).unwrap();
        let around = (made.mesh.points.len() - 8) / 2;
        // Walls 2 each, ends with one hole: corners + 2 (holes) - 2 triangles each.
        assert_eq!(made.mesh.triangles.len(), 8 + 2 * around + 2 * (4 + around));
        assert_eq!(made.mesh.vertices.len(), 16 + 2 * around + 2 * (4 + around));
        assert!(made.deviation.bound <= 0.01 && made.deviation.bound > 0.005);
    }
}
