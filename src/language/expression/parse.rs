//! Tokens to a tree, by precedence climbing.

use std::ops::Range;

use crate::language::diagnostic::Code;
use crate::language::expression::fault::Fault;
use crate::language::expression::function::{FUNCTIONS, Function, find};
use crate::language::expression::token::{Placed, Token, tokens};
use crate::language::suggest::closest;

/// How deep brackets, calls and signs may be nested.
const DEEPEST: usize = 64;

/// How deep the tree may be: a chain of operators is as deep as it is long, and evaluation recurses.
const HIGHEST: usize = 256;

/// An expression and its place in the text.
#[derive(Clone, Debug)]
pub struct Expression {
    pub(crate) node: Node,
    pub(crate) range: Range<usize>,
    depth: usize,
}

impl Expression {
    pub(crate) fn new(node: Node, range: Range<usize>) -> Self {
        let inner = match &node {
            Node::Number(_) | Node::Boolean(_) | Node::Text(_) | Node::Name(_) => 0,
            Node::List(items) | Node::Call(_, items) => {
                items.iter().map(|item| item.depth).max().unwrap_or(0)
            }
            Node::Negate(inner) | Node::Not(inner) | Node::Part(inner, _) => inner.depth,
            Node::Binary(_, sides) => sides[0].depth.max(sides[1].depth),
        };
        Self { node, range, depth: inner + 1 }
    }
}

/// What an expression does.
#[derive(Clone, Debug)]
pub(crate) enum Node {
    Number(f64),
    Boolean(bool),
    Text(String),
    Name(String),
    List(Vec<Expression>),
    Negate(Box<Expression>),
    Not(Box<Expression>),
    Binary(Binary, Box<[Expression; 2]>),
    Part(Box<Expression>, usize),
    Call(&'static Function, Vec<Expression>),
}

/// Operators between two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Binary {
    Or,
    And,
    Equal,
    NotEqual,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Add,
    Subtract,
    Multiply,
    Divide,
    Modulo,
    Power,
}

impl Binary {
    /// How it is written.
    pub(crate) const fn text(self) -> &'static str {
        match self {
            Self::Or => "or",
            Self::And => "and",
            Self::Equal => "==",
            Self::NotEqual => "!=",
            Self::Less => "<",
            Self::LessOrEqual => "<=",
            Self::Greater => ">",
            Self::GreaterOrEqual => ">=",
            Self::Add => "+",
            Self::Subtract => "-",
            Self::Multiply => "*",
            Self::Divide => "/",
            Self::Modulo => "%",
            Self::Power => "^",
        }
    }

    /// How tightly it binds: more is tighter.
    const fn level(self) -> u8 {
        match self {
            Self::Or => 1,
            Self::And => 2,
            Self::Equal
            | Self::NotEqual
            | Self::Less
            | Self::LessOrEqual
            | Self::Greater
            | Self::GreaterOrEqual => 3,
            Self::Add | Self::Subtract => 4,
            Self::Multiply | Self::Divide | Self::Modulo => 5,
            Self::Power => 7,
        }
    }
}

/// Binds tighter than products, looser than powers: `-2 ^ 2` is -4.
const UNARY: u8 = 6;
const COMPARISON: u8 = 3;

/// Parses the text of an expression, without its `= `.
///
/// # Errors
/// The first thing that cannot be read, with its place and what to write.
pub fn parse(text: &str) -> Result<Expression, Fault> {
    let mut parser = Parser { text, tokens: tokens(text)?, at: 0, depth: 0 };
    let expression = parser.expression(0)?;
    match parser.peek() {
        Token::End => Ok(expression),
        _ => Err(parser.surplus()),
    }
}

struct Parser<'t> {
    text: &'t str,
    tokens: Vec<Placed>,
    at: usize,
    depth: usize,
}

impl Parser<'_> {
    fn peek(&self) -> &Token {
        &self.tokens[self.at].token
    }

    fn here(&self) -> Range<usize> {
        self.tokens[self.at].range.clone()
    }

    fn advance(&mut self) -> Placed {
        let placed = self.tokens[self.at].clone();
        // The last token is the end, which stays.
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        placed
    }

    fn take(&mut self, token: &Token) -> bool {
        let here = self.peek() == token;
        if here {
            self.advance();
        }
        here
    }

    fn expression(&mut self, level: u8) -> Result<Expression, Fault> {
        self.depth += 1;
        if self.depth > DEEPEST {
            let message = format!("this expression is nested more than {DEEPEST} deep");
            return Err(Fault::new(Code::ExpressionLimit, self.here(), message).label("too deep"));
        }
        let mut left = self.operand()?;
        while let Some(operator) = self.binary(level)? {
            left = self.join(left, operator)?;
        }
        self.depth -= 1;
        Ok(left)
    }

    fn join(&mut self, left: Expression, operator: Binary) -> Result<Expression, Fault> {
        // Powers group to the right, everything else to the left.
        let next = if operator == Binary::Power { UNARY } else { operator.level() + 1 };
        let right = self.expression(next)?;
        if operator.level() == COMPARISON && self.binary(COMPARISON)?.is_some() {
            let fault = Fault::new(
                Code::ExpressionSyntax,
                left.range.start..right.range.end,
                "comparisons do not chain",
            );
            return Err(fault.help("write `a < b and b < c`"));
        }
        let range = left.range.start..right.range.end;
        bounded(Expression::new(Node::Binary(operator, Box::new([left, right])), range))
    }

    /// Takes the operator that follows, if it binds at least as tightly as `level`.
    fn binary(&mut self, level: u8) -> Result<Option<Binary>, Fault> {
        let Some(operator) = operator(self.peek()).filter(|operator| operator.level() >= level) else {
            return Ok(None);
        };
        if operator.level() == Binary::Add.level() {
            self.check_spaces(operator)?;
        }
        self.advance();
        Ok(Some(operator))
    }

    /// `+` and `-` between operands need spaces on both sides, since `-` may be part of a name.
    fn check_spaces(&self, operator: Binary) -> Result<(), Fault> {
        let range = self.here();
        let space = |at: Option<char>| at.is_none_or(char::is_whitespace);
        let (before, after) = (&self.text[..range.start], &self.text[range.end..]);
        if space(before.chars().next_back()) && space(after.chars().next()) {
            return Ok(());
        }
        let sign = operator.text();
        let fault =
            Fault::new(Code::ExpressionSyntax, range, format!("`{sign}` needs a space on both sides"));
        Err(fault.label(format!("write `a {sign} b`")).replace(if space(before.chars().next_back()) {
            format!("{sign} ")
        } else if space(after.chars().next()) {
            format!(" {sign}")
        } else {
            format!(" {sign} ")
        }))
    }

    fn operand(&mut self) -> Result<Expression, Fault> {
        let start = self.here().start;
        let node = match self.peek() {
            Token::Minus => {
                self.advance();
                Node::Negate(Box::new(self.expression(UNARY)?))
            }
            Token::Name(name) if name == "not" => {
                self.advance();
                Node::Not(Box::new(self.expression(COMPARISON)?))
            }
            _ => return self.parts(),
        };
        Ok(Expression::new(node, start..self.tokens[self.at.saturating_sub(1)].range.end))
    }

    /// An atom and the parts that are taken of it: `p.x`.
    fn parts(&mut self) -> Result<Expression, Fault> {
        let mut whole = self.atom()?;
        while self.take(&Token::Dot) {
            let Placed { token, range } = self.advance();
            let index = match &token {
                Token::Name(name) => ["x", "y", "z"].iter().position(|axis| axis == name),
                _ => None,
            };
            let Some(index) = index else {
                let fault =
                    Fault::new(Code::ExpressionSyntax, range, "a point has the parts `.x`, `.y` and `.z`");
                return Err(fault.label("expected x, y or z"));
            };
            let place = whole.range.start..range.end;
            whole = bounded(Expression::new(Node::Part(Box::new(whole), index), place))?;
        }
        Ok(whole)
    }

    fn atom(&mut self) -> Result<Expression, Fault> {
        let Placed { token, range } = self.advance();
        let node = match token {
            Token::Number(number) => Node::Number(number),
            Token::Text(text) => Node::Text(text),
            Token::Name(name) => return self.name(&name, range),
            Token::Open => {
                let inner = self.expression(0)?;
                self.close(&Token::Close, "(", &range)?;
                return Ok(inner);
            }
            Token::OpenList => {
                let items = self.items(&Token::CloseList)?;
                self.close(&Token::CloseList, "[", &range)?;
                Node::List(items)
            }
            token => return Err(missing_operand(&token, range)),
        };
        let end = self.tokens[self.at - 1].range.end.max(range.end);
        Ok(Expression::new(node, range.start..end))
    }

    fn name(&mut self, name: &str, range: Range<usize>) -> Result<Expression, Fault> {
        let node = match name {
            "true" => Node::Boolean(true),
            "false" => Node::Boolean(false),
            "pi" => Node::Number(std::f64::consts::PI),
            "and" | "or" => return Err(missing_operand(&Token::Name(name.to_owned()), range)),
            _ if *self.peek() == Token::Open => return self.call(name, range),
            _ => Node::Name(name.to_owned()),
        };
        Ok(Expression::new(node, range))
    }

    fn call(&mut self, name: &str, range: Range<usize>) -> Result<Expression, Fault> {
        let Some(function) = find(name) else { return Err(unknown_function(name, range)) };
        let open = self.advance().range;
        let arguments = self.items(&Token::Close)?;
        self.close(&Token::Close, "(", &open)?;
        let range = range.start..self.tokens[self.at - 1].range.end;
        if arguments.len() < function.least || arguments.len() > function.most {
            let least = if function.most > function.least { "at least " } else { "" };
            let plural = if function.least == 1 { "" } else { "s" };
            let needs = format!("{least}{} argument{plural}", function.least);
            let message = format!("`{name}` takes {needs}, found {}", arguments.len());
            let fault = Fault::new(Code::ArgumentCount, range, message);
            return Err(fault.label(format!("expected {}", function.usage)));
        }
        Ok(Expression::new(Node::Call(function, arguments), range))
    }

    /// Expressions with commas between them, up to a closing bracket that is left.
    fn items(&mut self, close: &Token) -> Result<Vec<Expression>, Fault> {
        let mut items = Vec::new();
        while self.peek() != close {
            items.push(self.expression(0)?);
            if !self.take(&Token::Comma) {
                break;
            }
        }
        Ok(items)
    }

    fn close(&mut self, close: &Token, open: &str, range: &Range<usize>) -> Result<(), Fault> {
        if self.take(close) {
            return Ok(());
        }
        if *self.peek() != Token::End {
            return Err(self.surplus());
        }
        let fault = Fault::new(Code::ExpressionSyntax, range.clone(), format!("`{open}` is never closed"));
        Err(fault.label("no closing bracket"))
    }

    /// The error on a token that no expression can go on with.
    fn surplus(&self) -> Fault {
        let range = self.here();
        let written = &self.text[range.clone()];
        let fault =
            Fault::new(Code::ExpressionSyntax, range, format!("expected an operator, found `{written}`"));
        match self.peek() {
            Token::Close | Token::CloseList => fault.label("closes nothing"),
            Token::Comma => fault.label("only between arguments and in lists"),
            _ => fault.label("expected + - * / % ^ < > == and, or the end"),
        }
    }
}

fn bounded(expression: Expression) -> Result<Expression, Fault> {
    if expression.depth <= HIGHEST {
        return Ok(expression);
    }
    let message = format!("this expression has more than {HIGHEST} operations in a row");
    Err(Fault::new(Code::ExpressionLimit, expression.range, message).label("too long"))
}

fn operator(token: &Token) -> Option<Binary> {
    Some(match token {
        Token::Plus => Binary::Add,
        Token::Minus => Binary::Subtract,
        Token::Times => Binary::Multiply,
        Token::Over => Binary::Divide,
        Token::Modulo => Binary::Modulo,
        Token::Power => Binary::Power,
        Token::Less => Binary::Less,
        Token::LessOrEqual => Binary::LessOrEqual,
        Token::Greater => Binary::Greater,
        Token::GreaterOrEqual => Binary::GreaterOrEqual,
        Token::Equal => Binary::Equal,
        Token::NotEqual => Binary::NotEqual,
        Token::Name(name) if name == "and" => Binary::And,
        Token::Name(name) if name == "or" => Binary::Or,
        _ => return None,
    })
}

fn missing_operand(token: &Token, range: Range<usize>) -> Fault {
    let message =
        if *token == Token::End { "this expression ends too early" } else { "a value is missing here" };
    Fault::new(Code::ExpressionSyntax, range, message).label("expected a number, a name, a call, `(` or `[`")
}

fn unknown_function(name: &str, range: Range<usize>) -> Fault {
    let fault = Fault::new(Code::UnknownFunction, range, format!("there is no function `{name}`"));
    let names = FUNCTIONS.iter().map(|function| function.name);
    match closest(name, names.clone()) {
        Some(near) => fault.label(format!("did you mean `{near}`?")).replace(near),
        None => fault.help(format!("functions: {}", names.collect::<Vec<_>>().join(", "))),
    }
}
