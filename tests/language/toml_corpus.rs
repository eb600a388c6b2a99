//! The published corpus of TOML 1.0: every valid document has its values, every invalid one is refused.

use std::path::PathBuf;
use std::process::Command;

use kiln::language::source::{SourceMap, decode};
use kiln::language::value::{Data, Table, Value, parse};
use serde_json::Value as Json;

/// The folder of real data; `None`, said aloud, where there is none.
#[expect(clippy::print_stdout, reason = "a run without the real data says so")]
fn cases(count: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("KILN_CASES").map(PathBuf::from);
    if folder.is_none() {
        println!("not run without KILN_CASES: {count}");
    }
    folder
}

#[test]
fn the_corpus_is_read_as_its_authors_say() {
    let Some(folder) = cases("346 real-data cases") else { return };
    let packed = folder.join("toml/toml_test_1.0.json.gz");
    let unpacked = Command::new("gzip").arg("-dc").arg(&packed).output().expect("gzip runs");
    assert!(unpacked.status.success(), "{} cannot be unpacked", packed.display());
    let corpus: Json = serde_json::from_slice(&unpacked.stdout).expect("the corpus is JSON");
    let files = corpus["files"].as_object().expect("the corpus lists files");
    assert!(files.len() > 300);
    let wrong: Vec<String> = files.iter().filter_map(|(name, case)| fault(name, case)).collect();
    assert!(wrong.is_empty(), "{} of {} are wrong:\n{}", wrong.len(), files.len(), wrong.join("\n"));
}

fn fault(name: &str, case: &Json) -> Option<String> {
    let bytes = base64(case["b64"].as_str().expect("a case has bytes"));
    let read = read(&bytes);
    if name.starts_with("invalid/") {
        return read.is_ok().then(|| format!("{name} was accepted"));
    }
    let expected = case.get("expect").expect("a valid case has its values");
    match read {
        Err(messages) => Some(format!("{name} was refused: {messages:?}")),
        Ok(table) => differs_table(&table, expected).map(|what| format!("{name}: {what}")),
    }
}

fn read(bytes: &[u8]) -> Result<Table, Vec<String>> {
    let text = decode(bytes).map_err(|fault| vec![fault.to_string()])?;
    let mut sources = SourceMap::new();
    let file = sources.add("case.toml", text).expect("it is small");
    let (table, found) = parse(&sources, file);
    if found.is_empty() { Ok(table) } else { Err(found.into_iter().map(|one| one.message).collect()) }
}

fn differs_table(table: &Table, expected: &Json) -> Option<String> {
    let Some(expected) = expected.as_object() else { return Some("a table was not expected".to_owned()) };
    if table.entries.len() != expected.len() {
        return Some(format!("{} entries instead of {}", table.entries.len(), expected.len()));
    }
    table.entries.iter().find_map(|(name, entry)| match expected.get(name) {
        None => Some(format!("`{name}` was not expected")),
        Some(expected) => differs(&entry.value, expected).map(|what| format!("`{name}`: {what}")),
    })
}

fn differs(value: &Value, expected: &Json) -> Option<String> {
    match &value.data {
        Data::Table(table) => return differs_table(table, expected),
        Data::Array(items) => {
            let listed = expected.as_array()?;
            if items.len() != listed.len() {
                return Some(format!("{} items instead of {}", items.len(), listed.len()));
            }
            return items.iter().zip(listed).find_map(|(item, expected)| differs(item, expected));
        }
        _ => {}
    }
    let (kind, text) = (expected["type"].as_str()?, expected["value"].as_str()?);
    let same = match &value.data {
        Data::String(read) => kind == "string" && read == text,
        Data::Integer(read) => kind == "integer" && text.parse() == Ok(*read),
        Data::Float(read) => kind == "float" && same_float(*read, text),
        Data::Boolean(read) => kind == "bool" && text.parse() == Ok(*read),
        Data::Datetime(read) => {
            (kind.starts_with("date") || kind.starts_with("time")) && same_time(read, text)
        }
        _ => false,
    };
    (!same).then(|| format!("{value:?} instead of {expected}"))
}

fn same_float(read: f64, text: &str) -> bool {
    text.parse::<f64>().is_ok_and(|expected| read == expected || read.is_nan() && expected.is_nan())
}

fn same_time(read: &str, text: &str) -> bool {
    read.get(..8) == text.get(..8)
}

fn base64(text: &str) -> Vec<u8> {
    let digit = |byte: u8| match byte {
        b'A'..=b'Z' => Some(byte - b'A'),
        b'a'..=b'z' => Some(byte - b'a' + 26),
        b'0'..=b'9' => Some(byte - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    };
    let digits: Vec<u8> = text.bytes().filter_map(digit).collect();
    let bytes = digits.chunks(4).flat_map(|chunk| {
        let bits = (0..4).fold(0u32, |bits, index| bits << 6 | u32::from(*chunk.get(index).unwrap_or(&0)));
        bits.to_be_bytes()[1..chunk.len()].to_vec()
    });
    bytes.collect()
}

#[test]
fn hostile_documents_are_refused_with_a_message() {
    let Some(folder) = cases("3 real-data cases") else { return };
    let refused = |name: &str| {
        let bytes = std::fs::read(folder.join("hostile/toml").join(name)).expect("the case is there");
        read(&bytes).expect_err("it is refused")
    };
    assert_eq!(refused("deep_arrays.toml"), ["arrays and tables are nested more than 64 deep"]);
    assert_eq!(refused("huge_int.toml"), ["the whole number 99999999999999999999 does not fit in 64 bits"]);
    assert_eq!(refused("utf16.toml"), ["this is UTF-16 text; save it as UTF-8"]);
}
