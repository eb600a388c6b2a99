// What the Khronos glTF validator finds: every issue, and its own counts.
// node checks/validator.mjs OUT.json FILE...
import fs from 'node:fs';
import path from 'node:path';
import validator from 'gltf-validator';

// Buffers and images beside the file; the validator asks by relative address.
function beside(file) {
  return async (address) =>
    new Uint8Array(await fs.promises.readFile(path.join(path.dirname(file), decodeURIComponent(address))));
}

async function measure(file) {
  const measured = { tool: 'validator', version: validator.version(), file, totals: {}, shapes: {}, error: null };
  try {
    const bytes = new Uint8Array(fs.readFileSync(file));
    const result = await validator.validateBytes(bytes, {
      uri: file,
      maxIssues: 0,
      externalResourceFunction: beside(file),
    });
    const { numErrors, numWarnings, numInfos, numHints, messages } = result.issues;
    measured.totals = {
      'validator-errors': numErrors,
      'validator-warnings': numWarnings,
      'validator-infos': numInfos,
      'validator-hints': numHints,
      'validator-messages': messages.map((m) => `${m.code} at ${m.pointer ?? m.offset}: ${m.message}`),
      ...counts(result.info),
    };
  } catch (error) {
    measured.error = String(error);
  }
  return measured;
}

// The validator's figures under the report's names; absent when it could not read so far.
function counts(info) {
  if (info === undefined || info.drawCallCount === undefined) return {};
  return {
    'triangles': info.totalTriangleCount,
    'drawn-vertices': info.totalVertexCount,
    'primitives': info.drawCallCount,
    'materials': info.materialCount,
    'images': (info.resources ?? []).filter((resource) => resource.image !== undefined).length,
  };
}

const [out, ...files] = process.argv.slice(2);
const measured = [];
for (const file of files) measured.push(await measure(file));
fs.writeFileSync(out, JSON.stringify(measured));
