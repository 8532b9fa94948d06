//! The shaders of draws are valid WGSL, and their structs lie in memory as Rust's do.

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
#[should_panic(expected = "size of MaterialRow")]
fn a_changed_struct_is_seen() {
    struct MaterialRow {
        base_color: [f32; 4],
    }
    same_layout!(
        &composed("geometry/user_material.wgsl"),
        MaterialRow { base_color }
    );
}

#[test]
fn the_records_of_draws_lie_as_in_rust() {
    use dolomite_geometry::layout::{GeometryDraw, MaterialRow};
    let draw = composed("geometry/user_material.wgsl");
    same_layout!(
        &draw,
        MaterialRow {
            base_color,
            emissive,
            surface,
        }
    );
    let draw = composed("geometry/draw.wgsl");
    same_layout!(
        &draw,
        GeometryDraw {
            clip_from_anchor,
            previous_clip_from_anchor,
            camera,
            time,
            anchor,
            uv_range,
            viewport,
            flags,
            producer,
            numbers,
        }
    );
}

/// Value of a constant of a module, which a test of ours has to name.
fn constant(module: &Module, name: &str) -> u32 {
    let found = module.constants.iter().find_map(|(_, constant)| {
        let full = constant.name.as_deref()?;
        let init = &module.global_expressions[constant.init];
        match init {
            naga::Expression::Literal(naga::Literal::U32(value)) if full == name => Some(*value),
            _ => None,
        }
    });
    found.unwrap_or_else(|| panic!("no constant {name}"))
}

#[test]
fn the_words_of_the_head_are_where_rust_has_them() {
    use dolomite_geometry::layout::GeometryHead;
    let head = composed("geometry/head.wgsl");
    for (name, at) in [
        ("INDEXED", offset_of!(GeometryHead, indexed)),
        ("AMPLIFIED", offset_of!(GeometryHead, amplified)),
        ("PLAIN", offset_of!(GeometryHead, plain)),
        ("OTHERS", offset_of!(GeometryHead, others)),
        ("VERTICES", offset_of!(GeometryHead, vertices)),
        ("PRIMITIVES", offset_of!(GeometryHead, primitives)),
        ("WANTED_VERTICES", offset_of!(GeometryHead, wanted_vertices)),
        (
            "WANTED_PRIMITIVES",
            offset_of!(GeometryHead, wanted_primitives),
        ),
        ("DISCARDED", offset_of!(GeometryHead, discarded)),
        ("LOWERED", offset_of!(GeometryHead, lowered)),
        ("OWN", offset_of!(GeometryHead, own)),
        ("HEAD_WORDS", size_of::<GeometryHead>()),
    ] {
        assert_eq!(constant(&head, name) as usize * 4, at, "{name}");
    }
    let vertex = composed("geometry/vertex.wgsl");
    let bytes = u64::from(constant(&vertex, "VERTEX_WORDS")) * 4;
    assert_eq!(bytes, dolomite_geometry::layout::VERTEX_BYTES);
}
