//! The twist at a corner where two cross-boundary derivatives disagree about it.
//!
//! Source: J. A. Gregory, Smooth interpolation without twist constraints, in R. Barnhill, R. Riesenfeld (ed.),
//! Computer Aided Geometric Design, 1974: T = (u b + v a) / (u + v), where a is the twist by the derivative
//! across v = 0 and b that by the one across u = 0. With their mean m and half difference d = (b - a) / 2 it is
//! T - m = d (u - v) / (u + v), which enters the surface times G(u) G(v) with G(t) = t (1 - t)^2.
//!
//! u v (u - v) / (u + v) has bounded second derivatives, which are cubics of w = u / (u + v):
//! 4 (1 - w)^3 by u twice, 6 w^2 - 4 w^3 - 1 mixed, -4 w^3 by v twice.

/// The product G(u) G(v) (u - v) / (u + v) with its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Correction {
    pub(super) value: f64,
    pub(super) u: f64,
    pub(super) v: f64,
    pub(super) uu: f64,
    pub(super) uv: f64,
    pub(super) vv: f64,
}

/// The correction at distances `u` and `v` (0 to 1) from the corner.
pub(super) fn correction(u: f64, v: f64) -> Correction {
    let sum = u + v;
    // At the corner itself the second derivatives depend on the way there; along the diagonal they are these.
    let w = if sum > 0.0 { u / sum } else { 0.5 };
    let away = 1.0 - w;
    // p = u v (u - v) / (u + v).
    let ratio = w - away;
    let p = u * v * ratio;
    let p_u = v * ratio + 2.0 * u * away * away;
    let p_v = u * ratio - 2.0 * v * w * w;
    let (p_uu, p_uv, p_vv) = (4.0 * away * away * away, w * w * (6.0 - 4.0 * w) - 1.0, -4.0 * w * w * w);
    // (1 - t)^2 and its derivatives.
    let fade = |t: f64| ((1.0 - t) * (1.0 - t), -2.0 * (1.0 - t), 2.0);
    let ((a, a1, a2), (b, b1, b2)) = (fade(u), fade(v));
    Correction {
        value: a * b * p,
        u: b * (a1 * p + a * p_u),
        v: a * (b1 * p + b * p_v),
        uu: b * (a2 * p + 2.0 * a1 * p_u + a * p_uu),
        uv: a1 * b1 * p + a1 * b * p_v + a * b1 * p_u + a * b * p_uv,
        vv: a * (b2 * p + 2.0 * b1 * p_v + b * p_vv),
    }
}

/// An interval.
type Range = (f64, f64);

/// Intervals of the second derivatives (twice by u, mixed, twice by v) over a rectangle.
pub(super) fn second_ranges(u: Range, v: Range) -> [Range; 3] {
    let w = share(u, v);
    let away = (1.0 - w.1, 1.0 - w.0);
    let ratio = (w.0 - away.1, w.1 - away.0);
    let p = times(times(u, v), ratio);
    let p_u = plus(times(v, ratio), scale(times(u, times(away, away)), 2.0));
    let p_v = plus(times(u, ratio), scale(times(v, times(w, w)), -2.0));
    let cube = |(low, high): Range| (low * low * low, high * high * high);
    // 6 w^2 - 4 w^3 - 1 grows from 0 to 1.
    let mixed = |w: f64| w * w * (6.0 - 4.0 * w) - 1.0;
    let (p_uu, p_uv, p_vv) = (scale(cube(away), 4.0), (mixed(w.0), mixed(w.1)), scale(cube(w), -4.0));
    let fade = |(low, high): Range| {
        let (a, b) = (1.0 - high, 1.0 - low);
        ((a * a, b * b), (-2.0 * b, -2.0 * a))
    };
    let ((a, a1), (b, b1)) = (fade(u), fade(v));
    let along = |faded: Range, slope: Range, p_first: Range, p_second: Range| {
        plus(scale(p, 2.0), plus(scale(times(slope, p_first), 2.0), times(faded, p_second)))
    };
    let crossed = plus(
        plus(times(times(a1, b1), p), times(times(a1, b), p_v)),
        plus(times(times(a, b1), p_u), times(times(a, b), p_uv)),
    );
    [times(b, along(a, a1, p_u, p_uu)), crossed, times(a, along(b, b1, p_v, p_vv))]
}

/// The interval of u / (u + v).
fn share(u: Range, v: Range) -> Range {
    let ratio = |part: f64, other: f64, empty: f64| {
        let sum = part + other;
        if sum > 0.0 { part / sum } else { empty }
    };
    (ratio(u.0, v.1, 0.0), ratio(u.1, v.0, 1.0))
}

fn plus(a: Range, b: Range) -> Range {
    (a.0 + b.0, a.1 + b.1)
}

fn scale(a: Range, factor: f64) -> Range {
    if factor < 0.0 { (a.1 * factor, a.0 * factor) } else { (a.0 * factor, a.1 * factor) }
}

/// The interval of products.
pub(super) fn times(a: Range, b: Range) -> Range {
    let products = [a.0 * b.0, a.0 * b.1, a.1 * b.0, a.1 * b.1];
    (
        products.into_iter().fold(f64::INFINITY, f64::min),
        products.into_iter().fold(f64::NEG_INFINITY, f64::max),
    )
}

#[cfg(test)]
mod tests {
    use super::{correction, second_ranges};

    #[test]
    fn derivatives_are_limits_of_differences() {
        let h = 1e-5;
        for a in 1..10 {
            for b in 1..10 {
                let (u, v) = (f64::from(a) / 10.0, f64::from(b) / 10.0);
                let here = correction(u, v);
                let by_u = |f: fn(f64, f64) -> f64| (f(u + h, v) - f(u - h, v)) / (2.0 * h);
                let by_v = |f: fn(f64, f64) -> f64| (f(u, v + h) - f(u, v - h)) / (2.0 * h);
                let differences = [
                    (by_u(|u, v| correction(u, v).value), here.u),
                    (by_v(|u, v| correction(u, v).value), here.v),
                    (by_u(|u, v| correction(u, v).u), here.uu),
                    (by_v(|u, v| correction(u, v).u), here.uv),
                    (by_u(|u, v| correction(u, v).v), here.uv),
                    (by_v(|u, v| correction(u, v).v), here.vv),
                ];
                for (index, (difference, derivative)) in differences.into_iter().enumerate() {
                    assert!((difference - derivative).abs() < 1e-8, "{index} at {u} {v}");
                }
            }
        }
    }

    #[test]
    fn ranges_hold_second_derivatives_at_the_corner_too() {
        for (u, v) in [((0.0, 0.1), (0.0, 0.1)), ((0.0, 0.3), (0.2, 0.3)), ((0.5, 1.0), (0.0, 1.0))] {
            let ranges = second_ranges(u, v);
            for a in 0..=20 {
                for b in 0..=20 {
                    let x = u.0 + (u.1 - u.0) * f64::from(a) / 20.0;
                    let y = v.0 + (v.1 - v.0) * f64::from(b) / 20.0;
                    let at = correction(x, y);
                    for (range, value) in ranges.iter().zip([at.uu, at.uv, at.vv]) {
                        assert!(range.0 - 1e-12 <= value && value <= range.1 + 1e-12, "{x} {y}");
                    }
                }
            }
        }
    }
}
