//! The passes of the tessellation stage as a capsule: what an app records, what its pools must hold then.

use std::sync::Arc;

use bytemuck::{Zeroable, bytes_of, cast_slice};
use dolomite_geometry::layout::{EVALUATED_BYTES, VERTEX_BYTES};
use dolomite_shaders::ShaderFile;
use dolomite_tessellation::layout::{StageView, WorkHead};
use dolomite_tessellation::passes::{PASSES, PassRules, defs, pass_count};
use dolomite_tessellation::render::record::{StageDispatch, stage_dispatches};
use dolomite_tessellation::tables::{Instance, Tables};
use dolomite_tessellation::{
    Domain, Drawing, HostFunctions, PatchMesh, Tessellator, tessellate_host,
};

use super::CapsuleError;
use super::builder::Builder;
use super::format::{BindingKind, Capsule, Command, Field, FieldType, From, Indirect, Step};

/// Bytes behind each pool that nothing may write.
const GUARD: usize = 4096;

/// What every byte of the pools holds before the run.
const SENTINEL: u8 = 0xAB;

/// How far the vertices of a run may be from those of the CPU reference.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// Of positions: units in the last place, at least of `scale`.
    pub ulp: f64,
    /// Size of the terms that positions are sums of, metres.
    pub scale: f32,
    /// Of normals and texture coordinates: steps of their last bit.
    pub steps: u32,
}

impl Tolerance {
    /// Positions whose products are exact, so that contraction to fused operations changes nothing.
    pub const EXACT: Self = Self {
        ulp: 0.0,
        scale: 0.0,
        steps: 1,
    };
}

/// What is run.
pub struct StageCase<'a> {
    /// Its rules.
    pub tessellator: Tessellator,
    /// Patches of one entity, and the entity.
    pub mesh: PatchMesh,
    /// Its matrix and parameters.
    pub instance: Instance,
    /// Most vertices and primitives.
    pub pools: [u32; 2],
    /// How it is seen.
    pub view: StageView,
    /// Where vertices are evaluated.
    pub drawing: Drawing,
    /// Vertices of what an amplify function makes of a primitive; 0 without one.
    pub amplified: u32,
    /// Functions in the place of the stage's own.
    pub functions: Option<ShaderFile>,
    /// Their CPU reference.
    pub reference: &'a dyn HostFunctions,
    /// How far vertices may be off.
    pub tolerance: Tolerance,
}

impl<'a> StageCase<'a> {
    /// Flat patches whose levels stand in their control points.
    #[must_use]
    pub fn flat(tessellator: Tessellator, mesh: PatchMesh, pools: [u32; 2]) -> Self {
        let mut instance = Instance::IDENTITY;
        instance.params[0][0] = -1.0;
        Self {
            tessellator,
            mesh,
            instance,
            pools,
            view: open_view(),
            drawing: Drawing::Stored,
            amplified: 0,
            functions: None,
            reference: &super::flat::Flat,
            tolerance: Tolerance::EXACT,
        }
    }
}

/// A view without perspective from everywhere: all planes let everything in.
#[must_use]
pub fn open_view() -> StageView {
    StageView {
        planes: [[0.0, 0.0, 0.0, 1.0]; 6],
        pixels_per_radian: 1000.0,
        pixels_per_edge: 8.0,
        ..Zeroable::zeroed()
    }
}

/// The run of a case.
///
/// # Errors
/// If a shader is wrong, or the patches are too many.
pub fn record(name: &str, about: &str, case: &StageCase<'_>) -> Result<Capsule, CapsuleError> {
    let mut builder = Builder::new(name, about);
    let layout = case.mesh.layout();
    let mesh = Arc::new(case.mesh.clone());
    let entities = [(mesh, case.instance)];
    let tables = Tables::new(layout, &entities).map_err(CapsuleError::TooLarge)?;
    let mut params = tables.params;
    params.view = case.view;
    params.uv_range = 1.0;
    params.amplified = case.amplified;
    [params.max_vertices, params.max_primitives] = case.pools;
    let evaluated = case.drawing == Drawing::Evaluated;
    let vertex_bytes = if evaluated {
        EVALUATED_BYTES
    } else {
        VERTEX_BYTES
    };
    let corners = match case.tessellator.domain {
        Domain::Isolines => 2,
        _ => 3,
    };
    let guarded = |bytes: u64| bytes + GUARD as u64;

    let uniform = builder.buffer("params", bytes_of(&params));
    let words = builder.buffer("tables", cast_slice(&tables.words));
    let data = builder.buffer("data", cast_slice(&tables.data));
    let work = builder.filled("work", params.work_bytes(), SENTINEL);
    let pool = u64::from(case.pools[0]) * vertex_bytes;
    let vertices = builder.filled("vertices", guarded(pool), SENTINEL);
    let index_pool = u64::from(case.pools[1]) * 4 * corners;
    let indices = builder.filled("indices", guarded(index_pool), SENTINEL);

    let (uniform_kind, read, write) = (
        BindingKind::Uniform,
        BindingKind::ReadOnlyStorage,
        BindingKind::Storage,
    );
    let layouts = [
        builder.layout(&[uniform_kind, read, read, write]),
        builder.layout(&[uniform_kind, read, read, read, write, write]),
    ];
    let groups = [
        builder.group(layouts[0], &[uniform, words, data, work]),
        builder.group(layouts[1], &[uniform, words, data, work, vertices, indices]),
    ];
    let rules = PassRules {
        evaluated,
        split: layout.split,
        ..Default::default()
    };
    let own = defs(&case.tessellator, rules);
    let functions: Vec<ShaderFile> = case.functions.into_iter().collect();
    let dispatches = stage_dispatches(&params, case.tessellator.domain);
    let mut steps = Vec::new();
    for (pass, dispatch) in PASSES[..pass_count(case.tessellator.domain)]
        .iter()
        .zip(dispatches)
    {
        let defs: Vec<_> = own.iter().copied().chain(pass.def()).collect();
        let module = dolomite_shaders::compose_with(pass.file, &defs, &functions)?;
        let module = builder.module(pass.file, &defs, &module)?;
        let bound = usize::from(pass.emits);
        let pipeline = builder.pipeline(module, pass.entry, &[layouts[bound]]);
        let (groups_known, indirect) = match dispatch {
            StageDispatch::Groups(groups) => (Some(groups), None),
            StageDispatch::Indirect(offset) => (
                None,
                Some(Indirect {
                    buffer: work,
                    offset,
                }),
            ),
        };
        steps.push(Step {
            pipeline,
            groups: vec![groups[bound]],
            dispatch: groups_known,
            indirect,
        });
    }
    builder.command(Command::Clear {
        buffer: work,
        offset: 0,
        size: params.cleared_bytes(),
    });
    builder.command(Command::Pass { steps });

    let made = tessellate_host(
        &case.tessellator,
        &entities,
        case.reference,
        &case.view,
        case.pools,
        1.0,
    );
    let whole = tessellate_host(
        &case.tessellator,
        &entities,
        case.reference,
        &case.view,
        [u32::MAX; 2],
        1.0,
    );
    let mut head = made.head;
    head.amplified = [case.amplified, head.primitives, 0, 0];
    head.wanted_vertices = whole.head.vertices;
    head.wanted_primitives = whole.head.primitives;
    check_head(&mut builder, work, &head);
    if evaluated {
        let places = evaluated_places(case);
        let fields = vec![word("patch", 0, 1), word("place", 4, 2)];
        let expected = cast_slice(&places);
        let at = (vertices, 0, vertex_bytes);
        builder.check("vertices", at, fields, expected, From::CpuReference);
    } else {
        let fields = vertex_fields(case.tolerance);
        let expected = cast_slice(&made.vertices);
        let at = (vertices, 0, vertex_bytes);
        builder.check("vertices", at, fields, expected, From::CpuReference);
    }
    let at = (indices, 0, 4);
    let fields = vec![word("index", 0, 1)];
    builder.check(
        "indices",
        at,
        fields,
        cast_slice(&made.indices),
        From::CpuReference,
    );
    let untouched = [SENTINEL; GUARD];
    for (name, buffer, end) in [
        ("behind the vertices", vertices, pool),
        ("behind the indices", indices, index_pool),
    ] {
        let fields = vec![word("word", 0, 1)];
        builder.check(name, (buffer, end, 4), fields, &untouched, From::Untouched);
    }
    Ok(builder.finish())
}

/// Counters and draw arguments.
fn check_head(builder: &mut Builder, work: u32, head: &WorkHead) {
    let fields = vec![
        word("indexed", core::mem::offset_of!(WorkHead, indexed), 5),
        word("amplified", core::mem::offset_of!(WorkHead, amplified), 4),
        word("plain", core::mem::offset_of!(WorkHead, plain), 4),
        word("vertices", core::mem::offset_of!(WorkHead, vertices), 1),
        word("primitives", core::mem::offset_of!(WorkHead, primitives), 1),
        word(
            "wanted vertices",
            core::mem::offset_of!(WorkHead, wanted_vertices),
            1,
        ),
        word(
            "wanted primitives",
            core::mem::offset_of!(WorkHead, wanted_primitives),
            1,
        ),
        word("discarded", core::mem::offset_of!(WorkHead, discarded), 1),
        word("lowered", core::mem::offset_of!(WorkHead, lowered), 1),
    ];
    let size = size_of::<WorkHead>() as u64;
    let at = (work, 0, size);
    builder.check("head", at, fields, bytes_of(head), From::CpuReference);
}

fn word(name: &str, at: usize, count: u64) -> Field {
    Field {
        name: name.to_owned(),
        at: at as u64,
        count,
        ty: FieldType::U32,
    }
}

fn vertex_fields(tolerance: Tolerance) -> Vec<Field> {
    let Tolerance { ulp, scale, steps } = tolerance;
    let field = |name: &str, at, count, ty| Field {
        name: name.to_owned(),
        at,
        count,
        ty,
    };
    vec![
        field("position", 0, 3, FieldType::F32 { ulp, scale }),
        field("normal and material", 12, 1, FieldType::Oct12 { steps }),
        field("texture coordinates", 16, 1, FieldType::Snorm16x2 { steps }),
    ]
}

/// Patch and place of each vertex, as draws that evaluate are given them.
fn evaluated_places(case: &StageCase<'_>) -> Vec<[u32; 3]> {
    let patch = |number| dolomite_tessellation::HostPatch {
        mesh: &case.mesh,
        number,
        instance: &case.instance,
    };
    let control = |number| case.reference.control(&patch(number), &case.view);
    let made = case
        .tessellator
        .tessellate_mesh(&case.mesh, control, case.pools);
    made.vertices
        .iter()
        .map(|vertex| [vertex.patch, vertex.at[0], vertex.at[1]])
        .collect()
}
