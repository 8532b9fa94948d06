// Comparisons of what stands in no order: triangles wherever their vertices are, and lists wherever they begin.

import { type Found, ulpOf } from './compare.js';
import type { Lists, Triangles } from './format.js';

/** A triangle from its least corner on: the bits of where its corners are, and their heights. */
interface Triangle {
  key: string;
  heights: number[];
}

function triangle(corners: readonly (readonly [number, number, number])[]): Triangle {
  // + 0 takes the sign of 0 away, which is that of a rounding.
  const places = corners.map(([x, , z]) => [x + 0, z + 0] as const);
  const before = (a: number, b: number): boolean => {
    const [p, q] = [places[a]!, places[b]!];
    return p[0] < q[0] || (p[0] === q[0] && p[1] < q[1]);
  };
  const least = [1, 2].reduce((best, k) => (before(k, best) ? k : best), 0);
  const turned = [0, 1, 2].map((k) => (least + k) % 3);
  return { key: turned.map((k) => places[k]!.join()).join(';'), heights: turned.map((k) => corners[k]![1]) };
}

/** Two findings: triangles that are not on both sides, and heights of the others. */
export function compareTriangles(command: Triangles, vertices: Uint32Array, indices: Uint32Array, expected: Uint32Array): Found[] {
  const [numbers, wanted] = [vertices, expected].map((words) => new Float32Array(words.buffer)) as [Float32Array, Float32Array];
  const stored = (index: number): [number, number, number] => {
    const at = (index * command.stride) / 4;
    return [numbers[at] ?? NaN, numbers[at + 1] ?? NaN, numbers[at + 2] ?? NaN];
  };
  const theirs = new Map<string, number[]>();
  for (let k = 0; k < command.count; k += 1) {
    const corner = (j: number): [number, number, number] => {
      const at = 9 * k + 3 * j;
      return [wanted[at]!, wanted[at + 1]!, wanted[at + 2]!];
    };
    const { key, heights } = triangle([corner(0), corner(1), corner(2)]);
    theirs.set(key, heights);
  }
  const of = (field: string, count: number, allowed: number, unit: Found['unit']): Found => ({
    check: command.name, field, count, different: 0, wrong: 0, largest: 0, allowed, unit,
  });
  const places = of('places', command.count, 0, 'bits');
  const heights = of('heights', 3 * command.count, command.ulp, 'ulp');
  for (let k = 0; k < command.count; k += 1) {
    const corners = [0, 1, 2].map((j) => stored(indices[3 * k + j]!));
    const { key, heights: own } = triangle(corners);
    const there = theirs.get(key);
    if (!there) {
      places.different += 1;
      places.first ??= `triangle ${k}, ${key}, is nowhere among those that are expected`;
      continue;
    }
    // A triangle that comes twice is not expected the second time.
    theirs.delete(key);
    own.forEach((height, j) => {
      if (height === there[j]) return;
      const off = Math.abs(height - there[j]!) / ulpOf(Math.max(Math.abs(there[j]!), command.scale));
      heights.different += 1;
      heights.largest = Math.max(heights.largest, off);
      if (off <= command.ulp) return;
      heights.wrong += 1;
      heights.first ??= `triangle ${k}, corner ${j}: ${height} in place of ${there[j]}`;
    });
  }
  places.wrong = places.different + theirs.size;
  places.different = places.wrong;
  places.largest = places.wrong;
  return [places, heights];
}

export function compareLists(command: Lists, words: Uint32Array, expected: Uint32Array): Found {
  const found: Found = { check: command.name, field: 'lists', count: 0, different: 0, wrong: 0, largest: 0, allowed: 0, unit: 'bits' };
  let at = 0;
  for (let record = 0; record < command.count; record += 1) {
    const head = command.offset + record * command.stride;
    const [first, length] = [words[(head + command.first) / 4]!, words[(head + command.length) / 4]!];
    const wanted = expected.subarray(at + 1, at + 1 + expected[at]!);
    at += 1 + expected[at]!;
    found.count += wanted.length + 1;
    const own = words.subarray(first, first + length);
    if (own.length === wanted.length && own.every((word, k) => word === wanted[k])) continue;
    found.different += 1;
    found.wrong += 1;
    found.largest = 1;
    found.first ??= `list ${record}: ${own.slice(0, 12).join(' ')} in place of ${wanted.slice(0, 12).join(' ')}`;
  }
  return found;
}
