// A page that is tried: opened, waited for, looked at. Waits are for what is seen, never for a time.

import type { Browser, BrowserContextOptions, Page } from 'playwright-core';
import { PATIENCE } from './browser.js';

export type Say = (right: boolean, what: string) => void;

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

export interface Opened {
  page: Page;
  /** What the console and the page's own faults said. */
  said: string[];
}

/** What was opened last, for who asks what became of it. */
export let last: Opened | undefined;

const DESK: BrowserContextOptions = { viewport: { width: 640, height: 560 }, colorScheme: 'light', deviceScaleFactor: 1 };

/** `script` runs before the page's own. */
export async function opened(browser: Browser, address: string, script = '', options = DESK): Promise<Opened> {
  const page = await browser.newPage(options);
  page.setDefaultTimeout(PATIENCE);
  const said: string[] = [];
  page.on('console', (message) => said.push(`${message.type()}: ${message.text()}`));
  page.on('pageerror', (error) => said.push(`fault: ${error.message}`));
  await page.addInitScript(WATCH + script);
  last = { page, said };
  await page.goto(`${address}index.html`);
  return last;
}

/** Takes what is written over the picture away: text has other shapes on machines with other fonts. */
export async function bare(page: Page): Promise<void> {
  await page.addStyleTag({ content: '.hint, .busy { display: none !important }' });
}

export const state = (page: Page, name: string): Promise<unknown> =>
  page.waitForFunction((wanted) => document.body.dataset['state'] === wanted, name);

/** Until a scene is what is drawn. */
export const shown = (page: Page, name: string): Promise<unknown> =>
  page.waitForFunction(
    (wanted) => document.body.dataset['shown'] === wanted && document.body.dataset['state'] === 'drawn',
    name,
  );

export const count = async (page: Page, name: string): Promise<number> =>
  Number((await page.locator(`[data-count="${name}"]`).innerText()).replace(/\D/g, ''));

/** Mean difference of two pictures, in 1/255 of a channel; decoded by the browser. */
export async function difference(page: Page, a: Buffer, b: Buffer): Promise<number> {
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

/** How far the canvas comes to be from a picture of it, once that is more than `least`; 0 where it never is. */
export async function moved(page: Page, from: Buffer, least: number): Promise<number> {
  const end = Date.now() + PATIENCE;
  while (Date.now() < end) {
    const off = await difference(page, from, await page.locator('canvas').screenshot());
    if (off > least) return off;
  }
  return 0;
}

/** The level of all edges, by the slider's own event. */
export async function level(page: Page, value: number): Promise<void> {
  await page.locator('input[name="level"]').evaluate((input, to) => {
    (input as HTMLInputElement).value = String(to);
    input.dispatchEvent(new Event('input', { bubbles: true }));
  }, value);
}

/** Until so many triangles are counted. */
export const triangles = (page: Page, text: string): Promise<unknown> =>
  page.waitForFunction((wanted) => document.querySelector('[data-count="triangles"]')?.textContent === wanted, text);

/** Ends with a line on the console, which has to be silent, and closes the page. */
export async function closed({ page, said }: Opened, say: Say, what: string): Promise<void> {
  say(said.length === 0, `${what}: ${said.length} messages in the console ${said.join(' | ')}`);
  await page.close();
}
