//! The examples of `kiln explain` do what they say.

use kiln::language::Document;
use kiln::language::diagnostic::{Code, example, explain};
use kiln::language::source::MemoryFiles;

fn codes(text: &str) -> Vec<Code> {
    let files = MemoryFiles::new().with("example.toml", text).with("folder/file", "");
    let found = match Document::load("example.toml", &files) {
        Ok(document) => match document.spec(None, &[]) {
            Ok((_, warnings)) => warnings,
            Err(found) => found.into_vec(),
        },
        Err(found) => found.into_vec(),
    };
    found.into_iter().map(|one| one.code).collect()
}

/// Codes of the whole pipeline, for what only geometry and the result can say.
fn baked_codes(text: &str) -> Vec<Code> {
    let picture: &[u8] = include_bytes!("../../specs/inputs/label.png");
    let files = MemoryFiles::new().with("example.toml", text).with("label.png", picture);
    let document = match Document::load("example.toml", &files) {
        Ok(document) => document,
        Err(found) => return found.into_vec().into_iter().map(|one| one.code).collect(),
    };
    let options = kiln::compile::Options { name: "example".to_owned(), ..Default::default() };
    let found = match kiln::compile(&document, &files, &options) {
        Ok(compiled) => compiled.warnings,
        Err(found) => found,
    };
    found.into_vec().into_iter().map(|one| one.code).collect()
}

#[test]
fn examples_of_geometry_and_results_do_what_they_say() {
    let mut shown = 0;
    for &code in Code::ALL.iter().filter(|code| code.text() >= "K0800") {
        let example = example(code);
        if !example.wrong.is_empty() {
            assert_eq!(baked_codes(example.wrong), [code], "{code}: {}", example.wrong);
            assert_eq!(baked_codes(example.right), [], "{code}: {}", example.right);
            shown += 1;
        }
    }
    assert!(shown >= 10, "{shown}");
}

#[test]
fn a_wrong_example_gives_its_code_and_a_right_one_none() {
    for &code in Code::ALL.iter().filter(|code| code.text() < "K0800") {
        let example = example(code);
        assert!(example.text.ends_with('.'), "{code}");
        if !example.wrong.is_empty() {
            // What the document alone does not tell is found when it is built.
            let found = codes(example.wrong);
            let found = if found.is_empty() { baked_codes(example.wrong) } else { found };
            assert_eq!(found, [code], "{code}: {}", example.wrong);
        }
        assert_eq!(codes(example.right), [], "{code}: {}", example.right);
    }
}

#[test]
fn codes_are_unique_sorted_and_found_by_their_text() {
    let texts: Vec<&str> = Code::ALL.iter().map(|code| code.text()).collect();
    assert!(texts.windows(2).all(|pair| pair[0] < pair[1]), "{texts:?}");
    for &code in Code::ALL {
        assert_eq!(Code::parse(&code.text().to_lowercase()), Some(code));
        assert!(explain(code).contains(code.title()));
        assert!(!code.title().is_empty());
    }
    assert_eq!(Code::parse("K9999"), None);
}
