//! Levels of detail of a file: by `MSFT_lod`, or by names that end in `_LOD0`, `_LOD1`...

use std::collections::BTreeMap;

use super::Asset;

/// Which level of detail each node shows.
#[derive(Clone, Debug, Default)]
pub(in crate::preview) struct Shown {
    /// How many levels there are.
    pub(in crate::preview) count: usize,
    /// That of each node.
    levels: Vec<usize>,
}

impl Shown {
    /// That of a node, 0 for the finest.
    pub(in crate::preview) fn of(&self, node: usize) -> usize {
        self.levels.get(node).copied().unwrap_or(0)
    }
}

impl Asset {
    /// How many levels of detail some node has; 1 where none has more than itself.
    #[must_use]
    pub fn levels(&self) -> usize {
        let named = self.named().into_values().map(|levels| levels.len()).max().unwrap_or(1);
        self.nodes.iter().map(|node| node.levels.len() + 1).max().unwrap_or(1).max(named)
    }

    /// Shows one level of detail of everything, and nothing else: the coarsest where there is none so coarse.
    pub fn show_level(&mut self, level: usize) {
        self.shown = Shown { count: self.levels(), levels: vec![0; self.nodes.len()] };
        for node in 0..self.nodes.len() {
            let levels = &self.nodes[node].levels;
            let Some(last) = levels.len().checked_sub(1).filter(|_| level > 0) else { continue };
            let shown = level.min(last + 1);
            let coarser = self.nodes[levels[shown - 1]].mesh;
            self.nodes[node].mesh = coarser;
            self.shown.levels[node] = shown;
        }
        for levels in self.named().into_values() {
            let shown = level.min(levels.len() - 1);
            self.shown.levels[levels[shown]] = shown;
            let hidden = levels.iter().enumerate().filter(|(number, _)| *number != shown);
            hidden.for_each(|(_, node)| self.nodes[*node].mesh = None);
        }
    }

    /// Nodes that are levels by their names, by the name before the number; of what joints carry the finest has no number.
    fn named(&self) -> BTreeMap<String, Vec<usize>> {
        let mut all: BTreeMap<String, BTreeMap<usize, usize>> = BTreeMap::new();
        for (index, node) in self.nodes.iter().enumerate().filter(|(_, node)| node.mesh.is_some()) {
            let parts = node.name.rsplit_once("_LOD");
            let level = parts.and_then(|(name, number)| Some((name, number.parse::<usize>().ok()?)));
            let (name, number) = level.unwrap_or((&node.name, 0));
            all.entry(name.to_owned()).or_default().entry(number).or_insert(index);
        }
        all.retain(|_, levels| levels.len() > 1 && levels.keys().copied().eq(0..levels.len()));
        all.into_iter().map(|(name, levels)| (name, levels.into_values().collect())).collect()
    }
}
