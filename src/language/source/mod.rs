//! Text and where it stands: spans, the map of loaded files, and the one door to the file system.

mod files;
mod map;
mod text;

pub use files::{DiskFiles, FileError, FileRecord, Files, MemoryFiles, join};
pub use map::{FileId, Location, SourceMap, Span};
pub use text::{TextError, decode, readable};
