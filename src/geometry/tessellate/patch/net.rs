//! Blocks into triangles that share their edges, each within the tolerance.

use glam::DVec3;
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};

use super::density::Density;
use super::judge::{judge, judge_chord};
use super::lattice::Lattice;
use super::layout::{Block, Edge, Layout, Rim};
use super::plan::Plan;
use super::rows::{Corner, Cut, Free, Piece, weave};
use crate::geometry::mesh::index;
use crate::geometry::number::{acos, floor_large};
use crate::geometry::tessellate::{Detail, Deviation, Evidence, SurfaceDensity, TessellateError};

/// Triangles of all blocks on common points.
pub(super) struct Net<'a> {
    pub(super) layout: Layout<'a>,
    pub(super) points: Vec<DVec3>,
    pub(super) pieces: Vec<Piece>,
    /// Whether the grids of all blocks are given.
    fixed: bool,
    /// For each piece its lattice, if it is one.
    lattices: Vec<Option<Lattice>>,
    pub(super) deviation: Deviation,
    /// For each edge, degrees by which normals jump across it; 180 at borders.
    pub(super) turns: Vec<f64>,
}

/// What a triangle leaves out.
#[derive(Clone, Copy)]
pub(super) struct Judged {
    pub(super) bound: f64,
    pub(super) evidence: Evidence,
    /// How far each side bends away; side k lies opposite of corner k.
    pub(super) sides: [f64; 3],
}

/// Normals that jump by more degrees than this make an edge a line of its own, which keeps the tolerance by itself.
/// Smooth constructions leave about 1e-6.
const FEATURE: f64 = 0.01;

/// Rounds in which the densities are put right by what the triangles say.
const ROUNDS: usize = 3;

/// Triangles of a block that are asked what they need.
const ASKED: usize = 33;

/// Edges or blocks that one thread takes at once.
const AT_ONCE: usize = 4;

/// Share of the triangles that the plan itself is to bring under the tolerance; the rest are refined.
const PLANNED: f64 = 0.95;

impl<'a> Net<'a> {
    pub(super) fn new(layout: Layout<'a>, detail: &Detail) -> Result<Self, TessellateError> {
        let turns = layout.edges.par_iter().with_min_len(AT_ONCE).map(|edge| turn(&layout, edge)).collect();
        let mut plans = plans(&layout, detail)?;
        let fixed = matches!(detail.density, SurfaceDensity::Grid { .. });
        let (points, pieces, lattices) = (Vec::new(), Vec::new(), Vec::new());
        let mut net = Self { layout, points, pieces, fixed, lattices, deviation: Deviation::NONE, turns };
        let SurfaceDensity::Tolerance(tolerance) = detail.density else {
            net.weave(&plans, detail)?;
            net.deviation = net.measure();
            return Ok(net);
        };
        // A block whose triangles say that its plan is right is not asked again: what neighbors change is its rim.
        let mut right = vec![false; plans.len()];
        for round in 0..ROUNDS {
            net.weave(&plans, detail)?;
            detail.allow(net.triangles())?;
            if round + 1 == ROUNDS {
                break;
            }
            let factor = |(block, right): (usize, &bool)| {
                if *right { 1.0 } else { net.correction(block, &plans[block], tolerance) }
            };
            let factors: Vec<f64> = right.par_iter().enumerate().map(factor).collect();
            right = factors.iter().map(|factor| *factor == 1.0).collect();
            if right.iter().all(|right| *right) {
                break;
            }
            plans.iter_mut().zip(factors).for_each(|(plan, factor)| plan.scale(factor));
        }
        net.deviation = super::refine::refine(&mut net, tolerance, detail)?;
        Ok(net)
    }

    pub(super) fn triangles(&self) -> u64 {
        self.pieces.iter().map(|piece| piece.triangles.len() as u64).sum()
    }

    /// Cuts all edges and fills all blocks.
    fn weave(&mut self, plans: &[Plan], detail: &Detail) -> Result<(), TessellateError> {
        self.points = self.layout.nodes.clone();
        let cuts: Result<Vec<Cut>, _> =
            (0..self.layout.edges.len()).map(|edge| self.cut(edge, plans, detail)).collect();
        let cuts = cuts?;
        self.pieces = Vec::with_capacity(plans.len());
        self.lattices.clear();
        for (block, plan) in self.layout.blocks.iter().zip(plans) {
            let rims = Rim::ALL.map(|rim| {
                let used = block.edge(rim);
                let mut cut = cuts[used.edge].clone();
                if used.backward {
                    cut.points.reverse();
                    cut.fractions = cut.fractions.iter().rev().map(|fraction| 1.0 - fraction).collect();
                }
                cut
            });
            let lattice = if self.fixed { Lattice::new(block, plan, &rims) } else { None };
            let piece = if let Some(lattice) = &lattice {
                lattice.piece(block, &rims, &mut self.points)
            } else {
                let mut next = index(self.points.len());
                let mut piece = weave(block, plan, &rims, &mut next);
                place(&mut self.points, block, &mut piece);
                piece
            };
            self.lattices.push(lattice);
            self.pieces.push(piece);
        }
        Ok(())
    }

    /// Cuts an edge as finely as any of its sides needs it. Every piece of it will have a triangle.
    fn cut(&mut self, number: usize, plans: &[Plan], detail: &Detail) -> Result<Cut, TessellateError> {
        let edge = &self.layout.edges[number];
        if edge.pole {
            return Ok(Cut { fractions: vec![0.5], points: vec![edge.ends[0]] });
        }
        let feature = self.turns[number] > FEATURE;
        let mut density: Option<Density> = None;
        for (block, rim) in &edge.uses {
            let plan = &plans[*block];
            let mut own = plan.along(*rim);
            if feature {
                own = own.max(&plan.chords[*rim as usize]);
            }
            if self.layout.blocks[*block].edge(*rim).backward {
                own = own.reversed();
            }
            density = Some(density.map_or(own.clone(), |density| density.max(&own)));
        }
        // An edge that comes back to its start encloses something only with three points.
        let least = if edge.ends[0] == edge.ends[1] { 3 } else { 1 };
        let density = density.unwrap_or_else(|| Density::even(1.0));
        detail.allow(floor_large(density.total()))?;
        let fractions = density.stations(least);
        let (owner, rim) = edge.uses[0];
        let block = &self.layout.blocks[owner];
        let mut points = vec![edge.ends[0]];
        for fraction in &fractions[1..fractions.len() - 1] {
            let (u, v) = block.at(rim.place(*fraction));
            points.push(index(self.points.len()));
            self.points.push(block.jet(u, v).point);
        }
        points.push(edge.ends[1]);
        Ok(Cut { fractions, points })
    }

    /// The factor by which the densities of a block miss what its triangles need.
    fn correction(&self, block: usize, plan: &Plan, tolerance: f64) -> f64 {
        let piece = &self.pieces[block];
        // Every so many of them say as much. The number is odd: triangles of one cell stand side by side in the list.
        let apart = piece.triangles.len().div_ceil(ASKED) | 1;
        let mut ratios: Vec<f64> = (0..piece.triangles.len())
            .step_by(apart)
            .map(|triangle| self.judge(block, &piece.triangles[triangle], tolerance).bound / tolerance)
            .collect();
        if ratios.is_empty() {
            return 1.0;
        }
        ratios.sort_by(f64::total_cmp);
        let place = crate::geometry::number::floor_index(PLANNED * (ratios.len() - 1) as f64);
        let ratio = ratios[place];
        // Few rows or steps are whole numbers first: a coarser plan would not come out coarser, or too coarse.
        let many = plan.rows.total() >= 6.0 && plan.steps.iter().any(|steps| steps.total() >= 6.0);
        if ratio > 1.02 && ratio.is_finite() {
            (ratio / 0.98).sqrt().min(2.0)
        } else if ratio < 0.88 && ratio > 0.0 && many {
            (ratio / 0.96).sqrt().max(0.5)
        } else {
            1.0
        }
    }

    /// The verdict on a triangle, with the lines of those of its sides that are lines of their own.
    pub(super) fn judge(&self, block: usize, triangle: &[u32; 3], tolerance: f64) -> Judged {
        let (place, piece) = (&self.layout.blocks[block], &self.pieces[block]);
        let corners = triangle.map(|corner| piece.corners[corner as usize]);
        let points = corners.map(|corner| self.points[corner.point as usize]);
        let normals = triangle.map(|corner| piece.normals[corner as usize]);
        let verdict = judge(place, (corners, normals), points, tolerance);
        let (bound, evidence) = verdict.bound(tolerance);
        let mut judged = Judged { bound, evidence, sides: verdict.sides };
        for side in 0..3 {
            let (i, j) = ((side + 1) % 3, (side + 2) % 3);
            let Some(edge) = rim_of(place, &corners[i], &corners[j]) else { continue };
            if self.turns[edge] > FEATURE {
                let pair = (&corners[i], &corners[j]);
                let (chord, evidence) = judge_chord(place, pair, [points[i], points[j]], tolerance);
                judged.bound = judged.bound.max(chord);
                judged.evidence = judged.evidence.max(evidence);
                // A line that is good enough does not say where a triangle that is folded is to be split.
                if chord > tolerance {
                    judged.sides[side] = judged.sides[side].max(chord);
                }
            }
        }
        judged
    }

    /// The bound of all triangles as they are.
    fn measure(&self) -> Deviation {
        let mut deviation = Deviation::NONE;
        for (block, piece) in self.pieces.iter().enumerate() {
            let lattice = self.lattices[block].as_ref();
            if let Some(bound) = lattice.and_then(|lattice| self.measure_lattice(block, lattice)) {
                deviation = deviation.union(bound);
                continue;
            }
            for triangle in &piece.triangles {
                let judged = self.judge(block, triangle, f64::INFINITY);
                deviation = deviation.union(judged.deviation());
            }
        }
        deviation
    }

    /// The proved bound of a lattice and of those of its rims that are lines of their own; none where there is no proof.
    fn measure_lattice(&self, number: usize, lattice: &Lattice) -> Option<Deviation> {
        let (block, piece) = (&self.layout.blocks[number], &self.pieces[number]);
        let mut deviation = lattice.deviation(block, piece, &self.points)?;
        for rim in Rim::ALL {
            if self.turns[block.edge(rim).edge] <= FEATURE {
                continue;
            }
            for (a, b) in lattice.along(rim) {
                let ends = [a, b].map(|corner| piece.corners[corner as usize]);
                let places = ends.map(|corner| self.points[corner.point as usize]);
                let (bound, evidence) = judge_chord(block, (&ends[0], &ends[1]), places, f64::INFINITY);
                deviation = deviation.union(Deviation::new(bound, evidence));
            }
        }
        Some(deviation)
    }
}

/// Finds the normals of all corners of a piece, and the points that are new.
fn place(points: &mut Vec<DVec3>, block: &Block<'_>, piece: &mut Piece) {
    /// Places that are evaluated at once: enough to share the cost of lines, few enough to stay small.
    const AT_ONCE: usize = 1 << 13;
    let corners = &piece.corners;
    piece.normals = Vec::with_capacity(corners.len());
    while piece.normals.len() < corners.len() {
        let rest = &corners[piece.normals.len()..];
        let rest = &rest[..rest.len().min(AT_ONCE)];
        let row_along_u = rest.len() < 2 || rest[0].v == rest[1].v;
        let lines = |corner: &Corner| if row_along_u { (corner.u, corner.v) } else { (corner.v, corner.u) };
        let wide = rest.iter().take_while(|corner| lines(corner).1 == lines(&rest[0]).1).count();
        let same = |row: &&[Corner]| {
            let level = lines(&row[0]).1;
            row.len() == wide && row.iter().zip(rest).all(|(a, b)| lines(a) == (lines(b).0, level))
        };
        let high = rest.chunks(wide).take_while(same).count();
        let across: Vec<f64> = rest[..wide].iter().map(|corner| lines(corner).0).collect();
        let up: Vec<f64> = (0..high).map(|row| lines(&rest[row * wide]).1).collect();
        let jets = if row_along_u { block.lattice(&across, &up) } else { block.lattice(&up, &across) };
        for (k, corner) in rest[..wide * high].iter().enumerate() {
            let (column, row) = (k % wide, k / wide);
            let jet = &jets[if row_along_u { k } else { column * high + row }];
            piece.normals.push(jet.normal);
            if corner.point as usize == points.len() {
                points.push(jet.point);
            }
        }
    }
}

impl Judged {
    pub(super) fn deviation(&self) -> Deviation {
        Deviation::new(self.bound, self.evidence)
    }
}

/// The edge that two corners of a block stand on, if they stand on one rim.
pub(super) fn rim_of(block: &Block<'_>, a: &Corner, b: &Corner) -> Option<usize> {
    let on = |rim: Rim| {
        let stands = |corner: &Corner| {
            corner.free == Free::Neither && on_rim(block, corner, rim)
                || (corner.free != Free::Neither && on_end(block, corner, rim))
        };
        stands(a) && stands(b) && (a.free == Free::Neither || b.free == Free::Neither)
    };
    let rim = Rim::ALL.into_iter().find(|rim| on(*rim))?;
    let used = block.edge(rim).edge;
    Some(used)
}

/// Whether a corner stands on a rim.
pub(super) fn on_rim(block: &Block<'_>, corner: &Corner, rim: Rim) -> bool {
    match rim {
        Rim::Bottom => corner.v == block.v.0,
        Rim::Top => corner.v == block.v.1,
        Rim::Left => corner.u == block.u.0,
        Rim::Right => corner.u == block.u.1,
    }
}

/// Whether a corner on a pole is an end of a rim that leads to the pole.
fn on_end(_block: &Block<'_>, corner: &Corner, rim: Rim) -> bool {
    match corner.free {
        Free::U => !rim.along_u(),
        Free::V => rim.along_u(),
        Free::Neither => false,
    }
}

/// The demands of all blocks; refuses more triangles than are allowed before any is made.
fn plans(layout: &Layout<'_>, detail: &Detail) -> Result<Vec<Plan>, TessellateError> {
    let tolerance = match detail.density {
        SurfaceDensity::Grid { u, v } => return grids(layout, (u, v), detail),
        SurfaceDensity::Tolerance(tolerance) => tolerance,
    };
    let plan = |block: &Block<'_>| {
        let poles = Rim::ALL.map(|rim| layout.edges[block.edge(rim).edge].pole);
        Plan::new(block, tolerance, poles)
    };
    let plans: Vec<Plan> = layout.blocks.par_iter().with_min_len(AT_ONCE).map(plan).collect();
    // The plan may err; by half it does not.
    let needed: f64 = plans.iter().map(|plan| plan.triangles).sum();
    detail.allow(floor_large(needed / 2.0))?;
    Ok(plans)
}

/// Steps of the grid go to blocks by their share of the domain.
fn grids(layout: &Layout<'_>, (u, v): (u32, u32), detail: &Detail) -> Result<Vec<Plan>, TessellateError> {
    use crate::geometry::number::floor_count;
    use crate::geometry::surface::Surface;
    detail.allow(u64::from(u) * u64::from(v))?;
    let steps = |count: u32, part: (f64, f64), domain: crate::geometry::curve::Domain| {
        let reached = |t: f64| ((t - domain.start) / domain.span() * f64::from(count)).round();
        floor_count(reached(part.1) - reached(part.0)).max(1)
    };
    let plan = |block: &Block<'_>| {
        let (domain_u, domain_v) = (block.surface.domain_u(), block.surface.domain_v());
        Plan::grid(steps(u, block.u, domain_u), steps(v, block.v, domain_v))
    };
    Ok(layout.blocks.iter().map(plan).collect())
}

/// Degrees by which normals jump across an edge; 180 where there is no neighbour, or more than one.
fn turn(layout: &Layout<'_>, edge: &Edge) -> f64 {
    const PLACES: [f64; 5] = [0.02, 0.25, 0.5, 0.75, 0.98];
    let [one, other] = edge.uses.as_slice() else { return 180.0 };
    let normal = |(block, rim): &(usize, Rim), fraction: f64| {
        let block = &layout.blocks[*block];
        let fraction = if block.edge(*rim).backward { 1.0 - fraction } else { fraction };
        let (u, v) = block.at(rim.place(fraction));
        let normal = block.jet(u, v).normal;
        if block.flipped { -normal } else { normal }
    };
    let angle = |fraction: f64| {
        let cosine = normal(one, fraction).dot(normal(other, fraction)).clamp(-1.0, 1.0);
        acos(cosine).to_degrees()
    };
    PLACES.into_iter().map(angle).fold(0.0, f64::max)
}
