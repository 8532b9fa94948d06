#!/usr/bin/env bash
# Dawn's null backend, by npm's `webgpu`: what a copy from buffer to buffer leaves in its target.
#
# Version: webgpu 0.6.2 (npm), Node 20.20.2, Linux x86_64
# Guess:   a backend without a device still keeps what is written and copied: after writing sevens into one
#          buffer and copying it into another, the other maps as sevens. Failing that, as zeros, since
#          WebGPU promises that a new buffer reads as zeros.
# Seen:    `direct 5,5,5,5 copied same: no error: none`. What queue.writeBuffer puts into a mappable buffer
#          is there; a copy between buffers is accepted without an error and moves nothing, and the target
#          maps as whatever memory it was given: most often not zeros, other numbers in each run.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
npm install --silent --ignore-scripts --no-audit --no-fund webgpu@0.6.2
cat >copy.mjs <<'JS'
import { create, globals } from 'webgpu';
Object.assign(globalThis, globals);
const device = await (await create(['backend=null']).requestAdapter()).requestDevice();
let error = 'none';
device.addEventListener('uncapturederror', (event) => (error = event.error.message));
const { COPY_SRC, COPY_DST, MAP_READ } = GPUBufferUsage;
const mapped = async (buffer) => {
  await buffer.mapAsync(GPUMapMode.READ);
  return new Uint8Array(buffer.getMappedRange());
};
const direct = device.createBuffer({ size: 4, usage: MAP_READ | COPY_DST });
device.queue.writeBuffer(direct, 0, new Uint8Array(4).fill(5));
const from = device.createBuffer({ size: 256, usage: COPY_SRC | COPY_DST });
device.queue.writeBuffer(from, 0, new Uint8Array(256).fill(7));
const to = device.createBuffer({ size: 256, usage: MAP_READ | COPY_DST });
const encoder = device.createCommandEncoder();
encoder.copyBufferToBuffer(from, 0, to, 0, 256);
device.queue.submit([encoder.finish()]);
const same = (await mapped(to)).every((byte) => byte === 7) ? 'yes' : 'no';
console.log(`direct ${await mapped(direct)} copied same: ${same} error: ${error}`);
process.exit(0);
JS
seen=$(node copy.mjs)
echo "$seen"
[[ $seen == 'direct 5,5,5,5 copied same: no error: none' ]]
