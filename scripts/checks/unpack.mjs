// Files of the profiles `quantized` and `web` as files of floats, for tools that read no others: views decompressed by
// meshoptimizer's own decoder, whole numbers divided as the specification says, positions taken to metres by the node
// that carries each mesh, which is then left out. Copies that are places of one node become nodes below it, `NODE.0`...
// node checks/unpack.mjs FOLDER FILE...   writes each file under its own name into FOLDER
import fs from 'node:fs';
import path from 'node:path';
import { MeshoptDecoder } from 'three/examples/jsm/libs/meshopt_decoder.module.js';

const PACKED = 'EXT_meshopt_compression';
const INSTANCES = 'EXT_mesh_gpu_instancing';
const TAKEN = [PACKED, INSTANCES, 'KHR_mesh_quantization'];
const ARRAYS = { 5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };
const WIDTHS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT4: 16 };
const MOST = { 5120: 127, 5121: 255, 5122: 32767, 5123: 65535 };

function split(bytes) {
  const length = bytes.readUInt32LE(12);
  return { document: JSON.parse(bytes.subarray(20, 20 + length).toString('utf8')), binary: bytes.subarray(28 + length) };
}

function joined(document, binary) {
  let text = Buffer.from(JSON.stringify(document), 'utf8');
  text = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, 0x20)]);
  const words = (...numbers) => Buffer.from(Uint32Array.from(numbers).buffer);
  const chunks = [words(text.length, 0x4e4f534a), text, words(binary.length, 0x004e4942), binary];
  return Buffer.concat([words(0x46546c67, 2, 12 + chunks.reduce((sum, chunk) => sum + chunk.length, 0)), ...chunks]);
}

// The plain bytes of every view.
function views(document, binary) {
  return (document.bufferViews ?? []).map((view) => {
    const packed = view.extensions?.[PACKED];
    const { byteOffset = 0, byteLength } = packed ?? view;
    const source = binary.subarray(byteOffset, byteOffset + byteLength);
    if (packed === undefined) return new Uint8Array(source);
    const plain = new Uint8Array(packed.count * packed.byteStride);
    MeshoptDecoder.decodeGltfBuffer(plain, packed.count, packed.byteStride, source, packed.mode, packed.filter ?? 'NONE');
    return plain;
  });
}

// The numbers of an accessor as they stand, and as the specification divides them.
function numbers(document, plain, accessor) {
  const width = WIDTHS[accessor.type];
  const divided = (number) => (accessor.normalized ? Math.max(number / MOST[accessor.componentType], -1) : number);
  const rows = (where, componentType, count, columns) => {
    const Kind = ARRAYS[componentType];
    const stride = document.bufferViews[where.bufferView].byteStride ?? columns * Kind.BYTES_PER_ELEMENT;
    const bytes = plain[where.bufferView];
    const data = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    const get = `get${Kind.name.replace('Array', '')}`;
    const found = new Float64Array(count * columns);
    for (let row = 0; row < count; row += 1)
      for (let column = 0; column < columns; column += 1)
        found[row * columns + column] = data[get]((where.byteOffset ?? 0) + row * stride + column * Kind.BYTES_PER_ELEMENT, true);
    return found;
  };
  const found =
    accessor.bufferView === undefined
      ? new Float64Array(accessor.count * width)
      : rows(accessor, accessor.componentType, accessor.count, width);
  if (accessor.sparse !== undefined) {
    const { count, indices, values } = accessor.sparse;
    const changed = rows(values, accessor.componentType, count, width);
    rows(indices, indices.componentType, count, 1).forEach((place, at) => {
      for (let column = 0; column < width; column += 1) found[place * width + column] = changed[at * width + column];
    });
  }
  return found.map(divided);
}

function unpack(bytes) {
  const { document, binary } = split(bytes);
  const plain = views(document, binary);
  const carriers = (document.nodes ?? [])
    .map((node, index) => ({ node, index }))
    .filter(({ node }) => node.name === undefined && node.mesh !== undefined && node.children === undefined);
  const placing = carriers.find(({ node }) => node.scale !== undefined)?.node;
  const grid = placing
    ? { step: Math.fround(placing.scale[0]), offset: placing.translation.map(Math.fround) }
    : document.asset.extras?.grid;
  const floats = new Map();
  const asFloats = (index, map) => {
    if (!floats.has(index)) floats.set(index, map(numbers(document, plain, document.accessors[index])));
  };
  for (const mesh of document.meshes ?? [])
    for (const primitive of mesh.primitives) {
      for (const [name, index] of (primitive.targets ?? []).flatMap(Object.entries))
        asFloats(index, (all) => (name === 'POSITION' && grid !== undefined ? all.map((number) => Math.fround(number * grid.step)) : all));
      for (const [name, index] of Object.entries(primitive.attributes)) {
        const { componentType } = document.accessors[index];
        if (name === 'POSITION' && componentType === 5123)
          asFloats(index, (all) => all.map((number, at) => Math.fround(number * grid.step + grid.offset[at % 3])));
        else if (/^(NORMAL|TANGENT|TEXCOORD_)/.test(name) && componentType !== 5126) asFloats(index, (all) => all);
      }
    }
  const quantized = document.extensionsRequired?.includes('KHR_mesh_quantization') && grid !== undefined;
  for (const skin of quantized ? (document.skins ?? []) : [])
    asFloats(skin.inverseBindMatrices, (all) => fromMetres(all, grid));
  // Every view once as it is, then one for each list of floats.
  const out = plain.map((view) => Buffer.from(view));
  for (const view of document.bufferViews ?? []) delete view.extensions;
  for (const [index, all] of floats) {
    const accessor = document.accessors[index];
    const width = WIDTHS[accessor.type];
    out.push(Buffer.from(Float32Array.from(all).buffer));
    document.bufferViews.push({ buffer: 0, byteLength: 0, target: document.bufferViews[accessor.bufferView]?.target });
    Object.assign(accessor, { bufferView: out.length - 1, byteOffset: 0, componentType: 5126 });
    delete accessor.normalized;
    delete accessor.sparse;
    for (const [bound, pick] of Object.entries({ min: Math.min, max: Math.max }))
      if (accessor[bound] !== undefined)
        accessor[bound] = accessor[bound].map((_, axis) =>
          all.reduce((found, number, at) => (at % width === axis ? pick(found, Math.fround(number)) : found), all[axis]),
        );
  }
  drop(document, carriers);
  spread(document, plain, quantized ? grid : undefined);
  document.extensionsRequired = document.extensionsRequired?.filter((name) => !TAKEN.includes(name));
  document.extensionsUsed = document.extensionsUsed?.filter((name) => !TAKEN.includes(name));
  for (const list of ['extensionsRequired', 'extensionsUsed']) if (!document[list]?.length) delete document[list];
  return joined(document, placed(document, out));
}

// Lays views one after the other; those that nothing refers to any more go.
function placed(document, out) {
  const used = new Set([...(document.accessors ?? []), ...(document.images ?? [])].map((one) => one.bufferView));
  const places = new Map();
  const parts = [];
  let length = 0;
  const kept = [];
  document.bufferViews.forEach((view, index) => {
    if (!used.has(index)) return;
    const part = Buffer.concat([out[index], Buffer.alloc((4 - (out[index].length % 4)) % 4)]);
    places.set(index, kept.length);
    kept.push({ ...view, buffer: 0, byteOffset: length, byteLength: out[index].length });
    parts.push(part);
    length += part.length;
  });
  for (const one of [...(document.accessors ?? []), ...(document.images ?? [])])
    if (one.bufferView !== undefined) one.bufferView = places.get(one.bufferView);
  document.bufferViews = kept;
  for (const view of kept) if (view.target === undefined) delete view.target;
  document.buffers = [{ byteLength: length }];
  return Buffer.concat(parts);
}

// Column-major matrices times the inverse of the way from the grid to metres.
function fromMetres(all, { step, offset }) {
  const found = Float64Array.from(all);
  for (let start = 0; start < all.length; start += 16)
    for (let row = 0; row < 4; row += 1) {
      const [x, y, z, w] = [0, 1, 2, 3].map((column) => all[start + column * 4 + row]);
      [x, y, z].forEach((part, column) => (found[start + column * 4 + row] = part / step));
      found[start + 12 + row] = w - (x * offset[0] + y * offset[1] + z * offset[2]) / step;
    }
  return found;
}

// The nodes that only carry a mesh, which stand last: the node above shows it itself. Those of levels of detail stay, in metres.
function drop(document, carriers) {
  const first = document.nodes.length - carriers.length;
  const coarser = new Set(document.nodes.flatMap((node) => node.extensions?.MSFT_lod?.ids ?? []));
  const gone = new Set();
  for (const { node, index } of carriers) {
    if (index < first) throw new Error(`node ${index} carries a mesh and does not stand after all others`);
    if (coarser.has(index) || node.extensions?.MSFT_lod) continue;
    const shows = document.nodes.findIndex((other) => other.children?.includes(index));
    const above = document.nodes[shows];
    for (const { target } of (document.animations ?? []).flatMap((animation) => animation.channels))
      if (target.node === index) target.node = shows;
    above.mesh = node.mesh;
    above.children = above.children.filter((child) => child !== index);
    if (above.children.length === 0) delete above.children;
    gone.add(index);
  }
  for (const { node, index } of carriers) {
    if (gone.has(index) || node.skin !== undefined) continue;
    delete node.scale;
    delete node.translation;
  }
  const place = (index) => index - [...gone].filter((other) => other < index).length;
  document.nodes = document.nodes.filter((_, index) => !gone.has(index));
  for (const node of document.nodes) {
    if (node.children) node.children = node.children.map(place);
    if (node.extensions?.MSFT_lod) node.extensions.MSFT_lod.ids = node.extensions.MSFT_lod.ids.map(place);
  }
}

// Copies as nodes, whose places do without the grid that those of the file hold; what held them goes.
function spread(document, plain, grid) {
  const held = new Set();
  const count = document.nodes.length;
  for (let index = 0; index < count; index += 1) {
    const node = document.nodes[index];
    const attributes = node.extensions?.[INSTANCES]?.attributes;
    if (attributes === undefined) continue;
    Object.values(attributes).forEach((accessor) => held.add(accessor));
    const rows = (name, width, rest) => {
      if (attributes[name] === undefined) return () => rest;
      const all = numbers(document, plain, document.accessors[attributes[name]]);
      return (row) => [...all.slice(row * width, (row + 1) * width)];
    };
    const copies = document.accessors[Object.values(attributes)[0]].count;
    const [move, turn, size] = [rows('TRANSLATION', 3, [0, 0, 0]), rows('ROTATION', 4, [0, 0, 0, 1]), rows('SCALE', 3, [1, 1, 1])];
    for (let row = 0; row < copies; row += 1) {
      let [translation, scale] = [move(row), size(row)];
      const rotation = turn(row);
      if (grid !== undefined) {
        scale = scale.map((part) => part / grid.step);
        const offset = turned(rotation, scale.map((part, axis) => part * grid.offset[axis]));
        translation = translation.map((part, axis) => part - offset[axis]);
      }
      (node.children ??= []).push(document.nodes.length);
      document.nodes.push({ name: `${node.name}.${row}`, mesh: node.mesh, translation, rotation, scale });
    }
    delete node.mesh;
    delete node.extensions[INSTANCES];
    if (Object.keys(node.extensions).length === 0) delete node.extensions;
  }
  if (held.size === 0) return;
  // They stand last, so that no other accessor changes its number.
  const first = document.accessors.length - held.size;
  if (Math.min(...held) !== first) throw new Error('accessors of copies do not stand after all others');
  document.accessors.length = first;
}

// A vector turned by a unit quaternion.
function turned([x, y, z, w], [a, b, c]) {
  const [d, e, f] = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
  return [a + w * d + y * f - z * e, b + w * e + z * d - x * f, c + w * f + x * e - y * d];
}

await MeshoptDecoder.ready;
const [folder, ...files] = process.argv.slice(2);
for (const file of files) {
  const bytes = fs.readFileSync(file);
  fs.writeFileSync(path.join(folder, path.basename(file)), unpack(bytes));
  // Pictures beside the file are found beside it again.
  for (const { uri } of split(bytes).document.images ?? [])
    if (uri !== undefined && !uri.startsWith('data:')) {
      const name = decodeURIComponent(uri);
      fs.copyFileSync(path.join(path.dirname(file), name), path.join(folder, name));
    }
}
