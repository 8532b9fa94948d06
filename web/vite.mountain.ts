// `virtual:mountain`: a piece of the file of real heights, cut out at build time.

import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import type { Plugin } from 'vite';

const FILE = '../assets/dem/jacksboro_344x403_i16le_metres.raw';
const COLUMNS = 403;
/** First row and column, and how many. */
const PIECE = { row: 220, column: 200, rows: 90, columns: 100 };

export function mountain(): Plugin {
  const name = 'virtual:mountain';
  return {
    name,
    resolveId: (id) => (id === name ? `\0${name}` : undefined),
    load(id) {
      if (id !== `\0${name}`) return undefined;
      const bytes = readFileSync(resolve(import.meta.dirname, FILE));
      const metres: number[] = [];
      for (let row = 0; row < PIECE.rows; row += 1) {
        for (let column = 0; column < PIECE.columns; column += 1) {
          metres.push(bytes.readInt16LE(2 * ((PIECE.row + row) * COLUMNS + PIECE.column + column)));
        }
      }
      return `export default ${JSON.stringify({ columns: PIECE.columns, rows: PIECE.rows, metres })};`;
    },
  };
}
