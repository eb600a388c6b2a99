//! Formatting: documents mean what they meant, comments stay, and twice is once.

use std::path::{Path, PathBuf};

use kiln::language::format;

/// What a text means.
fn meaning(text: &str) -> String {
    let table: toml::Table = toml::from_str(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    format!("{table:?}")
}

/// The comments of a text, in order; only for texts without `#` in strings that stand alone.
fn comments(text: &str) -> Vec<&str> {
    text.lines().filter_map(|line| line.split_once("# ")).map(|(_, comment)| comment.trim_end()).collect()
}

fn gallery() -> Vec<PathBuf> {
    let mut all = Vec::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("specs")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "toml") {
                all.push(path);
            }
        }
    }
    all.sort();
    assert!(all.len() > 50);
    all
}

#[test]
fn the_gallery_is_formatted() {
    for path in gallery() {
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(format(&text) == text, "{} is not formatted: kiln fmt {0}", path.display());
    }
}

/// The gallery, its spaces set at random: the same meaning, the same comments, and twice is once.
#[test]
fn what_was_set_at_random_means_the_same() {
    let mut seed = 1_u64;
    let mut random = |below: u64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) % below
    };
    for path in gallery() {
        let text = std::fs::read_to_string(&path).unwrap();
        let mut other = String::new();
        let (mut quoted, mut noted) = (false, false);
        for sign in text.chars() {
            quoted ^= sign == '"' && !noted;
            noted = (noted || sign == '#' && !quoted) && sign != '\n';
            if quoted || noted || sign == '"' {
                other.push(sign);
                continue;
            }
            let mut spaces = |other: &mut String| other.extend((0..random(3)).map(|_| ' '));
            match sign {
                ' ' | ',' | '=' | '{' | '}' => {
                    spaces(&mut other);
                    other.push(sign);
                    spaces(&mut other);
                }
                '\n' => other.extend((0..=random(3)).map(|_| '\n')),
                sign => other.push(sign),
            }
        }
        let after = format(&other);
        assert_eq!(meaning(&after), meaning(&text), "{}", path.display());
        assert_eq!(comments(&after), comments(&text), "{}", path.display());
        assert_eq!(format(&after), after, "{}", path.display());
        // Where only spaces were set otherwise, comments may stand in other columns; all else is as it was.
        let bare = |text: &str| -> Vec<String> {
            let code = |line: &str| line.split('#').next().unwrap_or_default().trim_end().to_owned();
            text.lines().map(code).filter(|line| !line.is_empty()).collect()
        };
        assert_eq!(bare(&after), bare(&text), "{}", path.display());
    }
}

#[test]
fn each_rule_shows() {
    let cases = [
        ("", ""),
        ("\n\n\n", ""),
        ("a=1", "a = 1\n"),
        ("\n\na   =   1\n\n\n\nb=2\r\n", "a = 1\n\nb = 2\n"),
        ("[ shape . a ]#x\n", "[shape.a]    #x\n"),
        ("[[ clip . a . track ]]\n", "[[clip.a.track]]\n"),
        ("a . b = 1.5\n'c d' . e=-1e3", "a.b = 1.5\n'c d'.e = -1e3\n"),
        ("a = [ 1,2 ,3, ]\n", "a = [1, 2, 3]\n"),
        ("a = [\n1,2\n, 3 # three\n]", "a = [\n  1, 2\n  , 3, # three\n]\n"),
        ("a = [[\n1\n]\n,[2]]\n", "a = [[\n  1,\n]\n  , [2]]\n"),
        (
            "a = [\n    { b=1,c={} },\n\t[\n1,\n],# end\n]\n",
            "a = [\n  { b = 1, c = {} },\n  [\n    1,\n  ], # end\n]\n",
        ),
        ("a = {b = \"# no comment\"}   # one  \n", "a = { b = \"# no comment\" } # one\n"),
        ("a = 1     # aligned\nbcd = 22  # aligned\n", "a = 1     # aligned\nbcd = 22  # aligned\n"),
        ("a = \"\"\"\n  kept   \n\n\n x\"\"\"#c\n", "a = \"\"\"\n  kept   \n\n\n x\"\"\" #c\n"),
        ("a = 1979-05-27 07:32:00\n", "a = 1979-05-27 07:32:00\n"),
        ("a = [# open\n\n\n# alone\n]", "a = [ # open\n\n  # alone\n]\n"),
        ("\u{feff}a=1\n", "a = 1\n"),
        ("  # indented\n  a=1\n", "# indented\na = 1\n"),
    ];
    for (text, expected) in cases {
        let after = format(text);
        assert_eq!(after, expected, "of {text:?}");
        assert_eq!(format(&after), after, "twice, of {text:?}");
        assert_eq!(meaning(&after), meaning(text.trim_start_matches('\u{feff}')), "of {text:?}");
    }
}

/// Text that is no document comes back as text, whatever it is.
#[test]
fn broken_text_harms_nothing() {
    for text in [
        "[",
        "]",
        "}}}",
        "a = [",
        "{",
        ",,,",
        "= = =",
        "\"",
        "'''",
        "\"\"\"a",
        "a.b.",
        "\u{0}",
        "a = ]\n[,",
        "é#\u{a0}",
    ] {
        let _ = format(text);
    }
}
