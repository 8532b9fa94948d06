// The page by keys alone, and by fingers on a small screen.

import { join } from 'node:path';
import type { Browser, CDPSession } from 'playwright-core';
import { bare, closed, count, moved, opened, type Say, shown, state } from './opened.js';

/** What keys have to reach: a selector of each. */
const REACHED = [
  'canvas', '.scenes input', '[name="level"]', '[name="edge"]', '[name="spacing"]', '[name="mode"]', '[name="fill"]', '[name="lines"]',
  '.passes summary', '.files button', '.reset', 'textarea', 'footer a',
];

export async function keyboard(browser: Browser, address: string, say: Say): Promise<void> {
  const it = await opened(browser, address);
  const { page } = it;
  await bare(page);
  await state(page, 'drawn');
  const left = new Set(REACHED);
  let hidden = '';
  // Escape leaves the text, in which Tab indents.
  for (let k = 0; k < 40 && left.size > 0; k += 1) {
    await page.keyboard.press('Tab');
    const [found, seen] = await page.evaluate((selectors) => {
      const element = document.activeElement;
      const match = selectors.find((selector) => element?.matches(selector));
      // A mark around it, or around the label that stands for it.
      const ring = [element, element?.closest('label')?.querySelector('span')].some((one) => one && getComputedStyle(one).outlineStyle !== 'none');
      return [match, ring] as const;
    }, REACHED);
    if (found) left.delete(found);
    if (found && !seen) hidden += ` ${found}`;
    if (found === 'textarea') await page.keyboard.press('Escape');
  }
  say(left.size === 0, `keys reach ${REACHED.length - left.size} of ${REACHED.length} things ${[...left].join(' ')}`);
  say(hidden === '', `what has the focus is marked${hidden}`);

  const canvas = page.locator('canvas');
  const before = await canvas.screenshot();
  await canvas.focus();
  for (let k = 0; k < 6; k += 1) await page.keyboard.press('ArrowRight');
  const turned = await moved(page, before, 2);
  say(turned > 2, `arrows turn it: ${turned.toFixed(1)} of 255`);
  const far = await count(page, 'triangles');
  for (let k = 0; k < 6; k += 1) await page.keyboard.press('+');
  await page.waitForFunction((least) => Number(document.querySelector('[data-count="triangles"]')?.textContent?.replace(/\D/g, '')) > least, far);
  say(true, `plus comes closer: ${await count(page, 'triangles')} triangles in place of ${far}`);
  await page.locator('.scenes input').first().focus();
  await page.keyboard.press('ArrowRight');
  await shown(page, 'teapot');
  say(true, 'arrows choose the next scene');
  await closed(it, say, 'the keyboard');
}

type Point = { x: number; y: number };

/** Fingers that go from places to others in some steps, all at once. */
async function fingers(session: CDPSession, ways: readonly (readonly [Point, Point])[]): Promise<void> {
  const at = (share: number): object[] => ways.map(([from, to], id) => ({ id, x: from.x + (to.x - from.x) * share, y: from.y + (to.y - from.y) * share }));
  await session.send('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: at(0) as never });
  for (let step = 1; step <= 5; step += 1) {
    await session.send('Input.dispatchTouchEvent', { type: 'touchMove', touchPoints: at(step / 5) as never });
  }
  await session.send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
}

/** Least side of what fingers press, CSS pixels: success criterion 2.5.8 of WCAG 2.2. */
const TARGET = 24;

export async function telephone(browser: Browser, address: string, say: Say, pictures: string | undefined): Promise<void> {
  const it = await opened(browser, address, '', {
    viewport: { width: 390, height: 844 },
    colorScheme: 'light',
    deviceScaleFactor: 1,
    hasTouch: true,
    isMobile: true,
  });
  const { page } = it;
  await state(page, 'drawn');
  if (pictures) await page.screenshot({ path: join(pictures, 'telephone.png'), fullPage: true });
  await bare(page);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  say(wide <= 0, `390 pixels are wide enough: ${wide} beyond`);
  const small = await page.evaluate((least) => {
    // Of what is chosen by its label, the label is what fingers press.
    const targets = [...document.querySelectorAll<HTMLElement>('button, input, summary, textarea, canvas')].map((one) => one.closest('label') ?? one);
    const boxes = targets.map((one) => ({ one, box: one.getBoundingClientRect() })).filter(({ box }) => box.width > 0);
    return boxes.filter(({ box }) => Math.min(box.width, box.height) < least).map(({ one, box }) => `${one.textContent?.trim()} ${box.width.toFixed(0)} × ${box.height.toFixed(0)}`);
  }, TARGET);
  say(small.length === 0, `${small.length} things to press are smaller than ${TARGET} pixels ${small.join(', ')}`);

  const session = await page.context().newCDPSession(page);
  const canvas = page.locator('canvas');
  await canvas.scrollIntoViewIfNeeded();
  const box = (await canvas.boundingBox())!;
  const middle = { x: box.x + box.width / 2, y: box.y + box.height / 2 };
  const off = (x: number, y: number): Point => ({ x: middle.x + x, y: middle.y + y });
  const before = await canvas.screenshot();
  await fingers(session, [[off(-60, 0), off(60, 20)]]);
  const dragged = await moved(page, before, 2);
  say(dragged > 2, `a finger turns it: ${dragged.toFixed(1)} of 255`);
  const far = await count(page, 'triangles');
  await fingers(session, [[off(-20, 0), off(-60, 0)], [off(20, 0), off(60, 0)]]);
  await page.waitForFunction((least) => Number(document.querySelector('[data-count="triangles"]')?.textContent?.replace(/\D/g, '')) > least, far);
  const near = await count(page, 'triangles');
  say(near > far, `two fingers come closer: ${near} triangles in place of ${far}`);
  const stays = await page.evaluate(() => [scrollX, scrollY, visualViewport?.scale].join());
  say(stays.endsWith(',1'), `the page itself is not zoomed: ${stays}`);
  await page.locator('.scenes label').nth(1).tap();
  await shown(page, 'teapot');
  say(true, 'a tap chooses the next scene');
  await closed(it, say, 'a telephone');
}
