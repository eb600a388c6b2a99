//! Subdivision surfaces: a cage, a scheme, creases.

use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::kind::choice;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::reference::ShapeReference;
use crate::language::spec::scalar::finite;
use crate::language::spec::schema::{Schemas, any_of, one_of_words};
use crate::language::spec::spanned::Sp;
use crate::language::value::Value;

table! {
    /// A coarse shape made smooth: each of its faces is split again and again, and its vertices move toward a smooth surface.
    /// Without `levels` it is refined until the mesh lies within `tolerance` of that surface.
    "subdivide" pub Subdivide {
        /// The coarse shape: its name, or a shape in place. Boxes, meshes, polyhedra and imported files keep their polygons;
        /// of other shapes the triangles are the cage.
        cage: ShapeReference;
        /// How faces are split and what moves where.
        scheme: Sp<SubdivisionScheme> = SubdivisionScheme::CatmullClark;
        /// How often it is refined. When it is not written, as often as `tolerance` asks.
        levels: Option<Sp<u32>> => Check::within(1.0, 12.0);
        /// Whether the vertices of the mesh are put on the smooth surface; otherwise they lie beside it. Without `levels`
        /// that needs more of them.
        limit: Sp<bool> = true;
        /// What becomes of the ends of faces at the border of a cage that is open.
        border: Sp<CageBorder> = CageBorder::Smooth;
        /// Edges that stay sharp for a while or for ever, with "catmull-clark" and "loop". A later one overrides an earlier.
        /// Borders are sharp by themselves.
        creases: Vec<SubdivideCrease> = Vec::new();
        /// Vertices that stay sharp, with "catmull-clark" and "loop".
        corners: Vec<SubdivideCorner> = Vec::new();
        /// Whether faces of more than three corners are cut into triangles where the scheme is one of triangles.
        triangulate: Sp<bool> = false;
    }
    checked check
}

choices! {
    /// How a cage is refined.
    SubdivisionScheme {
        /// Faces of any number of corners into quads. Smooth; bicubic where the cage is regular.
        CatmullClark = "catmull-clark";
        /// Triangles into four. Smooth.
        Loop = "loop";
        /// Triangles into three, turned over: more steps with fewer faces each. Smooth.
        Root3 = "sqrt3";
        /// Corners are cut off again and again. Its smooth surface touches the middles of the faces.
        DooSabin = "doo-sabin";
        /// Corners are cut off between the middles of edges; one level is two cuts.
        MidEdge = "mid-edge";
        /// Triangles into four; the surface goes through the vertices of the cage.
        Butterfly = "butterfly";
        /// Faces into quads, and nothing moves.
        Bilinear = "bilinear";
    }
}

choices! {
    /// What becomes of the border of an open cage.
    CageBorder {
        /// It becomes a smooth curve all round.
        Smooth = "smooth";
        /// So it does, but vertices that belong to one face alone stay where they are. Not with "doo-sabin" and "mid-edge".
        Corners = "corners";
    }
}

table! {
    /// Edges of a cage that are sharp: between vertices, or by the angle of their faces.
    "crease" pub SubdivideCrease {
        /// The edges, each by its two vertices, `[a, b]`; vertices count from 0 in the order of the cage.
        edges: Vec<Sp<Vec<u32>>> = Vec::new();
        /// Instead: all edges at which the faces turn by more than this many degrees.
        crease_angle: Option<Sp<f64>> => Check::within(0.0, 180.0);
        /// Instead: the edges and vertices that the file of the cage says are sharp, each for as many levels as it says:
        /// lines `t crease` and `t corner` of an OBJ file, as `OpenSubdiv` has them.
        imported: Sp<bool> = false;
        /// For how many levels they stay sharp, such as 2 or 1.5; `"sharp"`, or 10, is for ever.
        sharpness: Sp<Sharpness> = Sharpness(FOREVER);
    }
    checked check
}

table! {
    /// A vertex of a cage that is sharp.
    "sharp corner" pub SubdivideCorner {
        /// The vertex, from 0 in the order of the cage.
        vertex: Sp<u32>;
        /// For how many levels it stays sharp; `"sharp"`, or 10, is for ever.
        sharpness: Sp<Sharpness> = Sharpness(FOREVER);
    }
}

/// A sharpness that does not end.
const FOREVER: f64 = 10.0;

/// For how many levels something stays sharp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sharpness(pub f64);

impl Read for Sharpness {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if value.number().is_some() {
            return finite(value, reader)
                .filter(|_| Check::above(0.0).up_to(FOREVER).apply(value, reader))
                .map(Self);
        }
        choice(value, &["sharp"], reader).map(|_| Self(FOREVER))
    }

    fn schema(_: &mut Schemas) -> Json {
        let mut alternatives = one_of_words(&["sharp"]);
        alternatives.push(json!({ "type": "number", "exclusiveMinimum": 0, "maximum": FOREVER }));
        any_of(alternatives)
    }

    fn written(&self) -> Option<Json> {
        Some(if self.0 == FOREVER { json!("sharp") } else { json!(self.0) })
    }
}

impl Subdivide {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let scheme = self.scheme.value;
        let creased = matches!(scheme, SubdivisionScheme::CatmullClark | SubdivisionScheme::Loop);
        let crease = self.creases.iter().map(|crease| crease.sharpness.span).next();
        let place = crease.or(self.corners.first().map(|corner| corner.vertex.span));
        let mut good = true;
        if let (false, Some(place)) = (creased, place) {
            let message = format!("the scheme \"{}\" has no rules for creases and corners", scheme.text());
            let report = Diagnostic::error(Code::Conflict, message)
                .at(if place.is_none() { self.scheme.span } else { place }, "sharp")
                .also(self.scheme.span, "the scheme")
                .help("write `scheme = \"catmull-clark\"` or \"loop\", or leave them out");
            reader.report(report);
            good = false;
        }
        let cuts = matches!(scheme, SubdivisionScheme::DooSabin | SubdivisionScheme::MidEdge);
        if cuts && self.border.value == CageBorder::Corners {
            let message = format!("the scheme \"{}\" cuts all corners, those of borders too", scheme.text());
            let report = Diagnostic::error(Code::Conflict, message)
                .at(self.border.span, "cannot stay")
                .also(self.scheme.span, "the scheme")
                .help("leave `border` out");
            reader.report(report);
            good = false;
        }
        good
    }
}

impl SubdivideCrease {
    fn check(&self, table: Span, reader: &mut Reader<'_>) -> bool {
        if let Some(pair) = self.edges.iter().find(|pair| pair.len() != 2) {
            let message = format!("an edge has 2 vertices, found {}", pair.len());
            let report = Diagnostic::error(Code::WrongLength, message).at(pair.span, "expected `[a, b]`");
            reader.report(report.help("write one pair for each edge: `[[0, 1], [1, 2]]`"));
            return false;
        }
        let said = [
            (!self.edges.is_empty(), "`edges`"),
            (self.crease_angle.is_some(), "`crease-angle`"),
            (self.imported.value, "`imported`"),
        ];
        let said: Vec<&str> = said.iter().filter(|(said, _)| *said).map(|(_, name)| *name).collect();
        let (code, message) = match said[..] {
            [_] => return true,
            [] => (Code::MissingField, "missing `edges`, `crease-angle` or `imported` of crease".to_owned()),
            _ => (Code::Conflict, format!("{} both say which edges are sharp", said.join(" and "))),
        };
        let report = Diagnostic::error(code, message).at(table, "which edges?");
        reader.report(report.help("write one of them; `creases` may have several entries"));
        false
    }
}
