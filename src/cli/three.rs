//! The viewer library of other people, three.js, where it is installed: Kiln carries no copy of it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::language::source::join;

/// The folder of an installed three.js.
pub(crate) struct Three {
    /// With all links followed.
    folder: PathBuf,
}

/// What shows that a folder holds it.
const MODULE: &str = "build/three.module.js";

/// Folders of it that may be asked for.
const OPEN: [&str; 2] = ["build/", "examples/jsm/"];

/// The largest file that is handed out, bytes.
const LARGEST: u64 = 64 << 20;

impl Three {
    /// The folder that is named; else one beside the program, or where npm put it for the working directory, the project,
    /// or a folder above them. None where there is none.
    pub(crate) fn find(named: Option<&Path>, root: &Path) -> Result<Option<Self>, String> {
        if let Some(named) = named {
            let wrong = || format!("{} does not hold three.js: there is no {MODULE} in it", named.display());
            return Self::at(named).map(Some).ok_or_else(wrong);
        }
        let program = std::env::current_exe().ok();
        let beside = program.iter().filter_map(|program| program.parent()).map(|folder| folder.join("three"));
        let here = std::env::current_dir().ok();
        let starts = here.iter().map(PathBuf::as_path).chain([root]);
        let above = starts.flat_map(Path::ancestors).flat_map(|folder| {
            ["node_modules/three", "scripts/node_modules/three"].map(|modules| folder.join(modules))
        });
        Ok(beside.chain(above).find_map(|folder| Self::at(&folder)))
    }

    fn at(folder: &Path) -> Option<Self> {
        let folder = folder.canonicalize().ok()?;
        folder.join(MODULE).is_file().then_some(Self { folder })
    }

    /// The modules that a module of a page needs, and those that these need: their paths in the folder and what stands there.
    pub(crate) fn needed(&self, text: &str) -> Vec<(String, Vec<u8>)> {
        let mut open: Vec<String> = imports(text).filter_map(|written| located(written, "")).collect();
        let mut found: BTreeMap<String, Vec<u8>> = BTreeMap::new();
        while let Some(path) = open.pop() {
            if found.contains_key(&path) {
                continue;
            }
            let Some(bytes) = self.read(&path) else { continue };
            let text = String::from_utf8_lossy(&bytes);
            open.extend(imports(&text).filter_map(|written| located(written, &path)));
            found.insert(path, bytes);
        }
        found.into_iter().collect()
    }

    /// A module by its path in the folder.
    pub(crate) fn read(&self, path: &str) -> Option<Vec<u8>> {
        let plain = |part: &str| {
            !part.starts_with('.')
                && !part.is_empty()
                && part.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"._-".contains(&byte))
        };
        let asked = path.ends_with(".js")
            && OPEN.iter().any(|open| path.starts_with(open))
            && path.split('/').all(plain);
        if !asked {
            return None;
        }
        // A link may lead anywhere.
        let file = self.folder.join(path).canonicalize().ok()?;
        let facts = std::fs::metadata(&file).ok()?;
        let inside = file.starts_with(&self.folder) && facts.is_file() && facts.len() <= LARGEST;
        inside.then(|| std::fs::read(file).ok())?
    }
}

/// The modules that a text of JavaScript imports, as they are written.
fn imports(text: &str) -> impl Iterator<Item = &str> {
    let starts = text.match_indices("from ").map(|(at, word)| &text[at + word.len()..]);
    starts.filter_map(|rest| {
        let quote = rest.chars().next().filter(|sign| matches!(sign, '\'' | '"'))?;
        rest[1..].split_once(quote).map(|(path, _)| path)
    })
}

/// The path of an imported module in the folder, where it is one of those: by the names that pages give them, or from the
/// module that imports it.
fn located(written: &str, from: &str) -> Option<String> {
    if written == "three" {
        return Some(MODULE.to_owned());
    }
    if let Some(path) = written.strip_prefix("three/addons/") {
        return Some(format!("examples/jsm/{path}"));
    }
    (!from.is_empty() && written.starts_with('.')).then(|| join(from, written).ok())?
}

#[cfg(test)]
mod tests {
    use super::{MODULE, Three};

    #[test]
    fn only_modules_inside_are_handed_out() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().join("three");
        for name in [MODULE, "examples/jsm/a/b.js", "src/c.js", "build/d.json", "build/.e.js"] {
            std::fs::create_dir_all(root.join(name).parent().unwrap()).unwrap();
            std::fs::write(root.join(name), name).unwrap();
        }
        std::fs::write(folder.path().join("secret.js"), "secret").unwrap();
        let three = Three::find(Some(&root), folder.path()).unwrap().unwrap();
        assert_eq!(three.read(MODULE).unwrap(), MODULE.as_bytes());
        assert!(three.read("examples/jsm/a/b.js").is_some());
        for path in [
            "src/c.js",
            "build/d.json",
            "build/.e.js",
            "build/../../secret.js",
            "build//three.module.js",
            "/build/three.module.js",
            "build/three.module.js/",
            "build/none.js",
            "",
        ] {
            assert!(three.read(path).is_none(), "{path}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(folder.path().join("secret.js"), root.join("build/link.js")).unwrap();
            assert!(three.read("build/link.js").is_none());
        }
        assert!(Three::find(Some(folder.path()), folder.path()).is_err());
        std::fs::write(
            root.join("examples/jsm/a/b.js"),
            "import {\n  c\n} from '../d.js';\nexport * from \"three\";",
        )
        .unwrap();
        std::fs::write(
            root.join("examples/jsm/d.js"),
            "import e from '../../../secret.js'; import f from './a/b.js'",
        )
        .unwrap();
        let needed = three.needed("import { B } from 'three/addons/a/b.js';\nimport x from './own.js'");
        let paths: Vec<&str> = needed.iter().map(|(path, _)| path.as_str()).collect();
        assert_eq!(paths, [MODULE, "examples/jsm/a/b.js", "examples/jsm/d.js"]);
    }
}
