// What the passes read of entities: owners of corners and edges, patches, control points; as
// plugins/tessellation/src/tables.rs.

import type { Layout, PatchMesh } from './mesh.js';

/** Where a mesh stands, and its parameters. */
export interface Entity {
  mesh: PatchMesh;
  /** Rows of the matrix to the world, of four numbers each. */
  rows: readonly (readonly number[])[];
  /** Four times four numbers. */
  params: readonly number[];
}

export interface Counts {
  corners: number;
  edges: number;
  patches: number;
  /** Where control points begin in the data, vec4. */
  points: number;
}

export interface Tables {
  words: Uint32Array<ArrayBuffer>;
  data: Float32Array<ArrayBuffer>;
  counts: Counts;
}

const ENTITY_FLOATS = 44;

export function tablesOf(layout: Layout, entities: readonly Entity[]): Tables {
  const [corners, edges, patches, indices]: number[][] = [[], [], [], []] as number[][];
  const points: number[] = [];
  const known = new Map<PatchMesh, { index: number; point: number }>();
  entities.forEach(({ mesh }, entity) => {
    let first = known.get(mesh);
    if (!first) {
      first = { index: indices!.length, point: points.length / 4 };
      known.set(mesh, first);
      for (let k = 0; k < mesh.indices.length; k += 1) indices!.push(mesh.indices[k]!);
      for (const point of mesh.points) points.push(...point);
    }
    const { topology } = mesh;
    const firstPatch = patches!.length / 12;
    const [firstCorner, firstEdge] = [corners!.length, edges!.length];
    for (const owner of topology.corners) corners!.push(owner + 4 * firstPatch);
    for (const owner of topology.edges) edges!.push(owner + 4 * firstPatch);
    topology.patches.forEach((own, number) => {
      patches!.push(entity, number, first.index + number * layout.points, first.point);
      // The sum leaves the mark of reversal in the top bit alone.
      own.forEach((word, k) => patches!.push(word + (k < 4 ? firstCorner : firstEdge)));
    });
  });
  const counts: Counts = {
    corners: corners!.length,
    edges: edges!.length,
    patches: patches!.length / 12,
    points: (entities.length * ENTITY_FLOATS) / 4,
  };
  const indexTable = corners!.length + edges!.length + patches!.length;
  for (let at = 2; at < patches!.length; at += 12) patches![at]! += indexTable;
  const words = new Uint32Array(indexTable + indices!.length);
  let at = 0;
  for (const list of [corners!, edges!, patches!, indices!]) {
    words.set(list, at);
    at += list.length;
  }
  const data = new Float32Array(entities.length * ENTITY_FLOATS + points.length);
  entities.forEach(({ rows, params }, number) => {
    data.set([...rows.flat(), ...rows.flat(), ...params], number * ENTITY_FLOATS);
  });
  data.set(points, entities.length * ENTITY_FLOATS);
  return { words, data, counts };
}
