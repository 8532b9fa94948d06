// Stars of a galaxy with two arms, as examples/stars.rs has them; fewer, so that software adapters keep up.

import { octahedron } from '../stage/mesh.js';
import type { Entity } from '../stage/tables.js';
import { at, type Vec3 } from './place.js';

const STARS = 2000;

/** Numbers from 0 to 1 (PCG: O'Neill 2014). */
function numbers(seed: number): () => number {
  let state = seed;
  return () => {
    state = (Math.imul(state, 747796405) + 2891336453) >>> 0;
    const word = Math.imul(((state >>> ((state >>> 28) + 4)) ^ state) >>> 0, 277803737);
    return (((word >>> 22) ^ word) >>> 0) / 0xffffffff;
  };
}

export function stars(): Entity[] {
  const mesh = octahedron(1);
  const next = numbers(7);
  return Array.from({ length: STARS }, () => {
    let place: Vec3;
    if (next() < 0.25) {
      const ball = [next() + next() - 1, next() + next() - 1, next() + next() - 1] as const;
      const size = next();
      place = [ball[0] * 20 * size, ball[1] * 11 * size, ball[2] * 20 * size];
    } else {
      const away = 6 + 115 * next() * next();
      const angle = (next() < 0.5 ? 0 : Math.PI) + 2.6 * Math.log(away) + (next() - 0.5) * (next() - 0.5) * 5;
      place = [away * Math.cos(angle), (next() + next() + next() - 1.5) * 3, away * Math.sin(angle)];
    }
    const size = 0.16 + 0.9 * next() ** 4;
    return { mesh, rows: at(place, size), params: [Math.min(Math.floor(next() * 5), 4), ...new Array<number>(15).fill(0)] };
  });
}
