// What a capsule's header says: the types of lab/src/capsule/format.rs, which documents them.

export interface Span {
  at: number;
  length: number;
}

export type BindingKind = 'uniform' | 'read-only-storage' | 'storage' | 'depth-texture';

/** Who says what is expected. */
export type Source = 'cpu-reference' | 'f64' | 'untouched';

export type Field = { name: string; at: number; count: number } & (
  | { type: 'u32' }
  | { type: 'f32'; ulp: number; scale: number }
  | { type: 'oct12'; steps: number }
  | { type: 'snorm16x2'; steps: number }
  | { type: 'part'; low: number; bits: number; steps: number }
);

export interface Step {
  pipeline: number;
  groups: number[];
  dispatch?: [number, number, number];
  indirect?: { buffer: number; offset: number };
}

export interface Check {
  do: 'check';
  name: string;
  buffer: number;
  offset: number;
  stride: number;
  count: number;
  fields: Field[];
  expected: Span;
  from: Source;
  unordered?: boolean;
}

export interface Triangles {
  do: 'triangles';
  name: string;
  vertices: number;
  stride: number;
  indices: number;
  count: number;
  ulp: number;
  scale: number;
  expected: Span;
  from: Source;
}

export interface Lists {
  do: 'lists';
  name: string;
  buffer: number;
  offset: number;
  stride: number;
  count: number;
  first: number;
  length: number;
  expected: Span;
  from: Source;
}

export interface Digest {
  do: 'digest';
  name: string;
  buffer: number;
  ranges: Span;
  expected: Span;
  from: Source;
}

export type Command =
  | { do: 'write'; buffer: number; offset: number; data: Span }
  | { do: 'clear'; buffer: number; offset: number; size: number }
  | { do: 'pass'; steps: Step[] }
  | Check
  | Triangles
  | Lists
  | Digest;

export interface BufferOf {
  name: string;
  size: number;
  fill: number;
  data?: Span;
}

export interface TextureOf {
  name: string;
  width: number;
  height: number;
  data: Span;
}

export interface Header {
  name: string;
  about: string;
  features: string[];
  modules: { name: string; defs: string[]; wgsl: Span }[];
  layouts: BindingKind[][];
  pipelines: { module: number; entry: string; layouts: number[] }[];
  buffers: BufferOf[];
  textures?: TextureOf[];
  groups: { layout: number; buffers: number[] }[];
  commands: Command[];
}
