// A ridge of the Jacksboro fault, Tennessee (assets/dem): the build cuts it out of the file of real heights.

import heights from 'virtual:mountain';
import { PatchMesh, SPLINE, type Vec4 } from '../stage/mesh.js';
import type { Entity } from '../stage/tables.js';
import { at } from './place.js';

/** Metres between samples, to the east and to the south. */
const STEP = [74.6, 92.5] as const;

export function mountain(): Entity[] {
  const { columns, rows, metres } = heights;
  const points = metres.map((height, k): Vec4 => {
    const [x, z] = [k % columns, Math.floor(k / columns)];
    return [(x - columns / 2) * STEP[0], height, (z - rows / 2) * STEP[1], 0];
  });
  const indices: number[] = [];
  for (let z = 0; z + 3 < rows; z += 1) {
    for (let x = 0; x + 3 < columns; x += 1) {
      for (let j = 0; j < 4; j += 1) for (let i = 0; i < 4; i += 1) indices.push((z + j) * columns + x + i);
    }
  }
  const mesh = new PatchMesh(SPLINE, points, indices);
  return [{ mesh, rows: at([0, 0, 0], 1), params: [14, 170, ...new Array<number>(14).fill(0)] }];
}
