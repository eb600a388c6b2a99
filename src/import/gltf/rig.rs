//! The joints of a file's skins, as they are bound and as they rest.

use glam::DAffine3;

use super::geometry::{affine, bound};
use super::{GltfFault, GltfFile, Place};

/// The joints of all skins of a file.
#[derive(Clone, Debug, Default)]
pub struct Rig {
    /// Parents before children.
    pub joints: Vec<RigJoint>,
}

/// A joint.
#[derive(Clone, Debug)]
pub struct RigJoint {
    /// Its node.
    pub node: usize,
    /// Its name, may be empty.
    pub name: String,
    /// The joint that carries it, through other nodes or not; an index in the rig.
    pub parent: Option<usize>,
    /// The map from it to the scene when its mesh is bound, which stands where its skin's first joint at rest brings it.
    pub bind: DAffine3,
    /// The nodes between it and its parent, or the scene.
    pub between: Vec<usize>,
    /// The map from its node's parent to the joint that carries it, or to the scene, at rest.
    pub before: DAffine3,
    /// Its place in its node's parent at rest.
    pub rest: Place,
}

impl GltfFile {
    /// The joints of all skins. Linear in the joints times their depth.
    ///
    /// # Errors
    /// When a matrix is broken, cannot be undone, or binds a joint elsewhere than another does.
    pub fn rig(&self) -> Result<Rig, GltfFault> {
        let (data, nodes, worlds) = (self.data(), self.nodes(), self.worlds());
        let mut binds: Vec<Option<DAffine3>> = vec![None; nodes.len()];
        for skin in self.document.skins() {
            let skin = super::skin(&data, &skin)?;
            let mesh = bound(&skin, &worlds);
            for (joint, inverse) in skin.joints.iter().zip(&skin.inverse) {
                let inverse = affine(inverse);
                let bind = mesh * inverse.inverse();
                if !(bind.is_finite() && inverse.matrix3.determinant() != 0.0) {
                    return Err(GltfFault::Bound(*joint, "by a matrix that cannot be undone"));
                }
                match binds[*joint] {
                    None => binds[*joint] = Some(bind),
                    Some(known) if alike(&known, &bind) => {}
                    Some(_) => return Err(GltfFault::Bound(*joint, "in different ways by several skins")),
                }
            }
        }
        // Parents stand before children in the order of a walk from the roots.
        let mut rig = Rig::default();
        let mut place: Vec<Option<usize>> = vec![None; nodes.len()];
        let mut open: Vec<usize> =
            (0..nodes.len()).rev().filter(|node| self.parents[*node].is_none()).collect();
        while let Some(node) = open.pop() {
            open.extend(nodes[node].children.iter().rev());
            let Some(bind) = binds[node] else { continue };
            let mut between = Vec::new();
            let mut next = self.parents[node];
            while let Some(above) = next.filter(|above| place[*above].is_none()) {
                between.push(above);
                next = self.parents[above];
            }
            let map = |map: DAffine3, node: &usize| affine(&nodes[*node].place.matrix()) * map;
            place[node] = Some(rig.joints.len());
            rig.joints.push(RigJoint {
                node,
                name: nodes[node].name.clone(),
                parent: next.and_then(|above| place[above]),
                bind,
                before: between.iter().fold(DAffine3::IDENTITY, map),
                between,
                rest: nodes[node].place,
            });
        }
        Ok(rig)
    }
}

/// Whether two maps are one but for rounding to single precision.
fn alike(a: &DAffine3, b: &DAffine3) -> bool {
    let size = a.translation.abs().max_element().max(a.matrix3.x_axis.length());
    a.abs_diff_eq(*b, 1e-4 * size)
}
