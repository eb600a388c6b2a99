//! What `kiln sample` says of a shape made of surfaces with parameters.

use glam::DVec3;
use serde_json::{Map, Value, json};

use crate::geometry::curve::{Domain, Side};
use crate::geometry::surface::{
    AnySurface, PatchContinuity, Rim, Surface, SurfaceJoint, SurfaceJoints, SurfaceLine, joints, measure,
};

/// Places on a surface with these domains, or what is wrong with those that were asked for.
pub(super) type Places<'a> = &'a dyn Fn(Domain, Domain) -> Result<Vec<(f64, f64)>, String>;

/// Samples, sides and joints of each surface: one alone, or a list of patches.
pub(super) fn describe(name: &str, surfaces: &[AnySurface], places: Places<'_>) -> Result<Value, String> {
    let found = joints(surfaces);
    let mut object = Map::new();
    object.insert("shape".to_owned(), json!(name));
    if let [only] = surfaces {
        object.extend(patch(only, places)?);
    } else {
        let patches: Result<Vec<Value>, String> =
            surfaces.iter().map(|surface| patch(surface, places).map(Value::Object)).collect();
        object.insert("patches".to_owned(), json!(patches?));
    }
    object.insert("joints".to_owned(), found.joints.iter().map(joint).collect());
    object.insert("continuity".to_owned(), counts(&found));
    object.insert("open-sides".to_owned(), sides(&found.open));
    object.insert("collapsed-sides".to_owned(), sides(&found.collapsed));
    Ok(Value::Object(object))
}

fn patch(surface: &AnySurface, places: Places<'_>) -> Result<Map<String, Value>, String> {
    let (u, v) = (surface.domain_u(), surface.domain_v());
    let samples: Vec<Value> = places(u, v)?.into_iter().map(|place| sample(surface, (u, v), place)).collect();
    let measures = measure(surface);
    let mut object = Map::new();
    let mut put = |key: &str, value: Value| object.insert(key.to_owned(), value);
    put("domain-u", json!([u.start, u.end]));
    put("domain-v", json!([v.start, v.end]));
    put("breaks-u", json!(surface.breaks_u()));
    put("breaks-v", json!(surface.breaks_v()));
    put("area", json!(measures.area));
    put("volume-to-origin", json!(measures.volume));
    put("samples", json!(samples));
    Ok(object)
}

fn sample(surface: &AnySurface, domains: (Domain, Domain), (u, v): (f64, f64)) -> Value {
    let side = |t: f64, domain: Domain| (t, if t >= domain.end { Side::Before } else { Side::After });
    let (at_u, at_v) = (side(u, domains.0), side(v, domains.1));
    let (jet, second) = (surface.sided(at_u, at_v), surface.second(at_u, at_v));
    json!({
        "u": u, "v": v,
        "point": numbers(jet.point), "du": numbers(jet.du), "dv": numbers(jet.dv),
        "normal": numbers(jet.normal),
        "duu": numbers(second.uu), "duv": numbers(second.uv), "dvv": numbers(second.vv),
    })
}

fn numbers(vector: DVec3) -> Value {
    json!(vector.to_array())
}

fn rim(rim: Rim) -> &'static str {
    match rim {
        Rim::Bottom => "v-start",
        Rim::Top => "v-end",
        Rim::Left => "u-start",
        Rim::Right => "u-end",
    }
}

fn line((patch, line): (usize, SurfaceLine)) -> Value {
    match line {
        SurfaceLine::Rim(side) => json!({ "patch": patch, "side": rim(side) }),
        SurfaceLine::U(u) => json!({ "patch": patch, "u": u }),
        SurfaceLine::V(v) => json!({ "patch": patch, "v": v }),
    }
}

fn joint(joint: &SurfaceJoint) -> Value {
    let found = &joint.smoothness;
    json!({
        "between": joint.lines.map(line),
        "continuity": found.continuity.to_string(),
        "angle": found.angle,
        "at": numbers(found.place),
        "slope-difference": found.slope,
        "bend-difference": found.bend,
    })
}

/// How many joints there are of each class.
fn counts(found: &SurfaceJoints) -> Value {
    let of = |class: PatchContinuity| {
        found.joints.iter().filter(|joint| joint.smoothness.continuity == class).count()
    };
    PatchContinuity::ALL.into_iter().map(|class| (class.to_string(), json!(of(class)))).collect()
}

fn sides(list: &[(usize, Rim)]) -> Value {
    list.iter().map(|(patch, side)| json!({ "patch": patch, "side": rim(*side) })).collect()
}
