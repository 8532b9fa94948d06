//! All that is asked for, from an app with every part of Dolomite.

use std::collections::{BTreeMap, HashSet};
use std::time::{Duration, Instant};

use bevy::app::App;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::{PipelineCache, PipelineDescriptor};
use bevy::shader::{Shader, ShaderDefVal, ShaderImport};
use dolomite::DolomitePlugins;
use dolomite::ground::blocks::layout as blocks;
use dolomite::ground::detail::layout::all_without;
use dolomite::ground::render::GroundKind;
use dolomite::ground::render::detail::detail_variants;
use dolomite::ground::render::inspect::inspection_variants;
use dolomite::tessellation::render::{KindVariants, StageVariant, stage_variants};
use dolomite_classic::render::{BoundedClassicKind, ClassicKind};
use dolomite_geometry::render::{DrawShader, DrawTraits, draw_variants};
use dolomite_shaders::ShaderFile;

use super::{crowd, deferred, examples, rules, vegetation};
use crate::support::app;

/// A shader in one variant.
pub struct Variant {
    /// Whose it is.
    part: &'static str,
    pub shader: Shader,
    pub defs: Vec<ShaderDefVal>,
}

impl Variant {
    fn of_file(part: &'static str, file: &str, defs: &[&'static str]) -> Self {
        let file = dolomite_shaders::find(file);
        Self {
            part,
            shader: Shader::from_wgsl(file.source, file.path),
            defs: defs.iter().map(|def| (*def).into()).collect(),
        }
    }

    /// What a pipeline asks for.
    pub fn new(part: &'static str, shader: &Shader, defs: &[ShaderDefVal]) -> Self {
        Self {
            part,
            shader: shader.clone(),
            defs: defs.to_vec(),
        }
    }

    /// Whether it is this one.
    pub fn is(&self, shader: &Shader, defs: &[ShaderDefVal]) -> bool {
        self.shader.path == shader.path && self.defs == defs
    }

    /// The file of ours that it is made of.
    fn file(&self) -> &str {
        self.shader.path.split('#').next().unwrap_or_default()
    }

    /// For reports.
    pub fn name(&self) -> String {
        let defs = self.defs.iter().map(|def| match def {
            ShaderDefVal::Bool(name, true) => name.clone(),
            ShaderDefVal::Bool(name, false) => format!("{name} = false"),
            ShaderDefVal::Int(name, value) => format!("{name} = {value}"),
            ShaderDefVal::UInt(name, value) => format!("{name} = {value}"),
        });
        let defs = defs.collect::<Vec<_>>().join(" ");
        format!("{} of {} [{defs}]", self.shader.path, self.part)
    }
}

/// Everything that is asked for.
pub struct Asked {
    /// What shaders may import: Bevy's modules, ours, users' files.
    pub modules: Vec<Shader>,
    pub variants: Vec<Variant>,
}

impl Asked {
    /// How many variants each part has.
    pub fn parts(&self) -> BTreeMap<&'static str, usize> {
        let mut parts = BTreeMap::new();
        for variant in &self.variants {
            *parts.entry(variant.part).or_default() += 1;
        }
        parts
    }
}

/// `None`, after a line that says so, without Vulkan; in CI that fails.
pub fn all() -> Option<Asked> {
    let mut app = app::app(Duration::from_millis(16), |app| {
        app.add_plugins((DolomitePlugins, dolomite::deferred::BlinnPhongPlugin));
    })?;
    let mut variants = Vec::new();
    let mut stage = |part, asked: Vec<StageVariant>| {
        variants.extend(asked.into_iter().map(|variant| Variant {
            part,
            shader: Shader::from_wgsl(variant.source, format!("{}#{part}", variant.file)),
            defs: variant.defs,
        }));
    };
    for (name, list) in app.world().resource::<KindVariants>().0.clone() {
        stage(name, list());
    }
    stage("classic", stage_variants::<ClassicKind>());
    stage("bounded classic", detail_variants::<BoundedClassicKind>());
    stage("detail of the ground", detail_variants::<GroundKind<0>>());
    stage("examples", examples::variants());
    stage("rules", rules::variants());
    stage(
        "waves",
        draw_variants(
            &DrawShader::source(None, None, None),
            &[],
            &DrawTraits::default(),
        ),
    );
    variants.push(Variant {
        part: "waves",
        shader: Shader::from_wgsl(examples::WAVES, "waves.wgsl"),
        defs: Vec::new(),
    });
    for (file, _, second, _) in blocks::PASSES {
        let sets = match second {
            blocks::Second::Ground => all_without(),
            _ => vec![Vec::new()],
        };
        for set in sets {
            variants.push(Variant::of_file("passes of the ground", file, &set));
        }
    }
    let (answers, _) = blocks::ANSWER_PASS;
    variants.push(Variant::of_file("answers", answers, &[]));
    for defines in dolomite::inspector::picture::variants(&dolomite::WAYS) {
        let file = "inspector/picture.wgsl";
        variants.push(Variant::of_file("pictures of the frame", file, &defines));
    }
    for defines in inspection_variants() {
        let file = "ground/inspect.wgsl";
        variants.push(Variant::of_file(
            "inspections of the ground",
            file,
            &defines,
        ));
    }
    let drawn = crowd::draw(&mut app);
    variants.extend(drawn);
    variants.extend(deferred::draw(&mut app));
    variants.extend(vegetation::draw(&mut app));
    // The rest is asked for by tests and studies alone.
    let known: HashSet<String> = variants.iter().map(|v| v.file().to_owned()).collect();
    let rest = dolomite_shaders::ALL
        .iter()
        .filter(|file| !file.is_module());
    for file in rest.filter(|file| !known.contains(file.path)) {
        variants.push(Variant::of_file("tests and studies", file.path, &[]));
    }
    let ours = dolomite_shaders::ALL.iter().filter(|file| file.is_module());
    let ours = ours.map(|file| Shader::from_wgsl(file.source, file.path));
    let own: Vec<Shader> = ours.chain(users()).chain([rules::library()]).collect();
    let modules = with_bevys(&mut app, own, &variants);
    Some(Asked { modules, variants })
}

/// The pipelines that were asked for with a file of ours in them.
pub fn drawn(app: &App, part: &'static str) -> Vec<Variant> {
    let ours = |file: &&ShaderFile, shader: &Shader| shader.path == file.path;
    let shaders = app.world().resource::<Assets<Shader>>();
    let cache = app.sub_app(RenderApp).world().resource::<PipelineCache>();
    let mut variants: Vec<Variant> = Vec::new();
    for pipeline in cache.pipelines() {
        let PipelineDescriptor::RenderPipelineDescriptor(descriptor) = &pipeline.descriptor else {
            continue;
        };
        let state = &descriptor.vertex;
        let Some(shader) = shaders.get(&state.shader) else {
            continue;
        };
        let known = |variant: &Variant| variant.defs == state.shader_defs;
        if dolomite_shaders::ALL.iter().any(|file| ours(&file, shader))
            && !variants.iter().any(known)
        {
            variants.push(Variant {
                part,
                shader: shader.clone(),
                defs: state.shader_defs.clone(),
            });
        }
    }
    variants
}

/// The files with users' functions.
fn users() -> Vec<Shader> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    // Each folder, and how its files are named among an app's assets.
    let folders = [
        ("assets/shaders", "shaders/"),
        ("plugins/tessellation/assets", ""),
    ];
    let mut files = Vec::new();
    for (folder, named) in folders {
        for file in std::fs::read_dir(root.join(folder))
            .expect(folder)
            .flatten()
        {
            let name = file.file_name().to_string_lossy().into_owned();
            if name.ends_with(".wgsl") {
                let source = std::fs::read_to_string(file.path()).expect("WGSL is text");
                files.push(Shader::from_wgsl(source, format!("{named}{name}")));
            }
        }
    }
    files
}

/// The modules with those of Bevy that they and the variants import, which an app loads while it runs.
fn with_bevys(app: &mut App, own: Vec<Shader>, variants: &[Variant]) -> Vec<Shader> {
    let began = Instant::now();
    loop {
        let mut modules = own.clone();
        let named: HashSet<ShaderImport> = own.iter().map(|s| s.import_path.clone()).collect();
        let loaded = app.world().resource::<Assets<Shader>>().iter();
        let bevys = loaded.filter(|(_, shader)| !named.contains(&shader.import_path));
        modules.extend(bevys.map(|(_, shader)| shader.clone()));
        let there: HashSet<&ShaderImport> = modules.iter().map(|s| &s.import_path).collect();
        let asking = modules
            .iter()
            .chain(variants.iter().map(|variant| &variant.shader));
        let missing = asking
            .flat_map(|shader| &shader.imports)
            .find(|import| !there.contains(import));
        let Some(missing) = missing else {
            return modules;
        };
        let waited = began.elapsed();
        assert!(
            waited < Duration::from_secs(60),
            "{missing:?} is not loaded after {waited:?}"
        );
        app.update();
    }
}
