//! The proof that a scene can be written.

use glam::{DQuat, DVec3};
use thiserror::Error;

mod morph;
mod motion;

use crate::geometry::mesh::{Color, VertexIndex};

use super::{Camera, Collider, Geometry, Lens, Light, LightKind, MeshUse, Node, Scene};

/// A scene that holds what glTF demands. Made only by [`check`].
#[derive(Clone, Copy, Debug)]
pub struct Checked<'a> {
    scene: &'a Scene,
}

impl<'a> Checked<'a> {
    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }
}

/// What keeps a scene from being written.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SceneError {
    /// No triangle and no line anywhere.
    #[error("there is nothing to write: no triangle and no line in any mesh")]
    Empty,
    /// A geometry has neither triangles nor lines.
    #[error("shape `{0}` has no triangle and no line")]
    NoTriangle(String),
    /// Nothing of a wire can be seen.
    #[error("shape `{0}` has no length: rounded to single precision each of its lines is a point")]
    NoLength(String),
    /// A texture is shown on lines.
    #[error(
        "shape `{0}` is a wire, and its material `{1}` shows a texture, or shine along one direction: lines have no place for it"
    )]
    TexturedWire(String, String),
    /// Nothing of a geometry can be seen.
    #[error(
        "shape `{0}` has no area: rounded to single precision each of its triangles is a line or a point"
    )]
    NoArea(String),
    /// A number is not finite or does not fit single precision.
    #[error("shape `{0}` has a coordinate that is not finite or beyond single precision")]
    NotFinite(String),
    /// A normal or tangent is not of unit length.
    #[error("shape `{0}` has a {1} that is not of unit length")]
    NotUnit(String, &'static str),
    /// A color of a vertex is none.
    #[error("shape `{0}` has a vertex color whose parts are not from 0 to 1")]
    Color(String),
    /// Second texture coordinates are not one for each vertex, or leave the unit square.
    #[error("shape `{0}` has second texture coordinates that leave the unit square")]
    Lightmap(String),
    /// An attribute of its own is not one for each vertex, or not finite.
    #[error("shape `{0}` has an attribute `{1}` that is not finite at each vertex")]
    Attribute(String, String),
    /// A position is not on the grid of the scene.
    #[error("shape `{0}` has a coordinate that is not on the grid of the model")]
    OffGrid(String),
    /// An index points at nothing.
    #[error("{0} refers to something that does not exist")]
    Dangling(String),
    /// A texture is shown on a shape without texture coordinates.
    #[error(
        "shape `{0}` has no texture coordinates, but its material `{1}` shows a texture, or shine along one direction"
    )]
    NoUv(String, String),
    /// Runs do not cover the triangles in order.
    #[error("shape `{0}` has runs that do not cover its triangles")]
    Runs(String),
    /// More than 32-bit indices or 4 GiB can address.
    #[error("shape `{0}` is too large for a glTF file")]
    TooLarge(String),
    /// A state is not whole.
    #[error("state `{1}` of shape `{0}` has {2}")]
    Morph(String, String, &'static str),
    /// Nodes form a cycle.
    #[error("node `{0}` is its own ancestor")]
    Cycle(String),
    /// A skin is not whole.
    #[error("skin `{0}` has {1}")]
    Skin(String, &'static str),
    /// A motion cannot be written.
    #[error("clip `{0}` has {1}")]
    Animation(String, &'static str),
    /// A collider is not finite, or without extent.
    #[error("collider `{0}` has a size or a place that is beyond single precision")]
    Collider(String),
    /// A camera or light that cannot be written.
    #[error("node `{0}` has a {1} that glTF cannot hold")]
    View(String, &'static str),
    /// A node's transform is not finite, or its rotation not of unit length.
    #[error("node `{0}` has a transform that glTF cannot hold")]
    Transform(String),
}

/// Checks a scene. O(size of the scene).
///
/// # Errors
/// The first thing that is wrong.
pub fn check(scene: &Scene) -> Result<Checked<'_>, SceneError> {
    if scene.meshes.is_empty() {
        return Err(SceneError::Empty);
    }
    for geometry in &scene.geometries {
        check_geometry(geometry)?;
        check_attributes(geometry)?;
        check_grid(scene, geometry)?;
        morph::check(scene, geometry)?;
    }
    for mesh in &scene.meshes {
        check_use(scene, mesh)?;
    }
    for (index, node) in scene.nodes.iter().enumerate() {
        check_node(scene, index, node)?;
        check_view(node)?;
    }
    scene.colliders.iter().try_for_each(|collider| check_collider(scene, collider))?;
    motion::check(scene)?;
    Ok(Checked { scene })
}

fn check_view(node: &Node) -> Result<(), SceneError> {
    let held = |value: f64| value > 0.0 && value <= f64::from(f32::MAX);
    if let Some(Camera { lens, aspect, near, far }) = node.camera {
        let draws = match lens {
            Lens::Perspective { upright } => upright > 0.0 && upright < 180.0,
            Lens::Parallel { height } => held(height) && held(height * aspect) && far.is_some(),
        };
        let sees = draws && held(aspect) && held(near);
        if !sees || far.is_some_and(|far| !held(far) || far <= near) {
            return Err(SceneError::View(node.name.clone(), "camera"));
        }
    }
    if let Some(Light { kind, color, intensity, range }) = node.light {
        let lit =
            color.iter().all(|part| (0.0..=1.0).contains(part)) && (intensity == 0.0 || held(intensity));
        let cone = match kind {
            LightKind::Point | LightKind::Sun => true,
            LightKind::Spot { inner, outer } => inner >= 0.0 && inner < outer && outer <= 90.0,
        };
        if !lit || !cone || range.is_some_and(|range| !held(range)) {
            return Err(SceneError::View(node.name.clone(), "light"));
        }
    }
    Ok(())
}

fn check_collider(scene: &Scene, collider: &Collider) -> Result<(), SceneError> {
    let nodes = [Some(collider.node), collider.holder];
    if nodes.into_iter().flatten().any(|node| node >= scene.nodes.len()) {
        return Err(SceneError::Dangling(format!("collider `{}`", collider.name)));
    }
    let placed = collider.translation.abs().max_element() <= f64::from(f32::MAX);
    let turned = (collider.rotation.length_squared() - 1.0).abs() < 1e-6;
    if placed && turned && collider.body.is_sound() {
        Ok(())
    } else {
        Err(SceneError::Collider(collider.name.clone()))
    }
}

fn check_geometry(geometry: &Geometry) -> Result<(), SceneError> {
    let name = || geometry.name.clone();
    let mesh = &geometry.mesh;
    if mesh.triangles.is_empty() && geometry.wire.is_empty() {
        return Err(SceneError::NoTriangle(name()));
    }
    check_wire(geometry)?;
    if mesh.triangles.is_empty() {
        return Ok(());
    }
    // The greatest index is reserved for primitive restart.
    if mesh.vertices.len() >= u32::MAX as usize || mesh.triangles.len() >= u32::MAX as usize {
        return Err(SceneError::TooLarge(name()));
    }
    let limit = f64::from(f32::MAX);
    if !mesh.points.iter().all(|point| point.abs().max_element() <= limit) {
        return Err(SceneError::NotFinite(name()));
    }
    for vertex in &mesh.vertices {
        if vertex.point.0 as usize >= mesh.points.len() {
            return Err(SceneError::Dangling(format!("a vertex of shape `{}`", geometry.name)));
        }
        // The validator allows 0.0005; rounding to single precision costs 1e-7.
        if (vertex.normal.length_squared() - 1.0).abs() > 1e-6 || vertex.normal.is_nan() {
            return Err(SceneError::NotUnit(name(), "normal"));
        }
        if !vertex.uv.is_finite() {
            return Err(SceneError::NotFinite(name()));
        }
        if !is_color(vertex.color) {
            return Err(SceneError::Color(name()));
        }
    }
    let count = mesh.vertices.len();
    if mesh.triangles.iter().any(|triangle| triangle.iter().any(|vertex| vertex.0 as usize >= count)) {
        return Err(SceneError::Dangling(format!("a triangle of shape `{}`", geometry.name)));
    }
    let place = |vertex: VertexIndex| {
        mesh.points[mesh.vertices[vertex.0 as usize].point.0 as usize].as_vec3().as_dvec3()
    };
    let flat = |triangle: &[VertexIndex; 3]| {
        let [a, b, c] = triangle.map(place);
        (b - a).cross(c - a) == DVec3::ZERO
    };
    if mesh.triangles.iter().all(flat) {
        return Err(SceneError::NoArea(name()));
    }
    check_runs(geometry)?;
    check_lightmap(geometry)?;
    check_tangents(geometry)
}

fn is_color(color: Color) -> bool {
    color.0.iter().all(|part| (0.0..=1.0).contains(part))
}

fn check_grid(scene: &Scene, geometry: &Geometry) -> Result<(), SceneError> {
    let Some(grid) = scene.grid else { return Ok(()) };
    let lines = geometry.wire.points.iter().map(|point| point.position);
    let mut all = geometry.mesh.points.iter().copied().chain(lines);
    match all.find(|point| grid.place(*point).is_none()) {
        Some(_) => Err(SceneError::OffGrid(geometry.name.clone())),
        None => Ok(()),
    }
}

fn check_wire(geometry: &Geometry) -> Result<(), SceneError> {
    let wire = &geometry.wire;
    let name = || geometry.name.clone();
    if wire.is_empty() {
        return Ok(());
    }
    if wire.points.len() >= u32::MAX as usize {
        return Err(SceneError::TooLarge(name()));
    }
    let limit = f64::from(f32::MAX);
    if !wire.points.iter().all(|point| point.position.abs().max_element() <= limit) {
        return Err(SceneError::NotFinite(name()));
    }
    if !wire.points.iter().all(|point| is_color(point.color)) {
        return Err(SceneError::Color(name()));
    }
    let covers = wire.ranges().all(|(_, range)| range.len() >= 2);
    if !covers || wire.strands.last().is_none_or(|strand| strand.end as usize != wire.points.len()) {
        return Err(SceneError::Runs(name()));
    }
    let place = |point: u32| wire.points[point as usize].position.as_vec3();
    let long = wire.ranges().any(|(_, range)| {
        let first = place(range.start);
        range.skip(1).any(|point| place(point) != first)
    });
    if long { Ok(()) } else { Err(SceneError::NoLength(name())) }
}

fn check_runs(geometry: &Geometry) -> Result<(), SceneError> {
    let runs = &geometry.mesh.runs;
    let increasing = runs.windows(2).all(|pair| pair[0].end < pair[1].end);
    let covers = runs.last().is_some_and(|run| run.end as usize == geometry.mesh.triangles.len());
    if increasing && covers { Ok(()) } else { Err(SceneError::Runs(geometry.name.clone())) }
}

fn check_lightmap(geometry: &Geometry) -> Result<(), SceneError> {
    let Some(lightmap) = &geometry.lightmap else { return Ok(()) };
    let inside = |place: &[f32; 2]| place.iter().all(|part| (0.0..=1.0).contains(part));
    let whole = lightmap.places.len() == geometry.mesh.vertices.len() && geometry.uv;
    if whole && lightmap.places.iter().all(inside) {
        Ok(())
    } else {
        Err(SceneError::Lightmap(geometry.name.clone()))
    }
}

fn check_attributes(geometry: &Geometry) -> Result<(), SceneError> {
    for own in &geometry.attributes {
        let counts =
            [(&own.values, geometry.mesh.vertices.len()), (&own.of_lines, geometry.wire.points.len())];
        let held = |value: &f32| if own.bytes { (0.0..=1.0).contains(value) } else { value.is_finite() };
        let whole =
            counts.iter().all(|(values, count)| values.len() == count * own.width && values.iter().all(held));
        if !whole || !(1..=4).contains(&own.width) || !own.name.starts_with('_') {
            return Err(SceneError::Attribute(geometry.name.clone(), own.name.clone()));
        }
    }
    Ok(())
}

fn check_tangents(geometry: &Geometry) -> Result<(), SceneError> {
    let Some(tangents) = &geometry.tangents else { return Ok(()) };
    let unit =
        |[x, y, z, w]: &[f32; 4]| (x * x + y * y + z * z - 1.0).abs() < 1e-4 && (*w == 1.0 || *w == -1.0);
    if tangents.len() == geometry.mesh.vertices.len() && tangents.iter().all(unit) {
        Ok(())
    } else {
        Err(SceneError::NotUnit(geometry.name.clone(), "tangent"))
    }
}

fn check_use(scene: &Scene, mesh: &MeshUse) -> Result<(), SceneError> {
    let dangling = || SceneError::Dangling(format!("mesh `{}`", mesh.name));
    let geometry = scene.geometries.get(mesh.geometry).ok_or_else(dangling)?;
    let strands = geometry.wire.strands.iter().map(|strand| strand.origin);
    let mut origins = geometry.mesh.runs.iter().map(|run| run.origin).chain(strands);
    let origins = origins.all(|origin| (origin as usize) < mesh.materials.len());
    let materials = mesh.materials.iter().flatten().all(|material| *material < scene.materials.len());
    let levels = mesh.levels.iter().all(|level| {
        scene.meshes.get(level.mesh).is_some_and(|coarser| coarser.materials.len() == mesh.materials.len())
            && (0.0..=1.0).contains(&level.coverage)
    });
    if !origins || !materials || !levels {
        return Err(dangling());
    }
    for strand in &geometry.wire.strands {
        let worn = mesh.materials[strand.origin as usize].map(|material| &scene.materials[material]);
        if let Some(material) = worn.filter(|material| material.needs_uv()) {
            return Err(SceneError::TexturedWire(geometry.name.clone(), material.name.clone()));
        }
    }
    let shown = mesh.materials.iter().flatten().map(|material| &scene.materials[*material]);
    let textured = shown.into_iter().find(|material| material.needs_uv());
    match textured.filter(|_| !geometry.uv) {
        Some(material) => Err(SceneError::NoUv(geometry.name.clone(), material.name.clone())),
        None => Ok(()),
    }
}

fn check_node(scene: &Scene, index: usize, node: &Node) -> Result<(), SceneError> {
    if node.mesh.is_some_and(|mesh| mesh >= scene.meshes.len()) {
        return Err(SceneError::Dangling(format!("node `{}`", node.name)));
    }
    let limit = f64::from(f32::MAX);
    let sound = |translation: DVec3, rotation: DQuat, scale: DVec3| {
        translation.abs().max_element() <= limit
            && scale.abs().max_element() <= limit
            && (rotation.length_squared() - 1.0).abs() <= 1e-6
    };
    let own = sound(node.translation, node.rotation, node.scale);
    if !own || !node.instances.iter().all(|one| sound(one.translation, one.rotation, one.scale)) {
        return Err(SceneError::Transform(node.name.clone()));
    }
    let mut ancestor = node.parent;
    for _ in 0..scene.nodes.len() {
        let Some(parent) = ancestor else { return Ok(()) };
        if parent >= scene.nodes.len() {
            return Err(SceneError::Dangling(format!("node `{}`", node.name)));
        }
        if parent == index {
            break;
        }
        ancestor = scene.nodes[parent].parent;
    }
    if ancestor.is_none() { Ok(()) } else { Err(SceneError::Cycle(node.name.clone())) }
}
