//! The import table of `src/lib.rs` and the house rules that a program can check, held against every source file.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A source file without comments, texts and test code.
struct Source {
    /// Path from `src`.
    path: String,
    /// Path of its module: `geometry::curve::any`.
    module: Vec<String>,
    text: String,
    /// The code, with comments and the contents of texts blanked.
    code: String,
    /// Whether it is compiled for tests alone.
    test: bool,
}

/// Lines of a file without tests above which it needs to be split.
const LONGEST: usize = 600;

#[test]
fn every_import_stands_in_the_table() {
    let sources = sources();
    let table = table(&sources);
    let mut wrong = Vec::new();
    let mut edges = 0;
    for source in sources.iter().filter(|source| !source.test) {
        let from = row(&table, &source.module);
        for path in paths(source) {
            let Some(to) = target(&table, &path) else {
                wrong.push(format!("{}: `{}` is in no row of the table", source.path, path.join("::")));
                continue;
            };
            if from.as_deref() == Some(to) {
                continue;
            }
            edges += 1;
            match &from {
                Some(from) if !allows(&table[from.as_str()].1, to) => {
                    wrong.push(format!("{}: `{from}` uses `{to}` ({})", source.path, path.join("::")));
                }
                Some(_) => {}
                None if source.path == "lib.rs" || source.path == "main.rs" => {}
                None => wrong.push(format!("{} is in no row of the table", source.path)),
            }
        }
    }
    wrong.sort();
    wrong.dedup();
    assert!(wrong.is_empty(), "imports that the table in src/lib.rs does not allow:\n{}", wrong.join("\n"));
    assert!(edges > 100, "only {edges} imports were found: the test does not read the sources");
}

#[test]
fn the_table_has_no_cycle_and_keeps_the_direction() {
    let table = table(&sources());
    for (name, (place, allowed)) in &table {
        for other in allowed.iter().filter(|other| !other.starts_with("everything")) {
            let below: Vec<_> = table.iter().filter(|(row, _)| within(row, other)).collect();
            assert!(!below.is_empty(), "the row of `{name}` names `{other}`, which has no row");
            for (row, (below, _)) in below {
                assert!(below < place, "`{name}` may use `{row}`, which stands after it");
            }
        }
    }
    let direction = [
        "geometry::number",
        "geometry::curve",
        "geometry::mesh",
        "geometry::surface",
        "geometry::tessellate",
        "import",
        "model",
        "scene",
        "realize",
        "optimize",
        "gltf",
        "report",
    ];
    let places = direction.map(|name| table[name].0);
    assert!(places.is_sorted(), "the rows of the table are not in the order of the direction: {places:?}");
    for blind in ["optimize", "gltf"] {
        for hidden in ["model", "realize"] {
            assert!(!allows(&table[blind].1, hidden), "`{blind}` must not see `{hidden}`");
        }
    }
    for (name, (_, allowed)) in table.iter().filter(|(name, _)| name.starts_with("geometry")) {
        let inside = allowed.iter().all(|other| other.starts_with("geometry"));
        assert!(inside, "the kernel `{name}` may use {allowed:?}");
    }
}

#[test]
fn nothing_is_imported_by_a_star() {
    let star = |source: &Source| {
        let of = |line: &str| line.trim_start().contains("use ") && line.contains("::*");
        source.code.lines().position(of).map(|line| format!("{}:{}", source.path, line + 1))
    };
    let found: Vec<_> = sources().iter().filter_map(star).collect();
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn every_file_says_what_it_is_for() {
    let silent = |source: &Source| {
        let described = source.path == "main.rs" || source.text.starts_with("//! ");
        // A file of tests is described by its name.
        (!described && !source.test).then(|| source.path.clone())
    };
    let found: Vec<_> = sources().iter().filter_map(silent).collect();
    assert!(found.is_empty(), "these files do not open with `//!`: {found:?}");
}

#[test]
fn no_file_is_too_long_and_nothing_is_left_to_do() {
    let mut found = Vec::new();
    for source in sources() {
        for word in ["TO DO", "FIX ME", "XX X"].map(|word| word.replace(' ', "")) {
            if source.text.contains(&word) {
                found.push(format!("{} says {word}", source.path));
            }
        }
        let lines = without_tests(&source.text).lines().count();
        if lines > LONGEST && !source.test {
            found.push(format!("{} has {lines} lines without its tests", source.path));
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// The rules of the table find what they are made for.
#[test]
fn upward_imports_stars_and_groups_would_be_found() {
    let source = |module: &str, code: &str| Source {
        path: format!("{}.rs", module.replace("::", "/")),
        module: module.split("::").map(str::to_owned).collect(),
        text: code.to_owned(),
        code: blank(code),
        test: false,
    };
    let text = "use crate::{gltf, model::{self, Shape}};\nuse super::nearest::{near, far as away};\n\
                // crate::cli is not used\nfn f() { crate::report::facts::measure(\"crate::cli::run\") }\n\
                #[cfg(test)]\nmod tests { use crate::build; }\n";
    let found = paths(&source("geometry::curve::any", text));
    let found: Vec<_> = found.iter().map(|path| path.join("::")).collect();
    let expected = [
        "gltf",
        "model",
        "model::Shape",
        "report::facts::measure",
        "geometry::curve::nearest::near",
        "geometry::curve::nearest::far",
    ];
    assert_eq!(found, expected);
}

fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    collect(&root, &mut files);
    files.sort();
    assert!(files.len() > 80, "only {} files were found", files.len());
    files.iter().map(|file| read(&root, file)).collect()
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("the sources are there") {
        let path = entry.expect("it is read").path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

fn read(root: &Path, file: &Path) -> Source {
    let text = std::fs::read_to_string(file).expect("sources are text");
    let path = file.strip_prefix(root).expect("it is below").to_string_lossy().replace('\\', "/");
    let stem = path.trim_end_matches(".rs").trim_end_matches("/mod");
    let mut module: Vec<String> = stem.split('/').map(str::to_owned).collect();
    let test = module.iter().any(|part| part == "tests");
    if matches!(path.as_str(), "lib.rs" | "main.rs") {
        module.clear();
    }
    Source { code: blank(&text), path, module, text, test }
}

/// The table: for each module its place and what it may use.
fn table(sources: &[Source]) -> BTreeMap<String, (usize, Vec<String>)> {
    let library = sources.iter().find(|source| source.path == "lib.rs").expect("there is a library");
    let mut table = BTreeMap::new();
    for line in library.text.lines().filter_map(|line| line.strip_prefix("//! |")) {
        let cells: Vec<&str> = line.trim_end_matches('|').split('|').map(str::trim).collect();
        let [name, allowed] = cells.as_slice() else { panic!("a row of the table has two cells: {line}") };
        if *name == "module" || name.starts_with("---") {
            continue;
        }
        let plain = |cell: &str| cell.trim().trim_matches('`').to_owned();
        let allowed = allowed.split(',').map(plain).filter(|cell| !cell.is_empty()).collect();
        table.insert(plain(name), (table.len(), allowed));
    }
    assert!(table.len() > 10, "the table in src/lib.rs was not found");
    table
}

fn within(row: &str, module: &str) -> bool {
    row == module || row.strip_prefix(module).is_some_and(|rest| rest.starts_with("::"))
}

fn allows(allowed: &[String], to: &str) -> bool {
    allowed.iter().any(|one| match one.strip_prefix("everything") {
        Some(but) => !but.contains(&format!("`{to}")) && !but.contains(to),
        None => within(to, one),
    })
}

/// The row of a module: the longest name that it lies in.
fn row(table: &BTreeMap<String, (usize, Vec<String>)>, module: &[String]) -> Option<String> {
    (1..=module.len()).rev().map(|count| module[..count].join("::")).find(|name| table.contains_key(name))
}

fn target<'a>(table: &'a BTreeMap<String, (usize, Vec<String>)>, path: &[String]) -> Option<&'a str> {
    let name = row(table, path)?;
    table.get_key_value(&name).map(|(name, _)| name.as_str())
}

/// Every path of this crate that the code names, from its root, test code left out.
fn paths(source: &Source) -> Vec<Vec<String>> {
    let code = without_tests(&source.code);
    let mut found = Vec::new();
    for (start, _) in code.match_indices("crate::") {
        if starts_word(&code, start) {
            expand(&code[start + "crate::".len()..], Vec::new(), &mut found);
        }
    }
    for (start, _) in code.match_indices("super::") {
        if starts_word(&code, start) && !code[..start].ends_with("super::") {
            let mut module = source.module.clone();
            let mut rest = &code[start..];
            while let Some(above) = rest.strip_prefix("super::") {
                module.pop();
                rest = above;
            }
            expand(rest, module, &mut found);
        }
    }
    found.retain(|path| !path.is_empty());
    found
}

fn starts_word(code: &str, start: usize) -> bool {
    !code[..start].ends_with(|before: char| before.is_alphanumeric() || before == '_' || before == ':')
}

/// Reads a path or a group of paths that stands at the start of `code`; gives what follows it.
fn expand<'a>(code: &'a str, mut path: Vec<String>, found: &mut Vec<Vec<String>>) -> &'a str {
    let mut rest = code.trim_start();
    loop {
        if let Some(mut group) = rest.strip_prefix('{') {
            loop {
                group = expand(group, path.clone(), found).trim_start();
                match group.strip_prefix(',') {
                    Some(next) => group = next,
                    None => return group.strip_prefix('}').unwrap_or(group),
                }
            }
        }
        let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        if !word.is_empty() && word != "self" {
            path.push(word.to_owned());
        }
        rest = match after.strip_prefix("::") {
            Some(next) if !next.starts_with('<') => next,
            _ => {
                if !word.is_empty() {
                    found.push(path);
                }
                let named = after.trim_start().strip_prefix("as ").map(|name| {
                    name.trim_start_matches(|c: char| c.is_alphanumeric() || c == '_' || c == ' ')
                });
                return named.unwrap_or(after);
            }
        };
    }
}

/// Blanks comments and the contents of texts; lines stay.
fn blank(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(next) = rest.chars().next() {
        let skipped = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("r#\"") {
            rest.find("\"#").map_or(rest.len(), |end| end + 2)
        } else if next == '"' {
            quoted(rest)
        } else if rest.starts_with("'\"'") || rest.starts_with("'{'") || rest.starts_with("'}'") {
            3
        } else if let Some(escaped) = rest.strip_prefix("'\\") {
            escaped.find('\'').map_or(rest.len(), |end| end + 3)
        } else {
            0
        };
        if skipped == 0 {
            code.push(next);
            rest = &rest[next.len_utf8()..];
        } else {
            code.extend(rest[..skipped].chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
            rest = &rest[skipped..];
        }
    }
    code
}

fn quoted(text: &str) -> usize {
    let mut escaped = false;
    for (place, byte) in text.bytes().enumerate().skip(1) {
        match byte {
            _ if escaped => escaped = false,
            b'\\' => escaped = true,
            b'"' => return place + 1,
            _ => {}
        }
    }
    text.len()
}

/// The code with every item behind `#[cfg(test)]` cut out.
fn without_tests(code: &str) -> String {
    let mut kept = String::new();
    let mut rest = code;
    while let Some(start) = rest.find("#[cfg(test)]") {
        kept.push_str(&rest[..start]);
        let item = &rest[start..];
        let ends = item.find(['{', ';']).unwrap_or(item.len() - 1);
        let length = if item[ends..].starts_with(';') { ends + 1 } else { ends + block(&item[ends..]) };
        rest = &item[length..];
    }
    kept + rest
}

/// Length of the block of braces that stands at the start.
fn block(code: &str) -> usize {
    let mut depth = 0_usize;
    for (place, c) in code.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return place + 1;
        }
    }
    code.len()
}

/// Every module that is compiled for tests alone says so where it is declared.
#[test]
fn files_of_tests_are_declared_as_such() {
    let all = sources();
    let folders: BTreeSet<String> = all
        .iter()
        .filter(|source| source.test)
        .map(|source| source.module[..source.module.len() - 1].join("::"))
        .collect();
    assert!(!folders.is_empty());
    for folder in folders {
        let parent = all.iter().find(|source| source.module.join("::") == folder).expect("it has a parent");
        assert!(parent.code.contains("#[cfg(test)]\nmod tests;"), "{}", parent.path);
    }
}
