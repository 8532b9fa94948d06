// Dolomite's own WGSL files, as the build finds them.

const found = import.meta.glob<string>(
  ['../../../shaders/src/stage/*.wgsl', '../../../shaders/src/geometry/*.wgsl', '!**/probe.wgsl', '!**/geometry/draw.wgsl'],
  { eager: true, query: '?raw', import: 'default' },
);

/** By their path below shaders/src. */
export const FILES: ReadonlyMap<string, string> = new Map(
  Object.entries(found).map(([path, text]) => [path.replace(/^.*\/shaders\/src\//, ''), text]),
);
