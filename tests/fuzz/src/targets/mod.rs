//! The targets.

mod cage;
mod curve;
mod document;
mod expression;
mod field;
mod heights;
mod importer;
mod reach;
mod solid;
mod surface;

/// A target: its name and what it does with any bytes.
type Target = (&'static str, fn(&[u8]));

/// All targets.
const TARGETS: [Target; 10] = [
    ("document", document::run),
    ("expression", expression::run),
    ("importer", importer::run),
    ("cage", cage::run),
    ("curve", curve::run),
    ("field", field::run),
    ("heights", heights::run),
    ("reach", reach::run),
    ("solid", solid::run),
    ("surface", surface::run),
];

/// The target of a name.
pub fn named(name: &str) -> Option<fn(&[u8])> {
    TARGETS.iter().find(|target| target.0 == name).map(|target| target.1)
}
