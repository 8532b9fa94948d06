// Khronos' glTF validator over files that stand alone: `node validate.mjs FILE.glb...`
//
// Prints a line for each file that has an error or a warning, and at the end `N files, B not valid`; exits with 1 if
// there is such a file.

import { readFileSync } from 'node:fs';
import validator from 'gltf-validator';

const files = process.argv.slice(2);
let bad = 0;
for (const file of files) {
  // 0 is no limit: with one, validation stops at it, and errors behind it are not counted.
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), { maxIssues: 0 });
  const { numErrors, numWarnings, messages } = report.issues;
  if (numErrors + numWarnings > 0) {
    bad += 1;
    const severe = messages.filter(({ severity }) => severity < 2).slice(0, 3);
    console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, first ${JSON.stringify(severe)}`);
  }
}
console.log(`${files.length} files, ${bad} not valid`);
process.exitCode = bad === 0 ? 0 : 1;
