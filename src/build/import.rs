//! Meshes from files.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use indexmap::IndexMap;

use super::Builder;
use crate::import::keyframes::Keyframes;
use crate::import::look::Pictures;
use crate::import::{self, ImportError, ImportOptions, Imported, Note};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::{FileError, Files, Span, join};
use crate::language::spec::{FilePath, Import, MaterialName, Sp, Up};
use crate::model::{MaterialHandle, Recipe};

/// The rotation from a file's axes to a document's.
pub(super) fn axes_between(file: Up, document: Up) -> DMat3 {
    match (file, document) {
        (Up::Z, Up::Y) => DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
        (Up::Y, Up::Z) => DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y),
        _ => DMat3::IDENTITY,
    }
}

/// Most notes of one file that are told one by one.
pub(super) const NOTES: usize = 4;

impl Builder<'_> {
    /// The mesh of a file; whether its shape has a material of its own, which is that of all faces whose material the file
    /// gives no color.
    pub(super) fn import(&mut self, import: &Import, has_material: bool, span: Span) -> Option<Recipe> {
        let mut imported = self.read_mesh(import)?;
        if has_material {
            for look in imported.materials.iter_mut().filter(|look| look.color.is_none()) {
                look.pictures = Pictures::default();
            }
        }
        let mut notes = std::mem::take(&mut imported.notes);
        let materials = self.imported_materials(import, &imported, &mut notes);
        self.tell_notes(&import.file, &notes);
        let mut mesh = imported.mesh;
        let up = import.up.map_or_else(|| default_up(&import.file), |up| up.value);
        let axes = axes_between(up, self.spec.up);
        mesh.transform(&DAffine3::from_mat3(axes * import.scale.value));
        if let Err(error) = mesh.validate() {
            self.report(Diagnostic::error(Code::BadMesh, error.to_string()).at(span, "this mesh"));
            return None;
        }
        Some(Recipe::Polygons { mesh, materials: materials? })
    }

    /// Reports a file that cannot be read, at the place that names it.
    pub(super) fn file_fault(&mut self, error: &FileError, file: &Sp<FilePath>) {
        let code = match error {
            FileError::Missing => Code::FileMissing,
            FileError::Absolute | FileError::Outside | FileError::NotPortable => Code::OutsideRoot,
            FileError::TooLarge(_) => Code::TooLarge,
            FileError::Folder | FileError::Unreadable(_) => Code::FileUnreadable,
        };
        let report = Diagnostic::error(code, error.message(&file.value.written)).at(file.span, error.label());
        self.report(report);
    }

    pub(super) fn bytes_of(&mut self, file: &Sp<FilePath>) -> Option<Arc<[u8]>> {
        match self.files.read(&file.value.resolved) {
            Ok(bytes) => Some(bytes),
            Err(error) => {
                self.file_fault(&error, file);
                None
            }
        }
    }

    /// The model of a file with frames.
    pub(super) fn read_keyframes(&mut self, import: &Import) -> Option<Keyframes> {
        let file = &import.file;
        let bytes = self.bytes_of(file)?;
        let group = import.group.as_ref().map(|group| group.value.as_str());
        let read = match file.value.extension().as_str() {
            "md2" => import::md2::read(&bytes).map_err(ImportError::from),
            _ => import::md3::read(&bytes, group),
        };
        let read = read.map_err(|error| match import::recognize(&bytes) {
            Some(foreign) if error.is_foreign() => ImportError::Foreign(foreign),
            _ => error,
        });
        read.map_err(|error| self.refused(file, &error)).ok()
    }

    /// The shape of a file with frames: one of them.
    fn framed_mesh(&mut self, import: &Import) -> Option<Imported> {
        let md2 = import.file.value.extension() == "md2";
        let group = import.group.as_ref().filter(|_| md2).map(|group| ("group", group.span));
        let weld = import.weld.map(|weld| ("weld", weld.span));
        if let Some((field, span)) = group.or(weld) {
            let what =
                if md2 { "an MD2 file has one mesh, whose points" } else { "the points of an MD3 file" };
            let message = format!("{what} are those of every frame: no `{field}`");
            self.report(Diagnostic::error(Code::Conflict, message).at(span, "leave it out"));
            return None;
        }
        let found = self.read_keyframes(import)?;
        let frame = self.frame_of(import, &found)?;
        Some(found.frame(frame))
    }

    fn read_mesh(&mut self, import: &Import) -> Option<Imported> {
        let file = &import.file;
        if has_frames(file) {
            return self.framed_mesh(import);
        }
        let bytes = self.bytes_of(file)?;
        let options = ImportOptions {
            group: import.group.as_ref().map(|group| group.value.clone()),
            weld: import.weld.map(|weld| weld.value),
            most: self.model.limits.triangles,
        };
        let mut open = beside(self.files, &file.value);
        let ending = file.value.extension();
        let Some(read) = import::read(&ending, &bytes, &options, &mut open) else {
            return self.unsupported(file, &ending, &bytes);
        };
        match read {
            Ok(imported) => Some(imported),
            Err(error) => {
                let known = import::recognize(&bytes).filter(|_| error.is_foreign());
                self.refused(file, &known.map_or(error, ImportError::Foreign));
                None
            }
        }
    }

    pub(super) fn refused(&mut self, file: &Sp<FilePath>, error: &ImportError) {
        let line = error.line().map_or_else(String::new, |line| format!(":{line}"));
        let message = format!("{}{line}: {error}", file.value.written);
        let code = match error {
            ImportError::Foreign(_)
            | ImportError::Binary { .. }
            | ImportError::Gltf(import::gltf::GltfFault::Extension(_)) => Code::UnsupportedFormat,
            ImportError::UnknownGroup { .. } | ImportError::EmptyGroup { .. } => Code::UnknownPart,
            _ => Code::ImportFailed,
        };
        let report = Diagnostic::error(code, message).at(file.span, "cannot be imported");
        self.report(match error.hint() {
            Some(hint) => report.help(hint),
            None => report,
        });
    }

    fn unsupported<T>(&mut self, file: &Sp<FilePath>, extension: &str, bytes: &[u8]) -> Option<T> {
        let (what, hint) = match import::recognize(bytes) {
            Some(foreign) => (foreign.name.to_owned(), foreign.hint),
            None => (
                if extension.is_empty() {
                    "a file without an ending".to_owned()
                } else {
                    format!("a .{extension} file")
                },
                "export it as glTF (.glb or .gltf), Wavefront OBJ (.obj), STL (.stl), PLY (.ply) 3D Studio scene (.3ds) or drawing (.dxf)",
            ),
        };
        let message = format!("{} is {what}, which cannot be imported", file.value.written);
        let report = Diagnostic::error(Code::UnsupportedFormat, message)
            .at(file.span, "not glTF, OBJ, STL, PLY, 3DS, DXF, MD2, MD3 or MD5")
            .help(hint);
        self.report(report);
        None
    }

    pub(super) fn tell_notes(&mut self, file: &Sp<FilePath>, notes: &[Note]) {
        if notes.is_empty() {
            return;
        }
        let message = format!("{} was not imported as it stands", file.value.written);
        let mut report = Diagnostic::warning(Code::ImportNote, message).at(file.span, "see the notes");
        for note in notes.iter().take(NOTES) {
            let line = note.line.map_or_else(String::new, |line| format!("line {line}: "));
            report = report.note(format!("{line}{}", note.message));
        }
        if notes.len() > NOTES {
            report = report.note(format!("and {} more", notes.len() - NOTES));
        }
        self.report(report);
    }

    /// For each material of the file one of the model: as the document says, else as the file says.
    fn imported_materials(
        &mut self,
        import: &Import,
        imported: &Imported,
        notes: &mut Vec<Note>,
    ) -> Option<Vec<Option<MaterialHandle>>> {
        let names = &imported.mesh.materials;
        for (name, target) in &import.materials {
            if !names.contains(name) {
                let known = names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
                let message = format!("{} has no material `{name}`", import.file.value.written);
                let report = Diagnostic::error(Code::UnknownPart, message)
                    .at(target.span, "never used")
                    .note(if known.is_empty() {
                        "it names no materials".to_owned()
                    } else {
                        format!("its materials: {known}")
                    });
                self.report(report);
                return None;
            }
        }
        Some(self.looks_of((&import.file.value, &import.materials), imported, notes))
    }

    /// For each material of a file one of the model: as the document says, else as the file says. One that could not be
    /// built was told. Those of its pictures that are not found are noted.
    pub(super) fn looks_of(
        &mut self,
        (file, written): (&FilePath, &IndexMap<String, Sp<MaterialName>>),
        imported: &Imported,
        notes: &mut Vec<Note>,
    ) -> Vec<Option<MaterialHandle>> {
        let look = |(index, name): (usize, &String)| {
            let made = match written.get(name) {
                Some(target) => self.material(&target.value.0),
                None => imported.materials.get(index).and_then(|look| self.look(file, look, notes)),
            };
            if let Some(made) = made {
                self.from_files.wears(file, index, made);
            }
            made
        };
        imported.mesh.materials.iter().enumerate().map(look).collect()
    }
}

/// Reads files by their paths from another.
pub(super) fn beside<'f>(
    files: &'f dyn Files,
    file: &FilePath,
) -> impl FnMut(&str) -> Option<Vec<u8>> + use<'f> {
    let base = file.resolved.clone();
    move |path: &str| {
        let path = join(&base, path).ok()?;
        files.read(&path).ok().map(|bytes| bytes.to_vec())
    }
}

/// The axis that points up in files of its ending by custom.
pub(super) fn default_up(file: &Sp<FilePath>) -> Up {
    if import::z_is_up(&file.value.extension()) { Up::Z } else { Up::Y }
}

/// Whether a file of its name is glTF.
pub(super) fn is_gltf(file: &Sp<FilePath>) -> bool {
    matches!(file.value.extension().as_str(), "glb" | "gltf")
}

/// Whether a file of its name has frames.
pub(super) fn has_frames(file: &Sp<FilePath>) -> bool {
    matches!(file.value.extension().as_str(), "md2" | "md3")
}
