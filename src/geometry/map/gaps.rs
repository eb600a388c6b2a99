//! What stands in for samples without a value.

/// Gives each marked sample the mean of the known ones beside it, then of those that were just found, layer by layer. A
/// grid of marks alone becomes NaN.
pub(super) fn fill(columns: usize, values: &mut [f64], unknown: &[bool]) {
    let rows = values.len() / columns;
    let beside = |at: usize| {
        let (i, j) = (at % columns, at / columns);
        let left = (i > 0).then(|| at - 1);
        let right = (i + 1 < columns).then_some(at + 1);
        let up = (j > 0).then(|| at - columns);
        let down = (j + 1 < rows).then_some(at + columns);
        [left, right, up, down].into_iter().flatten()
    };
    let mut known: Vec<bool> = unknown.iter().map(|unknown| !unknown).collect();
    for (value, known) in values.iter_mut().zip(&known) {
        if !known {
            *value = f64::NAN;
        }
    }
    let mut queued = known.clone();
    let mut layer: Vec<usize> =
        (0..values.len()).filter(|at| !known[*at] && beside(*at).any(|at| known[at])).collect();
    layer.iter().for_each(|at| queued[*at] = true);
    while !layer.is_empty() {
        let mean = |at: &usize| {
            let (sum, count) = beside(*at)
                .filter(|at| known[*at])
                .fold((0.0, 0.0), |(sum, count), at| (sum + values[at], count + 1.0));
            sum / count
        };
        let found: Vec<f64> = layer.iter().map(mean).collect();
        let mut after = Vec::new();
        for (at, value) in layer.iter().zip(found) {
            values[*at] = value;
            known[*at] = true;
            for next in beside(*at) {
                if !queued[next] {
                    queued[next] = true;
                    after.push(next);
                }
            }
        }
        layer = after;
    }
}
