//! The stage's shaders are valid WGSL, and their structs lie in memory as Rust's do.

use std::mem::offset_of;

use naga::{Module, TypeInner};

fn composed(path: &str) -> Module {
    dolomite_shaders::compose(path, &[]).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Size, and (name, offset) of the members, of the struct whose name ends in `name`.
fn wgsl_struct(module: &Module, name: &str) -> (u32, Vec<(String, u32)>) {
    let found = module.types.iter().find_map(|(_, ty)| {
        // Composition decorates the names of imported types.
        let matches = ty
            .name
            .as_deref()
            .is_some_and(|full| full.starts_with(name));
        match &ty.inner {
            TypeInner::Struct { members, span } if matches => Some((
                *span,
                members
                    .iter()
                    .map(|m| (m.name.clone().unwrap_or_default(), m.offset))
                    .collect(),
            )),
            _ => None,
        }
    });
    found.unwrap_or_else(|| panic!("no struct {name}"))
}

/// Asserts that size and offsets of a Rust struct are those of its WGSL counterpart.
macro_rules! same_layout {
    ($module:expr, $rust:ident { $($field:ident),* $(,)? }) => {{
        let (size, members) = wgsl_struct($module, stringify!($rust));
        assert_eq!(size as usize, size_of::<$rust>(), "size of {}", stringify!($rust));
        let ours = [$((stringify!($field), offset_of!($rust, $field) as u32)),*];
        for (name, offset) in ours {
            let theirs = members.iter().find(|(theirs, _)| theirs == name || theirs.starts_with(&format!("{name}_a")));
            assert_eq!(theirs.map(|m| m.1), Some(offset), "{}.{name}", stringify!($rust));
        }
    }};
}

#[test]
#[should_panic(expected = "size of StageView")]
fn a_changed_struct_is_seen() {
    struct StageView {
        planes: [[f32; 4]; 6],
    }
    same_layout!(&composed("stage/control.wgsl"), StageView { planes });
}

#[test]
fn the_stages_records_lie_as_in_rust() {
    use dolomite_tessellation::layout::{StageParams, StageView};
    let control = composed("stage/control.wgsl");
    same_layout!(
        &control,
        StageView {
            planes,
            sweep,
            eye,
            pixels_per_radian,
            anchor,
            pixels_per_edge,
            time,
            previous_time,
            orthographic,
            camera,
        }
    );
    same_layout!(
        &control,
        StageParams {
            view,
            corners,
            edges,
            patches,
            max_vertices,
            max_primitives,
            corner_table,
            edge_table,
            patch_table,
            points,
            point_size,
            uv_range,
            amplified,
            split,
            layers,
        }
    );
}

#[test]
fn the_stages_passes_keep_to_webgpus_limits() {
    for (path, defs) in [
        ("stage/control.wgsl", [].as_slice()),
        ("stage/measure.wgsl", &[]),
        ("stage/plan.wgsl", &[]),
        ("stage/place_items.wgsl", &[]),
        ("stage/emit_vertices.wgsl", &["STAGE_READ", "STAGE_MOVES"]),
        ("stage/shadow_ranges.wgsl", &["STAGE_READ"]),
        ("stage/emit_grid.wgsl", &["STAGE_READ"]),
        ("stage/emit_strips.wgsl", &["STAGE_READ"]),
        (
            "stage/emit_strips.wgsl",
            &["STAGE_READ", "STAGE_QUADS", "STAGE_SPLIT"],
        ),
    ] {
        let module = dolomite_shaders::compose(path, defs).expect(path);
        let storage = module
            .global_variables
            .iter()
            .filter(|(_, v)| matches!(v.space, naga::AddressSpace::Storage { .. }))
            .count();
        // Eight in all: two are left for the data of a kind.
        assert!(storage <= 6, "{path} binds {storage} storage buffers");
        let size = module.entry_points[0].workgroup_size;
        assert!(size.iter().product::<u32>() <= 256, "{path}");
    }
}

/// Value of a constant of a module, which a test of ours has to name.
fn constant(module: &Module, name: &str) -> u32 {
    let found = module.constants.iter().find_map(|(_, constant)| {
        let full = constant.name.as_deref()?;
        let init = &module.global_expressions[constant.init];
        match init {
            naga::Expression::Literal(naga::Literal::U32(value)) if full.starts_with(name) => {
                Some(*value)
            }
            _ => None,
        }
    });
    found.unwrap_or_else(|| panic!("no constant {name}"))
}

#[test]
fn the_heads_own_words_are_where_rust_has_them() {
    use dolomite_tessellation::layout::WorkHead;
    let work = composed("stage/work.wgsl");
    for (name, at) in [
        ("VERTEX_DISPATCH", offset_of!(WorkHead, dispatch)),
        ("GRID_DISPATCH", offset_of!(WorkHead, grid_dispatch)),
        ("SHARE", offset_of!(WorkHead, share)),
        ("HEAD", size_of::<WorkHead>()),
    ] {
        assert_eq!(constant(&work, name) as usize * 4, at, "{name}");
    }
}
