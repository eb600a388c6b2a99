// What three.js finds when it loads the file and plays its clips: world matrices at rest, and at the times that the
// report names, poses of joints and moving nodes and places of vertices that joints carry or weights move.
// node checks/three.mjs OUT.json FILE...
import fs from 'node:fs';
import * as THREE from 'three';
import { MeshoptDecoder } from 'three/examples/jsm/libs/meshopt_decoder.module.js';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

globalThis.self ??= globalThis;

// Looks are taken out: there is no place for pictures without a browser.
function withoutLooks(bytes) {
  const length = bytes.readUInt32LE(12);
  const document = JSON.parse(bytes.subarray(20, 20 + length).toString('utf8'));
  for (const key of ['materials', 'textures', 'images', 'samplers']) delete document[key];
  for (const mesh of document.meshes ?? []) for (const primitive of mesh.primitives) delete primitive.material;
  let text = Buffer.from(JSON.stringify(document), 'utf8');
  text = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, 0x20)]);
  const head = Buffer.alloc(20);
  const rest = bytes.subarray(20 + length);
  head.writeUInt32LE(0x46546c67, 0);
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(20 + text.length + rest.length, 8);
  head.writeUInt32LE(text.length, 12);
  head.writeUInt32LE(0x4e4f534a, 16);
  const whole = Buffer.concat([head, text, rest]);
  return { document, buffer: whole.buffer.slice(whole.byteOffset, whole.byteOffset + whole.length) };
}

function load(buffer) {
  const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
  return new Promise((resolve, reject) => loader.parse(buffer, '', resolve, reject));
}

// The loaded objects by the names of the file's nodes.
function byName(gltf, document) {
  const objects = new Map();
  gltf.scene.traverse((object) => {
    const index = gltf.parser.associations.get(object)?.nodes;
    const name = document.nodes[index]?.name;
    if (name !== undefined && !objects.has(name)) objects.set(name, object);
  });
  return objects;
}

// World matrices of the copies of a mesh that are drawn at once, by the names that they have as nodes. Those of a mesh of whole
// numbers hold the step and the offset of its grid.
function copies(gltf, document) {
  const found = new Map();
  const { step = 1, offset = [0, 0, 0] } = document.asset.extras?.grid ?? {};
  const metres = new THREE.Matrix4().makeTranslation(...offset).scale(new THREE.Vector3(step, step, step)).invert();
  gltf.scene.traverse((object) => {
    if (!object.isInstancedMesh) return;
    const index = gltf.parser.associations.get(object)?.nodes ?? gltf.parser.associations.get(object.parent)?.nodes;
    for (let copy = 0; copy < object.count; copy += 1) {
      const matrix = new THREE.Matrix4();
      object.getMatrixAt(copy, matrix);
      found.set(`${document.nodes[index].name}.${copy}`, matrix.premultiply(object.matrixWorld).multiply(metres));
    }
  });
  return found;
}

// The first object of each mesh that joints carry or weights move.
function movedByMesh(gltf, document) {
  const meshes = new Map();
  gltf.scene.traverse((object) => {
    const index = gltf.parser.associations.get(object)?.meshes;
    const moves = object.isSkinnedMesh || object.morphTargetInfluences !== undefined;
    if (moves && index !== undefined && !meshes.has(document.meshes[index].name))
      meshes.set(document.meshes[index].name, object);
  });
  return meshes;
}

function pose(asked, gltf, objects, meshes) {
  gltf.scene.updateMatrixWorld(true);
  const nodes = {};
  for (const name of Object.keys(asked.nodes)) nodes[name] = objects.get(name)?.matrixWorld.toArray() ?? null;
  const vertices = {};
  const place = new THREE.Vector3();
  for (const [name, list] of Object.entries(asked.vertices)) {
    const mesh = meshes.get(name);
    mesh?.skeleton?.update();
    vertices[name] = list.map(({ vertex }) => {
      if (mesh === undefined) return null;
      mesh.getVertexPosition(vertex, place);
      return mesh.localToWorld(place).toArray();
    });
  }
  return { time: asked.time, nodes, vertices };
}

function play(gltf, clips, objects, meshes) {
  const found = {};
  for (const [name, asked] of Object.entries(clips)) {
    const clip = gltf.animations.find((clip) => clip.name === name);
    if (clip === undefined) continue;
    const mixer = new THREE.AnimationMixer(gltf.scene);
    const action = mixer.clipAction(clip);
    action.setLoop(THREE.LoopOnce);
    action.clampWhenFinished = true;
    action.play();
    found[name] = asked.poses.map((one) => {
      action.reset();
      mixer.setTime(one.time);
      return pose(one, gltf, objects, meshes);
    });
    mixer.stopAllAction();
  }
  return found;
}

async function measure(file) {
  const measured = { tool: 'three', version: THREE.REVISION, file, totals: {}, shapes: {}, nodes: {}, clips: {}, error: null };
  try {
    const { document, buffer } = withoutLooks(fs.readFileSync(file));
    const gltf = await load(buffer);
    const objects = byName(gltf, document);
    gltf.scene.updateMatrixWorld(true);
    measured.totals = { nodes: objects.size };
    for (const [name, object] of objects) measured.nodes[name] = object.matrixWorld.toArray();
    for (const [name, matrix] of copies(gltf, document)) measured.nodes[name] = matrix.toArray();
    measured.totals.nodes = Object.keys(measured.nodes).length;
    const report = file.replace(/\.glb$/, '.report.json');
    const clips = fs.existsSync(report) ? (JSON.parse(fs.readFileSync(report, 'utf8')).clips ?? {}) : {};
    measured.clips = play(gltf, clips, objects, movedByMesh(gltf, document));
  } catch (error) {
    measured.error = String(error);
  }
  return measured;
}

const [out, ...files] = process.argv.slice(2);
const measured = [];
for (const file of files) measured.push(await measure(file));
fs.writeFileSync(out, JSON.stringify(measured));
