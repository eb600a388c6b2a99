//! The gallery with random damage: never a panic, every refusal says where, every result can be read.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use kiln::compile::{Compiled, Options};
use kiln::language::Document;
use kiln::language::diagnostic::{Diagnostics, Severity};
use kiln::language::source::MemoryFiles;

use super::glb::Glb;
use crate::laws::Dice;

/// What a folder holds, by name.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let read = std::fs::read_dir(folder).expect("the gallery");
    let mut found: Vec<_> = read.map(|entry| entry.expect("it is read").path()).collect();
    found.sort();
    found
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("specs")
}

/// The path of a file from the project root.
fn name(file: &Path) -> String {
    let place = file.strip_prefix(env!("CARGO_MANIFEST_DIR")).expect("inside");
    place.to_string_lossy().replace('\\', "/")
}

/// The documents of the gallery.
fn documents() -> Vec<PathBuf> {
    let folders = entries(&root()).into_iter().filter(|path| path.is_dir());
    let files = folders.flat_map(|folder| entries(&folder));
    files.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect()
}

/// Whether a document has something to show, and is no library.
fn shows(file: &Path) -> bool {
    std::fs::read_to_string(file).expect("specs are text").contains("[shape")
}

/// Documents to damage: the gallery, and one that uses the rest of the language.
fn seeds() -> Vec<(String, String)> {
    let shown = documents().into_iter().filter(|file| shows(file));
    let seed = |file: PathBuf| (name(&file), std::fs::read_to_string(&file).expect("specs are text"));
    let mut seeds: Vec<(String, String)> = shown.map(seed).collect();
    seeds.push(("specs/own.toml".to_owned(), OWN.to_owned()));
    assert!(seeds.len() > 30);
    seeds
}

const OWN: &str = r#"
unit = "cm"
up = "z"
[shape.plate.extrude]
height = 0.5
profile = { polyline = { points = [[0, 0], [4, 0], [4, 3], [0, 3]], closed = true } }
holes = [{ circle = { radius = 0.5, center = [1, 1] } }, "slot"]
[curve.slot.natural-spline]
points = [[2, 1], [3, 1], [3, 2], [2, 2]]
closed = true
parameters = "centripetal"
[shape.tetra]
crease-angle = 60
[shape.tetra.mesh]
points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
smoothing-groups = [1, 1, 2, 0]
[shape.row.array]
of = "tetra"
count = 5
offset = [2, 0, 0]
rotate = [0, 0, 15]
around = [1, 1, 0]
[shape.block.array]
of = { sphere = { radius = 0.25 } }
count = [2, 2, 2]
offset = [1, 1, 1]
[shape.twin.mirror]
of = "block"
plane = { normal = [1, 1, 0], point = [4, 0, 0] }
[shape.all]
rotate = [10, 20, 30]
scale = [1, 2, 0.5]
uv = "always"
smoothing = "flat"
[shape.all.group]
of = ["row", "twin", "plate", { copy = { of = "tetra" } }]
[shape.knot]
segments = [6, 24]
[shape.knot.sweep]
profile = { ellipse = { radii = [0.2, 0.1] } }
path = { natural-spline = { points = [[1, 0, 0], [0, 1, 1], [-1, 0, 0], [0, -1, -1]], closed = true } }
twist = 180
[shape.bent.sweep]
profile = { arc = { points = [[0.1, 0], [0, 0.1], [-0.1, 0]] } }
path = { path = { start = [0, 0], segments = [{ line = [[1, 0], [2, 1]] }, { quadratic = [[3, 2], [4, 0]] }, { arc = { center = [4, -1], angle = -120 } }] } }
[shape.wedge.revolve]
profile = { bezier = { points = [[0, 0], [1, 0], [1, 1], [0, 1]] } }
angle = 75
start = -30
[node.a]
shape = "all"
at = [1, 2, 3]
[node.b]
shape = "knot"
parent = "a"
rotate = [0, 0, 45]
[node.c]
shape = "wedge"
parent = "b"
scale = 2
[node.d]
shape = "bent"
"#;

const EXTREMES: [&str; 24] = [
    "0",
    "-1",
    "1",
    "1e-300",
    "1e300",
    "-1e300",
    "1e15",
    "1e-15",
    "1e-7",
    "1e7",
    "4294967296",
    "9223372036854775807",
    "-0.0",
    "360",
    "361",
    "179.999999",
    "180",
    "90",
    "0.5",
    "1e-45",
    "3.5e38",
    "nan",
    "inf",
    "\"= 0 / 0\"",
];

/// Words, numbers, punctuation and line ends.
fn tokens(text: &str) -> Vec<String> {
    let mut tokens: Vec<String> = Vec::new();
    let word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '-');
    for c in text.chars() {
        match tokens.last_mut() {
            Some(last) if word(c) && last.ends_with(word) => last.push(c),
            _ => tokens.push(c.to_string()),
        }
    }
    tokens
}

fn damaged(text: &str, dice: &mut Dice) -> String {
    let mut tokens = tokens(text);
    let number = |token: &String| {
        token.starts_with(|c: char| c.is_ascii_digit() || c == '-') && token.parse::<f64>().is_ok()
    };
    for _ in 0..=dice.roll(3) {
        let at = dice.roll(tokens.len());
        let other = tokens[dice.roll(tokens.len())].clone();
        match dice.roll(8) {
            0 => drop(tokens.remove(at)),
            1 => tokens.insert(at, tokens[at].clone()),
            2 => tokens[at] = other,
            _ => {
                let numbers: Vec<usize> = (0..tokens.len()).filter(|at| number(&tokens[*at])).collect();
                let at = numbers[dice.roll(numbers.len())];
                tokens[at] = match dice.roll(3) {
                    0 => EXTREMES[dice.roll(EXTREMES.len())].to_owned(),
                    1 => tokens[numbers[dice.roll(numbers.len())]].clone(),
                    _ => format!("{}", tokens[at].parse::<f64>().unwrap_or(1.0) * dice.between(-3.0, 3.0)),
                };
            }
        }
    }
    tokens.concat()
}

/// What documents of the gallery read: pictures, models, and documents that show nothing by themselves.
fn inputs() -> &'static [(String, Vec<u8>)] {
    static INPUTS: OnceLock<Vec<(String, Vec<u8>)>> = OnceLock::new();
    INPUTS.get_or_init(|| {
        let pictures = entries(&root().join("inputs")).into_iter();
        let libraries = documents().into_iter().filter(|file| !shows(file));
        pictures
            .chain(libraries)
            .map(|file| (name(&file), std::fs::read(&file).expect("it is there")))
            .collect()
    })
}

fn run(path: &str, text: &str) -> Result<Compiled, Diagnostics> {
    let files = inputs().iter().fold(MemoryFiles::new(), |files, (name, bytes)| files.with(name, bytes));
    let files = files.with(path, text);
    let document = Document::load(path, &files)?;
    kiln::compile(&document, &files, &Options { name: "x".to_owned(), ..Options::default() })
}

#[test]
fn the_seeds_themselves_are_whole() {
    for (path, text) in seeds() {
        let compiled = run(&path, &text).unwrap_or_else(|found| panic!("{path}: {found}"));
        assert!(compiled.warnings.is_empty(), "{path}: {}", compiled.warnings);
    }
}

#[test]
fn damaged_documents_are_refused_with_a_place_or_baked_whole() {
    use rayon::prelude::{IntoParallelIterator, ParallelIterator};

    let seeds = seeds();
    let rounds: u64 =
        std::env::var("KILN_ROUNDS").ok().and_then(|rounds| rounds.parse().ok()).unwrap_or(2000);
    let faults: Vec<String> = (0..rounds).into_par_iter().filter_map(|round| fault(&seeds, round)).collect();
    assert!(
        faults.is_empty(),
        "{} of {rounds}:\n{}",
        faults.len(),
        faults[..faults.len().min(5)].join("\n\n")
    );
    crate::counts::tried("damaged-documents", usize::try_from(rounds).expect("small"));
    let baked = (0..200).filter(|round| try_round(&seeds, *round).1.is_ok()).count();
    assert!((20..180).contains(&baked), "{baked} of 200 are baked: the damage is too small or too great");
}

fn try_round(seeds: &[(String, String)], round: u64) -> (String, Result<Compiled, Diagnostics>) {
    let mut dice = Dice::new(round + 1000);
    let (path, text) = &seeds[dice.roll(seeds.len())];
    let text = format!("{}\n[limits]\ntriangles = 20000\nimage-pixels = 4000000\n", damaged(text, &mut dice));
    let result = run(path, &text);
    (text, result)
}

fn fault(seeds: &[(String, String)], round: u64) -> Option<String> {
    let result = catch_unwind(AssertUnwindSafe(|| {
        let (text, result) = try_round(seeds, round);
        judge(&result).map(|why| format!("{why}\n{text}"))
    }));
    match result {
        Ok(found) => found.map(|why| format!("round {round}: {why}")),
        Err(_) => Some(format!("round {round} panicked")),
    }
}

/// What is wrong with a result.
fn judge(result: &Result<Compiled, Diagnostics>) -> Option<String> {
    match result {
        Ok(compiled) => {
            Glb::new(&compiled.bytes).check();
            let report = compiled.report.as_ref().expect("a report was asked for");
            let warned = !compiled.warnings.is_empty();
            let beyond = report.shapes.iter().find(|(_, shape)| {
                let deviation = shape.deviation;
                deviation.tolerance.is_some_and(|tolerance| deviation.bound > tolerance * (1.0 + 1e-9))
                    && !warned
            });
            beyond.map(|(name, shape)| format!("{name} is beyond its tolerance: {:?}", shape.deviation))
        }
        Err(found) => {
            assert!(!found.render(true).is_empty());
            let errors: Vec<_> = found.iter().filter(|one| one.severity == Severity::Error).collect();
            let nowhere = errors.iter().find(|one| {
                one.place().is_none() && one.code.text() != "K0306" && one.code.text() != "K0902"
            });
            if errors.is_empty() {
                Some("refused without an error".to_owned())
            } else {
                nowhere.map(|one| format!("no place: {one:?}"))
            }
        }
    }
}
