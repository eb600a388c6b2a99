//! Colors of vertices: one for all, or by formulas of the place.

use serde_json::Value as Json;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::formula::Formula;
use crate::language::spec::material::Color;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::schema::{Schemas, any_of};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

/// The color of the vertices of a shape: a color, or a table of formulas.
#[derive(Clone, Debug, PartialEq)]
pub enum VertexColor {
    /// The same for all.
    Even(Color),
    /// By formulas.
    Varying(Box<VertexColorFormulas>),
}

table! {
    /// Colors of vertices by formulas of the place x, y, z before `scale`, `rotate` and `at`, in the document's unit, and of the
    /// normal nx, ny, nz there. Between vertices colors go straight, so write a finer `tolerance` or `segments` where they
    /// change within a face. What is beyond 0 and 1 is held back.
    "vertex-color" pub VertexColorFormulas {
        /// Two or more colors, evenly from 0 to 1, between which `by` chooses.
        colors: Option<Sp<Vec<Sp<Color>>>> => Check::items(2);
        /// Where between the first color, 0, and the last, 1.
        by: Option<Sp<Formula>>;
        /// Red, linear; 1 when it is not written.
        red: Option<Sp<Formula>>;
        /// Green, linear; 1 when it is not written.
        green: Option<Sp<Formula>>;
        /// Blue, linear; 1 when it is not written.
        blue: Option<Sp<Formula>>;
        /// Opacity; 1 when it is not written. What it does is said by the `alpha` of the material.
        alpha: Option<Sp<Formula>>;
    }
    checked check
}

impl VertexColorFormulas {
    /// The formulas of red, green, blue and alpha that are written.
    #[must_use]
    pub fn parts(&self) -> [Option<&Sp<Formula>>; 4] {
        [&self.red, &self.green, &self.blue, &self.alpha].map(Option::as_ref)
    }

    fn check(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        let part = self.parts().into_iter().flatten().next();
        let help = "write `{ colors = [\"#305020\", \"#ffffff\"], by = \"= y / 2\" }`, or formulas of `red`, `green`, `blue`";
        let report = match (&self.colors, &self.by, part) {
            (Some(_), Some(_), None) | (None, None, Some(_)) => return true,
            (None, None, None) => Diagnostic::error(
                Code::MissingField,
                "missing `colors` and `by`, or `red`, `green` or `blue`",
            )
            .at(span, "what color?")
            .help(help),
            (Some(colors), _, Some(part)) => Diagnostic::error(
                Code::Conflict,
                "colors are chosen by `by`, or made of their parts, not both",
            )
            .at(part.span, "a part")
            .also(colors.span, "the colors")
            .help(help),
            (Some(colors), None, None) => Diagnostic::error(Code::MissingField, "`colors` needs `by`")
                .at(colors.span, "which of them?")
                .help(help),
            (None, Some(by), _) => Diagnostic::error(Code::MissingField, "`by` needs `colors`")
                .at(by.span, "between what?")
                .help(help),
        };
        reader.report(report);
        false
    }
}

impl Read for VertexColor {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        match &value.data {
            Data::Table(_) => {
                VertexColorFormulas::read(value, reader).map(|formulas| Self::Varying(Box::new(formulas)))
            }
            _ => Color::read(value, reader).map(Self::Even),
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        any_of(vec![Color::schema(schemas), VertexColorFormulas::schema(schemas)])
    }
}
