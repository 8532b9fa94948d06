//! The WGSL structs lie in memory as Rust's do, and the bindings are those that are promised.

use dolomite_terrain::{
    Filter, GpuLayer, GpuTerrainUniform, GroundPoint, GroundRect, HeightMap, Layer, Source,
    Terrain, TerrainData,
};
use naga::{AddressSpace, Module, TypeInner};
use std::mem::offset_of;

fn composed() -> Module {
    dolomite_shaders::compose("terrain/probe.wgsl", &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// Size, and (name, offset) of the members, of a struct; composition decorates its name.
fn wgsl_struct(module: &Module, name: &str) -> (u32, Vec<(String, u32)>) {
    let found = module.types.iter().find_map(|(_, ty)| match &ty.inner {
        TypeInner::Struct { members, span } if ty.name.as_deref()?.starts_with(name) => {
            let member = |m: &naga::StructMember| (m.name.clone().unwrap_or_default(), m.offset);
            Some((*span, members.iter().map(member).collect()))
        }
        _ => None,
    });
    found.unwrap_or_else(|| panic!("no struct {name}"))
}

/// Asserts that a WGSL struct has exactly these members at the offsets of the Rust struct.
macro_rules! same_layout {
    ($module:expr, $wgsl:literal, $rust:ident { $($field:ident),* $(,)? }) => {{
        let (size, members) = wgsl_struct($module, $wgsl);
        assert_eq!(size as usize, size_of::<$rust>(), "size of {}", $wgsl);
        let ours = vec![$((stringify!($field).to_owned(), offset_of!($rust, $field) as u32)),*];
        assert_eq!(members, ours, "{}", $wgsl);
    }};
}

#[test]
fn the_bytes_of_maps_are_known_before_they_are_laid_out() {
    for (width, height) in [(1, 1), (2, 7), (61, 47), (64, 65)] {
        let samples = vec![3.0; (width * height) as usize];
        let at = bevy::math::DVec2::ZERO;
        let step = bevy::math::DVec2::ONE;
        let map = HeightMap::new(width, height, samples, at, step, Filter::Bicubic).expect("valid");
        let layer = Layer {
            source: Source::Map(map),
            mask: None,
        };
        let terrain = Terrain::new(TerrainData {
            extent: GroundRect::square(at, 100.0),
            layers: vec![layer.clone(), layer],
            base: 0.0,
            sea_level: None,
        });
        let terrain = terrain.expect("valid");
        assert_eq!(terrain.gpu_map_bytes(), 4 * terrain.gpu().data.len() as u64);
    }
}

#[test]
fn records_lie_as_in_rust() {
    let module = composed();
    same_layout!(
        &module,
        "Layer",
        GpuLayer {
            kind,
            octaves,
            data,
            warp_octaves,
            warp_data,
            erosion,
            mask_low,
            mask_scale,
            size,
            origin_cell,
            origin_frac,
            mantissa,
            shift,
            scale,
        }
    );
    same_layout!(
        &module,
        "TerrainUniform",
        GpuTerrainUniform {
            layer_count,
            base,
            sea_level,
            pad
        }
    );
    same_layout!(&module, "GroundPoint", GroundPoint { cell, frac });
}

#[test]
#[should_panic(expected = "Layer")]
fn a_changed_struct_is_seen() {
    struct Changed {
        kind: u32,
        rest: [u32; 19],
    }
    same_layout!(&composed(), "Layer", Changed { kind, rest });
}

#[test]
fn terrain_binds_two_buffers_and_a_uniform() {
    let module = composed();
    let mut found: Vec<_> = module
        .global_variables
        .iter()
        .filter_map(|(_, variable)| {
            let binding = variable
                .binding
                .as_ref()
                .filter(|binding| binding.group == 1)?;
            Some((
                binding.binding,
                matches!(variable.space, AddressSpace::Uniform),
            ))
        })
        .collect();
    found.sort_unstable();
    assert_eq!(found, [(0, false), (1, false), (2, true)]);
}
