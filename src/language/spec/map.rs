//! Maps: numbers over a rectangle, for heights and masks.

use glam::{DVec2, DVec3};
use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, kinds, table};
use crate::language::spec::formula::Formula;
use crate::language::spec::grid::Rows;
use crate::language::spec::import::FilePath;
use crate::language::spec::kind::{Kinds, take_kind};
use crate::language::spec::reader::{Fields, Read, Reader};
use crate::language::spec::reference::MapReference;
use crate::language::spec::scalar::finite;
use crate::language::spec::schema::Schemas;
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value, show_number};

/// A map: its kind and the fields that all kinds have.
#[derive(Clone, Debug, PartialEq)]
pub struct MapDefinition {
    /// What is common to all kinds.
    pub options: MapOptions,
    /// What it is.
    pub kind: Map,
}

table! {
    /// Fields of every map, beside the table of its kind.
    "map" pub MapOptions {
        /// What stands between the samples.
        interpolation: Sp<Between> = Between::Bilinear;
        /// Which samples have no value: `"marked"` for those that the file itself marks and numbers that are not finite,
        /// or a number for those that have it as well. There the map has holes, which run along the grid. Without it,
        /// samples without a value are errors.
        no_data: Option<Sp<NoData>>;
    }
}

/// Which samples of a map have no value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoData {
    /// Those that the file marks, and what is no finite number.
    Marked,
    /// Those of a number too.
    Number(f64),
}

choices! {
    /// How a map goes on between its samples.
    Between {
        /// Straight along rows and columns, with faint edges along them.
        Bilinear = "bilinear";
        /// A smooth surface through all samples: the cubic spline, twice continuously differentiable. It may swing a
        /// little beyond the samples.
        Bicubic = "bicubic";
    }
}

kinds! {
    /// A map of one kind.
    "map" Map {
        /// A grey picture.
        Image(MapImage) = "image";
        /// A file of bare numbers.
        Raw(MapRaw) = "raw";
        /// Numbers written out, or an ASCII grid.
        Grid(MapGrid) = "grid";
        /// Scattered points.
        Points(MapPoints) = "points";
        /// A formula of x and y.
        Formula(MapFormula) = "formula";
        /// Hills by chance, the same on every machine.
        Noise(MapNoise) = "noise";
        /// Several maps in one.
        Combine(MapCombine) = "combine";
    }
}

table! {
    /// A grey PNG picture of 8 or 16 bits: black is 0, white is 1. Each pixel is a sample; the upper left one is the
    /// first of the first row. 8 bits give 256 steps, which show on smooth ground: use 16 for heights.
    "map image" pub MapImage {
        /// The file; the path is relative to this document and stays inside the project.
        file: Sp<FilePath>;
    }
}

table! {
    /// A file of bare numbers, row by row, little-endian, without a header of its own.
    "map raw" pub MapRaw {
        /// The file; the path is relative to this document and stays inside the project.
        file: Sp<FilePath>;
        /// Numbers in a row.
        columns: Sp<u32> => Check::at_least(1.0);
        /// Rows.
        rows: Sp<u32> => Check::at_least(1.0);
        /// What the numbers are. They are taken as they stand.
        number: Sp<RawNumber> = RawNumber::U16;
        /// Bytes before the first number.
        skip: Sp<u64> = 0_u64;
    }
}

choices! {
    /// Numbers of a raw file.
    RawNumber {
        /// Whole numbers of 8 bits, from 0 to 255.
        U8 = "u8";
        /// Whole numbers of 16 bits, from 0 to 65535.
        U16 = "u16";
        /// Whole numbers of 16 bits with a sign.
        I16 = "i16";
        /// Floating point of 32 bits.
        F32 = "f32";
        /// Floating point of 64 bits.
        F64 = "f64";
    }
}

table! {
    /// A grid of numbers: written out in `rows`, or an ESRI ASCII grid (`.asc`) as `file`.
    "map grid" pub MapGrid {
        /// The numbers, row by row; the first row lies at -z, the first number of each at -x.
        rows: Option<Sp<Rows<f64>>>;
        /// The file; the path is relative to this document and stays inside the project.
        file: Option<Sp<FilePath>>;
    }
    checked check
}

table! {
    /// A map through scattered points with known values.
    "map points" pub MapPoints {
        /// The points, `[x, y, value]`; x runs with the columns, y with the rows.
        points: Vec<Sp<DVec3>> => Check::items(3);
        /// How the map goes on between points.
        method: Sp<Scatter> = Scatter::NaturalNeighbor;
        /// Where the map begins, `[x, y]`; the least of the points when it is not written.
        from: Option<Sp<DVec2>>;
        /// Where the map ends, `[x, y]`; the greatest of the points when it is not written.
        to: Option<Sp<DVec2>>;
        /// Samples in a row.
        columns: Sp<u32> = 129_u32 => Check::at_least(2.0);
        /// Rows of samples.
        rows: Sp<u32> = 129_u32 => Check::at_least(2.0);
    }
}

choices! {
    /// How a map goes on between scattered points.
    Scatter {
        /// Flat triangles between neighbors.
        Linear = "linear";
        /// Smooth but at the points themselves, which it passes through without swinging beyond them.
        NaturalNeighbor = "natural-neighbor";
        /// Means of all points, weighted by the inverse squares of their distances.
        Shepard = "shepard";
    }
}

table! {
    /// A formula of the variables x and y, taken at so many columns and rows. Angles are in degrees.
    "map formula" pub MapFormula {
        /// The formula.
        f: Sp<Formula>;
        /// x and y of the first sample.
        from: Sp<DVec2> = DVec2::ZERO;
        /// x and y of the last sample.
        to: Sp<DVec2> = DVec2::ONE;
        /// Samples in a row.
        columns: Sp<u32> = 129_u32 => Check::at_least(2.0);
        /// Rows of samples.
        rows: Sp<u32> = 129_u32 => Check::at_least(2.0);
    }
    checked check
}

table! {
    /// Hills and hollows by chance, from -1 to 1 around 0: layers of noise, each finer and flatter than the one before.
    "map noise" pub MapNoise {
        /// Another number gives another landscape.
        seed: Sp<f64> = 0.0;
        /// About how many hills lie side by side along x and along y, in the first layer.
        hills: Sp<DVec2> = DVec2::splat(4.0) => Check::above(0.0).up_to(65536.0);
        /// Layers.
        octaves: Sp<u32> = 5_u32 => Check::within(1.0, 16.0);
        /// How much flatter each layer is than the one before; layers are twice as fine.
        gain: Sp<f64> = 0.5 => Check::within(0.0, 1.0);
        /// Samples in a row.
        columns: Sp<u32> = 129_u32 => Check::at_least(2.0);
        /// Rows of samples.
        rows: Sp<u32> = 129_u32 => Check::at_least(2.0);
    }
}

table! {
    /// Several maps, sample by sample, on the grid of the first. Others are stretched over it.
    "map combine" pub MapCombine {
        /// The maps: their names, or maps in place.
        of: Vec<MapReference> => Check::items(2);
        /// What is done with their values.
        operation: Sp<MapOperation> = MapOperation::Add;
        /// A factor for each map, before anything else is done; 1 when they are not written.
        weights: Option<Sp<Vec<f64>>>;
    }
    checked check
}

choices! {
    /// What is done with the values of maps.
    MapOperation {
        /// Their sum.
        Add = "add";
        /// The first less all others.
        Subtract = "subtract";
        /// Their product.
        Multiply = "multiply";
        /// The least.
        Min = "min";
        /// The greatest.
        Max = "max";
    }
}

impl Read for NoData {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        match &value.data {
            Data::String(word) if word.as_str() == "marked" => Some(Self::Marked),
            _ if value.number().is_some() => finite(value, reader).map(Self::Number),
            _ => {
                reader.mismatch(value, "\"marked\", or the number that stands for no value");
                None
            }
        }
    }

    fn schema(_: &mut Schemas) -> Json {
        json!({ "anyOf": [{ "const": "marked" }, { "type": ["number", "string"] }] })
    }
}

impl MapGrid {
    fn check(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        let report = match (&self.rows, &self.file) {
            (Some(_), None) | (None, Some(_)) => return true,
            (Some(rows), Some(file)) => {
                Diagnostic::error(Code::Conflict, "a grid has either `rows` or a `file`")
                    .at(file.span, "cannot stand beside `rows`")
                    .also(rows.span, "the numbers")
            }
            (None, None) => {
                Diagnostic::error(Code::MissingField, "missing field `rows` or `file` of map grid")
                    .at(span, "no numbers")
                    .help("write `rows = [[0, 1], [1, 2]]`, or `file = \"hills.asc\"`")
            }
        };
        reader.report(report);
        false
    }
}

impl MapFormula {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let (from, to) = (self.from.value, self.to.value);
        if from.x != to.x && from.y != to.y {
            return true;
        }
        let (axis, at) = if from.x == to.x { ("x", from.x) } else { ("y", from.y) };
        let message = format!("`from` and `to` must differ in {axis}, found {} in both", show_number(at));
        reader.report(
            Diagnostic::error(Code::OutOfRange, message)
                .at(self.to.span, "spans no area")
                .also(self.from.span, "the start"),
        );
        false
    }
}

impl MapCombine {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let Some(weights) = &self.weights else { return true };
        if weights.len() == self.of.len() {
            return true;
        }
        let message = format!("`weights` has {} numbers for {} maps", weights.len(), self.of.len());
        reader.report(Diagnostic::error(Code::WrongCount, message).at(weights.span, "one for each map"));
        false
    }
}

impl Read for MapDefinition {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let mut fields = Fields::open(value, "map", reader)?;
        let options = MapOptions::take(&mut fields, reader);
        let kind = take_kind::<Map>(&mut fields, reader);
        let closed = fields.close(reader);
        match (options, kind, closed) {
            (Some(options), Some(kind), true) => Some(Self { options, kind }),
            _ => None,
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        let doc = "A map: one kind, and beside it the fields that every map has.";
        schemas.object("map", doc, |object, schemas| {
            MapOptions::describe(object, schemas);
            Map::describe_kinds(object, schemas);
        })
    }
}
