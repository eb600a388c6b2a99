// What three.js covers of a picture in a real browser, seen along a direction: as Blender's silhouettes, by a parallel camera
// that holds the projections of all vertices with six percent of the picture free on each side. Prints for each file a row of 0
// and 1 for each row of pixels, from the top, as JSON, with what the console complained of.
// node silhouettes.mjs SIZE AZIMUTH ELEVATION FILE.glb...
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';
import { launch, open } from './browser.mjs';

const THREE = path.join(import.meta.dirname, '..', '..', 'scripts', 'node_modules', 'three');
const PAGE = `<!doctype html><link rel="icon" href="data:,"><script type="importmap">
{ "imports": { "three": "/three/build/three.module.js", "three/addons/": "/three/examples/jsm/" } }</script>
<script type="module">
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';

function places(scene) {
  const all = [];
  const matrix = new THREE.Matrix4();
  scene.traverse((object) => {
    if (!object.isMesh) return;
    const position = object.geometry.attributes.position;
    object.skeleton?.update();
    for (let copy = 0; copy < (object.isInstancedMesh ? object.count : 1); copy += 1) {
      matrix.identity();
      if (object.isInstancedMesh) object.getMatrixAt(copy, matrix);
      matrix.premultiply(object.matrixWorld);
      for (let at = 0; at < position.count; at += 1)
        all.push(object.getVertexPosition(at, new THREE.Vector3()).applyMatrix4(matrix));
    }
  });
  return all;
}

window.drawn = async (address, size, azimuth, elevation) => {
  const scene = (await new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).loadAsync(address)).scene;
  scene.updateMatrixWorld(true);
  const [turn, raised] = [azimuth, elevation].map(THREE.MathUtils.degToRad);
  const back = new THREE.Vector3(Math.sin(turn) * Math.cos(raised), Math.sin(raised), Math.cos(turn) * Math.cos(raised));
  const right = new THREE.Vector3(Math.cos(turn), 0, -Math.sin(turn));
  const up = back.clone().cross(right);
  const all = places(scene);
  const spans = [right, up, back].map((axis) => all.reduce(
    ([low, high], place) => [Math.min(low, place.dot(axis)), Math.max(high, place.dot(axis))], [Infinity, -Infinity]));
  const [wide, high, deep] = spans.map(([low, most]) => most - low);
  const extent = Math.max(wide, high);
  const half = extent / (1 - 2 * 0.06) / 2;
  const camera = new THREE.OrthographicCamera(-half, half, half, -half, 1e-4 * (extent + deep), 10 * (extent + deep));
  const middle = spans.map(([low, most]) => (low + most) / 2);
  camera.position.addScaledVector(right, middle[0]).addScaledVector(up, middle[1]).addScaledVector(back, spans[2][1] + extent + deep);
  camera.quaternion.setFromRotationMatrix(new THREE.Matrix4().makeBasis(right, up, back));
  const renderer = new THREE.WebGLRenderer({ alpha: true, antialias: false, preserveDrawingBuffer: true });
  renderer.setPixelRatio(1);
  renderer.setSize(size, size);
  renderer.render(scene, camera);
  const gl = renderer.getContext();
  const pixels = new Uint8Array(4 * size * size);
  gl.readPixels(0, 0, size, size, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  renderer.dispose();
  // The first row that is read is the lowest.
  return Array.from({ length: size }, (_, row) => Array.from({ length: size },
    (_, column) => (pixels[4 * ((size - 1 - row) * size + column) + 3] > 0 ? 1 : 0)).join(''));
};
window.ready = true;
</script>`;
const KINDS = { '.js': 'text/javascript', '.glb': 'model/gltf-binary' };

const [size, azimuth, elevation, ...files] = process.argv.slice(2);
const server = http.createServer((asked, answer) => {
  const address = new URL(asked.url, 'http://local').pathname;
  const number = /^\/(\d+)\.glb$/.exec(address)?.[1];
  const file = number !== undefined ? files[Number(number)] : path.join(THREE, path.normalize(address.replace(/^\/three\//, '')));
  if (address === '/') {
    answer.setHeader('content-type', 'text/html');
    answer.end(PAGE);
  } else if (fs.existsSync(file)) {
    answer.setHeader('content-type', KINDS[path.extname(file)] ?? 'application/octet-stream');
    answer.end(fs.readFileSync(file));
  } else {
    answer.statusCode = 404;
    answer.end();
  }
});
await new Promise((listening) => server.listen(0, '127.0.0.1', listening));
const found = { complaints: [], covered: [] };
const browser = await launch();
try {
  const page = await open(browser, `http://127.0.0.1:${server.address().port}/`, found.complaints);
  await page.waitForFunction('window.ready');
  for (const number of files.keys())
    found.covered.push(await page.evaluate((asked) => window.drawn(...asked), [`/${number}.glb`, Number(size), Number(azimuth), Number(elevation)]));
} finally {
  await browser.close();
  server.close();
}
console.log(JSON.stringify(found));
