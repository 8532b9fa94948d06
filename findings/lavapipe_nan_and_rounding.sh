#!/usr/bin/env bash
# Comparisons and sums of f32 in WGSL on Mesa's software Vulkan (lavapipe), through wgpu-native: whether `x != x`
# finds NaN, and whether `(a + b) - a` keeps its rounding, as compensated sums need.
#
# Version: Mesa 22.3.6 (Debian 12's mesa-vulkan-drivers 22.3.6-1+deb12u2, LLVM 15); wgpu 0.32.0 (PyPI, which
#          brings wgpu-native 29.0.1.1), Python 3.11
# Guess:   IEEE 754 for single operations: `x != x` is true for NaN alone, as `!(x == x)` is; and with
#          a = 1e8, b = 1 the sum rounds to 1e8, so that (a + b) - a is 0.
# Seen:    `x != x: 0, !(x == x): 1, (a + b) - a: 1.0`. `!=` is compiled as an ordered comparison, false for NaN,
#          and the difference is simplified to b: Kahan's sum and two-sum do nothing.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv environment
environment/bin/pip install --quiet --disable-pip-version-check wgpu==0.32.0 cffi==2.1.1 rendercanvas==2.7.2
cat >numbers.py <<'PY'
import array
from wgpu.utils.compute import compute_with_buffers

SHADER = """
@group(0) @binding(0) var<storage, read> given: array<f32>;
@group(0) @binding(1) var<storage, read_write> seen: array<f32>;

@compute @workgroup_size(1)
fn main() {
    let x = given[0];
    seen[0] = f32(x != x);
    seen[1] = f32(!(x == x));
    seen[2] = (given[1] + given[2]) - given[1];
}
"""
given = array.array("f", [float("nan"), 1e8, 1.0])
out = compute_with_buffers({0: given}, {1: (3, "f")}, SHADER, n=1)
unequal, not_equal, left = memoryview(out[1]).cast("B").cast("f")
print(f"x != x: {unequal:.0f}, !(x == x): {not_equal:.0f}, (a + b) - a: {left}")
PY
driver=$(compgen -G '/usr/share/vulkan/icd.d/lvp_icd*.json' | head -n 1) || { echo 'needs mesa-vulkan-drivers'; exit 1; }
seen=$(VK_DRIVER_FILES=$driver VK_ICD_FILENAMES=$driver environment/bin/python numbers.py 2>/dev/null)
echo "$seen"
[[ $seen == 'x != x: 0, !(x == x): 1, (a + b) - a: 1.0' ]]
