//! SVG paths: the text of a `d` attribute, read to the end of its grammar.
//!
//! Source: W3C, Scalable Vector Graphics (SVG) 2, 2018, ch. 9.3 and, for what arcs mean, appendix B.2 (F.6 of
//! SVG 1.1).

use glam::DVec2;
use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::scalar::GREATEST;
use crate::language::spec::schema::Schemas;
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

table! {
    /// The path of an SVG drawing: what stands in the attribute `d`. Each subpath, which begins with M, is a part
    /// of the curve; one that ends with Z is closed. SVG counts y downward and Kiln upward, so the drawing is turned
    /// over: it looks as in a browser.
    "svg" pub Svg {
        /// The path data: `"M 0 0 L 10 0 ..."`. All commands are known, and all short forms.
        d: Sp<SvgPath>;
        /// One unit of the drawing, in the document's unit.
        scale: Sp<f64> = 1.0 => Check::above(0.0);
        /// The place of the drawing, in its own coordinates, that comes to lie at `[0, 0]`.
        origin: Sp<DVec2> = DVec2::ZERO;
        /// Whether y goes upward in the data already; then nothing is turned over.
        y_up: Sp<bool> = false;
    }
}

/// The subpaths of an SVG path, in absolute coordinates of the drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct SvgPath {
    /// Subpaths that draw something.
    pub subpaths: Vec<Subpath>,
}

/// One stroke of the pen.
#[derive(Clone, Debug, PartialEq)]
pub struct Subpath {
    /// Where it starts.
    pub start: DVec2,
    /// What it draws; never empty.
    pub segments: Vec<SvgSegment>,
    /// Whether it ends with Z.
    pub closed: bool,
}

/// A segment from the current point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SvgSegment {
    /// A straight line.
    Line(DVec2),
    /// A quadratic Bezier curve: control point, end.
    Quadratic([DVec2; 2]),
    /// A cubic Bezier curve: two control points, end.
    Cubic([DVec2; 3]),
    /// A part of an ellipse.
    Arc(SvgArc),
}

/// A part of an ellipse between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SvgArc {
    /// Half axes, more than zero; those of an ellipse that is too small are stretched.
    pub radii: DVec2,
    /// Degrees from the x axis of the drawing to that of the ellipse.
    pub rotation: f64,
    /// Whether it is the longer way around.
    pub large: bool,
    /// Whether angles grow along it.
    pub sweep: bool,
    /// Where it ends.
    pub end: DVec2,
}

impl SvgSegment {
    /// Where it ends.
    #[must_use]
    pub fn end(&self) -> DVec2 {
        match self {
            Self::Line(end) | Self::Quadratic([_, end]) | Self::Cubic([_, _, end]) => *end,
            Self::Arc(arc) => arc.end,
        }
    }
}

impl Read for SvgPath {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let Data::String(text) = &value.data else {
            reader.mismatch(value, "the data of an SVG path");
            return None;
        };
        match parse(text) {
            Ok(subpaths) if subpaths.is_empty() => {
                let report = Diagnostic::error(Code::SvgSyntax, "this SVG path draws nothing")
                    .at(value.span, "no line in it")
                    .help("copy what stands in the attribute `d` of a <path> element");
                reader.report(report);
                None
            }
            Ok(subpaths) => Some(Self { subpaths }),
            Err(fault) => {
                reader.report(fault.diagnostic(text, value.span, reader));
                None
            }
        }
    }

    fn schema(_: &mut Schemas) -> Json {
        json!({ "type": "string" })
    }
}

/// What is wrong with the data, at a byte of it.
#[derive(Clone, Debug, PartialEq)]
struct Fault {
    at: usize,
    length: usize,
    message: String,
    help: Option<&'static str>,
}

impl Fault {
    fn diagnostic(self, text: &str, span: Span, reader: &Reader<'_>) -> Diagnostic {
        let place = reader.sources.snippet(span).find(text).map(|offset| {
            let byte = |at: usize| u32::try_from(offset + at).unwrap_or(0);
            Span::new(span.start + byte(self.at), span.start + byte(self.at + self.length))
        });
        // Escapes in the string may hide the place; the number of the character tells it all the same.
        let character = text[..self.at].chars().count() + 1;
        let message = format!("SVG path: {}, at character {character}", self.message);
        let report = Diagnostic::error(Code::SvgSyntax, message).at(place.unwrap_or(span), "here");
        match self.help {
            Some(help) => report.help(help),
            None => report,
        }
    }
}

/// Reads path data.
fn parse(text: &str) -> Result<Vec<Subpath>, Fault> {
    let mut pen = Pen {
        scanner: Scanner { text, at: 0 },
        current: DVec2::ZERO,
        start: DVec2::ZERO,
        control: None,
        open: None,
        done: Vec::new(),
    };
    pen.draw()?;
    pen.lift(false);
    Ok(pen.done)
}

struct Scanner<'t> {
    text: &'t str,
    at: usize,
}

impl Scanner<'_> {
    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn space(&mut self) {
        let spaces = [' ', '\t', '\n', '\r', '\u{c}'];
        self.at = self.text.len() - self.rest().trim_start_matches(spaces).len();
    }

    /// White space and at most one comma.
    fn separator(&mut self) {
        self.space();
        if self.peek() == Some(',') {
            self.at += 1;
            self.space();
        }
    }

    fn fault(&self, at: usize, message: String) -> Fault {
        let length = self.text[at..].chars().next().map_or(0, char::len_utf8);
        Fault { at, length, message, help: None }
    }

    /// What stands here, for a message.
    fn found(&self) -> String {
        self.peek().map_or("the end".to_owned(), |character| format!("`{}`", character.escape_debug()))
    }

    /// Whether another set of numbers follows without a new command.
    fn continues(&mut self) -> bool {
        let here = self.at;
        self.separator();
        let number =
            self.peek().is_some_and(|character| character.is_ascii_digit() || "+-.".contains(character));
        if !number && self.text[here..self.at].contains(',') {
            // The comma belongs to nothing; it is told where the next command is asked for.
            self.at = here;
            self.space();
        }
        number
    }

    fn number(&mut self, what: &str, command: char) -> Result<f64, Fault> {
        let start = self.at;
        let bytes = self.text.as_bytes();
        let mut at = start;
        let digits = |at: &mut usize| {
            let first = *at;
            while bytes.get(*at).is_some_and(u8::is_ascii_digit) {
                *at += 1;
            }
            *at > first
        };
        if matches!(bytes.get(at), Some(b'+' | b'-')) {
            at += 1;
        }
        let whole = digits(&mut at);
        let mut fraction = false;
        if bytes.get(at) == Some(&b'.') {
            at += 1;
            fraction = digits(&mut at);
        }
        if !whole && !fraction {
            let found = self.found();
            return Err(self.fault(start, format!("expected {what} of `{command}`, found {found}")));
        }
        if matches!(bytes.get(at), Some(b'e' | b'E')) {
            let mut end = at + 1;
            if matches!(bytes.get(end), Some(b'+' | b'-')) {
                end += 1;
            }
            if digits(&mut end) {
                at = end;
            }
        }
        self.at = at;
        let written = &self.text[start..at];
        match written.parse::<f64>() {
            Ok(number) if number.abs() <= GREATEST => Ok(number),
            _ => Err(Fault {
                at: start,
                length: at - start,
                message: format!("the number {written} is too large"),
                help: None,
            }),
        }
    }

    /// A flag of an arc is one character; nothing needs to stand between it and what follows.
    fn flag(&mut self, what: &str, command: char) -> Result<bool, Fault> {
        let set = match self.peek() {
            Some('0') => false,
            Some('1') => true,
            _ => {
                let found = self.found();
                let message = format!("expected the {what} flag of `{command}`, 0 or 1, found {found}");
                return Err(Fault {
                    help: Some("an arc is: rx ry rotation large-flag sweep-flag x y"),
                    ..self.fault(self.at, message)
                });
            }
        };
        self.at += 1;
        Ok(set)
    }
}

/// The control point that S and T mirror.
#[derive(Clone, Copy)]
enum Control {
    Cubic(DVec2),
    Quadratic(DVec2),
}

struct Pen<'t> {
    scanner: Scanner<'t>,
    current: DVec2,
    /// Where the subpath started.
    start: DVec2,
    control: Option<Control>,
    /// The subpath in hand.
    open: Option<Subpath>,
    done: Vec<Subpath>,
}

impl Pen<'_> {
    fn draw(&mut self) -> Result<(), Fault> {
        let mut first = true;
        loop {
            self.scanner.space();
            let at = self.scanner.at;
            let Some(command) = self.scanner.peek() else { return Ok(()) };
            if !"MmLlHhVvCcSsQqTtAaZz".contains(command) {
                let message = format!("expected a command, found {}", self.scanner.found());
                let help = "commands are M L H V C S Q T A Z, in lower case for relative coordinates";
                return Err(Fault { help: Some(help), ..self.scanner.fault(at, message) });
            }
            if first && !command.eq_ignore_ascii_case(&'M') {
                let message = format!("a path begins with `M`, found `{command}`");
                return Err(self.scanner.fault(at, message));
            }
            first = false;
            self.scanner.at += 1;
            self.command(command)?;
        }
    }

    fn command(&mut self, command: char) -> Result<(), Fault> {
        if command.eq_ignore_ascii_case(&'Z') {
            self.lift(true);
            self.current = self.start;
            self.control = None;
            return Ok(());
        }
        let mut command = command;
        self.scanner.space();
        loop {
            self.step(command)?;
            // Pairs after those of a moveto are linetos.
            command = match command {
                'M' => 'L',
                'm' => 'l',
                other => other,
            };
            if !self.scanner.continues() {
                return Ok(());
            }
        }
    }

    fn step(&mut self, command: char) -> Result<(), Fault> {
        let from = if command.is_ascii_lowercase() { self.current } else { DVec2::ZERO };
        match command.to_ascii_uppercase() {
            'M' => {
                let place = from + self.pair("a coordinate", command)?;
                self.lift(false);
                (self.current, self.start, self.control) = (place, place, None);
            }
            'H' => {
                let x = from.x + self.scanner.number("a coordinate", command)?;
                self.add(SvgSegment::Line(DVec2::new(x, self.current.y)), None);
            }
            'V' => {
                let y = from.y + self.scanner.number("a coordinate", command)?;
                self.add(SvgSegment::Line(DVec2::new(self.current.x, y)), None);
            }
            'C' => {
                let one = from + self.pair("a coordinate", command)?;
                let two = from + self.next_pair(command)?;
                let end = from + self.next_pair(command)?;
                self.add(SvgSegment::Cubic([one, two, end]), Some(Control::Cubic(two)));
            }
            'S' => {
                let two = from + self.pair("a coordinate", command)?;
                let end = from + self.next_pair(command)?;
                let one = match self.control {
                    Some(Control::Cubic(before)) => self.current * 2.0 - before,
                    _ => self.current,
                };
                self.add(SvgSegment::Cubic([one, two, end]), Some(Control::Cubic(two)));
            }
            'Q' => {
                let control = from + self.pair("a coordinate", command)?;
                let end = from + self.next_pair(command)?;
                self.add(SvgSegment::Quadratic([control, end]), Some(Control::Quadratic(control)));
            }
            'T' => {
                let end = from + self.pair("a coordinate", command)?;
                let control = match self.control {
                    Some(Control::Quadratic(before)) => self.current * 2.0 - before,
                    _ => self.current,
                };
                self.add(SvgSegment::Quadratic([control, end]), Some(Control::Quadratic(control)));
            }
            'A' => {
                let arc = self.arc(from, command)?;
                self.add(arc, None);
            }
            _ => {
                let end = from + self.pair("a coordinate", command)?;
                self.add(SvgSegment::Line(end), None);
            }
        }
        Ok(())
    }

    fn pair(&mut self, what: &str, command: char) -> Result<DVec2, Fault> {
        let x = self.scanner.number(what, command)?;
        self.scanner.separator();
        Ok(DVec2::new(x, self.scanner.number(what, command)?))
    }

    fn next_pair(&mut self, command: char) -> Result<DVec2, Fault> {
        self.scanner.separator();
        self.pair("a coordinate", command)
    }

    fn arc(&mut self, from: DVec2, command: char) -> Result<SvgSegment, Fault> {
        // A negative radius counts without its sign; an arc without a radius is a line.
        let radii = self.pair("a radius", command)?.abs();
        self.scanner.separator();
        let rotation = self.scanner.number("the rotation", command)?;
        self.scanner.separator();
        let large = self.scanner.flag("large", command)?;
        self.scanner.separator();
        let sweep = self.scanner.flag("sweep", command)?;
        let end = from + self.next_pair(command)?;
        if radii.min_element() == 0.0 {
            return Ok(SvgSegment::Line(end));
        }
        Ok(SvgSegment::Arc(SvgArc { radii, rotation, large, sweep, end }))
    }

    fn add(&mut self, segment: SvgSegment, control: Option<Control>) {
        let (current, start) = (self.current, self.start);
        self.current = segment.end();
        self.control = control;
        // What does not move draws nothing; an arc that returns is left out too, as the standard says.
        let moves = match segment {
            SvgSegment::Line(end) => end != current,
            SvgSegment::Arc(arc) => arc.end != current,
            SvgSegment::Quadratic(points) => points.iter().any(|point| *point != current),
            SvgSegment::Cubic(points) => points.iter().any(|point| *point != current),
        };
        if moves {
            let subpath =
                self.open.get_or_insert_with(|| Subpath { start, segments: Vec::new(), closed: false });
            subpath.segments.push(segment);
        }
    }

    /// Ends the subpath in hand.
    fn lift(&mut self, closed: bool) {
        if let Some(subpath) = self.open.take() {
            self.done.push(Subpath { closed, ..subpath });
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::{SvgSegment, parse};

    fn ends(text: &str) -> Vec<Vec<(f64, f64)>> {
        let subpaths = parse(text).unwrap_or_else(|fault| panic!("{text}: {fault:?}"));
        let all = |subpath: super::Subpath| {
            let mut ends = vec![(subpath.start.x, subpath.start.y)];
            ends.extend(subpath.segments.iter().map(|segment| (segment.end().x, segment.end().y)));
            ends
        };
        subpaths.into_iter().map(all).collect()
    }

    #[test]
    fn short_forms_mean_what_long_ones_do() {
        let long = ends("M 10 20 L 30 -5 L 30.5 0.5 L 0.5 0.5");
        for short in [
            "M10,20 30-5 30.5.5.5.5",
            "M10 20L30-5l.5,5.5-30,0",
            "m10 20 20-25 .5 5.5-30 0",
            "\tM1e1\n20 3e+1-5H30.5V.5H.5",
        ] {
            let found = ends(short);
            let same = found.len() == 1 || short.contains('H');
            assert!(same, "{short}: {found:?}");
            assert_eq!(found[0][0], long[0][0]);
            assert_eq!(found[0].last(), long[0].last(), "{short}");
        }
    }

    #[test]
    fn closing_returns_to_the_start_and_a_new_stroke_may_begin_there() {
        let found = parse("M1 1h2v2zl5 0m1 1 2 2Z").unwrap();
        assert_eq!(found.len(), 3);
        assert!(found[0].closed && !found[1].closed && found[2].closed);
        assert_eq!((found[1].start, found[1].segments[0].end()), (DVec2::ONE, DVec2::new(6.0, 1.0)));
        assert_eq!(found[2].start, DVec2::new(7.0, 2.0));
    }

    #[test]
    fn smooth_curves_mirror_the_control_point_of_their_own_kind_alone() {
        let cubic = parse("M0 0C1 1 2 1 3 0s2 1 3 0").unwrap();
        assert_eq!(
            cubic[0].segments[1],
            SvgSegment::Cubic([(4.0, -1.0), (5.0, 1.0), (6.0, 0.0)].map(DVec2::from))
        );
        let after_line = parse("M0 0L3 0S5 1 6 0").unwrap();
        assert_eq!(
            after_line[0].segments[1],
            SvgSegment::Cubic([(3.0, 0.0), (5.0, 1.0), (6.0, 0.0)].map(DVec2::from))
        );
        let quadratic = parse("M0 0Q1 2 2 0T4 0 6 0").unwrap();
        assert_eq!(
            quadratic[0].segments[2],
            SvgSegment::Quadratic([(5.0, 2.0), (6.0, 0.0)].map(DVec2::from))
        );
        let after_cubic = parse("M0 0C1 1 2 1 3 0T4 0").unwrap();
        assert_eq!(
            after_cubic[0].segments[1],
            SvgSegment::Quadratic([(3.0, 0.0), (4.0, 0.0)].map(DVec2::from))
        );
    }

    #[test]
    fn flags_need_no_space() {
        let SvgSegment::Arc(arc) = parse("M0 0a25-30 45 1020,30").unwrap()[0].segments[0] else { panic!() };
        assert_eq!(
            (arc.radii, arc.rotation, arc.large, arc.sweep),
            (DVec2::new(25.0, 30.0), 45.0, true, false)
        );
        assert_eq!(arc.end, DVec2::new(20.0, 30.0));
        assert_eq!(
            parse("M0 0A0 5 0 0 1 2 2").unwrap()[0].segments[0],
            SvgSegment::Line(DVec2::new(2.0, 2.0))
        );
        assert!(parse("M0 0A2 5 0 0 1 0 0").unwrap().is_empty());
    }

    #[test]
    fn faults_stand_where_they_are() {
        let cases = [
            ("L 1 1", 0, "begins with `M`"),
            ("M 1", 3, "a coordinate of `M`, found the end"),
            ("M 1 1 L 2", 9, "a coordinate of `L`"),
            ("M 1 1 X 2", 6, "expected a command, found `X`"),
            ("M 1 1,,2 2", 5, "expected a command"),
            ("M 1 1 L 2 2,", 11, "expected a command, found `,`"),
            ("M 0 0 A 1 1 0 2 0 3 3", 14, "the large flag"),
            ("M 0 0 A 1 1 0 1 3 3", 16, "the sweep flag"),
            ("M 0 0 L 1e400 0", 8, "too large"),
            ("M 0 0 L é 0", 8, "found `é`"),
            ("M 0 0 Z 5 5", 8, "expected a command, found `5`"),
            ("M 0 0 L 1 -", 10, "a coordinate"),
            ("M 0 0 L . 1", 8, "a coordinate"),
        ];
        for (text, at, message) in cases {
            let fault = parse(text).expect_err(text);
            assert_eq!(fault.at, at, "{text}: {fault:?}");
            assert!(fault.message.contains(message), "{text}: {fault:?}");
        }
    }
}
