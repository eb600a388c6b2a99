//! Objects, materials, cameras and lights.

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::StudioFault;
use super::chunk::Chunk;
use super::keyframe::{self, Node};
use crate::geometry::number::srgb_to_linear;
use crate::import::look::{MaterialLook, Picture};

/// A file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// What has points.
    pub objects: Vec<Object>,
    /// Cameras.
    pub cameras: Vec<Camera>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Looks of materials.
    pub materials: Vec<MaterialLook>,
    /// Places that move, parents before children.
    pub nodes: Vec<Node>,
    /// First and last frame of the motion.
    pub frames: Option<keyframe::Frames>,
}

/// A mesh, where it stands in the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Object {
    /// Its name.
    pub name: String,
    /// Its points.
    pub points: Vec<DVec3>,
    /// For each point its place on a picture, v growing downwards; none where the file has none.
    pub uvs: Vec<DVec2>,
    /// Its faces.
    pub faces: Vec<Triangle>,
    /// Whether the file says how it is smoothed.
    pub has_smoothing: bool,
    /// The map from its own axes to the scene.
    pub axes: DAffine3,
}

/// A face.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangle {
    /// Numbers of points.
    pub corners: [u16; 3],
    /// A bit for each smoothing group.
    pub smoothing: u32,
    /// Name of its material.
    pub material: Option<String>,
}

/// A camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub place: DVec3,
    /// What it looks at.
    pub target: DVec3,
    /// Degrees about its line of sight.
    pub roll: f64,
    /// Focal length in millimeters over a picture of 36.
    pub lens: f64,
    /// Nearest and furthest that it sees, where the file says so.
    pub range: Option<(f64, f64)>,
}

/// A light.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub place: DVec3,
    /// Red, green and blue, linear.
    pub color: [f64; 3],
    /// What its color is multiplied by.
    pub strength: f64,
    /// Of a spot what it shines at, and the degrees of its bright cone and of its whole cone.
    pub spot: Option<(DVec3, f64, f64)>,
    /// Whether it shines.
    pub on: bool,
    /// Where it ends to shine, where the file says so.
    pub range: Option<f64>,
}

impl Scene {
    /// What the file says of materials of these names.
    #[must_use]
    pub fn looks(&self, names: &[String]) -> Vec<MaterialLook> {
        let look = |name: &String| {
            let known = self.materials.iter().find(|look| look.name == *name).cloned();
            known.unwrap_or_else(|| MaterialLook { name: name.clone(), ..MaterialLook::default() })
        };
        names.iter().map(look).collect()
    }
}

/// Reads a file.
///
/// # Errors
/// See [`StudioFault`].
pub fn read(bytes: &[u8]) -> Result<Scene, StudioFault> {
    let mut scene = Scene::default();
    Chunk::whole(bytes)?.inside(|chunk| match chunk.id {
        0x3d3d => chunk.inside(|chunk| match chunk.id {
            0xafff => {
                scene.materials.push(material(chunk)?);
                Ok(())
            }
            0x4000 => named(chunk, &mut scene),
            _ => Ok(()),
        }),
        0xb000 => {
            (scene.nodes, scene.frames) = keyframe::read(chunk)?;
            Ok(())
        }
        _ => Ok(()),
    })?;
    Ok(scene)
}

/// An object, a camera or a light.
fn named(mut chunk: Chunk<'_>, scene: &mut Scene) -> Result<(), StudioFault> {
    let name = chunk.text("a name")?;
    chunk.inside(|chunk| {
        match chunk.id {
            0x4100 => scene.objects.push(object(name.clone(), chunk)?),
            0x4600 => scene.lights.push(light(name.clone(), chunk)?),
            0x4700 => scene.cameras.push(camera(name.clone(), chunk)?),
            _ => {}
        }
        Ok(())
    })
}

fn object(name: String, chunk: Chunk<'_>) -> Result<Object, StudioFault> {
    let mut made = Object { name, axes: DAffine3::IDENTITY, ..Object::default() };
    chunk.inside(|mut chunk| {
        match chunk.id {
            0x4110 => {
                let count = usize::from(chunk.short("the number of points")?);
                chunk.rows(count, 12, "points")?;
                made.points = (0..count).map(|_| chunk.vector("a coordinate")).collect::<Result<_, _>>()?;
            }
            0x4120 => faces(chunk, &mut made)?,
            0x4140 => {
                let count = usize::from(chunk.short("the number of texture coordinates")?);
                chunk.rows(count, 8, "texture coordinates")?;
                let mut place = || {
                    let (u, v) = (chunk.float("a texture coordinate")?, chunk.float("a texture coordinate")?);
                    Ok(DVec2::new(u, 1.0 - v))
                };
                made.uvs = (0..count).map(|_| place()).collect::<Result<_, _>>()?;
            }
            0x4160 => {
                let mut axis = || chunk.vector("an axis");
                let matrix3 = DMat3::from_cols(axis()?, axis()?, axis()?);
                made.axes = DAffine3 { matrix3, translation: axis()? };
            }
            _ => {}
        }
        Ok(())
    })?;
    let points = made.points.len();
    if let Some(index) = made.faces.iter().flat_map(|face| face.corners).find(|at| usize::from(*at) >= points)
    {
        return Err(StudioFault::Index { object: made.name, what: "point", index, count: points });
    }
    // Without one for each point they say nothing.
    if made.uvs.len() < points {
        made.uvs.clear();
    }
    Ok(made)
}

fn faces(mut chunk: Chunk<'_>, made: &mut Object) -> Result<(), StudioFault> {
    let count = usize::from(chunk.short("the number of faces")?);
    chunk.rows(count, 8, "faces")?;
    let mut face = || {
        let mut corner = || chunk.short("a corner");
        let corners = [corner()?, corner()?, corner()?];
        corner()?;
        Ok(Triangle { corners, ..Triangle::default() })
    };
    made.faces = (0..count).map(|_| face()).collect::<Result<_, _>>()?;
    chunk.inside(|mut chunk| {
        match chunk.id {
            0x4130 => {
                let name = chunk.text("the name of a material")?;
                let some = usize::from(chunk.short("the number of faces of a material")?);
                for _ in 0..chunk.rows(some, 2, "faces of a material")? {
                    let index = chunk.short("a face of a material")?;
                    let Some(face) = made.faces.get_mut(usize::from(index)) else {
                        return Err(StudioFault::Index {
                            object: made.name.clone(),
                            what: "face",
                            index,
                            count,
                        });
                    };
                    face.material = Some(name.clone());
                }
            }
            0x4150 => {
                made.has_smoothing = true;
                chunk.rows(count, 4, "smoothing groups")?;
                for face in &mut made.faces {
                    face.smoothing = chunk.word("a smoothing group")?;
                }
            }
            _ => {}
        }
        Ok(())
    })
}

fn material(chunk: Chunk<'_>) -> Result<MaterialLook, StudioFault> {
    let mut look = MaterialLook::default();
    chunk.inside(|mut chunk| {
        match chunk.id {
            0xa000 => look.name = chunk.text("the name of a material")?,
            0xa020 => look.color = color(chunk)?.or(look.color),
            0xa040 => look.roughness = share(chunk)?.map(|share| 1.0 - share).or(look.roughness),
            0xa050 => look.opacity = share(chunk)?.map(|share| 1.0 - share).or(look.opacity),
            0xa081 => look.double_sided = true,
            0xa200 => chunk.inside(|mut chunk| {
                if chunk.id == 0xa300 {
                    let path = chunk.text("the name of a picture")?;
                    look.pictures.color = Some(path).filter(|path| !path.is_empty()).map(Picture::file);
                }
                Ok(())
            })?,
            _ => {}
        }
        Ok(())
    })?;
    look.blends = look.opacity.is_some_and(|opacity| opacity < 1.0);
    // A picture covers the color.
    if look.pictures.color.is_some() {
        look.color = Some([1.0; 3]);
    }
    Ok(look)
}

/// The color in a chunk, linear; files have those of a screen.
fn color(chunk: Chunk<'_>) -> Result<Option<[f64; 3]>, StudioFault> {
    let mut found = None;
    chunk.inside(|mut chunk| {
        let bytes = matches!(chunk.id, 0x0011 | 0x0012);
        if bytes || matches!(chunk.id, 0x0010 | 0x0013) {
            let mut part = || match bytes {
                true => chunk.byte("a color").map(|part| f64::from(part) / 255.0),
                false => chunk.float("a color").map(|part| part.clamp(0.0, 1.0)),
            };
            let own = [part()?, part()?, part()?];
            // Where a color stands there twice, the first is the one of a screen.
            found = found.or(Some(own.map(srgb_to_linear)));
        }
        Ok(())
    })?;
    Ok(found)
}

/// The percents in a chunk, as a share.
fn share(chunk: Chunk<'_>) -> Result<Option<f64>, StudioFault> {
    let mut found = None;
    chunk.inside(|mut chunk| {
        match chunk.id {
            0x0030 => found = Some(f64::from(chunk.short("percents")?) / 100.0),
            0x0031 => found = Some(chunk.float("percents")? / 100.0),
            _ => {}
        }
        Ok(())
    })?;
    Ok(found.map(|share| share.clamp(0.0, 1.0)))
}

fn light(name: String, mut chunk: Chunk<'_>) -> Result<Light, StudioFault> {
    let place = chunk.vector("the place of a light")?;
    let mut made = Light { name, place, color: [1.0; 3], strength: 1.0, spot: None, on: true, range: None };
    // Colors and the rest stand beside each other.
    if let Some(own) = color(chunk)? {
        made.color = own;
    }
    chunk.inside(|mut chunk| {
        match chunk.id {
            0x4610 => {
                let target = chunk.vector("the target of a light")?;
                let mut angle = || chunk.float("the angle of a light");
                made.spot = Some((target, angle()?, angle()?));
            }
            0x4620 => made.on = false,
            0x465a => made.range = Some(chunk.float("the range of a light")?).filter(|range| *range > 0.0),
            0x465b => made.strength = chunk.float("the strength of a light")?,
            _ => {}
        }
        Ok(())
    })?;
    Ok(made)
}

fn camera(name: String, mut chunk: Chunk<'_>) -> Result<Camera, StudioFault> {
    let place = chunk.vector("the place of a camera")?;
    let target = chunk.vector("the target of a camera")?;
    let (roll, lens) = (chunk.float("the roll of a camera")?, chunk.float("the lens of a camera")?);
    let mut range = None;
    chunk.inside(|mut chunk| {
        if chunk.id == 0x4720 {
            let (near, far) = (chunk.float("the range of a camera")?, chunk.float("the range of a camera")?);
            range = Some((near, far)).filter(|(near, far)| *near > 0.0 && far > near);
        }
        Ok(())
    })?;
    Ok(Camera { name, place, target, roll, lens, range })
}
