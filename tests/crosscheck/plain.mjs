// Files with compressed views as files without, by meshoptimizer's own decoder; all else stays as it is.
// node tests/crosscheck/plain.mjs IN.glb OUT.glb [IN.glb OUT.glb ...]
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const scripts = path.join(import.meta.dirname, '..', '..', 'scripts', 'package.json');
const decoder = createRequire(scripts).resolve('three/examples/jsm/libs/meshopt_decoder.module.js');
const { MeshoptDecoder } = await import(pathToFileURL(decoder));
await MeshoptDecoder.ready;

const PACKED = ['EXT_meshopt_compression', 'KHR_meshopt_compression'];

function plain(bytes) {
  const length = bytes.readUInt32LE(12);
  const document = JSON.parse(bytes.subarray(20, 20 + length).toString('utf8'));
  const binary = bytes.subarray(28 + length);
  const parts = [];
  let end = 0;
  for (const view of document.bufferViews ?? []) {
    const packed = PACKED.map((name) => view.extensions?.[name]).find((found) => found !== undefined);
    const { byteOffset = 0, byteLength } = packed ?? view;
    const source = binary.subarray(byteOffset, byteOffset + byteLength);
    let part = source;
    if (packed !== undefined) {
      part = new Uint8Array(packed.count * packed.byteStride);
      MeshoptDecoder.decodeGltfBuffer(part, packed.count, packed.byteStride, source, packed.mode, packed.filter ?? 'NONE');
      if (part.length !== view.byteLength) throw new Error(`a view of ${view.byteLength} bytes holds ${part.length}`);
      for (const name of PACKED) delete view.extensions[name];
      if (Object.keys(view.extensions).length === 0) delete view.extensions;
    }
    Object.assign(view, { buffer: 0, byteOffset: end });
    parts.push(Buffer.from(part), Buffer.alloc((4 - (part.length % 4)) % 4));
    end += Math.ceil(part.length / 4) * 4;
  }
  if (end > 0) document.buffers = [{ byteLength: end }];
  for (const list of ['extensionsUsed', 'extensionsRequired']) {
    document[list] = document[list]?.filter((name) => !PACKED.includes(name));
    if (!document[list]?.length) delete document[list];
  }
  let text = Buffer.from(JSON.stringify(document), 'utf8');
  text = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, 0x20)]);
  const words = (...numbers) => Buffer.from(Uint32Array.from(numbers).buffer);
  const body = [words(text.length, 0x4e4f534a), text, words(end, 0x004e4942), ...parts];
  return Buffer.concat([words(0x46546c67, 2, 12 + body.reduce((sum, part) => sum + part.length, 0)), ...body]);
}

const names = process.argv.slice(2);
for (let at = 0; at < names.length; at += 2) fs.writeFileSync(names[at + 1], plain(fs.readFileSync(names[at])));
