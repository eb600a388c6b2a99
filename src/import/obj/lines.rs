//! One pass over the lines of an OBJ file: everything is checked here, with line numbers.

use std::collections::HashMap;

use super::tags::{Tag, tag};
use crate::import::error::quoted;
use crate::import::{ImportError, Note};

/// What the parser does not keep of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct FaceRecord {
    /// Its corners.
    pub(super) corners: u32,
    /// Index into [`Scan::materials`].
    pub(super) material: Option<u32>,
    /// Smoothing group, 0 for none.
    pub(super) smoothing: u32,
}

/// The result of the pass.
#[derive(Debug, Default)]
pub(super) struct Scan {
    /// Lines `v`, `vt`, `vn` and `f` that are sure to parse.
    pub(super) clean: Vec<u8>,
    pub(super) faces: Vec<FaceRecord>,
    /// For each corner whether it has a texture coordinate, a normal.
    pub(super) has_uv: Vec<bool>,
    pub(super) has_normal: Vec<bool>,
    pub(super) materials: Vec<String>,
    pub(super) groups: Vec<String>,
    /// Material libraries with the lines that name them.
    pub(super) libraries: Vec<(u32, String)>,
    pub(super) has_smoothing: bool,
    /// For each corner its vertex, counted from 1.
    pub(super) vertices: Vec<u32>,
    /// Edges and vertices that tags say are sharp, counted from 0.
    pub(super) creases: Vec<([u32; 2], f64)>,
    pub(super) sharp_points: Vec<(u32, f64)>,
    pub(super) notes: Vec<Note>,
    /// Vertices whose numbers are wrong; only a face that uses one makes it an error.
    faults: Vec<ImportError>,
}

/// The kinds of elements that corners point to.
const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// State while reading.
#[derive(Default)]
struct Reader<'a> {
    scan: Scan,
    wanted: Option<&'a str>,
    line: u32,
    /// Elements of each kind so far.
    counts: [u32; 3],
    /// The largest index of each kind that points ahead, with its line.
    ahead: [Option<(u32, u32)>; 3],
    material: Option<u32>,
    material_numbers: HashMap<String, u32>,
    group_seen: HashMap<String, bool>,
    /// Whether faces of the current group and the current object are wanted.
    group_wanted: bool,
    object_wanted: bool,
    smoothing: u32,
    /// Keywords passed over: first line and count.
    passed_over: Vec<(&'static str, u32, u32)>,
}

impl Scan {
    /// Scans a file; only faces of group or object `wanted`, if that is given.
    pub(super) fn of(bytes: &[u8], wanted: Option<&str>) -> Result<Self, ImportError> {
        if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
            return Err(ImportError::Utf16);
        }
        let mut reader = Reader { wanted, ..Reader::default() };
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let mut rest = bytes;
        let mut next_line = 1;
        while !rest.is_empty() {
            reader.line = next_line;
            let (line, after, taken) = logical_line(rest);
            reader.read_line(&line)?;
            rest = after;
            next_line = next_line.saturating_add(taken);
        }
        reader.finish()
    }

    /// The fault of the vertex that [`Reader::spoil`] marked with this number.
    pub(super) fn fault(&self, number: f64) -> ImportError {
        let mut numbers = (0..self.faults.len()).zip(0_u32..);
        let found = numbers.find(|&(_, candidate)| f64::from(candidate) == number);
        found.map_or(ImportError::Refused { reason: "a vertex is not finite".to_owned() }, |(at, _)| {
            self.faults[at].clone()
        })
    }
}

/// The first logical line (a backslash at the end of a line joins the next to it), what follows, and how many lines
/// of the file it took. Lines end in LF, CR LF or CR.
fn logical_line(bytes: &[u8]) -> (std::borrow::Cow<'_, [u8]>, &[u8], u32) {
    let (line, mut rest) = physical_line(bytes);
    if !line.ends_with(b"\\") {
        return (line.into(), rest, 1);
    }
    let mut joined = line[..line.len() - 1].to_vec();
    let mut taken = 1;
    let mut more = true;
    while more && !rest.is_empty() {
        let (line, after) = physical_line(rest);
        more = line.ends_with(b"\\");
        joined.push(b' ');
        joined.extend_from_slice(line.strip_suffix(b"\\").unwrap_or(line));
        rest = after;
        taken += 1;
    }
    (joined.into(), rest, taken)
}

fn physical_line(bytes: &[u8]) -> (&[u8], &[u8]) {
    let end = bytes.iter().position(|&byte| byte == b'\n' || byte == b'\r').unwrap_or(bytes.len());
    let skip = match bytes.get(end..end + 2) {
        Some(b"\r\n") => 2,
        _ => usize::from(end < bytes.len()),
    };
    (&bytes[..end], &bytes[end + skip..])
}

/// The words of a line of numbers or corners, up to a comment.
fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    let end = line.iter().position(|&byte| byte == b'#').unwrap_or(line.len());
    line[..end].split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A finite number.
fn number(word: &[u8], line: u32, what: &'static str) -> Result<f64, ImportError> {
    let parsed: Option<f64> = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
    match parsed {
        Some(value) if value.is_finite() => Ok(value),
        Some(_) => Err(ImportError::NotFinite { line, text: quoted(word) }),
        None => Err(ImportError::BadNumber { line, what, text: quoted(word) }),
    }
}

impl Reader<'_> {
    fn read_line(&mut self, line: &[u8]) -> Result<(), ImportError> {
        if let Some(&byte) = line.iter().find(|&&byte| byte < b' ' && !byte.is_ascii_whitespace()) {
            return Err(ImportError::Binary { line: self.line, byte });
        }
        let line = line.trim_ascii();
        let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let (keyword, rest) = (&line[..end], line[end..].trim_ascii());
        match keyword {
            b"v" => self.vertex(rest),
            b"vt" => self.texture_coordinate(rest),
            b"vn" => self.normal(rest),
            b"f" | b"fo" => self.face(rest)?,
            b"s" => self.smoothing(rest),
            b"t" => self.tag(rest),
            b"g" | b"o" => self.group(keyword, rest),
            b"usemtl" => self.material(rest),
            b"mtllib" => self.scan.libraries.push((self.line, String::from_utf8_lossy(rest).into_owned())),
            _ if keyword.is_empty() || keyword.starts_with(b"#") => {}
            _ => self.pass_over(keyword),
        }
        Ok(())
    }

    fn vertex(&mut self, rest: &[u8]) {
        const AXES: [&str; 3] =
            ["the x coordinate of a vertex", "the y coordinate of a vertex", "the z coordinate of a vertex"];
        self.counts[0] = self.counts[0].saturating_add(1);
        let mut found = 0;
        let start = self.scan.clean.len();
        self.scan.clean.extend_from_slice(b"v");
        for word in words(rest) {
            if found < AXES.len() {
                if let Err(fault) = number(word, self.line, AXES[found]) {
                    return self.spoil(start, fault);
                }
                self.emit(word);
            }
            found += 1;
        }
        if found < AXES.len() {
            let fault = ImportError::TooFewNumbers {
                line: self.line,
                what: "a vertex",
                expected: 3,
                found: u32::try_from(found).unwrap_or(0),
            };
            return self.spoil(start, fault);
        }
        if found > AXES.len() {
            self.pass_over(b"v+");
        }
        self.scan.clean.push(b'\n');
    }

    /// Writes a vertex that cannot pass for a good one: x is infinite, y the number of its fault.
    fn spoil(&mut self, start: usize, fault: ImportError) {
        self.scan.clean.truncate(start);
        let marked = format!("v inf {} 0\n", self.scan.faults.len());
        self.scan.clean.extend_from_slice(marked.as_bytes());
        self.scan.faults.push(fault);
    }

    fn emit(&mut self, word: &[u8]) {
        self.scan.clean.push(b' ');
        self.scan.clean.extend_from_slice(word);
    }

    fn texture_coordinate(&mut self, rest: &[u8]) {
        self.counts[1] = self.counts[1].saturating_add(1);
        self.attribute(rest, b"vt", 2);
    }

    fn normal(&mut self, rest: &[u8]) {
        self.counts[2] = self.counts[2].saturating_add(1);
        self.attribute(rest, b"vn", 3);
    }

    /// A texture coordinate may have one number, the others are 0. An attribute that is not made of finite numbers
    /// becomes zero; a zero normal counts as none.
    fn attribute(&mut self, rest: &[u8], keyword: &'static [u8], numbers: usize) {
        let start = self.scan.clean.len();
        self.scan.clean.extend_from_slice(keyword);
        let mut found = 0;
        for word in words(rest).take(numbers) {
            if number(word, self.line, "").is_err() {
                break;
            }
            self.emit(word);
            found += 1;
        }
        let enough = if keyword == b"vt" { 1 } else { 3 };
        if found < enough {
            self.pass_over(if keyword == b"vt" { b"vt!" } else { b"vn!" });
            self.scan.clean.truncate(start + keyword.len());
            found = 0;
        }
        for _ in found..numbers {
            self.emit(b"0");
        }
        self.scan.clean.push(b'\n');
    }

    fn face(&mut self, rest: &[u8]) -> Result<(), ImportError> {
        let start = (self.scan.clean.len(), self.scan.has_uv.len());
        self.scan.clean.extend_from_slice(b"f");
        let mut corners = 0_u32;
        for word in words(rest) {
            self.corner(word)?;
            corners = corners.saturating_add(1);
        }
        let wanted = self.wanted.is_none() || self.group_wanted || self.object_wanted;
        if corners < 3 || !wanted {
            if corners < 3 {
                self.pass_over(b"f<3");
            }
            self.scan.clean.truncate(start.0);
            self.scan.has_uv.truncate(start.1);
            self.scan.has_normal.truncate(start.1);
            self.scan.vertices.truncate(start.1);
            return Ok(());
        }
        self.scan.clean.push(b'\n');
        self.scan.faces.push(FaceRecord { corners, material: self.material, smoothing: self.smoothing });
        if self.scan.has_uv.len() >= u32::MAX as usize {
            return Err(ImportError::TooMany { what: "corners of faces", limit: u32::MAX });
        }
        Ok(())
    }

    fn corner(&mut self, word: &[u8]) -> Result<(), ImportError> {
        let mut resolved = [0_u32; 3];
        for (kind, part) in word.split(|&byte| byte == b'/').enumerate() {
            if kind >= KINDS.len() || (part.is_empty() && kind == 0) {
                return Err(ImportError::BadCorner { line: self.line, text: quoted(word) });
            }
            if !part.is_empty() {
                resolved[kind] = self.index(kind, part, word)?;
            }
        }
        let [vertex, uv, normal] = resolved;
        if word.contains(&b'-') {
            let part = |index: u32| if index == 0 { String::new() } else { index.to_string() };
            let absolute = format!("{vertex}/{}/{}", part(uv), part(normal));
            self.emit(absolute.as_bytes());
        } else {
            self.emit(word);
        }
        self.scan.has_uv.push(uv != 0);
        self.scan.has_normal.push(normal != 0);
        self.scan.vertices.push(vertex);
        Ok(())
    }

    /// An index counted from 1. One that points ahead is checked at the end of the file.
    fn index(&mut self, kind: usize, part: &[u8], word: &[u8]) -> Result<u32, ImportError> {
        let (line, count) = (self.line, self.counts[kind]);
        let bad = || ImportError::BadCorner { line, text: quoted(word) };
        let digits = part.strip_prefix(b"-").or(part.strip_prefix(b"+")).unwrap_or(part);
        if digits.is_empty() || !digits.iter().all(u8::is_ascii_digit) {
            return Err(bad());
        }
        let text = std::str::from_utf8(part).map_err(|_| bad())?;
        // More digits than this are out of range whatever they say.
        let index: i128 = text.parse().unwrap_or(if part[0] == b'-' { i128::MIN } else { i128::MAX });
        let out_of_range = ImportError::IndexOutOfRange { line, what: KINDS[kind], index, count };
        if index == 0 {
            return Err(ImportError::IndexZero { line, text: quoted(word) });
        }
        let absolute = if index < 0 { index.saturating_add(i128::from(count) + 1) } else { index };
        let absolute = u32::try_from(absolute).map_err(|_| out_of_range.clone())?;
        if absolute == 0 {
            return Err(out_of_range);
        }
        if absolute > count && self.ahead[kind].is_none_or(|(_, largest)| absolute > largest) {
            self.ahead[kind] = Some((line, absolute));
        }
        Ok(absolute)
    }

    fn smoothing(&mut self, rest: &[u8]) {
        self.scan.has_smoothing = true;
        let text = std::str::from_utf8(rest).unwrap_or_default();
        self.smoothing = match text {
            "off" | "" => 0,
            "on" => 1,
            _ => text.parse().unwrap_or_else(|_| {
                self.pass_over(b"s");
                0
            }),
        };
    }

    fn group(&mut self, keyword: &[u8], rest: &[u8]) {
        let name = String::from_utf8_lossy(rest).into_owned();
        let wanted = self.wanted.is_some_and(|wanted| {
            name == wanted || (keyword == b"g" && name.split_whitespace().any(|part| part == wanted))
        });
        if keyword == b"g" {
            self.group_wanted = wanted;
        } else {
            self.object_wanted = wanted;
            self.group_wanted = false;
        }
        if !name.is_empty() && self.group_seen.insert(name.clone(), true).is_none() {
            self.scan.groups.push(name);
        }
    }

    fn material(&mut self, rest: &[u8]) {
        let name = String::from_utf8_lossy(rest).into_owned();
        if name.is_empty() {
            self.material = None;
            return;
        }
        let materials = &mut self.scan.materials;
        self.material = Some(*self.material_numbers.entry(name).or_insert_with_key(|name| {
            materials.push(name.clone());
            u32::try_from(materials.len() - 1).unwrap_or(u32::MAX)
        }));
    }

    fn tag(&mut self, rest: &[u8]) {
        match tag(words(rest)) {
            Some(Tag::Crease(edges)) => self.scan.creases.extend(edges),
            Some(Tag::Corner(vertices)) => self.scan.sharp_points.extend(vertices),
            Some(Tag::Other) => self.pass_over(b"t"),
            None => self.pass_over(b"t!"),
        }
    }

    /// Counts lines that are passed over, by what is said of them.
    fn pass_over(&mut self, keyword: &[u8]) {
        let what = match keyword {
            b"v+" => "vertex colors and weights are not read",
            b"vt!" => "a texture coordinate is not made of finite numbers; taken as 0, 0",
            b"vn!" => "a normal is not made of finite numbers; computed from the faces instead",
            b"f<3" => "a face with fewer than three corners was left out",
            b"s" => "a smoothing group is not a number; taken as off",
            b"t" => "tags other than `crease` and `corner` are not read",
            b"t!" => "a tag is broken; left out",
            b"p" => "points are not read",
            b"l" => "lines are not read",
            b"call" | b"csh" => "commands (`call`, `csh`) are not run",
            b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf" | b"parm"
            | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"cdc" | b"cdp" | b"bzp" | b"bsp"
            | b"res" => "free-form curves and surfaces are not read",
            b"mg" | b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"maplib" | b"usemap" | b"shadow_obj"
            | b"trace_obj" | b"ctech" | b"stech" | b"vc" => "display settings are not read",
            _ => "a keyword is not known",
        };
        match self.passed_over.iter_mut().find(|(known, ..)| *known == what) {
            Some((.., count)) => *count += 1,
            None => self.passed_over.push((what, self.line, 1)),
        }
    }

    /// Some programs write indices of texture coordinates or normals and then none of these at all.
    fn forget_missing_attributes(&mut self) {
        for (kind, what) in KINDS.into_iter().enumerate().skip(1) {
            if let Some((line, _)) = self.ahead[kind].filter(|_| self.counts[kind] == 0) {
                let has = if kind == 1 { &mut self.scan.has_uv } else { &mut self.scan.has_normal };
                has.fill(false);
                self.ahead[kind] = None;
                let message = format!("faces name {what}s, but the file has none");
                self.scan.notes.push(Note { line: Some(line), message });
            }
        }
    }

    fn finish(mut self) -> Result<Scan, ImportError> {
        self.forget_missing_attributes();
        for (kind, what) in KINDS.into_iter().enumerate() {
            let count = self.counts[kind];
            if let Some((line, index)) = self.ahead[kind]
                && index > count
            {
                return Err(ImportError::IndexOutOfRange { line, what, index: i128::from(index), count });
            }
        }
        if let Some(group) = self.wanted
            && self.scan.faces.is_empty()
        {
            let group = group.to_owned();
            let known = std::mem::take(&mut self.scan.groups);
            let named = |name: &String| *name == group || name.split_whitespace().any(|part| part == group);
            return Err(if known.iter().any(named) {
                ImportError::EmptyGroup { group }
            } else {
                ImportError::UnknownGroup { group, known }
            });
        }
        if self.scan.faces.is_empty() {
            return Err(ImportError::NoFaces { vertices: self.counts[0] });
        }
        for (what, line, count) in std::mem::take(&mut self.passed_over) {
            let message = if count == 1 { what.to_owned() } else { format!("{what} ({count} lines)") };
            self.scan.notes.push(Note { line: Some(line), message });
        }
        Ok(self.scan)
    }
}
