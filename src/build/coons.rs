//! Surfaces through curves: Coons patches and networks.

use glam::{DAffine3, DMat3, DVec3};

use super::profile::show;
use super::{Builder, patch};
use crate::geometry::curve::{AnyCurve, Transformed};
use crate::geometry::surface::AnySurface;
use crate::geometry::surface::coons::{
    CoonsBlend, CoonsError, CoonsSide, CoonsSides, Family, GordonBlend, GordonError, Twist, coons as make,
    gordon as make_network,
};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, CoonsTwist, Cross, CurveReference};
use crate::model::Recipe;

impl Builder<'_> {
    pub(super) fn coons(&mut self, coons: &spec::Coons) -> Option<Recipe> {
        let sides: Vec<_> = coons.sides.iter().map(|side| self.coons_side(side)).collect();
        let sides: Vec<CoonsSide> = sides.into_iter().collect::<Option<_>>()?;
        let sides = match (coons.point, sides) {
            (Some(point), _) => CoonsSides::Point(point.value),
            (None, sides) if coons.apart.value => {
                CoonsSides::Apart(Box::new(<[CoonsSide; 2]>::try_from(sides).ok()?))
            }
            (None, sides) => CoonsSides::Around(sides),
        };
        let blend = match coons.blend.value {
            spec::CoonsBlend::Bilinear => CoonsBlend::Bilinear,
            spec::CoonsBlend::Bicubic => CoonsBlend::Bicubic,
        };
        let twist = match coons.twist.map(|twist| twist.value) {
            None | Some(CoonsTwist::Adini) => Twist::Adini,
            Some(CoonsTwist::Zero) => Twist::Zero,
            Some(CoonsTwist::Bilinear) => Twist::Bilinear,
            Some(CoonsTwist::Given(vectors)) => Twist::Given(vectors),
        };
        match make(sides, blend, twist) {
            Ok(surface) => Some(alone(surface)),
            Err(error) => {
                self.report(coons_fault(coons, &error));
                None
            }
        }
    }

    fn coons_side(&mut self, side: &spec::CoonsSide) -> Option<CoonsSide> {
        let curve = self.curve_of(&side.curve);
        let cross = match side.cross.as_ref().map(|cross| &cross.value) {
            None => Some(None),
            Some(Cross::Constant(vector)) => Some(curve.clone().map(|curve| constant(curve, *vector))),
            Some(Cross::Curve(reference)) => self.curve_of(reference).map(Some),
        };
        Some(CoonsSide { curve: curve?, cross: cross? })
    }

    pub(super) fn gordon(&mut self, network: &spec::Gordon, span: Span) -> Option<Recipe> {
        let along_u = self.family(&network.u);
        let along_v = self.family(&network.v);
        let blend = match network.blend.value {
            spec::GordonBlend::Spline => GordonBlend::Spline,
            spec::GordonBlend::Linear => GordonBlend::Linear,
        };
        match make_network(&along_u?, &along_v?, blend) {
            Ok(surface) => Some(alone(AnySurface::Transfinite(Box::new(surface)))),
            Err(error) => {
                self.report(gordon_fault(network, span, &error));
                None
            }
        }
    }

    fn family(&mut self, references: &[CurveReference]) -> Option<Vec<AnyCurve>> {
        // All are built, so that every fault among them is seen.
        let curves: Vec<_> = references.iter().map(|reference| self.curve_of(reference)).collect();
        curves.into_iter().collect()
    }
}

fn alone(surface: AnySurface) -> Recipe {
    patch::recipe(vec![surface])
}

/// A curve that stays at one vector.
fn constant(curve: AnyCurve, vector: DVec3) -> AnyCurve {
    let map = DAffine3 { matrix3: DMat3::ZERO, translation: vector };
    AnyCurve::Transformed(Transformed::new(curve, map))
}

/// A vector in words; zeros without sign.
fn vector(vector: DVec3) -> String {
    format!("[{}, {}, {}]", show(vector.x + 0.0), show(vector.y + 0.0), show(vector.z + 0.0))
}

fn coons_fault(coons: &spec::Coons, error: &CoonsError) -> Diagnostic {
    let span = |side: usize| coons.sides[side].curve.span();
    match error {
        CoonsError::Gap(gap) => {
            let (first, second) = (gap.first, gap.second);
            let message = format!(
                "`sides[{first}]` and `sides[{second}]` do not meet: their nearest ends are {} apart",
                show(gap.distance)
            );
            let report = Diagnostic::error(Code::OpenSides, message)
                .at(span(second), "does not meet the side before")
                .also(span(first), "the side before")
                .help("sides stand in order around the patch, each ending where the next one starts");
            if coons.sides.len() == 2 {
                report.note("two sides that shall stay apart take `apart = true`")
            } else {
                report
            }
        }
        CoonsError::Open(distance) => {
            let message =
                format!("one side alone must be a closed curve; its ends are {} apart", show(*distance));
            Diagnostic::error(Code::OpenSides, message)
                .at(span(0), "open")
                .help("close the curve, or add the sides that are missing")
        }
        CoonsError::Cross { side, end, found, expected } => {
            let cross = coons.sides[*side].cross.as_ref().map_or_else(|| span(*side), |cross| cross.span);
            let message = format!(
                "`cross` of `sides[{side}]` is {} at its {end}, but the side that it meets there leaves with {}",
                vector(*found),
                vector(*expected)
            );
            Diagnostic::error(Code::CornerConflict, message)
                .at(cross, format!("must be {} at the {end}", vector(*expected)))
                .help("at a corner the derivative across a side is the tangent of the side beside it")
        }
        CoonsError::Twist { corner, given, found } => {
            let place = coons.twist.map_or_else(|| span(0), |twist| twist.span);
            let message = format!(
                "`twist[{corner}]` is {}, but the `cross` that begins or ends at this corner makes it {}",
                vector(*given),
                vector(*found)
            );
            Diagnostic::error(Code::CornerConflict, message)
                .at(place, "does not agree with `cross`")
                .help("leave `twist` out: where `cross` is given it determines the twist")
        }
    }
}

fn gordon_fault(network: &spec::Gordon, span: Span, error: &GordonError) -> Diagnostic {
    let list = |family: Family| match family {
        Family::U => ("u", &network.u),
        Family::V => ("v", &network.v),
    };
    let at = |family: Family, index: usize| list(family).1.get(index).map_or(span, CurveReference::span);
    let fault = |message: String| Diagnostic::error(Code::BadNetwork, message);
    match error {
        GordonError::Few { family, least, found } => {
            let (name, _) = list(*family);
            fault(format!(
                "a network around closed curves needs at least {least} curves along `{name}`, found {found}"
            ))
            .at(at(*family, 0), "too few")
        }
        GordonError::Mixed { family, first, second } => {
            let (name, _) = list(*family);
            fault(format!("`{name}[{first}]` is closed and `{name}[{second}]` is open"))
                .at(at(*family, *second), "open")
                .also(at(*family, *first), "closed")
                .help("the curves of a family are all open or all closed")
        }
        GordonError::BothClosed => fault("the curves of both families are closed".to_owned())
            .at(at(Family::V, 0), "closed")
            .also(at(Family::U, 0), "closed")
            .help("cut the curves of one family open: their ends meet where they start"),
        GordonError::Apart { u, v, distance } => {
            let message =
                format!("`u[{u}]` and `v[{v}]` do not meet: they pass at a distance of {}", show(*distance));
            fault(message)
                .at(at(Family::V, *v), "passes the other")
                .also(at(Family::U, *u), "the other")
                .help("in a network every curve along u meets every curve along v")
        }
        GordonError::Order { family, index, early } => {
            let (name, _) = list(*family);
            let other = if *family == Family::U { "v" } else { "u" };
            fault(format!("`{name}[{index}]` meets `{other}[{early}]` out of order"))
                .at(at(*family, *index), format!("meets `{other}[{early}]` before it should"))
                .help(format!(
                    "list the curves of `{other}` in the order in which all curves of `{name}` meet them"
                ))
        }
    }
}
