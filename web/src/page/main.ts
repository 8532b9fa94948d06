// The page: what a person chooses, what is drawn of it, what is said about it.

import { FILES as LIBRARY } from '../stage/files.js';
import { ShaderError } from '../stage/host.js';
import { SCENES, type Scene } from '../scenes/scenes.js';
import { Camera } from './camera.js';
import { Controls, one } from './controls.js';
import { NoDevice, open } from './device.js';
import drawSource from './draw.wgsl?raw';
import { Editor } from './editor.js';
import { Engine } from './engine.js';
import { MOST_ROUNDS } from './guard.js';
import { steer } from './input.js';
import levelSource from './level.wgsl?raw';
import { isNight, lookOf } from './look.js';
import { Message } from './message.js';

const FILES = new Map([...LIBRARY, ['page/draw.wgsl', drawSource], ['page/level.wgsl', levelSource]]);

const ENDLESS = `a loop went round more than ${MOST_ROUNDS.toLocaleString('en')} times in one thread and was ended; look at its bound`;

/** Milliseconds of rest after which the passes are timed. */
const REST = 400;

const canvas = one<HTMLCanvasElement>('canvas');
const message = new Message(one('.message'), () => void start());
const controls = new Controls();
const camera = new Camera(SCENES[0]!);
const editor = new Editor(one('.editor'), () => void typed());

let engine: Engine | undefined;
let scene: Scene = SCENES[0]!;
/** The texts of each scene's files: what is written, and what compiled last. */
const written = new Map<Scene, string[]>();
const drawn = new Map<Scene, string[]>();
let file = 0;
/** What is asked for, and what of it is compiled. */
let asked = 0;
let compiled = 0;
let dirty = false;
let resting: ReturnType<typeof setTimeout> | undefined;

const textsOf = (map: Map<Scene, string[]>): string[] => {
  let texts = map.get(scene);
  if (!texts) map.set(scene, (texts = scene.kinds.map((kind) => kind.source)));
  return texts;
};

function state(name: string): void {
  document.body.dataset['state'] = name;
}

/** Opens a device and shows the scene; after a lost device as well. */
async function start(): Promise<void> {
  message.hide();
  state('starting');
  engine = undefined;
  try {
    const { device, name } = await open();
    one('.device').textContent = name;
    const context = canvas.getContext('webgpu');
    if (!context) throw new NoDevice('This canvas gives no WebGPU context', 'Close other pages that draw, and load this one again.');
    const mine = new Engine(device, context, navigator.gpu.getPreferredCanvasFormat(), FILES);
    device.addEventListener('uncapturederror', (event) => {
      message.show('The GPU refuses what was asked of it', event.error.message, true);
      state('refused');
    });
    void device.lost.then((info) => {
      if (engine !== mine) return;
      engine = undefined;
      // What was drawn last may be what it was lost over.
      drawn.clear();
      message.show(
        'The GPU is gone',
        `${info.message || 'The browser has taken the device away.'}\nWhere functions were changed, they may have run for too long; the scene starts again with its own.`,
        true,
      );
      state('lost');
    });
    engine = mine;
    await show();
  } catch (error) {
    const title = error instanceof NoDevice ? error.title : 'This page cannot start';
    message.show(title, error instanceof Error ? error.message : String(error), !(error instanceof NoDevice));
    state('failed');
  }
}

/** Compiles what is asked for, and draws it once it is there. */
async function show(): Promise<void> {
  const mine = engine;
  if (!mine) return;
  asked += 1;
  const number = asked;
  const busy = setTimeout(() => (one('.busy').hidden = false), 150);
  state('compiling');
  try {
    const texts = [...textsOf(drawn)];
    await mine.show(scene, texts, controls.settings);
    if (number !== asked || mine !== engine) return;
    compiled = number;
    redraw();
  } catch (error) {
    if (number !== asked || mine !== engine) return;
    if (error instanceof ShaderError) editor.mark(error.faults);
    else message.show('The passes cannot be made', error instanceof Error ? error.message : String(error), true);
    state('faulty');
  } finally {
    clearTimeout(busy);
    if (number === asked) one('.busy').hidden = true;
  }
}

/** Something was typed: it is drawn if it compiles, else its faults are marked. */
async function typed(): Promise<void> {
  const text = editor.text;
  textsOf(written)[file] = text;
  const kind = scene.kinds[file]!;
  const fault = await engine?.check(kind, text, controls.settings);
  if (editor.text !== text || !engine) return;
  const own = fault?.faults.map((one) => {
    if (one.file === kind.file) return one;
    const missing = /^web::functions has no (\w+)$/.exec(one.message)?.[1];
    return { ...one, line: 1, message: missing ? `the stage calls a function named ${missing}, and there is none` : `${one.file}: ${one.message}` };
  });
  editor.mark(own ?? []);
  if (fault) {
    state('faulty');
    return;
  }
  textsOf(drawn)[file] = text;
  await show();
}

function redraw(): void {
  if (dirty) return;
  dirty = true;
  requestAnimationFrame(() => {
    dirty = false;
    frame();
  });
}

function frame(): void {
  if (!engine) return;
  if (canvas.width === 0 || canvas.height === 0) {
    message.show('There is no room to draw in', 'Make the window larger.', false);
    state('no-room');
    return;
  }
  if (document.body.dataset['state'] === 'no-room') message.hide();
  one('.stage').classList.toggle('night', isNight(scene));
  if (!engine.frame(camera, controls.settings, lookOf(scene))) return;
  const [mine, number] = [engine, compiled];
  const counted = mine.counted();
  void counted.then((counted) => {
    if (mine !== engine) return;
    controls.count(counted);
    // Not while something else compiles that was asked for after it.
    if (number !== asked || mine.shown !== scene) return;
    document.body.dataset['shown'] = scene.name;
    // What is written does not compile: its marks stay.
    if (document.body.dataset['state'] === 'faulty') return;
    const { endless } = counted;
    const where = endless && endless.kind !== scene.kinds[file] ? `${endless.kind.file}: ` : '';
    editor.mark(endless ? [{ file: endless.kind.file, line: endless.line, column: 1, message: where + ENDLESS }] : []);
    state(endless ? 'endless' : 'drawn');
  }, () => undefined);
  clearTimeout(resting);
  resting = setTimeout(() => {
    void mine.measure().then(
      (times) => {
        if (mine === engine) controls.time(times);
      },
      // A device that is lost is told of by its own promise.
      () => undefined,
    );
  }, REST);
}

function choose(next: Scene): void {
  scene = next;
  file = 0;
  camera.show(scene);
  controls.describe(scene);
  files();
  void show();
}

/** Tabs of the scene's files. */
function files(): void {
  one('.files').replaceChildren(
    ...scene.kinds.map((kind, k) => {
      const tab = document.createElement('button');
      tab.type = 'button';
      tab.role = 'tab';
      tab.textContent = kind.file;
      tab.ariaSelected = String(k === file);
      tab.addEventListener('click', () => {
        file = k;
        files();
      });
      return tab;
    }),
  );
  editor.text = textsOf(written)[file]!;
}

controls.scenes(SCENES, choose);
controls.changed((compile) => {
  if (compile) void show();
  else redraw();
});
one('.reset').addEventListener('click', () => {
  written.delete(scene);
  drawn.delete(scene);
  files();
  void show();
});
steer(canvas, camera, redraw);
new ResizeObserver(() => {
  const scale = Math.min(devicePixelRatio, 2);
  canvas.width = Math.round(canvas.clientWidth * scale);
  canvas.height = Math.round(canvas.clientHeight * scale);
  redraw();
}).observe(canvas);
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
controls.describe(scene);
files();
void start();
