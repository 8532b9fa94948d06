// Patches over shared control points, and which corners and edges they share: as PatchMesh and Topology in
// plugins/tessellation/src/patches.rs and topology.rs.

export type Domain = 'triangles' | 'quads' | 'isolines';

/** What a patch is made of. */
export interface Layout {
  domain: Domain;
  /** Control points a patch. */
  points: number;
  /** Control points along each side, from its start to its end; the last one is the side's corner. */
  sides: readonly (readonly number[])[];
}

export const TRIANGLE: Layout = { domain: 'triangles', points: 3, sides: [[1, 2], [2, 0], [0, 1]] };
export const QUAD: Layout = { domain: 'quads', points: 4, sides: [[3, 0], [0, 1], [1, 2], [2, 3]] };
export const BICUBIC: Layout = {
  domain: 'quads',
  points: 16,
  sides: [[12, 8, 4, 0], [0, 1, 2, 3], [3, 7, 11, 15], [15, 14, 13, 12]],
};
/** The same points as a uniform B-spline's: the surface lies within the inner four. */
export const SPLINE: Layout = { domain: 'quads', points: 16, sides: [[9, 5], [5, 6], [6, 10], [10, 9]] };
export const LINES: Layout = { domain: 'isolines', points: 4, sides: [] };

export type Vec4 = readonly [number, number, number, number];

/** Marks an edge that runs against the side of the patch. */
const REVERSED = 0x80000000;

export interface Topology {
  /** Owner of each corner and of each edge: patch · 4 + its number there. */
  corners: number[];
  edges: number[];
  /** Of each patch: four corners, four edges. */
  patches: number[][];
}

function link(layout: Layout, indices: ArrayLike<number>): Topology {
  const topology: Topology = { corners: [], edges: [], patches: [] };
  const corners = new Map<number, number>();
  const edges = new Map<string, { edge: number; backwards: boolean }>();
  for (let patch = 0; patch * layout.points < indices.length; patch += 1) {
    const own = [0, 0, 0, 0, 0, 0, 0, 0];
    layout.sides.forEach((side, k) => {
      const along = side.map((point) => indices[patch * layout.points + point]!);
      const [from, to] = [along[0]!, along.at(-1)!];
      let corner = corners.get(to);
      if (corner === undefined) {
        corner = topology.corners.push(patch * 4 + k) - 1;
        corners.set(to, corner);
      }
      own[k] = corner;
      const backwards = from > to;
      const key = (backwards ? along.reverse() : along).join();
      // A side that starts where it ends has no direction to share it by.
      let known = from === to ? undefined : edges.get(key);
      if (!known) {
        known = { edge: topology.edges.push(patch * 4 + k) - 1, backwards };
        if (from !== to) edges.set(key, known);
      }
      own[4 + k] = (known.edge | (known.backwards !== backwards ? REVERSED : 0)) >>> 0;
    });
    topology.patches.push(own);
  }
  return topology;
}

export class PatchMesh {
  readonly topology: Topology;

  constructor(
    readonly layout: Layout,
    readonly points: readonly Vec4[],
    readonly indices: ArrayLike<number>,
  ) {
    if (indices.length % layout.points !== 0) throw new RangeError(`${indices.length} indices do not make whole patches`);
    for (let k = 0; k < indices.length; k += 1) {
      if (!(indices[k]! < points.length)) throw new RangeError(`there is no control point ${indices[k]}`);
    }
    this.topology = link(layout, indices);
  }

  /** Patches from the control points of each in turn: those that are equal become one. */
  static fromPatches(layout: Layout, patches: readonly Vec4[]): PatchMesh {
    const known = new Map<string, number>();
    const points: Vec4[] = [];
    const indices = patches.map((point) => {
      const key = point.map((x) => x + 0).join();
      let index = known.get(key);
      if (index === undefined) {
        index = points.push(point) - 1;
        known.set(key, index);
      }
      return index;
    });
    return new PatchMesh(layout, points, indices);
  }

  get patches(): number {
    return this.topology.patches.length;
  }
}

/** An octahedron of radius 1 whose faces are cut into parts² triangles each; see shapes.rs. */
export function octahedron(parts: number): PatchMesh {
  const points: Vec4[] = [];
  const around = [[0, 1], [1, 0], [0, -1], [-1, 0], [0, 1]] as const;
  for (const y of [1, -1]) {
    for (let quarter = 0; quarter < 4; quarter += 1) {
      const [[ax, az], [bx, bz]] = [around[quarter]!, around[quarter + 1]!];
      const point = (i: number, j: number): Vec4 => {
        const a = parts - i - j;
        return [(a * ax + i * bx) / parts, (j * y) / parts, (a * az + i * bz) / parts, 0];
      };
      const push = (a: Vec4, b: Vec4, c: Vec4): void => {
        points.push(...(y > 0 ? [a, b, c] : [b, a, c]));
      };
      for (let j = 0; j < parts; j += 1) {
        for (let i = 0; i < parts - j; i += 1) {
          push(point(i, j), point(i + 1, j), point(i, j + 1));
          if (i + j + 2 <= parts) push(point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
        }
      }
    }
  }
  return PatchMesh.fromPatches(TRIANGLE, points);
}
