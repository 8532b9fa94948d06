//! From a file to a naga module, imports and all.

use crate::{ALL, ShaderFile};
use naga::valid::Capabilities;
use naga_oil::compose::{
    ComposableModuleDescriptor, Composer, NagaModuleDescriptor, ShaderDefValue,
};
use std::collections::HashMap;
use thiserror::Error;

/// A file that does not become a module.
#[derive(Debug, Error)]
#[error("{file}: {reason}")]
pub struct ComposeError {
    /// Path of the file in which it went wrong.
    pub file: String,
    /// What naga_oil or naga said, with the place.
    pub reason: String,
}

/// What plain WebGPU grants: naga counts `pack2x16float` and its inverse as an extra.
const CAPABILITIES: Capabilities = Capabilities::SHADER_FLOAT16_IN_FLOAT32;

/// Composes the file at `path` with everything of ours that it imports; `defs` are the shader
/// definitions that are set. The result is validated by naga.
///
/// # Errors
/// An unknown path, an import that is not ours, or WGSL that is not valid.
pub fn compose(path: &str, defs: &[&str]) -> Result<naga::Module, ComposeError> {
    compose_with(path, defs, &[])
}

/// As [`compose`], with `others` beside our files: one with the path of one of ours stands in its
/// place, as a user's functions stand in that of `stage/user.wgsl`.
///
/// # Errors
/// As [`compose`].
pub fn compose_with(
    path: &str,
    defs: &[&str],
    others: &[ShaderFile],
) -> Result<naga::Module, ComposeError> {
    let ours = ALL
        .iter()
        .filter(|file| others.iter().all(|other| other.path != file.path));
    let files: Vec<ShaderFile> = others.iter().chain(ours).copied().collect();
    match files.iter().find(|file| file.path == path) {
        Some(file) => build(file, defs, &files),
        None => Err(ComposeError {
            file: path.to_owned(),
            reason: "no such file; the files are listed in dolomite_shaders::ALL".to_owned(),
        }),
    }
}

fn build(
    file: &ShaderFile,
    defs: &[&str],
    files: &[ShaderFile],
) -> Result<naga::Module, ComposeError> {
    let defs: HashMap<String, ShaderDefValue> = defs
        .iter()
        .map(|name| ((*name).to_owned(), ShaderDefValue::Bool(true)))
        .collect();
    let mut composer = Composer::default().with_capabilities(CAPABILITIES);
    for module in imports(file, files) {
        add(&mut composer, module, &defs, files)?;
    }
    let module = composer.make_naga_module(NagaModuleDescriptor {
        source: file.source,
        file_path: file.path,
        shader_defs: defs,
        ..Default::default()
    });
    module.map_err(|oil| ComposeError {
        file: file.path.to_owned(),
        reason: oil.emit_to_string(&composer),
    })
}

/// The modules of `files` that a file imports.
fn imports<'a>(
    file: &ShaderFile,
    files: &'a [ShaderFile],
) -> impl Iterator<Item = &'a ShaderFile> + use<'a> {
    let lines = file
        .source
        .lines()
        .filter_map(|line| line.trim().strip_prefix("#import "));
    let paths: Vec<&str> = lines
        .map(|import| import.trim().trim_end_matches(';'))
        .collect();
    files.iter().filter(move |module| {
        module.import_path().is_some_and(|module| {
            paths.iter().any(|path| {
                path.strip_prefix(module)
                    .is_some_and(|rest| rest.is_empty() || rest.starts_with([':', ' ']))
            })
        })
    })
}

/// Adds a module to the composer, after the modules that it imports.
fn add(
    composer: &mut Composer,
    file: &ShaderFile,
    defs: &HashMap<String, ShaderDefValue>,
    files: &[ShaderFile],
) -> Result<(), ComposeError> {
    if file
        .import_path()
        .is_some_and(|path| composer.contains_module(path))
    {
        return Ok(());
    }
    for module in imports(file, files) {
        add(composer, module, defs, files)?;
    }
    let added = composer.add_composable_module(ComposableModuleDescriptor {
        source: file.source,
        file_path: file.path,
        shader_defs: defs.clone(),
        ..Default::default()
    });
    match added {
        Ok(_) => Ok(()),
        Err(oil) => Err(ComposeError {
            file: file.path.to_owned(),
            reason: oil.emit_to_string(composer),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use naga::valid::{ValidationFlags, Validator};

    /// Whether a file is nothing without Bevy's own modules. The game's tests compose these with Bevy's files; others
    /// name such modules under a condition alone.
    fn needs_bevy(file: &ShaderFile) -> bool {
        ["deferred/", "vegetation/"]
            .iter()
            .any(|folder| file.path.starts_with(folder))
            && (file.source.contains("#import bevy") || imports(file, ALL).any(needs_bevy))
    }

    #[test]
    fn every_file_is_valid_wgsl() {
        let needing = ALL.iter().filter(|file| needs_bevy(file)).count();
        assert!(needing < 13, "{needing} files cannot be checked here");
        for file in ALL.iter().filter(|file| !needs_bevy(file)) {
            let module = compose(file.path, &[]).unwrap_or_else(|error| panic!("{error}"));
            let valid = Validator::new(ValidationFlags::all(), CAPABILITIES).validate(&module);
            assert!(valid.is_ok(), "{}: {valid:?}", file.path);
            assert_eq!(
                file.is_module(),
                module.entry_points.is_empty(),
                "{}",
                file.path
            );
        }
    }

    #[test]
    fn a_file_stands_in_the_place_of_another() {
        let functions = |body| ShaderFile {
            path: "stage/user.wgsl",
            source: body,
        };
        let good = functions(
            "#define_import_path dolomite::stage::user
#import dolomite::stage::api::{Patch, PatchLevels, StageView}
fn control(input: Patch, view: StageView) -> PatchLevels {
    return PatchLevels(vec4(7.0), vec2(7.0));
}",
        );
        let path = "stage/control.wgsl";
        let [ours, others] = [&[] as &[_], &[good]].map(|others| {
            let module = compose_with(path, &[], others).expect("valid functions");
            format!("{module:?}")
        });
        assert!(!ours.contains("F32(7.0)") && others.contains("F32(7.0)"));
        let broken = functions("#define_import_path dolomite::stage::user\nfn control() {}");
        assert!(compose_with(path, &[], &[broken]).is_err());
    }

    #[test]
    fn a_wrong_file_is_refused() {
        let error = compose("terrain/none.wgsl", &[]).expect_err("no such file");
        assert_eq!(error.file, "terrain/none.wgsl");
        for body in ["return 1.5;", "return nothing;", "return 1u"] {
            let source = format!("fn f() -> u32 {{ {body} }}");
            let broken = ShaderFile {
                path: "terrain/broken.wgsl",
                source: source.leak(),
            };
            let error = build(&broken, &[], ALL).expect_err(body);
            assert_eq!(error.file, "terrain/broken.wgsl");
            assert!(error.reason.contains("terrain/broken.wgsl:1:"), "{error}");
        }
    }
}
