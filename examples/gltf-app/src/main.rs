//! Reads baked assets by the names that the build script wrote: a name that is gone from a document does not compile.
//!
//! It plays the clip of the chest and prints where the lock goes, as a game would move it.

/// What was baked of the folder `assets`.
#[allow(dead_code, reason = "all names of all assets stand here")]
mod assets {
    include!(concat!(env!("OUT_DIR"), "/assets.rs"));
}

use assets::chest::{BOUNDS, BYTES, clips, materials, nodes};
use gltf::animation::util::ReadOutputs;
use gltf::{Document, Node};

/// A matrix by columns.
type Matrix = [[f32; 4]; 4];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(BYTES)?;
    let data = blob.ok_or("no data")?;
    println!("chest: {} bytes, {BOUNDS:?}", BYTES.len());
    println!("wide: {} bytes, {:?}", assets::chest_wide::BYTES.len(), assets::chest_wide::BOUNDS);
    for material in document.materials() {
        println!("material {}", material.name().unwrap_or_default());
    }
    assert!(document.materials().any(|material| material.name() == Some(materials::BRASS)));

    let clip = document.animations().find(|clip| clip.name() == Some(clips::OPEN)).ok_or("no clip")?;
    let channel = clip.channels().next().ok_or("no channel")?;
    let hinge = channel.target().node();
    assert_eq!(hinge.name(), Some(nodes::HINGE));
    let reader = channel.reader(|_| Some(data.as_slice()));
    let times: Vec<f32> = reader.read_inputs().ok_or("no times")?.collect();
    let Some(ReadOutputs::Rotations(rotations)) = reader.read_outputs() else {
        return Err("no rotations".into());
    };
    let rotations: Vec<[f32; 4]> = rotations.into_f32().collect();
    for (time, rotation) in times.iter().zip(&rotations) {
        let [_, y, z] = place(&document, nodes::LOCK, (hinge.index(), *rotation)).ok_or("no lock")?;
        println!("{time:.2} s: the lock is {y:.4} m up and {z:.4} m in front");
    }
    Ok(())
}

/// Where a node of a name stands while another one is turned.
fn place(document: &Document, name: &str, turned: (usize, [f32; 4])) -> Option<[f32; 3]> {
    fn below(node: &Node<'_>, outer: &Matrix, name: &str, turned: (usize, [f32; 4])) -> Option<[f32; 3]> {
        let (translation, mut rotation, scale) = node.transform().decomposed();
        if node.index() == turned.0 {
            rotation = turned.1;
        }
        let own = gltf::scene::Transform::Decomposed { translation, rotation, scale }.matrix();
        let whole = product(outer, &own);
        if node.name() == Some(name) {
            return Some([whole[3][0], whole[3][1], whole[3][2]]);
        }
        node.children().find_map(|child| below(&child, &whole, name, turned))
    }
    let identity = gltf::scene::Transform::Matrix { matrix: unit() }.matrix();
    let mut roots = document.default_scene()?.nodes();
    roots.find_map(|node| below(&node, &identity, name, turned))
}

fn unit() -> Matrix {
    std::array::from_fn(|column| std::array::from_fn(|row| if column == row { 1.0 } else { 0.0 }))
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let cell = |column: usize, row: usize| (0..4).map(|k| a[k][row] * b[column][k]).sum();
    std::array::from_fn(|column| std::array::from_fn(|row| cell(column, row)))
}
