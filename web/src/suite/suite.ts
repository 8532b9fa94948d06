// Plays capsules, each by itself and, where it is one of the stage, by the host too.

import type { Found } from '../capsule/compare.js';
import { play } from '../capsule/play.js';
import { Capsule } from '../capsule/read.js';
import { FILES } from '../stage/files.js';
import { canHost, hosted } from './hosted.js';

export interface Result {
  name: string;
  about: string;
  right: boolean;
  /** Why it could not be played, if it could not. */
  fault?: string;
  found: Found[];
  milliseconds: number;
}

export async function result(device: GPUDevice, bytes: Uint8Array): Promise<Result> {
  const began = performance.now();
  let [name, about] = ['?', ''];
  const found: Found[] = [];
  try {
    const capsule = Capsule.read(bytes);
    ({ name, about } = capsule.header);
    found.push(...(await play(device, capsule)).found);
    if (canHost(capsule)) found.push(...(await hosted(device, FILES, capsule)));
  } catch (error) {
    const fault = error instanceof Error ? error.message : String(error);
    return { name, about, right: false, fault, found, milliseconds: performance.now() - began };
  }
  const right = found.length > 0 && found.every((one) => one.wrong === 0);
  return { name, about, right, found, milliseconds: performance.now() - began };
}

/** A line of text for each thing that was found. */
export function lines({ name, right, fault, found, milliseconds }: Result): string[] {
  const sum = found.reduce((all, one) => all + one.count, 0);
  const head = `${right ? 'right' : 'WRONG'}  ${name}: ${sum} numbers in ${milliseconds.toFixed(0)} ms${fault ? `: ${fault}` : ''}`;
  const off = found.filter((one) => one.different > 0).map((one) => {
    const share = `${one.different} of ${one.count} differ, by at most ${Number(one.largest.toPrecision(3))} ${one.unit} of ${one.allowed}`;
    return `         ${one.check}, ${one.field}: ${share}${one.first ? `; ${one.first}` : ''}`;
  });
  return [head, ...off];
}
