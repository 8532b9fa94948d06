//! The ground's shaders are valid WGSL, and their structs lie in memory as Rust's do.

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

/// A constant of a file, by its text.
fn constant(file: &str, name: &str) -> usize {
    let source = dolomite_shaders::find(file).source;
    let begins = format!("const {name}: u32 = ");
    let line = source.lines().find_map(|line| line.strip_prefix(&begins));
    let value = line.unwrap_or_else(|| panic!("no {name} in {file}"));
    let value = value.trim_end_matches("u;").parse();
    value.unwrap_or_else(|error| panic!("{name} in {file}: {error}"))
}

#[test]
#[should_panic(expected = "size of EditedRect")]
fn a_changed_struct_is_seen() {
    struct EditedRect {
        low: [u32; 2],
        more: [u32; 7],
    }
    same_layout!(&composed("blocks/look.wgsl"), EditedRect { low, more });
}

#[test]
fn what_an_inspection_is_told_lies_as_in_rust() {
    use dolomite_ground::inspection::InspectionParams;
    same_layout!(
        &composed("ground/inspect.wgsl"),
        InspectionParams {
            clip,
            anchor,
            anchor_height,
            tolerance,
            half_size,
            root_area,
            pad,
            first_end,
            last_begin,
            first_stretch,
            last_stretch,
        }
    );
}

#[cfg(feature = "render")]
#[test]
fn the_grounds_look_lies_as_in_rust() {
    use bevy::render::render_resource::ShaderType;
    use dolomite_ground::render::{GroundLook, LookBand, LookCanopy, LookLayer};
    // `#[derive(ShaderType)]` lays the Rust struct out by WGSL's own rules: order and size are left.
    let module = composed("ground/material.wgsl");
    let (size, members) = wgsl_struct(&module, "GroundLook");
    assert_eq!(u64::from(size), GroundLook::min_size().get());
    let names: Vec<&str> = members
        .iter()
        .map(|(name, _)| name.trim_end_matches('_'))
        .collect();
    let ours = [
        "sea_level",
        "relief_texel",
        "relief_scale",
        "count",
        "tiles",
        "water",
        "deep",
        "order",
        "layers",
        "bands",
        "canopy",
    ];
    assert_eq!(names, ours);
    let at = |name: &str| members.iter().find(|(theirs, _)| theirs == name);
    assert_eq!(at("layers").map(|(_, at)| *at), Some(64 + 32 * 16));
    assert_eq!(at("bands").map(|(_, at)| *at), Some(64 + 32 * 16 + 32 * 32));
    let (size, _) = wgsl_struct(&module, "GroundBand");
    assert_eq!(u64::from(size), LookBand::min_size().get());
    let (size, _) = wgsl_struct(&module, "GroundLayer");
    assert_eq!(u64::from(size), LookLayer::min_size().get());
    let (size, _) = wgsl_struct(&module, "CanopyLayer");
    assert_eq!(u64::from(size), LookCanopy::min_size().get());
}

#[test]
fn ground_without_a_sea_calls_nothing_of_one() {
    let calls = |defs: &[&str]| {
        let module = dolomite_shaders::compose("ground/functions.wgsl", defs).expect("valid");
        let surface = module.functions.iter().find(|(_, function)| {
            let name = function.name.as_deref();
            name.is_some_and(|name| name.contains("ground_surface"))
        });
        let (_, surface) = surface.expect("it is imported");
        format!("{:?}", surface.body).matches("Call {").count()
    };
    let (with, without) = (calls(&[]), calls(&["GROUND_WITHOUT_SEA"]));
    assert_eq!(with - without, 1, "the surface of the water");
    assert_eq!(calls(&["GROUND_FEW_LAYERS"]), with);
}

/// Expressions that read a texture, in each function.
fn reads(defs: &[&str]) -> Vec<(String, usize)> {
    let module = dolomite_shaders::compose("ground/material.wgsl", defs).expect("valid");
    let functions = module.functions.iter().map(|(_, function)| {
        let read = |(_, expression): &(_, &naga::Expression)| {
            matches!(
                expression,
                naga::Expression::ImageSample { .. } | naga::Expression::ImageLoad { .. }
            )
        };
        let name = function.name.clone().unwrap_or_default();
        (name, function.expressions.iter().filter(read).count())
    });
    functions.filter(|(_, count)| *count > 0).collect()
}

#[cfg(feature = "render")]
#[test]
fn a_pixel_reads_a_fixed_number_of_texels_whatever_lies_there() {
    use dolomite_ground::GroundShading;
    let reads = reads(&[]);
    let of = |name: &str| {
        let of = reads.iter().filter(|(full, _)| full.contains(name));
        of.map(|(_, count)| *count).sum::<usize>()
    };
    // Two textures a tap, in a loop over taps; the relief map once. No other function reads: no loop over layers does.
    assert_eq!((of("layers_at"), of("ground_surface")), (2, 1), "{reads:?}");
    assert_eq!(reads.iter().map(|(_, count)| count).sum::<usize>(), 3);
    let source = dolomite_shaders::find("ground/taps.wgsl").source;
    let bound = "for (var n = 0u; n < MOST_TAPS && left != 0u; n++)";
    assert_eq!(source.matches(bound).count(), 1);
    assert_eq!(source.matches("textureSample").count(), 2);
    let most: u32 = source
        .lines()
        .find_map(|line| line.strip_prefix("const MOST_TAPS: u32 = "))
        .and_then(|rest| rest.trim_end_matches("u;").parse().ok())
        .expect("it is stated");
    assert_eq!(2 * most + 1, GroundShading::MOST_READS);
    // A tap for each combination of copy, scale, side and layer.
    assert_eq!(most, 1 << 4);
}

#[test]
fn the_full_material_reads_the_same_textures_elsewhere() {
    let reads = reads(&["GROUND_FULL"]);
    assert!(
        reads.iter().any(|(name, _)| name.contains("sample_once")),
        "{reads:?}"
    );
}

#[test]
fn the_records_of_blocks_lie_as_in_rust() {
    use dolomite_ground::blocks::changed::EditReach;
    use dolomite_ground::blocks::choose::AHEAD;
    use dolomite_ground::blocks::errors::{BED_SHARE, TAIL};
    use dolomite_ground::blocks::layout::{
        BlockNumbers, GpuHead as BlockHead, MOST_MADE, MOST_REFRESHED, RECORD_WORDS, SAMPLE_COUNT,
        SEEN_BYTES,
    };
    use dolomite_ground::blocks::place::{CORNER_COUNT, LEAST_HALF, VERTICES};
    use dolomite_ground::blocks::record::{ALWAYS, GROWTH, NEST, RING, RINGED_COUNT, WINDOW};
    use dolomite_ground::detail::lattice::MAX_DEPTH;
    let fit = composed("blocks/fit.wgsl");
    same_layout!(
        &fit,
        BlockHead {
            centre,
            half,
            parent,
            children,
            looked,
            mixed_error,
            low,
            high,
            others,
            pad,
        }
    );
    same_layout!(
        &fit,
        BlockNumbers {
            budget,
            levels,
            shift,
            readable
        }
    );
    let (size, members) = wgsl_struct(&fit, "SeenBlock");
    assert_eq!(u64::from(size), SEEN_BYTES, "{members:?}");
    let record = |name: &str| constant("blocks/record.wgsl", name);
    let mut at = 0;
    for (name, words) in [
        ("HEIGHTS", VERTICES),
        ("GRADIENTS", VERTICES),
        ("ERRORS", VERTICES),
        ("LOWS", VERTICES),
        ("HIGHS", VERTICES),
        ("RING_ERRORS", RING),
        ("CELL_LOWS", RINGED_COUNT),
        ("CELL_HIGHS", RINGED_COUNT),
    ] {
        assert_eq!(record(name), at, "{name}");
        at += words;
    }
    assert_eq!((record("RECORD_WORDS"), RECORD_WORDS), (at, at));
    assert_eq!(record("CORNER_COUNT"), CORNER_COUNT);
    assert_eq!(record("LEAST_HALF"), LEAST_HALF as usize);
    let number = |file: &str, name: &str| {
        let begins = format!("const {name}: f32 = ");
        let source = dolomite_shaders::find(file).source;
        let line = source.lines().find_map(|line| line.strip_prefix(&begins));
        let value = line.unwrap_or_else(|| panic!("no {name}"));
        value
            .trim_end_matches(';')
            .parse::<f32>()
            .expect("a number")
    };
    for (file, name, value) in [
        ("blocks/record.wgsl", "WINDOW", WINDOW),
        ("blocks/record.wgsl", "NEST", NEST),
        ("blocks/record.wgsl", "GROWTH", GROWTH),
        ("blocks/record.wgsl", "ALWAYS", ALWAYS),
        ("blocks/errors.wgsl", "TAIL", TAIL),
        ("blocks/errors.wgsl", "BED_SHARE", BED_SHARE),
        ("blocks/fit.wgsl", "AHEAD", AHEAD),
    ] {
        assert_eq!(number(file, name), value, "{name}");
    }
    let samples = constant("blocks/samples.wgsl", "SAMPLE_COUNT");
    assert_eq!(samples, SAMPLE_COUNT as usize);
    let made = constant("blocks/bindings.wgsl", "MOST_MADE");
    assert_eq!(made, MOST_MADE as usize);
    let refreshed = constant("blocks/bindings.wgsl", "MOST_REFRESHED");
    assert_eq!(refreshed, MOST_REFRESHED as usize);
    let ring = constant("blocks/edited.wgsl", "RING");
    assert_eq!(ring, EditReach::NEAR.wide_cells as usize);
    // A lattice may be halved as often.
    assert!(constant("blocks/drop.wgsl", "LEVELS") > MAX_DEPTH as usize);
    // A round of an edit has a thread for each block of the one before, and for each root.
    let spread = composed("blocks/spread.wgsl");
    assert_eq!(spread.entry_points[0].workgroup_size, [MOST_MADE, 1, 1]);
}

#[test]
fn the_records_of_the_level_of_detail_lie_as_in_rust() {
    use dolomite_ground::blocks::layout::{COUNT_WORDS, HORIZON};
    use dolomite_ground::detail::horizon::{COLUMNS, LAYERS};
    use dolomite_ground::detail::layout::{DetailParams, EditedRect};
    use dolomite_ground::detail::{DetailView, HorizonView};
    let look = composed("blocks/look.wgsl");
    same_layout!(
        &look,
        DetailView {
            planes,
            eye,
            scale,
            right,
            near,
            up,
            cos_corner,
            forward,
            orthographic,
            sweep,
            shadow_share,
            anchor,
            metric,
            inverse_tolerance,
            classic,
        }
    );
    same_layout!(
        &look,
        DetailParams {
            view,
            origin_cell,
            origin_frac,
            step_x,
            step_z,
            roots,
            depth,
            capacity,
            stamp,
            max_vertices,
            max_triangles,
            depth_range,
            sea,
            opaque_depth,
            anchor_height,
            flags,
            clip,
            half_size,
            oldest,
            horizon,
            border,
            edited_count,
            first_x,
            last_x,
            first_z,
            last_z,
            edited,
        }
    );
    same_layout!(
        &look,
        EditedRect {
            low,
            high,
            wide_from,
            wide_cells
        }
    );
    same_layout!(
        &look,
        HorizonView {
            eye,
            nearest,
            ahead,
            reach,
            pixel,
            near_reach,
        }
    );
    assert_eq!(constant("detail/bindings.wgsl", "HORIZON"), HORIZON);
    assert_eq!(constant("detail/horizon.wgsl", "COLUMNS"), COLUMNS);
    assert_eq!(constant("detail/horizon.wgsl", "LAYERS"), LAYERS);
    // Behind the map there is whether it is blind.
    assert_eq!(COUNT_WORDS, HORIZON + COLUMNS * LAYERS + 1);
}

#[test]
fn the_passes_of_the_level_of_detail_keep_to_webgpus_limits() {
    use dolomite_ground::blocks::layout::{ANSWER_PASS, PASSES};
    let files = PASSES.iter().map(|(file, ..)| file).chain([&ANSWER_PASS.0]);
    for file in files {
        let module = composed(file);
        let storage = module
            .global_variables
            .iter()
            .filter(|(_, global)| matches!(global.space, naga::AddressSpace::Storage { .. }));
        // WebGPU promises eight.
        assert!(storage.count() <= 8, "{file}");
    }
}

#[test]
fn the_records_of_height_queries_lie_as_in_rust() {
    use dolomite_ground::blocks::layout::ANSWER_PASS;
    use dolomite_ground::detail::probe::{ANSWER_GROUP, AnswerHead, Asked};
    use dolomite_terrain::ProbeAnswer;
    let module = composed(ANSWER_PASS.0);
    same_layout!(&module, Asked { frame, count });
    // A list without end lies behind the head.
    let (_, members) = wgsl_struct(&module, "Answers");
    let ours = [
        ("frame", offset_of!(AnswerHead, frame)),
        ("count", offset_of!(AnswerHead, count)),
        ("stamp", offset_of!(AnswerHead, stamp)),
        ("anchor_height", offset_of!(AnswerHead, anchor_height)),
        ("list", size_of::<AnswerHead>()),
    ];
    for (name, offset) in ours {
        let theirs = members.iter().find(|(theirs, _)| theirs == name);
        assert_eq!(theirs.map(|m| m.1), Some(offset as u32), "{name}");
    }
    same_layout!(
        &module,
        ProbeAnswer {
            height,
            rise,
            gradient,
            bound
        }
    );
    assert_eq!(module.entry_points[0].workgroup_size, [ANSWER_GROUP, 1, 1]);
}

#[test]
fn the_levels_own_words_of_the_head_are_behind_those_of_geometry() {
    use dolomite_geometry::layout::{HEAD_WORDS, OWN};
    use dolomite_ground::blocks::layout::{
        HEAD_CANDIDATES, HEAD_COARSENING, HEAD_CURVE, HEAD_DRAWN, HEAD_LEFT, HEAD_MADE, HEAD_STAMP,
        HEAD_USED, HEAD_WISHES,
    };
    let last = HEAD_CURVE + constant("blocks/finish.wgsl", "HEAD_CURVE_COUNT") - 1;
    assert!(last < HEAD_WORDS as usize, "{last}");
    for (name, word) in [
        ("HEAD_COARSENING", HEAD_COARSENING),
        ("HEAD_LEFT", HEAD_LEFT),
        ("HEAD_USED", HEAD_USED),
        ("HEAD_WISHES", HEAD_WISHES),
        ("HEAD_MADE", HEAD_MADE),
        ("HEAD_CANDIDATES", HEAD_CANDIDATES),
        ("HEAD_DRAWN", HEAD_DRAWN),
        ("HEAD_STAMP", HEAD_STAMP),
        ("HEAD_CURVE", HEAD_CURVE),
    ] {
        assert_eq!(constant("blocks/finish.wgsl", name), word, "{name}");
        assert!((OWN..HEAD_WORDS).contains(&(word as u64)), "{name}");
    }
}
