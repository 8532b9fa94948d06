//! Which cameras see which entities of a kind: by the camera that an entity names, and by render layers.

use std::collections::BTreeSet;

use bevy::camera::visibility::RenderLayers;

/// Layers that the stage tells apart.
pub const LAYERS: usize = 32;

/// The layers of an entity or a camera, one a bit; and whether it is in others too.
pub fn layer_bits(layers: &RenderLayers) -> (u32, bool) {
    layers.iter().fold((0, false), |(bits, more), layer| {
        if layer < LAYERS {
            (bits | 1 << layer, more)
        } else {
            (bits, true)
        }
    })
}

/// By whom the entities of a kind are seen, each way once: few ways, however many entities.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SeenBy(BTreeSet<(u32, u32)>);

impl SeenBy {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// An entity in layers, seen by one camera alone, or by all where `camera` is 0.
    pub fn add(&mut self, camera: f32, layers: u32) {
        self.0.insert((camera as u32, layers));
    }

    /// Whether a camera of this number sees any of them in its layers.
    pub fn is_seen(&self, camera: f32, layers: &RenderLayers) -> bool {
        let (layers, _) = layer_bits(layers);
        let mut ways = self.0.iter();
        ways.any(|(only, own)| (*only == 0 || *only == camera as u32) && own & layers != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::Instance;

    #[test]
    fn layers_are_bits() {
        assert_eq!(layer_bits(&RenderLayers::default()), (1, false));
        assert_eq!(layer_bits(&RenderLayers::none()), (0, false));
        let many = RenderLayers::from_layers(&[1, 17, 31, 40]);
        let (bits, more) = layer_bits(&many);
        assert_eq!((bits, more), (1 << 1 | 1 << 17 | 1 << 31, true));
        let instance = Instance::IDENTITY.in_layers(bits);
        assert!(instance.is_in(1 << 31) && instance.is_in(1 << 17) && !instance.is_in(1));
        assert!(Instance::IDENTITY.is_in(0), "without layers: in all");
    }

    #[test]
    fn a_camera_sees_what_names_it_or_nobody_in_its_layers() {
        let mut seen = SeenBy::default();
        let usual = RenderLayers::default();
        assert!(!seen.is_seen(1.0, &usual), "there is nothing");
        seen.add(7.0, 1);
        assert!(seen.is_seen(7.0, &usual) && !seen.is_seen(8.0, &usual));
        assert!(!seen.is_seen(7.0, &RenderLayers::layer(3)));
        seen.add(0.0, 1 << 3);
        assert!(seen.is_seen(8.0, &RenderLayers::from_layers(&[2, 3])));
        assert!(!seen.is_seen(8.0, &RenderLayers::none()));
        seen.clear();
        assert!(!seen.is_seen(7.0, &usual));
    }
}
