//! Files of other formats, told by their first bytes.

/// A format that is not read, and what to export instead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Foreign {
    /// What it is, with its article.
    pub name: &'static str,
    /// What to do.
    pub hint: &'static str,
}

const BLENDER: &str = "in Blender: File > Export > Wavefront (.obj), then import that file";
const OBJ: &str = "export it as Wavefront OBJ (text) or STL from the program that made it";
const MD4: &str = "export it as a Quake III model (.md3), or with its skeleton as a Doom 3 model (.md5mesh)";
const MESH: &str = "open it in Blender or MeshLab and export Wavefront OBJ or STL";
const UNPACK: &str = "unpack it first";
const SOLID: &str = "export an STL file from your CAD program, as fine as you need it";

/// First bytes of each format.
const MAGIC: [(&[u8], Foreign); 30] = [
    (b"BLENDER", Foreign { name: "a Blender file", hint: BLENDER }),
    (
        b"\x28\xb5\x2f\xfd",
        Foreign { name: "a compressed file (Zstandard; Blender files often are)", hint: BLENDER },
    ),
    (b"\x1f\x8b", Foreign { name: "a compressed file (gzip)", hint: UNPACK }),
    (b"Kaydara FBX Binary", Foreign { name: "an FBX file", hint: OBJ }),
    (b"; FBX", Foreign { name: "an FBX file", hint: OBJ }),
    (b"glTF", Foreign { name: "a binary glTF file", hint: "let its name end with .glb" }),
    (b"ply\n", Foreign { name: "a PLY file", hint: "let its name end with .ply" }),
    (b"ply\r", Foreign { name: "a PLY file", hint: "let its name end with .ply" }),
    (b"OFF", Foreign { name: "an OFF file", hint: MESH }),
    (b"COFF", Foreign { name: "an OFF file", hint: MESH }),
    (b"PK\x03\x04", Foreign { name: "a ZIP archive (3MF and USDZ are, too)", hint: UNPACK }),
    (b"IDP2", Foreign { name: "a Quake II model (MD2)", hint: "let its name end with .md2" }),
    (b"IDP3", Foreign { name: "a Quake III model (MD3)", hint: "let its name end with .md3" }),
    (b"IDP4", Foreign { name: "a Quake III skeletal model (MD4)", hint: MD4 }),
    (b"RDM5", Foreign { name: "a Quake III skeletal model (MDR)", hint: MD4 }),
    (b"IDPO", Foreign { name: "a Quake model (MDL)", hint: MESH }),
    (
        b"MD5Version",
        Foreign {
            name: "a Doom 3 model (MD5)",
            hint: "let its name end with .md5mesh, or .md5anim for a motion",
        },
    ),
    (b"AutoCAD Binary DXF", Foreign { name: "a drawing (DXF)", hint: "let its name end with .dxf" }),
    (b"ISO-10303-21", Foreign { name: "a STEP file", hint: SOLID }),
    (b"DBRep_DrawableShape", Foreign { name: "an OpenCascade shape (BREP)", hint: SOLID }),
    (b"PXR-USDC", Foreign { name: "a binary USD file", hint: MESH }),
    (b"#usda", Foreign { name: "a USD file", hint: MESH }),
    (b"//Maya ASCII", Foreign { name: "a Maya scene", hint: OBJ }),
    (b"FOR4", Foreign { name: "a Maya scene", hint: OBJ }),
    (b"FOR8", Foreign { name: "a Maya scene", hint: OBJ }),
    (b"FORM", Foreign { name: "a LightWave object (or another IFF file)", hint: OBJ }),
    (b"Ogawa", Foreign { name: "an Alembic cache", hint: MESH }),
    (b"\x89PNG", Foreign { name: "a PNG picture", hint: "name a mesh file here" }),
    (b"<?xml", Foreign { name: "an XML file (Collada, X3D and AMF are)", hint: MESH }),
    (b"%PDF", Foreign { name: "a PDF document", hint: "name a mesh file here" }),
];

/// What a file is by its first bytes, when it is neither OBJ nor STL. A file that is none of the known formats
/// gives `None`, as OBJ and STL do.
#[must_use]
pub fn recognize(bytes: &[u8]) -> Option<Foreign> {
    let known = MAGIC.iter().find(|(magic, _)| bytes.starts_with(magic)).map(|&(_, foreign)| foreign);
    known.or_else(|| {
        let is_3ds = bytes.starts_with(b"MM")
            && bytes.get(2..6).is_some_and(|length| {
                let length = u32::from_le_bytes([length[0], length[1], length[2], length[3]]);
                length >= 16 && length as usize <= bytes.len()
            });
        is_3ds.then_some(Foreign { name: "a 3D Studio scene (3DS)", hint: "let its name end with .3ds" })
    })
}

#[cfg(test)]
mod tests {
    use super::{MAGIC, recognize};

    #[test]
    fn every_format_is_recognized_by_its_own_entry() {
        for (magic, foreign) in MAGIC {
            let mut bytes = magic.to_vec();
            bytes.extend([0; 100]);
            assert_eq!(recognize(&bytes), Some(foreign), "{magic:?}");
        }
        let mut studio = b"MM\x14\0\0\0\x02\0".to_vec();
        studio.extend([0; 12]);
        assert_eq!(recognize(&studio).map(|foreign| foreign.name), Some("a 3D Studio scene (3DS)"));
    }

    #[test]
    fn obj_and_stl_are_left_alone() {
        for bytes in [&b"v 0 0 0\n"[..], b"solid x\n", b"# OBJ", b"", b"M", b"MM", b"o OFF"] {
            assert_eq!(recognize(bytes), None, "{bytes:?}");
        }
    }
}
