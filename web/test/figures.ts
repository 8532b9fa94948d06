// The page of figures in Chromium: `node dist-tools/figures.js PAGE [--pictures FOLDER]`. Exits with 1 if something is wrong.
//
// It is opened as a file, in light and in dark, with every request to elsewhere refused and counted.

import { readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { endAfter, launch } from './browser.js';

const words = process.argv.slice(2);
const at = words.indexOf('--pictures');
const pictures = at < 0 ? undefined : words.splice(at, 2)[1];
const file = resolve(words[0] ?? '../docs/figures/index.html');
const text = readFileSync(file, 'utf8');
let wrong = 0;
const say = (right: boolean, what: string): void => {
  if (!right) wrong += 1;
  console.log(`${right ? 'right' : 'WRONG'}  ${what}`);
};
const times = (part: string): number => text.split(part).length - 1;

endAfter(300);
const browser = await launch(false);
const grounds: number[] = [];
try {
  for (const colorScheme of ['light', 'dark'] as const) {
    const page = await browser.newPage({ viewport: { width: 1100, height: 800 }, colorScheme, deviceScaleFactor: 1 });
    const said: string[] = [];
    page.on('console', (message) => said.push(message.text()));
    page.on('pageerror', (error) => said.push(error.message));
    page.on('requestfailed', (request) => said.push(`not loaded: ${request.url()}`));
    await page.route(/^https?:/, (route) => {
      said.push(`from elsewhere: ${route.request().url()}`);
      return route.abort();
    });
    await page.goto(pathToFileURL(file).href);
    const seen = await page.evaluate(() => {
      const large = (element: Element): boolean => {
        const { width, height } = element.getBoundingClientRect();
        return width > 1 && height > 1;
      };
      const count = (selector: string): number => [...document.querySelectorAll(selector)].filter(large).length;
      const light = (colour: string): number => {
        const parts = colour.match(/[\d.]+/g)?.map(Number) ?? [];
        return ((parts[0] ?? 0) + (parts[1] ?? 0) + (parts[2] ?? 0)) / 765;
      };
      const body = getComputedStyle(document.body);
      const links = [...document.querySelectorAll<HTMLAnchorElement>('nav a')];
      return {
        charts: count('figure > svg'),
        bars: count('svg.bar'),
        rows: count('tr') - count('tr:has(th)'),
        sections: count('h2'),
        dates: count('p.weak'),
        links: links.filter((link) => document.getElementById(link.hash.slice(1))).length,
        scripts: document.scripts.length,
        ground: light(body.backgroundColor),
        ink: light(body.color),
        wide: document.documentElement.scrollWidth,
      };
    });
    grounds.push(seen.ground);
    const { charts, bars, rows, sections, dates, links } = seen;
    say(said.length === 0, `${colorScheme}: ${said.length} messages in the console ${said.join(' | ')}`);
    say(charts === times('<figure>') && charts > 0, `${colorScheme}: ${charts} charts are seen`);
    say(bars === times('class="bar"') && bars > 0, `${colorScheme}: ${bars} bars are seen`);
    say(rows === times('<code>'), `${colorScheme}: ${rows} numbers with their commands`);
    say(sections === links && dates === sections, `${colorScheme}: ${sections} topics with device and date, ${links} links`);
    say(seen.scripts === 0, `${colorScheme}: ${seen.scripts} scripts`);
    say(Math.abs(seen.ground - seen.ink) > 0.6, `${colorScheme}: text stands out`);
    say(seen.wide <= 1100, `${colorScheme}: ${seen.wide} pixels wide`);
    if (pictures) await page.screenshot({ path: join(pictures, `figures-${colorScheme}.png`) });
    await page.close();
  }
  say((grounds[0] ?? 0) > 0.8 && (grounds[1] ?? 1) < 0.3, 'light is light and dark is dark');
} finally {
  await browser.close();
}
process.exitCode = wrong === 0 ? 0 : 1;
