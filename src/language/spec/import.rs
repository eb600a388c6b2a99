//! Models and textures from files.

use std::path::Path;

use indexmap::IndexMap;
use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::join;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::reference::MaterialName;
use crate::language::spec::schema::Schemas;
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

/// A path, found from the file that writes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilePath {
    /// As it is written.
    pub written: String,
    /// From the project root, with `/` between its parts: what [`Files`](crate::language::source::Files) reads.
    pub resolved: String,
}

table! {
    /// A model from a file: Wavefront OBJ or STL.
    "import" pub Import {
        /// The file; the path is relative to this document and stays inside the project.
        file: Sp<FilePath>;
        /// Only this group or object of the file.
        group: Option<Sp<String>>;
        /// Factor from the file's unit to the document's: 0.001 for millimetres in a document in metres.
        scale: Sp<f64> = 1.0 => Check::above(0.0);
        /// Which axis of the file points up: `"y"` when it is not written, for STL `"z"`.
        up: Option<Sp<Up>>;
        /// Points nearer than this, in the file's unit, are made one.
        weld: Option<Sp<f64>> => Check::at_least(0.0);
        /// For each material of the file the name of one of this document.
        materials: IndexMap<String, Sp<MaterialName>> = IndexMap::new();
    }
}

choices! {
    /// The axis that points up.
    Up {
        /// The y axis, as in glTF.
        Y = "y";
        /// The z axis, as in most CAD.
        Z = "z";
    }
}

impl FilePath {
    /// The part after the last dot, in lower case; empty where there is none.
    #[must_use]
    pub fn extension(&self) -> String {
        let extension = Path::new(&self.resolved).extension();
        extension.map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default()
    }
}

impl Read for FilePath {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let Data::String(written) = &value.data else {
            reader.mismatch(value, "the path of a file");
            return None;
        };
        let from = reader.sources.file_of(value.span).map_or("", |file| reader.sources.path(file));
        match join(from, written) {
            Ok(resolved) => Some(Self { written: written.clone(), resolved }),
            Err(fault) => {
                reader.report(
                    Diagnostic::error(Code::OutsideRoot, fault.message(written))
                        .at(value.span, fault.label()),
                );
                None
            }
        }
    }

    fn schema(_: &mut Schemas) -> Json {
        json!({ "type": "string" })
    }
}
