//! How a picture is laid on: FBX's transform of texture coordinates as KHR_texture_transform.

use super::convert::finite;
use glam::{DQuat, DVec2, DVec3, EulerRot};
use ufbx::Props;

/// Offset, rotation in radians and scale, as [`crate::model::TextureUse::transform`] has them.
pub(crate) type UvTransform = ([f32; 2], f32, [f32; 2]);

/// Columns of a map of the plane are at right angles if their product is no more than this share of
/// their lengths'.
const SQUARE: f64 = 1e-9;

/// FBX's parameters of a texture. A point of the UV set is scaled about one pivot, turned about another
/// and moved: what comes out is where in the picture it looks.
#[derive(Debug, Clone, Copy)]
struct Placing {
    translation: DVec3,
    /// Degrees about X, then Y, then Z.
    rotation: DVec3,
    scaling: DVec3,
    scaling_pivot: DVec3,
    rotation_pivot: DVec3,
    /// U and V change places first.
    swap: bool,
}

impl Placing {
    fn of(props: &Props) -> Self {
        let vector = |name: &str, without: DVec3| {
            let value = props.find_prop(name).map(|prop| prop.value_vec4);
            let value = value.map(|v| DVec3::new(v.x, v.y, v.z));
            value.filter(|v| v.is_finite()).unwrap_or(without)
        };
        Self {
            translation: vector("Translation", DVec3::ZERO),
            rotation: vector("Rotation", DVec3::ZERO),
            scaling: vector("Scaling", DVec3::ONE),
            scaling_pivot: vector("TextureScalingPivot", DVec3::ZERO),
            rotation_pivot: vector("TextureRotationPivot", DVec3::ZERO),
            swap: props
                .find_prop("UVSwap")
                .is_some_and(|prop| prop.value_int != 0),
        }
    }

    /// In the file's coordinates, whose V grows upwards.
    fn at(&self, u: f64, v: f64) -> DVec2 {
        let point = match self.swap {
            true => DVec3::new(v, u, 0.0),
            false => DVec3::new(u, v, 0.0),
        };
        let [x, y, z] = self.rotation.to_array().map(f64::to_radians);
        let turn = DQuat::from_euler(EulerRot::ZYX, z, y, x);
        let scaled = self.scaling * (point - self.scaling_pivot) + self.scaling_pivot;
        let turned = turn * (scaled - self.rotation_pivot) + self.rotation_pivot;
        (turned + self.translation).truncate()
    }

    fn is_flat(&self) -> bool {
        self.rotation.x == 0.0 && self.rotation.y == 0.0
    }

    /// The same in glTF's coordinates, whose V grows downwards; `None` where it is sheared, which
    /// offset, rotation and scale cannot say.
    fn said(&self) -> Option<UvTransform> {
        let zero = self.at(0.0, 0.0);
        let (x, y) = (self.at(1.0, 0.0) - zero, self.at(0.0, 1.0) - zero);
        let (angle, scale) = if self.is_flat() && !self.swap {
            // As the file has them, with their signs.
            (self.rotation.z.to_radians(), self.scaling.truncate())
        } else {
            if x.dot(y).abs() > SQUARE * x.length() * y.length() {
                return None;
            }
            let side = if x.perp_dot(y) < 0.0 { -1.0 } else { 1.0 };
            let along = if x.length() > 0.0 { x } else { -y.perp() };
            (along.to_angle(), DVec2::new(x.length(), side * y.length()))
        };
        // glTF's origin is the file's (0, 1).
        let origin = self.at(0.0, 1.0);
        // No negative zero.
        let plain = |x: f64| finite(x) + 0.0;
        Some((
            [plain(origin.x), plain(1.0 - origin.y)],
            plain(angle),
            [plain(scale.x), plain(scale.y)],
        ))
    }
}

/// The transform of a texture; `None` if it changes nothing. The second is true where a part of it
/// cannot be said in two dimensions and is left out.
pub(crate) fn placed(props: &Props) -> (Option<UvTransform>, bool) {
    let placing = Placing::of(props);
    let said = placing.said();
    let made = said.or_else(|| {
        let rotation = DVec3::new(0.0, 0.0, placing.rotation.z);
        Placing {
            rotation,
            ..placing
        }
        .said()
    });
    let changes = made.filter(|made| *made != ([0.0; 2], 0.0, [1.0; 2]));
    (changes, said.is_none())
}

/// What a renderer of KHR_texture_transform makes of a texture coordinate.
pub(crate) fn transformed([u, v]: [f32; 2], (offset, rotation, scale): UvTransform) -> [f32; 2] {
    let turn = DVec2::from_angle(-f64::from(rotation));
    let scaled = DVec2::new(f64::from(u * scale[0]), f64::from(v * scale[1]));
    let turned = turn.rotate(scaled);
    [finite(turned.x) + offset[0], finite(turned.y) + offset[1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: Placing = Placing {
        translation: DVec3::ZERO,
        rotation: DVec3::ZERO,
        scaling: DVec3::ONE,
        scaling_pivot: DVec3::ZERO,
        rotation_pivot: DVec3::ZERO,
        swap: false,
    };

    /// Where a corner looks is the same by the file's own parameters and by the extension.
    fn agrees(placing: Placing) {
        let said = placing.said().expect("it can be said");
        for (u, v) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.3, -1.7)] {
            let wanted = placing.at(u, v);
            let [x, y] = transformed([u as f32, (1.0 - v) as f32], said);
            let off = (DVec2::new(f64::from(x), 1.0 - f64::from(y)) - wanted).length();
            assert!(off < 1e-5, "{placing:?} at {u}, {v}: off by {off}");
        }
    }

    #[test]
    fn a_tiling_of_four_is_a_scale_of_four() {
        let placing = Placing {
            scaling: DVec3::new(4.0, 4.0, 1.0),
            ..PLAIN
        };
        assert_eq!(placing.said(), Some(([0.0, -3.0], 0.0, [4.0, 4.0])));
    }

    #[test]
    fn a_shift_up_in_the_file_is_a_shift_down_in_gltf() {
        let placing = Placing {
            translation: DVec3::new(0.25, 0.5, 0.0),
            ..PLAIN
        };
        assert_eq!(placing.said(), Some(([0.25, -0.5], 0.0, [1.0, 1.0])));
    }

    #[test]
    fn a_quarter_turn_sends_u_to_v() {
        let placing = Placing {
            rotation: DVec3::new(0.0, 0.0, 90.0),
            ..PLAIN
        };
        // Counter-clockwise with V upwards: (1, 0) looks at (0, 1).
        assert!((placing.at(1.0, 0.0) - DVec2::new(0.0, 1.0)).length() < 1e-12);
        let (_, rotation, _) = placing.said().unwrap();
        assert_eq!(rotation, std::f32::consts::FRAC_PI_2);
        agrees(placing);
    }

    #[test]
    fn pivots_swaps_and_mirrors_are_said() {
        let centre = DVec3::new(0.5, 0.5, 0.0);
        let all = Placing {
            translation: DVec3::new(0.1, -0.7, 0.0),
            rotation: DVec3::new(0.0, 0.0, 30.0),
            scaling: DVec3::new(2.0, -3.0, 1.0),
            scaling_pivot: centre,
            rotation_pivot: DVec3::new(0.2, 0.9, 0.0),
            swap: false,
        };
        agrees(all);
        agrees(Placing { swap: true, ..all });
        // About the centre, the centre stays.
        let about = Placing {
            rotation: DVec3::new(0.0, 0.0, 77.0),
            scaling: DVec3::splat(3.0),
            scaling_pivot: centre,
            rotation_pivot: centre,
            ..PLAIN
        };
        assert!((about.at(0.5, 0.5) - centre.truncate()).length() < 1e-12);
        agrees(about);
        // Half a turn about X mirrors V.
        let flipped = Placing {
            rotation: DVec3::new(180.0, 0.0, 0.0),
            ..PLAIN
        };
        agrees(flipped);
        agrees(Placing {
            scaling: DVec3::new(0.0, 2.0, 1.0),
            rotation: DVec3::new(180.0, 0.0, 25.0),
            ..PLAIN
        });
    }

    #[test]
    fn a_turn_in_space_that_shears_is_not_said() {
        let sheared = Placing {
            rotation: DVec3::new(30.0, 40.0, 0.0),
            ..PLAIN
        };
        assert_eq!(sheared.said(), None);
    }
}
