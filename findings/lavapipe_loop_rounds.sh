#!/usr/bin/env bash
# Loops of a shader on Mesa's software Vulkan (lavapipe), through wgpu-native: how often they go round.
#
# Version: Mesa 22.3.6 (Debian 12's mesa-vulkan-drivers 22.3.6-1+deb12u2, LLVM 15); wgpu 0.32.0 (PyPI, which
#          brings wgpu-native 29.0.1.1), Python 3.11
# Guess:   as often as they say: three loops of 60 000 rounds, one after the other, count to 60 000 each.
# Seen:    `60000 5534 1 of 60000 each`. All loops of an invocation share 65 535 rounds, and each takes one more
#          than its body runs, to find its end; the loop in which they run out ends there, and every later one
#          runs its body once. No error, no lost device.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv environment
environment/bin/pip install --quiet --disable-pip-version-check wgpu==0.32.0 cffi==2.1.1 rendercanvas==2.7.2
cat >loops.py <<'PY'
import array
from wgpu.utils.compute import compute_with_buffers

SHADER = """
@group(0) @binding(0) var<storage, read> rounds: array<u32>;
@group(0) @binding(1) var<storage, read_write> counted: array<u32>;

@compute @workgroup_size(1)
fn main() {
    for (var k = 0u; k < rounds[0]; k++) { counted[0] += 1u; }
    for (var k = 0u; k < rounds[0]; k++) { counted[1] += 1u; }
    for (var k = 0u; k < rounds[0]; k++) { counted[2] += 1u; }
}
"""
out = compute_with_buffers({0: array.array("I", [60000])}, {1: (3, "I")}, SHADER, n=1)
print(*memoryview(out[1]).cast("B").cast("I"), "of 60000 each")
PY
driver=$(compgen -G '/usr/share/vulkan/icd.d/lvp_icd*.json' | head -n 1) || { echo 'needs mesa-vulkan-drivers'; exit 1; }
seen=$(VK_DRIVER_FILES=$driver VK_ICD_FILENAMES=$driver environment/bin/python loops.py 2>/dev/null)
echo "$seen"
[[ $seen == '60000 5534 1 of 60000 each' ]]
