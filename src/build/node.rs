//! Nodes, or where a document has none, one for each shape that stands by itself.

use glam::{DQuat, DVec3};

use super::{Builder, rotation};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::model::Node;

impl Builder<'_> {
    pub(super) fn nodes(&mut self) {
        if self.spec.nodes.is_empty() {
            self.root_nodes();
        } else {
            self.written_nodes();
        }
    }

    /// Tells of a document that shows nothing, once all nodes are there.
    pub(super) fn check_shown_nodes(&mut self) {
        let shows = self.model.nodes.iter().any(|node| node.shape.is_some());
        if !shows
            && self
                .reports
                .iter()
                .all(|report| report.severity != crate::language::diagnostic::Severity::Error)
        {
            let report = Diagnostic::error(Code::NothingToShow, "this document shows no shape")
                .at(Span::NONE, "")
                .help("define a shape, as in `[shape.ball.sphere]` with `radius = 0.5`");
            self.report(report);
        }
    }

    fn root_nodes(&mut self) {
        let spec = self.spec;
        for name in &spec.roots {
            let shape = self.named_shape(name);
            self.model.nodes.push(Node {
                name: name.clone(),
                shape,
                material: None,
                parent: None,
                socket: None,
                is_socket: false,
                is_copy: false,
                camera: None,
                light: None,
                translation: DVec3::ZERO,
                rotation: DQuat::IDENTITY,
                scale: DVec3::ONE,
            });
        }
    }

    fn written_nodes(&mut self) {
        let spec = self.spec;
        for (name, definition) in &spec.nodes {
            let node = &definition.value;
            let shape = node.shape.as_ref().and_then(|shape| self.named_shape(&shape.value.0));
            let material = node.material.as_ref().and_then(|material| self.material(&material.value.0));
            let parent = node.parent.as_ref().and_then(|parent| spec.nodes.get_index_of(&parent.value.0));
            self.model.nodes.push(Node {
                name: name.clone(),
                shape: shape.filter(|_| node.copies.is_none()),
                material,
                parent,
                socket: None,
                is_socket: false,
                is_copy: false,
                camera: node.camera.as_ref().map(|camera| self.camera_of(&camera.value)),
                light: node.light.as_ref().map(|light| self.light_of(&light.value)),
                translation: node.at.value,
                rotation: rotation(node.rotate.value),
                scale: node.scale.value.0,
            });
        }
        // After all that are written, so that these have the numbers of the document.
        for (parent, (name, definition)) in spec.nodes.iter().enumerate() {
            let node = &definition.value;
            let shape = node.shape.as_ref().and_then(|shape| self.named_shape(&shape.value.0));
            let material = self.model.nodes[parent].material;
            for (index, copy) in node.copies.iter().flat_map(|copies| &copies.value).enumerate() {
                self.model.nodes.push(Node {
                    name: format!("{name}.{index}"),
                    shape,
                    material,
                    parent: Some(parent),
                    socket: None,
                    is_socket: false,
                    is_copy: true,
                    camera: None,
                    light: None,
                    translation: copy.value.at.value,
                    rotation: rotation(copy.value.rotate.value),
                    scale: copy.value.scale.value.0,
                });
            }
        }
    }

    /// Puts nodes on the sockets that they name, once all sockets are there.
    pub(super) fn attach_nodes(&mut self) {
        let spec = self.spec;
        for (index, definition) in spec.nodes.values().enumerate() {
            let Some(name) = &definition.value.socket else { continue };
            let node = |node: &usize| {
                self.model.nodes[*node].is_socket && self.model.nodes[*node].name == name.value
            };
            match (0..self.model.nodes.len()).find(node) {
                Some(node) => self.model.nodes[index].parent = Some(node),
                None => self.model.nodes[index].socket = self.socket(name),
            }
        }
    }
}
