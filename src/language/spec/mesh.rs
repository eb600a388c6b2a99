//! Meshes written out: points and faces.

use glam::{DVec2, DVec3};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::material::Color;
use crate::language::spec::polygon::Face;
use crate::language::spec::reader::Reader;
use crate::language::spec::reference::MaterialName;
use crate::language::spec::spanned::Sp;

table! {
    /// Points and faces, written out. Faces turn counterclockwise seen from outside.
    "mesh" pub Mesh {
        /// The points, `[x, y, z]`, in the document's unit.
        points: Vec<Sp<DVec3>> => Check::items(3);
        /// The faces: for each, the indices of its corners in `points`, from 0. A face with holes is a list of loops:
        /// `[[0, 1, 2, 3], [4, 5, 6]]`, the outline first.
        faces: Vec<Sp<Face>> => Check::items(1);
        /// Texture coordinates, `[u, v]`. Without `face-uvs` there is one for each point.
        uvs: Option<Sp<Vec<DVec2>>>;
        /// For each face, the indices of its corners in `uvs`; loops are written as in `faces`.
        face_uvs: Option<Sp<Vec<Sp<Face>>>>;
        /// For each point its color, which multiplies that of the material.
        colors: Option<Sp<Vec<Color>>>;
        /// For each face the number of its smoothing group: edges between faces of one group look smooth. 0 is flat.
        smoothing_groups: Option<Sp<Vec<u32>>>;
        /// For each face the name of its material. Without it all have the material of the shape.
        face_materials: Option<Sp<Vec<Sp<MaterialName>>>>;
    }
    checked check
}

impl Mesh {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let mut good = true;
        for (index, face) in self.faces.iter().enumerate() {
            good &= self.check_face(index, face, reader);
        }
        let uvs = self.check_uvs(reader);
        let points = ("points", self.points.len());
        let colors = (self.colors.as_ref())
            .is_none_or(|colors| self.same_count("colors", colors.len(), colors.span, points, reader));
        let faces = ("faces", self.faces.len());
        let materials = self.face_materials.as_ref().is_none_or(|materials| {
            self.same_count("face-materials", materials.len(), materials.span, faces, reader)
        });
        self.check_groups(reader) && materials && uvs && colors && good
    }

    fn check_face(&self, index: usize, face: &Sp<Face>, reader: &mut Reader<'_>) -> bool {
        let place = format!("`faces[{index}]`");
        let faults = face.loops.iter().enumerate().filter_map(|(k, corners)| {
            let fault = corner_fault(corners)?;
            Some(if k == 0 { fault } else { format!("has a hole that {fault}") })
        });
        if let Some(fault) = faults.into_iter().next() {
            reader.report(Diagnostic::error(Code::FaceCorners, format!("{place} {fault}")).at(face.span, ""));
            return false;
        }
        check_indices(&place, face, self.points.len(), "points", reader)
    }

    fn check_uvs(&self, reader: &mut Reader<'_>) -> bool {
        match (&self.uvs, &self.face_uvs) {
            (Some(uvs), Some(faces)) => self.check_face_uvs(uvs.len(), faces, reader),
            (Some(uvs), None) => {
                self.same_count("uvs", uvs.len(), uvs.span, ("points", self.points.len()), reader)
            }
            (None, Some(faces)) => {
                let report = Diagnostic::error(Code::MissingField, "`face-uvs` needs `uvs`");
                reader.report(report.at(faces.span, "indices into `uvs`"));
                false
            }
            (None, None) => true,
        }
    }

    fn check_face_uvs(&self, uvs: usize, faces: &Sp<Vec<Sp<Face>>>, reader: &mut Reader<'_>) -> bool {
        if !self.same_count("face-uvs", faces.len(), faces.span, ("faces", self.faces.len()), reader) {
            return false;
        }
        let mut good = true;
        for (index, (corners, face)) in faces.iter().zip(&self.faces).enumerate() {
            let place = format!("`face-uvs[{index}]`");
            let counts = |face: &Face| face.loops.iter().map(Vec::len).collect::<Vec<_>>();
            if counts(corners) == counts(face) {
                good &= check_indices(&place, corners, uvs, "uvs", reader);
                continue;
            }
            let said =
                |face: &Face| counts(face).iter().map(ToString::to_string).collect::<Vec<_>>().join(" + ");
            let message = format!("{place} has {} corners, its face has {}", said(corners), said(face));
            let report = Diagnostic::error(Code::WrongCount, message);
            reader.report(report.at(corners.span, "").also(face.span, "the face"));
            good = false;
        }
        good
    }

    fn check_groups(&self, reader: &mut Reader<'_>) -> bool {
        let faces = ("faces", self.faces.len());
        self.smoothing_groups.as_ref().is_none_or(|groups| {
            self.same_count("smoothing-groups", groups.len(), groups.span, faces, reader)
        })
    }

    fn same_count(
        &self,
        field: &str,
        count: usize,
        span: Span,
        (of, expected): (&str, usize),
        reader: &mut Reader<'_>,
    ) -> bool {
        if count == expected {
            return true;
        }
        let message = format!("`{field}` needs one item for each of the {expected} {of}, found {count}");
        reader.report(Diagnostic::error(Code::WrongCount, message).at(span, format!("expected {expected}")));
        false
    }
}

pub(super) fn corner_fault(face: &[u32]) -> Option<String> {
    if face.len() < 3 {
        return Some(format!("needs at least 3 corners, found {}", face.len()));
    }
    let mut sorted = face.to_vec();
    sorted.sort_unstable();
    let twice = sorted.windows(2).find(|pair| pair[0] == pair[1])?;
    Some(format!("names point {} twice", twice[0]))
}

fn check_indices(place: &str, face: &Sp<Face>, count: usize, of: &str, reader: &mut Reader<'_>) -> bool {
    let Some(index) = face.corners().find(|index| *index as usize >= count) else { return true };
    let message = format!("{place} names {index}, but `{of}` has only {count} items");
    let report = Diagnostic::error(Code::FaceIndex, message).at(face.span, "index out of range");
    reader.report(report.note("indices count from 0"));
    false
}
