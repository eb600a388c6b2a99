//! Files that commands read beside documents.

use std::path::{Component, Path};

use crate::project::reason;

/// Bytes of a file that is read at most: what a `.glb` file can hold.
const MOST: u64 = u32::MAX as u64;

/// A file, if it is not too large.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, String> {
    let length = std::fs::metadata(path).map_err(|error| reason(&error))?.len();
    if length > MOST {
        return Err(format!("it has {length} bytes, more than {MOST}"));
    }
    std::fs::read(path).map_err(|error| reason(&error))
}

/// A file in the folder or below it; others are not opened, whatever another file asks for.
pub(super) fn beside(folder: &Path, path: &str) -> Option<Vec<u8>> {
    let path = Path::new(path);
    let inside = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    inside.then(|| read(&folder.join(path)).ok()).flatten()
}
