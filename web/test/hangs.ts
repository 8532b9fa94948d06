// A page that never comes back, for the test of what is done about it: `node dist-tools/hangs.js` has to end with code 3,
// and its browser with it. Prints the number of the browser's process.

import { readdirSync, readFileSync } from 'node:fs';
import { endAfter, launch } from './browser.js';

/** The process that this one started and whose name is the browser's. */
function child(): string | undefined {
  const own = ` ${process.pid} `;
  return readdirSync('/proc').find((entry) => {
    if (!/^\d+$/.test(entry)) return false;
    try {
      // Its number, its name in brackets, its state, its parent.
      const stat = readFileSync(`/proc/${entry}/stat`, 'utf8');
      return stat.slice(stat.lastIndexOf(')') + 3, stat.lastIndexOf(')') + 6 + own.length).includes(own) && stat.includes('(chrom');
    } catch {
      return false;
    }
  });
}

const browser = await launch(false);
console.log(`browser ${child()}`);
endAfter(5);
const page = await browser.newPage();
// For longer than anybody waits.
await page.evaluate(() => {
  for (;;);
});
