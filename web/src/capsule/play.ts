// Plays a capsule on a device, and compares.

import { compare, compareDigests, type Found } from './compare.js';
import { isPlain, load } from './load.js';
import { type Capsule, CapsuleError } from './read.js';
import { compareLists, compareTriangles } from './sets.js';

export interface Played {
  name: string;
  found: Found[];
  /** Milliseconds of the modules and pipelines, and of the rest. */
  compiled: number;
  ran: number;
}

/** Whether all that was found is as near as it must be. */
export function isRight(played: Played): boolean {
  return played.found.length > 0 && played.found.every((found) => found.wrong === 0);
}

async function readBack(device: GPUDevice, buffer: GPUBuffer, offset: number, size: number): Promise<Uint32Array> {
  if (size === 0) return new Uint32Array();
  const staging = device.createBuffer({ size, usage: GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST });
  const encoder = device.createCommandEncoder();
  encoder.copyBufferToBuffer(buffer, offset, staging, 0, size);
  device.queue.submit([encoder.finish()]);
  await staging.mapAsync(GPUMapMode.READ);
  const words = new Uint32Array(staging.getMappedRange().slice(0));
  staging.destroy();
  return words;
}

/** Plays it. Throws what the device says, where it refuses something. */
export async function play(device: GPUDevice, capsule: Capsule): Promise<Played> {
  const { header } = capsule;
  const began = performance.now();
  const { buffers, submit, destroy } = await load(device, capsule);
  const compiled = performance.now();

  const found: Found[] = [];
  device.pushErrorScope('validation');
  for (const command of header.commands) {
    switch (command.do) {
      case 'write':
      case 'clear':
      case 'pass':
        submit([command]);
        break;
      case 'check': {
        const size = command.count * command.stride;
        const words = await readBack(device, buffers[command.buffer]!, command.offset, size);
        found.push(...compare(command, words, capsule.words(command.expected)));
        break;
      }
      case 'triangles': {
        const [vertices, indices] = [buffers[command.vertices]!, buffers[command.indices]!];
        const all = await readBack(device, vertices, 0, vertices.size);
        const corners = await readBack(device, indices, 0, 12 * command.count);
        found.push(...compareTriangles(command, all, corners, capsule.words(command.expected)));
        break;
      }
      case 'lists': {
        const words = await readBack(device, buffers[command.buffer]!, 0, header.buffers[command.buffer]!.size);
        found.push(compareLists(command, words, capsule.words(command.expected)));
        break;
      }
      case 'digest': {
        const { size } = header.buffers[command.buffer]!;
        const words = await readBack(device, buffers[command.buffer]!, 0, size);
        found.push(compareDigests(command.name, words, capsule.words(command.ranges), capsule.words(command.expected)));
        break;
      }
    }
  }
  const wrong = await device.popErrorScope();
  destroy();
  if (wrong) throw new CapsuleError(`${header.name}: ${wrong.message}`);
  return { name: header.name, found, compiled: compiled - began, ran: performance.now() - compiled };
}

/** Runs that are waited for together, so that waiting counts little; as `ROUND` in lab/src/capsule/native.rs. */
export const ROUND = 10;

/** Milliseconds of a run of all that stands before the first comparison: of each of so many rounds, submitted and waited for. */
export async function times(device: GPUDevice, capsule: Capsule, repeats: number): Promise<number[]> {
  const { submit, destroy } = await load(device, capsule);
  const { commands } = capsule.header;
  const run = commands.slice(0, commands.findIndex((command) => !isPlain(command))).filter(isPlain);
  const taken: number[] = [];
  // The first two bring along what is compiled late.
  for (let k = -2; k < repeats; k += 1) {
    const began = performance.now();
    for (let number = 0; number < ROUND; number += 1) submit(run);
    await device.queue.onSubmittedWorkDone();
    if (k >= 0) taken.push((performance.now() - began) / ROUND);
  }
  destroy();
  return taken;
}
