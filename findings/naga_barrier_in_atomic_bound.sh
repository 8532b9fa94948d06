#!/usr/bin/env bash
# A barrier in a loop whose bound is an atomicLoad: two implementations of WGSL on one shader.
#
# Version: naga 29.0.4 (cargo, all validation flags on), webgpu 0.6.2 (npm, Dawn's Tint), Node 20.20.2
# Guess:   naga refuses it, as WGSL asks: an atomic number may differ from thread to thread, so the barrier
#          does not stand in uniform control flow.
# Seen:    `naga atomic: accepted`, and
#          `tint atomic: refused: 'workgroupBarrier' must only be called from uniform control flow`.
#          naga accepts a bound that is the thread's own number, too. Both accept workgroupUniformLoad.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir src
cat >shader.wgsl <<'WGSL'
@group(0) @binding(0) var<storage, read_write> counts: array<atomic<u32>>;
var<workgroup> shared_count: u32;
@compute @workgroup_size(32)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    if thread == 0u { shared_count = atomicLoad(&counts[0]); }
    let last = BOUND;
    for (var at = group.x; at < last; at += 4u) { workgroupBarrier(); }
}
WGSL
sed 's/BOUND/atomicLoad(\&counts[0])/' shader.wgsl >atomic.wgsl
sed 's/BOUND/thread/' shader.wgsl >thread.wgsl
sed 's/BOUND/workgroupUniformLoad(\&shared_count)/' shader.wgsl >uniform.wgsl
cat >Cargo.toml <<'TOML'
[package]
name = "validate"
version = "0.0.0"
edition = "2021"
[workspace]
[dependencies]
naga = { version = "=29.0.4", features = ["wgsl-in"] }
TOML
cat >src/main.rs <<'RUST'
use naga::valid::{Capabilities, ValidationFlags, Validator};

fn main() {
    for name in ["atomic", "thread", "uniform"] {
        let source = std::fs::read_to_string(format!("{name}.wgsl")).unwrap();
        let module = naga::front::wgsl::parse_str(&source).unwrap();
        let seen = Validator::new(ValidationFlags::all(), Capabilities::default()).validate(&module);
        println!("naga {name}: {}", if seen.is_ok() { "accepted" } else { "refused" });
    }
}
RUST
cat >validate.mjs <<'JS'
import { readFileSync } from 'node:fs';
import { create, globals } from 'webgpu';
Object.assign(globalThis, globals);
const device = await (await create(['backend=null']).requestAdapter()).requestDevice();
device.addEventListener('uncapturederror', () => {});
for (const name of ['atomic', 'thread', 'uniform']) {
  const module = device.createShaderModule({ code: readFileSync(`${name}.wgsl`, 'utf8') });
  const [first] = (await module.getCompilationInfo()).messages.filter(({ type }) => type === 'error');
  console.log(`tint ${name}: ${first ? `refused: ${first.message}` : 'accepted'}`);
}
process.exit(0);
JS
npm install --silent --ignore-scripts --no-audit --no-fund webgpu@0.6.2
seen=$(CARGO_TARGET_DIR=$folder/target cargo run --quiet; node validate.mjs 2>/dev/null | grep '^tint')
echo "$seen"
[[ $seen == "naga atomic: accepted
naga thread: accepted
naga uniform: accepted
tint atomic: refused: 'workgroupBarrier' must only be called from uniform control flow
tint thread: refused: 'workgroupBarrier' must only be called from uniform control flow
tint uniform: accepted" ]]
