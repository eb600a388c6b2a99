//! Solids: parts made finely enough, put together, with what their triangles carry.
//!
//! The deviation of a solid is from the surfaces of its parts: each point of the mesh lies within it of the surface it
//! stands for. Where two surfaces cross at an angle `a`, their edge may lie off by the sum of both over sin `a`.

use std::ops::Range;

use super::inherited::Inherited;
use super::limit::{Cost, Working};
use super::shape::{Made, Maker, cost, flatten, join};
use super::{RealizeError, bent};
use crate::geometry::mesh::{self, Mesh, Wire};
use crate::geometry::solid::{
    self, Check, Combination, HalfSpace, Making, SolidFault, Stock, combine, cut_open, half_space, push_out,
};
use crate::geometry::tessellate::{Deviation, Evidence};
use crate::model::{
    Hollow, KeptSide, Model, PlaneCut, Recipe, ShapeHandle, Smoothing, SolidOperation, SolidRecipe,
};

/// Edges shorter than this many roundings to single precision vanish: their ends would fall together in the file.
const ROUNDINGS: f64 = 2.0;

impl Maker<'_> {
    /// A solid in its own space.
    pub(super) fn solid(
        &self,
        handle: ShapeHandle,
        recipe: &SolidRecipe,
        inherited: Inherited,
        next_source: &mut u32,
    ) -> Result<Made, RealizeError> {
        let first = *next_source;
        let work = Work { maker: self, handle, recipe, inherited };
        let made = match &recipe.operation {
            SolidOperation::Combine(how) => work.combined(how, next_source)?,
            SolidOperation::Cut(cut) => work.cut(cut, next_source)?,
            SolidOperation::Hull(points) => {
                *next_source += 1;
                work.hull(points, first)?
            }
            SolidOperation::Round(radius) => {
                *next_source += 1;
                work.rounded(*radius, first)?
            }
            SolidOperation::Shell(hollow) => work.shell(hollow, next_source)?,
        };
        let smoothing = self.model.shape(handle).options.smoothing;
        let made = if smoothing == Smoothing::Flat { flatten(made) } else { made };
        cost(&made).check(&self.model.limits)?;
        Ok(made)
    }
}

/// One solid in the making.
struct Work<'a> {
    maker: &'a Maker<'a>,
    handle: ShapeHandle,
    recipe: &'a SolidRecipe,
    inherited: Inherited,
}

impl Work<'_> {
    fn model(&self) -> &Model {
        self.maker.model
    }

    fn fault(&self, fault: SolidFault) -> RealizeError {
        let part = fault.part().and_then(|part| self.recipe.parts.get(part)).copied();
        RealizeError::Solid { shape: self.handle, part, fault }
    }

    fn resolution(&self) -> f64 {
        ROUNDINGS * self.inherited.rounding
    }

    /// All parts side by side, and which triangles are whose.
    fn parts(
        &self,
        inherited: Inherited,
        next_source: &mut u32,
    ) -> Result<(Made, Vec<Range<usize>>), RealizeError> {
        let mut whole = Made::empty();
        let mut ranges = Vec::new();
        let mut total = Cost::default();
        for part in &self.recipe.parts {
            let made = self.maker.part(*part, inherited, next_source)?;
            total = total.plus(cost(&made));
            total.check(&self.model().limits)?;
            let start = whole.mesh.triangles.len();
            if whole.mesh.triangles.is_empty() && whole.materials.is_empty() {
                whole = made;
            } else {
                join(&mut whole, &made);
            }
            ranges.push(start..whole.mesh.triangles.len());
        }
        Ok((whole, ranges))
    }

    /// The parts of which one has lines: they enclose nothing, unless the parts are only wrapped.
    fn solids(
        &self,
        inherited: Inherited,
        next_source: &mut u32,
    ) -> Result<(Made, Vec<Range<usize>>), RealizeError> {
        let lined = self.recipe.parts.iter().position(|part| has_lines(self.model(), *part));
        match lined {
            Some(part) => Err(self.fault(SolidFault::Lines { part })),
            None => self.parts(inherited, next_source),
        }
    }

    fn checks(&self) -> Vec<Check> {
        let check = |part: &ShapeHandle| {
            if may_cross(self.model(), *part) { Check::Crossings } else { Check::Trusted }
        };
        self.recipe.parts.iter().map(check).collect()
    }

    /// For each source up to those of the parts, when its parameters come round again.
    fn periods(&self, first: u32) -> Vec<(f64, f64)> {
        let mut periods = vec![(f64::INFINITY, f64::INFINITY); first as usize];
        self.recipe.parts.iter().for_each(|part| bent::periods(self.model(), *part, &mut periods));
        periods
    }

    /// Evaluates a combination over what is made.
    fn put_together(
        &self,
        mut whole: Made,
        parts: Vec<Range<usize>>,
        how: &Combination,
        periods: &[(f64, f64)],
    ) -> Result<Made, RealizeError> {
        Working::Combined.check(whole.mesh.triangles.len(), &self.model().limits)?;
        let check = self.checks();
        let making = Making { resolution: self.resolution(), periods, check: &check };
        let stock = Stock { mesh: std::mem::take(&mut whole.mesh), parts };
        let combined = combine(&stock, how, &making).map_err(|fault| self.fault(fault))?;
        whole.mesh = combined.mesh;
        whole.deviation = beyond(whole.deviation, combined.moved);
        Ok(whole)
    }

    fn combined(&self, how: &Combination, next_source: &mut u32) -> Result<Made, RealizeError> {
        let first = *next_source;
        let (whole, parts) = self.solids(self.inherited, next_source)?;
        self.put_together(whole, parts, how, &self.periods(first))
    }

    /// Adds a mesh that belongs to no part, in the shape's material or else the first of its parts.
    fn add(&self, whole: &mut Made, parts: &mut Vec<Range<usize>>, mesh: &Mesh) -> usize {
        let material = self.model().shape(self.handle).options.material;
        let material = material.or_else(|| whole.materials.first().copied().flatten());
        let start = whole.mesh.triangles.len();
        whole.mesh.append(mesh, mesh::index(whole.materials.len()));
        whole.materials.push(material);
        parts.push(start..whole.mesh.triangles.len());
        parts.len() - 1
    }

    fn cut(&self, cut: &PlaneCut, next_source: &mut u32) -> Result<Made, RealizeError> {
        let first = *next_source;
        let (mut whole, mut parts) = self.solids(self.inherited, next_source)?;
        let source = *next_source;
        // The surfaces of the parts and the cut; of sides that are moved apart each has its own.
        let each = source + 1 - first;
        *next_source = first + if cut.keep == KeptSide::Both { 2 * each } else { each };
        let periods = self.periods(first);
        if !cut.cap {
            return self.cut_open(whole, cut, &periods, each);
        }
        let box_above = half_space(&cut.above, &whole.mesh.bounds(), source);
        let part = Combination::Part(0);
        let other = Combination::Part(self.add(&mut whole, &mut parts, &box_above));
        let below = Combination::Difference(Box::new(part.clone()), vec![other.clone()]);
        let above = Combination::Intersection(vec![part, other]);
        match cut.keep {
            KeptSide::Below => self.put_together(whole, parts, &below, &periods),
            KeptSide::Above => self.put_together(whole, parts, &above, &periods),
            KeptSide::Both => {
                let lower = self.put_together(whole.clone(), parts.clone(), &below, &periods)?;
                let upper = self.put_together(whole, parts, &above, &periods)?;
                Ok(both(lower, upper, cut, each))
            }
        }
    }

    fn cut_open(
        &self,
        whole: Made,
        cut: &PlaneCut,
        periods: &[(f64, f64)],
        each: u32,
    ) -> Result<Made, RealizeError> {
        let below = HalfSpace { normal: -cut.above.normal, ..cut.above };
        let side = |half: &HalfSpace| {
            let mesh = cut_open(&whole.mesh, half, periods);
            Made { mesh, ..whole.clone() }
        };
        let made = match cut.keep {
            KeptSide::Above => side(&cut.above),
            KeptSide::Below => side(&below),
            KeptSide::Both => both(side(&below), side(&cut.above), cut, each),
        };
        if made.mesh.triangles.is_empty() { Err(self.fault(SolidFault::Nothing)) } else { Ok(made) }
    }

    fn hull(&self, points: &[glam::DVec3], source: u32) -> Result<Made, RealizeError> {
        let (whole, _) = self.parts(self.inherited, &mut 0)?;
        let corners = whole.mesh.points.iter().chain(whole.wire.points.iter().map(|point| &point.position));
        let all: Vec<_> = corners.chain(points).copied().collect();
        // A smooth surface has two triangles for each of its points.
        Working::Wrapped.check(2 * all.len(), &self.model().limits)?;
        let mesh = solid::hull(&all, self.crease_angle()).map_err(|fault| self.fault(fault))?;
        Ok(self.derived(mesh, source, &whole, whole.deviation))
    }

    fn crease_angle(&self) -> f64 {
        let options = &self.model().shape(self.handle).options;
        if options.smoothing == Smoothing::Smooth { 180.0 } else { options.crease_angle }
    }

    /// A mesh that no exact surface stands behind.
    fn derived(&self, mut mesh: Mesh, source: u32, parts: &Made, deviation: Deviation) -> Made {
        mesh.vertices.iter_mut().for_each(|vertex| vertex.anchor.source = source);
        let material = self.model().shape(self.handle).options.material;
        Made {
            mesh,
            wire: Wire::default(),
            materials: vec![material.or_else(|| parts.materials.first().copied().flatten())],
            deviation,
            tolerance: parts.tolerance,
            notes: parts.notes.clone(),
            levels: parts.levels,
        }
    }

    /// What the surface may be off by, and what of that is left for the part: half.
    fn shares(&self) -> (f64, Inherited) {
        let tolerance = self.inherited.tolerance.unwrap_or_else(|| {
            let bounds = self.maker.extents.bounds(self.recipe.parts[0]);
            bounds.diagonal() / 2000.0
        });
        let share = self.inherited.share(tolerance / 2.0, 0.5);
        (self.maker.coarsened(tolerance, self.inherited.level), share)
    }

    /// The surface of a part moved by a radius, and its deviation.
    fn moved(
        &self,
        mesh: &Mesh,
        radius: f64,
        tolerance: f64,
        before: Deviation,
    ) -> Result<(Mesh, Deviation), RealizeError> {
        Working::Combined.check(mesh.triangles.len(), &self.model().limits)?;
        let aim = (tolerance - before.bound - self.inherited.rounding).max(tolerance / 4.0);
        let check = self.checks()[0];
        let details = (self.resolution(), self.crease_angle(), check);
        let (mesh, missed) = solid::offset(mesh, radius, aim, details).map_err(|fault| self.fault(fault))?;
        Ok((mesh, beyond(before, missed + self.resolution())))
    }

    fn rounded(&self, radius: f64, source: u32) -> Result<Made, RealizeError> {
        let (tolerance, share) = self.shares();
        let (part, _) = self.solids(share, &mut 0)?;
        let (mesh, deviation) = self.moved(&part.mesh, radius, tolerance, part.deviation)?;
        let made = self.derived(mesh, source, &part, deviation);
        Ok(Made { tolerance: Some(tolerance), ..made })
    }

    fn shell(&self, hollow: &Hollow, next_source: &mut u32) -> Result<Made, RealizeError> {
        let first = *next_source;
        let (tolerance, share) = self.shares();
        let (mut whole, mut parts) = self.solids(share, next_source)?;
        let source = *next_source;
        *next_source += 1;
        let before = whole.deviation;
        let radius = if hollow.outside { hollow.thickness } else { -hollow.thickness };
        let opened = self.opened(&whole.mesh, hollow)?;
        let (mut other, deviation) = self.moved(&opened, radius, tolerance, before)?;
        other.vertices.iter_mut().for_each(|vertex| vertex.anchor.source = source);
        let part = Combination::Part(0);
        let other = Combination::Part(self.add(&mut whole, &mut parts, &other));
        let (outer, inner) = if hollow.outside { (other, part) } else { (part, other) };
        let how = Combination::Difference(Box::new(outer), vec![inner]);
        let made = self.put_together(whole, parts, &how, &self.periods(first))?;
        Ok(Made { deviation: made.deviation.union(deviation), tolerance: Some(tolerance), ..made })
    }

    /// The part with the faces that are to be open pushed out, so that what is shrunk still goes through them.
    fn opened(&self, mesh: &Mesh, hollow: &Hollow) -> Result<Mesh, RealizeError> {
        if hollow.open.is_empty() {
            return Ok(mesh.clone());
        }
        let mut stock = Stock::default();
        let mut all = vec![Combination::Part(stock.add(mesh, 0))];
        for (number, plane) in hollow.open.iter().enumerate() {
            let pushed =
                push_out(mesh, plane, 3.0 * hollow.thickness, number).map_err(|fault| self.fault(fault))?;
            all.push(Combination::Part(stock.add(&pushed, 0)));
        }
        let making = Making { resolution: self.resolution(), ..Making::default() };
        let made = combine(&stock, &Combination::Union(all), &making).map_err(|fault| self.fault(fault))?;
        Ok(made.mesh)
    }
}

/// A deviation, and some more that is proved.
fn beyond(deviation: Deviation, more: f64) -> Deviation {
    if more == 0.0 {
        return deviation;
    }
    Deviation::new(deviation.bound + more, deviation.evidence.max(Evidence::Proved))
}

/// Both sides of a cut as one, moved apart; the sources of the upper are counted on by `each`.
fn both(mut lower: Made, mut upper: Made, cut: &PlaneCut, each: u32) -> Made {
    upper.mesh.vertices.iter_mut().for_each(|vertex| vertex.anchor.source += each);
    let half = cut.above.normal * (cut.gap / 2.0);
    if cut.gap > 0.0 {
        lower.mesh.points.iter_mut().for_each(|point| *point -= half);
        upper.mesh.points.iter_mut().for_each(|point| *point += half);
    }
    let count = mesh::index(lower.materials.len());
    lower.mesh.append(&upper.mesh, count);
    lower.materials.extend(&upper.materials);
    lower.deviation = lower.deviation.union(upper.deviation);
    lower
}

/// Whether a shape has lines.
fn has_lines(model: &Model, handle: ShapeHandle) -> bool {
    found(model, handle, |recipe| matches!(recipe, Recipe::Wire(_)))
}

/// Whether nothing promises that a shape does not cross itself.
pub(super) fn may_cross(model: &Model, handle: ShapeHandle) -> bool {
    found(model, handle, |recipe| {
        matches!(
            recipe,
            Recipe::Sweep(_)
                | Recipe::Patches { .. }
                | Recipe::Trimmed(_)
                | Recipe::Polygons { .. }
                | Recipe::Deformed { .. }
                | Recipe::Subdivided(_)
        )
    })
}

/// Whether something holds of a shape or of one that it is made of, short of solids. Shapes come after their parts, so one
/// pass over those before it is enough however often parts share parts.
fn found(model: &Model, handle: ShapeHandle, holds: impl Fn(&Recipe) -> bool) -> bool {
    let mut all: Vec<bool> = Vec::with_capacity(handle.0 as usize + 1);
    for shape in &model.shapes[..=handle.0 as usize] {
        let of_parts = match &shape.recipe {
            Recipe::Assembly(parts) => parts.iter().any(|(part, _)| all[part.0 as usize]),
            Recipe::Deformed { of, .. } => all[of.0 as usize],
            _ => false,
        };
        all.push(of_parts || holds(&shape.recipe));
    }
    all.pop().unwrap_or(false)
}
