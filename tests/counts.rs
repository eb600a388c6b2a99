//! What tests tried, for the table of `scripts/trust.py`.

/// Keeps how many of something a test tried, in the folder that `KILN_COUNTS` names.
///
/// # Panics
/// When the count cannot be written.
pub(crate) fn tried(what: &str, count: usize) {
    if let Some(folder) = std::env::var_os("KILN_COUNTS") {
        let folder = std::path::PathBuf::from(folder);
        std::fs::create_dir_all(&folder).expect("a folder for counts");
        std::fs::write(folder.join(what), format!("{count}\n")).expect("a count is written");
    }
}
