//! Every shader, in every variant that a pipeline may ask for, compiled by a second implementation of WGSL: naga
//! accepts what browsers refuse.
//!
//! The variants come from the code that makes the pipelines: `stage_variants` of each kind of patches, the tables of
//! the passes of the ground, and, for crowds, deferred lighting and what grows, what was asked for in frames that were
//! drawn.
#![expect(
    clippy::duplicate_mod,
    reason = "each example brings what examples share along"
)]

mod composer;
mod crowd;
mod deferred;
mod examples;
mod node;
mod rules;
mod variants;
mod vegetation;

use composer::{Composer, written};
use node::Named;

/// A barrier in a loop that an atomic number bounds: each thread may read another number.
const BOUNDED_BY_ATOMIC: &str = "
@group(0) @binding(0) var<storage, read_write> counts: array<atomic<u32>>;
@compute @workgroup_size(32)
fn main(@builtin(workgroup_id) group: vec3<u32>) {
    let last = atomicLoad(&counts[0]);
    for (var at = group.x; at < last; at += 4u) {
        workgroupBarrier();
    }
}
";

/// A pipeline of nine storage buffers, one more than WebGPU grants.
const NINE_BUFFERS: &str = "
@group(0) @binding(0) var<storage, read_write> a: u32;
@group(0) @binding(1) var<storage, read_write> b: u32;
@group(0) @binding(2) var<storage, read_write> c: u32;
@group(0) @binding(3) var<storage, read_write> d: u32;
@group(0) @binding(4) var<storage, read_write> e: u32;
@group(0) @binding(5) var<storage, read_write> f: u32;
@group(0) @binding(6) var<storage, read_write> g: u32;
@group(0) @binding(7) var<storage, read_write> h: u32;
@group(0) @binding(8) var<storage, read_write> i: u32;
@compute @workgroup_size(1)
fn main() {
    a = b + c + d + e + f + g + h + i;
}
";

#[test]
fn what_naga_accepts_and_tint_refuses_is_refused() {
    if !node::is_there() {
        return;
    }
    for (name, source, reason) in [
        (
            "bounded",
            BOUNDED_BY_ATOMIC,
            "'workgroupBarrier' must only be called from uniform control flow",
        ),
        ("nine", NINE_BUFFERS, "storage buffers"),
    ] {
        let module = naga::front::wgsl::parse_str(source).expect(name);
        let shader = written(&module).expect("naga accepts it");
        let report = node::compile(
            name,
            &[Named {
                name: name.into(),
                shader,
            }],
        );
        assert!(!report.accepted, "{}", report.said);
        assert!(report.said.contains(reason), "{}", report.said);
        assert!(report.said.contains("1 faults"), "{}", report.said);
    }
}

#[test]
fn every_variant_is_accepted_by_tint_too_gpu() {
    if !node::is_there() {
        return;
    }
    let Some(asked) = variants::all() else {
        return;
    };
    let parts = asked.parts();
    let mut composer = Composer::new(asked.modules);
    let mut faults = Vec::new();
    let mut shaders = Vec::new();
    let mut ids = std::collections::HashMap::new();
    for variant in &asked.variants {
        let key = (
            variant.shader.path.clone(),
            variant.shader.source.as_str().to_owned(),
        );
        let id = *ids
            .entry(key)
            .or_insert_with(|| composer.add(variant.shader.clone()));
        let name = variant.name();
        match composer.compose(id, &variant.defs) {
            Ok(shader) => shaders.push(Named { name, shader }),
            Err(fault) => faults.push(format!("{name}: {fault}")),
        }
    }
    assert!(
        faults.is_empty(),
        "{} faults\n{}",
        faults.len(),
        faults.join("\n")
    );
    for (part, count) in parts {
        println!("{part}: {count} variants");
    }
    let report = node::compile("all", &shaders);
    println!("{} variants; distinct: {}", shaders.len(), report.said);
    assert!(report.accepted, "{}", report.said);
}
