//! The ways to make the triangles of the classic scene, to compare them: who tessellates, when, and by
//! what rule.

use bevy::prelude::*;
use clap::ValueEnum;
use dolomite::ground::detail::{self, TerrainLod};
use dolomite_classic::render::ClassicSettings;
use dolomite_classic::{ClassicLevels, STATIC_LEVEL};
use thiserror::Error;

use super::NAME;
use crate::scene::LoadedScene;

/// Who tessellates, and when.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Mode {
    /// The GPU, when the view changes.
    #[default]
    Gpu,
    /// The CPU, when the view changes: the same levels and the same mesh, uploaded.
    Cpu,
    /// The GPU, once: the greatest level everywhere, kept.
    StaticGpu,
    /// The CPU, once: the same, uploaded once.
    StaticCpu,
}

impl Mode {
    /// All four, the defined one first.
    pub const ALL: [Self; 4] = [Self::Gpu, Self::Cpu, Self::StaticGpu, Self::StaticCpu];

    /// The one after it; after the last the first.
    #[must_use]
    pub fn next(self) -> Self {
        match self {
            Self::Gpu => Self::Cpu,
            Self::Cpu => Self::StaticGpu,
            Self::StaticGpu => Self::StaticCpu,
            Self::StaticCpu => Self::Gpu,
        }
    }

    /// The name, as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gpu => "gpu",
            Self::Cpu => "cpu",
            Self::StaticGpu => "static-gpu",
            Self::StaticCpu => "static-cpu",
        }
    }
}

/// By what rule levels are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Metric {
    /// Distance from the eye and relief, as the classic scene is defined.
    #[default]
    Classic,
    /// Length of an edge on the screen.
    Edge,
    /// Distance of the triangles from the true surface on the screen.
    Error,
}

impl Metric {
    /// The one after it; after the last the first.
    #[must_use]
    pub fn next(self) -> Self {
        match self {
            Self::Classic => Self::Edge,
            Self::Edge => Self::Error,
            Self::Error => Self::Classic,
        }
    }

    /// The name, as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Classic => "classic",
            Self::Edge => "edge",
            Self::Error => "error",
        }
    }
}

/// How the triangles of the classic scene are made.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct Methods {
    /// Who, and when.
    pub mode: Mode,
    /// By what rule, in modes that follow the view.
    pub metric: Metric,
    /// What the rule aims at, pixels: the length of an edge, or the error; `None`: its default.
    pub tau: Option<f32>,
    /// Tessellates patches outside of the frustum too.
    pub no_cull: bool,
}

/// Why a way to make triangles was refused.
#[derive(Debug, Error, PartialEq)]
pub enum MethodError {
    /// Another scene.
    #[error(
        "scene `{0}`: --mode, --metric, --tau, --no-cull and --matrix are for `--scene {classic}`",
        classic = NAME
    )]
    OtherScene(String),
    /// A rule that aims at nothing.
    #[error("--tau is for --metric edge and --metric error; the classic levels aim at no pixels")]
    NoTau,
    /// No length on the screen.
    #[error("--tau {0}: must be 1 to 1000 pixels")]
    Tau(f32),
    /// No error on the screen.
    #[error("--tau {0}: must be 0.05 to 1000 pixels")]
    Error(f32),
}

impl Methods {
    /// Checks the choice for a scene.
    ///
    /// # Errors
    /// [`MethodError`]: a choice that the scene does not have, or that makes no sense.
    pub fn check(&self, scene: &LoadedScene) -> Result<(), MethodError> {
        if scene.name != NAME && *self != Self::default() {
            return Err(MethodError::OtherScene(scene.name.clone()));
        }
        self.check_rule()
    }

    /// Checks the rule and what it aims at.
    fn check_rule(&self) -> Result<(), MethodError> {
        match (self.metric, self.tau) {
            (Metric::Classic, Some(_)) => Err(MethodError::NoTau),
            // NaN is in no range.
            (Metric::Edge, Some(tau)) if !(1.0..=1000.0).contains(&tau) => {
                Err(MethodError::Tau(tau))
            }
            (Metric::Error, Some(tau)) if !(0.05..=1000.0).contains(&tau) => {
                Err(MethodError::Error(tau))
            }
            _ => Ok(()),
        }
    }

    /// What the scene's kinds are told.
    pub fn settings(&self) -> ClassicSettings {
        let levels = match (self.mode, self.metric) {
            (Mode::StaticGpu | Mode::StaticCpu, _) => ClassicLevels::Static(STATIC_LEVEL),
            (_, Metric::Edge) => ClassicLevels::EdgeLength,
            (_, Metric::Classic) => ClassicLevels::Classic,
            (_, Metric::Error) => ClassicLevels::ErrorBound,
        };
        ClassicSettings {
            levels,
            host: matches!(self.mode, Mode::Cpu | Mode::StaticCpu),
            cull: !self.no_cull,
        }
    }

    /// What the camera asks of the level of detail, where that makes the triangles. The default of the
    /// error is a pixel.
    pub fn detail(&self) -> Option<TerrainLod> {
        let bounded = self.settings().levels == ClassicLevels::ErrorBound;
        bounded.then(|| TerrainLod {
            metric: detail::Metric::ErrorBound {
                pixels: self.tau.unwrap_or(1.0),
            },
            finest: FINEST,
            max_vertices: 1 << 19,
            ..TerrainLod::default()
        })
    }
}

/// Side of the least cells of the classic surface, metres: a quarter of the spacing of its samples.
const FINEST: f32 = 0.25;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_command_line() {
        for mode in Mode::ALL {
            let value = mode.to_possible_value().unwrap();
            assert_eq!(value.get_name(), mode.name());
        }
        for metric in Metric::value_variants() {
            assert_eq!(
                metric.to_possible_value().unwrap().get_name(),
                metric.name()
            );
        }
    }

    #[test]
    fn the_keys_go_round() {
        let (mut mode, mut metric) = (Mode::default(), Metric::default());
        for expected in Mode::ALL {
            assert_eq!(mode, expected);
            mode = mode.next();
        }
        assert_eq!(mode, Mode::default());
        for expected in Metric::value_variants() {
            assert_eq!(metric, *expected);
            metric = metric.next();
        }
        assert_eq!(metric, Metric::default());
    }

    #[test]
    fn rules_without_sense_are_refused() {
        let checked = |metric, tau| {
            Methods {
                metric,
                tau,
                ..default()
            }
            .check_rule()
        };
        for (metric, tau) in [
            (Metric::Classic, None),
            (Metric::Edge, None),
            (Metric::Edge, Some(1.0)),
            (Metric::Edge, Some(1000.0)),
            (Metric::Error, None),
            (Metric::Error, Some(0.5)),
        ] {
            assert_eq!(checked(metric, tau), Ok(()), "{metric:?} {tau:?}");
        }
        assert_eq!(checked(Metric::Classic, Some(4.0)), Err(MethodError::NoTau));
        for tau in [0.5, -3.0, 1001.0, f32::NAN] {
            let refused = checked(Metric::Edge, Some(tau));
            assert!(matches!(refused, Err(MethodError::Tau(_))), "{tau}");
        }
        for tau in [0.0, -1.0, 1001.0, f32::NAN] {
            let refused = checked(Metric::Error, Some(tau));
            assert!(matches!(refused, Err(MethodError::Error(_))), "{tau}");
        }
    }

    #[test]
    fn modes_become_settings() {
        let of = |mode, metric| {
            Methods {
                mode,
                metric,
                ..default()
            }
            .settings()
        };
        assert_eq!(of(Mode::Gpu, Metric::Classic), ClassicSettings::default());
        assert!(of(Mode::Cpu, Metric::Edge).host);
        assert_eq!(
            of(Mode::Cpu, Metric::Edge).levels,
            ClassicLevels::EdgeLength
        );
        for (mode, host) in [(Mode::StaticGpu, false), (Mode::StaticCpu, true)] {
            let settings = of(mode, Metric::Edge);
            assert_eq!(settings.levels, ClassicLevels::Static(32.0));
            assert_eq!(settings.host, host);
        }
        for mode in [Mode::Gpu, Mode::Cpu] {
            assert_eq!(of(mode, Metric::Error).levels, ClassicLevels::ErrorBound);
        }
        let detail = |mode, metric| {
            Methods {
                mode,
                metric,
                ..default()
            }
            .detail()
        };
        assert!(detail(Mode::Gpu, Metric::Error).is_some());
        assert_eq!(detail(Mode::StaticGpu, Metric::Error), None);
        assert_eq!(detail(Mode::Gpu, Metric::Edge), None);
    }
}
