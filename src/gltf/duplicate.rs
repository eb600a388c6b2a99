//! What is equal is written once: views of equal bytes, accessors that say the same of one view, primitives of one
//! material that follow each other.
//!
//! Promise: every name stays; what is read through the accessors of a file is what would be read without this. Meshes of
//! equal triangles with different names stay meshes of their own over the same accessors.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

use gltf::json::buffer::{Stride, Target, View};
use gltf::json::{Accessor, Index, Root};

use super::buffer::Content;
use crate::geometry::mesh;

/// Views in the order of their lengths.
#[derive(Default)]
pub(super) struct Views {
    known: BTreeMap<usize, Vec<Known>>,
}

struct Known {
    bytes: Range<usize>,
    content: Content,
    target: Option<Target>,
    packed: bool,
    view: Index<View>,
}

impl Views {
    /// The view that was written before of the bytes from `start` on, if there is one like it.
    pub(super) fn find(
        &self,
        (bytes, start): (&[u8], usize),
        content: Content,
        (target, packed): (Option<Target>, bool),
    ) -> Option<Index<View>> {
        let alike = |known: &&Known| {
            known.content == content
                && known.target == target
                && known.packed == packed
                && bytes[known.bytes.clone()] == bytes[start..]
        };
        self.known.get(&(bytes.len() - start))?.iter().find(alike).map(|known| known.view)
    }

    pub(super) fn add(
        &mut self,
        bytes: Range<usize>,
        content: Content,
        (target, packed): (Option<Target>, bool),
        view: Index<View>,
    ) {
        self.known.entry(bytes.len()).or_default().push(Known { bytes, content, target, packed, view });
    }
}

/// Says how far apart the elements of a view stand that several accessors of vertices share, which the format demands.
pub(super) fn share(view: &mut View, content: Content) {
    if let (Content::Attributes { stride } | Content::Exponential { stride }, Some(_)) =
        (content, view.target.as_ref())
    {
        view.byte_stride = Some(Stride(stride));
    }
}

/// Makes equal accessors one, and leaves out those that nothing uses. O(accessors).
pub(super) fn merge_accessors(root: &mut Root) {
    let mut used = vec![false; root.accessors.len()];
    each_accessor(root, |index| used[index.value()] = true);
    // Only looked up, never walked.
    let mut known: HashMap<String, u32> = HashMap::new();
    let mut kept: Vec<Accessor> = Vec::with_capacity(root.accessors.len());
    let mut places = Vec::with_capacity(root.accessors.len());
    for (accessor, used) in std::mem::take(&mut root.accessors).into_iter().zip(used) {
        if !used {
            places.push(0);
            continue;
        }
        let told =
            serde_json::to_string(&accessor).expect("an accessor has no map with other keys than text");
        places.push(*known.entry(told).or_insert_with(|| {
            kept.push(accessor);
            mesh::index(kept.len() - 1)
        }));
    }
    root.accessors = kept;
    each_accessor(root, |index| *index = Index::new(places[index.value()]));
}

/// Visits every place that names an accessor.
fn each_accessor(root: &mut Root, mut visit: impl FnMut(&mut Index<Accessor>)) {
    for primitive in root.meshes.iter_mut().flat_map(|mesh| &mut mesh.primitives) {
        primitive.attributes.values_mut().chain(&mut primitive.indices).for_each(&mut visit);
        for target in primitive.targets.iter_mut().flatten() {
            let named = [&mut target.positions, &mut target.normals, &mut target.tangents];
            named.into_iter().flatten().for_each(&mut visit);
        }
    }
    root.skins.iter_mut().flat_map(|skin| &mut skin.inverse_bind_matrices).for_each(&mut visit);
    for sampler in root.animations.iter_mut().flat_map(|animation| &mut animation.samplers) {
        visit(&mut sampler.input);
        visit(&mut sampler.output);
    }
}

/// Neighbors of a list that are alike, as ranges.
pub(super) fn neighbors<T: PartialEq>(all: &[T]) -> impl Iterator<Item = Range<usize>> {
    let mut start = 0;
    all.chunk_by(T::eq).map(move |alike| {
        let range = start..start + alike.len();
        start = range.end;
        range
    })
}
