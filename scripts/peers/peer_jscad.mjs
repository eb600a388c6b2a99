// JSCAD: extrudeRotate and extrudeFromSlices; the file is written here, as JSCAD writes no glTF. CASE IN OUT
import fs from 'node:fs';
import modeling from '@jscad/modeling';

const { extrusions, geometries, primitives } = modeling;

function vase({ profile, turns }) {
  return extrusions.extrudeRotate({ segments: turns }, primitives.polygon({ points: profile }));
}

function sweep({ path, frames, radius, sides }) {
  const circle = primitives.circle({ radius, segments: sides });
  const base = extrusions.slice.fromSides(geometries.geom2.toSides(circle));
  const callback = (_, index) => {
    const [normal, binormal, tangent] = frames[index];
    return extrusions.slice.transform([...normal, 0, ...binormal, 0, ...tangent, 0, ...path[index], 1], base);
  };
  return extrusions.extrudeFromSlices({ numberOfSlices: path.length, callback }, base);
}

// Polygons as fans over vertices that are equal exactly.
function triangles(solid) {
  const known = new Map();
  const positions = [];
  const indices = [];
  const vertex = (point) => {
    const key = point.join();
    if (!known.has(key)) {
      known.set(key, positions.length / 3);
      positions.push(...point);
    }
    return known.get(key);
  };
  for (const polygon of geometries.geom3.toPolygons(solid)) {
    const corners = polygon.vertices.map(vertex);
    for (let i = 1; i + 1 < corners.length; i++) indices.push(corners[0], corners[i], corners[i + 1]);
  }
  return { positions: new Float32Array(positions), indices: new Uint32Array(indices) };
}

function write(file, { positions, indices }) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  positions.forEach((value, i) => {
    low[i % 3] = Math.min(low[i % 3], value);
    high[i % 3] = Math.max(high[i % 3], value);
  });
  const size = positions.byteLength + indices.byteLength;
  const document = {
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    buffers: [{ byteLength: size }],
    bufferViews: [
      { buffer: 0, byteLength: positions.byteLength, target: 34962 },
      { buffer: 0, byteOffset: positions.byteLength, byteLength: indices.byteLength, target: 34963 },
    ],
    accessors: [
      { bufferView: 0, componentType: 5126, count: positions.length / 3, type: 'VEC3', min: low, max: high },
      { bufferView: 1, componentType: 5125, count: indices.length, type: 'SCALAR' },
    ],
  };
  let text = Buffer.from(JSON.stringify(document));
  text = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, 0x20)]);
  const head = Buffer.alloc(20);
  head.write('glTF', 0, 'latin1');
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(28 + text.length + size, 8);
  head.writeUInt32LE(text.length, 12);
  head.write('JSON', 16, 'latin1');
  const chunk = Buffer.alloc(8);
  chunk.writeUInt32LE(size, 0);
  chunk.write('BIN\0', 4, 'latin1');
  fs.writeFileSync(file, Buffer.concat([head, text, chunk, Buffer.from(positions.buffer), Buffer.from(indices.buffer)]));
}

const [name, input, out] = process.argv.slice(2);
write(out, triangles({ vase, sweep }[name](JSON.parse(fs.readFileSync(input, 'utf8')))));
