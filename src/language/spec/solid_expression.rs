//! Expressions over shapes: `body + handle - inside`.
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = factor { "&" factor }
//! factor  = name | "(" sum ")"
//! ```

use std::ops::Range;

use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::reader::{Read, Reader, backtick};
use crate::language::spec::reference::Family;
use crate::language::spec::schema::Schemas;
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

/// The longest expression, in bytes.
const LONGEST: usize = 10_000;

/// The deepest parentheses.
const DEEPEST: usize = 64;

/// An expression whose shapes are all defined.
#[derive(Clone, Debug, PartialEq)]
pub enum SolidExpression {
    /// The shape of a name.
    Shape(Sp<String>),
    /// Everything that is in one of both.
    Union(Box<Self>, Box<Self>),
    /// The first without the second.
    Difference(Box<Self>, Box<Self>),
    /// Everything that is in both.
    Intersection(Box<Self>, Box<Self>),
}

impl Read for SolidExpression {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let Data::String(text) = &value.data else {
            reader.mismatch(value, "names of shapes with +, - and & between them");
            return None;
        };
        match parse(text) {
            Ok(tree) => Some(tree.located(text, value.span, reader)),
            Err(fault) => {
                let (span, _) = place(text, value.span, &fault.range, reader);
                let character = text[..fault.range.start].chars().count() + 1;
                let message = format!("{}: {}, at character {character}", reader.place(), fault.message);
                let report = Diagnostic::error(Code::SolidSyntax, message).at(span, fault.label);
                reader.report(report.help(fault.help));
                None
            }
        }
    }

    fn schema(_: &mut Schemas) -> Json {
        json!({ "type": "string" })
    }
}

/// The span of a part of the text, and whether it is exact: escapes may hide it.
fn place(text: &str, span: Span, range: &Range<usize>, reader: &Reader<'_>) -> (Span, bool) {
    let byte = |at: usize| u32::try_from(at).unwrap_or(0);
    match reader.sources.snippet(span).find(text).filter(|_| !text.is_empty()) {
        Some(offset) => {
            let start = span.start + byte(offset);
            (Span::new(start + byte(range.start), start + byte(range.end)), true)
        }
        None => (span, false),
    }
}

/// What is wrong, and where in the text.
struct Fault {
    range: Range<usize>,
    message: String,
    label: &'static str,
    help: &'static str,
}

/// An expression before its names are looked up.
enum Tree {
    Name(String, Range<usize>),
    Both(u8, Box<Self>, Box<Self>),
}

impl Tree {
    fn located(self, text: &str, span: Span, reader: &mut Reader<'_>) -> SolidExpression {
        match self {
            Self::Name(name, range) => {
                let (span, exact) = place(text, span, &range, reader);
                reader.uses_inside(Family::Shape, &name, span, exact);
                SolidExpression::Shape(Sp::new(name, span))
            }
            Self::Both(sign, one, other) => {
                let one = Box::new(one.located(text, span, reader));
                let other = Box::new(other.located(text, span, reader));
                match sign {
                    b'+' => SolidExpression::Union(one, other),
                    b'-' => SolidExpression::Difference(one, other),
                    _ => SolidExpression::Intersection(one, other),
                }
            }
        }
    }
}

fn parse(text: &str) -> Result<Tree, Fault> {
    if text.len() > LONGEST {
        return Err(Fault {
            range: 0..text.len(),
            message: format!("an expression has at most {LONGEST} bytes, found {}", text.len()),
            label: "too long",
            help: "give parts of it names: a shape of the kind `solid` may stand in another",
        });
    }
    let mut parser = Parser { text, at: 0, depth: 0 };
    let tree = parser.sum()?;
    match parser.peek() {
        None => Ok(tree),
        Some(')') => {
            Err(parser.fault("a closing parenthesis that nothing opens", "never opened", "leave it out"))
        }
        Some(found) => {
            let message = format!("expected +, - or &, found {}", backtick(&found.to_string()));
            Err(parser.fault(&message, "no sign before it", "write +, - or & between two shapes"))
        }
    }
}

struct Parser<'t> {
    text: &'t str,
    at: usize,
    depth: usize,
}

impl Parser<'_> {
    /// The next character that is no space.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        let trimmed = rest.trim_start_matches([' ', '\t', '\n', '\r']);
        self.at = self.text.len() - trimmed.len();
        trimmed.chars().next()
    }

    fn fault(&mut self, message: &str, label: &'static str, help: &'static str) -> Fault {
        let length = self.peek().map_or(0, char::len_utf8);
        Fault { range: self.at..self.at + length, message: message.to_owned(), label, help }
    }

    fn sum(&mut self) -> Result<Tree, Fault> {
        let mut tree = self.product()?;
        while let Some(sign @ ('+' | '-')) = self.peek() {
            self.at += 1;
            let other = self.product()?;
            tree = Tree::Both(if sign == '+' { b'+' } else { b'-' }, Box::new(tree), Box::new(other));
        }
        Ok(tree)
    }

    fn product(&mut self) -> Result<Tree, Fault> {
        let mut tree = self.factor()?;
        while self.peek() == Some('&') {
            self.at += 1;
            let other = self.factor()?;
            tree = Tree::Both(b'&', Box::new(tree), Box::new(other));
        }
        Ok(tree)
    }

    fn factor(&mut self) -> Result<Tree, Fault> {
        match self.peek() {
            Some('(') => self.parentheses(),
            Some(letter) if letter.is_alphanumeric() || letter == '_' => Ok(self.name()),
            Some(sign @ ('+' | '-' | '&')) => {
                let message = format!("{} needs a shape before it", backtick(&sign.to_string()));
                Err(self.fault(
                    &message,
                    "nothing before it",
                    "write the name of a shape on both sides of a sign",
                ))
            }
            Some(found) => {
                let message = format!("expected the name of a shape, found {}", backtick(&found.to_string()));
                Err(self.fault(&message, "no name", "write names of shapes with +, - and & between them"))
            }
            None => Err(self.fault(
                "expected the name of a shape, found the end",
                "a name is missing here",
                "write names of shapes with +, - and & between them: \"body + handle - inside\"",
            )),
        }
    }

    fn parentheses(&mut self) -> Result<Tree, Fault> {
        let start = self.at;
        self.depth += 1;
        if self.depth > DEEPEST {
            let message = format!("parentheses are nested more than {DEEPEST} deep");
            return Err(self.fault(&message, "too deep", "give parts of it names"));
        }
        self.at += 1;
        let tree = self.sum()?;
        if self.peek() != Some(')') {
            if self.peek().is_some() {
                return Err(self.fault(
                    "expected +, -, & or )",
                    "no sign before it",
                    "write a sign between two shapes",
                ));
            }
            return Err(Fault {
                range: start..start + 1,
                message: "a parenthesis is never closed".to_owned(),
                label: "opened here",
                help: "write `)` where it ends",
            });
        }
        self.at += 1;
        self.depth -= 1;
        Ok(tree)
    }

    /// Letters, digits, `_`, and hyphens between them.
    fn name(&mut self) -> Tree {
        let start = self.at;
        let rest = &self.text[start..];
        let mut end = 0;
        for (at, letter) in rest.char_indices() {
            let after = rest[at + letter.len_utf8()..].chars().next();
            let hyphen = letter == '-' && after.is_some_and(char::is_alphanumeric);
            if !(letter.is_alphanumeric() || letter == '_' || hyphen) {
                break;
            }
            end = at + letter.len_utf8();
        }
        self.at = start + end;
        Tree::Name(rest[..end].to_owned(), start..start + end)
    }
}

#[cfg(test)]
mod tests {
    use super::{Tree, parse};

    fn shown(tree: &Tree) -> String {
        match tree {
            Tree::Name(name, _) => name.clone(),
            Tree::Both(sign, one, other) => {
                format!("({} {} {})", shown(one), char::from(*sign), shown(other))
            }
        }
    }

    #[test]
    fn signs_bind_as_they_should() {
        for (text, expected) in [
            ("a", "a"),
            ("a + b - c", "((a + b) - c)"),
            ("a - b & c + d", "((a - (b & c)) + d)"),
            ("a-(b+c)", "(a - (b + c))"),
            ("(a)&( b )", "(a & b)"),
            ("left-arm - right-arm", "(left-arm - right-arm)"),
            ("a2 -b", "(a2 - b)"),
        ] {
            assert_eq!(parse(text).map(|tree| shown(&tree)).ok().as_deref(), Some(expected), "{text}");
        }
    }

    #[test]
    fn faults_say_where_they_are() {
        for (text, at) in [
            ("", 0),
            ("a +", 3),
            ("+ a", 0),
            ("a b", 2),
            ("(a + b", 0),
            ("a)", 1),
            ("a * b", 2),
            ("a + (b - )", 9),
            ("a & & b", 4),
            ("()", 1),
        ] {
            assert_eq!(parse(text).err().map(|fault| fault.range.start), Some(at), "{text}");
        }
        assert!(parse(&"(".repeat(2000)).is_err());
        assert!(parse(&"a + ".repeat(20_000)).is_err());
    }
}
