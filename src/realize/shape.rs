//! One shape into triangles.

use glam::{DAffine3, DMat3};

use super::extents::Extents;
use super::field::dress_elements;
use super::inherited::Inherited;
use super::limit::{self, Cost, Working};
use super::mapping::lay;
use super::material::{own_or, show_normals, source_of, split_by_element};
use super::reach::bent;
use super::source::source_count;
use super::vertex_color::color;
use super::{Faces, Level, Memo, Note, Options, RealizeError};
use crate::geometry::mesh;
use crate::geometry::mesh::convert::{ConvertOptions, Shading, convert};
use crate::geometry::mesh::{Mesh, Vertex, VertexIndex, Wire};
use crate::geometry::number::{Bounds, single_rounding};
use crate::geometry::tessellate::{
    DeformError, Deformed, Detail, Deviation, Geodesic, HeightBound, SurfaceDensity, TessellateError,
    Tessellation, based_map, cuboid, deform, extrude, field_surface, geodesic, height_map, patchwork,
    perturbed, plane, quadric, revolve, rounded_box, sheet, sweep, trimmed, two_sided, wire,
};
use crate::model::{Frame, MaterialHandle, Model, Recipe, Shape, ShapeHandle, Smoothing};

/// A shape as triangles in its own space or its user's.
#[derive(Clone, Debug)]
pub(super) struct Made {
    pub(super) mesh: Mesh,
    pub(super) wire: Wire,
    /// Material of each origin of the mesh's runs and the wire's strands.
    pub(super) materials: Vec<Option<MaterialHandle>>,
    pub(super) deviation: Deviation,
    pub(super) tolerance: Option<f64>,
    /// What a person should know, each with the part it is about.
    pub(super) notes: Vec<(ShapeHandle, Note)>,
    /// How often the cages in it were refined for their tolerance, at most.
    pub(super) levels: u32,
}

/// Makes shapes of one model.
pub(super) struct Maker<'a> {
    pub(super) model: &'a Model,
    coarser: f64,
    level: Level,
    memo: Option<&'a Memo<'a>>,
    /// How far each shape reaches.
    pub(super) extents: Extents,
    /// Triangles that each shape has at least.
    least: Vec<u64>,
    /// How often cages that are refined for a tolerance are refined at least.
    pub(super) levels: u32,
}

impl Made {
    /// Nothing.
    pub(super) fn empty() -> Self {
        Self {
            mesh: Mesh::default(),
            wire: Wire::default(),
            materials: Vec::new(),
            deviation: Deviation::NONE,
            tolerance: None,
            notes: Vec::new(),
            levels: 0,
        }
    }
}

impl<'a> Maker<'a> {
    pub(super) fn new(model: &'a Model, options: &Options<'a>) -> Self {
        let coarser = if options.coarser > 0.0 { options.coarser } else { 1.0 };
        Self {
            model,
            coarser,
            level: options.level,
            memo: options.memo,
            extents: super::extents::extents(model),
            least: limit::least_triangles(model),
            levels: 0,
        }
    }

    /// The same, which refines cages at least so often.
    pub(super) fn with_levels(self, levels: u32) -> Self {
        Self { levels, ..self }
    }

    /// All tolerances are multiplied by this.
    pub(super) fn coarser(&self) -> f64 {
        self.coarser
    }

    /// What a tolerance is in the end.
    pub(super) fn coarsened(&self, tolerance: f64, level: Level) -> f64 {
        level.tolerance(tolerance * self.coarser)
    }

    /// The shape in the document's unit, its placement applied. Anchors carry the index that
    /// [`sources`](super::sources) gives to their surface.
    pub(super) fn make(&self, handle: ShapeHandle, uv: bool) -> Result<Made, RealizeError> {
        let least = self.least[handle.0 as usize];
        if least > Working::Surface.most(&self.model.limits) {
            return Err(Working::Surface.refusal(least, &self.model.limits));
        }
        let mut first_source = 0;
        let rounding = single_rounding(self.extents.bounds(handle).reach());
        let inherited = Inherited { tolerance: self.model.tolerance, rounding, uv, level: self.level };
        self.part(handle, inherited, &mut first_source)
    }

    /// A shape as a part of another: kept from before, or made. Its sources count on from the next one.
    pub(super) fn part(
        &self,
        handle: ShapeHandle,
        inherited: Inherited,
        next_source: &mut u32,
    ) -> Result<Made, RealizeError> {
        let make = || {
            let mut sources = 0;
            self.part_anew(handle, inherited, &mut sources).map(|made| (made, sources))
        };
        let (mut made, sources) = match self.memo {
            Some(memo) => memo.shape((self, handle), inherited, make)?,
            None => make()?,
        };
        shift_sources(&mut made, *next_source);
        *next_source += sources;
        Ok(made)
    }

    fn part_anew(
        &self,
        handle: ShapeHandle,
        inherited: Inherited,
        next_source: &mut u32,
    ) -> Result<Made, RealizeError> {
        let shape = self.model.shape(handle);
        let uv = inherited.uv;
        let wanted = Inherited { tolerance: shape.options.tolerance.or(inherited.tolerance), ..inherited };
        let mut made = match &shape.recipe {
            Recipe::Assembly(parts) => {
                self.assembly(parts, wanted.within(&shape.options.placement), next_source)?
            }
            Recipe::Deformed { of, .. } => {
                self.deformed((handle, *of), wanted.within(&shape.options.placement), next_source)?
            }
            Recipe::Displaced(recipe) => {
                self.displaced(handle, recipe, wanted.within(&shape.options.placement), next_source)?
            }
            Recipe::Solid(recipe) => {
                self.solid(handle, recipe, wanted.within(&shape.options.placement), next_source)?
            }
            Recipe::Implicit { shapes, .. } if !shapes.is_empty() => {
                self.around_shapes(handle, wanted.within(&shape.options.placement), next_source)?
            }
            Recipe::Subdivided(recipe) => {
                self.subdivided(handle, recipe, wanted.within(&shape.options.placement), next_source)?
            }
            recipe => {
                let mut made = self.leaf(handle, wanted)?;
                shift_sources(&mut made, *next_source);
                *next_source += source_count(recipe);
                made
            }
        };
        if uv {
            lay(&mut made.mesh, shape.options.uv_mapping);
        }
        if shape.options.uv_scale != glam::DVec2::ONE && uv {
            for vertex in &mut made.mesh.vertices {
                vertex.uv *= shape.options.uv_scale;
            }
        }
        if let Some(law) = &shape.options.vertex_color {
            color(&mut made, law)?;
        }
        place(&mut made, &shape.options.placement);
        if let Some(map) = self.model.normal_maps.iter().find(|map| map.shape == handle) {
            show_normals(&mut made, map.material, &shape.recipe);
        }
        if let Some(material) = shape.options.material {
            // A part keeps its own material; what has none takes the whole's.
            made.materials.iter_mut().for_each(|slot| *slot = slot.or(Some(material)));
        }
        Ok(made)
    }

    fn leaf(
        &self,
        handle: ShapeHandle,
        Inherited { tolerance, rounding, uv, level }: Inherited,
    ) -> Result<Made, RealizeError> {
        let shape = self.model.shape(handle);
        let stretch = stretch(&shape.options.placement.matrix3);
        let tolerance = self.coarsened(Self::tolerance(shape, tolerance), level);
        // What rounding will add is taken off beforehand, as long as it leaves half.
        let aim = (tolerance - rounding).max(tolerance / 2.0);
        let detail = self.detail(shape, aim / stretch, (uv, level));
        let working = Working::of(&shape.recipe);
        let in_terms_of_limits = |error| self.in_terms_of_limits(working, error);
        let surface = |made: Tessellation| Made {
            mesh: made.mesh,
            wire: Wire::default(),
            materials: vec![None],
            deviation: made.deviation,
            // In the space before the placement, which scales it back with the rest.
            tolerance: (!has_fixed_grid(shape)).then_some(tolerance / stretch),
            notes: Vec::new(),
            levels: 0,
        };
        let made = match &shape.recipe {
            Recipe::Cuboid { size, center } => Ok(cuboid(*size, *center, uv)),
            Recipe::RoundedBox(shape) => rounded_box(shape, &detail),
            Recipe::Geodesic(ball) => {
                let frequency = ball.frequency.map(|frequency| (frequency >> level.number).max(1));
                geodesic(&Geodesic { frequency, ..*ball }, &detail)
            }
            Recipe::Plane(flat) => plane(flat, &detail),
            Recipe::Revolution(revolution) => revolve(revolution, &detail),
            Recipe::Extrusion(extrusion) => extrude(extrusion, &detail),
            Recipe::Sweep(path) => sweep(path, &detail),
            Recipe::Patches { patches, materials } => {
                let made = patchwork(patches, &detail).map_err(in_terms_of_limits)?;
                let mut made = surface(made);
                if !materials.is_empty() {
                    let of =
                        |mesh: &Mesh, corners: &[VertexIndex; 3]| patches.owner(source_of(mesh, corners));
                    split_by_element(&mut made, of, &own_or(materials, shape.options.material));
                }
                return self.finished(shape, made);
            }
            Recipe::Sheet(face) => sheet(face, &detail),
            Recipe::Quadric(shape) => quadric(shape, &detail),
            Recipe::Perturbed(skin) => perturbed(skin, &detail),
            Recipe::Trimmed(shape) => trimmed(shape, &detail),
            Recipe::Implicit { surface: field, materials, colors, .. } => {
                let made = field_surface(field, &detail).map_err(in_terms_of_limits)?;
                let mut made = surface(made);
                dress_elements(&mut made, &field.field, (materials, colors), shape.options.material);
                return self.finished(shape, made);
            }
            Recipe::Height(map) => height_map(map, &detail, tolerance / stretch),
            Recipe::Based(map) => based_map(map, &detail, tolerance / stretch),
            Recipe::TwoSided(body) => two_sided(body, &detail, tolerance / stretch),
            Recipe::Polygons { mesh, materials } => {
                return self.finished(shape, self.polygons(handle, mesh, materials)?);
            }
            Recipe::Wire(curves) => {
                let made = wire(curves, &detail).map(|(wire, deviation)| Made {
                    wire,
                    ..surface(Tessellation { mesh: Mesh::default(), deviation })
                });
                return self.finished(shape, made.map_err(in_terms_of_limits)?);
            }
            Recipe::Assembly(_)
            | Recipe::Deformed { .. }
            | Recipe::Displaced(_)
            | Recipe::Solid(_)
            | Recipe::Subdivided(_) => Ok(Tessellation { mesh: Mesh::default(), deviation: Deviation::NONE }),
        };
        let made = made.map_err(in_terms_of_limits)?;
        self.finished(shape, surface(made))
    }

    /// How finely a surface is cut that is to be within a tolerance in its own space.
    pub(super) fn detail(&self, shape: &Shape, aim: f64, (uv, level): (bool, Level)) -> Detail {
        Detail {
            density: match shape.options.density {
                Some(grid) => SurfaceDensity::Grid { u: level.steps(grid.u), v: level.steps(grid.v) },
                None => SurfaceDensity::Tolerance(aim),
            },
            crease_angle: match shape.options.smoothing {
                Smoothing::Auto => shape.options.crease_angle,
                Smoothing::Smooth => 180.0,
                Smoothing::Flat => 0.0,
            },
            uv,
            triangle_limit: Working::of(&shape.recipe).most(&self.model.limits),
        }
    }

    pub(super) fn in_terms_of_limits(&self, working: Working, error: TessellateError) -> RealizeError {
        match error {
            TessellateError::TooMany { needed, .. } => working.refusal(needed, &self.model.limits),
            error => error.into(),
        }
    }

    pub(super) fn finished(&self, shape: &Shape, made: Made) -> Result<Made, RealizeError> {
        // Boxes, flat faces and polygons have one normal a face already.
        let faceted = matches!(
            shape.recipe,
            Recipe::Cuboid { .. }
                | Recipe::Plane(_)
                | Recipe::Sheet(_)
                | Recipe::Polygons { .. }
                | Recipe::Assembly(_)
                | Recipe::Deformed { .. }
        );
        let flat = !faceted && shape.options.smoothing == Smoothing::Flat;
        let made = if flat { flatten(made) } else { made };
        cost(&made).check(&self.model.limits)?;
        Ok(made)
    }

    /// Tolerance in the document's unit; where none is written, the diagonal of the placed shape / 2000.
    fn tolerance(shape: &Shape, written: Option<f64>) -> f64 {
        written.unwrap_or_else(|| {
            let diagonal = super::extents::extent(&shape.recipe).diagonal();
            diagonal * stretch(&shape.options.placement.matrix3) / 2000.0
        })
    }

    fn polygons(
        &self,
        handle: ShapeHandle,
        mesh: &mesh::PolygonMesh,
        materials: &[Option<MaterialHandle>],
    ) -> Result<Made, RealizeError> {
        let shape = self.model.shape(handle);
        let shading = match shape.options.smoothing {
            Smoothing::Auto => Shading::Auto,
            Smoothing::Flat => Shading::Flat,
            Smoothing::Smooth => Shading::Smooth,
        };
        let converted = convert(mesh, &ConvertOptions { shading, crease_angle: shape.options.crease_angle })?;
        let faces = |list: &[u32]| list.first().map(|first| Faces { first: *first, count: list.len() });
        let notes = [
            faces(&converted.dropped_faces).map(Note::Dropped),
            faces(&converted.flat_faces).map(Note::Flat),
            faces(&converted.crossing_faces).map(Note::Crossing),
        ];
        let of =
            |index: &Option<u32>| index.and_then(|index| materials.get(index as usize).copied().flatten());
        Ok(Made {
            materials: converted.materials.iter().map(of).collect(),
            mesh: converted.mesh,
            wire: Wire::default(),
            deviation: Deviation::NONE,
            tolerance: None,
            notes: notes.into_iter().flatten().map(|note| (handle, note)).collect(),
            levels: 0,
        })
    }

    /// A shape that is made finely enough to be bent, then bent.
    fn deformed(
        &self,
        (handle, of): (ShapeHandle, ShapeHandle),
        inherited: Inherited,
        next_source: &mut u32,
    ) -> Result<Made, RealizeError> {
        let shape = self.model.shape(handle);
        let map = self.extents.map(handle).map_err(RealizeError::Deform)?;
        let tolerance = inherited.tolerance.unwrap_or_else(|| {
            let points = bent(self.model, &self.extents, of).into_iter();
            Bounds::of_points(points.map(|point| map.apply(point).point)).diagonal() / 2000.0
        });
        let stretch = map.stretch(&self.extents.bounds(of));
        if !stretch.is_finite() {
            return Err(RealizeError::Deform(DeformError::NoLength));
        }
        // Half for the shape itself; what that leaves is for the map.
        let share = Inherited {
            rounding: inherited.rounding / stretch,
            ..inherited.share(tolerance / (2.0 * stretch), 0.5 / stretch)
        };
        let first = *next_source;
        let mut made = self.part(of, share, next_source)?;
        Working::Deformed.check(made.mesh.triangles.len(), &self.model.limits)?;
        let tolerance = self.coarsened(tolerance, inherited.level);
        let aim = (tolerance - inherited.rounding).max(tolerance / 2.0);
        let before = made.deviation.bound * stretch;
        let left = (aim - before).max(aim / 8.0);
        let limit = Working::Deformed.most(&self.model.limits);
        // The sources of the shape count on after those before it.
        let mut periods = vec![(f64::INFINITY, f64::INFINITY); first as usize];
        super::bent::periods(self.model, of, &mut periods);
        let subject = Deformed { mesh: made.mesh, wire: made.wire };
        let (subject, deviation) =
            deform(subject, map, &periods, left, limit).map_err(|error| match error {
                DeformError::Tessellate(error) => self.in_terms_of_limits(Working::Deformed, error),
                error => RealizeError::Deform(error),
            })?;
        (made.mesh, made.wire) = (subject.mesh, subject.wire);
        made.deviation = Deviation {
            bound: before + deviation.bound,
            evidence: made.deviation.evidence.max(deviation.evidence),
        };
        made.tolerance = Some(tolerance);
        let made = if shape.options.smoothing == Smoothing::Flat { flatten(made) } else { made };
        cost(&made).check(&self.model.limits)?;
        Ok(made)
    }

    fn assembly(
        &self,
        parts: &[(ShapeHandle, DAffine3)],
        inherited: Inherited,
        next_source: &mut u32,
    ) -> Result<Made, RealizeError> {
        let mut whole = Made::empty();
        let mut total = Cost::default();
        for copies in parts.chunk_by(|(one, _), (next, _)| one == next) {
            let (handle, first) = copies[0];
            let mut sources = 0;
            let made = self.part(handle, inherited.within(&first), &mut sources)?;
            // All copies are counted before the first is made.
            total = total.plus(cost(&made).times(copies.len() as u64));
            total.check(&self.model.limits)?;
            for (_, map) in copies {
                let mut copy = made.clone();
                shift_sources(&mut copy, *next_source);
                *next_source += sources;
                place(&mut copy, map);
                join(&mut whole, &copy);
            }
        }
        Ok(whole)
    }
}

/// Whether the document fixes how finely a shape is cut.
fn has_fixed_grid(shape: &Shape) -> bool {
    let divided = matches!(&shape.recipe, Recipe::Geodesic(ball) if ball.frequency.is_some());
    let sampled = match &shape.recipe {
        Recipe::Height(map) => map.bound != HeightBound::Surface,
        Recipe::Based(map) => map.heights().bound != HeightBound::Surface,
        _ => false,
    };
    shape.options.density.is_some() || divided || sampled
}

pub(super) fn cost(made: &Made) -> Cost {
    Cost::of(&made.mesh).plus(Cost::of_wire(&made.wire))
}

pub(super) fn join(whole: &mut Made, part: &Made) {
    let offset = mesh::index(whole.materials.len());
    whole.mesh.append(&part.mesh, offset);
    whole.wire.append(&part.wire, offset);
    whole.materials.extend(&part.materials);
    whole.deviation = whole.deviation.union(part.deviation);
    whole.levels = whole.levels.max(part.levels);
    whole.tolerance = match (whole.tolerance, part.tolerance) {
        (Some(one), Some(other)) => Some(one.max(other)),
        (one, other) => one.or(other),
    };
    for note in &part.notes {
        if !whole.notes.contains(note) {
            whole.notes.push(*note);
        }
    }
}

/// Counts on the sources of a part after those before it.
fn shift_sources(made: &mut Made, first: u32) {
    if first > 0 {
        made.mesh.vertices.iter_mut().for_each(|vertex| vertex.anchor.source += first);
        made.wire.points.iter_mut().for_each(|point| point.anchor.source += first);
    }
}

fn place(made: &mut Made, map: &DAffine3) {
    if *map == DAffine3::IDENTITY {
        return;
    }
    made.mesh.transform(map);
    made.wire.transform(map);
    let stretch = stretch(&map.matrix3);
    made.deviation.bound *= stretch;
    made.tolerance = made.tolerance.map(|tolerance| tolerance * stretch);
}

/// The greatest factor by which a map stretches a length.
#[must_use]
pub fn stretch(matrix: &DMat3) -> f64 {
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let skew: f64 = [(0, 1), (1, 2), (2, 0)].iter().map(|(a, b)| columns[*a].dot(columns[*b]).abs()).sum();
    let longest = columns.iter().map(|column| column.length()).fold(0.0, f64::max);
    if skew <= 1e-9 * longest * longest {
        longest
    } else {
        columns.iter().map(|column| column.length_squared()).sum::<f64>().sqrt()
    }
}

/// Gives every triangle its own normal; vertices are shared no more.
pub(super) fn flatten(mut made: Made) -> Made {
    let mesh = &mut made.mesh;
    let mut vertices: Vec<Vertex> = Vec::with_capacity(mesh.triangles.len() * 3);
    for triangle in &mut mesh.triangles {
        let corners = triangle.map(|vertex| mesh.vertices[vertex.0 as usize]);
        let [a, b, c] = corners.map(|vertex| mesh.points[vertex.point.0 as usize]);
        let normal = (b - a).cross(c - a).normalize_or(corners[0].normal);
        for (slot, vertex) in triangle.iter_mut().zip(corners) {
            *slot = VertexIndex(mesh::index(vertices.len()));
            vertices.push(Vertex { normal, ..vertex });
        }
    }
    mesh.vertices = vertices;
    made
}

/// Turns and scales a finished shape from the document's unit and axes to metres with y up.
pub(super) fn to_metres(made: &mut Made, frame: &Frame) {
    place(made, &frame.map());
}
