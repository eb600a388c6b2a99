//! What lies between the lines that meet in a corner, and which of it is cut off so that nothing touches itself there.

use glam::DVec2;

use super::delaunay::{BORDER, Delaunay, next, previous};

/// What lies between two lines at a corner, or between a line and the border.
#[derive(Clone, Copy)]
pub(super) struct Sector {
    pub(super) below: bool,
    /// The other ends of what bounds it, counter-clockwise.
    pub(super) ends: [u32; 2],
    /// Whether that is the border, without a line.
    pub(super) on_border: [bool; 2],
    /// Greater for narrower ones.
    narrow: f64,
}

/// The sectors of a line at a corner, counter-clockwise; on the border from one side of it to the other.
pub(super) fn sectors(mesh: &Delaunay, sides: &[u32], corner: u32, bit: u32) -> Vec<Sector> {
    let around = mesh.around(corner);
    let border = mesh.beyond(around[0]) == BORDER;
    let end = |edge: u32| mesh.corners[next(edge) as usize];
    // Each with the side of the line after it.
    let mut spokes: Vec<(u32, bool, bool)> = (around.iter().enumerate())
        .filter(|(k, edge)| mesh.line(**edge) & bit != 0 || (border && *k == 0))
        .map(|(_, edge)| (end(*edge), sides[*edge as usize / 3] & bit == 0, mesh.line(*edge) & bit == 0))
        .collect();
    if border {
        let last = previous(around[around.len() - 1]);
        spokes.push((mesh.corners[last as usize], false, mesh.line(last) & bit == 0));
    } else if let Some(first) = spokes.first().copied() {
        spokes.push(first);
    }
    let at = |corner: u32| DVec2::from_array(mesh.places[corner as usize].map(f64::from));
    let way = |end: u32| (at(end) - at(corner)).normalize_or(DVec2::X);
    let sector = |pair: &[(u32, bool, bool)]| {
        let ends = [pair[0].0, pair[1].0];
        let [from, to] = ends.map(way);
        let narrow = if from.perp_dot(to) > 0.0 { from.dot(to) } else { f64::NEG_INFINITY };
        Sector { below: pair[0].1, ends, on_border: [pair[0].2, pair[1].2], narrow }
    };
    spokes.windows(2).map(sector).collect()
}

/// The sectors below a line whose corners are cut off, so that neither what is above nor what is below meets itself
/// there: all but the widest. On the border one may be left only beside it, else what is above would still meet itself.
pub(super) fn cut_sectors(sectors: &[Sector]) -> Vec<Sector> {
    let count = |below: bool| sectors.iter().filter(|sector| sector.below == below).count();
    if count(true) < 2 && count(false) < 2 {
        return Vec::new();
    }
    let last = sectors.len() - 1;
    let border = sectors[0].ends[0] != sectors[last].ends[1];
    let may_stay = |k: usize| sectors[k].below && (!border || k == 0 || k == last);
    let spared =
        (0..=last).filter(|k| may_stay(*k)).min_by(|a, b| sectors[*a].narrow.total_cmp(&sectors[*b].narrow));
    (0..=last).filter(|k| sectors[*k].below && Some(*k) != spared).map(|k| sectors[k]).collect()
}
