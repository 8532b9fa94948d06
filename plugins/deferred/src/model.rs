//! Shading models: what a surface does with the light that arrives.
//!
//! A model is one WGSL function `fn name(surface: Surface, light: Incident) -> vec3<f32>` in a module with an import
//! path of its own, and a lighting id that its materials write. `dolomite::deferred::types` holds both structs.

use std::collections::BTreeMap;
use std::fmt::Write;

use bevy::prelude::Resource;
use thiserror::Error;

/// The lighting id of Bevy's standard material.
pub const STANDARD: u8 = 1;
/// The lighting id of `BlinnPhongMaterial`.
pub const BLINN_PHONG: u8 = 2;

/// Why a model was not added.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ModelError {
    /// 0 is what is not lit, 1 Bevy's standard material.
    #[error("the lighting id {0} is taken: 0 is not lit, 1 is Bevy's standard material")]
    Reserved(u8),
    /// Another model has it.
    #[error("the lighting id {0} has a model already")]
    Taken(u8),
    /// Without one it cannot be imported.
    #[error("the first line is not `#define_import_path some::path`")]
    NoPath,
    /// The text has no such function.
    #[error("there is no `fn {0}(` in the module")]
    NoFunction(String),
}

/// The models of an app, by lighting id. Add yours before the first frame.
#[derive(Resource, Clone, Debug, Default)]
pub struct ShadingModels(BTreeMap<u8, Model>);

#[derive(Clone, Debug)]
struct Model {
    function: String,
    path: String,
    source: String,
}

impl ShadingModels {
    /// Adds a model: its id, the text of its module, the name of its function. A pixel with an id that no model has
    /// is lit as the standard material.
    ///
    /// # Errors
    /// If the id is taken, or the text is not a module with that function.
    pub fn add(&mut self, id: u8, source: &str, function: &str) -> Result<(), ModelError> {
        if id <= STANDARD {
            return Err(ModelError::Reserved(id));
        }
        if self.0.contains_key(&id) {
            return Err(ModelError::Taken(id));
        }
        let path = source
            .lines()
            .next()
            .and_then(|line| line.strip_prefix("#define_import_path "))
            .ok_or(ModelError::NoPath)?;
        if !source.contains(&format!("fn {function}(")) {
            return Err(ModelError::NoFunction(function.to_owned()));
        }
        let model = Model {
            function: function.to_owned(),
            path: path.trim().to_owned(),
            source: source.to_owned(),
        };
        self.0.insert(id, model);
        Ok(())
    }

    /// Texts of the models' own modules, with their import paths.
    pub fn sources(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0
            .values()
            .map(|model| (model.path.as_str(), model.source.as_str()))
    }

    /// The module `dolomite::deferred::models`, whose `shade` chooses by the lighting id.
    #[must_use]
    pub fn module(&self) -> String {
        let mut text = "#define_import_path dolomite::deferred::models\n\n\
             #import dolomite::deferred::standard::standard\n\
             #import dolomite::deferred::types::{Incident, Surface}\n"
            .to_owned();
        let mut cases = String::new();
        for (id, model) in &self.0 {
            // A `String` takes everything.
            let _ = writeln!(
                text,
                "#import {}::{} as model_{id}",
                model.path, model.function
            );
            let _ = writeln!(
                cases,
                "        case {id}u: {{ return model_{id}(surface, light); }}"
            );
        }
        if cases.is_empty() {
            text += "\nfn shade(surface: Surface, light: Incident) -> vec3<f32> {\n    return standard(surface, light);\n}\n";
            return text;
        }
        let _ = write!(
            text,
            "\nfn shade(surface: Surface, light: Incident) -> vec3<f32> {{\n    switch surface.model {{\n{cases}        default: {{ return standard(surface, light); }}\n    }}\n}}\n"
        );
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOON: &str = "#define_import_path my::toon\nfn toon(s: Surface, l: Incident) -> vec3<f32> { return vec3(0.0); }";

    #[test]
    fn what_cannot_be_a_model_is_refused_by_name() {
        let mut models = ShadingModels::default();
        assert_eq!(models.add(0, TOON, "toon"), Err(ModelError::Reserved(0)));
        assert_eq!(models.add(1, TOON, "toon"), Err(ModelError::Reserved(1)));
        assert_eq!(
            models.add(3, "fn toon() {}", "toon"),
            Err(ModelError::NoPath)
        );
        let none = Err(ModelError::NoFunction("tune".to_owned()));
        assert_eq!(models.add(3, TOON, "tune"), none);
        assert_eq!(models.add(3, TOON, "toon"), Ok(()));
        assert_eq!(models.add(3, TOON, "toon"), Err(ModelError::Taken(3)));
        assert!(
            models
                .module()
                .contains("case 3u: { return model_3(surface, light); }")
        );
    }
}
