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
    /// A model from a file: glTF (.glb or .gltf, as its nodes place its meshes, skinned ones as they are bound), Wavefront OBJ, STL, PLY,
    /// the faces of a drawing (DXF), the meshes of a 3D Studio scene (3DS) with its materials and smoothing groups, a Doom 3
    /// mesh (MD5), or a Quake model (MD2, MD3), whose frames become morphs of the shape where a node shows it, with a name each,
    /// and whose sequences become clips. The tags of an MD3 file are nodes with their names in kebab-case, which move with the
    /// frames and carry others as sockets do.
    ///
    /// Materials of files bring their colors and pictures: those of a glTF file stand in it or beside it, and what OBJ (by its
    /// material library), PLY, 3DS, MD2, MD3 and MD5 files name is looked for beside the file, as PNG or JPEG, whatever
    /// ending and letters' case the file writes. A missing one is a warning. `materials` gives others.
    ///
    /// Morph targets of a glTF file become morphs of the shape where a node shows it, with their names (by custom in
    /// `targetNames`) in kebab-case and their weights; `[clip.NAME.import]` plays their weights.
    "import" pub Import {
        /// The file; the path is relative to this document and stays inside the project.
        file: Sp<FilePath>;
        /// Only this group or object of the file: of glTF this node with what stands below it, or this mesh; of MD3 a surface,
        /// of MD5 the meshes of a material; of DXF a layer.
        group: Option<Sp<String>>;
        /// Factor from the file's unit to the document's: 0.001 for millimetres in a document in metres.
        scale: Sp<f64> = 1.0 => Check::above(0.0);
        /// Which axis of the file points up: `"y"` when it is not written, for STL, DXF, 3DS, MD2, MD3 and MD5 `"z"`.
        up: Option<Sp<Up>>;
        /// Points nearer than this, in the file's unit, are made one; morph targets of a glTF file are left out then.
        weld: Option<Sp<f64>> => Check::at_least(0.0);
        /// For each material of the file the name of one of this document.
        materials: IndexMap<String, Sp<MaterialName>> = IndexMap::new();
        /// The frame of an MD2 or MD3 file that is the shape, by its name in the file; the first when it is not written.
        frame: Option<Sp<String>>;
        /// Which frames of an MD2 or MD3 file, or morph targets of a glTF file, are read.
        frames: Sp<Frames> = Frames::All;
        /// How the sequences of an MD2 or MD3 file are told.
        sequences: Sp<Sequences> = Sequences::Named;
        /// Frames of an MD2 or MD3 file that are played in a second.
        frame_rate: Sp<f64> = 10.0 => Check::within(1.0, 1000.0);
        /// The sequences of an MD2 or MD3 file that are played again and again: from their last frame they go on to the first.
        r#loop: Vec<Sp<String>> = Vec::new();
    }
}

choices! {
    /// Which frames of a file are read.
    Frames {
        /// All: those that are not the shape are morphs of it, and sequences are clips; of glTF all targets.
        All = "all";
        /// The one that is the shape; of glTF the shape as it is with the weights of the file.
        One = "one";
    }
}

choices! {
    /// How the sequences of a file are told.
    Sequences {
        /// By the names of their frames: `stand01` and `stand02` are of the sequence `stand`, `pain101` is of `pain1`.
        Named = "named";
        /// By their places, as those of a player in Quake II: `stand`, `run`, `attack`, `pain-a`, `pain-b`, `pain-c`, `jump`,
        /// `flip`, `salute`, `taunt`, `wave`, `point`, `crouch-stand`, `crouch-walk`, `crouch-attack`, `crouch-pain`,
        /// `crouch-death`, `death-fall-back`, `death-fall-forward`, `death-fall-back-slow`, and `boom` where the file has it.
        Standard = "standard";
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
