//! Points, vertices and triangles of a plan.

use std::ops::Range;

use glam::{DVec2, DVec3};

use super::super::cap::{CapLoop, Facing, add_cap, twice_area};
use super::super::{Detail, TessellateError, Tessellation};
use super::Plan;
use super::columns::{Columns, Plain};
use crate::geometry::curve::Side;
use crate::geometry::mesh;
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex};
use crate::geometry::number::atan2;
use crate::geometry::surface::{SectionPoint, Stand};

/// Makes the mesh of a plan.
pub(super) struct Builder<'a> {
    plan: &'a Plan<'a>,
    detail: &'a Detail,
    mesh: Mesh,
    /// Whether each row is a hard edge.
    hard_rows: Vec<bool>,
}

/// The points of one outline, row by row.
struct Grid {
    columns: usize,
    points: Vec<PointIndex>,
}

impl Grid {
    fn at(&self, row: usize, column: usize) -> PointIndex {
        self.points[row * self.columns + column]
    }
}

/// A part of a wall between two hard rows and two hard columns, ends included.
#[derive(Clone, Copy)]
struct Patch {
    outline: usize,
    rows: (usize, usize),
    columns: (usize, usize),
    /// Whether the edges at its ends are hard.
    hard_columns: (bool, bool),
    /// Whether it comes back to its own first vertices.
    round: (bool, bool),
}

impl<'a> Builder<'a> {
    pub(super) fn new(plan: &'a Plan<'a>, detail: &'a Detail) -> Self {
        let mut builder = Self { plan, detail, mesh: Mesh::default(), hard_rows: Vec::new() };
        builder.hard_rows = (0..plan.rows.len()).map(|row| builder.is_hard_row(row)).collect();
        builder
    }

    pub(super) fn build(mut self, caps: bool) -> Result<Tessellation, TessellateError> {
        self.reserve();
        let mut grids = Vec::new();
        for outline in 0..self.plan.columns.len() {
            let grid = self.grid(outline);
            for patch in self.patches(outline) {
                self.patch(&grid, &patch);
            }
            grids.push(grid);
        }
        if caps && !self.plan.closed && self.plan.columns.iter().all(|columns| columns.closed) {
            self.cap(&grids, 0)?;
            self.cap(&grids, self.plan.rows.len() - 1)?;
        }
        let mut mesh = self.mesh;
        mesh.runs = vec![Run { origin: 0, end: mesh::index(mesh.triangles.len()) }];
        Ok(Tessellation { mesh, deviation: self.plan.deviation })
    }

    fn reserve(&mut self) {
        let columns: usize = self.plan.columns.iter().map(Columns::len).sum();
        let cells = columns * self.plan.rows.len();
        self.mesh.points.reserve(cells);
        self.mesh.vertices.reserve(cells);
        self.mesh.triangles.reserve(2 * cells);
    }

    /// Whether the surface has an edge along a row anywhere.
    fn is_hard_row(&self, row: usize) -> bool {
        let row = &self.plan.rows[row];
        if !row.joint {
            return false;
        }
        let turn = |columns: &Columns, column: usize| {
            let normal = |stand: &Stand| stand.normal(&columns.at(column, None, &stand.mix));
            degrees(normal(&row.before), normal(&row.after))
        };
        let hard =
            |columns: &Columns| (0..columns.len()).any(|k| turn(columns, k) > self.detail.crease_angle);
        self.plan.columns.iter().any(hard)
    }

    /// Whether the section has a corner at a column in any row; rows without a change stand for all.
    fn is_hard_column(&self, columns: &Columns, column: usize) -> bool {
        if !columns.is_joint(column) {
            return false;
        }
        let rows = &self.plan.rows;
        let used = if self.plan.surface.change.is_constant() { 1 } else { rows.len() };
        let turn = |stand: &Stand| {
            let side = |side: Side| columns.at(column, Some(side), &stand.mix).across;
            let (before, after) = (side(Side::Before), side(Side::After));
            atan2(before.perp_dot(after).abs(), before.dot(after)).to_degrees()
        };
        rows[..used].iter().any(|row| turn(&row.after) > self.detail.crease_angle)
    }

    fn grid(&mut self, outline: usize) -> Grid {
        let (plan, columns) = (self.plan, &self.plan.columns[outline]);
        let count = columns.len();
        let distinct = count - usize::from(columns.closed);
        let last = plan.rows.len() - 1;
        let mut grid = Grid { columns: count, points: Vec::with_capacity(count * (last + 1)) };
        for row in 0..=last {
            if plan.closed && row == last {
                let seam = plan.seam[outline];
                grid.points.extend(
                    (0..count).map(|column| grid.points[seam.column(column, count)]).collect::<Vec<_>>(),
                );
                continue;
            }
            let start = grid.points.len();
            if plan.rows[row].plain {
                let (first, plane) = (mesh::index(self.mesh.points.len()), &plan.rows[row].after.plane);
                let places = columns.plain()[..distinct].iter().map(Plain::place);
                self.mesh.points.extend(places.map(|place| plane.point(place.x, place.y)));
                grid.points.extend((first..).take(distinct).map(PointIndex));
                if columns.closed {
                    grid.points.push(grid.points[start]);
                }
                continue;
            }
            let mix = plan.rows[row].after.mix;
            let pole = plan.rows[row].is_pole().then(|| self.point(row, DVec2::ZERO));
            for column in 0..distinct {
                let place = || columns.at(column, Some(Side::After), &mix).place;
                grid.points.push(pole.unwrap_or_else(|| self.point(row, place())));
            }
            if columns.closed {
                grid.points.push(grid.points[start]);
            }
        }
        grid
    }

    /// A point of a row, at corners in the bisecting plane.
    fn point(&mut self, row: usize, place: DVec2) -> PointIndex {
        let row = &self.plan.rows[row];
        self.mesh.points.push(row.point(&row.after, place));
        PointIndex(mesh::index(self.mesh.points.len()) - 1)
    }

    fn patches(&self, outline: usize) -> Vec<Patch> {
        let (plan, columns) = (self.plan, &self.plan.columns[outline]);
        let (last_row, last) = (plan.rows.len() - 1, columns.len() - 1);
        let hard = |column: usize| self.is_hard_column(columns, column);
        let seam = hard(0);
        let mut stops = vec![0];
        stops.extend((1..last).filter(|column| hard(*column)));
        stops.push(last);
        let mut rows = vec![0];
        rows.extend((1..last_row).filter(|row| self.hard_rows[*row]));
        rows.push(last_row);
        let share = !self.detail.uv;
        let round_rows = share && plan.closed && !plan.shifted && rows.len() == 2 && !self.hard_rows[0];
        let round_columns = share && columns.closed && stops.len() == 2 && !seam;
        let mut patches = Vec::new();
        for rows in rows.windows(2) {
            for columns in stops.windows(2) {
                let hard_at = |column: usize| (column > 0 && column < last) || seam;
                patches.push(Patch {
                    outline,
                    rows: (rows[0], rows[1]),
                    columns: (columns[0], columns[1]),
                    hard_columns: (hard_at(columns[0]), hard_at(columns[1])),
                    round: (round_rows, round_columns),
                });
            }
        }
        patches
    }

    fn patch(&mut self, grid: &Grid, patch: &Patch) {
        let (first, last) = patch.rows;
        let mut bases = Vec::with_capacity(last - first + 1);
        for row in first..=last {
            if patch.round.0 && row == last {
                bases.push(bases[0]);
            } else {
                bases.push(self.row(grid, patch, row));
            }
        }
        let (left, right) = patch.columns;
        let cells = right - left;
        let pole = |row: usize| self.plan.rows[row].is_pole();
        let mut triangles = std::mem::take(&mut self.mesh.triangles);
        for row in first..last {
            let vertex = |row: usize, cell: usize| {
                let cell = if patch.round.1 { cell % cells } else { cell };
                VertexIndex(bases[row - first] + mesh::index(cell))
            };
            if !pole(row) && !pole(row + 1) {
                for cell in 0..cells {
                    let (near, right) = (vertex(row, cell), vertex(row, cell + 1));
                    let (far, across) = (vertex(row + 1, cell), vertex(row + 1, cell + 1));
                    triangles.extend([[near, right, across], [near, across, far]]);
                }
                continue;
            }
            for cell in 0..cells {
                let point = |row: usize, cell: usize| grid.at(row, left + cell);
                let ring = [(row, cell), (row, cell + 1), (row + 1, cell + 1), (row + 1, cell)];
                for corners in [[0, 1, 2], [0, 2, 3]].map(|corners| corners.map(|corner: usize| ring[corner]))
                {
                    let [a, b, c] = corners.map(|(row, cell)| point(row, cell));
                    if a == b || b == c || c == a {
                        continue;
                    }
                    triangles.push(corners.map(|(row, corner)| {
                        // A pole has a vertex for each cell.
                        if pole(row) {
                            VertexIndex(bases[row - first] + mesh::index(cell))
                        } else {
                            vertex(row, corner)
                        }
                    }));
                }
            }
        }
        self.mesh.triangles = triangles;
    }

    /// Makes the vertices of a row of a patch and tells the first.
    fn row(&mut self, grid: &Grid, patch: &Patch, row: usize) -> u32 {
        let base = mesh::index(self.mesh.vertices.len());
        let (left, right) = patch.columns;
        let pole = self.plan.rows[row].is_pole();
        let columns = if pole || patch.round.1 { left..right } else { left..right + 1 };
        if self.plan.rows[row].plain {
            self.plain_row(grid, patch, (row, columns));
            return base;
        }
        for column in columns {
            let vertex = if pole {
                self.pole_vertex(grid, patch, (row, column))
            } else {
                self.vertex(grid, patch, (row, column))
            };
            self.mesh.vertices.push(vertex);
        }
        base
    }

    /// The vertices of a row on which everything but the columns is the same.
    fn plain_row(&mut self, grid: &Grid, patch: &Patch, (row, range): (usize, Range<usize>)) {
        let (stand, columns) = (&self.plan.rows[row], &self.plan.columns[patch.outline]);
        let frame = &stand.after.plane.frame;
        let (along, uv) = (1.0 - stand.along, self.detail.uv);
        let source = mesh::index(patch.outline);
        let vertex = |(column, plain): (usize, &Plain)| {
            let normal = plain.normal(Self::side(patch, column));
            Vertex {
                point: grid.at(row, column),
                normal: frame.side * normal.x + frame.up * normal.y,
                uv: if uv { DVec2::new(columns.along[column], along) } else { DVec2::ZERO },
                color: Color::WHITE,
                anchor: Anchor { source, u: columns.u[column], v: stand.v },
            }
        };
        let first = range.start;
        let plain = columns.plain()[range].iter().enumerate();
        self.mesh.vertices.extend(plain.map(|(index, plain)| vertex((first + index, plain))));
    }

    /// The side from which a column of a patch is seen; none where its joint is smooth.
    fn side(patch: &Patch, column: usize) -> Option<Side> {
        if column == patch.columns.0 && patch.hard_columns.0 {
            Some(Side::After)
        } else if column == patch.columns.1 && patch.hard_columns.1 {
            Some(Side::Before)
        } else {
            None
        }
    }

    /// The normal of a patch at a row; at a soft row the mean of both sides.
    fn normal(&self, patch: &Patch, row: usize, at: impl Fn(&Stand) -> SectionPoint) -> DVec3 {
        let stand = &self.plan.rows[row];
        let normal = |stand: &Stand| stand.normal(&at(stand));
        match (self.hard_rows[row], row == patch.rows.0, row == patch.rows.1) {
            (true, true, _) => normal(&stand.after),
            (true, _, true) => normal(&stand.before),
            _ if !stand.joint => normal(&stand.after),
            _ => {
                let after = normal(&stand.after);
                (normal(&stand.before) + after).normalize_or(after)
            }
        }
    }

    fn vertex(&self, grid: &Grid, patch: &Patch, (row, column): (usize, usize)) -> Vertex {
        let columns = &self.plan.columns[patch.outline];
        let side = Self::side(patch, column);
        let place = DVec2::new(columns.along[column], 1.0 - self.plan.rows[row].along);
        Vertex {
            point: grid.at(row, column),
            normal: self.normal(patch, row, |stand| columns.at(column, side, &stand.mix)),
            uv: if self.detail.uv { place } else { DVec2::ZERO },
            color: Color::WHITE,
            anchor: self.anchor(patch, (columns.u[column], row)),
        }
    }

    /// A vertex of a pole stands for a whole cell: it looks along the middle of it.
    fn pole_vertex(&self, grid: &Grid, patch: &Patch, (row, column): (usize, usize)) -> Vertex {
        let columns = &self.plan.columns[patch.outline];
        let sides = [(column, Side::After), (column + 1, Side::Before)];
        let normals = sides.map(|(column, side)| {
            let side = if columns.is_joint(column) { Some(side) } else { None };
            self.normal(patch, row, |stand| columns.at(column, side, &stand.mix))
        });
        let middle = |values: &[f64]| (values[column] + values[column + 1]) / 2.0;
        let place = DVec2::new(middle(&columns.along), 1.0 - self.plan.rows[row].along);
        Vertex {
            point: grid.at(row, column),
            normal: (normals[0] + normals[1]).normalize_or(normals[0]),
            uv: if self.detail.uv { place } else { DVec2::ZERO },
            color: Color::WHITE,
            anchor: self.anchor(patch, (middle(&columns.u), row)),
        }
    }

    fn anchor(&self, patch: &Patch, (u, row): (f64, usize)) -> Anchor {
        Anchor { source: mesh::index(patch.outline), u, v: self.plan.rows[row].v }
    }

    fn cap(&mut self, grids: &[Grid], row: usize) -> Result<(), TessellateError> {
        let end = row > 0;
        let stand = if end { &self.plan.rows[row].before } else { &self.plan.rows[row].after };
        if stand.mix.scale == DVec2::ZERO {
            return Ok(());
        }
        let of = |(columns, grid): (&Columns, &Grid)| CapLoop {
            place: columns.places(&stand.mix),
            points: (0..columns.len() - 1).map(|column| grid.at(row, column)).collect(),
        };
        let mut loops = self.plan.columns.iter().zip(grids).map(of);
        let along = stand.plane.frame.along;
        let facing = Facing { normal: if end { along } else { -along }, mirrored: !end };
        let source = mesh::index(self.plan.columns.len()) + u32::from(end);
        for count in self.plan.islands {
            let island: Vec<CapLoop> = loops.by_ref().take(*count).collect();
            if twice_area(&island[0].place) == 0.0 {
                return Err(TessellateError::NoArea);
            }
            add_cap(&mut self.mesh, &island, facing, source, self.detail.uv)?;
        }
        Ok(())
    }
}

/// Angle between two directions.
fn degrees(one: DVec3, other: DVec3) -> f64 {
    atan2(one.cross(other).length(), one.dot(other)).to_degrees()
}
