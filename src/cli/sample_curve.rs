//! What `kiln sample` says of a curve.

use glam::DVec3;
use serde_json::{Map, Value, json};

use crate::geometry::curve::control::coefficients;
use crate::geometry::curve::{
    AnyCurve, BezierSpline, Curve, Jet, Meeting, RationalSpline, Side, length, lengths_at,
};

/// Domain, length, samples with derivatives and arc length, how the pieces meet, and their coefficients.
pub(super) fn describe(name: &str, curve: &AnyCurve, places: &[f64]) -> Value {
    let domain = curve.domain();
    let lengths = lengths_at(curve, places);
    let samples = places.iter().zip(lengths).map(|(t, reached)| {
        let jet = curve.evaluate(*t, if *t >= domain.end { Side::Before } else { Side::After });
        json!({
            "t": t,
            "point": numbers(jet.point),
            "first": numbers(jet.first),
            "second": numbers(jet.second),
            "length": reached,
            "curvature": curvature(&jet),
        })
    });
    let samples: Vec<Value> = samples.collect();
    let whole = length(curve);
    let mut object = Map::new();
    let mut put = |key: &str, value: Value| object.insert(key.to_owned(), value);
    put("curve", json!(name));
    put("domain", json!([domain.start, domain.end]));
    put("closed", json!(curve.is_closed()));
    put("length", json!(whole));
    put("joints", json!(curve.joints()));
    put("breaks", breaks(curve, whole));
    if curve.is_closed() {
        put("seam", continuity(curve, domain.end, domain.start, whole));
    }
    match curve {
        AnyCurve::Bezier(spline) => {
            put("coefficients", polynomials(spline));
            if let Some(pieces) = function(spline) {
                put("function", pieces);
            }
        }
        AnyCurve::Rational(spline) => {
            put("coefficients", homogeneous(spline));
        }
        _ => {}
    }
    put("samples", json!(samples));
    Value::Object(object)
}

fn numbers(vector: DVec3) -> Value {
    json!(vector.to_array())
}

/// Nothing where the curve stands still.
fn curvature(jet: &Jet) -> Value {
    let speed = jet.first.length();
    let curvature = jet.first.cross(jet.second).length() / (speed * speed * speed);
    if curvature.is_finite() { json!(curvature) } else { Value::Null }
}

/// Each place where pieces meet, and how well they do.
fn breaks(curve: &AnyCurve, size: f64) -> Value {
    let places = curve.breaks().into_iter();
    places.map(|t| json!({ "t": t, "continuity": continuity(curve, t, t, size) })).collect()
}

fn continuity(curve: &AnyCurve, before: f64, after: f64, size: f64) -> Value {
    json!(Meeting::of(curve, before, after, size).continuity().to_string())
}

/// Coefficients of 1, (t - from), (t - from)^2, ... of each piece.
fn polynomials(spline: &BezierSpline) -> Value {
    let piece = |(index, ends): (usize, &[f64])| {
        let powers = coefficients(spline.piece(index), ends[1] - ends[0]);
        let powers: Vec<Value> = powers.into_iter().map(numbers).collect();
        json!({ "from": ends[0], "to": ends[1], "powers": powers })
    };
    spline.knots().windows(2).enumerate().map(piece).collect()
}

/// The same of a rational curve: (w x, w y, w z, w).
fn homogeneous(spline: &RationalSpline) -> Value {
    let piece = |(index, ends): (usize, &[f64])| {
        let powers = coefficients(spline.piece(index), ends[1] - ends[0]);
        let powers: Vec<Value> = powers.into_iter().map(|power| json!(power.to_array())).collect();
        json!({ "from": ends[0], "to": ends[1], "powers": powers })
    };
    spline.knots().windows(2).enumerate().map(piece).collect()
}

/// The pieces y = a + b (x - from) + c (x - from)^2 + d (x - from)^3 of a cubic curve (x, y(x)) whose parameter is x.
fn function(spline: &BezierSpline) -> Option<Value> {
    const ROUNDING: f64 = 1e-9;
    let names = ["a", "b", "c", "d"];
    let mut pieces = Vec::new();
    for (index, ends) in spline.knots().windows(2).enumerate() {
        let step = ends[1] - ends[0];
        let powers = coefficients(spline.piece(index), step);
        let reach = ends[0].abs().max(ends[1].abs());
        let linear = |k: usize| if k == 0 { ends[0] } else { f64::from(u8::from(k == 1)) };
        let mut scale = 1.0;
        for (k, power) in powers.iter().enumerate() {
            let apart = (power.x - linear(k)).abs() * scale;
            if apart > ROUNDING * reach || power.z != 0.0 || k >= names.len() {
                return None;
            }
            scale *= step;
        }
        let mut piece =
            Map::from_iter([("from".to_owned(), json!(ends[0])), ("to".to_owned(), json!(ends[1]))]);
        piece.extend(names.iter().zip(&powers).map(|(name, power)| ((*name).to_owned(), json!(power.y))));
        pieces.push(Value::Object(piece));
    }
    Some(Value::Array(pieces))
}
