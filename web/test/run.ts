// Plays capsules in Chromium and tries the page: `node dist-tools/run.js FOLDER`, FOLDER with *.capsule files.
//
// Prints a line for each thing that was tried, and exits with 1 if one of them is wrong. `--json FILE` writes all that
// was found of the capsules; `--keep` makes the golden picture anew; `--pictures FOLDER` keeps one of each scene;
// `--only capsules` or `--only page` tries one half.

import { readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { lines, type Result } from '../src/suite/suite.js';
import { launch, ROOT, serve } from './browser.js';
import { page as tryPage } from './page.js';

const words = process.argv.slice(2);
function option(name: string): string | undefined {
  const at = words.indexOf(name);
  return at < 0 ? undefined : words.splice(at, 2)[1];
}
const [json, pictures, only] = [option('--json'), option('--pictures'), option('--only')];
const keep = words.includes('--keep');
const folder = words.find((word) => !word.startsWith('--'));
const began = Date.now();
let wrong = 0;
const say = (right: boolean, what: string): void => {
  if (!right) wrong += 1;
  console.log(`${right ? 'right' : 'WRONG'}  ${what}`);
};

const { address, server } = await serve([join(ROOT, 'dist'), ...(folder ? [folder] : [])]);
const browser = await launch();
try {
  console.log(`Chromium ${browser.version()}`);
  if (folder && only !== 'page') {
    const files = readdirSync(folder).filter((name) => name.endsWith('.capsule')).sort();
    const page = await browser.newPage();
    const said: string[] = [];
    page.on('console', (message) => said.push(message.text()));
    page.on('pageerror', (error) => said.push(error.message));
    await page.goto(`${address}play.html`);
    const results: Result[] = [];
    for (const file of files) {
      const result = await page.evaluate((name) => window.playCapsule(name), file);
      results.push(result);
      for (const line of lines(result)) console.log(line);
    }
    const bad = results.filter((result) => !result.right).length;
    say(bad === 0 && files.length > 0, `${files.length} capsules played, ${bad} of them wrong`);
    say(said.length === 0, `${said.length} messages in the console ${said.join(' | ')}`);
    if (json) writeFileSync(json, JSON.stringify({ adapter: `Chromium ${browser.version()}`, results }, null, 1));
    await page.close();
  }
  if (only !== 'capsules') await tryPage(browser, address, say, keep, pictures);
} finally {
  await browser.close();
  server.close();
}
console.log(`${wrong} wrong, ${((Date.now() - began) / 1000).toFixed(0)} s`);
process.exitCode = wrong === 0 ? 0 : 1;
