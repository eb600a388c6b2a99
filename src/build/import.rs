//! Meshes from files.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};

use super::Builder;
use crate::geometry::mesh;
use crate::import::md2::{Md2, Md2Fault};
use crate::import::{self, ImportOptions, Imported, MaterialLook};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::{FileError, Span, join};
use crate::language::spec::{FilePath, Import, Sp, Up};
use crate::model::{AlphaMode, Material, MaterialHandle, Recipe};

/// The rotation from a file's axes to a document's.
pub(super) fn axes_between(file: Up, document: Up) -> DMat3 {
    match (file, document) {
        (Up::Z, Up::Y) => DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
        (Up::Y, Up::Z) => DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y),
        _ => DMat3::IDENTITY,
    }
}

/// Most notes of one file that are told one by one.
const NOTES: usize = 4;

impl Builder<'_> {
    pub(super) fn import(&mut self, import: &Import, span: Span) -> Option<Recipe> {
        let imported = self.read_mesh(import)?;
        self.tell_notes(import, &imported);
        let materials = self.imported_materials(import, &imported);
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

    fn bytes_of(&mut self, file: &Sp<FilePath>) -> Option<Arc<[u8]>> {
        match self.files.read(&file.value.resolved) {
            Ok(bytes) => Some(bytes),
            Err(error) => {
                self.file_fault(&error, file);
                None
            }
        }
    }

    /// The model of an MD2 file.
    pub(super) fn read_md2(&mut self, import: &Import) -> Option<Md2> {
        let file = &import.file;
        let bytes = self.bytes_of(file)?;
        let read = import::md2::read(&bytes).map_err(|fault| match import::recognize(&bytes) {
            Some(foreign) if fault == Md2Fault::NotMd2 => import::ImportError::Foreign(foreign),
            _ => fault.into(),
        });
        read.map_err(|error| self.refused(file, &error)).ok()
    }

    /// The shape of an MD2 file: one of its frames.
    fn framed_mesh(&mut self, import: &Import) -> Option<Imported> {
        let group = import.group.as_ref().map(|group| ("group", group.span));
        let weld = import.weld.map(|weld| ("weld", weld.span));
        if let Some((field, span)) = group.or(weld) {
            let message =
                format!("an MD2 file has one mesh, whose points are those of every frame: no `{field}`");
            self.report(Diagnostic::error(Code::Conflict, message).at(span, "leave it out"));
            return None;
        }
        let found = self.read_md2(import)?;
        let frame = self.frame_of(import, &found)?;
        let mut mesh = found.mesh;
        mesh.points.clone_from(&found.frames[frame].points);
        Some(Imported { mesh, ..Imported::default() })
    }

    fn read_mesh(&mut self, import: &Import) -> Option<Imported> {
        let file = &import.file;
        if file.value.extension() == "md2" {
            return self.framed_mesh(import);
        }
        let bytes = self.bytes_of(file)?;
        let options = ImportOptions {
            group: import.group.as_ref().map(|group| group.value.clone()),
            weld: import.weld.map(|weld| weld.value),
        };
        let files = self.files;
        let base = file.value.resolved.clone();
        let mut open = |path: &str| {
            let path = join(&base, path).ok()?;
            files.read(&path).ok().map(|bytes| bytes.to_vec())
        };
        let read = match file.value.extension().as_str() {
            "stl" => import::stl::read(&bytes, &options),
            "obj" => import::obj::read(&bytes, &options, &mut open),
            "ply" => import::ply::read(&bytes, &options),
            other => return self.unsupported(file, other, &bytes),
        };
        match read {
            Ok(imported) => Some(imported),
            Err(error) => {
                self.refused(file, &error);
                None
            }
        }
    }

    fn refused(&mut self, file: &Sp<FilePath>, error: &import::ImportError) {
        let line = error.line().map_or_else(String::new, |line| format!(":{line}"));
        let message = format!("{}{line}: {error}", file.value.written);
        let code = match error {
            import::ImportError::Foreign(_) | import::ImportError::Binary { .. } => Code::UnsupportedFormat,
            import::ImportError::UnknownGroup { .. } | import::ImportError::EmptyGroup { .. } => {
                Code::UnknownPart
            }
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
                "export it as Wavefront OBJ (.obj), STL (.stl), PLY (.ply) or Quake II model (.md2)",
            ),
        };
        let message = format!("{} is {what}, which cannot be imported", file.value.written);
        let report = Diagnostic::error(Code::UnsupportedFormat, message)
            .at(file.span, "not OBJ, STL, PLY or MD2")
            .help(hint);
        self.report(report);
        None
    }

    fn tell_notes(&mut self, import: &Import, imported: &Imported) {
        let file = &import.file;
        let notes = &imported.notes;
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
        let mut handles = Vec::new();
        for (index, name) in names.iter().enumerate() {
            handles.push(match import.materials.get(name) {
                Some(target) => Some(self.material(&target.value.0)?),
                None => imported.materials.get(index).and_then(|look| self.look(look)),
            });
        }
        Some(handles)
    }

    /// A material as a material library describes it; `None` where it says nothing of its look.
    fn look(&mut self, look: &MaterialLook) -> Option<MaterialHandle> {
        let [red, green, blue] = look.color?;
        let opacity = look.opacity.unwrap_or(1.0);
        self.model.materials.push(Material {
            name: look.name.clone(),
            color: [red, green, blue, opacity],
            metallic: 0.0,
            roughness: 1.0,
            color_texture: None,
            metallic_roughness_texture: None,
            normal_texture: None,
            occlusion_texture: None,
            emissive: [0.0; 3],
            emissive_texture: None,
            alpha: if opacity < 1.0 { AlphaMode::Blend } else { AlphaMode::Opaque },
            double_sided: false,
        });
        Some(MaterialHandle(mesh::index(self.model.materials.len()) - 1))
    }
}

/// OBJ files have y up by custom, STL and MD2 files z.
pub(super) fn default_up(file: &Sp<FilePath>) -> Up {
    if matches!(file.value.extension().as_str(), "stl" | "md2") { Up::Z } else { Up::Y }
}
