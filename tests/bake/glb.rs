//! A reader of `.glb` files that shares nothing with the one in `src/gltf`: JSON values and slices of bytes.

use std::collections::BTreeMap;

use serde_json::Value;

/// A file: its JSON and its binary chunk.
#[derive(Debug)]
pub(crate) struct Glb {
    pub(crate) json: Value,
    bin: Vec<u8>,
}

/// One mesh of a file. All primitives of triangles of a mesh that Kiln writes share their vertices, and so do all of
/// lines.
#[derive(Debug)]
pub(crate) struct Mesh {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) normals: Vec<[f64; 3]>,
    pub(crate) uvs: Option<Vec<[f64; 2]>>,
    /// Linear red, green and blue, and opacity where that is written.
    pub(crate) colors: Option<Vec<Vec<f64>>>,
    pub(crate) triangles: Vec<[usize; 3]>,
    pub(crate) lines: Lines,
}

/// The lines of a mesh.
#[derive(Debug, Default)]
pub(crate) struct Lines {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) segments: Vec<[usize; 2]>,
    /// As of a mesh.
    pub(crate) colors: Option<Vec<Vec<f64>>>,
    /// The material of each primitive.
    pub(crate) materials: Vec<Option<usize>>,
}

/// What is counted and summed over a mesh, points at equal positions taken as one.
#[derive(Debug, PartialEq)]
pub(crate) struct Facts {
    pub(crate) points: usize,
    pub(crate) area: f64,
    pub(crate) volume: f64,
    pub(crate) closed: bool,
    pub(crate) euler: i64,
    pub(crate) boundary: usize,
}

fn number(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize
}

fn count(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap_or(0)).expect("it fits")
}

/// An index that was read as a number.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "read from 16 or 32 bits without a sign"
)]
fn whole(number: f64) -> usize {
    number as usize
}

impl Glb {
    /// Splits a file into its chunks.
    pub(crate) fn new(bytes: &[u8]) -> Self {
        assert_eq!((&bytes[..4], number(bytes, 4)), (&b"glTF"[..], 2));
        assert_eq!(number(bytes, 8), bytes.len(), "the length in the header");
        let length = number(bytes, 12);
        assert_eq!((&bytes[16..20], length % 4), (&b"JSON"[..], 0));
        let json = serde_json::from_slice(&bytes[20..20 + length]).expect("JSON");
        let rest = &bytes[20 + length..];
        assert_eq!((&rest[4..8], number(rest, 0) % 4), (&b"BIN\0"[..], 0));
        assert_eq!(number(rest, 0) + 8, rest.len());
        Self { json, bin: rest[8..].to_vec() }
    }

    pub(crate) fn list(&self, key: &str) -> &[Value] {
        self.json[key].as_array().map_or(&[], Vec::as_slice)
    }

    /// The bytes of a view.
    pub(crate) fn view(&self, index: usize) -> &[u8] {
        let view = &self.list("bufferViews")[index];
        assert_eq!(view["buffer"], 0);
        let start = count(&view["byteOffset"]);
        &self.bin[start..start + count(&view["byteLength"])]
    }

    /// The numbers of an accessor, row after row.
    pub(crate) fn accessor(&self, index: usize) -> Vec<Vec<f64>> {
        let accessor = &self.list("accessors")[index];
        let columns = match accessor["type"].as_str() {
            Some("SCALAR") => 1,
            Some("VEC2") => 2,
            Some("VEC3") => 3,
            Some("VEC4") => 4,
            Some("MAT4") => 16,
            other => panic!("{other:?}"),
        };
        let width = match count(&accessor["componentType"]) {
            5121 => 1,
            5123 => 2,
            5125 | 5126 => 4,
            other => panic!("component type {other}"),
        };
        let kind = count(&accessor["componentType"]);
        let rows = count(&accessor["count"]);
        assert!(rows > 0, "accessor {index} is empty");
        let mut all = match accessor.get("bufferView") {
            Some(_) => self.rows(accessor, (kind, width), (rows, columns)),
            None => vec![vec![0.0; columns]; rows],
        };
        if let Some(sparse) = accessor.get("sparse") {
            let (indices, changed) = (&sparse["indices"], count(&sparse["count"]));
            let short = count(&indices["componentType"]);
            let places = self.rows(indices, (short, if short == 5123 { 2 } else { 4 }), (changed, 1));
            let places: Vec<usize> = places.iter().map(|row| whole(row[0])).collect();
            assert!(places.windows(2).all(|pair| pair[0] < pair[1]), "accessor {index}: indices increase");
            for (place, row) in
                places.iter().zip(self.rows(&sparse["values"], (kind, width), (changed, columns)))
            {
                all[*place] = row;
            }
        }
        all
    }

    /// Rows of numbers in a view, from an offset on.
    fn rows(
        &self,
        place: &Value,
        (kind, width): (usize, usize),
        (rows, columns): (usize, usize),
    ) -> Vec<Vec<f64>> {
        let (view, offset) = (count(&place["bufferView"]), count(&place["byteOffset"]));
        assert_eq!((count(&self.list("bufferViews")[view]["byteOffset"]) + offset) % width, 0, "alignment");
        let bytes = &self.view(view)[offset..offset + rows * columns * width];
        let read = |bytes: &[u8]| match kind {
            5121 => f64::from(bytes[0]),
            5123 => f64::from(u16::from_le_bytes(bytes.try_into().expect("two bytes"))),
            5125 => f64::from(u32::from_le_bytes(bytes.try_into().expect("four bytes"))),
            _ => f64::from(f32::from_le_bytes(bytes.try_into().expect("four bytes"))),
        };
        bytes.chunks(columns * width).map(|row| row.chunks(width).map(read).collect()).collect()
    }

    /// The morph targets of a mesh: for each the places of all vertices and their normals at weight 1.
    pub(crate) fn targets(&self, index: usize) -> Vec<[Vec<[f64; 3]>; 2]> {
        let (surfaces, _) = self.primitives(index);
        let mesh = self.mesh(index);
        let targets = surfaces[0]["targets"].as_array().map_or(&[][..], Vec::as_slice);
        assert!(
            surfaces.iter().all(
                |other| other["targets"].as_array().map_or(&[][..], Vec::as_slice).len() == targets.len()
            )
        );
        let moved = |base: &[[f64; 3]], way: &Value| {
            let ways = self.accessor(count(way));
            assert_eq!(ways.len(), base.len());
            base.iter().zip(ways).map(|(from, way)| [0, 1, 2].map(|axis| from[axis] + way[axis])).collect()
        };
        let of = |target: &Value| {
            [moved(&mesh.positions, &target["POSITION"]), moved(&mesh.normals, &target["NORMAL"])]
        };
        targets.iter().map(of).collect()
    }

    fn vectors<const N: usize>(&self, primitive: &Value, name: &str) -> Option<Vec<[f64; N]>> {
        let index = primitive["attributes"].get(name)?;
        let row = |row: Vec<f64>| <[f64; N]>::try_from(row).expect("the width of the attribute");
        Some(self.accessor(count(index)).into_iter().map(row).collect())
    }

    fn colors(&self, primitive: &Value) -> Option<Vec<Vec<f64>>> {
        let index = count(primitive["attributes"].get("COLOR_0")?);
        let accessor = &self.list("accessors")[index];
        let whole = count(&accessor["componentType"]) == 5121;
        assert_eq!(accessor["normalized"] == true, whole);
        let mut colors = self.accessor(index);
        if whole {
            colors.iter_mut().flatten().for_each(|part| *part /= 255.0);
        }
        assert!(colors.iter().flatten().all(|part| (0.0..=1.0).contains(part)));
        Some(colors)
    }

    /// The primitives of a mesh: those of triangles, then those of lines.
    fn primitives(&self, index: usize) -> (Vec<&Value>, Vec<&Value>) {
        let primitives = self.list("meshes")[index]["primitives"].as_array().expect("primitives");
        let mode = |primitive: &Value| primitive.get("mode").map_or(4, count);
        assert!(primitives.iter().all(|primitive| matches!(mode(primitive), 1 | 4)));
        primitives.iter().partition(|primitive| mode(primitive) == 4)
    }

    /// The indices of primitives that share their positions.
    fn indices(&self, primitives: &[&Value]) -> Vec<usize> {
        let of = |primitive: &&Value| {
            assert_eq!(primitive["attributes"]["POSITION"], primitives[0]["attributes"]["POSITION"]);
            self.accessor(count(&primitive["indices"]))
        };
        primitives.iter().flat_map(of).map(|row| whole(row[0])).collect()
    }

    /// A mesh by its place in the file.
    pub(crate) fn mesh(&self, index: usize) -> Mesh {
        let (surfaces, _) = self.primitives(index);
        let indices = self.indices(&surfaces);
        let (triangles, rest) = indices.as_chunks::<3>();
        assert!(rest.is_empty());
        let first = surfaces.first().copied().unwrap_or(&Value::Null);
        Mesh {
            positions: self.vectors(first, "POSITION").unwrap_or_default(),
            normals: self.vectors(first, "NORMAL").unwrap_or_default(),
            uvs: self.vectors(first, "TEXCOORD_0"),
            colors: self.colors(first),
            triangles: triangles.to_vec(),
            lines: self.lines(index),
        }
    }

    fn lines(&self, index: usize) -> Lines {
        let (_, lines) = self.primitives(index);
        let Some(first) = lines.first() else { return Lines::default() };
        let indices = self.indices(&lines);
        let (segments, rest) = indices.as_chunks::<2>();
        assert!(rest.is_empty());
        Lines {
            positions: self.vectors(first, "POSITION").expect("positions"),
            segments: segments.to_vec(),
            colors: self.colors(first),
            materials: lines.iter().map(|one| one.get("material").map(count)).collect(),
        }
    }

    /// The mesh of a name.
    pub(crate) fn named(&self, name: &str) -> Mesh {
        let place = self.list("meshes").iter().position(|mesh| mesh["name"] == name);
        self.mesh(place.unwrap_or_else(|| panic!("no mesh {name}")))
    }

    /// Everything that the specification demands of what is written here.
    pub(crate) fn check(&self) {
        assert!(self.json.get("extensionsRequired").is_none());
        assert_eq!(count(&self.list("buffers")[0]["byteLength"]), self.bin.len());
        let mut ends = 0;
        for (index, view) in self.list("bufferViews").iter().enumerate() {
            let start = count(&view["byteOffset"]);
            assert!(start >= ends && start.is_multiple_of(4), "view {index} overlaps or is not aligned");
            ends = start + self.view(index).len();
        }
        for mesh in 0..self.list("meshes").len() {
            self.check_mesh(mesh);
        }
        self.check_nodes();
        for texture in self.list("textures") {
            assert!(count(&texture["source"]) < self.list("images").len());
            assert!(count(&texture["sampler"]) < self.list("samplers").len());
        }
    }

    fn check_mesh(&self, index: usize) {
        let mesh = self.mesh(index);
        let vertices = mesh.positions.len();
        assert_eq!(mesh.normals.len(), vertices);
        assert!(mesh.triangles.iter().flatten().all(|corner| *corner < vertices), "an index is out of range");
        assert!(mesh.positions.iter().chain(&mesh.normals).flatten().all(|number| number.is_finite()));
        for normal in &mesh.normals {
            let square: f64 = normal.iter().map(|part| part * part).sum();
            assert!((square - 1.0).abs() < 1e-5, "a normal has the square {square}");
        }
        self.check_lines(index, &mesh.lines);
        for primitive in self.primitives(index).0 {
            let accessor = &self.list("accessors")[count(&primitive["indices"])];
            let wide = count(&accessor["componentType"]) == 5125;
            assert_eq!(wide, vertices > 65_535, "{vertices} vertices");
            let position = count(&primitive["attributes"]["POSITION"]);
            self.check_bounds(position);
            if let Some(tangents) = self.vectors::<4>(primitive, "TANGENT") {
                assert_eq!(tangents.len(), vertices);
                for [x, y, z, w] in tangents {
                    assert!((x * x + y * y + z * z - 1.0).abs() < 1e-4 && w.abs() == 1.0);
                }
            }
            if let Some(material) = primitive.get("material") {
                assert!(count(material) < self.list("materials").len());
            }
        }
        if let Some(colors) = mesh.colors {
            assert_eq!(colors.len(), vertices);
        }
        if let Some(uvs) = mesh.uvs {
            assert!(uvs.len() == vertices && uvs.iter().flatten().all(|number| number.is_finite()));
        }
    }

    fn check_lines(&self, index: usize, lines: &Lines) {
        let vertices = lines.positions.len();
        assert!(lines.segments.iter().flatten().all(|end| *end < vertices), "an index is out of range");
        assert!(lines.positions.iter().flatten().all(|number| number.is_finite()));
        for primitive in self.primitives(index).1 {
            let accessor = &self.list("accessors")[count(&primitive["indices"])];
            assert_eq!(count(&accessor["componentType"]) == 5125, vertices > 65_535, "{vertices} vertices");
            let attributes = primitive["attributes"].as_object().expect("attributes");
            // Without normals they are shown without light.
            assert!(attributes.keys().all(|name| matches!(name.as_str(), "POSITION" | "COLOR_0")));
            self.check_bounds(count(&attributes["POSITION"]));
            if let Some(material) = primitive.get("material") {
                assert!(count(material) < self.list("materials").len());
            }
        }
    }

    fn check_bounds(&self, accessor: usize) {
        let rows = self.accessor(accessor);
        let written = &self.list("accessors")[accessor];
        for axis in 0..3 {
            let column = || rows.iter().map(|row| row[axis]);
            let (min, max) =
                (column().fold(f64::INFINITY, f64::min), column().fold(f64::NEG_INFINITY, f64::max));
            // The JSON library reads decimals to within a unit in the last place of a double.
            #[expect(clippy::cast_possible_truncation, reason = "the file holds single precision")]
            let single = |number: Option<f64>| number.map(|number| number as f32);
            let stated = (single(written["min"][axis].as_f64()), single(written["max"][axis].as_f64()));
            assert_eq!(stated, (single(Some(min)), single(Some(max))));
        }
    }

    fn check_nodes(&self) {
        let nodes = self.list("nodes");
        let mut parents = vec![0; nodes.len()];
        let scene = &self.list("scenes")[count(&self.json["scene"])];
        let children = nodes.iter().map(|node| &node["children"]).chain([&scene["nodes"]]);
        // Coarser levels of detail stand in no scene.
        let children = children.chain(nodes.iter().map(|node| &node["extensions"]["MSFT_lod"]["ids"]));
        for child in children.filter_map(Value::as_array).flatten() {
            parents[count(child)] += 1;
        }
        assert!(parents.iter().all(|parents| *parents == 1), "each node stands once: {parents:?}");
        for node in nodes {
            if let Some(mesh) = node.get("mesh") {
                assert!(count(mesh) < self.list("meshes").len());
            }
        }
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Mesh {
    /// The vector across a triangle whose length is twice its area.
    pub(crate) fn across(&self, triangle: [usize; 3]) -> [f64; 3] {
        let [a, b, c] = triangle.map(|corner| self.positions[corner]);
        cross(minus(b, a), minus(c, a))
    }

    /// The greatest angle in degrees between the normal of a corner and its triangle.
    pub(crate) fn greatest_lean(&self) -> f64 {
        let lean = |triangle: &[usize; 3]| {
            let flat = self.across(*triangle);
            let length = dot(flat, flat).sqrt();
            let cosine = |corner: &usize| dot(self.normals[*corner], flat) / length;
            triangle.iter().map(cosine).fold(1.0, f64::min)
        };
        let least = self.triangles.iter().map(lean).fold(1.0, f64::min);
        kiln::geometry::number::acos(least.clamp(-1.0, 1.0)).to_degrees()
    }

    pub(crate) fn facts(&self) -> Facts {
        let bits = |position: &[f64; 3]| position.map(|number| (number + 0.0).to_bits());
        let mut places = BTreeMap::new();
        for position in &self.positions {
            let next = places.len();
            places.entry(bits(position)).or_insert(next);
        }
        let point = |corner: usize| places[&bits(&self.positions[corner])];
        let mut edges: BTreeMap<(usize, usize), (usize, i64)> = BTreeMap::new();
        let (mut area, mut volume) = (0.0, 0.0);
        let origin = self.positions.first().copied().unwrap_or_default();
        for triangle in &self.triangles {
            let flat = self.across(*triangle);
            area += dot(flat, flat).sqrt() / 2.0;
            volume += dot(minus(self.positions[triangle[0]], origin), flat) / 6.0;
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                let (from, to) = (point(triangle[from]), point(triangle[to]));
                let edge = edges.entry((from.min(to), from.max(to))).or_default();
                edge.0 += 1;
                edge.1 += if from < to { 1 } else { -1 };
            }
        }
        let signed = |number: usize| i64::try_from(number).expect("it fits");
        Facts {
            points: places.len(),
            area,
            volume,
            closed: !edges.is_empty() && edges.values().all(|(_, balance)| *balance == 0),
            euler: signed(places.len()) - signed(edges.len()) + signed(self.triangles.len()),
            boundary: edges.values().filter(|(uses, _)| *uses == 1).count(),
        }
    }
}
