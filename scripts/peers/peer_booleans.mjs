// Manifold from npm: two balls, one without the other; the file is written here. `peer_booleans.mjs OUT.glb`
import fs from 'node:fs';
import Module from 'manifold-3d';

const SEGMENTS = 448; // of the equator: 100 352 triangles

// A binary glTF file of bare triangles.
function file(positions, indices) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  positions.forEach((value, place) => {
    low[place % 3] = Math.min(low[place % 3], value);
    high[place % 3] = Math.max(high[place % 3], value);
  });
  const views = [positions, indices].map((array) => Buffer.from(array.buffer, array.byteOffset, array.byteLength));
  const data = Buffer.concat(views);
  const json = Buffer.from(JSON.stringify({
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: positions.length / 3, type: 'VEC3', min: low, max: high },
      { bufferView: 1, componentType: 5125, count: indices.length, type: 'SCALAR' },
    ],
    bufferViews: [
      { buffer: 0, byteLength: views[0].length },
      { buffer: 0, byteOffset: views[0].length, byteLength: views[1].length },
    ],
    buffers: [{ byteLength: data.length }],
  }));
  const text = Buffer.concat([json, Buffer.alloc((4 - (json.length % 4)) % 4, ' ')]);
  const head = Buffer.alloc(20);
  const tail = Buffer.alloc(8);
  [0x46546c67, 2, 28 + text.length + data.length, text.length, 0x4e4f534a].forEach((n, k) => head.writeUInt32LE(n, 4 * k));
  [data.length, 0x004e4942].forEach((n, k) => tail.writeUInt32LE(n, 4 * k));
  return Buffer.concat([head, text, tail, data]);
}

const library = await Module();
library.setup();
const ball = library.Manifold.sphere(1, SEGMENTS);
const made = ball.subtract(ball.translate([0.7, 0.2, 0.1])).getMesh();
fs.writeFileSync(process.argv[2], file(made.vertProperties, made.triVerts));
