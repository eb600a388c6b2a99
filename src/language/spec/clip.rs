//! Clips: what moves, and how.

use glam::{DVec3, DVec4};
use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::formula::Formula;
use crate::language::spec::import::{FilePath, Up};
use crate::language::spec::kind::choice;
use crate::language::spec::material::Color;
use crate::language::spec::morph::MorphName;
use crate::language::spec::point::read_numbers;
use crate::language::spec::reach::Reach;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::reference::{CurveReference, MaterialName, NodeName, SkeletonName};
use crate::language::spec::scalar::finite;
use crate::language::spec::schema::{Schemas, any_of, numbers, one_of_words, or_expression};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

/// The longest clip, seconds.
const LONGEST: f64 = 3600.0;

table! {
    /// A motion: tracks that move nodes and joints over time. It is sampled and written with so few keys that no skinned
    /// vertex is further than `tolerance` from the exact motion, in players that turn on the sphere and in those that
    /// turn by straight lines.
    "clip" pub Clip {
        /// The skeleton of the tracks' joints; not needed where the document has one.
        skeleton: Option<Sp<SkeletonName>>;
        /// Seconds; until the last key or the end of the last curve of values when it is not written.
        duration: Option<Sp<f64>> => Check::at_least(0.0).up_to(LONGEST);
        /// Whether it is played again and again: it must end as it begins.
        r#loop: Sp<bool> = false;
        /// How far a vertex may be from the exact motion, in the document's unit. When it is not written, the document's
        /// `motion-tolerance` holds, else the diagonal of the bounding box / 10000.
        tolerance: Option<Sp<f64>> => Check::above(0.0);
        /// Samples a second of the exact motion, to begin with.
        rate: Sp<f64> = 60.0 => Check::within(1.0, 1000.0);
        /// What becomes of poses beyond the limits of joints, and of properties beyond what they may be.
        limits: Sp<LimitRule> = LimitRule::Error;
        /// What moves, as `[[clip.NAME.track]]`.
        track: Vec<Sp<ClipTrack>> = Vec::new();
        /// The motion of a file, as `[clip.NAME.import]`: tracks for all of its joints, and of glTF for states and materials.
        import: Option<Sp<MotionImport>>;
        /// What joints reach by turning those before them, as `[[clip.NAME.reach]]`.
        reach: Vec<Sp<Reach>> = Vec::new();
        /// What happens at some time, as `[[clip.NAME.event]]`; for the game, in the animation's extras.
        event: Vec<ClipEvent> = Vec::new();
    }
}

table! {
    /// The motion of a BVH file, for a skeleton whose joints have the names of the file's in kebab-case and stand at rest as
    /// they do there; that of an MD5 motion (`.md5anim`), for a skeleton from an MD5 mesh of the same joints; or an animation of
    /// a glTF file, for a skeleton of joints of the same names, for the states of shapes that are imported from the same file, and
    /// for their materials. What of an animation nothing here has is left out with a warning that names it.
    "motion import" pub MotionImport {
        /// The file; the path is relative to this document and stays inside the project.
        file: Sp<FilePath>;
        /// Which animation of a glTF file, by its name there; the first when it is not written.
        animation: Option<Sp<String>>;
        /// What one unit of the file is in the document's unit; as the skeleton's import has it when it is not written.
        scale: Option<Sp<f64>> => Check::above(0.0);
        /// The axis that points up in the file; as the skeleton's import has it when it is not written.
        up: Option<Sp<Up>>;
    }
}

choices! {
    /// What becomes of poses beyond the limits of joints, and of properties beyond what they may be.
    LimitRule {
        /// They are errors.
        Error = "error";
        /// Each angle or number is brought into its range.
        Clamp = "clamp";
    }
}

table! {
    /// The motion of one part of a node or joint, on top of its rest: translations are added (for joints in the rest frame),
    /// rotations are applied before the rest's own, scales are multiplied. Or the weight of a state of a shape. Or a property of a
    /// material, or of the light or camera of a node, in place of the written one; such tracks need players that know
    /// `KHR_animation_pointer`, which is used and not required, and Bevy, which opens no file with them, gets none.
    "track" pub ClipTrack {
        /// The node.
        node: Option<Sp<NodeName>>;
        /// The joint.
        joint: Option<Sp<String>>;
        /// The chain all of whose joints move by one `formula`; in it u runs from 0 at the first joint to 1 at the last.
        chain: Option<Sp<String>>;
        /// The state of a shape whose weight moves, `"SHAPE.TARGET"`: at every node that shows the shape, or at `node` alone.
        morph: Option<Sp<MorphName>>;
        /// The material of which a property changes.
        material: Option<Sp<MaterialName>>;
        /// The part that moves, or the property that changes. A track of a node `along` a curve needs none, nor has a weight one.
        path: Option<Sp<MotionPath>>;
        /// Values at times, each `{ at = seconds, value = ... }`. Translations: three numbers in the document's unit, or one
        /// with `axis`. Rotations: degrees with `axis`; three angles in degrees; or a quaternion `[x, y, z, w]`. Scales: a
        /// number or three. Weights: a number. Colors: `"#rrggbb"`, or linear red, green and blue. Other properties: a number, as
        /// where they are written. With `along`: the share of the curve's length.
        keys: Vec<MotionKey> = Vec::new();
        /// How values go from key to key.
        between: Sp<Between> = Between::Linear;
        /// Formulas of the time t in seconds, in place of keys: one, or a list of three.
        formula: Option<Formulas>;
        /// A plane curve in place of keys: x is the time in seconds, y the value. It must run onward in x.
        curve: Option<CurveReference>;
        /// The axis of a turn or translation by one number: "x", "y", "z" or a direction.
        axis: Option<Sp<Direction>>;
        /// The order in which three angles are applied, each about an axis that stands still. When it is not written, "xyz" for
        /// nodes and "yzx" for joints, which is the order of their limits.
        order: Option<Sp<AngleOrder>>;
        /// What is between keys of angles.
        way: Sp<RotationWay> = RotationWay::Angles;
        /// A curve that a node is moved along by its length, or a color, whose red, green and blue are then its x, y and z.
        /// Without keys, formula or speed: once, at constant speed.
        along: Option<CurveReference>;
        /// Whether a node that is moved along a curve turns with it: its z looks along the curve, its y is up. The frames turn no
        /// more than the curve makes them.
        orient: Sp<bool> = true;
        /// The direction that stays up along the curve, where that is wanted instead.
        up: Option<Sp<DVec3>>;
        /// Speeds along the curve in the document's unit a second, each `{ at = seconds, value = ... }`, changing evenly between.
        speed: Vec<MotionKey> = Vec::new();
    }
    checked check
}

choices! {
    /// Which part of a node or joint moves, or which property of a material, or of a node's light or camera, changes. What is
    /// written differs by no more than half a step of a screen's 8 bits from colors, opacity and shares from 0 to 1, a hundredth
    /// of a degree from angles, and a thousandth of its greatest from everything else.
    MotionPath {
        /// Where it is.
        Translation = "translation";
        /// How it is turned.
        Rotation = "rotation";
        /// Its size.
        Scale = "scale";
        /// The color of a material, with four numbers its opacity too, or of a node's light.
        Color = "color";
        /// The opacity of a material.
        Alpha = "alpha";
        /// The color of the light that a material gives off.
        Emissive = "emissive";
        /// How metallic a material is.
        Metallic = "metallic";
        /// How rough a material is.
        Roughness = "roughness";
        /// The strength of a material's normal texture.
        NormalScale = "normal-scale";
        /// The strength of a material's occlusion texture.
        OcclusionStrength = "occlusion-strength";
        /// The opacity below which nothing is there, of a material with `alpha = "mask"`.
        AlphaCutoff = "alpha-cutoff";
        /// A material's `emissive-strength`, where one is written.
        EmissiveStrength = "emissive-strength";
        /// A material's `ior`, where one is written.
        Ior = "ior";
        /// A material's `dispersion`, where one is written.
        Dispersion = "dispersion";
        /// The `factor` of a material's `clearcoat`.
        Clearcoat = "clearcoat";
        /// The `roughness` of a material's `clearcoat`.
        ClearcoatRoughness = "clearcoat-roughness";
        /// The strength of the normal texture of a material's `clearcoat`.
        ClearcoatNormalScale = "clearcoat-normal-scale";
        /// The `factor` of a material's `transmission`.
        Transmission = "transmission";
        /// The `thickness` of a material's `volume`.
        Thickness = "thickness";
        /// The `attenuation-distance` of a material's `volume`, where one is written.
        AttenuationDistance = "attenuation-distance";
        /// The `attenuation-color` of a material's `volume`.
        AttenuationColor = "attenuation-color";
        /// The `factor` of a material's `specular`.
        Specular = "specular";
        /// The `color` of a material's `specular`.
        SpecularColor = "specular-color";
        /// The `color` of a material's `sheen`.
        SheenColor = "sheen-color";
        /// The `roughness` of a material's `sheen`.
        SheenRoughness = "sheen-roughness";
        /// The `factor` of a material's `iridescence`.
        Iridescence = "iridescence";
        /// The `ior` of a material's `iridescence`.
        IridescenceIor = "iridescence-ior";
        /// The `thickness` of a material's `iridescence`.
        IridescenceThickness = "iridescence-thickness";
        /// The `strength` of a material's `anisotropy`.
        Anisotropy = "anisotropy";
        /// The `rotation` of a material's `anisotropy`.
        AnisotropyRotation = "anisotropy-rotation";
        /// The strength of a node's light.
        Intensity = "intensity";
        /// How far a node's light shines.
        Range = "range";
        /// What a node's camera sees upright, degrees.
        FieldOfView = "field-of-view";
        /// What a node's camera without perspective sees upright.
        Height = "height";
    }
}

choices! {
    /// How values go from key to key.
    Between {
        /// They stay until the next key.
        Step = "step";
        /// Straight, or the shorter way round.
        Linear = "linear";
        /// Smoothly, by cubics with the slopes of the keys.
        Cubic = "cubic";
    }
}

choices! {
    /// What is between keys of a rotation by angles. Quaternions always go the shorter way.
    RotationWay {
        /// Angles change each by itself, over any number of turns.
        Angles = "angles";
        /// The shorter way from rotation to rotation.
        Shortest = "shortest";
    }
}

choices! {
    /// The order of three angles.
    AngleOrder {
        /// About x, then y, then z.
        Xyz = "xyz";
        /// About x, then z, then y.
        Xzy = "xzy";
        /// About y, then x, then z.
        Yxz = "yxz";
        /// About y, then z, then x.
        Yzx = "yzx";
        /// About z, then x, then y.
        Zxy = "zxy";
        /// About z, then y, then x.
        Zyx = "zyx";
    }
}

table! {
    /// A value at a time.
    "key" pub MotionKey {
        /// Seconds from the start of the clip.
        at: Sp<f64> => Check::at_least(0.0).up_to(LONGEST);
        /// The value: a number, a list of three or four, or a color.
        value: Sp<KeyValue>;
        /// How fast the value changes there, in its unit a second, between "cubic" keys; by the neighbours when it is not
        /// written.
        slope: Option<Sp<KeyValue>>;
    }
}

table! {
    /// Something that happens at a time.
    "event" pub ClipEvent {
        /// Seconds from the start of the clip.
        at: Sp<f64> => Check::at_least(0.0).up_to(LONGEST);
        /// What happens.
        name: Sp<String>;
    }
}

/// One number, or three or four, or a color.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyValue {
    /// The numbers; those that are not written are 0.
    pub numbers: DVec4,
    /// How many are written.
    pub count: usize,
    /// Whether they are written as a color.
    pub is_color: bool,
}

impl Read for KeyValue {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if value.number().is_some() {
            return finite(value, reader).map(|one| Self {
                numbers: DVec4::new(one, 0.0, 0.0, 0.0),
                count: 1,
                is_color: false,
            });
        }
        if let Data::String(text) = &value.data
            && text.starts_with('#')
        {
            let count = if text.len() > 7 { 4 } else { 3 };
            return Color::read(value, reader).map(|color| Self {
                numbers: DVec4::from_array(color.linear),
                count,
                is_color: true,
            });
        }
        let read = read_numbers(value, 3, 4, "a number, a list of 3 or 4 numbers, or a color", reader)?;
        let last = read.get(3).copied().unwrap_or(0.0);
        let numbers = DVec4::new(read[0], read[1], read[2], last);
        Some(Self { numbers, count: read.len(), is_color: false })
    }

    fn schema(_: &mut Schemas) -> Json {
        let color = json!({ "type": "string", "pattern": "^#([0-9a-fA-F]{6}|[0-9a-fA-F]{8})$" });
        any_of(vec![or_expression("number"), numbers(3, 4), color])
    }
}

/// One formula or several.
#[derive(Clone, Debug, PartialEq)]
pub struct Formulas(pub Vec<Sp<Formula>>);

impl Formulas {
    /// Where the first is written.
    #[must_use]
    pub fn span(&self) -> Span {
        self.0.first().map_or(Span::NONE, |formula| formula.span)
    }
}

impl Read for Formulas {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if let Data::Array(items) = &value.data {
            if items.len() != 3 {
                let message =
                    format!("{} must be a formula or 3 of them, found {}", reader.place(), items.len());
                reader.report(Diagnostic::error(Code::WrongLength, message).at(value.span, "not 3"));
                return None;
            }
            return Vec::<Sp<Formula>>::read(value, reader).map(Self);
        }
        Sp::<Formula>::read(value, reader).map(|formula| Self(vec![formula]))
    }

    fn schema(schemas: &mut Schemas) -> Json {
        let one = Formula::schema(schemas);
        any_of(vec![one.clone(), json!({ "type": "array", "items": one, "minItems": 3, "maxItems": 3 })])
    }
}

/// A direction: the letter of an axis, or three numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction(pub DVec3);

impl Read for Direction {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if let Data::String(_) = &value.data {
            return choice(value, &["x", "y", "z"], reader).map(|letter| {
                Self(match letter {
                    "x" => DVec3::X,
                    "y" => DVec3::Y,
                    _ => DVec3::Z,
                })
            });
        }
        let read = read_numbers(value, 3, 3, "\"x\", \"y\", \"z\" or three numbers", reader)?;
        let direction = DVec3::new(read[0], read[1], read[2]);
        if direction == DVec3::ZERO {
            let message = format!("{} must be a direction, found [0, 0, 0]", reader.place());
            reader.report(Diagnostic::error(Code::OutOfRange, message).at(value.span, "no direction"));
            return None;
        }
        Some(Self(direction.normalize()))
    }

    fn schema(_: &mut Schemas) -> Json {
        let mut alternatives = one_of_words(&["x", "y", "z"]);
        alternatives.push(numbers(3, 3));
        any_of(alternatives)
    }
}

impl ClipTrack {
    fn check(&self, table: Span, reader: &mut Reader<'_>) -> bool {
        let targets = [
            self.node.as_ref().filter(|_| self.morph.is_none()).map(|node| ("node", node.span)),
            self.morph.as_ref().map(|morph| ("morph", morph.span)),
            self.joint.as_ref().map(|joint| ("joint", joint.span)),
            self.chain.as_ref().map(|chain| ("chain", chain.span)),
            self.material.as_ref().map(|material| ("material", material.span)),
        ];
        let laws = [
            self.keys.first().map(|key| ("keys", key.at.span)),
            self.formula.as_ref().map(|formula| ("formula", formula.span())),
            self.curve.as_ref().map(|curve| ("curve", curve.span())),
            self.speed.first().map(|key| ("speed", key.at.span)),
        ];
        let targeted = one_of(
            &targets,
            ("what moves", "`node`, `joint`, `chain`, `morph` or `material`"),
            (table, false),
            reader,
        );
        let free = self.along.is_some();
        let ruled = one_of(&laws, ("how it moves", "`keys`, `formula` or `curve`"), (table, free), reader);
        let whole = [
            self.path.as_ref().map(|path| ("path", path.span)),
            self.along.as_ref().map(|along| ("along", along.span())),
            self.axis.as_ref().map(|axis| ("axis", axis.span)),
            self.speed.first().map(|key| ("speed", key.at.span)),
        ];
        if let (Some(morph), Some((field, span))) = (&self.morph, whole.into_iter().flatten().next()) {
            let message = format!("a weight is one number and has no `{field}`");
            let report = Diagnostic::error(Code::Conflict, message)
                .at(span, "cannot stand beside `morph`")
                .also(morph.span, "the weight");
            reader.report(report);
            return false;
        }
        if let Some(report) = self.misplaced() {
            reader.report(report);
            return false;
        }
        let report = match (&self.along, &self.path) {
            (None, None) if self.morph.is_some() => return targeted && ruled,
            (None, None) => Diagnostic::error(Code::MissingField, "missing field `path` of track")
                .at(table, "needs `path`"),
            (Some(_), None) if self.material.is_some() => {
                Diagnostic::error(Code::MissingField, "missing field `path` of track")
                    .at(table, "needs `path`: \"color\" or \"emissive\"")
            }
            (Some(along), Some(path)) if !path.value.runs_along() => {
                Diagnostic::error(Code::Conflict, "a track along a curve moves the translation or a color")
                    .at(path.span, "cannot stand beside `along`")
                    .also(along.span(), "the curve")
            }
            _ => return targeted && ruled,
        };
        reader.report(report);
        false
    }

    /// What stands beside a path, a target or a law with which it says nothing.
    fn misplaced(&self) -> Option<Diagnostic> {
        if let (Some(key), None) = (self.speed.first(), &self.along) {
            let report =
                Diagnostic::error(Code::Conflict, "a speed is one along a curve, and this track has none")
                    .at(key.at.span, "along what?");
            return Some(report.help("write `along`, or `keys`, `formula` or `curve` in place of `speed`"));
        }
        let path = self.path.as_ref()?;
        let is_property = path.value.is_property();
        let other = [
            self.joint.as_ref().map(|joint| ("a joint", joint.span)),
            self.chain.as_ref().map(|chain| ("a chain", chain.span)),
        ];
        if let (true, Some((what, span))) = (is_property, other.into_iter().flatten().next()) {
            let message = format!("{what} has no `{}`", path.value.text());
            let report = Diagnostic::error(Code::NoProperty, message).at(path.span, "no such part");
            return Some(report.also(span, "it has translation, rotation and scale"));
        }
        if let (false, Some(material)) = (is_property, &self.material) {
            let message = format!("a material has no `{}`", path.value.text());
            let report =
                Diagnostic::error(Code::NoProperty, message).at(path.span, "materials stay in place");
            return Some(
                report.also(material.span, "the material").help("write `node` in place of `material`"),
            );
        }
        let turning = [
            self.axis.as_ref().map(|axis| ("axis", axis.span)),
            self.order.as_ref().map(|order| ("order", order.span)),
            self.up.as_ref().map(|up| ("up", up.span)),
        ];
        let (field, span) = turning.into_iter().flatten().next().filter(|_| is_property)?;
        let message = format!("`{}` is no motion and has no `{field}`", path.value.text());
        let report = Diagnostic::error(Code::Conflict, message).at(span, "cannot stand here");
        Some(report.also(path.span, "the property"))
    }
}

impl MotionPath {
    /// Whether it is no part of a node or joint, but a property of a material, light or camera.
    #[must_use]
    pub const fn is_property(self) -> bool {
        !matches!(self, Self::Translation | Self::Rotation | Self::Scale)
    }

    /// Whether it can go along a curve.
    #[must_use]
    pub const fn runs_along(self) -> bool {
        matches!(
            self,
            Self::Translation
                | Self::Color
                | Self::Emissive
                | Self::AttenuationColor
                | Self::SpecularColor
                | Self::SheenColor
        )
    }
}

/// Whether exactly one of several fields is written; none will do where the track is `free`.
fn one_of(
    fields: &[Option<(&str, Span)>],
    (what, list): (&str, &str),
    (table, free): (Span, bool),
    reader: &mut Reader<'_>,
) -> bool {
    let written: Vec<_> = fields.iter().flatten().collect();
    let report = match written.as_slice() {
        [_] => return true,
        [] if free => return true,
        [] => Diagnostic::error(Code::MissingField, format!("missing {list} of track"))
            .at(table, format!("{what} is not said")),
        [(one, first), (other, second), ..] => {
            let message = format!("`{one}` and `{other}` both say {what}");
            Diagnostic::error(Code::Conflict, message).at(*second, "said again").also(*first, "said here")
        }
    };
    reader.report(report);
    false
}
