//! Realized shapes as bytes: every bit of every number, in the order of the fields, little-endian.
//!
//! Promise: what is read is what was written. Bytes that are something else are told from that, not trusted: no count is believed
//! before the bytes for it are there, and no index that leads nowhere is let through.

use glam::{DVec2, DVec3};

use super::recipe_hash::Met;
use super::shape::Made;
use super::{Faces, Note};
use crate::geometry::mesh::{
    Anchor, Color, Mesh, PointIndex, Run, Strand, Vertex, VertexIndex, Wire, WirePoint,
};
use crate::geometry::tessellate::{Deviation, Evidence};

/// A shape and how many sources its anchors count, as bytes; none where it names what was not met.
pub(super) fn encode(made: &Made, sources: u32, met: &Met) -> Option<Vec<u8>> {
    let Made { mesh, wire, materials, deviation, tolerance, notes, levels } = made;
    let mut out = Out(Vec::with_capacity(size(made)));
    out.word(sources);
    out.word(*levels);
    out.number(deviation.bound);
    out.byte(match deviation.evidence {
        Evidence::Exact => 0,
        Evidence::Proved => 1,
        Evidence::Sampled => 2,
    });
    out.byte(u8::from(tolerance.is_some()));
    out.number(tolerance.unwrap_or(0.0));
    out.count(materials.len());
    for material in materials {
        let place = |material| met.materials.iter().position(|known| *known == material);
        out.word(match material {
            Some(material) => u32::try_from(place(*material)?).ok()?,
            None => u32::MAX,
        });
    }
    out.count(notes.len());
    for (shape, note) in notes {
        out.word(u32::try_from(met.shapes.iter().position(|known| known == shape)?).ok()?);
        let (kind, faces) = match note {
            Note::Dropped(faces) => (0, faces),
            Note::Flat(faces) => (1, faces),
            Note::Crossing(faces) => (2, faces),
            Note::Triangulated(faces) => (3, faces),
            Note::Classes(counts) => {
                out.byte(4);
                counts.iter().for_each(|count| out.word(*count));
                continue;
            }
        };
        out.byte(kind);
        out.word(faces.first);
        out.count(faces.count);
    }
    out.count(mesh.points.len());
    mesh.points.iter().for_each(|point| out.place(*point));
    out.count(mesh.vertices.len());
    for Vertex { point, normal, uv, color, anchor } in &mesh.vertices {
        out.word(point.0);
        out.place(*normal);
        out.number(uv.x);
        out.number(uv.y);
        out.color(*color);
        out.anchor(anchor);
    }
    out.count(mesh.triangles.len());
    mesh.triangles.iter().flatten().for_each(|corner| out.word(corner.0));
    out.count(mesh.runs.len());
    for Run { origin, end } in &mesh.runs {
        out.word(*origin);
        out.word(*end);
    }
    out.count(wire.points.len());
    for WirePoint { position, color, anchor } in &wire.points {
        out.place(*position);
        out.color(*color);
        out.anchor(anchor);
    }
    out.count(wire.strands.len());
    for Strand { end, closed, origin } in &wire.strands {
        out.word(*end);
        out.byte(u8::from(*closed));
        out.word(*origin);
    }
    Some(out.0)
}

/// About how many bytes a shape takes.
pub(super) fn size(made: &Made) -> usize {
    let Mesh { points, vertices, triangles, .. } = &made.mesh;
    256 + 24 * points.len() + 80 * vertices.len() + 12 * triangles.len() + 64 * made.wire.points.len()
}

/// The shape of some bytes, and how many sources it has; none where they are no such.
pub(super) fn decode(bytes: &[u8], met: &Met) -> Option<(Made, u32)> {
    let mut from = In(bytes);
    let (sources, levels) = (from.word()?, from.word()?);
    let bound = from.number()?;
    let evidence = match from.byte()? {
        0 => Evidence::Exact,
        1 => Evidence::Proved,
        2 => Evidence::Sampled,
        _ => return None,
    };
    let (has_tolerance, tolerance) = (from.truth()?, from.number()?);
    let materials = from.list(4, |from| match from.word()? {
        u32::MAX => Some(None),
        place => met.materials.get(place as usize).copied().map(Some),
    })?;
    let notes = from.list(17, |from| {
        let shape = *met.shapes.get(from.word()? as usize)?;
        let (kind, first) = (from.byte()?, from.word()?);
        if kind == 4 {
            return Some((shape, Note::Classes([first, from.word()?, from.word()?, from.word()?])));
        }
        let faces = Faces { first, count: usize::try_from(from.long()?).ok()? };
        let note = match kind {
            0 => Note::Dropped(faces),
            1 => Note::Flat(faces),
            2 => Note::Crossing(faces),
            3 => Note::Triangulated(faces),
            _ => return None,
        };
        Some((shape, note))
    })?;
    let points = from.list(24, In::place)?;
    let vertices = from.list(80, |from| {
        let point = PointIndex(from.word()?);
        let normal = from.place()?;
        let uv = DVec2::new(from.number()?, from.number()?);
        Some(Vertex { point, normal, uv, color: from.color()?, anchor: from.anchor()? })
    })?;
    let triangles = from.list(12, |from| {
        Some([VertexIndex(from.word()?), VertexIndex(from.word()?), VertexIndex(from.word()?)])
    })?;
    let runs = from.list(8, |from| Some(Run { origin: from.word()?, end: from.word()? }))?;
    let mesh = Mesh { points, vertices, triangles, runs };
    let points = from.list(60, |from| {
        Some(WirePoint { position: from.place()?, color: from.color()?, anchor: from.anchor()? })
    })?;
    let strands =
        from.list(9, |from| Some(Strand { end: from.word()?, closed: from.truth()?, origin: from.word()? }))?;
    let wire = Wire { points, strands };
    let deviation = Deviation { bound, evidence };
    let tolerance = has_tolerance.then_some(tolerance);
    let made = Made { mesh, wire, materials, deviation, tolerance, notes, levels };
    (from.0.is_empty() && holds(&made)).then_some((made, sources))
}

/// Whether every index leads somewhere, and runs and strands cover all.
fn holds(made: &Made) -> bool {
    let Made { mesh, wire, materials, .. } = made;
    mesh.vertices.iter().all(|vertex| vertex.point.subscript() < mesh.points.len())
        && mesh.triangles.iter().flatten().all(|corner| corner.subscript() < mesh.vertices.len())
        && cover(mesh.runs.iter().map(|run| (run.end, run.origin)), mesh.triangles.len(), materials.len())
        && cover(
            wire.strands.iter().map(|strand| (strand.end, strand.origin)),
            wire.points.len(),
            materials.len(),
        )
}

/// Whether ends, each with an origin, grow up to a count.
fn cover(mut ends: impl Iterator<Item = (u32, u32)>, all: usize, origins: usize) -> bool {
    let mut last = 0;
    let good = ends.all(|(end, origin)| {
        let grows = end >= last && (origin as usize) < origins;
        last = end;
        grows
    });
    good && last as usize == all
}

/// Bytes that are written.
struct Out(Vec<u8>);

impl Out {
    fn byte(&mut self, byte: u8) {
        self.0.push(byte);
    }

    fn word(&mut self, word: u32) {
        self.0.extend(word.to_le_bytes());
    }

    fn count(&mut self, count: usize) {
        self.0.extend((count as u64).to_le_bytes());
    }

    fn number(&mut self, number: f64) {
        self.0.extend(number.to_bits().to_le_bytes());
    }

    fn place(&mut self, place: DVec3) {
        place.to_array().into_iter().for_each(|part| self.number(part));
    }

    fn color(&mut self, color: Color) {
        color.0.into_iter().for_each(|part| self.word(part.to_bits()));
    }

    fn anchor(&mut self, anchor: &Anchor) {
        self.word(anchor.source);
        self.number(anchor.u);
        self.number(anchor.v);
    }
}

/// Bytes that are read.
struct In<'a>(&'a [u8]);

impl In<'_> {
    fn bytes<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*first)
    }

    fn byte(&mut self) -> Option<u8> {
        self.bytes::<1>().map(|[byte]| byte)
    }

    fn truth(&mut self) -> Option<bool> {
        self.byte().filter(|byte| *byte < 2).map(|byte| byte == 1)
    }

    fn word(&mut self) -> Option<u32> {
        self.bytes().map(u32::from_le_bytes)
    }

    fn long(&mut self) -> Option<u64> {
        self.bytes().map(u64::from_le_bytes)
    }

    fn number(&mut self) -> Option<f64> {
        self.bytes().map(|bytes| f64::from_bits(u64::from_le_bytes(bytes)))
    }

    fn place(&mut self) -> Option<DVec3> {
        Some(DVec3::new(self.number()?, self.number()?, self.number()?))
    }

    fn color(&mut self) -> Option<Color> {
        let mut part = || self.word().map(f32::from_bits);
        Some(Color([part()?, part()?, part()?, part()?]))
    }

    fn anchor(&mut self) -> Option<Anchor> {
        Some(Anchor { source: self.word()?, u: self.number()?, v: self.number()? })
    }

    /// A list of items that take this many bytes each.
    fn list<T>(&mut self, each: usize, read: impl Fn(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let count = usize::try_from(self.long()?).ok()?;
        if count > self.0.len() / each {
            return None;
        }
        (0..count).map(|_| read(self)).collect()
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::{decode, encode};
    use crate::geometry::mesh::{
        Anchor, Color, Mesh, PointIndex, Run, Strand, Vertex, VertexIndex, Wire, WirePoint,
    };
    use crate::geometry::tessellate::{Deviation, Evidence};
    use crate::model::{MaterialHandle, ShapeHandle};
    use crate::realize::recipe_hash::Met;
    use crate::realize::shape::Made;
    use crate::realize::{Faces, Note};

    fn made() -> Made {
        let anchor = Anchor { source: 7, u: 0.1, v: -0.0 };
        let color = Color([0.25, 0.5, 1.0, f32::MIN_POSITIVE]);
        let vertex = |point| Vertex {
            point: PointIndex(point),
            normal: DVec3::Y,
            uv: DVec2::new(0.1 + 0.2, 1e-300),
            color,
            anchor,
        };
        Made {
            mesh: Mesh {
                points: vec![DVec3::ZERO, DVec3::X, DVec3::NEG_Z / 3.0],
                vertices: [0, 1, 2].map(vertex).to_vec(),
                triangles: vec![[0, 1, 2].map(VertexIndex)],
                runs: vec![Run { origin: 1, end: 1 }],
            },
            wire: Wire {
                points: vec![WirePoint { position: DVec3::ONE, color, anchor }; 2],
                strands: vec![Strand { end: 2, closed: true, origin: 0 }],
            },
            materials: vec![None, Some(MaterialHandle(9))],
            deviation: Deviation { bound: 0.1, evidence: Evidence::Sampled },
            tolerance: Some(0.3),
            notes: vec![
                (ShapeHandle(4), Note::Crossing(Faces { first: 3, count: 5 })),
                (ShapeHandle(4), Note::Classes([9, 1, 2, 8])),
            ],
            levels: 2,
        }
    }

    fn met() -> Met {
        Met { shapes: vec![ShapeHandle(2), ShapeHandle(4)], materials: vec![MaterialHandle(9)] }
    }

    /// Debug prints every number so that it reads back as itself.
    #[test]
    fn what_is_read_is_what_was_written_and_damage_is_told() {
        let (made, met) = (made(), met());
        let bytes = encode(&made, 8, &met).expect("all of it was met");
        let (read, sources) = decode(&bytes, &met).expect("it is whole");
        assert_eq!((format!("{read:?}"), sources), (format!("{made:?}"), 8));
        for end in 0..bytes.len() {
            assert!(decode(&bytes[..end], &met).is_none(), "{end}");
        }
        // Every bit of what is not a number matters, or leads nowhere worse than to another shape.
        for at in 0..bytes.len() {
            let mut other = bytes.clone();
            other[at] ^= 0x81;
            if let Some((read, _)) = decode(&other, &met) {
                let mesh = &read.mesh;
                assert!(
                    mesh.triangles.iter().flatten().all(|corner| corner.subscript() < mesh.vertices.len())
                );
                assert!(mesh.vertices.iter().all(|vertex| vertex.point.subscript() < mesh.points.len()));
            }
        }
        let nothing = Met::default();
        assert!(encode(&made, 8, &nothing).is_none());
        assert!(decode(&bytes, &nothing).is_none());
    }
}
