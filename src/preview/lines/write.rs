//! Line drawings as files.
//!
//! Source: W3C, Scalable Vector Graphics 2, 2018; Adobe, PostScript Language Reference, 3rd ed. 1999, and Encapsulated
//! PostScript File Format Specification, version 3.0, 1992.

use std::fmt::Write as _;

use super::{Drawing, Kind, Trace};

/// How a drawing is inked.
#[derive(Clone, Copy, Debug)]
pub struct Ink {
    /// Pixels across and down.
    pub size: (u32, u32),
    /// Whether hidden lines are drawn, dashed.
    pub hidden: bool,
    /// The paper: sRGB; none is transparent.
    pub paper: Option<[u8; 3]>,
}

/// Width of a line in pixels, for pictures of 1000 pixels.
fn width(kind: Kind) -> f64 {
    match kind {
        Kind::Outline | Kind::Rim => 2.2,
        Kind::Crease | Kind::Intersection | Kind::Wire => 1.4,
        Kind::Border => 1.0,
    }
}

fn name(kind: Kind) -> &'static str {
    match kind {
        Kind::Outline => "outline",
        Kind::Rim => "rim",
        Kind::Crease => "crease",
        Kind::Intersection => "intersection",
        Kind::Border => "border",
        Kind::Wire => "wire",
    }
}

/// Dashes of hidden lines, in widths of the line.
const DASH: [f64; 2] = [4.0, 3.0];

/// Grey of hidden lines.
const GREY: f64 = 0.55;

/// Lines that look the same, one after the other.
fn groups<'a>(drawing: &'a Drawing, ink: &Ink) -> Vec<(Kind, bool, Vec<&'a Trace>)> {
    let mut groups: Vec<(Kind, bool, Vec<&Trace>)> = Vec::new();
    for trace in drawing.traces.iter().filter(|trace| ink.hidden || trace.hidden == 0) {
        let hidden = trace.hidden > 0;
        match groups.iter_mut().find(|(kind, other, _)| *kind == trace.kind && *other == hidden) {
            Some((.., own)) => own.push(trace),
            None => groups.push((trace.kind, hidden, vec![trace])),
        }
    }
    // Hidden lines lie under all others.
    groups.sort_by_key(|(kind, hidden, _)| (!hidden, std::cmp::Reverse(*kind)));
    groups
}

/// A number with two decimals and no needless zeros.
fn short(number: f64) -> String {
    let text = format!("{number:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn scale(ink: &Ink) -> f64 {
    f64::from(ink.size.0.min(ink.size.1)) / 1000.0
}

/// As an SVG file.
#[must_use]
pub fn svg(drawing: &Drawing, ink: &Ink) -> String {
    let (across, down) = ink.size;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{across}\" height=\"{down}\" viewBox=\"0 0 {across} {down}\">\n"
    );
    if let Some([r, g, b]) = ink.paper {
        let _ = writeln!(text, "<rect width=\"100%\" height=\"100%\" fill=\"#{r:02x}{g:02x}{b:02x}\"/>");
    }
    text.push_str("<g fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n");
    for (kind, hidden, traces) in groups(drawing, ink) {
        let share = if hidden { 0.6 } else { 1.0 };
        let width = width(kind) * share * scale(ink);
        let color = if hidden { "#8c8c8c" } else { "#101014" };
        let class = if hidden { format!("{} hidden", name(kind)) } else { name(kind).to_owned() };
        let dash = if hidden {
            format!(" stroke-dasharray=\"{} {}\"", short(DASH[0] * width), short(DASH[1] * width))
        } else {
            String::new()
        };
        let _ = writeln!(
            text,
            "<g class=\"{class}\" stroke=\"{color}\" stroke-width=\"{}\"{dash}>",
            short(width)
        );
        for trace in traces {
            text.push_str("<path d=\"");
            for (k, place) in trace.places.iter().enumerate() {
                let letter = match k {
                    0 => "M",
                    1 => "L",
                    _ => " ",
                };
                let _ = write!(text, "{letter}{} {}", short(place.x), short(place.y));
            }
            text.push_str(if trace.closed { "Z\"/>\n" } else { "\"/>\n" });
        }
        text.push_str("</g>\n");
    }
    text.push_str("</g>\n</svg>\n");
    text
}

/// As an encapsulated PostScript file; a pixel is a point.
#[must_use]
pub fn postscript(drawing: &Drawing, ink: &Ink) -> String {
    let (across, down) = ink.size;
    let mut text = format!(
        "%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 {across} {down}\n%%Pages: 1\n%%EndComments\n%%Page: 1 1\n\
         gsave\n1 setlinecap 1 setlinejoin\n/m {{ moveto }} bind def /l {{ lineto }} bind def\n"
    );
    if let Some(paper) = ink.paper {
        let [r, g, b] = paper.map(|part| short(f64::from(part) / 255.0));
        let _ = writeln!(text, "{r} {g} {b} setrgbcolor 0 0 {across} {down} rectfill");
    }
    for (kind, hidden, traces) in groups(drawing, ink) {
        let share = if hidden { 0.6 } else { 1.0 };
        let width = width(kind) * share * scale(ink);
        let (grey, dash) = if hidden {
            (GREY, format!("{} {}", short(DASH[0] * width), short(DASH[1] * width)))
        } else {
            (0.06, String::new())
        };
        let _ = writeln!(text, "% {}", name(kind));
        let _ = writeln!(text, "{} setgray {} setlinewidth [{dash}] 0 setdash", short(grey), short(width));
        for trace in traces {
            for (k, place) in trace.places.iter().enumerate() {
                let letter = if k == 0 { "m" } else { "l" };
                let _ = writeln!(text, "{} {} {letter}", short(place.x), short(f64::from(down) - place.y));
            }
            text.push_str(if trace.closed { "closepath stroke\n" } else { "stroke\n" });
        }
    }
    text.push_str("grestore\nshowpage\n%%EOF\n");
    text
}
