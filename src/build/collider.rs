//! Colliders of a document.

use super::Builder;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::{self, ColliderFit};
use crate::model::{Collider, Fit};

/// The most convex parts where none are written.
const PARTS: u32 = 16;

/// Concavity where none is written, as part of the diagonal.
const CONCAVITY: f64 = 0.03;

impl Builder<'_> {
    pub(super) fn colliders(&mut self) {
        let spec = self.spec;
        for (name, definition) in &spec.colliders {
            if let Some(collider) = self.collider(name, &definition.value) {
                self.model.colliders.push(collider);
                self.collider_places.push(definition.span);
            }
        }
    }

    fn collider(&mut self, name: &str, written: &spec::Collider) -> Option<Collider> {
        let shape = self.named_shape(&written.shape.value.0)?;
        let nodes: Vec<usize> = match &written.node {
            Some(node) => self.spec.nodes.get_index_of(&node.value.0).into_iter().collect(),
            None => {
                let shows = |(_, node): &(usize, &crate::model::Node)| node.shape == Some(shape);
                self.model.nodes.iter().enumerate().filter(shows).map(|(index, _)| index).collect()
            }
        };
        if nodes.is_empty() {
            let message = format!("no node shows the shape `{}` of collider `{name}`", written.shape.value.0);
            let report = Diagnostic::error(Code::ColliderPlace, message)
                .at(written.shape.span, "never shown")
                .help("write `node` with the name of the node that the collider belongs to");
            self.report(report);
            return None;
        }
        let fit = match written.fit.value {
            ColliderFit::Auto => Fit::Auto,
            ColliderFit::Box => Fit::Box,
            ColliderFit::Sphere => Fit::Sphere,
            ColliderFit::Capsule => Fit::Capsule,
            ColliderFit::Cylinder => Fit::Cylinder,
            ColliderFit::Hull => Fit::Hull,
            ColliderFit::Parts => Fit::Parts,
        };
        Some(Collider {
            name: name.to_owned(),
            shape,
            nodes,
            fit,
            vertices: written.vertices.value,
            parts: written.parts.as_ref().map_or(PARTS, |parts| parts.value),
            concavity: written.concavity.as_ref().map_or(CONCAVITY, |concavity| concavity.value),
        })
    }
}
