//! Perturbed patches: polygons with bumps.

use glam::DVec3;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::reader::Reader;
use crate::language::spec::reference::FieldReference;
use crate::language::spec::spanned::Sp;

table! {
    /// Polygons with bumps, joined along their sides: flat, or parts of a ball. Without bumps a face is where F = 0; with
    /// bumps where F = sum of `factor` Q², of those Q that are negative there. On flat faces F is the height, and on balls
    /// about the height: (d² - r²) / 2r at the distance d from the center of a ball of radius r. So a bump whose Q is -1 in
    /// its middle is about `factor` high, and ends smoothly where Q is 0. The surface is one point for each ray: along the
    /// normals of faces, or from `center`. Where bumps make it overhang, so that a ray meets it more than once, the shape
    /// is the solid below it; the report says so.
    "perturbed patches" pub PerturbedPatches {
        /// Corners, `[x, y, z]`, in the document's unit.
        points: Vec<Sp<DVec3>> => Check::items(3);
        /// The faces: for each, the indices of its corners in `points`, from 0, counterclockwise seen from outside.
        faces: Vec<Sp<Vec<u32>>> => Check::items(1);
        /// The center that all faces look away from. With it bumps may lie over sides that faces share; without it only
        /// where the faces at a side lie in one plane. On flat faces about a center F is measured along with the distance of
        /// the face from it, so that it is the same on both sides of an edge: in faces further out than the mean it grows less.
        center: Option<Sp<DVec3>>;
        /// Whether faces are parts of a ball about `center`, on which all points lie. Their sides are great circles.
        spherical: Sp<bool> = false;
        /// The bumps.
        bumps: Vec<Sp<PatchBump>> = Vec::new();
        /// How far the surface may go from the faces. When it is not written: as far as the bumps reach, or half of the size
        /// of all points where a bump goes on without end.
        reach: Option<Sp<f64>> => Check::above(0.0);
        /// How far the solid goes below a single face that overhangs.
        depth: Option<Sp<f64>> => Check::above(0.0);
    }
    checked check
}

table! {
    /// A perturbation of patches.
    "patch bump" pub PatchBump {
        /// Its Q, by name or in place: a quadric, a half space, or such a field perturbed by others; moved, scaled, added up.
        /// `{ quadric = { xx = 25, yy = 25, zz = 25, constant = -1 }, at = [0, 1, 0] }` is a ball of radius 1/5.
        field: FieldReference;
        /// Factor of its square: the height of a hill; negative, the depth of a hollow.
        factor: Sp<f64> = 1.0 => Check::nonzero();
        /// The faces that it is for, by their indices; when it is not written, all.
        faces: Option<Sp<Vec<u32>>>;
    }
}

impl PerturbedPatches {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let mut good = true;
        for (index, face) in self.faces.iter().enumerate() {
            good &= self.check_face(index, face, reader);
        }
        for (index, bump) in self.bumps.iter().enumerate() {
            let Some(faces) = &bump.value.faces else { continue };
            let place = format!("`bumps[{index}].faces`");
            good &= in_range(&place, faces, ("faces", self.faces.len()), reader);
        }
        if self.spherical.value && self.center.is_none() {
            let report = Diagnostic::error(Code::MissingField, "faces of a ball need its `center`")
                .at(self.spherical.span, "a ball about which point?")
                .help("write `center = [0, 0, 0]`");
            reader.report(report);
            good = false;
        }
        good
    }

    fn check_face(&self, index: usize, face: &Sp<Vec<u32>>, reader: &mut Reader<'_>) -> bool {
        let place = format!("`faces[{index}]`");
        if let Some(fault) = super::mesh::corner_fault(face) {
            reader.report(Diagnostic::error(Code::FaceCorners, format!("{place} {fault}")).at(face.span, ""));
            return false;
        }
        in_range(&place, face, ("points", self.points.len()), reader)
    }
}

fn in_range(place: &str, found: &Sp<Vec<u32>>, (of, count): (&str, usize), reader: &mut Reader<'_>) -> bool {
    let Some(index) = found.iter().find(|index| **index as usize >= count) else { return true };
    let message = format!("{place} names {index}, but `{of}` has only {count} items");
    let report = Diagnostic::error(Code::FaceIndex, message).at(found.span, "index out of range");
    reader.report(report.note("indices count from 0"));
    false
}
