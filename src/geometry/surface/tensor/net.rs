//! Nets of control points of derivatives over a part of a piece: the hulls that bounds are made of.

use crate::geometry::curve::control::{Control, restrict};

/// Nets up to this many points need no allocation.
const INLINE: usize = 16;

/// A small net of control points, row by row.
pub(super) struct Net<P> {
    columns: usize,
    inline: [P; INLINE],
    heap: Vec<P>,
    count: usize,
}

impl<P: Control> Net<P> {
    pub(super) fn new(points: &[P], columns: usize) -> Self {
        let mut net = Self { columns, inline: [P::default(); INLINE], heap: Vec::new(), count: points.len() };
        if points.len() <= INLINE {
            net.inline[..points.len()].copy_from_slice(points);
        } else {
            net.heap.extend_from_slice(points);
        }
        net
    }

    pub(super) fn points(&self) -> &[P] {
        if self.heap.is_empty() { &self.inline[..self.count] } else { &self.heap }
    }

    fn points_mut(&mut self) -> &mut [P] {
        if self.heap.is_empty() { &mut self.inline[..self.count] } else { &mut self.heap }
    }

    pub(super) fn columns(&self) -> usize {
        self.columns
    }

    fn rows(&self) -> usize {
        self.count / self.columns
    }

    /// The net of the derivative by u, whose parameter runs from 0 to 1; of a constant, a net of zeros.
    pub(super) fn derived_u(mut self) -> Self {
        let (old, rows) = (self.columns, self.rows());
        if old == 1 {
            self.points_mut().fill(P::default());
            return self;
        }
        let new = old - 1;
        let points = self.points_mut();
        for row in 0..rows {
            for k in 0..new {
                points[row * new + k] = (points[row * old + k + 1] - points[row * old + k]) * new as f64;
            }
        }
        self.shortened(new, rows)
    }

    /// The same by v.
    pub(super) fn derived_v(mut self) -> Self {
        let (columns, rows) = (self.columns, self.rows());
        if rows == 1 {
            self.points_mut().fill(P::default());
            return self;
        }
        let points = self.points_mut();
        for k in 0..columns * (rows - 1) {
            points[k] = (points[k + columns] - points[k]) * (rows - 1) as f64;
        }
        self.shortened(columns, rows - 1)
    }

    fn shortened(mut self, columns: usize, rows: usize) -> Self {
        (self.columns, self.count) = (columns, columns * rows);
        self.heap.truncate(self.count);
        self
    }

    /// The net of the part between local parameters.
    pub(super) fn restricted(mut self, u: (f64, f64), v: (f64, f64)) -> Self {
        let (columns, rows) = (self.columns, self.rows());
        let points = self.points_mut();
        for row in points.chunks_exact_mut(columns) {
            restrict(row, u.0, u.1);
        }
        if v != (0.0, 1.0) && rows > 1 {
            let mut line = Self::new(&points[..rows], rows);
            let line = line.points_mut();
            for column in 0..columns {
                (0..rows).for_each(|row| line[row] = points[row * columns + column]);
                restrict(line, v.0, v.1);
                (0..rows).for_each(|row| points[row * columns + column] = line[row]);
            }
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::Net;
    use crate::geometry::surface::tensor::bernstein;

    fn control(count: usize) -> Vec<DVec3> {
        let number = |k: usize| ((k * k * 7 + k * 3 + 1) % 17) as f64 - 8.0;
        (0..count).map(|k| DVec3::new(number(k), number(k + 5), number(k + 11))).collect()
    }

    #[test]
    fn nets_are_those_of_derivatives_and_parts() {
        for (p, q) in [(1, 1), (3, 3), (2, 5), (6, 1), (1, 4)] {
            let points = control((p + 1) * (q + 1));
            let net = || Net::new(&points, p + 1);
            let (from, to) = ((0.2, 0.7), (0.5, 1.0));
            for (x, y) in [(0.0, 0.0), (0.3, 0.8), (1.0, 1.0)] {
                let (u, v) = (0.2 + 0.5 * x, 0.5 + 0.5 * y);
                let [_, du, dv] = bernstein::jet(&points, (p, q), u, v);
                let [_, uv, _] = bernstein::second(&points, (p, q), u, v);
                let value = |net: Net<DVec3>, degree: (usize, usize)| {
                    bernstein::jet(net.restricted(from, to).points(), degree, x, y)[0]
                };
                assert!(value(net().derived_u(), (p - 1, q)).distance(du) < 1e-11);
                assert!(value(net().derived_v(), (p, q - 1)).distance(dv) < 1e-11);
                assert!(value(net().derived_v().derived_u(), (p - 1, q - 1)).distance(uv) < 1e-10);
            }
        }
        let constant = Net::new(&control(3), 1).derived_u();
        assert!(constant.points().iter().all(|point| *point == DVec3::ZERO));
    }
}
