//! What height maps stand on.

use glam::{DVec2, DVec3};

use super::Builder;
use super::profile::show;
use crate::geometry::surface::{ExtrudedSurface, RevolvedSurface};
use crate::geometry::tessellate::{Base, BaseFault, BaseSurface, Chart, HeightMap, SurfaceBase};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{CylinderBase, HeightBase, Projection, ShapeBase, Sp};
use crate::model::Recipe;

/// What is written of a round base.
struct Round {
    radii: DVec3,
    projection: Sp<Projection>,
    longitude: Sp<DVec2>,
    latitude: Sp<DVec2>,
    rise: Option<Sp<DVec2>>,
    size: Option<Sp<DVec2>>,
}

impl Builder<'_> {
    pub(super) fn height_base(&mut self, name: &str, written: &HeightBase) -> Option<Base> {
        match written {
            HeightBase::Sphere(base) => self.ellipsoid(&Round {
                radii: DVec3::splat(base.radius.value),
                projection: base.projection,
                longitude: base.longitude,
                latitude: base.latitude,
                rise: base.rise,
                size: base.size,
            }),
            HeightBase::Ellipsoid(base) => self.ellipsoid(&Round {
                radii: base.radii.value,
                projection: base.projection,
                longitude: base.longitude,
                latitude: base.latitude,
                rise: base.rise,
                size: base.size,
            }),
            HeightBase::Cylinder(base) => self.cylinder(base),
            HeightBase::Surface(base) => self.surface_base(name, base),
        }
    }

    /// Warns of rows that are one point on the base and have several heights.
    pub(super) fn note_poles(&mut self, base: &Base, heights: &HeightMap, span: Span) {
        let closes = base.closes();
        let field = &heights.field;
        for (is_point, row) in [(closes.first, 0), (closes.last, field.rows() - 1)] {
            let (mean, spread) = field.point_of(row, closes.columns);
            let (low, high) = field.range();
            if !is_point || spread <= 1e-3 * (high - low) {
                continue;
            }
            let message = format!(
                "row {row} is one point on the base, and its heights differ from their mean {} by up to {}",
                show(mean),
                show(spread)
            );
            let report = Diagnostic::warning(Code::UnequalPole, message)
                .at(span, "the mean stands there")
                .help("give the row one height, or end the map before the pole with `latitude`");
            self.report(report);
        }
    }

    fn idle(&mut self, field: Option<Span>, name: &str, projection: Sp<Projection>) -> Option<()> {
        let Some(span) = field.filter(|span| !span.is_none()) else { return Some(()) };
        let message = format!("`{name}` has no effect with `projection = \"{}\"`", projection.value.text());
        self.report(Diagnostic::error(Code::Conflict, message).at(span, "no effect"));
        None
    }

    fn needs<T: Copy>(&mut self, field: Option<Sp<T>>, name: &str, example: &str, at: Span) -> Option<T> {
        if field.is_none() {
            let report =
                Diagnostic::error(Code::MissingField, format!("missing field `{name}` of this base"))
                    .at(at, "how large?")
                    .help(format!("write `{name} = {example}`"));
            self.report(report);
        }
        field.map(|field| field.value)
    }

    fn turn(&mut self, longitude: Sp<DVec2>) -> Option<[f64; 2]> {
        let [from, to] = longitude.value.to_array();
        if from < to && to - from <= 360.0 {
            return Some([from, to]);
        }
        let message = format!("`longitude` goes from {} to {} degrees", show(from), show(to));
        let report = Diagnostic::error(Code::OutOfRange, message)
            .at(longitude.span, "must rise by at most 360 degrees")
            .help("write `longitude = [-180, 180]`");
        self.report(report);
        None
    }

    fn ellipsoid(&mut self, round: &Round) -> Option<Base> {
        let projection = round.projection;
        let radii = round.radii;
        let size = round.size.map(|size| size.span);
        let rise = round.rise.map(|rise| rise.span);
        let chart = match projection.value {
            Projection::Spherical => {
                self.idle(rise, "rise", projection)?;
                self.idle(size, "size", projection)?;
                let [from, to] = round.latitude.value.to_array();
                if from <= to {
                    let message = format!("`latitude` goes from {} to {} degrees", show(from), show(to));
                    let report = Diagnostic::error(Code::OutOfRange, message)
                        .at(round.latitude.span, "rows go down")
                        .help("write the northern one first: `latitude = [90, -90]`");
                    self.report(report);
                    return None;
                }
                Chart::Spherical { longitude: self.turn(round.longitude)?, latitude: [from, to] }
            }
            Projection::Cylindrical => {
                self.idle(size, "size", projection)?;
                self.idle(Some(round.latitude.span), "latitude", projection)?;
                let longitude = self.turn(round.longitude)?;
                let example = format!("[{}, {}]", show(radii.y / 2.0), show(-radii.y / 2.0));
                let [from, to] = self.needs(round.rise, "rise", &example, projection.span)?.to_array();
                if from <= to || from >= radii.y || to <= -radii.y {
                    let message = format!("`rise` goes from {} to {}", show(from), show(to));
                    let at = round.rise.map_or(Span::NONE, |rise| rise.span);
                    let report = Diagnostic::error(Code::OutOfRange, message)
                        .at(at, format!("must fall, between {} and {}", show(radii.y), show(-radii.y)))
                        .help(format!(
                            "write `rise = {example}`, or `projection = \"spherical\"` to reach the poles"
                        ));
                    self.report(report);
                    return None;
                }
                Chart::Cylindrical { longitude, rise: [from, to] }
            }
            Projection::Parallel => {
                self.idle(rise, "rise", projection)?;
                self.idle(Some(round.latitude.span), "latitude", projection)?;
                self.idle(Some(round.longitude.span), "longitude", projection)?;
                let size = self.needs(
                    round.size,
                    "size",
                    &format!("[{0}, {0}]", show(radii.min_element())),
                    projection.span,
                )?;
                let part = size / 2.0 / DVec2::new(radii.x, radii.y);
                if part.length_squared() >= 1.0 {
                    self.beyond(round.size, "the corners of the map do not meet the base");
                    return None;
                }
                Chart::Parallel { size }
            }
        };
        Some(Base::Ellipsoid { radii, chart })
    }

    fn cylinder(&mut self, base: &CylinderBase) -> Option<Base> {
        let (radius, projection) = (base.radius.value, base.projection);
        let chart = match projection.value {
            Projection::Spherical => {
                let report = Diagnostic::error(Code::Conflict, "a cylinder has no poles to project from")
                    .at(projection.span, "for spheres and ellipsoids")
                    .help("write `projection = \"cylindrical\"` or `\"parallel\"`");
                self.report(report);
                return None;
            }
            Projection::Cylindrical => {
                self.idle(base.size.map(|size| size.span), "size", projection)?;
                let height = self.needs(base.height, "height", "1", base.radius.span)?;
                Chart::Cylindrical {
                    longitude: self.turn(base.longitude)?,
                    rise: [height / 2.0, -height / 2.0],
                }
            }
            Projection::Parallel => {
                self.idle(base.height.map(|height| height.span), "height", projection)?;
                self.idle(Some(base.longitude.span), "longitude", projection)?;
                let size =
                    self.needs(base.size, "size", &format!("[{0}, {0}]", show(radius)), projection.span)?;
                if size.x >= 2.0 * radius {
                    self.beyond(base.size, "the sides of the map do not meet the base");
                    return None;
                }
                Chart::Parallel { size }
            }
        };
        Some(Base::Cylinder { radius, chart })
    }

    fn beyond(&mut self, size: Option<Sp<DVec2>>, why: &str) {
        let span = size.map_or(Span::NONE, |size| size.span);
        let report = Diagnostic::error(Code::OutOfRange, format!("this map is wider than its base: {why}"))
            .at(span, "too large")
            .help("write a smaller `size`, or another projection");
        self.report(report);
    }

    fn surface_base(&mut self, name: &str, written: &ShapeBase) -> Option<Base> {
        let span = written.of.span();
        let handle = self.shape_of(&format!("{name}-base"), 0, &written.of)?;
        let shape = self.model.shape(handle);
        let (recipe, place) = (shape.recipe.clone(), shape.options.placement);
        let surface = match recipe {
            Recipe::Patches { patches, .. } if patches.surfaces.len() == 1 => {
                patches.surfaces.into_iter().next().map(BaseSurface::Any)
            }
            Recipe::Trimmed(trimmed) => Some(BaseSurface::Any(trimmed.surface().clone())),
            Recipe::Revolution(turned) => Some(BaseSurface::Turned(RevolvedSurface {
                profile: turned.profile,
                start: turned.start,
                angle: turned.angle,
            })),
            Recipe::Extrusion(pushed) if pushed.outlines.len() == 1 && pushed.edge.is_none() => {
                let outline = pushed.outlines.into_iter().next();
                outline.map(|profile| {
                    let (bottom, height) = (pushed.bottom, pushed.height);
                    BaseSurface::Pushed(ExtrudedSurface { profile, bottom, height })
                })
            }
            _ => None,
        };
        let Some(surface) = surface else {
            let report = Diagnostic::error(Code::BadBase, "this shape is not one surface over parameters u and v")
                .at(span, "cannot carry heights")
                .help("surfaces are `revolve`, `extrude` with one outline, `loft`, `ruled`, `translational`, `parametric`, `nurbs`, `b-spline`, `patches` of one patch, `hermite`, `coons` and `gordon`");
            self.report(report);
            return None;
        };
        let whole = SurfaceBase::domains(&surface);
        let u = self.range(written.u, "u", whole[0])?;
        let v = self.range(written.v, "v", whole[1])?;
        match SurfaceBase::new(surface, place, Some(u), Some(v)) {
            Ok(base) => Some(Base::Surface(Box::new(base))),
            Err(fault) => {
                self.report(unfit(fault, span));
                None
            }
        }
    }

    /// A range of a parameter inside of all of it.
    fn range(&mut self, written: Option<Sp<DVec2>>, name: &str, whole: [f64; 2]) -> Option<[f64; 2]> {
        let Some(range) = written else { return Some(whole) };
        let [from, to] = range.value.to_array();
        let slack = 1e-9 * (whole[1] - whole[0]);
        if from < to && from >= whole[0] - slack && to <= whole[1] + slack {
            return Some([from.max(whole[0]), to.min(whole[1])]);
        }
        let message = format!("`{name}` goes from {} to {}", show(from), show(to));
        let report = Diagnostic::error(Code::OutOfRange, message)
            .at(range.span, format!("must rise, between {} and {}", show(whole[0]), show(whole[1])))
            .help(format!("write `{name} = [{}, {}]`", show(whole[0]), show(whole[1])));
        self.report(report);
        None
    }
}

fn unfit(fault: BaseFault, span: Span) -> Diagnostic {
    match fault {
        BaseFault::Edge { along_v, at } => {
            let name = if along_v { "u" } else { "v" };
            let message = format!(
                "this surface has an edge at {name} = {}: heights along its normals would tear there",
                show(at)
            );
            Diagnostic::error(Code::BadBase, message)
                .at(span, "has an edge inside")
                .help(format!("round the edge, or stay on one side of it with `{name}`"))
        }
        BaseFault::Twisted => Diagnostic::error(
            Code::BadBase,
            "this surface closes with a twist: it has no outside to stand on",
        )
        .at(span, "one side alone")
        .help("use a part of it with `u` or `v`"),
        BaseFault::Flat { place } => {
            let message = format!(
                "this surface has no area or turns over near u = {}, v = {}: there are no normals to stand along",
                show(place[0]),
                show(place[1])
            );
            Diagnostic::error(Code::BadBase, message)
                .at(span, "degenerate inside")
                .help("leave that place out with `u` or `v`")
        }
    }
}
