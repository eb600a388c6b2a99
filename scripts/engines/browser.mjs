// What engines cover of a picture in a real browser: one browser, a page for each engine, all files one after another.
// The camera is parallel; every surface is drawn on both sides, without its material, since what is asked is where things are.
// node browser.mjs ASKED.json > FOUND.json
// ASKED: { size, engines: [NAME], files: [{ path, camera: { right, up, back, middle, extent, depth }, hidden: [MESH] }] }
// FOUND: for each engine { complaints: [TEXT], covered: [BASE64 or null], errors: [TEXT or null] }, in the order of the files; a row
// of pixels from the top after another, eight to a byte, the first in the highest bit.
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';
import { launch, open } from './chromium.mjs';

const MODULES = path.join(import.meta.dirname, '..', 'node_modules');
const DECODER = 'three/examples/jsm/libs/meshopt_decoder.module.js';

// Shared by both pages: rows of pixels as they are read, the lowest first, into bits.
const BITS = `
const bits = (pixels, size) => {
  const bytes = new Uint8Array(Math.ceil(size * size / 8));
  for (let row = 0; row < size; row += 1)
    for (let column = 0; column < size; column += 1)
      if (pixels[4 * ((size - 1 - row) * size + column) + 3] > 0) {
        const at = row * size + column;
        bytes[at >> 3] |= 128 >> (at & 7);
      }
  return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(''));
};`;

const PAGES = {
  three: `<!doctype html><link rel="icon" href="data:,"><script type="importmap">
{ "imports": { "three": "/modules/three/build/three.module.js", "three/addons/": "/modules/three/examples/jsm/" } }</script>
<script type="module">
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
${BITS}
const plain = new THREE.MeshBasicMaterial({ side: THREE.DoubleSide });
let renderer;

window.drawn = async (address, size, camera, hidden) => {
  renderer ??= new THREE.WebGLRenderer({ alpha: true, antialias: true, preserveDrawingBuffer: true });
  renderer.setPixelRatio(1);
  renderer.setSize(size, size);
  const loaded = await new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).loadAsync(address);
  const scene = loaded.scene;
  const names = (loaded.parser.json.meshes ?? []).map((mesh) => mesh.name);
  scene.traverse((object) => {
    if (object.isLine || object.isPoints) object.material.visible = false;
    if (!object.isMesh) return;
    object.frustumCulled = false;
    object.material = plain;
    if (hidden.includes(names[loaded.parser.associations.get(object)?.meshes])) object.geometry = new THREE.BufferGeometry();
  });
  const half = camera.extent / (1 - 2 * 0.06) / 2;
  const span = camera.extent + camera.depth;
  const eye = new THREE.OrthographicCamera(-half, half, half, -half, 1e-4 * span, 10 * span);
  const [right, up, back] = [camera.right, camera.up, camera.back].map((axis) => new THREE.Vector3(...axis));
  eye.position.set(...camera.middle).addScaledVector(back, span);
  eye.quaternion.setFromRotationMatrix(new THREE.Matrix4().makeBasis(right, up, back));
  renderer.render(scene, eye);
  const gl = renderer.getContext();
  const pixels = new Uint8Array(4 * size * size);
  gl.readPixels(0, 0, size, size, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  scene.traverse((object) => object.geometry?.dispose());
  return bits(pixels, size);
};
window.ready = true;
</script>`,
  babylon: `<!doctype html><link rel="icon" href="data:,"><canvas id="canvas"></canvas>
<script src="/modules/babylonjs/babylon.js"></script>
<script src="/modules/babylonjs-loaders/babylonjs.loaders.min.js"></script>
<script>
${BITS}
BABYLON.MeshoptCompression.Configuration.decoder.url = '/decoder.js';
BABYLON.SceneLoader.ShowLoadingScreen = false;
let engine;
let complete;
BABYLON.SceneLoader.OnPluginActivatedObservable.add((loader) => {
  if (loader.name !== 'gltf') return;
  loader.animationStartMode = BABYLON.GLTFLoaderAnimationStartMode.NONE;
  // The finest level of detail is loaded last.
  complete = new Promise((done) => loader.onCompleteObservable.addOnce(done));
});

window.drawn = async (address, size, camera, hidden, names) => {
  const canvas = document.getElementById('canvas');
  if (!engine) {
    [canvas.width, canvas.height] = [size, size];
    engine = new BABYLON.Engine(canvas, true, { preserveDrawingBuffer: true, premultipliedAlpha: false });
  }
  const scene = new BABYLON.Scene(engine);
  scene.useRightHandedSystem = true;
  scene.clearColor = new BABYLON.Color4(0, 0, 0, 0);
  await BABYLON.SceneLoader.AppendAsync('', address, scene, undefined, '.glb');
  await complete;
  const plain = new BABYLON.StandardMaterial('plain', scene);
  plain.disableLighting = true;
  plain.emissiveColor = BABYLON.Color3.White();
  plain.backFaceCulling = false;
  for (const mesh of scene.meshes) {
    mesh.alwaysSelectAsActiveMesh = true;
    const pointers = mesh._internalMetadata?.gltf?.pointers ?? [];
    const own = pointers.map((pointer) => /^\\/meshes\\/(\\d+)/.exec(pointer)?.[1]).filter((index) => index !== undefined);
    const lines = mesh.material && mesh.material.fillMode >= BABYLON.Material.PointListDrawMode;
    if (lines || own.some((index) => hidden.includes(names[index]))) mesh.visibility = 0;
    mesh.hasVertexAlpha = false;
    mesh.material = plain;
  }
  const half = camera.extent / (1 - 2 * 0.06) / 2;
  const span = camera.extent + camera.depth;
  const back = new BABYLON.Vector3(...camera.back);
  const middle = new BABYLON.Vector3(...camera.middle);
  const eye = new BABYLON.TargetCamera('eye', middle.add(back.scale(span)), scene);
  eye.mode = BABYLON.Camera.ORTHOGRAPHIC_CAMERA;
  [eye.orthoLeft, eye.orthoRight, eye.orthoBottom, eye.orthoTop] = [-half, half, -half, half];
  [eye.minZ, eye.maxZ] = [1e-4 * span, 10 * span];
  eye.upVector = new BABYLON.Vector3(...camera.up);
  eye.setTarget(middle);
  scene.activeCamera = eye;
  await scene.whenReadyAsync();
  scene.render();
  const pixels = await engine.readPixels(0, 0, size, size);
  scene.dispose();
  return bits(pixels, size);
};
window.ready = true;
</script>`,
};
const KINDS = { '.js': 'text/javascript', '.glb': 'model/gltf-binary' };

const asked = JSON.parse(fs.readFileSync(process.argv[2], 'utf8'));

// What a page asks for: itself, a file by its number with the pictures beside it, or a module.
function answered(address) {
  if (address in PAGES) return [PAGES[address], 'text/html'];
  if (address === 'decoder.js') {
    const module = fs.readFileSync(path.join(MODULES, DECODER), 'utf8');
    return [module.replace(/export\s*\{\s*MeshoptDecoder\s*\}/, 'globalThis.MeshoptDecoder = MeshoptDecoder'), KINDS['.js']];
  }
  const [, number, beside] = /^files\/(\d+)\/(.*)$/.exec(address) ?? [];
  const file = number === undefined
    ? path.join(MODULES, path.normalize(address.replace(/^modules\//, '')))
    : path.join(path.dirname(asked.files[Number(number)].path), path.basename(beside));
  if (!fs.existsSync(file)) return undefined;
  return [fs.readFileSync(file), KINDS[path.extname(file)] ?? 'application/octet-stream'];
}

// Names of the meshes of a file, in its order.
function meshNames(file) {
  const bytes = fs.readFileSync(file);
  const json = JSON.parse(bytes.toString('utf8', 20, 20 + bytes.readUInt32LE(12)));
  return (json.meshes ?? []).map((mesh) => mesh.name);
}

const server = http.createServer((request, response) => {
  const found = answered(decodeURIComponent(new URL(request.url, 'http://local').pathname.slice(1)));
  if (found === undefined) response.writeHead(404).end();
  else response.writeHead(200, { 'content-type': found[1] }).end(found[0]);
});
await new Promise((listening) => server.listen(0, '127.0.0.1', listening));
const result = {};
const browser = await launch();
try {
  for (const engine of asked.engines) {
    const found = { complaints: [], covered: [], errors: [] };
    const page = await open(browser, `http://127.0.0.1:${server.address().port}/${engine}`, found.complaints);
    await page.waitForFunction('window.ready');
    for (const [number, file] of asked.files.entries()) {
      const address = `/files/${number}/${path.basename(file.path)}`;
      try {
        const own = [address, asked.size, file.camera, file.hidden, meshNames(file.path)];
        found.covered.push(await page.evaluate((one) => window.drawn(...one), own));
        found.errors.push(null);
      } catch (error) {
        found.covered.push(null);
        found.errors.push(String(error.message ?? error));
      }
    }
    await page.close();
    result[engine] = found;
  }
} finally {
  await browser.close();
  server.close();
}
console.log(JSON.stringify(result));
