// The page as a person has it: what is drawn, what moves, what is said when something is wrong.

import { existsSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';
import type { Browser } from 'playwright-core';
import { ROOT, within } from './browser.js';
import { breaks, cannotStart } from './faults.js';
import { keyboard, telephone } from './hands.js';
import { bare, closed, count, difference, last, level, moved, opened, type Say, shown, state, triangles } from './opened.js';

export type { Say };

export interface Options {
  /** Makes the golden picture anew. */
  keep: boolean;
  /** Leaves out the scenes but the first, and the telephone. */
  short: boolean;
  /** Where pictures are kept. */
  pictures: string | undefined;
}

const GOLDEN = join(ROOT, 'test/golden');

async function drawsAndMoves(browser: Browser, address: string, say: Say, keep: boolean): Promise<void> {
  const it = await opened(browser, address);
  const { page } = it;
  await bare(page);
  await state(page, 'drawn');
  const asked = await page.evaluate('JSON.stringify(window.asked)');
  say(asked === '[{}]', `the device is asked for without features and limits: ${String(asked)}`);

  await level(page, 8);
  // A triangle of level 8 has rings of 3 (14 + 10 + 6 + 2) = 96 triangles; a closed surface of t has t / 2 + 2 vertices.
  await triangles(page, '12,288');
  say((await count(page, 'vertices')) === 6146, `level 8: ${await count(page, 'vertices')} vertices of 12288 triangles`);
  await state(page, 'drawn');
  const canvas = page.locator('canvas');
  const picture = await canvas.screenshot();
  const file = join(GOLDEN, 'sphere.png');
  if (keep) writeFileSync(file, picture);
  const off = existsSync(file) ? await difference(page, picture, readFileSync(file)) : Infinity;
  // One step in 255 on average: another version of the software adapter may round otherwise.
  say(off < 1, `the picture is the golden one: ${off.toFixed(3)} of 255 away on average`);

  const box = (await canvas.boundingBox())!;
  await page.mouse.move(box.x + 200, box.y + 150);
  await page.mouse.down();
  await page.mouse.move(box.x + 300, box.y + 170, { steps: 3 });
  await page.mouse.up();
  const dragged = await moved(page, picture, 2);
  say(dragged > 2, `the mouse turns it: ${dragged.toFixed(1)} of 255`);
  await breaks(page, say);
  await closed(it, say, 'the sphere');
}

async function everyScene(browser: Browser, address: string, say: Say, pictures: string | undefined): Promise<void> {
  const it = await opened(browser, address);
  const { page } = it;
  await bare(page);
  for (const name of ['sphere', 'teapot', 'lamps', 'stars', 'mountain']) {
    await page.locator(`.scenes label:has(input[value="${name}"])`).click();
    await shown(page, name);
    const drawn = await count(page, 'triangles');
    say(drawn > 300, `${name}: ${drawn} triangles`);
    if (pictures) await page.locator('canvas').screenshot({ path: join(pictures, `${name}.png`) });
  }
  await closed(it, say, 'every scene');
}

/** The whole page, by day and by night, as the README shows it. */
async function seen(browser: Browser, address: string, pictures: string): Promise<void> {
  for (const colorScheme of ['light', 'dark'] as const) {
    const viewport = { width: 1280, height: 860 };
    const { page } = await opened(browser, address, '', { viewport, colorScheme, deviceScaleFactor: 1 });
    for (const name of ['sphere', 'mountain']) {
      await page.locator(`.scenes label:has(input[value="${name}"])`).click();
      await shown(page, name);
      // The times of the passes come after a rest.
      await page.waitForFunction(() => document.querySelectorAll('.passes li').length === 7);
      await page.screenshot({ path: join(pictures, `page-${name}-${colorScheme}.png`) });
    }
    await page.close();
  }
}

/** Bytes of the built page and all that it loads, compressed. */
function weight(): number {
  const dist = join(ROOT, 'dist');
  const files = readdirSync(dist, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
  return files.reduce((sum, entry) => sum + gzipSync(readFileSync(join(entry.parentPath, entry.name))).length, 0);
}

export async function page(browser: Browser, address: string, say: Say, { keep, short, pictures }: Options): Promise<void> {
  const bytes = weight();
  say(bytes <= 500_000, `the pages have ${(bytes / 1000).toFixed(0)} kB, compressed`);
  const parts: [string, () => Promise<void>][] = [
    ['a page that cannot start', () => cannotStart(browser, address, say)],
    ['the sphere', () => drawsAndMoves(browser, address, say, keep)],
    ['the keyboard', () => keyboard(browser, address, say)],
  ];
  if (!short) {
    parts.push(['every scene', () => everyScene(browser, address, say, pictures)]);
    parts.push(['a telephone', () => telephone(browser, address, say, pictures)]);
  }
  if (pictures) parts.push(['pictures', () => seen(browser, address, pictures)]);
  for (const [what, part] of parts) {
    try {
      // Each wait has its own end; what evaluates a script has none.
      await within(what, 900_000, part());
    } catch (error) {
      const text = `${what}: ${String(error).split('\n')[0]}`;
      const shown = last?.page.evaluate(() => `${document.body.dataset['state']}: ${document.querySelector('.message')?.textContent?.trim()}`);
      const at = await within('its state', 10_000, shown ?? Promise.resolve('')).catch(String);
      say(false, `${text}; the page is ${at}; its console: ${last?.said.join(' | ')}`);
      void last?.page.close().catch(() => undefined);
    }
  }
}
