// What the stage's shaders are told, word for word as plugins/tessellation/src/layout.rs.

import type { Domain } from './mesh.js';
import type { Counts } from './tables.js';

/** The view as control functions see it; units and meanings stand in shaders/src/stage/api.wgsl. */
export interface View {
  planes: readonly (readonly number[])[];
  eye: readonly [number, number, number];
  anchor: readonly [number, number, number];
  pixelsPerRadian: number;
  pixelsPerEdge: number;
}

export const PARAMS_BYTES = 224;
const HEAD_WORDS = 40;
const BLOCK = 256;
const COLUMNS = 32768;
const VERTEX_RUN = 4;
const GRID_RUN = 32;

/** Bytes of the work buffer at which the arguments of indirect dispatches and draws stand. */
export const VERTEX_DISPATCH = 24 * 4;
export const GRID_DISPATCH = 27 * 4;
export const AMPLIFIED_DRAW = 5 * 4;
export const PLAIN_DRAW = 9 * 4;
export const HEAD_BYTES = HEAD_WORDS * 4;
export const VERTEX_BYTES = 20;

/** Numbers in the head of the work buffer. */
export interface Head {
  vertices: number;
  primitives: number;
  wantedPrimitives: number;
  discarded: number;
  lowered: number;
}

export function readHead(words: Uint32Array): Head {
  return {
    vertices: words[18]!,
    primitives: words[19]!,
    wantedPrimitives: words[21]!,
    discarded: words[22]!,
    lowered: words[23]!,
  };
}

export interface Pools {
  vertices: number;
  primitives: number;
}

export function paramsOf(view: View, counts: Counts, pools: Pools, uvRange: number, amplified: number): ArrayBuffer {
  const buffer = new ArrayBuffer(PARAMS_BYTES);
  const floats = new Float32Array(buffer);
  const words = new Uint32Array(buffer);
  view.planes.forEach((plane, k) => floats.set(plane, 4 * k));
  floats.set([...view.eye, view.pixelsPerRadian, ...view.anchor, view.pixelsPerEdge], 28);
  // Time, time before, orthographic, number of the camera.
  floats.set([0, 0, 0, 1], 36);
  words.set(
    [
      counts.corners, counts.edges, counts.patches, pools.vertices, pools.primitives, 0, counts.corners,
      counts.corners + counts.edges, counts.points, 1,
    ],
    40,
  );
  floats[50] = uvRange;
  words[51] = amplified;
  return buffer;
}

const items = (counts: Counts): number => counts.corners + counts.edges + counts.patches;

/** Bytes of the work buffer that have to be 0 before the first pass. */
export function clearedBytes(counts: Counts): number {
  return (HEAD_WORDS + counts.corners + counts.edges) * 4;
}

export function workBytes(counts: Counts, pools: Pools): number {
  const all = items(counts);
  const blocks = Math.ceil(all / BLOCK);
  const vertexThreads = Math.floor(pools.vertices / VERTEX_RUN) + all;
  const gridThreads = Math.floor(pools.primitives / GRID_RUN) + counts.patches;
  return clearedBytes(counts) + 4 * (4 * counts.patches + 2 * blocks + 2 * (all + 1) + vertexThreads + gridThreads);
}

const SIDES: Record<Domain, number> = { triangles: 3, quads: 4, isolines: 0 };

/** Workgroups of the passes whose number is known before. */
export function workgroups(counts: Counts, domain: Domain): { patches: number; items: number; strips: number } {
  return {
    patches: Math.ceil(counts.patches / 64),
    items: Math.ceil(items(counts) / BLOCK),
    strips: Math.ceil((2 * SIDES[domain] * counts.patches) / 256),
  };
}

/** So many groups, in rows. */
export function grid(groups: number): [number, number] {
  return [Math.min(groups, COLUMNS), Math.ceil(groups / COLUMNS)];
}
