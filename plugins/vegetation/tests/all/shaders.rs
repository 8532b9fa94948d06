//! The shaders are valid WGSL in every variant, and their structs lie in memory as Rust's do.

use std::mem::offset_of;

use dolomite_vegetation::render::layout::{BladeView, GrowParams, LayerParams, LookParams, Ring};
use dolomite_vegetation::render::record::PASSES;
use dolomite_vegetation::{Press, WindField};
use naga::{Module, TypeInner};

fn composed(path: &str) -> Module {
    super::support::composed(path, &[])
}

/// Size, and (name, offset) of the members, of the struct whose name begins so.
fn wgsl_struct(module: &Module, name: &str) -> (u32, Vec<(String, u32)>) {
    let found = module.types.iter().find_map(|(_, ty)| {
        // Composition decorates the names of imported types.
        let matches = ty
            .name
            .as_deref()
            .is_some_and(|full| full.starts_with(name));
        match &ty.inner {
            TypeInner::Struct { members, span } if matches => {
                let members = members
                    .iter()
                    .map(|m| (m.name.clone().unwrap_or_default(), m.offset));
                Some((*span, members.collect()))
            }
            _ => None,
        }
    });
    found.unwrap_or_else(|| panic!("no struct {name}"))
}

/// Asserts that size and offsets of a Rust struct are those of its WGSL counterpart.
macro_rules! same_layout {
    ($module:expr, $wgsl:literal, $rust:ident { $($field:ident),* $(,)? }) => {{
        let (size, members) = wgsl_struct($module, $wgsl);
        assert_eq!(size as usize, size_of::<$rust>(), "size of {}", $wgsl);
        let ours = [$((stringify!($field), offset_of!($rust, $field) as u32)),*];
        for (name, offset) in ours {
            let theirs = members.iter().find(|(theirs, _)| theirs.trim_end_matches('_') == name);
            assert_eq!(theirs.map(|m| m.1), Some(offset), "{}.{name}", $wgsl);
        }
    }};
}

#[test]
fn structs_lie_as_in_rust() {
    let module = composed("vegetation/grow.wgsl");
    same_layout!(
        &module,
        "Ring",
        Ring {
            least,
            square,
            inner_from,
            inner_to,
            tiles,
            level
        }
    );
    same_layout!(
        &module,
        "Layer",
        LayerParams {
            tallest,
            above,
            ring_count,
            list,
            reach,
            lods,
            rings
        }
    );
    same_layout!(
        &module,
        "GrowParams",
        GrowParams {
            planes,
            eye,
            pixels_per_radian,
            anchor,
            layer_count,
            flags,
            rooms,
            bases,
            vertices,
            piece_room,
            layers
        }
    );
    let (_, members) = wgsl_struct(&module, "Layer");
    use dolomite_vegetation::Growth;
    for (name, at) in [
        ("seed", offset_of!(Growth, lattice)),
        ("full", offset_of!(Growth, full)),
        ("uneven", offset_of!(Growth, uneven)),
        ("height_from", offset_of!(Growth, height)),
        ("slope_from", offset_of!(Growth, slope)),
        ("clump_seed", offset_of!(Growth, clump_seed)),
        ("clump_size", offset_of!(Growth, clump_size)),
        ("clump_from", offset_of!(Growth, clump_from)),
        ("clump_to", offset_of!(Growth, clump_to)),
    ] {
        let theirs = members
            .iter()
            .find(|(theirs, _)| theirs.trim_end_matches('_') == name);
        assert_eq!(theirs.map(|m| m.1 as usize), Some(at), "Layer.{name}");
    }
}

#[test]
fn what_draws_are_told_lies_as_in_rust() {
    let source = "
#import dolomite::vegetation::draw_types::BladeView
@group(0) @binding(0) var<uniform> view: BladeView;
@compute @workgroup_size(1) fn main() { let use_it = view.press_count; }
";
    let file = dolomite_shaders::ShaderFile {
        path: "probe.wgsl",
        source,
    };
    let module = super::support::composed("probe.wgsl", &[file]);
    same_layout!(
        &module,
        "Look",
        LookParams {
            root,
            tip,
            dry,
            size,
            sway,
            reach,
            head,
            middle
        }
    );
    same_layout!(
        &module,
        "WindField",
        WindField {
            gusts,
            swell,
            mean,
            share,
            flutter
        }
    );
    same_layout!(
        &module,
        "Press",
        Press {
            foot,
            radius,
            strength
        }
    );
    same_layout!(
        &module,
        "BladeView",
        BladeView {
            clip,
            previous_clip,
            camera,
            pixels_per_radian,
            sun,
            press_count,
            anchor,
            water,
            wind,
            previous_wind,
            looks,
            far,
            presses
        }
    );
}

#[test]
fn passes_keep_to_the_limits_of_webgpu() {
    for (file, entry, _) in PASSES {
        let module = composed(file);
        assert!(
            module.entry_points.iter().any(|found| found.name == entry),
            "{file}: {entry}"
        );
        let storage = module
            .global_variables
            .iter()
            .filter(|(_, variable)| matches!(variable.space, naga::AddressSpace::Storage { .. }));
        assert!(storage.count() <= 8, "{file}");
    }
}
