//! Vertices that primitives share, joined, ordered and written once.
//!
//! Promise: each triangle keeps its corners and its turn; strips and fans become lists of the same triangles; those with a
//! corner twice are left out. Vertices with equal bytes in every attribute and target are one; those that nothing uses go.
//! Points and lines without indices keep their vertices and their order. Source: P. Sander, D. Nehab, J. Barczak, Fast triangle
//! reordering for vertex locality and reduced overdraw, 2007.

use std::collections::{BTreeMap, HashMap};

use glam::DVec3;
use rayon::prelude::{
    IndexedParallelIterator as _, IntoParallelIterator as _, IntoParallelRefIterator as _,
    IntoParallelRefMutIterator as _, ParallelIterator as _, ParallelSlice as _, ParallelSliceMut as _,
};
use serde_json::Value;

use super::accessor::{Elements, Source};
use super::column::{self, Column};
use super::document::{Fault, Object, as_index, list, whole};
use super::grid::MeshPlace;
use super::pin::Pins;
use super::{Options, primitives};
use crate::geometry::mesh::cache::FifoCache;
use crate::geometry::mesh::{VertexIndex, index};
use crate::optimize::{Order, order_triangles};

/// An attribute of the base, 0, or of a target, counted from 1.
pub(super) type Slot = (usize, String);

/// Primitives of one mesh that become one.
pub(super) struct Member {
    pub(super) mesh: usize,
    /// Places of the primitives in their mesh.
    pub(super) parts: Vec<usize>,
    /// What each attribute of them is called, and its accessor.
    slots: BTreeMap<Slot, usize>,
    pub(super) mode: usize,
    /// Indices as they are drawn, once they are; none for vertices in their order.
    pub(super) indices: Option<Vec<u32>>,
}

/// Vertices and what is drawn of them.
pub(super) struct Set {
    slots: BTreeMap<Slot, usize>,
    place: MeshPlace,
    pub(super) members: Vec<Member>,
    pub(super) columns: Vec<(Slot, Column)>,
    /// Vertices, once they are written.
    pub(super) count: usize,
    pub(super) tally: Tally,
}

/// What there was, and what there is.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    pub(super) vertices: [usize; 2],
    pub(super) triangles: [usize; 2],
    pub(super) misses: [u64; 2],
}

/// Triangles in a list, a strip and a fan.
const TRIANGLES: [usize; 3] = [4, 5, 6];

fn mode(primitive: &Value) -> usize {
    whole(primitive, "mode").unwrap_or(4)
}

fn slots(primitive: &Value) -> BTreeMap<Slot, usize> {
    let targets = primitive.get("targets").and_then(Value::as_array).into_iter().flatten();
    let maps = primitive.get("attributes").into_iter().chain(targets).enumerate();
    let named = |(target, map): (usize, &Value)| {
        let own = map.as_object().cloned().unwrap_or_default();
        own.into_iter().filter_map(move |(name, value)| Some(((target, name), as_index(&value)?)))
    };
    maps.flat_map(|(target, map)| named((target, map)).collect::<Vec<_>>()).collect()
}

/// Groups the primitives of meshes that do not stay as they are: those that share their positions share a set, if nothing else
/// of theirs is at odds. Neighbors of one mesh with one material become one.
pub(super) fn sets(root: &Object, pins: &Pins, places: &[MeshPlace]) -> Vec<Set> {
    let mut all: Vec<Set> = Vec::new();
    // Sets by their positions, or by their first attribute; only looked up.
    let mut known: HashMap<Option<usize>, Vec<usize>> = HashMap::new();
    for (mesh, own) in list(root, "meshes").iter().enumerate().filter(|(mesh, _)| !pins.meshes.contains(mesh))
    {
        let mut before: Option<(usize, &Value)> = None;
        for (part, primitive) in primitives(own).enumerate() {
            let slots = slots(primitive);
            let position = slots.get(&(0, "POSITION".to_owned())).or(slots.values().next()).copied();
            let candidates = known.entry(position).or_default();
            let fitting = candidates.iter().find(|set| fits(&all[**set], &slots, &places[mesh]));
            let set = fitting.copied().unwrap_or_else(|| {
                all.push(Set::new(places[mesh]));
                candidates.push(all.len() - 1);
                all.len() - 1
            });
            let own = &mut all[set];
            own.slots.extend(slots.iter().map(|(slot, accessor)| (slot.clone(), *accessor)));
            let joins = before.filter(|(last, other)| *last == set && alike(other, primitive));
            match own.members.last_mut().filter(|_| joins.is_some()) {
                Some(member) => member.parts.push(part),
                None => {
                    let mode = mode(primitive);
                    own.members.push(Member { mesh, parts: vec![part], slots, mode, indices: None });
                }
            }
            before = Some((set, primitive));
        }
    }
    all
}

fn fits(set: &Set, slots: &BTreeMap<Slot, usize>, place: &MeshPlace) -> bool {
    let same = |(slot, accessor): (&Slot, &usize)| set.slots.get(slot).is_none_or(|own| own == accessor);
    let targets = |slots: &BTreeMap<Slot, usize>| slots.keys().map(|(target, _)| *target).max();
    slots.iter().all(same)
        && targets(&set.slots) == targets(slots)
        && set.place.grid == place.grid
        && set.place.whole == place.whole
}

/// Whether two primitives differ in their indices alone, and draw triangles.
fn alike(one: &Value, other: &Value) -> bool {
    let plain = |primitive: &Value| {
        let told = ["extensions", "extras"].iter().any(|name| primitive.get(name).is_some());
        !told && TRIANGLES.contains(&mode(primitive))
    };
    let same = |name: &str| one.get(name) == other.get(name);
    plain(one) && plain(other) && ["attributes", "targets", "material"].into_iter().all(same)
}

impl Set {
    fn new(place: MeshPlace) -> Self {
        Self {
            slots: BTreeMap::new(),
            place,
            members: Vec::new(),
            columns: Vec::new(),
            count: 0,
            tally: Tally::default(),
        }
    }

    /// Reads, joins, orders and rewrites everything. Linear, some 200 ns a triangle.
    pub(super) fn pack(&mut self, source: &Source<'_>, options: &Options) -> Result<(), Fault> {
        let mut elements: BTreeMap<Slot, Elements<'_>> = BTreeMap::new();
        for (slot, accessor) in &self.slots {
            elements.insert(slot.clone(), source.sound(*accessor)?);
        }
        let count = elements.values().next().map_or(0, |own| own.count);
        let (drawn, columns) = rayon::join(
            || self.members.iter().map(|member| drawn(source, member, count)).collect::<Result<Vec<_>, _>>(),
            || columns(&elements, options, &self.place),
        );
        let (mut drawn, mut columns) = (drawn?, columns);
        self.tally.vertices[0] = count;
        self.tally_triangles(0, &drawn, count);
        let fixed = drawn.iter().any(|own| matches!(own, Drawn::Vertices));
        if !fixed {
            let first = first_alike(&columns, count);
            drawn.par_iter_mut().for_each(|own| own.rename(|vertex| first[vertex as usize]));
        }
        let position = elements.get(&(0, "POSITION".to_owned()));
        let place = |vertex: VertexIndex| {
            position.map_or(DVec3::ZERO, |own| DVec3::from_array(own.numbers::<3>(vertex.subscript())))
        };
        let order = if options.profile.is_compressed() { Order::Packing } else { Order::Drawing };
        for own in &mut drawn {
            if let Drawn::Triangles(triangles) = own {
                whole_ones(triangles);
                order_triangles(triangles, &place, order);
            }
        }
        self.count = count;
        if !fixed {
            let used = first_uses(&mut drawn, count);
            self.count = used.len();
            columns.par_iter_mut().for_each(|(_, column)| gather(column, &used));
        }
        self.tally.vertices[1] = self.count;
        self.tally_triangles(1, &drawn, self.count);
        for (member, own) in self.members.iter_mut().zip(drawn) {
            if TRIANGLES.contains(&member.mode) {
                member.mode = TRIANGLES[0];
            }
            member.indices = own.indices();
        }
        self.columns = columns;
        Ok(())
    }

    fn tally_triangles(&mut self, when: usize, drawn: &[Drawn], vertices: usize) {
        for own in drawn {
            if let Drawn::Triangles(triangles) = own {
                let mut cache = FifoCache::new(vertices);
                let misses =
                    triangles.iter().map(|own| u64::from(cache.misses_of(own.map(|vertex| vertex.0))));
                self.tally.misses[when] += misses.sum::<u64>();
                self.tally.triangles[when] += triangles.len();
            }
        }
    }
}

impl Member {
    /// The accessor of an attribute, if it is one of its own.
    pub(super) fn accessor(&self, slot: &Slot) -> Option<usize> {
        self.slots.get(slot).copied()
    }
}

/// What a member draws.
enum Drawn {
    Triangles(Vec<[VertexIndex; 3]>),
    /// Points or lines by indices.
    Others(Vec<u32>),
    /// All vertices in their order.
    Vertices,
}

impl Drawn {
    fn rename(&mut self, mut name: impl FnMut(u32) -> u32) {
        match self {
            Self::Triangles(triangles) => {
                triangles.iter_mut().flatten().for_each(|vertex| vertex.0 = name(vertex.0));
            }
            Self::Others(indices) => indices.iter_mut().for_each(|vertex| *vertex = name(*vertex)),
            Self::Vertices => {}
        }
    }

    fn indices(self) -> Option<Vec<u32>> {
        match self {
            Self::Triangles(triangles) => {
                Some(triangles.as_flattened().iter().map(|vertex| vertex.0).collect())
            }
            Self::Others(indices) => Some(indices),
            Self::Vertices => None,
        }
    }
}

fn drawn(source: &Source<'_>, member: &Member, count: usize) -> Result<Drawn, Fault> {
    let mesh = &list(source.root, "meshes")[member.mesh];
    let mut triangles: Vec<[VertexIndex; 3]> = Vec::new();
    for part in &member.parts {
        let primitive = &mesh["primitives"][*part];
        let indices = match whole(primitive, "indices") {
            None => None,
            Some(accessor) => Some(indices(&source.elements(accessor)?, count).map_err(|message| {
                Fault::new(format!("/meshes/{}/primitives/{part}/indices", member.mesh), message)
            })?),
        };
        if !TRIANGLES.contains(&member.mode) {
            return Ok(indices.map_or(Drawn::Vertices, Drawn::Others));
        }
        let indices = indices.unwrap_or_else(|| (0..index(count)).collect());
        if mode(primitive) == TRIANGLES[0] && triangles.is_empty() {
            triangles = indices.as_chunks::<3>().0.iter().map(|own| own.map(VertexIndex)).collect();
        } else {
            triangles.extend(listed(&indices, mode(primitive)).map(|own| own.map(VertexIndex)));
        }
    }
    Ok(Drawn::Triangles(triangles))
}

fn indices(own: &Elements<'_>, count: usize) -> Result<Vec<u32>, String> {
    let all = own.wholes();
    match all.iter().position(|vertex| *vertex as usize >= count) {
        None => Ok(all),
        Some(place) => {
            Err(format!("index {} at place {place} is not below {count}, the number of vertices", all[place]))
        }
    }
}

/// The triangles of a list, a strip or a fan (glTF 2.0 Specification, section 3.7.2.1).
fn listed(indices: &[u32], mode: usize) -> Box<dyn Iterator<Item = [u32; 3]> + '_> {
    let strip = indices.windows(3).enumerate();
    match mode {
        5 => {
            Box::new(strip.map(
                |(at, own)| if at % 2 == 0 { [own[0], own[1], own[2]] } else { [own[0], own[2], own[1]] },
            ))
        }
        6 => Box::new(indices.windows(2).skip(1).map(|own| [own[0], own[1], indices[0]])),
        _ => Box::new(indices.as_chunks::<3>().0.iter().copied()),
    }
}

/// Leaves out triangles that use a vertex twice; one stays where there are no others, for a primitive draws something.
fn whole_ones(triangles: &mut Vec<[VertexIndex; 3]>) {
    let whole = |[a, b, c]: &[VertexIndex; 3]| a != b && b != c && c != a;
    if triangles.iter().any(whole) {
        triangles.retain(whole);
    } else {
        triangles.truncate(1);
    }
}

fn columns(
    elements: &BTreeMap<Slot, Elements<'_>>,
    options: &Options,
    place: &MeshPlace,
) -> Vec<(Slot, Column)> {
    let base = |name: &str| elements.get(&(0, name.to_owned()));
    let bases: Vec<(&Slot, &Elements<'_>)> =
        elements.iter().filter(|((target, _), _)| *target == 0).collect();
    let mut made: Vec<(Slot, Column)> = bases
        .par_iter()
        .map(|(slot, own)| ((*slot).clone(), column::base(&slot.1, own, options.profile, place)))
        .collect();
    let targets: Vec<(&Slot, &Elements<'_>)> =
        elements.iter().filter(|((target, _), _)| *target > 0).collect();
    let changed: Vec<(Slot, Column)> = targets
        .par_iter()
        .map(|(slot, own)| {
            let written = made.iter().find(|((_, name), _)| *name == slot.1).map(|(_, column)| column);
            let from = (base(&slot.1), written);
            ((*slot).clone(), column::target(&slot.1, own, from, (options.profile, place)))
        })
        .collect();
    made.extend(changed);
    made
}

/// For each vertex the first one whose bytes are the same in every column. A table of twice as many places, each looked at
/// from where its hash says onward.
fn first_alike(columns: &[(Slot, Column)], count: usize) -> Vec<u32> {
    let mut hashes = vec![0_u64; count];
    const PIECE: usize = 8192;
    hashes.par_chunks_mut(PIECE).enumerate().for_each(|(piece, hashes)| {
        for (_, column) in columns {
            let start = piece * PIECE * column.stride;
            let rows = column.rows[start..].chunks_exact(column.stride);
            for (hash, row) in hashes.iter_mut().zip(rows) {
                for word in row.as_chunks::<4>().0 {
                    let mixed =
                        (*hash ^ u64::from(u32::from_le_bytes(*word))).wrapping_mul(0x9E37_79B9_7F4A_7C15);
                    *hash = mixed ^ mixed >> 29;
                }
            }
        }
    });
    const FREE: u32 = u32::MAX;
    let size = (count * 2).next_power_of_two();
    let mut table = vec![FREE; size];
    let row = |column: &Column, vertex: usize| vertex * column.stride..(vertex + 1) * column.stride;
    let same = |a: usize, b: usize| {
        hashes[a] == hashes[b]
            && columns.iter().all(|(_, column)| column.rows[row(column, a)] == column.rows[row(column, b)])
    };
    let place = |vertex: usize| -> u32 {
        let mask = size as u64 - 1;
        let mut at = hashes[vertex] & mask;
        loop {
            let slot = &mut table[usize::try_from(at).unwrap_or(0)];
            if *slot == FREE {
                *slot = index(vertex);
                return *slot;
            }
            if same(*slot as usize, vertex) {
                return *slot;
            }
            at = (at + 1) & mask;
        }
    };
    (0..count).map(place).collect()
}

/// Names vertices anew in the order of their first use; gives the old name of each.
fn first_uses(drawn: &mut [Drawn], count: usize) -> Vec<u32> {
    const UNSEEN: u32 = u32::MAX;
    let mut names = vec![UNSEEN; count];
    let mut used = Vec::with_capacity(count);
    for own in drawn {
        own.rename(|vertex| {
            let name = &mut names[vertex as usize];
            if *name == UNSEEN {
                *name = index(used.len());
                used.push(vertex);
            }
            *name
        });
    }
    used
}

/// The rows of the vertices that are used, in their order.
fn gather(column: &mut Column, used: &[u32]) {
    let stride = column.stride;
    let mut rows = vec![0; used.len() * stride];
    const PIECE: usize = 8192;
    let (from, pieces) = (&column.rows, used.par_chunks(PIECE));
    rows.par_chunks_mut(PIECE * stride).zip(pieces).for_each(|(rows, used)| {
        for (row, vertex) in rows.chunks_exact_mut(stride).zip(used) {
            row.copy_from_slice(&from[*vertex as usize * stride..][..stride]);
        }
    });
    column.rows = rows;
}

/// Packs all sets, side by side.
pub(super) fn pack(sets: &mut [Set], source: &Source<'_>, options: &Options) -> Result<(), Fault> {
    let faults: Vec<Option<Fault>> =
        sets.into_par_iter().map(|set| set.pack(source, options).err()).collect();
    // The first in the order of the file, whichever was found first.
    faults.into_iter().flatten().next().map_or(Ok(()), Err)
}
