// Makes what a capsule needs on a device, and submits its passes.

import type { BindingKind, Command, Header } from './format.js';
import { type Capsule, CapsuleError } from './read.js';

const COMPUTE = 4; // GPUShaderStage.COMPUTE

function usages(header: Header): number[] {
  const usage = header.buffers.map(() => GPUBufferUsage.COPY_SRC | GPUBufferUsage.COPY_DST);
  const of: Record<BindingKind, number> = {
    uniform: GPUBufferUsage.UNIFORM,
    'read-only-storage': GPUBufferUsage.STORAGE,
    storage: GPUBufferUsage.STORAGE,
    'depth-texture': 0,
  };
  for (const { layout, buffers } of header.groups) {
    buffers.forEach((buffer, binding) => {
      const kind = header.layouts[layout]![binding]!;
      if (kind !== 'depth-texture') usage[buffer]! |= of[kind];
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

/** A command that compares nothing. */
export type Plain = Exclude<Command, { expected: unknown }>;

export const isPlain = (command: Command): command is Plain => !('expected' in command);

/** A capsule on a device. */
export interface Loaded {
  capsule: Capsule;
  buffers: GPUBuffer[];
  /** Carries commands out that compare nothing: as one submission, all that is written before it. */
  submit: (commands: readonly Plain[]) => void;
  destroy: () => void;
}

/** Makes all of it. Throws what the device says, where it refuses something. */
export async function load(device: GPUDevice, capsule: Capsule): Promise<Loaded> {
  const { header } = capsule;
  device.pushErrorScope('validation');
  const modules = await modulesOf(device, capsule);
  const layouts = header.layouts.map((kinds) =>
    device.createBindGroupLayout({
      entries: kinds.map((type, binding) =>
        type === 'depth-texture'
          ? { binding, visibility: COMPUTE, texture: { sampleType: 'depth' } }
          : { binding, visibility: COMPUTE, buffer: { type } },
      ),
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
  const textures = (header.textures ?? []).map(({ name, width, height, data }) => {
    const usage = GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST;
    const texture = device.createTexture({ label: name, size: [width, height], format: 'depth16unorm', usage });
    device.queue.writeTexture({ texture }, capsule.bytes(data), { bytesPerRow: 2 * width }, [width, height]);
    return texture;
  });
  const groups = header.groups.map(({ layout, buffers: bound }) =>
    device.createBindGroup({
      layout: layouts[layout]!,
      entries: bound.map((place, binding) => ({
        binding,
        resource: header.layouts[layout]![binding] === 'depth-texture' ? textures[place]!.createView() : { buffer: buffers[place]! },
      })),
    }),
  );
  const refused = await device.popErrorScope();
  if (refused) throw new CapsuleError(`${header.name}: ${refused.message}`);
  const submit: Loaded['submit'] = (commands) => {
    const encoder = device.createCommandEncoder();
    for (const command of commands) {
      if (command.do === 'write') {
        // Before all that is submitted after it.
        device.queue.writeBuffer(buffers[command.buffer]!, command.offset, capsule.bytes(command.data));
      } else if (command.do === 'clear') {
        encoder.clearBuffer(buffers[command.buffer]!, command.offset, command.size);
      } else {
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
      }
    }
    device.queue.submit([encoder.finish()]);
  };
  const destroy = (): void => {
    for (const buffer of buffers) buffer.destroy();
    for (const texture of textures) texture.destroy();
  };
  return { capsule, buffers, submit, destroy };
}
