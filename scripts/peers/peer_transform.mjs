// glTF-Transform: the passes of its command `optimize --compress meshopt --simplify false --texture-compress false`.
// peer_transform.mjs IN.glb OUT.glb
import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { dedup, flatten, instance, join, meshopt, prune, resample, sparse, weld } from '@gltf-transform/functions';
import { MeshoptDecoder, MeshoptEncoder } from 'meshoptimizer';

await MeshoptDecoder.ready;
await MeshoptEncoder.ready;
const io = new NodeIO()
  .registerExtensions(ALL_EXTENSIONS)
  .registerDependencies({ 'meshopt.decoder': MeshoptDecoder, 'meshopt.encoder': MeshoptEncoder });
const [source, out] = process.argv.slice(2);
const document = await io.read(source);
const keep = { keepAttributes: true, keepLeaves: true, keepSolidTextures: true };
await document.transform(
  dedup(), instance({ min: 5 }), flatten(), join(), weld(), resample(), prune(keep), sparse(),
  meshopt({ encoder: MeshoptEncoder, level: 'high' }),
);
await io.write(out, document);
