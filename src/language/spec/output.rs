//! What is written, for whom, and where a model stands in files.
//!
//! Settings of where it stands are one for all profiles, or one for each of some: `forward = "-z"`, or
//! `forward = { bevy = "-z" }`.

use glam::DVec3;
use serde_json::{Map, Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::collider::ColliderForm;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::kind::choice;
use crate::language::spec::reader::{Read, Reader, unknown_field};
use crate::language::spec::scalar::finite;
use crate::language::spec::schema::{Schemas, any_of, one_of_words, or_expression};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

choices! {
    /// For whom a file is.
    OutputProfile {
        /// `NAME.glb`: floats, and no extension is needed. Every engine opens it.
        Core = "core";
        /// `NAME.quantized.glb`: positions of 16 bits on one grid for the whole model, normals and tangents of 8, texture
        /// coordinates of 16 where they lie in the unit square. Needs `KHR_mesh_quantization`.
        Quantized = "quantized";
        /// `NAME.web.glb`: as quantized, on the coarsest grid that the tolerance allows, and compressed. Needs
        /// `KHR_mesh_quantization` and `EXT_meshopt_compression`.
        Web = "web";
        /// `NAME.verify.glb`: as core; meshes that are closed say by `EXT_mesh_manifold`, which is not required, which of their
        /// vertices are one, so that programs that need solids have them without guessing.
        Verify = "verify";
        /// `NAME.bevy.glb`: as core. Levels of detail in files of their own, each a scene for a `VisibilityRange`; colliders in `extras`.
        Bevy = "bevy";
        /// `NAME.godot.glb`: as core. Levels in files of their own, colliders by names. A warning tells names that Godot acts upon.
        Godot = "godot";
        /// `NAME.unreal.glb`: as core. Levels in files of their own, colliders by names.
        Unreal = "unreal";
        /// `NAME.unity.glb`: as quantized. Levels in files of their own, colliders in `extras`.
        Unity = "unity";
        /// `NAME.three.glb`: as quantized. Levels by `MSFT_lod`, for which three.js has a plugin; colliders in `extras`.
        Three = "three";
        /// `NAME.babylon.glb`: as quantized. Levels by `MSFT_lod`, colliders in `extras`.
        Babylon = "babylon";
        /// `NAME.blender.glb`: as core. Levels in files of their own, colliders in `extras`.
        Blender = "blender";
    }
}

choices! {
    /// The axis of a file that the front of a model looks along.
    Forward {
        /// As the format says, and as Kiln's models look.
        Z = "z";
        /// As cameras look, and games that take their axes for all things.
        NegativeZ = "-z";
        /// To the right of the format's front.
        X = "x";
        /// To the left of the format's front.
        NegativeX = "-x";
    }
}

/// What becomes the origin of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pivot {
    /// The origin of the document.
    Origin,
    /// The middle of the underside of the box around the model at rest.
    Base,
    /// The middle of that box.
    Center,
    /// A point, in the document's unit and axes.
    Point(DVec3),
}

/// How much larger a file is than the model in metres, the same along all axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputScale(pub f64);

/// Pixels of the longer side of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextureSize(pub u32);

/// A setting for all profiles, or for each of some.
#[derive(Clone, Debug, PartialEq)]
pub enum ByProfile<T> {
    /// For all.
    All(Sp<T>),
    /// For each of these; the others have what stands where nothing is written.
    Each(Vec<(OutputProfile, Sp<T>)>),
}

impl<T> ByProfile<T> {
    /// The setting of the profile that `is` it.
    pub fn of(&self, is: impl Fn(OutputProfile) -> bool) -> Option<&Sp<T>> {
        match self {
            Self::All(value) => Some(value),
            Self::Each(all) => all.iter().find(|(profile, _)| is(*profile)).map(|(_, value)| value),
        }
    }
}

table! {
    /// How small the pictures of a file are.
    "textures" pub Textures {
        /// Pixels of the longer side, at most: larger pictures are made smaller, colors as light, normals kept unit, without a
        /// seam where they repeat; what was a JPEG is then a PNG. May be one for each profile.
        max_size: Option<ByProfile<TextureSize>>;
        /// Whether PNG files are written anew in the shortest of many ways, where that is shorter. Nothing of them is lost; it
        /// takes a second for each million pixels.
        compress: Sp<bool> = false;
        /// Whether pictures are files of their own beside the `.glb`, named `FILE.PICTURE.png` or `.jpg`, rather than within it; so
        /// a tool can change or compress them, and a game load them by itself. May be one for each profile.
        beside: Option<ByProfile<bool>>;
    }
}

table! {
    /// What is written. Where a setting may be one for each profile, write it as `{ bevy = "-z", unreal = "x" }`; the others
    /// have the default. A forward axis, pivot or scale that is not the default becomes a node at the top that carries all
    /// others: meshes, skins, motions, sockets and bodies are the same in all files, and every engine reads nodes.
    "output" pub Output {
        /// One file for each of them; `["core"]` when it is not written.
        profiles: Option<Sp<Vec<Sp<OutputProfile>>>> => Check::items(1);
        /// How colliders stand in files. When it is not written: "godot" and "unreal" in the profiles of these names, else
        /// "extras".
        colliders: Option<Sp<ColliderForm>>;
        /// The axis of the file that the front of the model looks along; y points up. "z" when it is not written, which all
        /// importers turn to their engine's front. May be one for each profile.
        forward: Option<ByProfile<Forward>>;
        /// What becomes the origin of the file: `"origin"` of the document, which it is when nothing is written; `"base"`, the
        /// middle of the underside of the box around the finest level at rest; `"center"`, the middle of that box; or a point in
        /// the document's unit and axes. May be one for each profile.
        pivot: Option<ByProfile<Pivot>>;
        /// How much larger the file is than the model in metres, more than 0: 100 for centimetres. Lights reach as much further,
        /// and are the brighter for it. 1 when it is not written. May be one for each profile.
        scale: Option<ByProfile<OutputScale>>;
        /// Whether what wears one material is one primitive of a mesh. With `false` each part that a shape is put together of is one
        /// by itself, copies too, and says in `extras` by `part` the name of the shape that it is: for a game that shows, hides or
        /// paints parts. It then draws as many times as there are parts.
        merge: Sp<bool> = true;
        /// How small pictures are.
        textures: Option<Sp<Textures>>;
    }
}

impl Output {
    /// What a document without the section says.
    pub(crate) const NONE: Self = Self {
        profiles: None,
        colliders: None,
        forward: None,
        pivot: None,
        scale: None,
        merge: Sp { value: true, span: Span::NONE },
        textures: None,
    };
}

/// Sides of pictures.
const SIZES: Check = Check::within(1.0, 65536.0);

/// The words of a pivot.
const PIVOTS: [(&str, Pivot); 3] =
    [("origin", Pivot::Origin), ("base", Pivot::Base), ("center", Pivot::Center)];

impl Read for Pivot {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if let Data::Array(_) = value.data {
            return DVec3::read(value, reader).map(Self::Point);
        }
        let word = choice(value, &PIVOTS.map(|(word, _)| word), reader)?;
        PIVOTS.iter().find(|(own, _)| *own == word).map(|(_, pivot)| *pivot)
    }

    fn schema(schemas: &mut Schemas) -> Json {
        let mut all = one_of_words(&PIVOTS.map(|(word, _)| word));
        all.push(DVec3::schema(schemas));
        any_of(all)
    }
}

impl Read for OutputScale {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if let Data::Array(_) = value.data {
            let message = format!("{} is one number, the same along all axes", reader.place());
            let report = Diagnostic::error(Code::UnevenScale, message)
                .at(value.span, "uneven")
                .help("write one number; to stretch the model itself, write `scale` on its shapes");
            reader.report(report);
            return None;
        }
        let read = finite(value, reader)?;
        Check::above(0.0).apply(value, reader).then_some(Self(read))
    }

    fn schema(_: &mut Schemas) -> Json {
        let mut schema = or_expression("number");
        Check::above(0.0).constrain(&mut schema);
        schema
    }
}

impl Read for TextureSize {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let read = u32::read(value, reader)?;
        SIZES.apply(value, reader).then_some(Self(read))
    }

    fn schema(schemas: &mut Schemas) -> Json {
        let mut schema = u32::schema(schemas);
        SIZES.constrain(&mut schema);
        schema
    }
}

impl<T: Read> Read for ByProfile<T> {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let Data::Table(table) = &value.data else { return Sp::<T>::read(value, reader).map(Self::All) };
        let mut all = Vec::with_capacity(table.entries.len());
        for (name, entry) in &table.entries {
            let Some(profile) = OutputProfile::named(name) else {
                let known: Vec<String> = OutputProfile::ALL.map(|one| one.text().to_owned()).into();
                reader.report(unknown_field(name, entry.key, &known, "profiles"));
                continue;
            };
            let read = reader.within(name, |reader| Sp::<T>::read(&entry.value, reader));
            all.extend(read.map(|read| (profile, read)));
        }
        (all.len() == table.entries.len()).then_some(Self::Each(all))
    }

    fn schema(schemas: &mut Schemas) -> Json {
        let mut own = T::schema(schemas);
        let choices = own.as_object_mut().and_then(|own| own.remove("choices"));
        let each: Map<String, Json> =
            OutputProfile::ALL.iter().map(|profile| (profile.text().to_owned(), own.clone())).collect();
        let table = json!({ "type": "object", "properties": each, "additionalProperties": false });
        let mut schema = match own.get("anyOf").and_then(Json::as_array) {
            Some(own) => any_of([own.as_slice(), &[table]].concat()),
            None => any_of(vec![own, table]),
        };
        if let Some(choices) = choices {
            schema["choices"] = choices;
        }
        schema
    }
}
