//! What a project file, `kiln.toml`, can say: its documents, for whom they are baked, and what is remembered.

use indexmap::IndexMap;
use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::{FileError, join};
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::limit::{Bytes, Limits};
use crate::language::spec::morph::ParameterValue;
use crate::language::spec::output::OutputProfile;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::schema::{ORDER, Schemas};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

table! {
    /// A project, `kiln.toml`: it stands in the folder that no document of it reads outside of. What is said to a command takes
    /// the place of what is said here.
    "project" pub(crate) Project {
        /// Folders of documents, or documents; paths are relative to this file. Among the outputs a document has the place that it
        /// has below its root.
        roots: Vec<Sp<InnerPath>> => Check::items(1);
        /// Where outputs go; the folder `out` beside this file when it is not written.
        out: Option<Sp<InnerPath>>;
        /// For whom files are, whatever documents say: one file for each of them.
        profiles: Option<Sp<Vec<Sp<OutputProfile>>>> => Check::items(1);
        /// Parameters of all documents that have one of that name, as `--set` gives them.
        parameters: IndexMap<String, Sp<ParameterText>> = IndexMap::new();
        /// What was baked before.
        cache: Option<Sp<ProjectCache>>;
        /// How much documents may ask for.
        limits: Option<Sp<ProjectLimits>>;
    }
}

table! {
    /// How much documents may ask for: more than is usual or less. A document itself can only lower it.
    "project limits" pub(crate) ProjectLimits {
        /// Most triangles of one asset; 50 million when it is not written.
        triangles: Option<Sp<u64>> => Check::within(1.0, 1e9);
        /// Most vertices of one asset; 50 million when it is not written.
        vertices: Option<Sp<u64>> => Check::within(1.0, 1e9);
        /// Most memory, in bytes or as in `"512 MiB"`; 8 GiB when it is not written.
        memory: Option<Sp<Bytes>>;
        /// Most pixels of one image; 268435456 when it is not written.
        image_pixels: Option<Sp<u64>>;
        /// Most steps of work; 10^10 when it is not written.
        steps: Option<Sp<u64>>;
    }
}

impl Project {
    /// How much its documents may ask for. How deep they may be nested is not said here: that is what the stack holds.
    pub(crate) fn limits(&self) -> Limits {
        let usual = Limits::default();
        let Some(said) = self.limits.as_ref().map(|limits| &limits.value) else { return usual };
        let or = |said: Option<Sp<u64>>, usual: u64| said.map_or(usual, |said| said.value);
        Limits {
            triangles: or(said.triangles, usual.triangles),
            vertices: or(said.vertices, usual.vertices),
            memory: said.memory.map_or(usual.memory, |memory| memory.value.0),
            image_pixels: or(said.image_pixels, usual.image_pixels),
            recursion: usual.recursion,
            steps: or(said.steps, usual.steps),
        }
    }
}

table! {
    /// What was baked before, and where it is kept.
    "cache" pub(crate) ProjectCache {
        /// The folder, relative to this file.
        folder: Option<Sp<InnerPath>>;
        /// How much the folder may take, in bytes or as in `"2 GB"`; 1 GB when it is not written. What was not used for the longest
        /// time goes first.
        limit: Option<Sp<Bytes>>;
        /// One that machines share, which is asked for what the folder does not have.
        remote: Option<Sp<ProjectRemote>>;
    }
}

table! {
    /// A cache that machines share. Nothing is asked of the network without it.
    "remote cache" pub(crate) ProjectRemote {
        /// Its address: `http://` or `https://` of a server that stores what is put under a path, as remote caches of Bazel do, or
        /// `s3://BUCKET/PREFIX` of an object store.
        url: Sp<String>;
        /// Whether what is baked is stored there too.
        write: bool = false;
        /// Seconds that one request may take. A server that is slower is left alone.
        timeout: f64 = 10.0 => Check::within(0.1, 600.0);
    }
}

/// A path inside the project: of a file, or of a folder; `.` is that of the project file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct InnerPath {
    /// As it is written.
    pub(crate) written: String,
    /// From the folder of the project file, with `/` between its parts; empty for that folder.
    pub(crate) resolved: String,
}

/// The value of a parameter, as the command line writes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ParameterText(pub(crate) String);

impl Read for InnerPath {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let Data::String(written) = &value.data else {
            reader.mismatch(value, "a path");
            return None;
        };
        let resolved = match join("", written) {
            Ok(resolved) => resolved,
            Err(FileError::Folder) if !written.is_empty() => String::new(),
            Err(fault) => {
                let label = match fault {
                    FileError::Absolute => "write it relative to this file",
                    FileError::Folder => "write `.` for the folder of this file",
                    ref other => other.label(),
                };
                let report = Diagnostic::error(Code::OutsideRoot, fault.message(written));
                reader.report(report.at(value.span, label));
                return None;
            }
        };
        Some(Self { written: written.clone(), resolved })
    }

    fn schema(_: &mut Schemas) -> Json {
        json!({ "type": "string" })
    }
}

impl Read for ParameterText {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        ParameterValue::read(value, reader)?;
        Some(Self(match &value.data {
            Data::String(text) => text.clone(),
            _ => reader.sources.snippet(value.span).to_owned(),
        }))
    }

    fn schema(schemas: &mut Schemas) -> Json {
        ParameterValue::schema(schemas)
    }
}

/// The JSON Schema (draft 2020-12) of a project file.
#[must_use]
pub fn project_schema() -> Json {
    let mut schema = ordered_project();
    for definition in schema["$defs"].as_object_mut().into_iter().flat_map(|all| all.values_mut()) {
        definition.as_object_mut().map(|object| object.remove(ORDER));
    }
    schema
}

/// The schema, with the order of properties beside them.
pub(crate) fn ordered_project() -> Json {
    let mut schemas = Schemas::default();
    let mut schema = Project::schema(&mut schemas);
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!("Kiln project");
    schema["$defs"] = Json::Object(schemas.into_definitions());
    schema
}
