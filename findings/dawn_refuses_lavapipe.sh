#!/usr/bin/env bash
# Dawn, by npm's `webgpu`, on lavapipe, Mesa's Vulkan in software: whether it opens it, and what it says else.
#
# Version: webgpu 0.6.2 (npm), Node 20.20.2, Mesa 22.3.6 (Debian 12: mesa-vulkan-drivers, vulkan-tools), Linux x86_64
# Guess:   lavapipe says Vulkan 1.3, and wgpu takes it with WebGPU's default limits, so Dawn opens it too. If not, it
#          names what lavapipe lacks.
# Seen:    `adapter: none`, and the warning `Vulkan shaderUniform*ArrayDynamicIndexing required`. The feature of that
#          name is there (shaderUniformBufferArrayDynamicIndexing = true); what lavapipe lacks is the same for sampled
#          images (shaderSampledImageArrayDynamicIndexing = false). On Debian 12, Dawn in software is SwiftShader.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
drivers=(/usr/share/vulkan/icd.d/lvp_icd*.json)
export VK_DRIVER_FILES=${drivers[0]} XDG_RUNTIME_DIR=$folder
npm install --silent --ignore-scripts --no-audit --no-fund webgpu@0.6.2
cat >open.mjs <<'JS'
import { create, globals } from 'webgpu';
Object.assign(globalThis, globals);
const gpu = create(['backend=vulkan']);
const adapter = await gpu.requestAdapter();
console.log(`adapter: ${adapter ? adapter.info.description : 'none'}`);
process.exit(0);
JS
features=$(vulkaninfo 2>/dev/null | grep -oE 'shader(UniformBuffer|SampledImage)ArrayDynamicIndexing *= (true|false)' | tr -s ' ' | sort)
said=$(node open.mjs 2>&1 | grep -oE 'adapter: .*|Vulkan shader[^ ]* required' | sort)
seen="$features
$said"
echo "$seen"
[[ $seen == 'shaderSampledImageArrayDynamicIndexing = false
shaderUniformBufferArrayDynamicIndexing = true
Vulkan shaderUniform*ArrayDynamicIndexing required
adapter: none' ]]
