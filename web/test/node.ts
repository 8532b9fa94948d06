// Plays capsules in Node, on Dawn: `node dist-tools/node.js FILE.capsule...`. Which Vulkan driver it takes, the
// environment says (VK_DRIVER_FILES).
//
// Prints a line for each capsule and for each number that is not the expected one; exits with 1 on a wrong one, with
// 2 where there is no adapter. `--json FILE` writes all that was found.

import { readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { lines, type Result, result } from '../src/suite/suite.js';

interface Dawn {
  create(options: string[]): GPU;
  globals: object;
}

const words = process.argv.slice(2);
const json = words.indexOf('--json');
const out = json >= 0 ? words.splice(json, 2)[1] : undefined;
// The package lies where the other tests by Node have it.
const tests = resolve(import.meta.dirname, '../../tests/node/package.json');
const dawn = (await import(pathToFileURL(createRequire(tests).resolve('webgpu')).href)) as Dawn;
Object.assign(globalThis, dawn.globals);
// It has to live as long as its device: Dawn ends with it.
const gpu = dawn.create(['backend=vulkan']);
const adapter = await gpu.requestAdapter();
if (!adapter) {
  console.log('no adapter that Dawn takes');
  process.exit(2);
}
console.log(`${adapter.info.vendor} ${adapter.info.architecture} ${adapter.info.description}`.trim());
const device = await adapter.requestDevice();
let faults = 0;
device.addEventListener('uncapturederror', (event) => {
  faults += 1;
  console.log(`device: ${event.error.message}`);
});
const results: Result[] = [];
for (const file of words) {
  const one = await result(device, readFileSync(file));
  results.push(one);
  for (const line of lines(one)) console.log(line);
}
if (out) writeFileSync(out, JSON.stringify({ adapter: adapter.info.description, results }, null, 1));
const wrong = results.filter((one) => !one.right).length + faults;
console.log(`${results.length} capsules, ${wrong} wrong`);
if (gpu.wgslLanguageFeatures.size === 0) console.log('no language features');
process.exit(wrong === 0 && results.length > 0 ? 0 : 1);
