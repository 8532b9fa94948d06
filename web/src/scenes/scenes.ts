// What a person may choose to see.

import bezier from '../../../assets/shaders/bezier.wgsl?raw';
import globe from '../../../assets/shaders/globe.wgsl?raw';
import rock from '../../../assets/shaders/rock.wgsl?raw';
import tube from '../../../assets/shaders/tube.wgsl?raw';
import type { Pools } from '../stage/layout.js';
import { BICUBIC, type Layout, LINES, octahedron, SPLINE, TRIANGLE } from '../stage/mesh.js';
import type { Entity } from '../stage/tables.js';
import { globes, posts } from './lamps.js';
import { mountain } from './mountain.js';
import mountainSource from './mountain.wgsl?raw';
import { at, type Vec3 } from './place.js';
import { stars } from './stars.js';
import { teapot } from './teapot.js';

/** A row of the table of materials: linear colours. */
export interface Material {
  colour: Vec3;
  shines?: Vec3;
  roughness: number;
}

/** Patches with the same functions. */
export interface Kind {
  /** Name of the file that is shown. */
  file: string;
  source: string;
  layout: Layout;
  entities: () => Entity[];
  pools: Pools;
  clockwise?: boolean;
  /** Vertices of what `amplify` makes of a primitive. */
  amplified?: number;
  uvRange?: number;
  /** Whether its file has a material function. */
  ownMaterial?: boolean;
  doubleSided?: boolean;
  materials: Material[];
}

export interface Scene {
  name: string;
  title: string;
  /** Two sentences on what is seen. */
  text: string;
  kinds: Kind[];
  camera: { centre: Vec3; distance: number; yaw: number; pitch: number; nearest: number; farthest: number };
  /** Wanted length of an edge to begin with, pixels. */
  edge: number;
  /** Seen by night whatever the page's colours are: it shines by itself. */
  night?: boolean;
}

const POOLS: Pools = { vertices: 1 << 17, primitives: 1 << 18 };

export const SCENES: readonly Scene[] = [
  {
    name: 'sphere',
    title: 'Sphere',
    text: 'An octahedron of 128 triangle patches, pushed onto a sphere and out along its normal by eight octaves of noise. Every patch is cut as finely as its size in pixels asks for, and neighbours share the vertices of their edge, so the surface never opens.',
    kinds: [
      {
        file: 'rock.wgsl',
        source: rock,
        layout: TRIANGLE,
        entities: () => [{ mesh: octahedron(4), rows: at([0, 0, 0], 1), params: [0, 0.14, 1.4, ...new Array<number>(13).fill(0)] }],
        pools: POOLS,
        uvRange: 2,
        ownMaterial: true,
        materials: [],
      },
    ],
    camera: { centre: [0, 0, 0], distance: 3, yaw: 0.5, pitch: 0.3, nearest: 1.3, farthest: 30 },
    edge: 20,
  },
  {
    name: 'teapot',
    title: 'Teapot',
    text: 'The Utah teapot as Martin Newell drew it in 1975: 32 Bézier patches of 16 control points, and no triangle before the GPU makes them. Come closer, and the spout stays round; go away, and a few hundred triangles are enough.',
    kinds: [
      {
        file: 'bezier.wgsl',
        source: bezier,
        layout: BICUBIC,
        entities: () => [{ mesh: teapot(), rows: at([0, -1.5, 0], 1), params: new Array<number>(16).fill(0) }],
        pools: POOLS,
        doubleSided: true,
        materials: [{ colour: [0.4, 0.035, 0.02], roughness: 0.3 }],
      },
    ],
    camera: { centre: [0.2, 0.1, 0], distance: 8.2, yaw: 0.5, pitch: 0.35, nearest: 2.5, farthest: 60 },
    edge: 18,
  },
  {
    name: 'lamps',
    title: 'Lamps',
    text: 'Each post is a handful of curves: isolines follow them, with more segments where they bend, and an amplify function turns every segment into a tube of 24 triangles. The globes are octahedra that become spheres as they come near.',
    kinds: [
      {
        file: 'tube.wgsl',
        source: tube,
        layout: LINES,
        entities: posts,
        pools: { vertices: 1 << 14, primitives: 1 << 14 },
        amplified: 72,
        materials: [{ colour: [0.04, 0.05, 0.05], roughness: 0.4 }],
      },
      {
        file: 'globe.wgsl',
        source: globe,
        layout: TRIANGLE,
        entities: globes,
        pools: { vertices: 1 << 15, primitives: 1 << 16 },
        materials: [
          { colour: [0.9, 0.8, 0.6], roughness: 0.5 },
          { colour: [0.9, 0.8, 0.6], shines: [1.6, 1.05, 0.5], roughness: 0.5 },
        ],
      },
    ],
    camera: { centre: [0, 2.1, -4.5], distance: 12.5, yaw: 0.28, pitch: 0.12, nearest: 1, farthest: 80 },
    edge: 12,
    night: true,
  },
  {
    name: 'stars',
    title: 'Stars',
    text: 'Two thousand stars, each of them eight patches: far away an octahedron will do, near by it is a sphere. What is out of view is discarded by the control function, and costs nothing after the first pass.',
    kinds: [
      {
        file: 'globe.wgsl',
        source: globe,
        layout: TRIANGLE,
        entities: stars,
        pools: POOLS,
        materials: [[1, 0.45, 0.2], [1, 0.75, 0.45], [1, 0.95, 0.85], [0.8, 0.9, 1.2], [0.55, 0.7, 1.5]].map((shines) => ({
          colour: [0, 0, 0] as const,
          shines: shines as unknown as Vec3,
          roughness: 1,
        })),
      },
    ],
    camera: { centre: [0, 0, 0], distance: 95, yaw: 0.4, pitch: 0.55, nearest: 4, farthest: 400 },
    edge: 12,
    night: true,
  },
  {
    name: 'mountain',
    title: 'Mountain',
    text: 'Real heights of the Jacksboro fault in Tennessee (SRTM, US Geological Survey), one sample in 80 m, joined by B-spline patches. Near the eye a patch has thousands of triangles, for relief of a few metres; far away it has two.',
    kinds: [
      {
        file: 'mountain.wgsl',
        source: mountainSource,
        layout: SPLINE,
        entities: mountain,
        pools: POOLS,
        clockwise: true,
        uvRange: 8,
        ownMaterial: true,
        materials: [],
      },
    ],
    camera: { centre: [0, 430, 0], distance: 6000, yaw: 0.7, pitch: 0.42, nearest: 300, farthest: 16000 },
    edge: 18,
  },
];
