#!/usr/bin/env bash
# The largest f32 in WGSL that one implementation has written and another one reads.
#
# Version: naga 29.0.4 (cargo; its reader and its writer of WGSL), webgpu 0.6.2 (npm, Dawn's Tint), Node 20.20.2
# Guess:   what naga writes is valid WGSL: both accept it as they accept the source.
# Seen:    naga writes the shortest digits that round to the number, 340282350000000000000000000000000000000f. They
#          are above the largest f32, which WGSL makes an error: Tint refuses with `value cannot be represented as
#          'f32'`, also where the source had the number in hexadecimal. naga reads it back. A composer that writes by
#          naga makes shaders of it that no browser of Chromium's takes; 3.4e38 stands in for infinity as well.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir src
for literal in 3.4028234663852886e38f 0x1.fffffep127f 3.4e38f; do
  cat >"source-$literal.wgsl" <<WGSL
@group(0) @binding(0) var<storage, read_write> least: array<f32>;
@compute @workgroup_size(1)
fn main(@builtin(global_invocation_id) at: vec3<u32>) { least[at.x] = min(least[at.x], $literal); }
WGSL
done
cat >Cargo.toml <<'TOML'
[package]
name = "write"
version = "0.0.0"
edition = "2021"
[workspace]

[dependencies]
naga = { version = "=29.0.4", features = ["wgsl-in", "wgsl-out"] }
TOML
cat >src/main.rs <<'RUST'
use naga::back::wgsl::{write_string, WriterFlags};
use naga::front::wgsl::parse_str;
use naga::valid::{Capabilities, ValidationFlags, Validator};

fn main() {
    for literal in ["3.4028234663852886e38f", "0x1.fffffep127f", "3.4e38f"] {
        let module = parse_str(&std::fs::read_to_string(format!("source-{literal}.wgsl")).unwrap()).unwrap();
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::default());
        let text = write_string(&module, &validator.validate(&module).unwrap(), WriterFlags::empty()).unwrap();
        println!("naga written {literal}: {}", if parse_str(&text).is_ok() { "accepted" } else { "refused" });
        std::fs::write(format!("written-{literal}.wgsl"), text).unwrap();
    }
}
RUST
cat >validate.mjs <<'JS'
import { readFileSync } from 'node:fs';
import { create, globals } from 'webgpu';
Object.assign(globalThis, globals);
const device = await (await create(['backend=null']).requestAdapter()).requestDevice();
device.addEventListener('uncapturederror', () => {});
for (const file of ['source', 'written']) {
  for (const literal of ['3.4028234663852886e38f', '0x1.fffffep127f', '3.4e38f']) {
    const module = device.createShaderModule({ code: readFileSync(`${file}-${literal}.wgsl`, 'utf8') });
    const [first] = (await module.getCompilationInfo()).messages.filter(({ type }) => type === 'error');
    console.log(`tint ${file} ${literal}: ${first ? `refused: ${first.message}` : 'accepted'}`);
  }
}
process.exit(0);
JS
npm install --silent --ignore-scripts --no-audit --no-fund webgpu@0.6.2
seen=$(CARGO_TARGET_DIR=$folder/target cargo run --quiet; node validate.mjs 2>/dev/null | grep '^tint [sw]')
echo "$seen"
[[ $seen == "naga written 3.4028234663852886e38f: accepted
naga written 0x1.fffffep127f: accepted
naga written 3.4e38f: accepted
tint source 3.4028234663852886e38f: accepted
tint source 0x1.fffffep127f: accepted
tint source 3.4e38f: accepted
tint written 3.4028234663852886e38f: refused: value cannot be represented as 'f32'
tint written 0x1.fffffep127f: refused: value cannot be represented as 'f32'
tint written 3.4e38f: accepted" ]]
