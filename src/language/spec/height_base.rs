//! What height maps stand on instead of a plane.

use glam::{DVec2, DVec3};
use serde_json::Value as Json;

use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, kinds, table};
use crate::language::spec::kind::{Kinds as _, take_kind};
use crate::language::spec::reader::{Fields, Read, Reader};
use crate::language::spec::reference::ShapeReference;
use crate::language::spec::schema::Schemas;
use crate::language::spec::spanned::Sp;
use crate::language::value::Value;

kinds! {
    /// What heights stand on.
    "base" HeightBase {
        /// A ball.
        Sphere(SphereBase) = "sphere";
        /// A ball stretched along the axes.
        Ellipsoid(EllipsoidBase) = "ellipsoid";
        /// A cylinder around the y axis.
        Cylinder(CylinderBase) = "cylinder";
        /// The surface of another shape.
        Surface(ShapeBase) = "surface";
    }
}

impl Read for HeightBase {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let mut fields = Fields::open(value, "base", reader)?;
        let kind = take_kind::<Self>(&mut fields, reader);
        if fields.close(reader) { kind } else { None }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        schemas.object("base", "What heights stand on: one kind.", Self::describe_kinds)
    }
}

table! {
    /// A sphere about the origin. Seen from outside the columns of the map go to the right and its rows down.
    "sphere base" pub SphereBase {
        /// The radius.
        radius: Sp<f64> => Check::above(0.0);
        /// How the map lies on it.
        projection: Sp<Projection> = Projection::Spherical;
        /// Angles about the y axis of the first and last column, in degrees: 0 is +z, 90 is +x. Over 360 degrees the map
        /// closes: when its last column does not repeat the first, the first follows the last.
        longitude: Sp<DVec2> = DVec2::new(-180.0, 180.0);
        /// With `projection = "spherical"`: latitudes of the first and last row, in degrees. At 90 and -90 degrees a row is
        /// one point, which has the mean height of its samples.
        latitude: Sp<DVec2> = DVec2::new(90.0, -90.0) => Check::within(-90.0, 90.0);
        /// With `projection = "cylindrical"`: y of the first and last row.
        rise: Option<Sp<DVec2>>;
        /// With `projection = "parallel"`: lengths of the map along x and y.
        size: Option<Sp<DVec2>> => Check::above(0.0);
    }
}

table! {
    /// An ellipsoid about the origin. Seen from outside the columns of the map go to the right and its rows down; heights
    /// are measured along its true normals.
    "ellipsoid base" pub EllipsoidBase {
        /// Half axes along x, y and z.
        radii: Sp<DVec3> => Check::above(0.0);
        /// How the map lies on it.
        projection: Sp<Projection> = Projection::Spherical;
        /// Angles about the y axis of the first and last column, in degrees: 0 is +z, 90 is +x. They are those of the sphere
        /// that is stretched to the ellipsoid. Over 360 degrees the map closes: when its last column does not repeat the
        /// first, the first follows the last.
        longitude: Sp<DVec2> = DVec2::new(-180.0, 180.0);
        /// With `projection = "spherical"`: latitudes of the first and last row on that sphere, in degrees. At 90 and -90
        /// degrees a row is one point, which has the mean height of its samples.
        latitude: Sp<DVec2> = DVec2::new(90.0, -90.0) => Check::within(-90.0, 90.0);
        /// With `projection = "cylindrical"`: y of the first and last row.
        rise: Option<Sp<DVec2>>;
        /// With `projection = "parallel"`: lengths of the map along x and y.
        size: Option<Sp<DVec2>> => Check::above(0.0);
    }
}

table! {
    /// A cylinder around the y axis, its middle at the origin. Seen from outside the columns of the map go to the right and
    /// its rows down.
    "cylinder base" pub CylinderBase {
        /// The radius.
        radius: Sp<f64> => Check::above(0.0);
        /// With `projection = "cylindrical"`: how far the map reaches along y.
        height: Option<Sp<f64>> => Check::above(0.0);
        /// How the map lies on it: `"cylindrical"` or `"parallel"`.
        projection: Sp<Projection> = Projection::Cylindrical;
        /// Angles about the y axis of the first and last column, in degrees: 0 is +z, 90 is +x. Over 360 degrees the map
        /// closes: when its last column does not repeat the first, the first follows the last.
        longitude: Sp<DVec2> = DVec2::new(-180.0, 180.0);
        /// With `projection = "parallel"`: lengths of the map along x and y.
        size: Option<Sp<DVec2>> => Check::above(0.0);
    }
}

table! {
    /// The surface of another shape, as it is placed. Columns of the map go along its u and rows against its v, so that on a
    /// surface whose v goes up the map stands upright. Where the surface closes, the map closes; a side that is one point
    /// has the mean height of its samples.
    "surface base" pub ShapeBase {
        /// The shape: one surface by parameters without edges inside, such as `revolve` with a smooth profile, `loft`,
        /// `parametric`, `nurbs`, `patches` of one patch or `coons`, or the wall of an `extrude` with a smooth outline. What
        /// closes it at its ends does not matter.
        of: ShapeReference;
        /// From where to where in u; all of it when it is not written. `kiln sample --shape NAME FILE` tells the range; of a
        /// revolved profile u is the angle in degrees and v the parameter of the profile.
        u: Option<Sp<DVec2>>;
        /// From where to where in v, upward.
        v: Option<Sp<DVec2>>;
    }
}

choices! {
    /// How a map lies on a round base.
    Projection {
        /// By angle and latitude.
        Spherical = "spherical";
        /// By angle about the y axis and height along it.
        Cylindrical = "cylindrical";
        /// Straight along -z, onto the side that looks to +z.
        Parallel = "parallel";
    }
}
