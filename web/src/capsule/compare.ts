// Compares what came out of a run with what was expected: words bit by bit, numbers in units in the last place.

import type { Check, Field } from './format.js';

/** What was found about one field of all records of a check. */
export interface Found {
  check: string;
  field: string;
  /** Numbers compared. */
  count: number;
  /** Numbers whose bits are not the expected ones. */
  different: number;
  /** Numbers that are farther off than they may be. */
  wrong: number;
  /** The largest difference: units in the last place of f32, steps of others, 1 for words. */
  largest: number;
  /** The most that it may be. */
  allowed: number;
  unit: 'ulp' | 'steps' | 'bits';
  /** The first that is wrong, in words. */
  first?: string;
}

const float = new Float32Array(1);
const word = new Uint32Array(float.buffer);

export function asFloat(bits: number): number {
  word[0] = bits;
  return float[0]!;
}

/** The distance between f32 of this size, 2^-23 of the power of two below it. */
export function ulpOf(size: number): number {
  const exponent = Math.floor(Math.log2(Math.max(size, 2 ** -126)));
  // log2 rounds: 1 − 2^-24 must not be taken for 1.
  const power = 2 ** exponent;
  return (power > size ? power / 2 : 2 * power <= size ? 2 * power : power) * 2 ** -23;
}

/** Numbers of a field, from the words of its record. */
const parts: Record<Field['type'], number> = { u32: 1, f32: 1, oct12: 2, snorm16x2: 2, part: 1 };

function difference(field: Field, found: number, expected: number): number[] {
  switch (field.type) {
    case 'u32':
      return [found === expected ? 0 : 1];
    case 'f32': {
      if (found === expected) return [0];
      const [a, b] = [asFloat(found), asFloat(expected)];
      if (Number.isNaN(a) || Number.isNaN(b)) return [Number.isNaN(a) && Number.isNaN(b) ? 0 : Infinity];
      return [Math.abs(a - b) / ulpOf(Math.max(Math.abs(b), field.scale))];
    }
    case 'oct12': {
      const part = (shift: number): number => Math.abs(((found >>> shift) & 0xfff) - ((expected >>> shift) & 0xfff));
      const material = found >>> 24 === expected >>> 24 ? 0 : Infinity;
      return [part(0) + material, part(12) + material];
    }
    case 'part': {
      const part = (bits: number): number => (bits >>> field.low) & (2 ** field.bits - 1);
      return [Math.abs(part(found) - part(expected))];
    }
    case 'snorm16x2': {
      const signed = (bits: number, shift: number): number => ((bits >>> shift) << 16) >> 16;
      return [0, 16].map((shift) => Math.abs(signed(found, shift) - signed(expected, shift)));
    }
  }
}

function allowedOf(field: Field): number {
  return field.type === 'u32' ? 0 : field.type === 'f32' ? field.ulp : field.steps;
}

/** The records in the order of the fields whose bits have to be the same. */
function ordered(check: Check, words: Uint32Array): Uint32Array {
  const stride = check.stride / 4;
  const keys = check.fields.flatMap((field) =>
    field.type === 'u32' ? Array.from({ length: field.count }, (_, k) => field.at / 4 + k) : [],
  );
  const places = Array.from({ length: check.count }, (_, k) => k * stride);
  places.sort((a, b) => {
    const key = keys.find((at) => words[a + at] !== words[b + at]) ?? 0;
    return words[a + key]! - words[b + key]!;
  });
  const sorted = new Uint32Array(check.count * stride);
  places.forEach((from, k) => sorted.set(words.subarray(from, from + stride), k * stride));
  return sorted;
}

export function compare(check: Check, as: Uint32Array, wanted: Uint32Array): Found[] {
  const [found, expected] = check.unordered ? [ordered(check, as), ordered(check, wanted)] : [as, wanted];
  return check.fields.map((field) => {
    const allowed = allowedOf(field);
    const result: Found = {
      check: check.name,
      field: field.name,
      count: check.count * field.count * parts[field.type],
      different: 0,
      wrong: 0,
      largest: 0,
      allowed,
      unit: field.type === 'u32' ? 'bits' : field.type === 'f32' ? 'ulp' : 'steps',
    };
    for (let record = 0; record < check.count; record += 1) {
      for (let k = 0; k < field.count; k += 1) {
        const at = (record * check.stride + field.at) / 4 + k;
        const [a, b] = [found[at] ?? 0, expected[at] ?? 0];
        if (a === b) continue;
        for (const off of difference(field, a, b)) {
          if (off === 0) continue;
          result.different += 1;
          result.largest = Math.max(result.largest, off);
          if (off <= allowed) continue;
          result.wrong += 1;
          const shown = (bits: number): string => (field.type === 'f32' ? String(asFloat(bits)) : `0x${bits.toString(16)}`);
          result.first ??= `record ${record}, number ${k}: ${shown(a)} in place of ${shown(b)}`;
        }
      }
    }
    return result;
  });
}

/** FNV-1a over words, as `digest` in lab/src/capsule/format.rs. */
export function digest(words: Uint32Array): number {
  let hash = 0x811c9dc5;
  for (const value of words) hash = Math.imul(hash ^ value, 0x01000193);
  return hash >>> 0;
}

export function compareDigests(name: string, found: Uint32Array, ranges: Uint32Array, expected: Uint32Array): Found {
  const result: Found = {
    check: name,
    field: 'words',
    count: expected.length,
    different: 0,
    wrong: 0,
    largest: 0,
    allowed: 0,
    unit: 'bits',
  };
  for (let k = 0; k < expected.length; k += 1) {
    const [first, length] = [ranges[2 * k]!, ranges[2 * k + 1]!];
    if (digest(found.subarray(first, first + length)) === expected[k]) continue;
    result.different += 1;
    result.wrong += 1;
    result.largest = 1;
    result.first ??= `range ${k}: words ${first} to ${first + length}`;
  }
  return result;
}
