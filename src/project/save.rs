//! Outputs that appear whole or not at all.

use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Writes files under temporary names, then gives all of them their own: a reader sees the old files or the new ones,
/// whole. The folder is made where it is missing.
pub(crate) fn save(folder: &Path, files: &[(&str, &[u8])]) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let mut waiting: Vec<(tempfile::NamedTempFile, PathBuf)> = Vec::new();
    for (name, bytes) in files {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".kiln-");
        let mut file = builder.tempfile_in(folder)?;
        file.write_all(bytes)?;
        waiting.push((file, folder.join(name)));
    }
    for (file, target) in waiting {
        readable(file.as_file())?;
        file.persist(target).map_err(|error| error.error)?;
    }
    Ok(())
}

/// Temporary files are for their owner alone; outputs are for all, as the system's mask has it.
#[cfg(unix)]
fn readable(file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn readable(_: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}
