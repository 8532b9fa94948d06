//! Shading models: what a surface does with the light that arrives.
//!
//! A model is one WGSL function `fn name(surface: Surface, light: Incident) -> vec3<f32>` in a module with an import
//! path of its own, and a lighting id that its materials write. `dolomite::deferred::types` holds both structs.

use std::collections::BTreeMap;

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
    /// Whether it may reflect light from behind the surface.
    from_behind: bool,
}

impl ShadingModels {
    /// Adds a model: its id, the text of its module, the name of its function. A pixel with an id that no model has
    /// stays black, as in Bevy's own pass.
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
            from_behind: true,
        };
        self.0.insert(id, model);
        Ok(())
    }

    /// Says that a model's function is 0 for light from behind the surface, whose normal · direction is 0 or less:
    /// lights there are then passed over. Of the standard material this is known.
    pub fn dark_from_behind(&mut self, id: u8) {
        if let Some(model) = self.0.get_mut(&id) {
            model.from_behind = false;
        }
    }

    /// Ids of all models, the standard one first.
    pub fn ids(&self) -> impl Iterator<Item = u8> + '_ {
        std::iter::once(STANDARD).chain(self.0.keys().copied())
    }

    /// Texts of the models' own modules, with their import paths.
    pub fn sources(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0
            .values()
            .map(|model| (model.path.as_str(), model.source.as_str()))
    }

    /// The module `dolomite::deferred::models`: `shade` takes the model of the lighting id, or under the definition
    /// `ONE_MODEL` that of `MODEL_` and the id; `from_behind` says what [`Self::dark_from_behind`] does not.
    #[must_use]
    pub fn module(&self) -> String {
        let mut text = "#define_import_path dolomite::deferred::models\n\n\
             #import dolomite::deferred::standard::standard\n\
             #import dolomite::deferred::types::{Incident, Surface}\n"
            .to_owned();
        let (mut alone, mut cases) = (String::new(), String::new());
        let mut behind = vec!["false".to_owned()];
        for (id, model) in &self.0 {
            let (path, function) = (&model.path, &model.function);
            text += &format!("#import {path}::{function} as model_{id}\n");
            alone +=
                &format!("#ifdef MODEL_{id}\n    return model_{id}(surface, light);\n#endif\n");
            cases += &format!("        case {id}u: {{ return model_{id}(surface, light); }}\n");
            if model.from_behind {
                behind.push(format!("model == {id}u"));
            }
        }
        let behind = behind.join(" || ");
        let switch = if cases.is_empty() {
            "    return standard(surface, light);\n".to_owned()
        } else {
            format!(
                "    switch surface.model {{\n{cases}        default: {{ return standard(surface, light); }}\n    }}\n"
            )
        };
        text + &format!(
            "\nfn from_behind(model: u32) -> bool {{\n    return {behind};\n}}\n\n\
             fn shade(surface: Surface, light: Incident) -> vec3<f32> {{\n\
             #ifdef ONE_MODEL\n\
             {alone}\
             #ifdef MODEL_{STANDARD}\n    return standard(surface, light);\n#endif\n\
             #else\n\
             {switch}\
             #endif\n}}\n"
        )
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
        let module = models.module();
        assert!(module.contains("        case 3u: { return model_3(surface, light); }\n"));
        assert!(module.contains("#ifdef MODEL_3\n    return model_3(surface, light);\n#endif\n"));
        assert!(module.contains("return false || model == 3u;"));
        models.dark_from_behind(3);
        assert!(models.module().contains("return false;"));
        assert!(models.ids().eq([1, 3]));
    }
}
