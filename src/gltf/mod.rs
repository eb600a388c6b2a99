//! The gltf stage.
