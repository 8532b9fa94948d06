#!/usr/bin/env bash
# gltfpack, kept keys (`-af 0`) of a rotation that is a cubic spline: what becomes of its tangents.
#
# Version: gltfpack 1.3.0 (npm), node 18 or newer
# Guess:   `-af 0` keeps the keys of a sampler of CUBICSPLINE as they are, up to the rounding of its number format: a node that
#          turns at 4 rad/s turns as before, within a tenth of a degree.
# Seen:    `CUBICSPLINE of normalized shorts, tangent 2.0000 -> 1.0000, at 0.23 s 30.77 -> 19.14 degrees`. The output is an accessor
#          of normalized shorts, which suit unit quaternions; but a spline's output holds tangents too, and these are cut off at 1.
#          A quaternion's derivative has half the length of the angular velocity, so whatever turns faster than 2 rad/s is slowed
#          down. gltfpack says nothing; with `-noq`, or resampled (the default, 30 Hz), the motion is kept.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

npm init --yes >/dev/null
npm install --silent --no-audit --no-fund gltfpack@1.3.0 >/dev/null

# A node that turns about Y: keys at 0, 1 and 2 s, with the derivatives of a rotation at 4 rad/s.
cat >make.mjs <<'JS'
import { writeFileSync } from 'node:fs';
const SPEED = 4, times = [0, 1, 2], angles = [0, 1.2, 2.4], output = [];
for (const angle of angles) {
  const key = [0, Math.sin(angle / 2), 0, Math.cos(angle / 2)];
  const tangent = [0, (Math.cos(angle / 2) * SPEED) / 2, 0, (-Math.sin(angle / 2) * SPEED) / 2];
  output.push(...tangent, ...key, ...tangent);
}
const corners = [0, 0, 0, 1, 0, 0, 0, 1, 0];
const bytes = Buffer.from(new Float32Array([...corners, ...times, ...output]).buffer);
const view = (byteOffset, byteLength) => ({ buffer: 0, byteOffset, byteLength });
writeFileSync('turn.gltf', JSON.stringify({
  asset: { version: '2.0' },
  scene: 0,
  scenes: [{ nodes: [0] }],
  nodes: [{ name: 'turning', mesh: 0 }],
  meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
  buffers: [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString('base64')}` }],
  bufferViews: [view(0, 36), view(36, 12), view(48, 4 * output.length)],
  accessors: [
    { bufferView: 0, componentType: 5126, count: 3, type: 'VEC3', min: [0, 0, 0], max: [1, 1, 0] },
    { bufferView: 1, componentType: 5126, count: 3, type: 'SCALAR', min: [0], max: [2] },
    { bufferView: 2, componentType: 5126, count: 9, type: 'VEC4' },
  ],
  animations: [{
    samplers: [{ input: 1, output: 2, interpolation: 'CUBICSPLINE' }],
    channels: [{ sampler: 0, target: { node: 0, path: 'rotation' } }],
  }],
}));
JS
node make.mjs
npx gltfpack -i turn.gltf -o packed.gltf -af 0 >packed.log 2>&1

cat >play.mjs <<'JS'
import { readFileSync } from 'node:fs';
const open = (name) => {
  const gltf = JSON.parse(readFileSync(name, 'utf8'));
  const uri = gltf.buffers[0].uri;
  const bytes = uri.startsWith('data:') ? Buffer.from(uri.split(',')[1], 'base64') : readFileSync(uri);
  const sampler = gltf.animations[0].samplers[0];
  const accessor = gltf.accessors[sampler.output];
  const view = gltf.bufferViews[accessor.bufferView];
  const short = accessor.componentType === 5122;
  const size = short ? 2 : 4;
  const at = (element, k) => {
    const place = (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0) + element * (view.byteStride ?? 4 * size) + size * k;
    return short ? Math.max(bytes.readInt16LE(place) / 32767, -1) : bytes.readFloatLE(place);
  };
  const element = (number) => [0, 1, 2, 3].map((k) => at(number, k));
  return { sampler, short: short && accessor.normalized, element };
};
// Of the first span, one second long, by glTF's formula of cubic splines.
const angle = ({ element }, t) => {
  const [p, m, n, q] = [element(1), element(2), element(3), element(4)];
  const at = (k) => (2 * t ** 3 - 3 * t ** 2 + 1) * p[k] + (t ** 3 - 2 * t ** 2 + t) * m[k]
    + (-2 * t ** 3 + 3 * t ** 2) * q[k] + (t ** 3 - t ** 2) * n[k];
  return (2 * Math.atan2(at(1), at(3)) * 180) / Math.PI;
};
const [source, packed] = ['turn.gltf', 'packed.gltf'].map(open);
const kind = `${packed.sampler.interpolation} of ${packed.short ? 'normalized shorts' : 'another format'}`;
const tangents = [source, packed].map(({ element }) => element(2)[1].toFixed(4)).join(' -> ');
// Where the two differ most.
let most = 0;
for (let k = 1; k < 100; k++) {
  if (Math.abs(angle(source, k / 100) - angle(packed, k / 100)) > Math.abs(angle(source, most) - angle(packed, most))) most = k / 100;
}
console.log(`${kind}, tangent ${tangents}, at ${most.toFixed(2)} s ${[source, packed].map((file) => angle(file, most).toFixed(2)).join(' -> ')} degrees`);
JS
node play.mjs | tee seen
grep --quiet --fixed-strings 'CUBICSPLINE of normalized shorts, tangent 2.0000 -> 1.0000, at 0.23 s 30.77 -> 19.14 degrees' seen
