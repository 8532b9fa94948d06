// Plays a capsule on a device, and compares.

import { compare, compareDigests, type Found } from './compare.js';
import type { BindingKind, Header } from './format.js';
import { type Capsule, CapsuleError } from './read.js';

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

const COMPUTE = 4; // GPUShaderStage.COMPUTE

function usages(header: Header): number[] {
  const usage = header.buffers.map(() => GPUBufferUsage.COPY_SRC | GPUBufferUsage.COPY_DST);
  const of: Record<BindingKind, number> = {
    uniform: GPUBufferUsage.UNIFORM,
    'read-only-storage': GPUBufferUsage.STORAGE,
    storage: GPUBufferUsage.STORAGE,
  };
  for (const { layout, buffers } of header.groups) {
    buffers.forEach((buffer, binding) => {
      usage[buffer]! |= of[header.layouts[layout]![binding]!];
    });
  }
  for (const command of header.commands) {
    if (command.do !== 'pass') continue;
    for (const { indirect } of command.steps) {
      if (indirect) usage[indirect.buffer]! |= GPUBufferUsage.INDIRECT;
    }
  }
  return usage;
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

/** What a compiler says of each module, or nothing. */
async function modulesOf(device: GPUDevice, capsule: Capsule): Promise<GPUShaderModule[]> {
  const known = new Map<number, GPUShaderModule>();
  const modules: GPUShaderModule[] = [];
  for (const { name, wgsl } of capsule.header.modules) {
    let module = known.get(wgsl.at);
    if (!module) {
      module = device.createShaderModule({ code: capsule.text(wgsl), label: name });
      known.set(wgsl.at, module);
      const { messages } = await module.getCompilationInfo();
      const error = messages.find((message) => message.type === 'error');
      if (error) throw new CapsuleError(`${capsule.header.name}: ${name}:${error.lineNum}: ${error.message}`);
    }
    modules.push(module);
  }
  return modules;
}

/** Plays it. Throws what the device says, where it refuses something. */
export async function play(device: GPUDevice, capsule: Capsule): Promise<Played> {
  const { header } = capsule;
  const began = performance.now();
  device.pushErrorScope('validation');
  const modules = await modulesOf(device, capsule);
  const layouts = header.layouts.map((kinds) =>
    device.createBindGroupLayout({
      entries: kinds.map((type, binding) => ({ binding, visibility: COMPUTE, buffer: { type } })),
    }),
  );
  const pipelines = header.pipelines.map(({ module, entry, layouts: own }) =>
    device.createComputePipeline({
      label: entry,
      layout: device.createPipelineLayout({ bindGroupLayouts: own.map((layout) => layouts[layout]!) }),
      compute: { module: modules[module]!, entryPoint: entry },
    }),
  );
  const usage = usages(header);
  const buffers = header.buffers.map(({ name, size, fill, data }, place) => {
    const buffer = device.createBuffer({ label: name, size: Math.max(size, 16), usage: usage[place]!, mappedAtCreation: true });
    const bytes = new Uint8Array(buffer.getMappedRange());
    bytes.fill(fill);
    if (data) bytes.set(capsule.bytes(data));
    buffer.unmap();
    return buffer;
  });
  const groups = header.groups.map(({ layout, buffers: bound }) =>
    device.createBindGroup({
      layout: layouts[layout]!,
      entries: bound.map((buffer, binding) => ({ binding, resource: { buffer: buffers[buffer]! } })),
    }),
  );
  const refused = await device.popErrorScope();
  if (refused) throw new CapsuleError(`${header.name}: ${refused.message}`);
  const compiled = performance.now();

  const found: Found[] = [];
  device.pushErrorScope('validation');
  for (const command of header.commands) {
    switch (command.do) {
      case 'write':
        device.queue.writeBuffer(buffers[command.buffer]!, command.offset, capsule.bytes(command.data));
        break;
      case 'clear': {
        const encoder = device.createCommandEncoder();
        encoder.clearBuffer(buffers[command.buffer]!, command.offset, command.size);
        device.queue.submit([encoder.finish()]);
        break;
      }
      case 'pass': {
        const encoder = device.createCommandEncoder();
        const pass = encoder.beginComputePass();
        for (const step of command.steps) {
          pass.setPipeline(pipelines[step.pipeline]!);
          step.groups.forEach((group, number) => pass.setBindGroup(number, groups[group]!));
          if (step.indirect) {
            pass.dispatchWorkgroupsIndirect(buffers[step.indirect.buffer]!, step.indirect.offset);
          } else if (step.dispatch) {
            pass.dispatchWorkgroups(...step.dispatch);
          }
        }
        pass.end();
        device.queue.submit([encoder.finish()]);
        break;
      }
      case 'check': {
        const size = command.count * command.stride;
        const words = await readBack(device, buffers[command.buffer]!, command.offset, size);
        found.push(...compare(command, words, capsule.words(command.expected)));
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
  for (const buffer of buffers) buffer.destroy();
  if (wrong) throw new CapsuleError(`${header.name}: ${wrong.message}`);
  return { name: header.name, found, compiled: compiled - began, ran: performance.now() - compiled };
}
