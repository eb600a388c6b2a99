//! What can be written after commands that show models, and start new ones.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::cli::values::{assignment, background, heat, pixels, profile, seconds, view};
use crate::gltf::Profile;
use crate::preview::View;
use crate::preview::heat::Heat;

#[derive(Debug, Args)]
pub(crate) struct Render {
    /// The document, or a .glb file
    pub(crate) file: PathBuf,
    /// The picture: .png; .svg or .eps for lines; .apng or .gif for a turntable and a clip that plays [default: the file's
    /// name with .png]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// From where: front, right, back, left, top, bottom, corner, or AZIMUTH,ELEVATION in degrees; several make a sheet
    #[arg(long, value_name = "VIEW", default_value = "corner", allow_hyphen_values = true, value_parser = view)]
    pub(crate) view: Vec<View>,
    /// Pixels of each view
    #[arg(long, value_name = "N|WIDTHxHEIGHT", default_value = "1024", value_parser = pixels)]
    pub(crate) size: (u32, u32),
    /// Show numbers as colors, with their scale: deviation (from the true surface, for documents), curvature, uv-stretch,
    /// texel-density, lod (which level of detail each part shows), or weights:JOINT
    #[arg(long, value_name = "WHAT", value_parser = heat)]
    pub(crate) heat: Option<Heat>,
    /// Draw the surfaces of a document themselves, not their triangles, and say of each how well it is known: the ground
    /// truth for the mesh, seen by the same camera
    #[arg(long)]
    pub(crate) exact: bool,
    /// Be quick and coarse: tolerances eight times as wide
    #[arg(long, conflicts_with = "exact")]
    pub(crate) draft: bool,
    /// How light is reflected
    #[arg(long, value_enum, default_value_t = ShadingName::Standard)]
    pub(crate) shading: ShadingName,
    /// Draw parallel lines as parallel lines
    #[arg(long)]
    pub(crate) orthographic: bool,
    /// Look through the camera of this node
    #[arg(long, value_name = "NODE", conflicts_with_all = ["view", "orthographic", "turntable"])]
    pub(crate) camera: Option<String>,
    /// Cast no shadows
    #[arg(long)]
    pub(crate) no_shadows: bool,
    /// What becomes of hidden lines in .svg and .eps
    #[arg(long, value_enum, default_value_t = Hidden::Dashed)]
    pub(crate) hidden: Hidden,
    /// What is behind everything: a color like #e6e8ec, or `transparent`
    #[arg(long, value_name = "COLOR", default_value = "#e6e8ec", value_parser = background)]
    pub(crate) background: [u8; 4],
    /// The clip to show
    #[arg(long, value_name = "NAME")]
    pub(crate) clip: Option<String>,
    /// Seconds from the start of the clip; without it, an .apng or .gif plays the whole clip
    #[arg(long, value_name = "SECONDS", requires = "clip", value_parser = seconds)]
    pub(crate) time: Option<f64>,
    /// Turn once around in this many pictures
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=720))]
    pub(crate) turntable: Option<u16>,
    /// The level of detail to show, 0 for the finest
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=7))]
    pub(crate) lod: u8,
    /// The folder that the document may not read outside of [default: that of the project file, or the working directory]
    #[arg(long, value_name = "DIR")]
    pub(crate) root: Option<PathBuf>,
    /// The variant of the document
    #[arg(long, value_name = "NAME")]
    pub(crate) variant: Option<String>,
    /// Set a parameter of the document
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,
}

#[derive(Debug, Args)]
pub(crate) struct Watch {
    /// The document
    pub(crate) file: PathBuf,
    /// Write what is baked to this folder too
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Where on this machine the page is served; another port is taken where this one is in use
    #[arg(long, value_name = "N", default_value_t = 4870)]
    pub(crate) port: u16,
    /// The folder of three.js [default: where npm installed it, for this folder, the project, or one above]
    #[arg(long, value_name = "DIR")]
    pub(crate) three: Option<PathBuf>,
    /// For whom files are [default: what the document says, else core]
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = profile)]
    pub(crate) profile: Vec<Profile>,
    /// The folder that the document may not read outside of [default: that of the project file, or the working directory]
    #[arg(long, value_name = "DIR")]
    pub(crate) root: Option<PathBuf>,
    /// Set a parameter of the document
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,
    /// Be quick and coarse: tolerances eight times as wide, no levels of detail, no lightmaps and occlusion
    #[arg(long)]
    pub(crate) draft: bool,
}

/// What becomes of hidden lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Hidden {
    /// They are thin and dashed
    Dashed,
    /// They are left out
    None,
}

/// How light is reflected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShadingName {
    /// As glTF says: metal and roughness
    Standard,
    /// Phong's rule, with normals between those of the corners
    Phong,
    /// Phong's rule at the corners, and light between them
    Gouraud,
    /// Phong's rule, one normal for each triangle
    Flat,
    /// Normals as colors
    Normals,
}

#[derive(Debug, Args)]
pub(crate) struct New {
    /// Name of the document, in kebab-case; `.toml` is added
    #[arg(required_unless_present = "list")]
    pub(crate) name: Option<String>,
    /// What to start from; --list tells what there is
    #[arg(long, value_name = "STARTER", default_value = "vase")]
    pub(crate) from: String,
    /// Tell what documents there are to start from
    #[arg(long, conflicts_with_all = ["name", "from"])]
    pub(crate) list: bool,
}
