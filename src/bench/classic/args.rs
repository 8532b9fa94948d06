//! What the command line says of the scene `classic`.

use std::path::PathBuf;

use clap::Args;

use super::methods::{MethodError, Methods, Metric, Mode};
use crate::scene::{LoadedScene, NamedScene};

/// Where its data lie, and how its triangles are made.
#[derive(Args, Clone, Debug)]
pub struct ClassicArgs {
    /// Folder of the shared data [default: DOLOMITE_SHARED, or `shared` beside the checkout].
    #[arg(long, value_name = "DIR", help_heading = "Classic scene")]
    pub data: Option<PathBuf>,
    /// Who makes the triangles of the classic scene, and when.
    #[arg(long, value_enum, default_value_t, help_heading = "Classic scene")]
    pub mode: Mode,
    /// By what rule, in modes that follow the view.
    #[arg(long, value_enum, default_value_t, help_heading = "Classic scene")]
    pub metric: Metric,
    /// What the rule aims at: length of an edge, or error [default: --pixels-per-edge].
    #[arg(long, value_name = "PIXELS", help_heading = "Classic scene")]
    pub tau: Option<f32>,
    /// Tessellate patches outside of the frustum too, as the scene's definition has it; the picture is the
    /// same.
    #[arg(long, help_heading = "Classic scene")]
    pub no_cull: bool,
}

impl ClassicArgs {
    fn methods(&self) -> Methods {
        Methods {
            mode: self.mode,
            metric: self.metric,
            tau: self.tau,
            no_cull: self.no_cull,
        }
    }

    /// The scene, to be found by its name.
    pub fn scene(&self) -> NamedScene {
        super::scene(self.data.clone(), self.methods())
    }

    /// Checks the choice for the scene that was loaded.
    ///
    /// # Errors
    /// [`MethodError`]: a choice that the scene does not have, or that makes no sense.
    pub fn check(&self, scene: &LoadedScene) -> Result<(), MethodError> {
        self.methods().check(scene)
    }
}
