//! Numbers on the shown triangles, as colors for the page.

use serde_json::json;

use super::baked::Asset;
use crate::preview::heat::{Heat, HeatMap, Measured};
use crate::preview::{Moment, Stage};

/// What is drawn of an asset at a level of detail and a moment, with what is shown on it.
pub(super) fn heated(asset: &Asset, level: usize, moment: &Moment, heat: &Heat) -> Result<Stage, String> {
    let (drawn, _) = asset.drawn(level).map_err(str::to_owned)?;
    let mut stage = Stage::new(drawn, moment).map_err(|error| error.to_string())?;
    let deviations: &[Option<Measured>] = if *heat == Heat::Deviation { asset.deviations() } else { &[] };
    let map = HeatMap::new(heat, (drawn, &stage), deviations).map_err(|error| error.to_string())?;
    stage.heat = Some(map);
    Ok(stage)
}

/// The colors of a level of an asset at rest: a line of JSON, padded to a multiple of four bytes, that names the primitives by their
/// node and their number in its mesh, then for each triangle nine numbers (f32, little-endian), the linear colors of
/// its corners in the order of the file.
pub(super) fn colors(asset: &Asset, level: usize, heat: &Heat) -> Result<Vec<u8>, String> {
    const GRAY: [f32; 3] = [0.35; 3];
    const CORNERS: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let stage = heated(asset, level, &Moment::default(), heat)?;
    let (drawn, _) = asset.drawn(level).map_err(str::to_owned)?;
    let map = stage.heat.as_ref().ok_or("nothing was measured")?;
    let (mut pieces, mut numbers) = (Vec::new(), Vec::new());
    let (mut start, mut before, mut part) = (0, None, 0);
    for piece in &stage.pieces {
        part = if before == Some(piece.node) { part + 1 } else { 0 };
        before = Some(piece.node);
        let own = drawn.nodes[piece.node].mesh.and_then(|mesh| drawn.meshes[mesh].parts.get(part));
        for triangle in start..piece.end {
            // A node that mirrors shows its triangles turned around.
            let shown = stage.triangles[triangle];
            let step = |corners: [u32; 3]| i64::from(corners[1]) - i64::from(corners[0]);
            let same = own.is_none_or(|own| step(own.triangles[triangle - start]) == step(shown));
            for corner in if same { [0, 1, 2] } else { [0, 2, 1] } {
                let name = crate::geometry::number::count_of(triangle);
                let color = map.color(name, CORNERS[corner]).map_or(GRAY, |color| color.to_array());
                numbers.extend(color.iter().flat_map(|part| part.to_le_bytes()));
            }
        }
        pieces.push(json!({ "node": piece.node, "part": part, "triangles": piece.end - start }));
        start = piece.end;
    }
    let head = json!({
        "title": heat.title(), "low": map.low, "high": map.high, "greatest": map.greatest, "pieces": pieces,
    });
    let mut bytes = head.to_string().into_bytes();
    // The line ends where a number may begin.
    bytes.resize((bytes.len() + 1).next_multiple_of(4) - 1, b' ');
    bytes.push(b'\n');
    bytes.extend(numbers);
    Ok(bytes)
}
