// Rows of matrices to the world.

export type Vec3 = readonly [number, number, number];

/** Scaled, and put at a place. */
export function at([x, y, z]: Vec3, scale: number): number[][] {
  return [[scale, 0, 0, x], [0, scale, 0, y], [0, 0, scale, z]];
}

/** Turned about the vertical, by half a turn where `way` is −1, and put at a place. */
export function turned(way: number, [x, y, z]: Vec3): number[][] {
  return [[way, 0, 0, x], [0, 1, 0, y], [0, 0, way, z]];
}
