//! Shapes moved along their normals into recipes.

use std::sync::Arc;

use super::Builder;
use super::formula::Compiler;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::{Displace, DisplaceProjection};
use crate::model::{Displacement, Heights, Projection, Recipe};

impl Builder<'_> {
    pub(super) fn displace(&mut self, name: &str, written: &Displace) -> Option<Recipe> {
        let of = self.shape_of(name, 0, &written.of);
        let heights = self.heights(written);
        Some(Recipe::Displaced(Displacement { of: of?, heights: heights? }))
    }

    fn heights(&mut self, written: &Displace) -> Option<Heights> {
        let [low, high] = written.range.value.to_array();
        if let Some(formula) = &written.formula {
            let mut compiler = Compiler::new(&["x", "y", "z"]);
            return match compiler.add(&formula.value) {
                Ok(slot) => {
                    let formula = Box::new(compiler.finish(vec![slot]).formula);
                    Some(Heights::Formula { formula, range: written.range.value })
                }
                Err(diagnostic) => {
                    self.report(*diagnostic);
                    None
                }
            };
        }
        let map = written.map.as_ref()?;
        let field = self.map_of(map)?;
        if field.has_gaps() {
            let message =
                "this map has samples without a value: a shape that is moved by it has no place there";
            let report = Diagnostic::error(Code::NoValue, message)
                .at(map.span(), "has holes")
                .help("leave `no-data` out, or fill the gaps in the map");
            self.report(report);
            return None;
        }
        let projection = match written.projection.value {
            DisplaceProjection::Texture => Projection::Texture,
            DisplaceProjection::X => Projection::Along(0),
            DisplaceProjection::Y => Projection::Along(1),
            DisplaceProjection::Z => Projection::Along(2),
            DisplaceProjection::Spherical => Projection::Spherical,
            DisplaceProjection::Cylindrical => Projection::Cylindrical,
        };
        let field = Arc::new(field.scaled(high - low, low).closed(projection.closes()));
        Some(Heights::Map { field, projection })
    }
}
