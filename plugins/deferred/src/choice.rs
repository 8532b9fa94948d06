//! The way that a view is lit by.

use crate::components::Way;

/// What a view's point and spot lights need.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Chosen {
    /// There are none: nothing of them is bound.
    Nothing,
    /// Passes of [`Way::Volumes`].
    Volumes,
    /// Passes of [`Way::Tiled`].
    Tiled,
    /// No pass before the light.
    BruteForce,
}

/// What the pipelines of a view are compiled for, so that what no light needs is not in them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Variation {
    /// How point and spot lights are found.
    pub chosen: Chosen,
    /// What directional lights need.
    pub suns: Suns,
    /// Whether a point or spot light in view casts shadows.
    pub casters: bool,
    /// Whether lights are tested against the depth pyramid.
    pub culled: bool,
    /// Whether ambient occlusion of ours is read.
    pub occluded: bool,
}

/// What the directional lights of the world need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Suns {
    /// There are none.
    #[default]
    None,
    /// None casts shadows.
    Open,
    /// At least one does.
    Shadowed,
}

/// Up to so many lights in view, each pixel goes through all of them: lists of tiles cost a pass. On software Vulkan
/// going through 8 takes three quarters of the time of lists of them, and each more takes four times what it takes in
/// lists, so that both meet near 16 (docs/measured/light.md); the picture is the same on either side of it.
pub const FEW: u32 = 16;

/// The way for so many lights in view.
#[must_use]
pub const fn choose(way: Way, lights: u32, blends_floats: bool) -> Chosen {
    match (way, lights) {
        (_, 0) => Chosen::Nothing,
        (Way::BruteForce, _) | (Way::Auto, ..=FEW) => Chosen::BruteForce,
        (Way::Volumes, _) if blends_floats => Chosen::Volumes,
        (Way::Volumes | Way::Tiled | Way::Auto, _) => Chosen::Tiled,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_lights_are_gone_through_and_none_need_nothing() {
        assert_eq!(choose(Way::Auto, FEW, true), Chosen::BruteForce);
        assert_eq!(choose(Way::Auto, FEW + 1, true), Chosen::Tiled);
        assert_eq!(choose(Way::Volumes, 1, true), Chosen::Volumes);
        assert_eq!(choose(Way::Volumes, 1, false), Chosen::Tiled);
        assert_eq!(choose(Way::BruteForce, 100_000, true), Chosen::BruteForce);
        for way in [Way::Auto, Way::Volumes, Way::Tiled, Way::BruteForce] {
            assert_eq!(choose(way, 0, true), Chosen::Nothing);
        }
    }
}
