//! `[lod]`: levels of detail of all shapes.

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::reader::Reader;
use crate::language::spec::spanned::Sp;

/// The most levels beside the finest.
pub(crate) const MOST_LEVELS: usize = 7;

table! {
    /// Levels of detail: each shape again, more coarsely, for when it is far away. Surfaces are cut anew at a coarser tolerance,
    /// with the same texture coordinates, seams, materials and weights; subdivisions are refined less often, fixed grids have
    /// half as many steps; meshes without a surface lose triangles. A shape that morphs is cut anew together with its states, which
    /// all are within the level's tolerance, and what moves its weights moves those of its levels. A level stays closed where the shape is, in as many parts
    /// with as many holes; one that would have hardly fewer triangles is left out.
    "lod" pub Lod {
        /// How many levels there are, the finest among them. Each is allowed four times the tolerance of the one before, which
        /// takes about a fourth of the triangles.
        levels: Option<Sp<u32>> => Check::within(2.0, 8.0);
        /// Instead of their number the tolerances of the coarser levels, each greater than the one before, in the document's
        /// unit. A shape whose own tolerance is greater keeps that.
        tolerances: Option<Sp<Vec<f64>>> => Check::above(0.0);
        /// How they stand in files. When it is not written: "msft-lod", and "files" in profiles of engines that do not read that.
        form: Option<Sp<LodForm>>;
    }
    checked check
}

choices! {
    /// How levels of detail stand in files.
    LodForm {
        /// In one file, beside the nodes that show the finest, by the extension `MSFT_lod`, which is not required: who does not
        /// know it shows the finest. `MSFT_screencoverage` says for what part of the picture each is good.
        MsftLod = "msft-lod";
        /// In one file, as nodes `NODE_LOD0`, `NODE_LOD1`... below each node that shows a shape. Who does not know these names
        /// shows all levels at once.
        Nodes = "nodes";
        /// In files of their own: `NAME.glb`, `NAME.lod1.glb`...
        Files = "files";
    }
}

impl Lod {
    fn check(&self, table: Span, reader: &mut Reader<'_>) -> bool {
        let report = match (&self.levels, &self.tolerances) {
            (None, None) => Diagnostic::error(Code::MissingField, "missing `levels` or `tolerances` of lod")
                .at(table, "how many levels?")
                .help("write `levels = 4`, or `tolerances = [0.002, 0.01]`"),
            (Some(levels), Some(tolerances)) => Diagnostic::error(
                Code::Conflict,
                "`levels` and `tolerances` both say how many levels there are",
            )
            .at(tolerances.span, "said again")
            .also(levels.span, "said here")
            .help("leave one of them out"),
            (None, Some(tolerances)) => match fault(&tolerances.value) {
                Some(message) => Diagnostic::error(Code::BadLevels, message)
                    .at(tolerances.span, "these tolerances")
                    .help("write one tolerance for each level but the finest, as in `[0.002, 0.01, 0.05]`"),
                None => return true,
            },
            (Some(_), None) => return true,
        };
        reader.report(report);
        false
    }
}

/// What is wrong with the tolerances of coarser levels.
fn fault(tolerances: &[f64]) -> Option<String> {
    if tolerances.is_empty() || tolerances.len() > MOST_LEVELS {
        return Some(format!(
            "there are 1 to {MOST_LEVELS} levels beside the finest, not {}",
            tolerances.len()
        ));
    }
    let pair = tolerances.windows(2).find(|pair| pair[0] >= pair[1])?;
    Some(format!("each level is coarser than the one before, but {} follows {}", pair[1], pair[0]))
}
