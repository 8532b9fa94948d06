// Tessellates a scene and draws it. Nothing is done while nothing changes.

import { compose, type Files } from '../stage/compose.js';
import {
  composedOf, type Functions, moduleOf, PASS_NAMES, type PipelineCache, type Rules, ShaderError, StagePipelines, StageRun, wordsOf,
} from '../stage/host.js';
import { AMPLIFIED_DRAW, type Head, PLAIN_DRAW } from '../stage/layout.js';
import { guarded, loops } from './guard.js';
import { tablesOf } from '../stage/tables.js';
import type { Kind, Scene } from '../scenes/scenes.js';
import type { Camera } from './camera.js';

export interface Settings {
  spacing: Rules['spacing'];
  mode: Rules['mode'];
  /** 0 where the functions decide. */
  level: number;
  /** Wanted length of an edge, pixels. */
  edge: number;
  fill: boolean;
  lines: boolean;
}

/** Colours of light and lines, linear. */
export interface Look {
  sky: readonly number[];
  ground: readonly number[];
  /** Of edges over triangles; the fourth is how much they cover. */
  lines: readonly number[];
  /** Of edges alone. */
  wire: readonly number[];
  sun: number;
}

/** What is counted of a frame. */
export interface Counted {
  patches: number;
  head: Head;
  triangles: number;
  bytes: number;
  /** A loop of the shown functions that was ended: which kind's file, and its line. */
  endless?: { kind: Kind; line: number };
}

const DEPTH: GPUTextureFormat = 'depth32float';
const SAMPLES = 4;
const FUNCTIONS = 'web::functions';
/** Direction to the sun, of length 1. */
const SUN = [0.48, 0.72, 0.5].map((x) => x / Math.hypot(0.48, 0.72, 0.5));
const DRAW_BYTES = 240;
const MATERIAL_ROWS = 16;
/** Lines of a file, at most: above them the number of its kind is written. */
const LINES = 1 << 16;

interface Ready {
  kind: Kind;
  run: StageRun;
  pipelines: StagePipelines;
  draw: GPURenderPipeline;
  group: GPUBindGroup;
  uniform: GPUBuffer;
  owned: GPUBuffer[];
}

export class Engine {
  private ready: Ready[] = [];
  /** What is drawn: another than what was asked for last, until that is compiled. */
  shown: Scene | undefined;
  private readonly cache: PipelineCache = new Map();
  private readonly draws = new Map<string, Promise<GPURenderPipeline>>();
  private readonly levels: Required<Functions>['data'];
  private readonly level: GPUBuffer;
  private readonly stopped: GPUBuffer;
  private readonly layouts: GPUBindGroupLayout[];
  private readonly empty: GPUBindGroup;
  private targets: { colour: GPUTexture; depth: GPUTexture } | undefined;

  constructor(
    readonly device: GPUDevice,
    private readonly context: GPUCanvasContext,
    private readonly format: GPUTextureFormat,
    private readonly files: Files,
  ) {
    context.configure({ device, format, alphaMode: 'premultiplied' });
    this.level = device.createBuffer({ size: 16, usage: GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST });
    this.stopped = device.createBuffer({ size: 16, usage: GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST | GPUBufferUsage.COPY_SRC });
    const layout = device.createBindGroupLayout({
      entries: [
        { binding: 0, visibility: GPUShaderStage.COMPUTE, buffer: { type: 'uniform' } },
        { binding: 1, visibility: GPUShaderStage.COMPUTE, buffer: { type: 'storage' } },
      ],
    });
    const entries = [this.level, this.stopped].map((buffer, binding) => ({ binding, resource: { buffer } }));
    this.levels = { layout, group: device.createBindGroup({ layout, entries }) };
    const none = device.createBindGroupLayout({ entries: [] });
    this.empty = device.createBindGroup({ layout: none, entries: [] });
    const both = GPUShaderStage.VERTEX | GPUShaderStage.FRAGMENT;
    this.layouts = [
      none,
      none,
      device.createBindGroupLayout({
        entries: [
          { binding: 0, visibility: both, buffer: { type: 'uniform' } },
          { binding: 1, visibility: both, buffer: { type: 'uniform' } },
          { binding: 2, visibility: GPUShaderStage.VERTEX, buffer: { type: 'read-only-storage' } },
          { binding: 3, visibility: GPUShaderStage.VERTEX, buffer: { type: 'read-only-storage' } },
        ],
      }),
    ];
  }

  /** The files with a text of functions in the place of what is shown: for the passes, as the number `kind` of a scene. */
  private filesFor(kind: Kind, source: string, number: number): Files {
    return new Map([...this.files, [kind.file, guarded(source, number * LINES)]]);
  }

  /** What is wrong with a text of functions, without making pipelines of it; nothing where it compiles. */
  async check(kind: Kind, source: string, settings: Settings): Promise<ShaderError | undefined> {
    const files = this.filesFor(kind, source, 0);
    const rules: Rules = { domain: kind.layout.domain, spacing: settings.spacing, mode: settings.mode };
    try {
      const { replaced } = this.functions(kind);
      const defs = rules.domain === 'triangles' ? [] : rules.domain === 'quads' ? ['STAGE_QUADS', 'STAGE_FOUR_POINTS'] : ['STAGE_ISOLINES', 'STAGE_FOUR_POINTS'];
      for (const [file, more] of [['stage/control.wgsl', []], ['stage/emit_vertices.wgsl', ['STAGE_READ']]] as const) {
        await moduleOf(this.device, file, composedOf(kind.file, () => compose(files, file, [...defs, ...more], replaced)));
      }
      await this.drawModule(kind, source);
      return undefined;
    } catch (error) {
      if (error instanceof ShaderError) return error;
      throw error;
    }
  }

  private functions(kind: Kind): Functions {
    const replaced = new Map([
      [FUNCTIONS, kind.file],
      ['dolomite::stage::user', 'page/level.wgsl'],
    ]);
    return { replaced, data: this.levels, amplified: kind.amplified ?? 0, uvRange: kind.uvRange ?? 1 };
  }

  private drawModule(kind: Kind, source: string): Promise<GPUShaderModule> {
    const files = new Map([...this.files, [kind.file, guarded(source)]]);
    const replaced = new Map<string, string>();
    if (kind.ownMaterial) replaced.set('dolomite::geometry::user_material', kind.file);
    if (kind.amplified) replaced.set('dolomite::geometry::user_amplify', kind.file);
    const defs = kind.amplified ? ['AMPLIFY'] : [];
    const composed = composedOf(kind.file, () => compose(files, 'page/draw.wgsl', defs, replaced));
    // A loop that may be ended is not known to go round as often in all four pixels of a slope.
    const code = loops(source) ? `diagnostic(off, derivative_uniformity); ${composed.code}` : composed.code;
    return moduleOf(this.device, 'page/draw.wgsl', { ...composed, code });
  }

  private async drawPipeline(kind: Kind, source: string): Promise<GPURenderPipeline> {
    const key = `${kind.file} ${kind.doubleSided} ${kind.clockwise} ${source}`;
    let made = this.draws.get(key);
    if (!made) {
      made = this.drawModule(kind, source).then((module) =>
        this.device.createRenderPipelineAsync({
          label: 'draw',
          layout: this.device.createPipelineLayout({ bindGroupLayouts: this.layouts }),
          vertex: { module, entryPoint: 'vertex' },
          fragment: { module, entryPoint: 'fragment', targets: [{ format: this.format }] },
          primitive: { topology: 'triangle-list', cullMode: kind.doubleSided ? 'none' : 'back' },
          depthStencil: { format: DEPTH, depthWriteEnabled: true, depthCompare: 'greater' },
          multisample: { count: SAMPLES },
        }),
      );
      this.draws.set(key, made);
      made.catch(() => this.draws.delete(key));
    }
    return made;
  }

  /**
   * Compiles what a scene needs, with these texts in the place of its kinds' own; what is drawn changes once all of
   * it is there. Throws a ShaderError where a text does not compile.
   */
  async show(scene: Scene, sources: readonly string[], settings: Settings): Promise<void> {
    const made = await Promise.all(
      scene.kinds.map(async (kind, k) => {
        const source = sources[k] ?? kind.source;
        const rules: Rules = {
          domain: kind.layout.domain,
          spacing: settings.spacing,
          mode: settings.mode,
          clockwise: kind.clockwise ?? false,
        };
        const [pipelines, draw] = await Promise.all([
          StagePipelines.compile(this.device, this.filesFor(kind, source, k), rules, this.functions(kind), this.cache),
          this.drawPipeline(kind, source),
        ]);
        return { kind, pipelines, draw };
      }),
    );
    const old = this.ready;
    this.ready = made.map(({ kind, pipelines, draw }) => {
      // Patches stay where they are while only functions or rules change.
      const known = old.find((ready) => ready.kind === kind);
      if (known) return { ...known, pipelines, draw };
      return this.place(kind, pipelines, draw);
    });
    for (const gone of old) if (!this.ready.some((ready) => ready.run === gone.run)) this.free(gone);
    this.shown = scene;
  }

  private place(kind: Kind, pipelines: StagePipelines, draw: GPURenderPipeline): Ready {
    const { device } = this;
    const run = new StageRun(device, kind.layout.domain, tablesOf(kind.layout, kind.entities()), kind.pools);
    const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
    const uniform = device.createBuffer({ label: 'draw', size: DRAW_BYTES, usage });
    const materials = device.createBuffer({ label: 'materials', size: MATERIAL_ROWS * 48, usage });
    const table = new Float32Array(MATERIAL_ROWS * 12);
    kind.materials.forEach(({ colour, shines, roughness }, row) => {
      table.set([...colour, 0, ...(shines ?? [0, 0, 0]), 0.5, roughness, 0, 1, 1], 12 * row);
    });
    device.queue.writeBuffer(materials, 0, table);
    const group = device.createBindGroup({
      layout: this.layouts[2]!,
      entries: [uniform, materials, run.vertices, run.indices].map((buffer, binding) => ({ binding, resource: { buffer } })),
    });
    return { kind, run, pipelines, draw, group, uniform, owned: [uniform, materials] };
  }

  private free(ready: Ready): void {
    ready.run.destroy();
    for (const buffer of ready.owned) buffer.destroy();
  }

  /** Tessellates and draws; false where there is no room to draw into. */
  frame(camera: Camera, settings: Settings, look: Look): boolean {
    const canvas = this.context.canvas;
    const { width, height } = canvas;
    if (width === 0 || height === 0 || this.ready.length === 0) return false;
    const { clip, view } = camera.look(width, height, settings.edge);
    const encoder = this.device.createCommandEncoder();
    this.device.queue.writeBuffer(this.level, 0, new Float32Array([settings.level, 0, 0, 0]));
    encoder.clearBuffer(this.stopped);
    for (const { kind, run, pipelines, uniform } of this.ready) {
      run.setView(view, pipelines.functions);
      const numbers = new Float32Array(DRAW_BYTES / 4);
      numbers.set(clip, 0);
      numbers.set(clip, 16);
      numbers.set([...view.eye, 0, 0, 0, 0, kind.uvRange ?? 1, width, height], 32);
      new Uint32Array(numbers.buffer)[42] = (settings.fill ? 1 : 0) | (settings.lines ? 2 : 0);
      numbers.set([...SUN, look.sun, ...look.sky, 0, ...look.ground, 0, ...(settings.fill ? look.lines : [...look.wire, 1])], 44);
      this.device.queue.writeBuffer(uniform, 0, numbers);
      run.record(encoder, pipelines);
    }
    const { colour, depth } = this.target(width, height);
    const pass = encoder.beginRenderPass({
      colorAttachments: [
        {
          view: colour.createView(),
          resolveTarget: this.context.getCurrentTexture().createView(),
          loadOp: 'clear',
          storeOp: 'discard',
          clearValue: { r: 0, g: 0, b: 0, a: 0 },
        },
      ],
      depthStencilAttachment: { view: depth.createView(), depthClearValue: 0, depthLoadOp: 'clear', depthStoreOp: 'discard' },
    });
    pass.setBindGroup(0, this.empty);
    pass.setBindGroup(1, this.empty);
    for (const { kind, run, draw, group } of this.ready) {
      pass.setPipeline(draw);
      pass.setBindGroup(2, group);
      pass.drawIndirect(run.work, kind.amplified ? AMPLIFIED_DRAW : PLAIN_DRAW);
    }
    pass.end();
    this.device.queue.submit([encoder.finish()]);
    return true;
  }

  private target(width: number, height: number): { colour: GPUTexture; depth: GPUTexture } {
    if (this.targets?.colour.width !== width || this.targets.colour.height !== height) {
      this.targets?.colour.destroy();
      this.targets?.depth.destroy();
      const make = (format: GPUTextureFormat): GPUTexture =>
        this.device.createTexture({ size: [width, height], format, sampleCount: SAMPLES, usage: GPUTextureUsage.RENDER_ATTACHMENT });
      this.targets = { colour: make(this.format), depth: make(DEPTH) };
    }
    return this.targets;
  }

  /** What the last frame counted, of all kinds together. */
  async counted(): Promise<Counted> {
    const kinds = this.ready.map(({ kind }) => kind);
    const stopped = wordsOf(this.device, this.stopped, 4).then(([at = 0]) => ({ kind: kinds[Math.floor(at / LINES)]!, line: at % LINES }));
    const counts = Promise.all(
      this.ready.map(async ({ kind, run }): Promise<Counted> => {
        const head = await run.head();
        const triangles = head.primitives * (kind.amplified ? kind.amplified / 3 : 1);
        return { patches: run.tables.counts.patches, head, triangles, bytes: run.bytes };
      }),
    );
    const [endless, all] = await Promise.all([stopped, counts]);
    const sum = all.reduce((a, b) => ({
      patches: a.patches + b.patches,
      head: {
        vertices: a.head.vertices + b.head.vertices,
        primitives: a.head.primitives + b.head.primitives,
        wantedPrimitives: a.head.wantedPrimitives + b.head.wantedPrimitives,
        discarded: a.head.discarded + b.head.discarded,
        lowered: Math.max(a.head.lowered, b.head.lowered),
      },
      triangles: a.triangles + b.triangles,
      bytes: a.bytes + b.bytes,
    }));
    return endless.line > 0 ? { ...sum, endless } : sum;
  }

  /** Milliseconds of each pass of all kinds, submitted alone, from the submission until it is done. */
  async measure(): Promise<{ pass: string; milliseconds: number }[]> {
    const times = PASS_NAMES.map((pass) => ({ pass, milliseconds: 0 }));
    for (const { run, pipelines } of [...this.ready]) {
      for (let k = 0; k < pipelines.passes.length; k += 1) {
        const encoder = this.device.createCommandEncoder();
        run.record(encoder, pipelines, k, k + 1);
        const began = performance.now();
        this.device.queue.submit([encoder.finish()]);
        await this.device.queue.onSubmittedWorkDone();
        times[k]!.milliseconds += performance.now() - began;
      }
    }
    return times;
  }
}
