// Plays capsules in Chromium and tries the page: `node dist-tools/run.js FOLDER`, FOLDER with *.capsule files.
//
// Prints a line for each thing that was tried, and exits with 1 if one of them is wrong, with 3 if the browser hangs.
//
// | option | what |
// |---|---|
// | `--only capsules`, `--only page` | tries one half |
// | `--short` | of the page what a change breaks first: it is opened, a slider moves, the picture, faults |
// | `--json FILE` | writes all that was found of the capsules, with the wall time of each |
// | `--keep` | makes the golden picture anew |
// | `--pictures FOLDER` | keeps pictures: of each scene, of the page, of it on a telephone |
// | `--limit SECONDS` | ends all after so long (3600) |

import { readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import type { Browser } from 'playwright-core';
import { lines, type Result } from '../src/suite/suite.js';
import { endAfter, launch, PATIENCE, ROOT, serve, within } from './browser.js';
import { page as tryPage, type Say } from './page.js';

const words = process.argv.slice(2);
function option(name: string): string | undefined {
  const at = words.indexOf(name);
  return at < 0 ? undefined : words.splice(at, 2)[1];
}
const [json, pictures, only, limit] = [option('--json'), option('--pictures'), option('--only'), option('--limit')];
const [keep, short] = [words.includes('--keep'), words.includes('--short')];
const folder = words.find((word) => !word.startsWith('--'));
const began = Date.now();
const seconds = (from: number): string => `${((Date.now() - from) / 1000).toFixed(0)} s`;
let wrong = 0;
const say: Say = (right, what) => {
  if (!right) wrong += 1;
  console.log(`${right ? 'right' : 'WRONG'}  ${what}`);
};

/** Plays every capsule of a folder, one after the other. */
async function capsules(browser: Browser, address: string, from: string): Promise<void> {
  const files = readdirSync(from).filter((name) => name.endsWith('.capsule')).sort();
  const page = await browser.newPage();
  const said: string[] = [];
  page.on('console', (message) => said.push(message.text()));
  page.on('pageerror', (error) => said.push(error.message));
  await page.goto(`${address}play.html`, { timeout: PATIENCE });
  const results: Result[] = [];
  for (const file of files) {
    const result = await within(file, 2 * PATIENCE, page.evaluate((name) => window.playCapsule(name), file));
    results.push(result);
    for (const line of lines(result)) console.log(line);
  }
  const bad = results.filter((result) => !result.right).length;
  say(bad === 0 && files.length > 0, `${files.length} capsules played, ${bad} of them wrong`);
  say(said.length === 0, `${said.length} messages in the console ${said.join(' | ')}`);
  if (json) writeFileSync(json, JSON.stringify({ adapter: `Chromium ${browser.version()}`, results }, null, 1));
  await page.close();
}

endAfter(Number(limit ?? 3600));
const { address, server } = await serve([join(ROOT, 'dist'), ...(folder ? [folder] : [])]);
const browser = await launch();
try {
  console.log(`Chromium ${browser.version()}`);
  if (folder && only !== 'page') await capsules(browser, address, folder);
  if (only !== 'capsules') await tryPage(browser, address, say, { keep, short, pictures });
} catch (error) {
  say(false, String(error));
} finally {
  await within('closing the browser', 60_000, browser.close()).catch((error) => say(false, String(error)));
  server.close();
}
console.log(`${wrong} wrong, ${seconds(began)}`);
// Not by itself: a browser that hangs would be waited for.
process.exit(wrong === 0 ? 0 : 1);
