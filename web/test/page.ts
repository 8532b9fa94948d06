// The page as a person has it: what is drawn, what moves, what is said when something is missing.

import { existsSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';
import type { Browser, Page } from 'playwright-core';
import { ROOT } from './browser.js';

export type Say = (right: boolean, what: string) => void;

const GOLDEN = join(ROOT, 'test/golden');
/** Software adapters that are busy compile for a while. */
const PATIENCE = 90_000;

/** What scripts see of devices: asked for with what, and the last one. */
const WATCH = `
  window.asked = [];
  if (window.GPUAdapter) {
    const request = GPUAdapter.prototype.requestDevice;
    GPUAdapter.prototype.requestDevice = async function (wanted) {
      window.asked.push(wanted ?? {});
      return (window.lastDevice = await request.call(this, wanted));
    };
  }
`;

interface Opened {
  page: Page;
  /** What the console and the page's own faults said. */
  said: string[];
}

/** What was opened last, for who asks what became of it. */
let last: Opened | undefined;

async function opened(browser: Browser, address: string, script = ''): Promise<Opened> {
  const page = await browser.newPage({ viewport: { width: 640, height: 560 }, colorScheme: 'light', deviceScaleFactor: 1 });
  const said: string[] = [];
  page.on('console', (message) => said.push(`${message.type()}: ${message.text()}`));
  page.on('pageerror', (error) => said.push(`fault: ${error.message}`));
  await page.addInitScript(WATCH + script);
  last = { page, said };
  await page.goto(`${address}index.html`);
  // Text has other shapes on machines with other fonts.
  await page.addStyleTag({ content: '.hint, .busy { display: none !important }' });
  return last;
}

const state = (page: Page, name: string): Promise<unknown> =>
  page.waitForFunction((wanted) => document.body.dataset['state'] === wanted, name, { timeout: PATIENCE });

const count = async (page: Page, name: string): Promise<number> =>
  Number((await page.locator(`[data-count="${name}"]`).innerText()).replace(/\D/g, ''));

/** Mean difference of two pictures, in 1/255 of a channel; decoded by the browser. */
async function difference(page: Page, a: Buffer, b: Buffer): Promise<number> {
  return page.evaluate(
    async (sources) => {
      const [one, two] = await Promise.all(
        sources.map(async (source) => {
          const image = new Image();
          image.src = source;
          await image.decode();
          const context = new OffscreenCanvas(image.width, image.height).getContext('2d')!;
          context.drawImage(image, 0, 0);
          return context.getImageData(0, 0, image.width, image.height).data;
        }),
      );
      if (one!.length !== two!.length) return Infinity;
      let sum = 0;
      for (let k = 0; k < one!.length; k += 1) sum += Math.abs(one![k]! - two![k]!);
      return sum / one!.length;
    },
    [a, b].map((png) => `data:image/png;base64,${png.toString('base64')}`),
  );
}

/** The level of all edges, by the slider's own event. */
async function level(page: Page, value: number): Promise<void> {
  await page.locator('input[name="level"]').evaluate((input, to) => {
    (input as HTMLInputElement).value = String(to);
    input.dispatchEvent(new Event('input', { bubbles: true }));
  }, value);
}

async function drawsAndMoves(browser: Browser, address: string, say: Say, keep: boolean): Promise<void> {
  const { page, said } = await opened(browser, address);
  await state(page, 'drawn');
  const asked = await page.evaluate('JSON.stringify(window.asked)');
  say(asked === '[{}]', `the device is asked for without features and limits: ${String(asked)}`);

  await level(page, 8);
  // A triangle of level 8 has rings of 3 (14 + 10 + 6 + 2) = 96 triangles; a closed surface of t has t / 2 + 2 vertices.
  await page.waitForFunction(() => document.querySelector('[data-count="triangles"]')?.textContent === '12,288', undefined, { timeout: PATIENCE });
  say((await count(page, 'vertices')) === 6146, `level 8: ${await count(page, 'vertices')} vertices of 12288 triangles`);
  const canvas = page.locator('canvas');
  const picture = await canvas.screenshot();
  const file = join(GOLDEN, 'sphere.png');
  if (keep) writeFileSync(file, picture);
  const off = existsSync(file) ? await difference(page, picture, readFileSync(file)) : Infinity;
  // One step in 255 on average: another version of the software adapter may round otherwise.
  say(off < 1, `the picture is the golden one: ${off.toFixed(3)} of 255 away on average`);

  await canvas.focus();
  for (let k = 0; k < 6; k += 1) await page.keyboard.press('ArrowRight');
  await page.waitForTimeout(1500);
  const turned = await difference(page, picture, await canvas.screenshot());
  say(turned > 2, `keys turn it: ${turned.toFixed(1)} of 255`);
  const box = (await canvas.boundingBox())!;
  const before = await canvas.screenshot();
  await page.mouse.move(box.x + 200, box.y + 150);
  await page.mouse.down();
  await page.mouse.move(box.x + 300, box.y + 170, { steps: 3 });
  await page.mouse.up();
  await page.waitForTimeout(1500);
  const dragged = await difference(page, before, await canvas.screenshot());
  say(dragged > 2, `the mouse turns it: ${dragged.toFixed(1)} of 255`);

  const editor = page.locator('textarea');
  const text = await editor.inputValue();
  const lines = text.split('\n');
  const wrong = lines.findIndex((line) => line.includes('let height = relief'));
  await editor.fill(lines.map((line, k) => (k === wrong ? line.replace('given.z', 'given.nothing') : line)).join('\n'));
  await state(page, 'faulty');
  const marked = await page.locator('.gutter b').allInnerTexts();
  const fault = (await page.locator('.faults button').first().innerText()).slice(0, 90);
  say(marked.join() === String(wrong + 1), `a fault in line ${wrong + 1} is marked in ${marked.join()}: ${fault}`);
  await editor.fill(text.replace('* (1.0 + 1.5', '* (1.1 + 1.5').replace('1.0 + given.y * height.w', '1.0 + 0.2 * given.y * height.w'));
  await state(page, 'drawn');
  say((await page.locator('.gutter b').count()) === 0, 'functions that compile are drawn');

  await page.addStyleTag({ content: '.no-room { height: 0 !important; min-height: 0 !important; border: 0 !important }' });
  const stage = page.locator('.stage');
  await stage.evaluate((element) => element.classList.add('no-room'));
  await state(page, 'no-room');
  say((await page.locator('.message h2').innerText()).includes('no room'), 'a canvas of 0 × 0: a message');
  await stage.evaluate((element) => element.classList.remove('no-room'));
  await state(page, 'drawn');
  say(await page.locator('.message').isHidden(), 'with room again it is drawn');

  await page.evaluate('window.lastDevice.destroy()');
  await state(page, 'lost');
  await page.locator('.message button').click();
  await state(page, 'drawn');
  say(await page.locator('.message').isHidden(), 'a lost device: a message, and a new one at a press');

  say(said.length === 0, `${said.length} messages in the console ${said.join(' | ')}`);
  await page.close();
}

async function everyScene(browser: Browser, address: string, say: Say, pictures: string | undefined): Promise<void> {
  const { page, said } = await opened(browser, address);
  for (const name of ['sphere', 'teapot', 'lamps', 'stars', 'mountain']) {
    await page.locator(`.scenes label:has(input[value="${name}"])`).click();
    await page.waitForFunction((text) => document.querySelector('[role="tab"]')?.textContent !== text, '', { timeout: 1000 });
    await page.waitForTimeout(50);
    await state(page, 'drawn');
    const triangles = await count(page, 'triangles');
    say(triangles > 300, `${name}: ${triangles} triangles`);
    if (pictures) await page.locator('canvas').screenshot({ path: join(pictures, `${name}.png`) });
  }
  say(said.length === 0, `${said.length} messages in the console ${said.join(' | ')}`);
  await page.close();
}

async function saysWhatIsMissing(browser: Browser, address: string, say: Say): Promise<void> {
  for (const [what, script, title] of [
    ['no WebGPU', "Object.defineProperty(Navigator.prototype, 'gpu', { get: () => undefined });", 'no WebGPU'],
    ['no adapter', 'GPU.prototype.requestAdapter = async () => null;', 'no GPU'],
  ] as const) {
    const { page, said } = await opened(browser, address, script);
    await state(page, 'failed');
    const text = await page.locator('.message').innerText();
    say(text.includes(title) && text.includes('Chrome'), `${what}: ${text.replace(/\s+/g, ' ').slice(0, 100)}`);
    say(said.length === 0, `${said.length} messages in the console ${said.join(' | ')}`);
    await page.close();
  }
}

/** Bytes of the built page and all that it loads, compressed. */
function weight(): number {
  const dist = join(ROOT, 'dist');
  const files = readdirSync(dist, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
  return files.reduce((sum, entry) => sum + gzipSync(readFileSync(join(entry.parentPath, entry.name))).length, 0);
}

export async function page(browser: Browser, address: string, say: Say, keep: boolean, pictures?: string): Promise<void> {
  const bytes = weight();
  say(bytes <= 500_000, `the pages have ${(bytes / 1000).toFixed(0)} kB, compressed`);
  const parts: (() => Promise<void>)[] = [
    () => saysWhatIsMissing(browser, address, say),
    () => drawsAndMoves(browser, address, say, keep),
    () => everyScene(browser, address, say, pictures),
  ];
  for (const part of parts) {
    try {
      await part();
    } catch (error) {
      const shown = await last?.page.evaluate(() => `${document.body.dataset['state']}: ${document.querySelector('.message')?.textContent?.trim()}`);
      say(false, `${String(error).split('\n')[0]}; the page is ${shown}; its console: ${last?.said.join(' | ')}`);
      await last?.page.close();
    }
  }
}
