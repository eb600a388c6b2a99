// What three.js makes of the materials of a file without pictures: numbers by name, colors linear.
// node tests/crosscheck/looks.mjs FILE
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const scripts = createRequire(path.join(import.meta.dirname, '..', '..', 'scripts', 'package.json'));
const bring = (name) => import(pathToFileURL(scripts.resolve(name)));
globalThis.self ??= globalThis;
const { GLTFLoader } = await bring('three/examples/jsm/loaders/GLTFLoader.js');
const { MeshoptDecoder } = await bring('three/examples/jsm/libs/meshopt_decoder.module.js');

const bytes = fs.readFileSync(process.argv[2]);
const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
const gltf = await new Promise((resolve, reject) => loader.parse(buffer, '', resolve, reject));
const told = {};
gltf.scene.updateMatrixWorld(true);
gltf.scene.traverse((object) => {
  if (object.material === undefined) return;
  const look = { type: object.material.type, scale: object.matrixWorld.getMaxScaleOnAxis() };
  look.tangents = object.geometry.attributes.tangent !== undefined;
  for (const [name, value] of Object.entries(object.material)) {
    if (Number.isFinite(value)) look[name] = value;
    else if (value?.isColor) look[name] = value.toArray();
  }
  // Those of a physical material stand behind getters.
  const hidden = ['anisotropy', 'clearcoat', 'dispersion', 'iridescence', 'ior', 'sheen', 'transmission'];
  for (const name of hidden) look[name] = object.material[name];
  told[object.material.name] = look;
});
console.log(JSON.stringify(told));
