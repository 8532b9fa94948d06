// A host for the tessellation stage: compiles its passes from WGSL files, and runs them on any patches. It does
// what plugins/tessellation/src/render does for Bevy, with nothing but WebGPU's default limits.

import { compose, type Composed, ComposeError, type Files } from './compose.js';
import {
  clearedBytes, GRID_DISPATCH, grid, HEAD_BYTES, type Head, PARAMS_BYTES, paramsOf, type Pools, readHead, VERTEX_BYTES,
  VERTEX_DISPATCH, type View, workBytes, workgroups,
} from './layout.js';
import type { Domain } from './mesh.js';
import type { Tables } from './tables.js';

export type Spacing = 'equal' | 'fractional-even' | 'fractional-odd';
export type Mode = 'exact' | 'd3d';

export interface Rules {
  domain: Domain;
  spacing: Spacing;
  mode: Mode;
  clockwise?: boolean;
}

const PASSES = [
  { file: 'stage/control.wgsl', entry: 'control_patches', emits: false },
  { file: 'stage/measure.wgsl', entry: 'measure', emits: false },
  { file: 'stage/plan.wgsl', entry: 'plan', emits: false },
  { file: 'stage/place_items.wgsl', entry: 'place_items', emits: false },
  { file: 'stage/emit_vertices.wgsl', entry: 'emit_vertices', emits: true },
  { file: 'stage/emit_grid.wgsl', entry: 'emit_grid', emits: true },
  { file: 'stage/emit_strips.wgsl', entry: 'emit_strips', emits: true },
] as const;

export const PASS_NAMES: readonly string[] = PASSES.map((pass) => pass.entry);

/** Shader definitions of rules, as `defs` in plugins/tessellation/src/passes.rs. */
export function defsOf(rules: Rules): string[] {
  const defs: string[] = [];
  if (rules.domain === 'quads') defs.push('STAGE_QUADS', 'STAGE_FOUR_POINTS');
  if (rules.domain === 'isolines') defs.push('STAGE_ISOLINES', 'STAGE_FOUR_POINTS');
  if (rules.spacing === 'fractional-even') defs.push('STAGE_FRACTIONAL_EVEN');
  if (rules.spacing === 'fractional-odd') defs.push('STAGE_FRACTIONAL_ODD');
  if (rules.mode === 'd3d') defs.push('STAGE_D3D');
  if (rules.clockwise) defs.push('STAGE_CLOCKWISE');
  return defs;
}

/** A fault in WGSL, where it is. */
export interface Fault {
  file: string;
  /** From 1. */
  line: number;
  column: number;
  message: string;
}

/** WGSL that does not compile. */
export class ShaderError extends Error {
  override name = 'ShaderError';
  constructor(readonly faults: readonly Fault[]) {
    super(faults.map(({ file, line, message }) => `${file}:${line}: ${message}`).join('\n'));
  }
}

/** What `make` gives; a fault in the text becomes a ShaderError. */
export function composedOf(label: string, make: () => Composed): Composed {
  try {
    return make();
  } catch (error) {
    if (!(error instanceof ComposeError)) throw error;
    throw new ShaderError([{ file: error.file || label, line: error.line, column: 1, message: error.message }]);
  }
}

/** A compiled module; throws a ShaderError with the places in the files that it was composed from. */
export async function moduleOf(device: GPUDevice, label: string, composed: Composed): Promise<GPUShaderModule> {
  device.pushErrorScope('validation');
  const module = device.createShaderModule({ label, code: composed.code });
  const [info, refused] = await Promise.all([module.getCompilationInfo(), device.popErrorScope()]);
  const errors = info.messages.filter((message) => message.type === 'error');
  if (errors.length === 0 && !refused) return module;
  const faults = errors.map(({ lineNum, linePos, message }) => {
    const place = composed.lines[lineNum - 1];
    return { file: place?.file ?? label, line: place?.line ?? lineNum, column: linePos, message: plain(message) };
  });
  throw new ShaderError(faults.length > 0 ? faults : [{ file: label, line: 1, column: 1, message: refused!.message }]);
}

/** A compiler's message with the names that the files have. */
function plain(message: string): string {
  return message.replace(/\b(?:stage|web|geometry)_(?:user|functions|api|[a-z]+)_(\w+)/g, '$1');
}

export interface Functions {
  /** Files by import path that stand in the place of the stage's own. */
  replaced: ReadonlyMap<string, string>;
  /** What they bind at group 1. */
  data?: { layout: GPUBindGroupLayout; group: GPUBindGroup };
  /** Vertices of what an amplify function makes of a primitive. */
  amplified?: number;
  /** Greatest |u| and |v|. */
  uvRange?: number;
}

/** Pipelines by their text: five of the seven passes do not call the user's functions. */
export type PipelineCache = Map<string, Promise<GPUComputePipeline>>;

/** The compiled passes of a kind of patches. */
export class StagePipelines {
  private constructor(
    readonly device: GPUDevice,
    readonly rules: Rules,
    readonly functions: Functions,
    readonly passes: readonly GPUComputePipeline[],
    readonly layouts: readonly [GPUBindGroupLayout, GPUBindGroupLayout],
  ) {}

  static async compile(
    device: GPUDevice,
    files: Files,
    rules: Rules,
    functions: Functions,
    cache: PipelineCache = new Map(),
  ): Promise<StagePipelines> {
    const layout = (kinds: GPUBufferBindingType[]): GPUBindGroupLayout =>
      device.createBindGroupLayout({
        entries: kinds.map((type, binding) => ({ binding, visibility: GPUShaderStage.COMPUTE, buffer: { type } })),
      });
    const layouts = [
      layout(['uniform', 'read-only-storage', 'read-only-storage', 'storage']),
      layout(['uniform', 'read-only-storage', 'read-only-storage', 'read-only-storage', 'storage', 'storage']),
    ] as const;
    const used = PASSES.slice(0, rules.domain === 'isolines' ? 6 : 7);
    const passes = await Promise.all(
      used.map(async ({ file, entry, emits }) => {
        const defs = emits ? [...defsOf(rules), 'STAGE_READ'] : defsOf(rules);
        const composed = composedOf(file, () => compose(files, file, defs, functions.replaced));
        const key = `${functions.data ? 'data' : ''} ${composed.code}`;
        const known = cache.get(key);
        if (known) return known;
        const made = (async () => {
          const module = await moduleOf(device, file, composed);
          const own = [layouts[emits ? 1 : 0], ...(functions.data ? [functions.data.layout] : [])];
          return device.createComputePipelineAsync({
            label: entry,
            layout: device.createPipelineLayout({ bindGroupLayouts: own }),
            compute: { module, entryPoint: entry },
          });
        })();
        cache.set(key, made);
        // What does not compile is not kept: a lost device must not be remembered as a fault.
        made.catch(() => cache.delete(key));
        return made;
      }),
    );
    return new StagePipelines(device, rules, functions, passes, layouts);
  }
}

/** The first bytes of a buffer, once all that was submitted is done. */
export async function wordsOf(device: GPUDevice, buffer: GPUBuffer, bytes: number): Promise<Uint32Array> {
  const staging = device.createBuffer({ size: bytes, usage: GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST });
  const encoder = device.createCommandEncoder();
  encoder.copyBufferToBuffer(buffer, 0, staging, 0, bytes);
  device.queue.submit([encoder.finish()]);
  await staging.mapAsync(GPUMapMode.READ);
  const words = new Uint32Array(staging.getMappedRange().slice(0));
  staging.destroy();
  return words;
}

/** Patches on the device, with room for what becomes of them. */
export class StageRun {
  readonly params: GPUBuffer;
  readonly work: GPUBuffer;
  readonly vertices: GPUBuffer;
  readonly indices: GPUBuffer;
  /** Bytes of all buffers. */
  readonly bytes: number;
  private readonly owned: GPUBuffer[] = [];
  private readonly tableWords: GPUBuffer;
  private readonly data: GPUBuffer;

  constructor(
    readonly device: GPUDevice,
    readonly domain: Domain,
    readonly tables: Tables,
    readonly pools: Pools,
  ) {
    const { STORAGE, UNIFORM, COPY_DST, COPY_SRC, INDIRECT } = GPUBufferUsage;
    const make = (label: string, size: number, usage: number): GPUBuffer => {
      const buffer = device.createBuffer({ label, size: Math.max(16, size), usage: usage | COPY_DST | COPY_SRC });
      this.owned.push(buffer);
      return buffer;
    };
    this.params = make('params', PARAMS_BYTES, UNIFORM);
    this.tableWords = make('tables', tables.words.byteLength, STORAGE);
    this.data = make('data', tables.data.byteLength, STORAGE);
    this.work = make('work', workBytes(tables.counts, pools), STORAGE | INDIRECT);
    this.vertices = make('vertices', pools.vertices * VERTEX_BYTES, STORAGE);
    const corners = domain === 'isolines' ? 2 : 3;
    this.indices = make('indices', pools.primitives * 4 * corners, STORAGE);
    device.queue.writeBuffer(this.tableWords, 0, tables.words);
    device.queue.writeBuffer(this.data, 0, tables.data);
    this.bytes = this.owned.reduce((sum, buffer) => sum + buffer.size, 0);
  }

  /** Sees the patches as `view` does. */
  setView(view: View, functions: Functions): void {
    const params = paramsOf(view, this.tables.counts, this.pools, functions.uvRange ?? 1, functions.amplified ?? 0);
    this.device.queue.writeBuffer(this.params, 0, params);
  }

  /** Records the passes `from` to `to` (all of them by default); the first clears what passes count in. */
  record(encoder: GPUCommandEncoder, pipelines: StagePipelines, from = 0, to = pipelines.passes.length): void {
    const { counts } = this.tables;
    const group = (layout: GPUBindGroupLayout, buffers: GPUBuffer[]): GPUBindGroup =>
      this.device.createBindGroup({
        layout,
        entries: buffers.map((buffer, binding) => ({ binding, resource: { buffer } })),
      });
    const common = [this.params, this.tableWords, this.data, this.work];
    if (from === 0) encoder.clearBuffer(this.work, 0, clearedBytes(counts));
    const pass = encoder.beginComputePass();
    const groups = workgroups(counts, this.domain);
    const work = group(pipelines.layouts[0], common);
    const emit = group(pipelines.layouts[1], [...common, this.vertices, this.indices]);
    const { data } = pipelines.functions;
    if (data) pass.setBindGroup(1, data.group);
    pipelines.passes.forEach((pipeline, number) => {
      if (number < from || number >= to) return;
      pass.setPipeline(pipeline);
      pass.setBindGroup(0, number < 4 ? work : emit);
      if (number === 0) pass.dispatchWorkgroups(...grid(groups.patches));
      else if (number === 1 || number === 3) pass.dispatchWorkgroups(...grid(groups.items));
      else if (number === 2) pass.dispatchWorkgroups(1);
      else if (number === 4) pass.dispatchWorkgroupsIndirect(this.work, VERTEX_DISPATCH);
      else if (number === 5) pass.dispatchWorkgroupsIndirect(this.work, GRID_DISPATCH);
      else pass.dispatchWorkgroups(...grid(groups.strips));
    });
    pass.end();
  }

  /** What was counted in the last run. */
  async head(): Promise<Head> {
    return readHead(await wordsOf(this.device, this.work, HEAD_BYTES));
  }

  destroy(): void {
    for (const buffer of this.owned) buffer.destroy();
  }
}
