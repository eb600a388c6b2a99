//! Colors of vertices into laws.

use super::Builder;
use super::formula::Compiler;
use crate::language::spec;
use crate::model::ColorLaw;

/// What formulas of colors speak of.
const VARIABLES: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

impl Builder<'_> {
    pub(super) fn color_law(&mut self, written: &spec::VertexColor) -> Option<ColorLaw> {
        let formulas = match written {
            spec::VertexColor::Even(color) => return Some(ColorLaw::Even(color.linear)),
            spec::VertexColor::Varying(formulas) => formulas,
        };
        let mut compiler = Compiler::new(&VARIABLES);
        if let (Some(colors), Some(by)) = (&formulas.colors, &formulas.by) {
            return match compiler.add(&by.value) {
                Ok(slot) => Some(ColorLaw::Between {
                    colors: colors.value.iter().map(|color| color.value.linear).collect(),
                    by: Box::new(compiler.finish(vec![slot]).formula),
                }),
                Err(diagnostic) => {
                    self.report(*diagnostic);
                    None
                }
            };
        }
        let mut slots = Vec::new();
        for part in formulas.parts() {
            let slot = match part {
                Some(part) => compiler.add(&part.value),
                None => Ok(compiler.constant(1.0)),
            };
            match slot {
                Ok(slot) => slots.push(slot),
                Err(diagnostic) => self.report(*diagnostic),
            }
        }
        (slots.len() == 4).then(|| ColorLaw::Parts(Box::new(compiler.finish(slots).formula)))
    }
}
