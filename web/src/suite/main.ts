// The page that plays capsules: a table of what was found.

import { times } from '../capsule/play.js';
import { Capsule } from '../capsule/read.js';
import { NoDevice, open } from '../page/device.js';
import { type Result, result } from './suite.js';

const body = document.querySelector('tbody')!;
const said = document.querySelector<HTMLElement>('.device')!;

let opened: ReturnType<typeof open> | undefined;

function cell(text: string, wrong = false): HTMLElement {
  const made = document.createElement('td');
  made.textContent = text;
  if (wrong) made.className = 'wrong';
  return made;
}

function row(result: Result): HTMLElement {
  const made = document.createElement('tr');
  const off = result.found.filter((one) => one.different > 0);
  const differs = off.map((one) => {
    const text = `${one.check}, ${one.field}: ${one.different} of ${one.count}, by at most ${Number(one.largest.toPrecision(3))} ${one.unit} of ${one.allowed}`;
    return one.wrong > 0 ? `${text}; wrong: ${one.first}` : text;
  });
  made.append(
    cell(result.name, !result.right),
    cell(String(result.found.reduce((sum, one) => sum + one.count, 0))),
    cell(result.fault ?? (differs.join('; ') || 'nothing'), !result.right),
    cell(`${result.milliseconds.toFixed(0)} ms`),
  );
  return made;
}

/** Plays one file, and shows what was found. */
async function play(bytes: Uint8Array): Promise<Result> {
  opened ??= open();
  const { device, name } = await opened;
  said.textContent = `Device: ${name}`;
  const found = await result(device, bytes);
  body.append(row(found));
  return found;
}

document.querySelector('input')!.addEventListener('change', async (event) => {
  const input = event.target as HTMLInputElement;
  body.replaceChildren();
  try {
    for (const file of input.files ?? []) await play(new Uint8Array(await file.arrayBuffer()));
  } catch (error) {
    said.textContent = error instanceof NoDevice ? `${error.title}. ${error.message}` : String(error);
  }
});

declare global {
  interface Window {
    /** For tests: plays the capsule at an address. */
    playCapsule: (address: string) => Promise<Result>;
    /** For measurements: milliseconds of a capsule's passes, so many times. */
    timeCapsule: (address: string, repeats: number) => Promise<number[]>;
  }
}
const bytesAt = async (address: string): Promise<Uint8Array> => new Uint8Array(await (await fetch(address)).arrayBuffer());
window.playCapsule = async (address) => play(await bytesAt(address));
window.timeCapsule = async (address, repeats) => {
  opened ??= open();
  return times((await opened).device, Capsule.read(await bytesAt(address)), repeats);
};
