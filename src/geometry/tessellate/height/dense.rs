//! Every sample a corner: two triangles for each cell.

use super::close::close;
use super::{HeightMap, push, tessellation, up};
use crate::geometry::mesh::{Mesh, index};
use crate::geometry::tessellate::{Detail, TessellateError, Tessellation};

/// The grid, each cell cut along the diagonal whose ends differ less. The bound is proved: by a quarter of its mixed
/// difference a cell of a bilinear field rises above a diagonal, and a spline is near the bilinear field.
pub(super) fn dense(shape: &HeightMap, detail: &Detail) -> Result<Tessellation, TessellateError> {
    let field = &*shape.field;
    let (columns, rows) = (field.columns(), field.rows());
    let cells = (columns as u64 - 1) * (rows as u64 - 1);
    detail.allow(2 * cells)?;
    let mut sheet = Mesh::default();
    sheet.points.reserve(columns * rows);
    sheet.vertices.reserve(columns * rows);
    sheet.triangles.reserve(crate::geometry::number::size(2 * cells));
    let samples = field.samples();
    for (at, height) in samples.iter().enumerate() {
        push(shape, &mut sheet, [(at % columns) as f64, (at / columns) as f64], *height, detail.uv);
    }
    let mut bound = 0.0_f64;
    for j in 0..rows - 1 {
        for i in 0..columns - 1 {
            let at = j * columns + i;
            let corners = [at, at + 1, at + columns + 1, at + columns];
            let [a, b, c, d] = corners.map(|at| samples[at]);
            let (by_x, by_y) = field.bends(i, j);
            bound = bound.max((a - b + c - d).abs() / 4.0 + (by_x + by_y) / 8.0);
            let [p, q, r, s] = corners.map(index);
            let pair =
                if (a - c).abs() <= (b - d).abs() { [[p, q, r], [p, r, s]] } else { [[p, q, s], [q, r, s]] };
            sheet.triangles.extend(pair.map(up));
        }
    }
    let last = rows - 1;
    let rim = (0..columns - 1)
        .chain((0..last).map(|j| j * columns + columns - 1))
        .chain((1..columns).rev().map(|i| last * columns + i))
        .chain((1..rows).rev().map(|j| j * columns));
    let rim: Vec<u32> = rim.map(index).collect();
    close(shape, sheet, &[vec![rim]], detail).map(|mesh| tessellation(mesh, bound))
}
