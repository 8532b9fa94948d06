#!/usr/bin/env bash
# Khronos' glTF validator: how many errors a report counts whose list of messages is limited.
#
# Version: gltf-validator 2.0.0-dev.3.10 (npm), Node 20.20.2
# Guess:   `maxIssues` shortens the list of messages; numErrors counts all errors that the file has, so
#          that a file with an error is known as one whatever the limit.
# Seen:    `all: 1 errors, 4 warnings, truncated false` and
#          `at most 4: 0 errors, 4 warnings, truncated true`. Validation stops at the limit, and the counts
#          are those of what was seen till then; messages are not sorted by severity, so that four
#          unexpected properties hide a mesh that does not exist. 0 stands for no limit.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
npm install --silent --ignore-scripts --no-audit --no-fund gltf-validator@2.0.0-dev.3.10
cat >count.cjs <<'JS'
const validator = require('gltf-validator');
const file = JSON.stringify({
  asset: { version: '2.0', one: 1, two: 2, three: 3, four: 4 },
  nodes: [{ mesh: 99 }],
});
(async () => {
  for (const [name, maxIssues] of [['all', 0], ['at most 4', 4]]) {
    const { numErrors, numWarnings, truncated } = (await validator.validateString(file, { maxIssues })).issues;
    console.log(`${name}: ${numErrors} errors, ${numWarnings} warnings, truncated ${truncated}`);
  }
})();
JS
seen=$(node count.cjs)
echo "$seen"
[[ $seen == $'all: 1 errors, 4 warnings, truncated false\nat most 4: 0 errors, 4 warnings, truncated true' ]]
