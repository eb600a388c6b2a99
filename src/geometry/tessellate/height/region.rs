//! The part of a height map that its masks keep, as lines of the triangulation.
//!
//! Promise: the region is bounded by the iso-lines of the masks ([`contour`](super::contour)), rounded to a grid that
//! depends on the size of the map and the tolerance alone: masks that keep opposite sides of one threshold share the
//! points between them to the last bit. Where parts of the region would touch in a point, they are parted: the corners
//! of what is below the threshold there are cut off, whichever side is kept.
//!
//! Each mask is a closed line with a bit of its own; triangles know on which side of each line they lie by parity, so
//! overlaps, crossings and what rounding does to them need no cases.

use glam::DVec2;

use super::chain::Side;
use super::delaunay::{BORDER, Delaunay, FIXED, Place, next};
use super::drawn::Tangled;
use super::greedy::whole;
use super::ground::Ground;
use super::lattice::Lattice;
use super::scribe::{Lines, Scribe, level_cells};
use super::sector::{Sector, cut_sectors, sectors};
use super::{HeightMap, MaskSide};
use crate::geometry::map::GridField;

/// A region by its lines.
pub(super) struct Region {
    lines: Vec<Lines>,
    /// All bits that tell lines apart.
    all: u32,
    /// What each map asks of them.
    tests: Vec<Test>,
    /// Places of lines to a step of the field.
    pub(super) grain: u64,
    /// How far lines are from the true ones, metres.
    pub(super) error: f64,
    /// Length by which corners are cut off, in places.
    cut: f64,
}

/// Bits that tell whether a place is kept: among these, those that must be set.
#[derive(Clone, Copy, Default)]
struct Test {
    bits: u32,
    wanted: u32,
}

/// Which triangles are kept: those of one map, without those of another.
#[derive(Clone, Copy)]
pub(super) struct Keep {
    pub(super) of: usize,
    pub(super) without: Option<usize>,
}

impl Keep {
    /// What the only map keeps.
    pub(super) const ONLY: Self = Self { of: 0, without: None };
}

/// Why a region has no lines.
pub(super) enum RegionError {
    TooMany(u64),
    Tangled,
}

impl From<Tangled> for RegionError {
    fn from(_: Tangled) -> Self {
        Self::Tangled
    }
}

/// Share of the tolerance by which lines may be off.
const SHARE: f64 = 0.25;

/// Places to a step of the field, a power of two: a sixteenth of the lines' share of the tolerance apart, as far as
/// whole numbers of the triangulation go.
pub(super) fn grain(shape: &HeightMap, tolerance: f64) -> u64 {
    let [right, bottom] = shape.field.extent();
    let step = (shape.size / DVec2::new(right, bottom)).max_element();
    let mut grain = 1_u64;
    while step / (grain as f64) > tolerance * SHARE / 16.0
        && right.max(bottom) * ((2 * grain) as f64) < (1 << 27) as f64
    {
        grain *= 2;
    }
    grain
}

impl Region {
    /// Whether a map is cut at all.
    pub(super) fn is_needed(shape: &HeightMap) -> bool {
        !shape.masks.is_empty() || shape.field.has_gaps()
    }

    /// Traces the lines of the masks of maps over one grid. Their chords are within `rise` of the heights on all lattices.
    pub(super) fn trace<G: Ground>(
        maps: &[&HeightMap],
        lattices: &[Lattice<'_, G>],
        (tolerance, rise): (f64, f64),
        limit: u64,
    ) -> Result<Self, RegionError> {
        let shape = maps[0];
        let [right, bottom] = shape.field.extent();
        let grain = grain(shape, tolerance);
        let step = shape.size / DVec2::new(right, bottom);
        let unit = step.max_element() / grain as f64;
        let error = tolerance * SHARE;
        let scribe = Scribe { shape, lattices, rise, grain, error, limit };
        let mut region = Self {
            lines: Vec::new(),
            all: 0,
            tests: Vec::new(),
            grain,
            error: error + 1.5 * unit,
            cut: (error / unit / 2.0).max(4.0),
        };
        for map in maps {
            region.add_map(&scribe, map)?;
        }
        Ok(region)
    }

    fn add_map<G: Ground>(&mut self, scribe: &Scribe<'_, G>, map: &HeightMap) -> Result<(), RegionError> {
        let mut test = Test::default();
        for mask in &map.masks {
            let bit = self.next_bit();
            self.lines.push(scribe.mask(bit, &mask.field, mask.threshold)?);
            test.bits |= bit;
            match mask.side {
                MaskSide::AtLeast => test.wanted |= bit,
                MaskSide::AtMost => {
                    let level = level_cells(&mask.field, mask.threshold);
                    self.lines.extend(scribe.cells(bit, &mask.field, &level));
                }
            }
            self.add_gaps(scribe, &mask.field, &mut test);
        }
        self.add_gaps(scribe, &map.field, &mut test);
        self.tests.push(test);
        Ok(())
    }

    /// A bit for the next line.
    fn next_bit(&mut self) -> u32 {
        let bit = self.all + 1;
        self.all |= bit;
        bit
    }

    /// Keeps cells whose samples all have values.
    fn add_gaps<G: Ground>(&mut self, scribe: &Scribe<'_, G>, field: &GridField, test: &mut Test) {
        if field.has_gaps() {
            let bit = self.next_bit();
            test.bits |= bit;
            test.wanted |= bit;
            self.lines.extend(scribe.cells(bit, field, &|i, j| field.knows(i, j)));
        }
    }

    /// Whether triangles on these sides of the lines are kept.
    fn keeps(&self, keep: Keep, side: u32) -> bool {
        let holds = |test: &Test| side & test.bits == test.wanted;
        holds(&self.tests[keep.of]) && !keep.without.is_some_and(|other| holds(&self.tests[other]))
    }

    /// Draws the lines and marks the triangles that are kept. Whether any is.
    pub(super) fn draw<G: Ground>(
        &self,
        mesh: &mut Delaunay,
        lattice: &Lattice<'_, G>,
        keep: Keep,
    ) -> Result<bool, Tangled> {
        let factor = whole(f64::from(lattice.units) * f64::from(lattice.refine) / self.grain as f64).max(1);
        mesh.allow_lines();
        let mut near = 0;
        let mut corner = |mesh: &mut Delaunay, place: Place| {
            let found = mesh.corner_at(place.map(|part| part * factor), near).ok_or(Tangled)?;
            near = mesh.out_of[found as usize] / 3;
            Ok(found)
        };
        let mut drawn = Vec::new();
        for lines in &self.lines {
            for chain in &lines.chains {
                let corners: Vec<u32> =
                    chain.iter().map(|place| corner(mesh, *place)).collect::<Result<_, Tangled>>()?;
                drawn.push((lines.bit, corners));
            }
            for side in Side::ALL {
                for end in &lines.border[side as usize] {
                    corner(mesh, side.place(lattice.far().map(|part| part / factor), *end))?;
                }
            }
        }
        for (bit, corners) in drawn {
            for pair in corners.windows(2) {
                mesh.draw(pair[0], pair[1], bit)?;
            }
        }
        self.draw_border(mesh, factor);
        let sides = mesh.sides_of_lines()?;
        self.part(mesh, sides, f64::from(factor))?;
        let sides = mesh.sides_of_lines()?;
        mesh.kept = sides.iter().map(|side| self.keeps(keep, *side)).collect();
        self.forget(mesh);
        Ok(mesh.kept.contains(&true))
    }

    /// Marks the edges on the border beside which the region of a line is above.
    fn draw_border(&self, mesh: &mut Delaunay, factor: i32) {
        let far = mesh.places[2];
        let edges: Vec<u32> = (0..3 * mesh.triangles()).filter(|edge| mesh.beyond(*edge) == BORDER).collect();
        for edge in edges {
            let (a, b) = (mesh.place(edge), mesh.place(next(edge)));
            let side = Side::of(a, b, far);
            let along = usize::from(!side.is_row());
            let middle = i64::from(a[along]) + i64::from(b[along]);
            for lines in &self.lines {
                let ends = &lines.border[side as usize];
                let before = ends.partition_point(|end| 2 * i64::from(*end) * i64::from(factor) < middle);
                if before % 2 == 1 {
                    mesh.toggle(edge, lines.bit);
                }
            }
        }
    }

    /// Parts what touches in a point: corners of what is below a line there are cut off, but for one.
    fn part(&self, mesh: &mut Delaunay, mut sides: Vec<u32>, factor: f64) -> Result<(), Tangled> {
        let mut bit = 1;
        while bit <= self.all {
            let mut meeting = vec![0_u8; mesh.places.len()];
            for edge in (0..3 * mesh.triangles()).filter(|edge| mesh.line(*edge) & bit != 0) {
                for side in [edge, next(edge)] {
                    let count = &mut meeting[mesh.corners[side as usize] as usize];
                    *count = count.saturating_add(1);
                }
            }
            // Two edges of a line that passes through a corner are four half-edges; on the border they may be fewer.
            let on_border = |corner: u32| {
                let place = mesh.places[corner as usize];
                let far = mesh.places[2];
                place.contains(&0) || (0..2).any(|k| place[k] == far[k])
            };
            let corners: Vec<u32> = (0..crate::geometry::mesh::index(mesh.places.len()))
                .filter(|corner| {
                    let most = meeting[*corner as usize];
                    most > 4 || (most > 2 && on_border(*corner))
                })
                .collect();
            for corner in corners {
                let cut = cut_sectors(&sectors(mesh, &sides, corner, bit));
                if !cut.is_empty() {
                    self.cut_corners(mesh, (corner, &cut), bit, factor)?;
                    sides = mesh.sides_of_lines()?;
                }
            }
            bit *= 2;
        }
        Ok(())
    }

    /// Gives corners of sectors that lie below a line to what is above it.
    fn cut_corners(
        &self,
        mesh: &mut Delaunay,
        (corner, cut): (u32, &[Sector]),
        bit: u32,
        factor: f64,
    ) -> Result<(), Tangled> {
        let at =
            |mesh: &Delaunay, corner: u32| DVec2::from_array(mesh.places[corner as usize].map(f64::from));
        let center = at(mesh, corner);
        for sector in cut {
            let shortest = sector.ends.map(|end| at(mesh, end).distance(center));
            let length = (self.cut * factor).min(shortest[0].min(shortest[1]) / 3.0);
            let mut found = [0; 2];
            for ((slot, end), on_border) in found.iter_mut().zip(sector.ends).zip(sector.on_border) {
                let place = center + (at(mesh, end) - center).normalize_or(DVec2::X) * length;
                let near = mesh.out_of[corner as usize] / 3;
                *slot = mesh.corner_at([whole(place.x), whole(place.y)], near).ok_or(Tangled)?;
                if on_border {
                    mesh.draw(corner, *slot, bit)?;
                } else {
                    mesh.draw(corner, end, bit)?;
                    mesh.draw(*slot, end, bit)?;
                }
            }
            mesh.draw(found[0], found[1], bit)?;
        }
        Ok(())
    }

    /// Lines that do not bound what is kept are no lines any more.
    fn forget(&self, mesh: &mut Delaunay) {
        let mut free = Vec::new();
        for edge in 0..3 * mesh.triangles() {
            let other = mesh.beyond(edge);
            let lines = mesh.line(edge) & !FIXED;
            if lines == 0 || other == BORDER || other < edge || mesh.keeps(edge / 3) != mesh.keeps(other / 3)
            {
                continue;
            }
            mesh.toggle(edge, lines);
            if mesh.keeps(edge / 3) && mesh.line(edge) == 0 {
                free.push([edge, next(edge)].map(|side| mesh.corners[side as usize]));
            }
        }
        mesh.restore(free);
    }
}

/// Loops of corners around the triangles that are kept, these to their left over columns and rows: for each connected
/// part its outer loop first, then its holes.
pub(super) fn rims(mesh: &Delaunay) -> Vec<Vec<Vec<u32>>> {
    let rim = |edge: u32| {
        let beyond = mesh.beyond(edge);
        mesh.keeps(edge / 3) && (beyond == BORDER || !mesh.keeps(beyond / 3))
    };
    let count = mesh.triangles();
    let mut part = vec![u32::MAX; count as usize];
    let mut parts = 0;
    for first in 0..count {
        if part[first as usize] != u32::MAX || !mesh.keeps(first) {
            continue;
        }
        let mut open = vec![first];
        part[first as usize] = parts;
        while let Some(triangle) = open.pop() {
            for edge in 3 * triangle..3 * triangle + 3 {
                let other = mesh.beyond(edge);
                if other != BORDER && mesh.keeps(other / 3) && part[other as usize / 3] == u32::MAX {
                    part[other as usize / 3] = parts;
                    open.push(other / 3);
                }
            }
        }
        parts += 1;
    }
    let mut loops: Vec<Vec<Vec<u32>>> = vec![Vec::new(); parts as usize];
    let mut seen = vec![false; 3 * count as usize];
    for first in 0..3 * count {
        if seen[first as usize] || !rim(first) {
            continue;
        }
        let mut ring = Vec::new();
        let mut edge = first;
        while !seen[edge as usize] {
            seen[edge as usize] = true;
            ring.push(mesh.corners[edge as usize]);
            edge = next(edge);
            while !rim(edge) {
                edge = next(mesh.beyond(edge));
            }
        }
        loops[part[first as usize / 3] as usize].push(ring);
    }
    for rings in &mut loops {
        let outer = rings.iter().position(|ring| twice_area(mesh, ring) > 0).unwrap_or(0);
        rings[..=outer].rotate_right(1);
    }
    loops
}

fn twice_area(mesh: &Delaunay, ring: &[u32]) -> i128 {
    let at = |corner: u32| mesh.places[corner as usize].map(i128::from);
    let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
    pairs.map(|(from, to)| (at(*from), at(*to))).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum()
}

/// The edges that bound what is kept, as pairs of corners.
pub(super) fn rim_edges(mesh: &Delaunay) -> impl Iterator<Item = [u32; 2]> + '_ {
    (0..3 * mesh.triangles())
        .filter(|edge| mesh.line(*edge) & !FIXED != 0 && mesh.keeps(*edge / 3))
        .map(|edge| [edge, next(edge)].map(|side| mesh.corners[side as usize]))
}
