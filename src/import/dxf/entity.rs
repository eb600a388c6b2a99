//! Entities of a drawing and of its blocks.

use std::collections::BTreeMap;

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::curve::{Piece, bulged};
use super::pairs::{Pair, Pairs};
use super::{DxfFault, Place};
use crate::geometry::number::{cos_degrees, sin_degrees};

/// What is read of a file.
#[derive(Default)]
pub(super) struct Parts {
    /// What stands in no block.
    pub(super) own: Vec<Entity>,
    /// Blocks by their names in upper case.
    pub(super) blocks: BTreeMap<String, Block>,
    /// How many entities of other kinds there are.
    pub(super) others: Vec<(String, usize)>,
}

/// A block.
#[derive(Default)]
pub(super) struct Block {
    /// What of it comes to lie at the place of an INSERT.
    pub(super) base: DVec3,
    pub(super) entities: Vec<Entity>,
}

/// What is drawn, on its layer.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Item {
    pub(super) layer: String,
    pub(super) kind: Kind,
}

/// What is drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    /// Faces over points.
    Faces { points: Vec<DVec3>, faces: Vec<Vec<u32>> },
    /// Pieces end to end.
    Curve { pieces: Vec<Piece>, closed: bool },
}

/// An entity.
pub(super) enum Entity {
    Item(Item),
    Insert(Insert),
}

/// A block in its places.
pub(super) struct Insert {
    pub(super) layer: String,
    pub(super) block: String,
    /// The map of the block's axes, without its base.
    pub(super) map: DAffine3,
    /// From column to column and from row to row, in the plane of the insert.
    pub(super) steps: [DVec3; 2],
    pub(super) counts: [u32; 2],
}

/// The pairs of an entity.
struct Raw<'b> {
    name: String,
    place: Place,
    pairs: Vec<Pair<'b>>,
}

impl Raw<'_> {
    fn find(&self, code: i32) -> Option<&Pair<'_>> {
        self.pairs.iter().find(|pair| pair.code == code)
    }

    fn number(&self, code: i32, otherwise: f64) -> Result<f64, DxfFault> {
        self.find(code).map_or(Ok(otherwise), Pair::number)
    }

    fn whole(&self, code: i32) -> Result<i64, DxfFault> {
        self.find(code).map_or(Ok(0), Pair::whole)
    }

    fn point(&self, code: i32) -> Result<DVec3, DxfFault> {
        Ok(DVec3::new(self.number(code, 0.0)?, self.number(code + 10, 0.0)?, self.number(code + 20, 0.0)?))
    }

    /// All points of a code, each begun by its x.
    fn points(&self, code: i32) -> Result<Vec<DVec3>, DxfFault> {
        let mut points: Vec<DVec3> = Vec::new();
        for pair in &self.pairs {
            if pair.code == code {
                points.push(DVec3::new(pair.number()?, 0.0, 0.0));
            } else if let Some(last) = points.last_mut() {
                match pair.code - code {
                    10 => last.y = pair.number()?,
                    20 => last.z = pair.number()?,
                    _ => {}
                }
            }
        }
        Ok(points)
    }

    fn numbers(&self, code: i32) -> Result<Vec<f64>, DxfFault> {
        self.pairs.iter().filter(|pair| pair.code == code).map(Pair::number).collect()
    }

    fn layer(&self) -> String {
        self.find(8).map_or_else(|| "0".to_owned(), Pair::text)
    }

    fn item(&self, kind: Kind) -> Entity {
        Entity::Item(Item { layer: self.layer(), kind })
    }

    fn curve(&self, pieces: Vec<Piece>, closed: bool) -> Option<Entity> {
        (!pieces.is_empty()).then(|| self.item(Kind::Curve { pieces, closed }))
    }

    /// The axes of an entity that lies in a plane of its own: the arbitrary axis algorithm of the DXF Reference.
    fn plane(&self) -> Result<DAffine3, DxfFault> {
        if self.find(210).is_none() && self.find(230).is_none() {
            return Ok(DAffine3::IDENTITY);
        }
        let Some(z) = self.point(210)?.try_normalize() else { return Ok(DAffine3::IDENTITY) };
        let near = z.x.abs() < 1.0 / 64.0 && z.y.abs() < 1.0 / 64.0;
        let x = if near { DVec3::Y } else { DVec3::Z }.cross(z).normalize();
        Ok(DAffine3::from_mat3(DMat3::from_cols(x, z.cross(x), z)))
    }

    fn refused<T>(&self, entity: &'static str, what: &'static str) -> Result<T, DxfFault> {
        Err(DxfFault::Entity { place: self.place, entity, what })
    }
}

/// Reads the blocks and entities.
pub(super) fn read(pairs: Pairs<'_>) -> Result<Parts, DxfFault> {
    let mut reader = Reader { pairs, next: None };
    let mut parts = Parts::default();
    let mut others: BTreeMap<String, usize> = BTreeMap::new();
    let (mut section, mut block) = (String::new(), None::<(String, Block)>);
    while let Some(raw) = reader.raw()? {
        match raw.name.as_str() {
            "SECTION" => section = raw.find(2).map_or_else(String::new, Pair::text),
            "ENDSEC" => section.clear(),
            "EOF" => {
                parts.others = others.into_iter().collect();
                return Ok(parts);
            }
            "BLOCK" if section == "BLOCKS" => {
                let name = raw.find(2).map_or_else(String::new, Pair::text).to_uppercase();
                block = Some((name, Block { base: raw.point(10)?, entities: Vec::new() }));
            }
            "ENDBLK" => parts.blocks.extend(block.take()),
            _ if section == "ENTITIES" || block.is_some() => {
                let name = raw.name.clone();
                let known = entity(raw, &mut reader)?;
                let Some(found) = known else {
                    *others.entry(name).or_default() += 1;
                    continue;
                };
                let into = block.as_mut().map_or(&mut parts.own, |(_, block)| &mut block.entities);
                into.extend(found);
            }
            _ => {}
        }
    }
    Err(DxfFault::Ends { place: reader.pairs.place(), what: "its sections, without `EOF`" })
}

/// Entities one after the other.
struct Reader<'b> {
    pairs: Pairs<'b>,
    /// The pair that begins the next entity.
    next: Option<Pair<'b>>,
}

impl<'b> Reader<'b> {
    fn raw(&mut self) -> Result<Option<Raw<'b>>, DxfFault> {
        let first = match self.next.take() {
            Some(pair) => Some(pair),
            None => self.pairs.next()?,
        };
        let Some(first) = first else { return Ok(None) };
        let name = if first.code == 0 { first.text() } else { String::new() };
        let mut raw = Raw { name, place: first.place, pairs: Vec::new() };
        while let Some(pair) = self.pairs.next()? {
            if pair.code == 0 {
                self.next = Some(pair);
                break;
            }
            raw.pairs.push(pair);
        }
        Ok(Some(raw))
    }

    /// What follows an entity until its end.
    fn below(&mut self, place: Place, what: &'static str) -> Result<Vec<Raw<'b>>, DxfFault> {
        let mut below = Vec::new();
        loop {
            match self.raw()? {
                Some(raw) if raw.name == "SEQEND" => return Ok(below),
                Some(raw) if matches!(raw.name.as_str(), "VERTEX" | "ATTRIB") => below.push(raw),
                _ => return Err(DxfFault::Ends { place, what }),
            }
        }
    }
}

/// What an entity is; none for kinds that are not read, an empty list for one that draws nothing.
fn entity<'b>(raw: Raw<'b>, reader: &mut Reader<'b>) -> Result<Option<Vec<Entity>>, DxfFault> {
    let made = match raw.name.as_str() {
        "3DFACE" | "SOLID" | "TRACE" => Some(face(&raw)?),
        "MESH" => Some(mesh(&raw)?),
        "LINE" => {
            let (from, to) = (raw.point(10)?, raw.point(11)?);
            raw.curve(if from == to { Vec::new() } else { vec![Piece::Line(from, to)] }, false)
        }
        "LWPOLYLINE" => light_polyline(&raw)?,
        "POLYLINE" => {
            let below = reader.below(raw.place, "a polyline")?;
            polyline(&raw, &below)?
        }
        "ARC" | "CIRCLE" => arc(&raw)?,
        "ELLIPSE" => ellipse(&raw)?,
        "SPLINE" => spline(&raw)?,
        "INSERT" => {
            if raw.whole(66)? == 1 {
                reader.below(raw.place, "an insert")?;
            }
            Some(Entity::Insert(insert(&raw)?))
        }
        _ => return Ok(None),
    };
    Ok(Some(made.into_iter().collect()))
}

fn face(raw: &Raw<'_>) -> Result<Entity, DxfFault> {
    let corners = [raw.point(10)?, raw.point(11)?, raw.point(12)?];
    let fourth = if raw.find(13).is_some() { raw.point(13)? } else { corners[2] };
    let [a, b, c] = corners;
    if raw.name == "3DFACE" {
        return Ok(raw.item(Kind::Faces { points: vec![a, b, c, fourth], faces: vec![vec![0, 1, 2, 3]] }));
    }
    // Corners of these run in a zigzag.
    let plane = raw.plane()?;
    let points = [a, b, fourth, c].map(|point| plane.transform_point3(point)).to_vec();
    Ok(raw.item(Kind::Faces { points, faces: vec![vec![0, 1, 2, 3]] }))
}

/// A mesh: points, then counts of corners and these.
fn mesh(raw: &Raw<'_>) -> Result<Entity, DxfFault> {
    let points = raw.points(10)?;
    let start = raw.pairs.iter().position(|pair| pair.code == 93).unwrap_or(raw.pairs.len());
    let size = raw.pairs.get(start).map_or(Ok(0), Pair::whole)?;
    let list = raw.pairs[start..].iter().skip(1).take_while(|pair| pair.code == 90).map(Pair::whole);
    let list: Vec<i64> = list.collect::<Result<_, _>>()?;
    let Some(list) = usize::try_from(size).ok().and_then(|size| list.get(..size)) else {
        return raw.refused("a MESH", "has fewer corners than it announces");
    };
    let (mut faces, mut at) = (Vec::new(), 0);
    while let Some(count) = list.get(at) {
        let end = usize::try_from(*count).ok().and_then(|count| (at + 1).checked_add(count));
        let Some(corners) = end.and_then(|end| list.get(at + 1..end)) else {
            return raw.refused("a MESH", "has a face of more corners than are left");
        };
        let corner = |index: &i64| corner(raw, "a MESH", *index, points.len());
        faces.push(corners.iter().map(corner).collect::<Result<Vec<u32>, _>>()?);
        at += 1 + corners.len();
    }
    Ok(raw.item(Kind::Faces { points, faces }))
}

fn corner(raw: &Raw<'_>, entity: &'static str, index: i64, count: usize) -> Result<u32, DxfFault> {
    let fault = DxfFault::Index { place: raw.place, entity, index, count };
    u32::try_from(index).ok().filter(|index| (*index as usize) < count).ok_or(fault)
}

fn light_polyline(raw: &Raw<'_>) -> Result<Option<Entity>, DxfFault> {
    let mut places: Vec<(DVec2, f64)> = Vec::new();
    for pair in &raw.pairs {
        match (pair.code, places.last_mut()) {
            (10, _) => places.push((DVec2::new(pair.number()?, 0.0), 0.0)),
            (20, Some((place, _))) => place.y = pair.number()?,
            (42, Some((_, bulge))) => *bulge = pair.number()?,
            _ => {}
        }
    }
    let height = raw.number(38, 0.0)?;
    flat(raw, &places, raw.whole(70)? & 1 != 0, height)
}

/// Lines and arcs in the plane of an entity at a height over its origin.
fn flat(
    raw: &Raw<'_>,
    places: &[(DVec2, f64)],
    closed: bool,
    height: f64,
) -> Result<Option<Entity>, DxfFault> {
    let map = raw.plane()? * DAffine3::from_translation(DVec3::Z * height);
    let pieces: Vec<Piece> = bulged(places, closed).iter().map(|piece| piece.mapped(&map)).collect();
    Ok(raw.curve(pieces, closed))
}

fn polyline(raw: &Raw<'_>, vertices: &[Raw<'_>]) -> Result<Option<Entity>, DxfFault> {
    let flags = raw.whole(70)?;
    let closed = flags & 1 != 0;
    let points: Vec<DVec3> = vertices.iter().map(|vertex| vertex.point(10)).collect::<Result<_, _>>()?;
    let marks: Vec<i64> = vertices.iter().map(|vertex| vertex.whole(70)).collect::<Result<_, _>>()?;
    // Points of the frame of a smoothed line are not on it.
    let on = |at: &usize| marks[*at] & 16 == 0;
    if flags & 64 != 0 {
        return polyface(raw, vertices, &points, &marks).map(Some);
    }
    if flags & 16 != 0 {
        let kept: Vec<DVec3> = (0..points.len()).filter(on).map(|at| points[at]).collect();
        return grid(raw, kept, closed, flags & 32 != 0).map(Some);
    }
    if flags & 8 != 0 {
        let mut kept: Vec<DVec3> = (0..points.len()).filter(on).map(|at| points[at]).collect();
        kept.extend(kept.first().copied().filter(|_| closed));
        let line = |pair: &[DVec3]| (pair[0] != pair[1]).then_some(Piece::Line(pair[0], pair[1]));
        return Ok(raw.curve(kept.windows(2).filter_map(line).collect(), closed));
    }
    let mut places = Vec::new();
    for at in (0..points.len()).filter(on) {
        places.push((points[at].truncate(), vertices[at].number(42, 0.0)?));
    }
    let height = raw.number(30, 0.0)?;
    flat(raw, &places, closed, height)
}

/// Points, then faces by their numbers from 1; of an edge that is not shown the number is negative.
fn polyface(
    raw: &Raw<'_>,
    vertices: &[Raw<'_>],
    points: &[DVec3],
    marks: &[i64],
) -> Result<Entity, DxfFault> {
    let places: Vec<DVec3> =
        points.iter().zip(marks).filter(|(_, mark)| *mark & 64 != 0).map(|(point, _)| *point).collect();
    let mut faces = Vec::new();
    for vertex in vertices.iter().zip(marks).filter(|(_, mark)| *mark & 192 == 128).map(|(vertex, _)| vertex)
    {
        let mut face = Vec::new();
        for code in 71..=74 {
            let number = vertex.whole(code)?.abs();
            if number != 0 {
                face.push(corner(vertex, "a polyface mesh", number - 1, places.len())?);
            }
        }
        // Of two corners it is a line, of one a point.
        if face.len() > 2 {
            faces.push(face);
        }
    }
    Ok(raw.item(Kind::Faces { points: places, faces }))
}

/// Rows of points.
fn grid(raw: &Raw<'_>, points: Vec<DVec3>, closed: bool, closed_across: bool) -> Result<Entity, DxfFault> {
    let smooth = raw.whole(75)? != 0;
    let [rows, columns] = if smooth { [73, 74] } else { [71, 72] }.map(|code| raw.whole(code));
    let size = |count: i64| usize::try_from(count).ok().filter(|count| (2..=points.len()).contains(count));
    let (Some(rows), Some(columns)) = (size(rows?), size(columns?)) else {
        return raw
            .refused("a polygon mesh", "has less than two rows or columns, or more than it has points");
    };
    if rows.checked_mul(columns) != Some(points.len()) {
        return raw.refused("a polygon mesh", "has another number of points than rows times columns");
    }
    let at =
        |row: usize, column: usize| crate::geometry::mesh::index((row % rows) * columns + column % columns);
    let mut faces = Vec::new();
    for row in 0..rows - usize::from(!closed) {
        for column in 0..columns - usize::from(!closed_across) {
            faces.push(vec![
                at(row, column),
                at(row, column + 1),
                at(row + 1, column + 1),
                at(row + 1, column),
            ]);
        }
    }
    Ok(raw.item(Kind::Faces { points, faces }))
}

fn arc(raw: &Raw<'_>) -> Result<Option<Entity>, DxfFault> {
    let radius = raw.number(40, 0.0)?;
    if radius <= 0.0 {
        return raw.refused("an arc or circle", "has no radius above 0");
    }
    let whole = raw.name == "CIRCLE";
    let from = if whole { 0.0 } else { raw.number(50, 0.0)? };
    let angles = DVec2::new(from, if whole { 360.0 } else { onward(from, raw.number(51, 360.0)?) });
    let (x, y) = (DVec3::X * radius, DVec3::Y * radius);
    let arc = Piece::Arc { center: raw.point(10)?, x, y, angles };
    Ok(raw.curve(vec![arc.mapped(&raw.plane()?)], whole))
}

/// The angle after another, at most a turn on.
fn onward(from: f64, to: f64) -> f64 {
    let way = (to - from).rem_euclid(360.0);
    from + if way <= 1e-9 { 360.0 } else { way }
}

fn ellipse(raw: &Raw<'_>) -> Result<Option<Entity>, DxfFault> {
    let x = raw.point(11)?;
    let across = if raw.find(210).is_some() { raw.point(210)? } else { DVec3::Z };
    let y = across.cross(x).normalize_or_zero() * x.length() * raw.number(40, 1.0)?;
    if x == DVec3::ZERO || y == DVec3::ZERO {
        return raw.refused("an ellipse", "has an axis without length");
    }
    let from = raw.number(41, 0.0)?.to_degrees();
    let to = onward(from, raw.number(42, std::f64::consts::TAU)?.to_degrees());
    let whole = to - from >= 360.0 - 1e-9;
    let angles = DVec2::new(from, if whole { from + 360.0 } else { to });
    Ok(raw.curve(vec![Piece::Arc { center: raw.point(10)?, x, y, angles }], whole))
}

fn spline(raw: &Raw<'_>) -> Result<Option<Entity>, DxfFault> {
    let (points, through) = (raw.points(10)?, raw.points(11)?);
    if points.is_empty() {
        let mut through = through;
        through.dedup();
        if through.len() < 2 {
            return raw.refused("a spline", "has fewer than two points");
        }
        return Ok(raw.curve(vec![Piece::Through(through)], false));
    }
    let degree = usize::try_from(raw.whole(71)?).unwrap_or(0);
    let knots = raw.numbers(40)?;
    if !(1..=25).contains(&degree) || points.len() <= degree {
        return raw.refused("a spline", "has a degree that is not from 1 to 25, or too few points for it");
    }
    if knots.len() != points.len() + degree + 1 || knots.windows(2).any(|pair| pair[1] < pair[0]) {
        return raw
            .refused("a spline", "has knots that fall, or another number of them than its points need");
    }
    let weights = raw.numbers(41)?;
    let weights = if weights.len() == points.len() { weights } else { vec![1.0; points.len()] };
    if weights.iter().any(|weight| *weight <= 0.0) {
        return raw.refused("a spline", "has a weight that is not above 0");
    }
    let closed = raw.whole(70)? & 1 != 0;
    Ok(raw.curve(vec![Piece::Spline { degree, knots, points, weights }], closed))
}

fn insert(raw: &Raw<'_>) -> Result<Insert, DxfFault> {
    let part = |code: i32| raw.number(code, 1.0);
    let scale = DVec3::new(part(41)?, part(42)?, part(43)?);
    let angle = raw.number(50, 0.0)?;
    let (sin, cos) = (sin_degrees(angle), cos_degrees(angle));
    let turn = DMat3::from_cols(DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0), DVec3::Z);
    let plane = raw.plane()?;
    let map = DAffine3 { matrix3: turn * DMat3::from_diagonal(scale), translation: raw.point(10)? };
    let steps = [DVec3::X * raw.number(44, 0.0)?, DVec3::Y * raw.number(45, 0.0)?];
    let count = |code: i32| {
        let count = raw.find(code).map_or(Ok(1), Pair::whole)?;
        Ok(u32::try_from(count.max(1)).unwrap_or(u32::MAX))
    };
    Ok(Insert {
        layer: raw.layer(),
        block: raw.find(2).map_or_else(String::new, Pair::text).to_uppercase(),
        map: plane * map,
        steps: steps.map(|step| plane.matrix3 * (turn * step)),
        counts: [count(70)?, count(71)?],
    })
}
