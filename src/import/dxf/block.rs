//! Blocks in the places where they are inserted.

use std::collections::BTreeMap;

use glam::DAffine3;

use super::DxfFault;
use super::entity::{Block, Entity, Item, Kind, Parts};

/// How deep blocks may stand in each other.
pub(super) const DEEPEST: usize = 32;
/// The most points that blocks may make.
pub(super) const MOST_POINTS: u64 = 10_000_000;

/// All that is drawn, blocks in their places. What would be too much is refused before it is made.
pub(super) fn placed(parts: &Parts) -> Result<Vec<Item>, DxfFault> {
    let mut sizes = BTreeMap::new();
    let count = size(&parts.own, parts, &mut sizes, &mut Vec::new())?;
    if count > MOST_POINTS {
        return Err(DxfFault::TooMany { count });
    }
    let mut items = Vec::new();
    place(&parts.own, parts, (&DAffine3::IDENTITY, None), &mut items);
    Ok(items)
}

/// How many points entities make; those of each block are counted once.
fn size<'p>(
    entities: &'p [Entity],
    parts: &'p Parts,
    sizes: &mut BTreeMap<&'p str, u64>,
    within: &mut Vec<&'p str>,
) -> Result<u64, DxfFault> {
    let mut sum = 0_u64;
    for entity in entities {
        let own = match entity {
            Entity::Item(Item { kind: Kind::Faces { points, faces }, .. }) => {
                (points.len() + faces.iter().map(Vec::len).sum::<usize>()) as u64
            }
            Entity::Item(Item { kind: Kind::Curve { pieces, .. }, .. }) => {
                pieces.iter().map(super::Piece::size).sum()
            }
            Entity::Insert(insert) => {
                // A block that is not there draws nothing.
                let Some((name, block)) = parts.blocks.get_key_value(&insert.block) else { continue };
                if within.contains(&name.as_str()) {
                    return Err(DxfFault::Circle { block: name.clone() });
                }
                if within.len() >= DEEPEST {
                    return Err(DxfFault::Deep);
                }
                let known = sizes.get(name.as_str()).copied();
                let once = match known {
                    Some(known) => known,
                    None => {
                        within.push(name);
                        let found = size(&block.entities, parts, sizes, within)?;
                        within.pop();
                        sizes.insert(name, found);
                        found
                    }
                };
                let [columns, rows] = insert.counts.map(u64::from);
                // Even a block of nothing takes the time to place it.
                once.max(1).saturating_mul(columns).saturating_mul(rows)
            }
        };
        sum = sum.saturating_add(own);
    }
    Ok(sum)
}

fn place(entities: &[Entity], parts: &Parts, (map, layer): (&DAffine3, Option<&str>), items: &mut Vec<Item>) {
    // What a block has on layer 0 lies on the layer of its insert.
    let on = |own: &str| layer.filter(|_| own == "0").unwrap_or(own).to_owned();
    for entity in entities {
        match entity {
            Entity::Item(item) => {
                let kind = match &item.kind {
                    Kind::Faces { points, faces } => {
                        let points = points.iter().map(|point| map.transform_point3(*point)).collect();
                        let mut faces = faces.clone();
                        if map.matrix3.determinant() < 0.0 {
                            faces.iter_mut().for_each(|face| face.reverse());
                        }
                        Kind::Faces { points, faces }
                    }
                    Kind::Curve { pieces, closed } => {
                        let pieces = pieces.iter().map(|piece| piece.mapped(map)).collect();
                        Kind::Curve { pieces, closed: *closed }
                    }
                };
                items.push(Item { layer: on(&item.layer), kind });
            }
            Entity::Insert(insert) => {
                let Some(Block { base, entities }) = parts.blocks.get(&insert.block) else { continue };
                let layer = on(&insert.layer);
                for row in 0..insert.counts[1] {
                    for column in 0..insert.counts[0] {
                        let step = insert.steps[0] * f64::from(column) + insert.steps[1] * f64::from(row);
                        let at = DAffine3::from_translation(step) * insert.map;
                        let own = *map * at * DAffine3::from_translation(-*base);
                        place(entities, parts, (&own, Some(&layer)), items);
                    }
                }
            }
        }
    }
}
