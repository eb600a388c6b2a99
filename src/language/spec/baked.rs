//! What is baked into the vertices of a shape: places on a lightmap, and what hides the sky.

use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::spanned::Sp;

table! {
    /// Second texture coordinates (`TEXCOORD_1`), for a picture of light that an engine bakes: no two places of the shape share a
    /// place of the picture. Each level of detail has a picture of its own.
    "lightmap" pub Lightmap {
        /// Texels of a side of the picture.
        size: Sp<u32> = 512_u32 => Check::within(16.0, 8192.0);
        /// Texels between each piece and the border of the picture; twice as many lie between pieces.
        padding: Sp<u32> = 2_u32 => Check::within(0.0, 64.0);
    }
}

table! {
    /// Colors of vertices are darkened by what hides the sky over them: parts of the shape itself, as it stands at rest. Between
    /// vertices it goes straight, so write a finer `tolerance` or `segments` where it changes within a face.
    "occlusion" pub Occlusion {
        /// Directions that each vertex looks along.
        samples: Sp<u32> = 128_u32 => Check::within(4.0, 65536.0);
        /// How far things hide, in the document's unit; however far when it is not written.
        distance: Option<Sp<f64>> => Check::above(0.0);
        /// How dark a vertex is whose whole sky is hidden: 1 is black.
        strength: Sp<f64> = 1.0 => Check::within(0.0, 1.0);
        /// Turns the directions.
        seed: Sp<u32> = 0_u32;
    }
}
