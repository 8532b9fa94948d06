// Posts and globes of a lane of lamps, as examples/lamps.rs has them.

import { LINES, octahedron, PatchMesh, type Vec4 } from '../stage/mesh.js';
import type { Entity } from '../stage/tables.js';
import { at, turned } from './place.js';

/** A curve through points with radii, as patches of four: the ends are repeated. */
function curve(points: readonly Vec4[]): Vec4[] {
  const point = (k: number): Vec4 => points[Math.min(Math.max(k, 1), points.length) - 1]!;
  return points.slice(1).flatMap((_, k) => [point(k), point(k + 1), point(k + 2), point(k + 3)]);
}

/** Foot, shaft, and a crook with a curl: position and radius, metres. */
const SHAFT: readonly Vec4[] = [
  [0, 0, 0, 0.16], [0, 0.12, 0, 0.15], [0, 0.22, 0, 0.07], [0, 0.5, 0, 0.06], [0, 2.9, 0, 0.045],
  [0.05, 3.5, 0, 0.04], [0.35, 3.95, 0, 0.035], [0.75, 3.98, 0, 0.03], [0.98, 3.7, 0, 0.028], [1, 3.45, 0, 0.028],
];
const CURL: readonly Vec4[] = [
  [0.02, 3.2, 0, 0.02], [0.25, 3.4, 0, 0.018], [0.45, 3.62, 0, 0.016], [0.62, 3.6, 0, 0.014], [0.62, 3.42, 0, 0.012],
  [0.48, 3.4, 0, 0.01], [0.47, 3.5, 0, 0.008],
];

const LAMPS = [0, 1, 2, 3, 4, 5, 6].map((k) => ({ x: k % 2 === 0 ? -2.4 : 2.4, z: -4 * k, way: k % 2 === 0 ? 1 : -1 }));

export function posts(): Entity[] {
  const mesh = PatchMesh.fromPatches(LINES, [...curve(SHAFT), ...curve(CURL)]);
  return LAMPS.map(({ x, z, way }) => ({ mesh, rows: turned(way, [x, 0, z]), params: new Array<number>(16).fill(0) }));
}

export function globes(): Entity[] {
  const mesh = octahedron(1);
  return LAMPS.map(({ x, z, way }) => ({
    mesh,
    rows: at([x + way, 3.24, z], 0.22),
    params: [1, ...new Array<number>(15).fill(0)],
  }));
}
