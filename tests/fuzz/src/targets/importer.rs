//! Any bytes as a file of each format: the first byte says which. Seeds: the gallery's inputs and the cases.

use crate::common::{LIMITS, bake};

const MESHES: [&str; 9] = ["obj", "ply", "stl", "md2", "md3", "md5mesh", "3ds", "dxf", "glb"];

pub(super) fn run(bytes: &[u8]) {
    let Some((first, rest)) = bytes.split_first() else { return };
    let kind = usize::from(*first) % (MESHES.len() + 7);
    if let Some(end) = MESHES.get(kind) {
        let file = format!("a.{end}");
        bake(&format!("[shape.a.import]\nfile = \"{file}\"\n{LIMITS}"), &[(&file, rest)]);
        return;
    }
    let (file, text) = match kind - MESHES.len() {
        0 => (
            "a.bvh",
            "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.import]\nfile = \"a.bvh\"\n[clip.c.import]\nfile = \"a.bvh\"\n",
        ),
        1 => ("a.3ds", "[node.a.import]\nfile = \"a.3ds\"\n"),
        2 => ("a.dxf", "[curve.c.dxf]\nfile = \"a.dxf\"\n[shape.b.extrude]\nprofile = \"c\"\nheight = 1\n"),
        3 => (
            "a.glb",
            "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.import]\nfile = \"a.glb\"\n[clip.c.import]\nfile = \"a.glb\"\n",
        ),
        4 => (
            "a.png",
            "tolerance = 0.2\n[shape.a.height-map]\nsize = [1, 1]\nmap = { image = { file = \"a.png\" } }\n",
        ),
        5 => (
            "a.asc",
            "tolerance = 0.2\n[shape.a.height-map]\nsize = [1, 1]\nmap = { grid = { file = \"a.asc\" } }\n",
        ),
        _ => (
            "a.png",
            "[material.m]\ncolor-texture = \"a.png\"\n[shape.a]\nmaterial = \"m\"\n[shape.a.box]\nsize = [1, 1, 1]\n",
        ),
    };
    bake(&format!("{text}{LIMITS}"), &[(file, rest)]);
}
