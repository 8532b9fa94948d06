//! A stranger's kinds of patches: every rule that the stage has, with the functions that stand where the user's go.

use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use bevy::shader::Shader;
use dolomite::tessellation::render::{PatchKind, PatchShader, StageVariant, stage_variants};
use dolomite::tessellation::{Drawing, Mode, PatchLayout, Spacing, Winding};

const LIBRARY: &str = "rules::functions";

/// The library that the kinds name: the stage's own examples of a user's functions, in one module.
pub fn library() -> Shader {
    let files = [
        "stage/user.wgsl",
        "geometry/user_amplify.wgsl",
        "stage/user_bounds.wgsl",
        "geometry/user_material.wgsl",
    ];
    let mut source = format!("#define_import_path {LIBRARY}\n");
    let mut imported = Vec::new();
    for line in files
        .iter()
        .flat_map(|file| dolomite_shaders::find(file).source.lines())
    {
        // A module imports another once: the first file that does so needs all that the others do.
        let import = line.strip_prefix("#import ");
        let module = import.and_then(|import| Some(import.split_once("::{")?.0));
        if line.starts_with("#define_import_path") || module.is_some_and(|m| imported.contains(&m))
        {
            continue;
        }
        imported.extend(module);
        source += line;
        source += "\n";
    }
    Shader::from_wgsl(source, "rules.wgsl")
}

const LAYOUTS: [PatchLayout; 4] = [
    PatchLayout::TRIANGLE,
    PatchLayout::QUAD,
    PatchLayout::lines(4),
    PatchLayout::QUAD.with_split_sides(),
];
const SPACINGS: [Spacing; 3] = [
    Spacing::Equal,
    Spacing::FractionalEven,
    Spacing::FractionalOdd,
];

/// The kind with these rules: layout, spacing, and how its vertices come into the draw.
#[derive(Resource, AsBindGroup, Clone)]
struct Rules<const LAYOUT: usize, const SPACING: usize, const VERTICES: usize> {}

const STORED: usize = 0;
const MOVES: usize = 1;
const EVALUATED: usize = 2;
const AMPLIFIED: usize = 3;

impl<const LAYOUT: usize, const SPACING: usize, const VERTICES: usize> PatchKind
    for Rules<LAYOUT, SPACING, VERTICES>
{
    const LAYOUT: PatchLayout = LAYOUTS[LAYOUT];
    const SPACING: Spacing = SPACINGS[SPACING];
    // Both of these exchange constants alone; each of them meets each layout and each spacing.
    const WINDING: Winding = [Winding::Ccw, Winding::Cw][(LAYOUT + SPACING + VERTICES) % 2];
    const MODE: Mode = [Mode::Exact, Mode::D3d][(LAYOUT + SPACING + VERTICES / 2) % 2];
    const DRAWING: Drawing =
        [Drawing::Stored, Drawing::Evaluated][(VERTICES == EVALUATED) as usize];
    const MOVES: bool = VERTICES == MOVES;
    const VERTEX_SHADED: bool = SPACING == 1;
    const AMPLIFIED: u32 = if VERTICES == AMPLIFIED { 3 } else { 0 };
    const CUSTOM_MATERIAL: bool = true;
    const BOUNDED: bool = true;

    fn shader() -> PatchShader {
        PatchShader::Library(LIBRARY)
    }
}

fn layouts<const SPACING: usize, const VERTICES: usize>() -> Vec<StageVariant> {
    [
        stage_variants::<Rules<0, SPACING, VERTICES>>(),
        stage_variants::<Rules<1, SPACING, VERTICES>>(),
        stage_variants::<Rules<2, SPACING, VERTICES>>(),
        stage_variants::<Rules<3, SPACING, VERTICES>>(),
    ]
    .concat()
}

fn spacings<const VERTICES: usize>() -> Vec<StageVariant> {
    [
        layouts::<0, VERTICES>(),
        layouts::<1, VERTICES>(),
        layouts::<2, VERTICES>(),
    ]
    .concat()
}

/// What their pipelines may ask for.
pub fn variants() -> Vec<StageVariant> {
    [
        spacings::<STORED>(),
        spacings::<MOVES>(),
        spacings::<EVALUATED>(),
        spacings::<AMPLIFIED>(),
    ]
    .concat()
}
