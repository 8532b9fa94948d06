// Reads the file of a capsule; web/CAPSULE.md documents it.

import type { Header, Span } from './format.js';

/** A file that is no capsule: the message says what is wrong with it. */
export class CapsuleError extends Error {
  override name = 'CapsuleError';
}

export class Capsule {
  private constructor(
    readonly header: Header,
    private readonly data: Uint8Array,
  ) {}

  static read(bytes: Uint8Array): Capsule {
    const text = new TextDecoder();
    if (bytes.length < 16 || text.decode(bytes.subarray(0, 8)) !== 'dolocap1') {
      throw new CapsuleError('this is no capsule: it does not begin with dolocap1');
    }
    const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(8, true);
    if (bytes.length < 16 + length) throw new CapsuleError('the file ends within its header');
    let header: Header;
    try {
      header = JSON.parse(text.decode(bytes.subarray(16, 16 + length))) as Header;
    } catch (error) {
      throw new CapsuleError(`its header is no JSON: ${String(error)}`);
    }
    const capsule = new Capsule(header, bytes.subarray(16 + length));
    capsule.verify();
    return capsule;
  }

  /** The bytes of a span; a copy, aligned. */
  bytes({ at, length }: Span): Uint8Array<ArrayBuffer> {
    // Not `slice`: that of Node's buffers does not copy.
    return new Uint8Array(this.data.subarray(at, at + length));
  }

  words(span: Span): Uint32Array<ArrayBuffer> {
    return new Uint32Array(this.bytes(span).buffer);
  }

  text(span: Span): string {
    return new TextDecoder().decode(this.bytes(span));
  }

  /** Every number that names something names something that is there. */
  private verify(): void {
    const { header } = this;
    const fail = (reason: string): never => {
      throw new CapsuleError(`${header.name}: ${reason}`);
    };
    const span = ({ at, length }: Span): void => {
      if (at < 0 || length < 0 || at + length > this.data.length) fail(`data ${at} + ${length} are not in the file`);
    };
    const place = (number: number, list: readonly unknown[], what: string): void => {
      if (!(number >= 0 && number < list.length)) fail(`there is no ${what} ${number}`);
    };
    if (header.features.length > 0) fail(`it asks for ${header.features.join(', ')}`);
    for (const module of header.modules) span(module.wgsl);
    for (const pipeline of header.pipelines) {
      place(pipeline.module, header.modules, 'module');
      for (const layout of pipeline.layouts) place(layout, header.layouts, 'layout');
    }
    for (const buffer of header.buffers) if (buffer.data) span(buffer.data);
    for (const texture of header.textures ?? []) span(texture.data);
    for (const group of header.groups) {
      place(group.layout, header.layouts, 'layout');
      group.buffers.forEach((bound, binding) => {
        if (header.layouts[group.layout]![binding] === 'depth-texture') place(bound, header.textures ?? [], 'texture');
        else place(bound, header.buffers, 'buffer');
      });
    }
    for (const command of header.commands) {
      switch (command.do) {
        case 'pass':
          for (const step of command.steps) {
            place(step.pipeline, header.pipelines, 'pipeline');
            for (const group of step.groups) place(group, header.groups, 'group');
            if (step.indirect) place(step.indirect.buffer, header.buffers, 'buffer');
          }
          break;
        case 'write':
          place(command.buffer, header.buffers, 'buffer');
          span(command.data);
          break;
        case 'triangles':
          place(command.vertices, header.buffers, 'buffer');
          place(command.indices, header.buffers, 'buffer');
          span(command.expected);
          break;
        case 'check':
        case 'lists':
        case 'digest':
          place(command.buffer, header.buffers, 'buffer');
          span(command.expected);
          break;
        case 'clear':
          place(command.buffer, header.buffers, 'buffer');
          break;
        default:
          fail(`an unknown command: ${JSON.stringify(command)}`);
      }
    }
  }
}
