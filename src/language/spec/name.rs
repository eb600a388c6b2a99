//! Names: kebab-case.

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::reader::backtick;

/// The longest name, in bytes.
const LONGEST: usize = 64;

/// The error on a name that is not in kebab-case; `what` is named so (`curve`).
pub(crate) fn check_name(what: &str, name: &str, span: Span) -> Option<Diagnostic> {
    if is_kebab(name) {
        return None;
    }
    let message = format!("{what} name {} is not in kebab-case", backtick(name));
    let report = Diagnostic::error(Code::BadName, message)
        .at(span, "expected lower-case letters and digits, with `-` between words")
        .note(format!("a name begins with a letter and has at most {LONGEST} letters"));
    let better = in_kebab(name);
    Some(if is_kebab(&better) { report.suggest(span, &better, format!("write `{better}`")) } else { report })
}

fn is_kebab(name: &str) -> bool {
    let word = |word: &str| {
        !word.is_empty() && word.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit())
    };
    name.len() <= LONGEST && name.starts_with(|c: char| c.is_ascii_lowercase()) && name.split('-').all(word)
}

/// The name in kebab-case; none where its letters make none.
pub(crate) fn kebab(name: &str) -> Option<String> {
    Some(in_kebab(name)).filter(|name| is_kebab(name))
}

/// The name in kebab-case, as far as its letters allow.
fn in_kebab(name: &str) -> String {
    let mut words = String::new();
    let mut lower = false;
    for letter in name.chars() {
        if letter.is_ascii_uppercase() && lower {
            words.push('-');
        }
        lower = letter.is_ascii_lowercase() || letter.is_ascii_digit();
        words.push(if letter.is_ascii_alphanumeric() { letter.to_ascii_lowercase() } else { '-' });
    }
    words.split('-').filter(|word| !word.is_empty()).collect::<Vec<_>>().join("-")
}

#[cfg(test)]
mod tests {
    use super::{in_kebab, is_kebab};

    #[test]
    fn names_are_kebab_case() {
        for good in ["a", "vase-2", "outer-wall", "x1-y2"] {
            assert!(is_kebab(good), "{good}");
        }
        for bad in ["", "A", "a_b", "-a", "a-", "a--b", "2a", "a b", "ä", &"a".repeat(65)] {
            assert!(!is_kebab(bad), "{bad}");
        }
        assert_eq!(in_kebab("OuterWall_2 x"), "outer-wall-2-x");
    }
}
