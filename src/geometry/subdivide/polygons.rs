//! A cage of polygons in, a refined mesh with limit normals out.

use glam::{DVec2, DVec3};

use super::chart::chart;
use super::level::{Channel, Level};
use super::limit::{Limit, position};
use super::near;
use super::sharpness::{Around, ENDLESS, VertexClass};
use super::topology::{NONE, Ring, Topology};
use super::{Scheme, Split, SubdivideFault, dual_limit, limit, refine};
use crate::geometry::mesh::polygon::Face;
use crate::geometry::mesh::triangulate::triangulate_in_space;
use crate::geometry::mesh::{Color, PointIndex, PolygonMesh, index};
use crate::geometry::number::cos_degrees;

/// The most steps: more fit no mesh.
const STEPS: u32 = 16;

/// How far to refine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// So many steps, at least one.
    Levels(u32),
    /// Until the mesh lies within this distance of the limit, as far as samples tell.
    Tolerance(f64),
}

/// Edges of a cage that are sharp.
#[derive(Clone, Debug, PartialEq)]
pub struct Crease {
    /// Which.
    pub edges: CreaseEdges,
    /// How many steps they stay sharp; from [`ENDLESS`] on for ever.
    pub sharpness: f64,
}

/// Some edges of a cage.
#[derive(Clone, Debug, PartialEq)]
pub enum CreaseEdges {
    /// Those between two vertices each.
    Pairs(Vec<[u32; 2]>),
    /// Those at which the faces turn by more than this many degrees.
    Angle(f64),
    /// Those that the cage itself says are sharp, and its sharp vertices, each for as many steps as it says.
    Own,
}

/// What is asked of a refinement.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The scheme.
    pub scheme: Scheme,
    /// How far.
    pub aim: Aim,
    /// Whether the vertices are put on the limit surface.
    pub limit: bool,
    /// Whether vertices of a border that belong to one face alone stay where they are.
    pub border_corners: bool,
    /// Sharp edges; a later one overrides an earlier.
    pub creases: Vec<Crease>,
    /// Sharp vertices and how many steps they stay so.
    pub corners: Vec<(u32, f64)>,
    /// Whether faces are cut into triangles first where the scheme wants that.
    pub triangulate: bool,
}

/// A refined cage.
#[derive(Clone, Debug, Default)]
pub struct Subdivided {
    /// The mesh, with normals unless nothing is smooth.
    pub mesh: PolygonMesh,
    /// Distance of the mesh from the limit surface, sampled.
    pub distance: f64,
    /// Steps made.
    pub levels: u32,
    /// Vertices of the cage that are smooth, ends of creases, on creases, corners.
    pub classes: [u32; 4],
    /// Faces of the cage that were cut into triangles.
    pub triangulated: u32,
}

/// Refines a cage. Time and memory O(faces made), but for O(k log k) at a vertex of k edges of the cage.
///
/// # Errors
/// The first fault of the cage or of what is asked; more than `triangle_limit` triangles, before memory is taken.
pub fn subdivide(
    mesh: &PolygonMesh,
    options: &Options,
    triangle_limit: u64,
) -> Result<Subdivided, SubdivideFault> {
    let mut cage = Cage::of(mesh, options)?;
    cage.sharpen(mesh, options)?;
    let classes = cage.classes();
    let (mut levels, scheme) = (0, options.scheme);
    let topology = &cage.level.topology;
    // Between two steps the borders of sqrt(3) are not those of its limit.
    let pairs = scheme == Scheme::Root3 && (0..index(topology.edges())).any(|edge| topology.is_border(edge));
    if let Aim::Levels(count) = options.aim
        && pairs
        && count % 2 == 1
    {
        return Err(SubdivideFault::OddLevels { levels: count });
    }
    loop {
        levels += 1;
        let wanted = if let Aim::Levels(count) = options.aim { count.max(1) } else { levels };
        let size = [cage.faces, cage.corners].map(|count| count as u64);
        let needed = scheme.triangles(size[0], size[1], wanted);
        if needed > triangle_limit || wanted > STEPS {
            return Err(SubdivideFault::TooMany { levels: wanted, needed, limit: triangle_limit });
        }
        cage.refine(scheme);
        if levels < wanted || (pairs && levels % 2 == 1) {
            continue;
        }
        let end = End::of(&cage, options);
        if let Aim::Tolerance(tolerance) = options.aim
            && end.distance > tolerance
        {
            continue;
        }
        let triangulated = cage.triangulated;
        return Ok(Subdivided {
            distance: end.distance,
            mesh: cage.mesh(mesh, options, end),
            levels,
            classes,
            triangulated,
        });
    }
}

/// A cage on its way.
struct Cage {
    level: Level,
    /// Texture coordinates over a topology of their own.
    charts: Option<Level>,
    /// Colors likewise.
    colors: Option<Level>,
    /// For each face the face of the given mesh it comes from.
    origin: Vec<u32>,
    faces: usize,
    corners: usize,
    triangulated: u32,
}

impl Cage {
    fn of(mesh: &PolygonMesh, options: &Options) -> Result<Self, SubdivideFault> {
        if let Some(vertex) = mesh.points.iter().position(|point| !point.is_finite()) {
            return Err(SubdivideFault::NotFinite { vertex: index(vertex) });
        }
        let flat = Flat::of(mesh, options)?;
        let vertices = index(mesh.points.len());
        let (faces, corners) = (flat.origin.len(), flat.source.len());
        let vertex_of = flat.source.iter().map(|corner| mesh.corners[*corner as usize].0).collect();
        let topology = Topology::of_faces(flat.start, vertex_of, vertices)?;
        let values = mesh.points.iter().flat_map(|point| point.to_array()).collect();
        let channels = vec![Channel { width: 3, values }];
        let named = |corners: &[u32]| -> Vec<u32> {
            let of = |corner: &u32| corners.get(*corner as usize).copied().unwrap_or(NONE);
            flat.source.iter().map(of).collect()
        };
        let uvs = mesh.uvs.iter().flat_map(|uv| uv.to_array()).collect();
        let charts =
            charted(&topology, options.scheme, &named(&mesh.corner_uvs), &Channel { width: 2, values: uvs });
        let shades = mesh.colors.iter().flat_map(|color| color.parts()).collect();
        let (names, shades) = (named(&mesh.corner_colors), Channel { width: 4, values: shades });
        let colors = charted(&topology, options.scheme, &names, &shades)
            .or_else(|| (!names.contains(&NONE)).then(|| averaged(&topology, &names, &shades)));
        let level = Level { topology, channels, ..Level::default() };
        let triangulated = flat.triangulated;
        Ok(Self { level, charts, colors, origin: flat.origin, faces, corners, triangulated })
    }

    fn sharpen(&mut self, mesh: &PolygonMesh, options: &Options) -> Result<(), SubdivideFault> {
        let topology = &self.level.topology;
        let mut edges = vec![0.0; topology.edges()];
        let edge_between = |a: u32, b: u32| {
            [a, b].into_iter().try_for_each(|vertex| self.check_vertex(vertex))?;
            Ok(topology.edge_between(a, b).ok_or(SubdivideFault::NoEdge { a, b })? as usize)
        };
        let mut own = false;
        for crease in &options.creases {
            match &crease.edges {
                CreaseEdges::Pairs(pairs) => {
                    for [a, b] in pairs {
                        edges[edge_between(*a, *b)?] = crease.sharpness;
                    }
                }
                CreaseEdges::Own => {
                    own = true;
                    if mesh.creases.is_empty() && mesh.sharp_points.is_empty() {
                        return Err(SubdivideFault::NoCreases);
                    }
                    for ([a, b], sharpness) in &mesh.creases {
                        edges[edge_between(a.0, b.0)?] = *sharpness;
                    }
                }
                CreaseEdges::Angle(degrees) => self.sharpen_angles(*degrees, crease.sharpness, &mut edges),
            }
        }
        let mut vertices = vec![0.0; topology.vertices()];
        if options.border_corners {
            let mut ring = Ring::default();
            for vertex in 0..index(topology.vertices()) {
                topology.ring(vertex, &mut ring);
                if ring.corners.len() == 1 {
                    vertices[vertex as usize] = ENDLESS;
                }
            }
        }
        for (point, sharpness) in mesh.sharp_points.iter().filter(|_| own) {
            vertices[point.subscript()] = *sharpness;
        }
        for (vertex, sharpness) in &options.corners {
            self.check_vertex(*vertex)?;
            vertices[*vertex as usize] = *sharpness;
        }
        for charts in [&mut self.charts, &mut self.colors].into_iter().flatten() {
            sharpen_charts(charts, &self.level.topology, &edges, &vertices);
        }
        if edges.iter().any(|sharpness| *sharpness > 0.0) {
            self.level.edge_sharpness = edges;
        }
        if vertices.iter().any(|sharpness| *sharpness > 0.0) {
            self.level.vertex_sharpness = vertices;
        }
        Ok(())
    }

    fn check_vertex(&self, vertex: u32) -> Result<(), SubdivideFault> {
        let count = index(self.level.topology.vertices());
        if vertex < count { Ok(()) } else { Err(SubdivideFault::NoVertex { vertex, count }) }
    }

    fn sharpen_angles(&self, degrees: f64, sharpness: f64, edges: &mut [f64]) {
        let topology = &self.level.topology;
        let normal = |corner: u32| {
            let corners = topology.face(topology.corner_face[corner as usize] as usize);
            let at = |k: usize| position(&self.level.channels[0], corners[k % corners.len()]);
            let sum: DVec3 = (1..corners.len()).map(|k| (at(k) - at(0)).cross(at(k + 1) - at(0))).sum();
            sum.normalize_or_zero()
        };
        for (edge, corner) in topology.edge_corner.iter().enumerate() {
            let twin = topology.twin[*corner as usize];
            if twin != NONE && normal(*corner).dot(normal(twin)) < cos_degrees(degrees) {
                edges[edge] = sharpness;
            }
        }
    }

    fn classes(&self) -> [u32; 4] {
        let (mut ring, mut around, mut counts) = (Ring::default(), Around::default(), [0; 4]);
        for vertex in 0..index(self.level.topology.vertices()) {
            self.level.topology.ring(vertex, &mut ring);
            around.read(&self.level, &ring);
            counts[match around.class() {
                VertexClass::Smooth => 0,
                VertexClass::Dart => 1,
                VertexClass::Crease => 2,
                VertexClass::Corner => 3,
            }] += 1;
        }
        counts
    }

    fn refine(&mut self, scheme: Scheme) {
        self.origin = origins(&self.level.topology, scheme, &self.origin);
        self.level = refine(&self.level, scheme);
        for charts in [&mut self.charts, &mut self.colors].into_iter().flatten() {
            *charts = refine(charts, scheme);
        }
    }

    fn mesh(self, given: &PolygonMesh, options: &Options, end: End) -> PolygonMesh {
        let End { topology, limit, dual, .. } = end;
        let on_limit = options.limit;
        let topology = topology.unwrap_or(self.level.topology);
        let points = if on_limit { &limit.channels[0] } else { &self.level.channels[0] };
        let mut made = PolygonMesh {
            points: (0..index(topology.vertices())).map(|vertex| position(points, vertex)).collect(),
            materials: given.materials.clone(),
            loop_ends: topology.face_start[1..].to_vec(),
            ..PolygonMesh::default()
        };
        let origin = if dual { &dual_origins(&self.origin, &topology) } else { &self.origin };
        made.faces = (origin.iter().enumerate())
            .map(|(face, from)| Face { loops_end: index(face) + 1, ..given.faces[*from as usize] })
            .collect();
        if !limit.corner_normals.is_empty()
            && limit.corner_normals.len() == topology.corners()
            && options.scheme != Scheme::Bilinear
        {
            made.normals = limit.normals;
            made.corner_normals = limit.corner_normals;
        }
        let ended = |charts: Level| match (dual, on_limit) {
            (true, _) => {
                let (topology, limit) = dual_limit(&widened(&charts));
                (limit.channels, topology.corner_vertex)
            }
            (false, true) => {
                (super::limit(&widened(&charts), options.scheme).channels, charts.topology.corner_vertex)
            }
            (false, false) => (charts.channels, charts.topology.corner_vertex),
        };
        if let Some((values, corners)) = self.charts.map(ended) {
            // Widened or not, the first two numbers are the coordinates.
            made.uvs = values[0].values.chunks_exact(values[0].width).map(DVec2::from_slice).collect();
            made.corner_uvs = corners;
        }
        if let Some((values, corners)) = self.colors.map(ended) {
            // Schemes that go through their vertices swing beyond them.
            made.colors = (values[0].values.as_chunks().0.iter()).map(|parts| Color::held(*parts)).collect();
            made.corner_colors = corners;
        }
        made.corners = topology.corner_vertex.into_iter().map(PointIndex).collect();
        made
    }
}

/// Values in charts end by the rule of the scheme inside; seams stay straight.
fn sharpen_charts(charts: &mut Level, whole: &Topology, edges: &[f64], vertices: &[f64]) {
    let topology = &charts.topology;
    charts.edge_sharpness = topology
        .edge_corner
        .iter()
        .map(|corner| edges[whole.corner_edge[*corner as usize] as usize])
        .collect();
    let mut ring = Ring::default();
    let mut made = Vec::with_capacity(topology.vertices());
    for vertex in 0..index(topology.vertices()) {
        topology.ring(vertex, &mut ring);
        let own = vertices[whole.corner_vertex[ring.corners[0] as usize] as usize];
        made.push(if ring.is_closed() { own } else { ENDLESS });
    }
    charts.vertex_sharpness = made;
}

/// Values of corners over a topology of their own, torn where faces disagree. None where there are none, and where faces
/// do not keep their corners, so that seams cannot be kept.
fn charted(topology: &Topology, scheme: Scheme, names: &[u32], values: &Channel) -> Option<Level> {
    if names.contains(&NONE) {
        return None;
    }
    let (torn, taken) = chart(topology, names);
    let keeps = matches!(scheme.split(), Split::Quads | Split::Triangles);
    let seamless = torn.edge_corner == topology.edge_corner;
    let channel = Channel {
        width: values.width,
        values: taken.iter().flat_map(|name| values.value(*name as usize)).copied().collect(),
    };
    (keeps || seamless).then(|| Level { topology: torn, channels: vec![channel], ..Level::default() })
}

/// One value for each vertex: the mean of those of its corners.
fn averaged(topology: &Topology, names: &[u32], values: &Channel) -> Level {
    let mut mean = Channel { width: values.width, values: vec![0.0; topology.vertices() * values.width] };
    let mut counts = vec![0.0; topology.vertices()];
    for (vertex, name) in topology.corner_vertex.iter().zip(names) {
        counts[*vertex as usize] += 1.0;
        let sum = &mut mean.values[*vertex as usize * values.width..];
        sum.iter_mut().zip(values.value(*name as usize)).for_each(|(sum, value)| *sum += value);
    }
    for (sum, count) in mean.values.chunks_exact_mut(values.width).zip(counts) {
        sum.iter_mut().for_each(|part| *part /= f64::max(count, 1.0));
    }
    Level { topology: topology.clone(), channels: vec![mean], ..Level::default() }
}

/// Values of two numbers have no normals: a third makes them flat positions.
fn widened(level: &Level) -> Level {
    let channel = &level.channels[0];
    let width = channel.width.max(3);
    let values = (0..level.topology.vertices()).flat_map(|vertex| {
        let value = channel.value(vertex);
        (0..width).map(|part| value.get(part).copied().unwrap_or(0.0))
    });
    Level {
        channels: vec![Channel { width, values: values.collect() }],
        topology: level.topology.clone(),
        edge_sharpness: level.edge_sharpness.clone(),
        vertex_sharpness: level.vertex_sharpness.clone(),
        step: level.step,
    }
}

/// For each face of the next level the face of the given mesh it comes from.
fn origins(old: &Topology, scheme: Scheme, from: &[u32]) -> Vec<u32> {
    let of_corner = |corner: &u32| from[old.corner_face[*corner as usize] as usize];
    match scheme.split() {
        Split::Quads | Split::Root3 => (0..index(old.corners())).map(|corner| of_corner(&corner)).collect(),
        Split::Triangles => from.iter().flat_map(|face| [*face; 4]).collect(),
        Split::Dual => (from.iter().copied())
            .chain(old.edge_corner.iter().map(of_corner))
            .chain(old.vertex_corner.iter().map(of_corner))
            .collect(),
    }
}

/// Of the faces of a limit mesh, which stand for the vertices of the level.
fn dual_origins(from: &[u32], dual: &Topology) -> Vec<u32> {
    (0..dual.faces()).map(|face| from[dual.face(face)[0] as usize]).collect()
}

/// What a refinement ends with.
struct End {
    /// That of the limit mesh, where it is another.
    topology: Option<Topology>,
    limit: Limit,
    dual: bool,
    distance: f64,
}

impl End {
    fn of(cage: &Cage, options: &Options) -> Self {
        let (level, scheme) = (&cage.level, options.scheme);
        if scheme.split() != Split::Dual {
            let limit = limit(level, scheme);
            let flat = scheme == Scheme::Bilinear;
            let distance = if flat { 0.0 } else { near::distance(level, &limit, options.limit) };
            return Self { topology: None, limit, dual: false, distance };
        }
        let (topology, limit) = dual_limit(level);
        let on_limit = Level { topology, channels: limit.channels.clone(), ..Level::default() };
        let distance = near::distance(&on_limit, &limit, true);
        if options.limit {
            return Self { topology: Some(on_limit.topology), limit, dual: true, distance };
        }
        // A vertex stands off by its way from the middle of the limit's face below it.
        let way = |vertex: u32| {
            let corners = on_limit.topology.face(vertex as usize);
            let sum: DVec3 = corners.iter().map(|corner| position(&limit.channels[0], *corner)).sum();
            position(&level.channels[0], vertex).distance(sum / f64::from(index(corners.len())))
        };
        let ways = (0..index(level.topology.vertices())).map(way).fold(0.0, f64::max);
        Self { topology: None, limit: Limit::default(), dual: false, distance: distance + ways }
    }
}

/// The faces of a mesh as the scheme wants them: for each corner that of the mesh it is.
struct Flat {
    start: Vec<u32>,
    source: Vec<u32>,
    origin: Vec<u32>,
    triangulated: u32,
}

impl Flat {
    fn of(mesh: &PolygonMesh, options: &Options) -> Result<Self, SubdivideFault> {
        let mut made = Self { start: vec![0], source: Vec::new(), origin: Vec::new(), triangulated: 0 };
        for face in 0..mesh.faces.len() {
            if mesh.loops_of(face).len() != 1 {
                return Err(SubdivideFault::Holes { face: index(face) });
            }
            let range = mesh.corners_of(face);
            if !options.scheme.wants_triangles() || range.len() <= 3 {
                made.push(range.map(index), face);
                continue;
            }
            if !options.triangulate {
                let corners = index(range.len());
                return Err(SubdivideFault::NotTriangles { face: index(face), corners });
            }
            made.triangulated += 1;
            let places: Vec<DVec3> = range.clone().map(|corner| mesh.position(corner)).collect();
            let cut = triangulate_in_space(&[&places]).map(|(cut, _)| cut).unwrap_or_default();
            for triangle in cut {
                made.push(triangle.into_iter().map(|corner| index(range.start) + corner), face);
            }
        }
        Ok(made)
    }

    fn push(&mut self, corners: impl Iterator<Item = u32>, face: usize) {
        self.source.extend(corners);
        self.start.push(index(self.source.len()));
        self.origin.push(index(face));
    }
}
