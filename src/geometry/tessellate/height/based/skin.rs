//! Skins: points over a base along its normals, as a function over the steps of a field.
//!
//! A skin is S = B + h n with base B, unit normal n and height h. In a cell of the field
//! `S_xx = B_xx + h_xx n + 2 h_x n_x + h n_xx`, so bounds on the parts bound it (the triangle inequality); for bases whose
//! derivatives have no closed bound second differences of S are looked at in many places instead.

use std::borrow::Cow;

use glam::DVec3;
use rayon::prelude::{IndexedParallelIterator, ParallelIterator, ParallelSliceMut};

use super::super::greedy::Floor;
use super::super::ground::Ground;
use super::BasedMap;
use crate::geometry::map::GridField;

/// Which height a skin has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Layer {
    /// That of the field.
    Top,
    /// The same everywhere.
    Level(f64),
    /// So much less than the field.
    Below(f64),
}

/// A skin of a map.
pub(super) struct Skin<'m> {
    map: &'m BasedMap,
    layer: Layer,
    bend: f64,
}

/// Margin of what is sampled.
const MARGIN: f64 = 1.25;

impl<'m> Skin<'m> {
    pub(super) fn new(map: &'m BasedMap, layer: Layer) -> Self {
        let bend = proved_bend(map, layer).unwrap_or_else(|| MARGIN * sampled_bend(map, layer));
        Self { map, layer, bend }
    }

    fn point(&self, x: f64, y: f64, height: f64) -> DVec3 {
        let [s, t] = self.map.parts([x, y]);
        let (point, normal) = self.map.base.stand(s, t);
        point + normal * height
    }
}

impl Ground for Skin<'_> {
    type Value = DVec3;

    fn grid(&self) -> &GridField {
        &self.map.heights.field
    }

    fn at(&self, x: f64, y: f64) -> DVec3 {
        self.point(x, y, self.map.height(self.layer, [x, y]))
    }

    fn samples(&self) -> Cow<'_, [DVec3]> {
        let (columns, rows) = (self.grid().columns(), self.grid().rows());
        let mut points = vec![DVec3::ZERO; columns * rows];
        points.par_chunks_exact_mut(columns).enumerate().for_each(|(j, row)| {
            for (i, point) in row.iter_mut().enumerate() {
                *point = self.at(i as f64, j as f64);
            }
        });
        Cow::Owned(points)
    }

    fn bend(&self) -> f64 {
        self.bend
    }

    fn standing(&self, [x, y]: [f64; 2], value: DVec3, floor: Option<Floor>, on_line: bool) -> DVec3 {
        if self.layer != Layer::Top || floor.is_none() {
            return value;
        }
        let height = self.map.height(self.layer, [x, y]);
        let set = self.grid().standing([x, y], height, floor, on_line);
        if set == height { value } else { self.point(x, y, set) }
    }
}

fn cells(field: &GridField) -> impl Iterator<Item = (usize, usize)> + '_ {
    (0..field.rows() - 1).flat_map(|j| (0..field.columns() - 1).map(move |i| (i, j)))
}

fn proved_bend(map: &BasedMap, layer: Layer) -> Option<f64> {
    let field = &*map.heights.field;
    let [right, bottom] = field.extent();
    let [across, along] = map.base.bounds()?;
    // For each step of the field.
    let step = |bounds: [f64; 3], count: f64| {
        [bounds[0] / (count * count), bounds[1] / count, bounds[2] / (count * count)]
    };
    let (across, along) = (step(across, right), step(along, bottom));
    let of = |[point, turn, bend]: [f64; 3], slope: f64, second: f64, height: f64| {
        point + second + 2.0 * slope * turn + height * bend
    };
    if let Layer::Level(level) = layer {
        return Some(of(across, 0.0, 0.0, level.abs()) + of(along, 0.0, 0.0, level.abs()));
    }
    let (low, high) = field.range();
    let lower = if let Layer::Below(depth) = layer { depth } else { 0.0 };
    let height = (low - lower).abs().max((high - lower).abs());
    let most = cells(field).map(|(i, j)| {
        let (slopes, bends) = (field.steepest(i, j), field.bends(i, j));
        of(across, slopes.0, bends.0, height) + of(along, slopes.1, bends.1, height)
    });
    Some(most.fold(0.0, f64::max))
}

/// Second differences inside of cells, a few thousand at the least.
fn sampled_bend(map: &BasedMap, layer: Layer) -> f64 {
    const PLACES: usize = 64;
    /// Of a cell.
    const STEP: f64 = 1.0 / 1024.0;
    let field = &*map.heights.field;
    let skin = Skin { map, layer, bend: 0.0 };
    let parts = |count: usize| PLACES.div_ceil(count).max(2);
    let (m, n) = (parts(field.columns() - 1), parts(field.rows() - 1));
    let place = |k: usize, of: usize| STEP + (1.0 - 2.0 * STEP) * k as f64 / (of - 1) as f64;
    let most = cells(field).map(|(i, j)| {
        let places = (0..n).flat_map(|b| (0..m).map(move |a| (a, b)));
        let bends = places.map(|(a, b)| {
            let (x, y) = (i as f64 + place(a, m), j as f64 + place(b, n));
            let middle = skin.at(x, y) * 2.0;
            let across = skin.at(x + STEP, y) + skin.at(x - STEP, y) - middle;
            let along = skin.at(x, y + STEP) + skin.at(x, y - STEP) - middle;
            (across.length() + along.length()) / (STEP * STEP)
        });
        bends.fold(0.0, f64::max)
    });
    most.fold(0.0, f64::max)
}
