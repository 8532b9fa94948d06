// How long a capsule's passes take in Chromium: `node dist-tools/time.js FOLDER NAME [ROUNDS]`, FOLDER with NAME.capsule.
// Beside it: `dolomite_lab capsule NAME --time ROUNDS`, the same by wgpu on this machine's Vulkan adapter. And how long
// the page's first scene takes with some hundred thousand triangles, as it says itself: pass by pass, each waited for.
//
// From the submission of a round until all of it is done, by the page's clock; the device is asked for no timestamps.

import { join } from 'node:path';
import { ROUND } from '../src/capsule/play.js';
import { endAfter, launch, PATIENCE, ROOT, serve } from './browser.js';
import { count, level, opened, state } from './opened.js';

const [folder, name, repeats = '30'] = process.argv.slice(2);
if (!folder || !name) {
  console.log('node dist-tools/time.js FOLDER NAME [ROUNDS]');
  process.exit(2);
}
endAfter(1200);
const { address, server } = await serve([join(ROOT, 'dist'), folder]);
const browser = await launch();
const page = await browser.newPage();
await page.goto(`${address}play.html`, { timeout: PATIENCE });
const times = await page.evaluate(([file, count]) => window.timeCapsule(file!, Number(count)), [`${name}.capsule`, repeats]);
times.sort((a, b) => a - b);
const shown = (at: number): string => `${times[at]!.toFixed(2)} ms`;
console.log(
  `${name} in Chromium ${browser.version()}: ${times.length} rounds of ${ROUND} runs; a run: shortest ${shown(0)}, median ${shown(times.length >> 1)}, longest ${shown(times.length - 1)}`,
);
await page.close();

const scene = await opened(browser, address);
await state(scene.page, 'drawn');
await level(scene.page, 23);
await scene.page.waitForFunction(() => Number(document.querySelector('[data-count="triangles"]')?.textContent?.replace(/\D/g, '')) > 90_000);
const said: number[] = [];
for (let k = 0; k < 5; k += 1) {
  await scene.page.locator('[data-count="time"]').evaluate((element) => (element.textContent = ''));
  await scene.page.locator('canvas').press('ArrowRight');
  await scene.page.waitForFunction(() => document.querySelector('[data-count="time"]')?.textContent?.endsWith('ms'));
  said.push(parseFloat(await scene.page.locator('[data-count="time"]').innerText()));
}
said.sort((a, b) => a - b);
console.log(`the page: ${await count(scene.page, 'triangles')} triangles, seven passes one by one: shortest ${said[0]} ms, median ${said[2]} ms, longest ${said[4]} ms`);
await browser.close();
server.close();
process.exit(0);
