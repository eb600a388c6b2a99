//! `[collider.NAME]`: simple bodies that physics engines take for shapes.

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::reader::Reader;
use crate::language::spec::reference::{NodeName, ShapeName};
use crate::language::spec::spanned::Sp;

table! {
    /// A body that a physics engine takes for a shape. Where the shape is a box, a ball, a capsule or a cylinder, also one that is
    /// turned from a profile, the body is exactly that; else it encloses the shape.
    "collider" pub Collider {
        /// The name of the shape.
        shape: Sp<ShapeName>;
        /// The node that it belongs to, whose own place holds for the body too; all nodes that show the shape when it is not written.
        node: Option<Sp<NodeName>>;
        /// What body it is.
        fit: Sp<ColliderFit> = ColliderFit::Auto;
        /// The most vertices of a hull, or of each part. One of fewer vertices than the true hull encloses it.
        vertices: Sp<u32> = 64_u32 => Check::within(8.0, 255.0);
        /// With `fit = "parts"`: the most parts; 16 when it is not written.
        parts: Option<Sp<u32>> => Check::within(2.0, 64.0);
        /// With `fit = "parts"`: how far from convex what a part stands for may be, as part of the diagonal of the shape's box;
        /// 0.03 when it is not written. The less, the more parts.
        concavity: Option<Sp<f64>> => Check::within(0.002, 1.0);
    }
    checked check
}

impl Collider {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let parts = self.parts.as_ref().map(|parts| ("parts", parts.span));
        let concavity = self.concavity.as_ref().map(|concavity| ("concavity", concavity.span));
        let Some((key, span)) = parts.or(concavity).filter(|_| self.fit.value != ColliderFit::Parts) else {
            return true;
        };
        let message = format!("`{key}` has no effect with `fit = \"{}\"`", self.fit.value.text());
        reader.report(
            Diagnostic::error(Code::Conflict, message)
                .at(span, "said of convex parts")
                .help("write `fit = \"parts\"`, or leave it out"),
        );
        false
    }
}

choices! {
    /// What body stands for a shape.
    ColliderFit {
        /// The shape itself where it is a box, a ball, a capsule or a cylinder, else its hull.
        Auto = "auto";
        /// A box along the axes of the node.
        Box = "box";
        /// A ball.
        Sphere = "sphere";
        /// A capsule along an axis of the node: that of the least volume.
        Capsule = "capsule";
        /// A cylinder along an axis of the node: that of the least volume.
        Cylinder = "cylinder";
        /// The least convex body.
        Hull = "hull";
        /// Several convex bodies that cover a shape that is not convex: it is cut by planes where it is least convex, until its
        /// parts are nearly so, and parts that do as well together are joined. The shape must be closed. Parts are named
        /// `NAME-00`, `NAME-01`...
        Parts = "parts";
    }
}

choices! {
    /// How colliders stand in a file.
    ColliderForm {
        /// As numbers in the `extras` of the node, under `colliders`: a list of tables with `name`, `shape` ("box", "sphere",
        /// "capsule", "cylinder", "hull"), `translation`, `rotation`, and `size`, `radius`, `height` (of a capsule without its ends)
        /// or `points` and `indices`; `part-of` names the collider of several parts. For Bevy and whatever else reads extras.
        Extras = "extras";
        /// By the extensions `OMI_physics_shape` and `OMI_physics_body`, which are not required, on nodes below the node.
        Omi = "omi";
        /// As meshes below the node, named `NAME-convcolonly`, of which Godot makes convex bodies.
        Godot = "godot";
        /// As meshes below the node, named `UBX_NODE_00`, `USP_`, `UCP_` and `UCX_`, of which Unreal makes bodies.
        Unreal = "unreal";
    }
}
