// The host for the stage against a capsule of it: what the capsule says of the patches goes through the host's own
// tables, composer and passes, and must come out as expected.

import { compare, type Found } from '../capsule/compare.js';
import type { Check } from '../capsule/format.js';
import type { Capsule } from '../capsule/read.js';
import type { Files } from '../stage/compose.js';
import { type Rules, StagePipelines, StageRun } from '../stage/host.js';
import { paramsOf } from '../stage/layout.js';
import { type Layout, LINES, PatchMesh, QUAD, TRIANGLE, type Vec4 } from '../stage/mesh.js';
import { tablesOf } from '../stage/tables.js';

/**
 * The capsules that the host is tried with: every domain, spacing, mode and winding, but not every combination, since
 * software adapters compile each for seconds. It has no split sides, and its draws do not evaluate.
 */
const HOSTED = [
  'stage-triangles-odd-exact', 'stage-quads-odd-exact', 'stage-isolines-odd-exact', 'stage-quads-equal-exact',
  'stage-triangles-even-d3d', 'stage-clockwise', 'stage-amplified',
];

export function canHost(capsule: Capsule): boolean {
  return HOSTED.includes(capsule.header.name);
}

function rulesOf(defs: readonly string[]): Rules {
  const has = (def: string): boolean => defs.includes(def);
  return {
    domain: has('STAGE_ISOLINES') ? 'isolines' : has('STAGE_QUADS') ? 'quads' : 'triangles',
    spacing: has('STAGE_FRACTIONAL_EVEN') ? 'fractional-even' : has('STAGE_FRACTIONAL_ODD') ? 'fractional-odd' : 'equal',
    mode: has('STAGE_D3D') ? 'd3d' : 'exact',
    clockwise: has('STAGE_CLOCKWISE'),
  };
}

const LAYOUTS: Record<Rules['domain'], Layout> = { triangles: TRIANGLE, quads: QUAD, isolines: LINES };

/** Words that are not the same. */
function words(name: string, found: ArrayBuffer, expected: Uint32Array): Found {
  const bits = new Uint32Array(found);
  const count = Math.max(bits.length, expected.length);
  let wrong = 0;
  for (let k = 0; k < count; k += 1) wrong += bits[k] === expected[k] ? 0 : 1;
  return { check: `host: ${name}`, field: 'words', count, different: wrong, wrong, largest: wrong > 0 ? 1 : 0, allowed: 0, unit: 'bits' };
}

async function read(device: GPUDevice, buffer: GPUBuffer, size: number): Promise<Uint32Array> {
  const staging = device.createBuffer({ size: Math.max(size, 4), usage: GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST });
  const encoder = device.createCommandEncoder();
  if (size > 0) encoder.copyBufferToBuffer(buffer, 0, staging, 0, size);
  device.queue.submit([encoder.finish()]);
  await staging.mapAsync(GPUMapMode.READ);
  const found = new Uint32Array(staging.getMappedRange().slice(0));
  staging.destroy();
  return found;
}

export async function hosted(device: GPUDevice, files: Files, capsule: Capsule): Promise<Found[]> {
  const { header } = capsule;
  const buffer = (name: string): Uint32Array<ArrayBuffer> => {
    const found = header.buffers.find((of) => of.name === name);
    if (!found?.data) throw new Error(`${header.name} has no buffer ${name}`);
    return capsule.words(found.data);
  };
  const [params, tables, data] = [buffer('params'), buffer('tables'), buffer('data')];
  const rules = rulesOf(header.modules[0]!.defs);
  const layout = LAYOUTS[rules.domain];
  // The mesh again, of its control points and of the indices behind the patches' table.
  const floats = new Float32Array(data.buffer);
  const [corners, edges, patches] = [params[40]!, params[41]!, params[42]!];
  const points: Vec4[] = [];
  for (let at = params[48]! * 4; at < floats.length; at += 4) {
    points.push([floats[at]!, floats[at + 1]!, floats[at + 2]!, floats[at + 3]!]);
  }
  const mesh = new PatchMesh(layout, points, tables.subarray(corners + edges + 12 * patches));
  const entity = { mesh, rows: [0, 4, 8].map((at) => [...floats.subarray(at, at + 4)]), params: [...floats.subarray(24, 40)] };
  const ours = tablesOf(layout, [entity]);
  const pools = { vertices: params[43]!, primitives: params[44]! };
  const numbers = new Float32Array(params.buffer);
  const vec3 = (at: number): [number, number, number] => [numbers[at]!, numbers[at + 1]!, numbers[at + 2]!];
  const view = {
    planes: [0, 1, 2, 3, 4, 5].map((k) => [...numbers.subarray(4 * k, 4 * k + 4)]),
    eye: vec3(28),
    pixelsPerRadian: numbers[31]!,
    anchor: vec3(32),
    pixelsPerEdge: numbers[35]!,
  };
  const amplified = params[51]!;
  const told = paramsOf(view, ours.counts, pools, numbers[50]!, amplified);
  // The capsule's view names no camera, the host's is the first.
  new Float32Array(told)[39] = numbers[39]!;
  const found = [words('params', told, params), words('tables', ours.words.buffer, tables), words('data', ours.data.buffer, data)];

  const functions = { replaced: new Map<string, string>(), amplified };
  const pipelines = await StagePipelines.compile(device, files, rules, functions);
  const run = new StageRun(device, rules.domain, ours, pools);
  run.setView(view, functions);
  const encoder = device.createCommandEncoder();
  run.record(encoder, pipelines);
  device.queue.submit([encoder.finish()]);
  const buffers: Record<string, GPUBuffer> = { head: run.work, vertices: run.vertices, indices: run.indices };
  for (const command of header.commands) {
    if (command.do !== 'check') continue;
    const source = buffers[command.name];
    if (!source) continue;
    const check: Check = { ...command, name: `host: ${command.name}` };
    const size = Math.min(command.count * command.stride, source.size);
    found.push(...compare(check, await read(device, source, size), capsule.words(command.expected)));
  }
  run.destroy();
  return found;
}
