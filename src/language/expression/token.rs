//! Text to tokens.

use std::ops::Range;

use crate::language::diagnostic::Code;
use crate::language::expression::fault::Fault;

/// What a token is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Token {
    Number(f64),
    Text(String),
    Name(String),
    Plus,
    Minus,
    Times,
    Over,
    Modulo,
    Power,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    NotEqual,
    Open,
    Close,
    OpenList,
    CloseList,
    Comma,
    Dot,
    End,
}

/// A token and its place in the expression's text.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub(crate) token: Token,
    pub(crate) range: Range<usize>,
}

/// The longest expression, in bytes.
const LONGEST: usize = 10_000;

/// All tokens of a text; the last is [`Token::End`].
pub(crate) fn tokens(text: &str) -> Result<Vec<Placed>, Fault> {
    if text.len() > LONGEST {
        let message = format!("an expression has at most {LONGEST} bytes, found {}", text.len());
        return Err(Fault::new(Code::ExpressionLimit, 0..text.len(), message));
    }
    let mut lexer = Lexer { text, at: 0 };
    let mut list = Vec::new();
    loop {
        lexer.space();
        let start = lexer.at;
        let token = lexer.next()?;
        let end = token == Token::End;
        list.push(Placed { token, range: start..lexer.at });
        if end {
            return Ok(list);
        }
    }
}

struct Lexer<'t> {
    text: &'t str,
    at: usize,
}

impl Lexer<'_> {
    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn space(&mut self) {
        self.at = self.text.len() - self.rest().trim_start_matches([' ', '\t', '\n', '\r']).len();
    }

    fn next(&mut self) -> Result<Token, Fault> {
        let Some(first) = self.rest().chars().next() else { return Ok(Token::End) };
        match first {
            'a'..='z' => self.name(),
            '0'..='9' => self.number(),
            '\'' | '"' => self.string(first),
            _ => self.operator(first),
        }
    }

    fn name(&mut self) -> Result<Token, Fault> {
        let length = self.rest().bytes().take_while(|byte| is_name(*byte)).count();
        let name = self.rest()[..length].to_owned();
        let range = self.at..self.at + length;
        self.at += length;
        match name.strip_suffix('-') {
            None => Ok(Token::Name(name)),
            Some(word) => {
                let fault =
                    Fault::new(Code::ExpressionSyntax, range, format!("the name `{name}` ends with `-`"));
                Err(fault.label("a minus needs a space on both sides").replace(format!("{word} -")))
            }
        }
    }

    fn number(&mut self) -> Result<Token, Fault> {
        let start = self.at;
        self.digits();
        if self.rest().starts_with('.') && self.rest()[1..].starts_with(|c: char| c.is_ascii_digit()) {
            self.at += 1;
            self.digits();
        }
        self.exponent();
        let written = &self.text[start..self.at];
        if self.rest().starts_with(|c: char| c.is_alphabetic() || c == '_') {
            let help = "write `2 * x` for a product";
            let fault =
                Fault::new(Code::ExpressionSyntax, start..self.at + 1, "a letter right after a number");
            return Err(fault.label("not a number").help(help));
        }
        match written.replace('_', "").parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(Token::Number(number)),
            _ => Err(Fault::new(Code::ExpressionValue, start..self.at, format!("{written} is too large"))),
        }
    }

    fn digits(&mut self) {
        self.at += self.rest().bytes().take_while(|byte| byte.is_ascii_digit() || *byte == b'_').count();
    }

    /// Takes `e-3`, but not the letter that begins something else.
    fn exponent(&mut self) {
        let Some(rest) = self.rest().strip_prefix(['e', 'E']) else { return };
        let sign = usize::from(rest.starts_with(['+', '-']));
        if rest[sign..].starts_with(|c: char| c.is_ascii_digit()) {
            self.at += 1 + sign;
            self.digits();
        }
    }

    fn string(&mut self, quote: char) -> Result<Token, Fault> {
        let start = self.at;
        match self.rest()[1..].find(quote) {
            Some(length) => {
                let text = self.rest()[1..=length].to_owned();
                self.at += length + 2;
                Ok(Token::Text(text))
            }
            None => {
                let range = start..self.text.len();
                Err(Fault::new(Code::ExpressionSyntax, range, "this string does not end")
                    .label("no closing quote"))
            }
        }
    }

    fn operator(&mut self, first: char) -> Result<Token, Fault> {
        for (written, token) in DOUBLE {
            if self.rest().starts_with(written) {
                self.at += 2;
                return Ok(token.clone());
            }
        }
        if let Some((_, token)) = SINGLE.iter().find(|(written, _)| *written == first) {
            self.at += 1;
            return Ok(token.clone());
        }
        Err(self.unknown(first))
    }

    fn unknown(&self, first: char) -> Fault {
        let range = self.at..self.at + first.len_utf8();
        let shown = first.escape_debug();
        let fault =
            Fault::new(Code::ExpressionSyntax, range, format!("`{shown}` means nothing in an expression"));
        match first {
            '=' => fault.help("write `==` to compare"),
            '&' => fault.help("write `and`"),
            '|' => fault.help("write `or`"),
            '!' => fault.help("write `not`, or `!=` for unequal"),
            '−' | '–' => fault.help("write `-`, with a space on both sides"),
            '×' | '·' => fault.help("write `*`"),
            'A'..='Z' | '_' => fault.help("names are in kebab-case: lower case, with `-` between words"),
            _ => fault,
        }
    }
}

const DOUBLE: &[(&str, Token)] = &[
    ("<=", Token::LessOrEqual),
    (">=", Token::GreaterOrEqual),
    ("==", Token::Equal),
    ("!=", Token::NotEqual),
];

const SINGLE: &[(char, Token)] = &[
    ('+', Token::Plus),
    ('-', Token::Minus),
    ('*', Token::Times),
    ('/', Token::Over),
    ('%', Token::Modulo),
    ('^', Token::Power),
    ('<', Token::Less),
    ('>', Token::Greater),
    ('(', Token::Open),
    (')', Token::Close),
    ('[', Token::OpenList),
    (']', Token::CloseList),
    (',', Token::Comma),
    ('.', Token::Dot),
];

fn is_name(byte: u8) -> bool {
    byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'-'
}
