//! Nodes: where shapes stand, and what moves with what.

use glam::DVec3;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::point::Scale;
use crate::language::spec::reader::Reader;
use crate::language::spec::reference::{MaterialName, NodeName, ShapeName};
use crate::language::spec::spanned::Sp;

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
        /// The name of a material, in place of the shape's own.
        material: Option<Sp<MaterialName>>;
    }
    checked check
}

impl Node {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let (Some(parent), Some(socket)) = (&self.parent, &self.socket) else { return true };
        let report = Diagnostic::error(Code::Conflict, "a node is carried by a `parent` or by a `socket`")
            .at(socket.span, "cannot stand beside `parent`")
            .also(parent.span, "the parent");
        reader.report(report);
        false
    }
}
