// Compiles WGSL files with Tint, the compiler of Dawn and so of Chromium, on Dawn's null backend: no GPU.
//
//   node compile.mjs FOLDER
//
// FOLDER holds `shaders.json`, a list of { name, file, compute, vertex, fragment }: `compute` names entry
// points, `vertex` is { entry, inputs: [{ location, format }] } or null, `fragment` is
// { entry, targets: [format or null] } or null. Each file becomes a shader module, and each entry point a
// pipeline with the layout that its own bindings make, so that the limits of WebGPU hold as well.
// Prints a line for each fault, at the end `N shaders, P pipelines, F faults`; exits with 1 on a fault.

import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { create, globals } from 'webgpu';

Object.assign(globalThis, globals);

const folder = process.argv[2];
const list = JSON.parse(readFileSync(join(folder, 'shaders.json'), 'utf8'));
const gpu = create(['backend=null']);
const adapter = await gpu.requestAdapter();
const device = await adapter.requestDevice();
// A fault of the device itself, outside of all scopes.
device.addEventListener('uncapturederror', (event) => fault('device', event.error.message));

let faults = 0;
let pipelines = 0;
function fault(place, message) {
  faults += 1;
  console.log(`${place}: ${message}`);
}

async function scoped(place, make) {
  device.pushErrorScope('validation');
  const made = make();
  const error = await device.popErrorScope();
  if (error) fault(place, error.message);
  return made;
}

function vertexState(module, { entry, inputs }) {
  const size = { uint32: 4, sint32: 4, float32: 4 };
  const bytes = (format) => (size[format.split('x')[0]] ?? 4) * Number(format.split('x')[1] ?? 1);
  const buffers = inputs.map(({ location, format }) => ({
    arrayStride: bytes(format),
    attributes: [{ shaderLocation: location, offset: 0, format }],
  }));
  return { module, entryPoint: entry, buffers };
}

for (const { name, file, compute, vertex, fragment } of list) {
  const code = readFileSync(join(folder, file), 'utf8');
  device.pushErrorScope('validation');
  const module = device.createShaderModule({ code, label: name });
  const info = await module.getCompilationInfo();
  const refused = await device.popErrorScope();
  const errors = info.messages.filter((message) => message.type === 'error');
  for (const { lineNum, linePos, message } of errors) fault(`${name} (${file}:${lineNum}:${linePos})`, message);
  if (refused && errors.length === 0) fault(`${name} (${file})`, refused.message);
  if (refused || errors.length > 0) continue;
  for (const entryPoint of compute) {
    pipelines += 1;
    await scoped(`${name} (${file}, ${entryPoint})`, () =>
      device.createComputePipeline({ layout: 'auto', compute: { module, entryPoint } }));
  }
  if (vertex) {
    pipelines += 1;
    const targets = fragment?.targets.map((format) => format && { format });
    await scoped(`${name} (${file}, ${vertex.entry})`, () =>
      device.createRenderPipeline({
        layout: 'auto',
        vertex: vertexState(module, vertex),
        primitive: { topology: 'triangle-list' },
        ...(fragment && { fragment: { module, entryPoint: fragment.entry, targets } }),
        depthStencil: { format: 'depth32float', depthWriteEnabled: true, depthCompare: 'greater-equal' },
      }));
  }
}
console.log(`${list.length} shaders, ${pipelines} pipelines, ${faults} faults`);
device.destroy();
process.exit(faults === 0 ? 0 : 1);
