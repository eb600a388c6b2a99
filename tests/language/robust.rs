//! No input makes the language panic, hang or overflow the stack, and what it says can always be shown.

use kiln::language::Document;
use kiln::language::source::MemoryFiles;

/// Reads bytes as a document in every way; how many diagnostics it gave.
fn digest(bytes: &[u8]) -> usize {
    let files = MemoryFiles::new().with("a.toml", bytes).with("b.toml", "[material.clay]\n");
    let found = match Document::load("a.toml", &files) {
        Err(found) => found,
        Ok(document) => {
            for variant in document.variants() {
                if let Err(found) = document.spec(Some(&variant), &[]) {
                    assert!(!found.render(true).is_empty());
                }
            }
            match document.spec(None, &[("height".to_owned(), "= 1 +".to_owned())]) {
                Ok((_, warnings)) => document.diagnostics(warnings),
                Err(found) => found,
            }
        }
    };
    let text = found.render(false);
    assert!(!text.chars().any(|c| c.is_control() && c != '\n'), "{text:?}");
    found.to_json().as_array().map_or(0, Vec::len)
}

/// Numbers that are the same in every run (xorshift, G. Marsaglia, 2003).
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        usize::try_from(self.0 % sides as u64).unwrap_or(0)
    }
}

#[test]
fn documents_with_random_damage_are_refused_or_read() {
    let texts = [
        include_str!("cases/whole.case"),
        include_str!("cases/expressions.case"),
        include_str!("cases/text.case"),
    ];
    let seeds: Vec<&str> = texts.iter().flat_map(|text| text.split("=== ")).collect();
    let pieces: [&[u8]; 16] = [
        b"[",
        b"]",
        b"{",
        b"}",
        b"\"",
        b"= ",
        b"'''",
        b"-",
        b"1e400",
        b"\xff",
        b"\xc3\xa9",
        b"\n",
        b"each = \"= i\"",
        b"nan",
        b"= [[[[1]]]]",
        b".",
    ];
    let mut dice = Dice(0x9e37_79b9_7f4a_7c15);
    for _ in 0..4000 {
        let mut bytes = seeds[dice.roll(seeds.len())].as_bytes().to_vec();
        for _ in 0..=dice.roll(6) {
            let at = dice.roll(bytes.len() + 1);
            match dice.roll(4) {
                0 => drop(bytes.drain(at..(at + dice.roll(20)).min(bytes.len()))),
                1 => drop(bytes.splice(at..at, pieces[dice.roll(pieces.len())].iter().copied())),
                2 if at < bytes.len() => bytes[at] = u8::try_from(dice.roll(256)).unwrap_or(0),
                _ => bytes.truncate(at.max(bytes.len() / 2)),
            }
        }
        digest(&bytes);
    }
}

#[test]
fn every_start_of_a_document_is_refused_or_read() {
    let text = include_str!("cases/whole.case").split("=== ").nth(2).unwrap();
    for end in (0..text.len()).step_by(3) {
        digest(&text.as_bytes()[..end]);
    }
}

#[test]
fn deep_and_long_documents_do_not_overflow_the_stack() {
    let nested =
        |open: &str, close: &str, times: usize| format!("{}1{}", open.repeat(times), close.repeat(times));
    let group = format!("[shape.a]\n{}\"b\"{}", "group = { of = [{ ".repeat(20), " }] }".repeat(20));
    for text in [
        format!("a = {}", nested("[", "]", 100_000)),
        format!("a = {}", nested("{a=", "}", 100_000)),
        format!("a{} = 1", ".a".repeat(100_000)),
        format!("[a{}]", ".a".repeat(100_000)),
        format!("[parameters]\na = \"= {}\"", nested("(", ")", 4000)),
        format!("[parameters]\na = \"= {}1\"", "-".repeat(4000)),
        format!("[parameters]\na = \"= {}1\"", "1 + ".repeat(2000)),
        format!("[parameters]\na = \"= {}1\"", "2 ^ ".repeat(2000)),
        format!("[parameters]\na = [1]\nb = \"= a{}\"", ".x".repeat(4000)),
        format!(
            "[parameters]\n{}",
            (0..5000).map(|n| format!("a{n} = \"= a{}\"\n", n + 1)).collect::<String>()
        ),
        (0..5000).map(|n| format!("[curve.c{n}.reverse]\nof = \"c{}\"\n", (n + 1) % 5000)).collect(),
        group,
        format!("include = [{}]", "\"a.toml\", ".repeat(10_000)),
        "x".repeat(1_000_000),
    ] {
        assert!(digest(text.as_bytes()) > 0, "{}", &text[..60.min(text.len())]);
    }
}

#[test]
fn inline_definitions_nest_up_to_the_depth_of_brackets() {
    let mut curve = "{ circle = { radius = 1 } }".to_owned();
    for _ in 0..30 {
        curve = format!("{{ reverse = {{ of = {curve} }} }}");
    }
    assert_eq!(
        digest(format!("[curve.a.reverse]\nof = {curve}\n").as_bytes()),
        1,
        "only the override is wrong"
    );
    for _ in 0..2 {
        curve = format!("{{ reverse = {{ of = {curve} }} }}");
    }
    assert_eq!(digest(format!("[curve.a.reverse]\nof = {curve}\n").as_bytes()), 1);
}
