//! Nodes: where shapes stand, and what moves with what.

use glam::DVec3;
use indexmap::IndexMap;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::import::{FilePath, Up};
use crate::language::spec::point::Scale;
use crate::language::spec::reader::Reader;
use crate::language::spec::reference::{MaterialName, NodeName, ShapeName};
use crate::language::spec::spanned::Sp;
use crate::language::spec::view::{Aim, Camera, Light};

table! {
    /// A place in the model: it shows a shape, or only carries other nodes. Nodes that show the same shape share one mesh.
    "node" pub Node {
        /// The name of the shape that it shows.
        shape: Option<Sp<ShapeName>>;
        /// The name of the node that carries it.
        parent: Option<Sp<NodeName>>;
        /// The name of the socket that carries it, in place of a node.
        socket: Option<Sp<String>>;
        /// Factor of size: a number, or one for each axis. Applied before `rotate` and `at`.
        scale: Sp<Scale> = Scale(DVec3::ONE) => Check::nonzero();
        /// Degrees about the x axis, then the y axis, then the z axis.
        rotate: Sp<DVec3> = DVec3::ZERO;
        /// How far it is moved from its parent, in the document's unit.
        at: Sp<DVec3> = DVec3::ZERO;
        /// What it looks at, in place of `rotate`: the name of a node, or a point of the model in the document's unit and axes.
        /// A node with a camera or light looks as those do; of any other z looks there, and where z points up in the document
        /// -y, the front of a model. The document's upward axis stays up. In clips it goes on looking.
        aim: Option<Sp<Aim>>;
        /// What is seen from there.
        camera: Option<Sp<Camera>>;
        /// What shines from there.
        light: Option<Sp<Light>>;
        /// The name of a material, in place of the shape's own.
        material: Option<Sp<MaterialName>>;
        /// Where it shows the shape, from the node itself, in place of once: each becomes a node `NODE.0`, `NODE.1`... below
        /// this one, or, for an engine that reads such, all are drawn at once (`EXT_mesh_gpu_instancing`). For a row, a ring or
        /// a forest write `{ count = 99, each = { at = ["= 2 * i", 0, 0] } }`.
        copies: Option<Sp<Vec<Sp<NodeCopy>>>> => Check::items(1);
        /// A whole scene from a file, as `[node.NAME.import]`: the node carries it.
        import: Option<Sp<SceneImport>>;
    }
    checked check
}

/// The most copies that a node shows.
const MOST_COPIES: usize = 20_000;

table! {
    /// A place where a node shows its shape once more.
    "node copy" pub NodeCopy {
        /// Factor of size: a number, or one for each axis. Applied before `rotate` and `at`.
        scale: Sp<Scale> = Scale(DVec3::ONE) => Check::nonzero();
        /// Degrees about the x axis, then the y axis, then the z axis.
        rotate: Sp<DVec3> = DVec3::ZERO;
        /// How far it is moved from the node, in the document's unit.
        at: Sp<DVec3> = DVec3::ZERO;
    }
}

table! {
    /// A scene from a 3D Studio file (3DS): its objects, cameras and lights are nodes of their names in kebab-case, one below
    /// the other as in the file, and its motion is a clip. What is hidden for some frames is scaled to nothing there.
    "scene import" pub SceneImport {
        /// The file; the path is relative to this document and stays inside the project.
        file: Sp<FilePath>;
        /// What one unit of the file is in the document's unit.
        scale: Sp<f64> = 1.0 => Check::above(0.0);
        /// Which axis of the file points up: `"z"` when it is not written.
        up: Option<Sp<Up>>;
        /// For each material of the file the name of one of this document.
        materials: IndexMap<String, Sp<MaterialName>> = IndexMap::new();
        /// Frames that are played in a second.
        frame_rate: Sp<f64> = 30.0 => Check::within(1.0, 1000.0);
        /// The name of the clip; that of the node when it is not written.
        clip: Option<Sp<String>>;
        /// Whether the clip is played again and again.
        r#loop: Sp<bool> = false;
    }
}

impl Node {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        if let (Some(shape), Some(import)) = (&self.shape, &self.import) {
            let message = "a node shows a `shape` or carries what it imports";
            let report = Diagnostic::error(Code::Conflict, message)
                .at(shape.span, "cannot stand beside `import`")
                .also(import.span, "the import");
            reader.report(report);
            return false;
        }
        if let (Some(aim), false) = (&self.aim, self.rotate.span.is_none()) {
            let report = Diagnostic::error(Code::Conflict, "a node is turned by `rotate` or by `aim`")
                .at(aim.span, "cannot stand beside `rotate`")
                .also(self.rotate.span, "turned here");
            reader.report(report);
            return false;
        }
        if let Some(copies) = &self.copies
            && !self.check_copies(copies, reader)
        {
            return false;
        }
        let (Some(parent), Some(socket)) = (&self.parent, &self.socket) else { return true };
        let report = Diagnostic::error(Code::Conflict, "a node is carried by a `parent` or by a `socket`")
            .at(socket.span, "cannot stand beside `parent`")
            .also(parent.span, "the parent");
        reader.report(report);
        false
    }

    fn check_copies(&self, copies: &Sp<Vec<Sp<NodeCopy>>>, reader: &mut Reader<'_>) -> bool {
        let report = if self.shape.is_none() {
            Diagnostic::error(Code::MissingField, "copies of a node that shows no `shape`")
                .at(copies.span, "of what?")
                .help("write `shape = \"NAME\"` beside `copies`; several shapes are one by `[shape.NAME.group]`")
        } else if copies.value.len() > MOST_COPIES {
            let message = format!("a node shows at most {MOST_COPIES} copies, found {}", copies.value.len());
            Diagnostic::error(Code::WrongLength, message)
                .at(copies.span, "too many")
                .help("let each be several: show a shape of the kind `array` or `group`")
        } else {
            return true;
        };
        reader.report(report);
        false
    }
}
