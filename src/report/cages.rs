//! What the vertices of a cage are.

use indexmap::IndexMap;
use serde::Serialize;

use crate::model::{Model, ShapeHandle};
use crate::realize::Note;

/// Vertices of a cage by what its sharp edges and borders make of them (H. Hoppe et al., "Piecewise Smooth Surface Reconstruction",
/// SIGGRAPH 1994).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct CageFacts {
    /// Without sharp edges.
    pub smooth: u32,
    /// With one: there a crease fades out.
    pub dart: u32,
    /// With two.
    pub crease: u32,
    /// With more, or sharp themselves.
    pub corner: u32,
}

/// The cages of all subdivision surfaces that are shown, by the names of their shapes.
pub(super) fn cages(model: &Model, notes: &[(ShapeHandle, Note)]) -> IndexMap<String, CageFacts> {
    let facts = |(shape, note): &(ShapeHandle, Note)| match *note {
        Note::Classes([smooth, dart, crease, corner]) => {
            Some((model.shape(*shape).name.clone(), CageFacts { smooth, dart, crease, corner }))
        }
        _ => None,
    };
    notes.iter().filter_map(facts).collect()
}
