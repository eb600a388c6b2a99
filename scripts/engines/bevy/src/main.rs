//! `bevy-check FILE.glb...`: loads each file as a game does, and prints for each a line of JSON with what Bevy made of it: counts
//! of meshes, primitives, triangles, vertices and materials, names of nodes, meshes and clips with their seconds, joints of each skin,
//! morph targets of each mesh that has some. A file that Bevy refuses has a line with its `error`.

use std::time::{Duration, Instant};

use bevy_animation::AnimationClip;
use bevy_animation::graph::AnimationGraph;
use bevy_app::{App, ScheduleRunnerPlugin, TaskPoolPlugin};
use bevy_asset::{
    AssetApp, AssetPlugin, AssetServer, Assets, Handle, LoadState, RecursiveDependencyLoadState,
    UnapprovedPathMode,
};
use bevy_gltf::{Gltf, GltfMesh, GltfPlugin, GltfSkin};
use bevy_image::ImagePlugin;
use bevy_mesh::{Mesh, MeshPlugin};
use bevy_world_serialization::WorldSerializationPlugin;
use serde_json::{Value, json};

/// A file that takes longer is stuck.
const PATIENCE: Duration = Duration::from_secs(120);

fn main() {
    let mut app = App::new();
    let anywhere = AssetPlugin {
        file_path: "/".to_owned(),
        unapproved_path_mode: UnapprovedPathMode::Allow,
        ..Default::default()
    };
    app.add_plugins((TaskPoolPlugin::default(), ScheduleRunnerPlugin::default(), anywhere));
    app.add_plugins((ImagePlugin::default(), MeshPlugin, WorldSerializationPlugin, GltfPlugin::default()));
    app.init_asset::<AnimationClip>().init_asset::<AnimationGraph>();
    app.finish();
    app.cleanup();
    for file in std::env::args().skip(1) {
        let found = loaded(&mut app, file)
            .map_or_else(|error| json!({ "error": error }), |handle| counted(&app, &handle));
        println!("{found}");
    }
}

/// Loads a file with all that it needs.
fn loaded(app: &mut App, file: String) -> Result<Handle<Gltf>, String> {
    let server = app.world().resource::<AssetServer>().clone();
    let handle: Handle<Gltf> = server.load(file);
    let started = Instant::now();
    loop {
        app.update();
        if let LoadState::Failed(error) = server.load_state(&handle) {
            return Err(error.to_string());
        }
        match server.recursive_dependency_load_state(&handle) {
            RecursiveDependencyLoadState::Loaded => return Ok(handle),
            RecursiveDependencyLoadState::Failed(error) => return Err(error.to_string()),
            _ if started.elapsed() > PATIENCE => return Err("it is not loaded after two minutes".to_owned()),
            _ => std::thread::yield_now(),
        }
    }
}

/// What stands in a loaded file.
fn counted(app: &App, handle: &Handle<Gltf>) -> Value {
    let world = app.world();
    let Some(file) = world.resource::<Assets<Gltf>>().get(handle) else {
        return json!({ "error": "it is gone" });
    };
    let all: Vec<&GltfMesh> =
        file.meshes.iter().filter_map(|mesh| world.resource::<Assets<GltfMesh>>().get(mesh)).collect();
    let meshes = world.resource::<Assets<Mesh>>();
    let (mut primitives, mut triangles, mut vertices, mut targets) = (0, 0, 0, Vec::new());
    for mesh in &all {
        let mut states = 0;
        for one in mesh.primitives.iter().filter_map(|primitive| meshes.get(&primitive.mesh)) {
            primitives += 1;
            vertices += one.count_vertices();
            if one.primitive_topology() == bevy_mesh::PrimitiveTopology::TriangleList {
                triangles += one.indices().map_or(one.count_vertices(), |indices| indices.len()) / 3;
            }
            states = states.max(one.morph_target_names().map_or(0, <[String]>::len));
        }
        if states > 0 {
            targets.push(states);
        }
    }
    targets.sort_unstable();
    let mut skins: Vec<usize> = file
        .skins
        .iter()
        .filter_map(|skin| world.resource::<Assets<GltfSkin>>().get(skin))
        .map(|skin| skin.joints.len())
        .collect();
    skins.sort_unstable();
    let clips = world.resource::<Assets<AnimationClip>>();
    let seconds = |clip: &Handle<AnimationClip>| clips.get(clip).map(AnimationClip::duration);
    let clips: serde_json::Map<String, Value> =
        file.named_animations.iter().map(|(name, clip)| (name.to_string(), json!(seconds(clip)))).collect();
    let mut nodes: Vec<&str> = file.named_nodes.keys().map(AsRef::as_ref).collect();
    nodes.sort_unstable();
    let mut names: Vec<&str> = all.iter().map(|mesh| mesh.name.as_str()).collect();
    names.sort_unstable();
    json!({
        "meshes": names, "primitives": primitives, "triangles": triangles, "vertices": vertices, "materials": file.materials.len(),
        "nodes": nodes, "skins": skins, "targets": targets, "clips": clips, "scenes": file.scenes.len(),
    })
}
