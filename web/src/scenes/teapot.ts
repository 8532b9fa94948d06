// The control points of the Utah teapot (Newell 1975), as examples/teapot.rs has them: 32 bicubic Bézier patches.

import { BICUBIC, PatchMesh, type Vec4 } from '../stage/mesh.js';

type Pair = readonly [number, number];

/** What is turned round the axis: four (radius, height) of each strip of the profile. */
const TURNED: readonly (readonly Pair[])[] = [
  [[1.4, 2.4], [1.3375, 2.53125], [1.4375, 2.53125], [1.5, 2.4]],
  [[1.5, 2.4], [1.75, 1.875], [2.0, 1.35], [2.0, 0.9]],
  [[2.0, 0.9], [2.0, 0.45], [1.5, 0.225], [1.5, 0.15]],
  [[0.0, 3.15], [0.8, 3.15], [0.0, 2.85], [0.2, 2.7]],
  [[0.2, 2.7], [0.4, 2.55], [1.3, 2.55], [1.3, 2.4]],
  [[1.5, 0.15], [1.5, 0.075], [1.425, 0.0], [0.0, 0.0]],
];

/** Handle and spout, the half before z = 0: rows of four (x, height), and how far the middle two stand out. */
const SWEPT: readonly (readonly (readonly [readonly Pair[], number])[])[] = [
  [
    [[[-1.6, 2.025], [-1.6, 2.025], [-1.5, 2.25], [-1.5, 2.25]], 0.3],
    [[[-2.3, 2.025], [-2.3, 2.025], [-2.5, 2.25], [-2.5, 2.25]], 0.3],
    [[[-2.7, 2.025], [-2.7, 2.025], [-3.0, 2.25], [-3.0, 2.25]], 0.3],
    [[[-2.7, 1.8], [-2.7, 1.8], [-3.0, 1.8], [-3.0, 1.8]], 0.3],
  ],
  [
    [[[-2.7, 1.8], [-2.7, 1.8], [-3.0, 1.8], [-3.0, 1.8]], 0.3],
    [[[-2.7, 1.575], [-2.7, 1.575], [-3.0, 1.35], [-3.0, 1.35]], 0.3],
    [[[-2.5, 1.125], [-2.5, 1.125], [-2.65, 0.9375], [-2.65, 0.9375]], 0.3],
    [[[-2.0, 0.9], [-2.0, 0.9], [-1.9, 0.6], [-1.9, 0.6]], 0.3],
  ],
  [
    [[[1.7, 1.425], [1.7, 1.425], [1.7, 0.6], [1.7, 0.6]], 0.66],
    [[[2.6, 1.425], [2.6, 1.425], [3.1, 0.825], [3.1, 0.825]], 0.66],
    [[[2.3, 2.1], [2.3, 2.1], [2.4, 2.025], [2.4, 2.025]], 0.25],
    [[[2.7, 2.4], [2.7, 2.4], [3.3, 2.4], [3.3, 2.4]], 0.25],
  ],
  [
    [[[2.7, 2.4], [2.7, 2.4], [3.3, 2.4], [3.3, 2.4]], 0.25],
    [[[2.8, 2.475], [2.8, 2.475], [3.525, 2.49375], [3.525, 2.49375]], 0.25],
    [[[2.9, 2.475], [2.9, 2.475], [3.45, 2.5125], [3.45, 2.5125]], 0.15],
    [[[2.8, 2.4], [2.8, 2.4], [3.2, 2.4], [3.2, 2.4]], 0.15],
  ],
];

/** Newell's control points off the axes of a quarter circle stand at this share of its radius. */
const QUARTER = 0.56;

export function teapot(): PatchMesh {
  const points: Vec4[] = [];
  const turns = [[[1, 0], [0, 1]], [[0, 1], [-1, 0]], [[-1, 0], [0, -1]], [[0, -1], [1, 0]]] as const;
  for (const strip of TURNED) {
    for (const [along, across] of turns) {
      for (const [radius, height] of strip) {
        for (const [a, b] of [[1, 0], [1, QUARTER], [QUARTER, 1], [0, 1]] as const) {
          points.push([radius * (a * along[0] + b * across[0]), height, radius * (a * along[1] + b * across[1]), 0]);
        }
      }
    }
  }
  for (const patch of SWEPT) {
    for (const side of [1, -1]) {
      for (const [row, out] of patch) {
        row.forEach(([x, y], k) => points.push([x, y, k === 1 || k === 2 ? out * side : 0, 0]));
      }
    }
  }
  return PatchMesh.fromPatches(BICUBIC, points);
}
