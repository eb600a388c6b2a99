//! Which points lie in a box.

use glam::DVec2;

use crate::geometry::mesh::index;
use crate::geometry::number::floor_count;

/// Points in square cells, about one for each.
pub(super) struct Grid {
    low: DVec2,
    cell: f64,
    columns: u32,
    rows: u32,
    /// One past the last of the points of each cell.
    ends: Vec<u32>,
    points: Vec<u32>,
    reach: f64,
}

impl Grid {
    pub(super) fn new(places: &[DVec2]) -> Self {
        let low = places.iter().copied().reduce(DVec2::min).unwrap_or_default();
        let high = places.iter().copied().reduce(DVec2::max).unwrap_or_default();
        let size = high - low;
        let reach = places.iter().fold(0.0, |reach, place| f64::max(reach, place.abs().max_element()));
        // A cell for each point, in a box of any shape; no more than the points in a row.
        let count = f64::from(index(places.len()).max(1));
        let cell = (size.x * size.y / count).sqrt().max(size.max_element() / count);
        let cells = |length: f64| if cell > 0.0 { floor_count(length / cell) + 1 } else { 1 };
        let (columns, rows) = (cells(size.x), cells(size.y));
        let mut grid =
            Self { low, cell, columns, rows, ends: Vec::new(), points: vec![0; places.len()], reach };
        let mut starts = vec![0; (columns * rows) as usize + 1];
        for place in places {
            starts[grid.cell_of(*place) + 1] += 1;
        }
        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }
        for (point, place) in (0..).zip(places) {
            let slot = &mut starts[grid.cell_of(*place)];
            grid.points[*slot as usize] = point;
            *slot += 1;
        }
        starts.pop();
        grid.ends = starts;
        grid
    }

    /// The greatest coordinate.
    pub(super) fn reach(&self) -> f64 {
        self.reach
    }

    fn column_row(&self, place: DVec2) -> (u32, u32) {
        if self.cell <= 0.0 {
            return (0, 0);
        }
        let at = (place - self.low) / self.cell;
        (floor_count(at.x).min(self.columns - 1), floor_count(at.y).min(self.rows - 1))
    }

    fn cell_of(&self, place: DVec2) -> usize {
        let (column, row) = self.column_row(place);
        (row * self.columns + column) as usize
    }

    /// Calls with each point of the cells that a box touches.
    pub(super) fn visit(&self, low: DVec2, high: DVec2, mut call: impl FnMut(u32)) {
        let ((first, bottom), (last, top)) = (self.column_row(low), self.column_row(high));
        for row in bottom..=top {
            let cells = (row * self.columns + first) as usize..=(row * self.columns + last) as usize;
            let start = if *cells.start() == 0 { 0 } else { self.ends[cells.start() - 1] };
            for point in &self.points[start as usize..self.ends[*cells.end()] as usize] {
                call(*point);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::Grid;

    #[test]
    fn every_point_of_a_box_is_visited_once() {
        for (wide, high) in [(1.0, 1.0), (1e3, 1e-3), (0.0, 1.0), (0.0, 0.0)] {
            let places: Vec<DVec2> = (0..200)
                .map(|k| DVec2::new(f64::from(k * 37 % 101) * wide, f64::from(k * 53 % 97) * high))
                .collect();
            let grid = Grid::new(&places);
            let (low, top) = (DVec2::new(20.0 * wide, 10.0 * high), DVec2::new(70.0 * wide, 60.0 * high));
            let mut seen = vec![0; places.len()];
            grid.visit(low, top, |point| seen[point as usize] += 1);
            for (place, count) in places.iter().zip(seen) {
                let inside = place.cmpge(low).all() && place.cmple(top).all();
                assert!(count == 1 || (count == 0 && !inside), "{place} {count}");
            }
        }
    }
}
