//! Names of assets as names of Rust.

/// Words that are no names in Rust (The Rust Reference, keywords, edition 2024), and names that the module needs itself.
const TAKEN: [&str; 54] = [
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn",
    "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop",
    "macro", "match", "mod", "move", "mut", "override", "priv", "pub", "ref", "return", "self", "static",
    "struct", "super", "trait", "true", "try", "type", "typeof", "unsafe", "unsized", "use", "virtual",
    "where", "while", "yield", "union", "std", "core",
];

/// The name of a module: `chess-king` is `chess_king`.
pub(super) fn module(name: &str) -> String {
    let text = plain(name).to_lowercase();
    if TAKEN.contains(&text.as_str()) { format!("{text}_") } else { text }
}

/// The name of a constant: `chess-king` is `CHESS_KING`.
pub(super) fn constant(name: &str) -> String {
    plain(name).to_uppercase()
}

/// Letters, digits and single underscores, the first no digit; what is neither letter nor digit becomes an underscore.
fn plain(name: &str) -> String {
    let mut text = String::new();
    for letter in name.chars() {
        if letter.is_ascii_alphanumeric() {
            text.push(letter);
        } else if !text.is_empty() && !text.ends_with('_') {
            text.push('_');
        }
    }
    let text = text.trim_end_matches('_');
    match text.chars().next() {
        None => "unnamed".to_owned(),
        Some(first) if first.is_ascii_digit() => format!("n{text}"),
        Some(_) => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::{constant, module};

    #[test]
    fn names_are_those_of_rust() {
        for (name, as_module, as_constant) in [
            ("chess-king", "chess_king", "CHESS_KING"),
            ("vase.tall", "vase_tall", "VASE_TALL"),
            ("type", "type_", "TYPE"),
            ("8-ball", "n8_ball", "N8_BALL"),
            ("  a--b ", "a_b", "A_B"),
            ("Äpfel", "pfel", "PFEL"),
            ("\u{1b}[31m", "n31m", "N31M"),
            ("", "unnamed", "UNNAMED"),
        ] {
            assert_eq!((module(name).as_str(), constant(name).as_str()), (as_module, as_constant));
        }
    }
}
