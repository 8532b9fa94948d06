//! A picture and its lights.

use bevy::math::{Mat4, Quat, Vec3};
use dolomite_deferred::light::{Cone, LightRow, LightSource, Shadows};
use dolomite_testkit::random::Random;

/// Of the texture, and the part of it that the view is drawn to: tiles at its ends are cut.
pub(super) const TEXTURE: [u32; 2] = [80, 64];
pub(super) const VIEWPORT: [u32; 4] = [5, 3, 72, 56];
pub(super) const TILES: [u32; 2] = [5, 4];
pub(super) const LIGHTS: usize = 160;
pub(super) const NEAR: f32 = 0.5;

/// Where and how the picture is seen.
pub(super) struct Seen {
    pub world_from_view: Mat4,
    pub clip_from_view: Mat4,
    pub depths: Vec<u16>,
}

/// Ground that goes away from the eye, posts before it, the sky above.
pub(super) fn seen(random: &mut Random) -> Seen {
    let turn = Quat::from_rotation_y(3.0 * random.unit_f32()) * Quat::from_rotation_x(-0.2);
    let place = Vec3::new(120.0, 14.0, -60.0);
    let [x0, y0, width, height] = VIEWPORT;
    let depths = (0..TEXTURE[0] * TEXTURE[1]).map(|pixel| {
        let [x, y] = [pixel % TEXTURE[0], pixel / TEXTURE[0]];
        let down = y.saturating_sub(y0) as f32 / height as f32;
        let post = x.saturating_sub(x0) % 23 == 4;
        // Outside of the view another one has drawn.
        if x < x0 || y < y0 || x >= x0 + width || y >= y0 + height {
            return 40_000;
        }
        if down < 0.3 && !post {
            return 0;
        }
        let distance = if post {
            2.5 + x as f32 / 40.0
        } else {
            3.0 / (down - 0.2)
        };
        (65_535.0 * NEAR / distance) as u16
    });
    Seen {
        world_from_view: Mat4::from_rotation_translation(turn, place),
        clip_from_view: Mat4::perspective_infinite_reverse_rh(
            1.1,
            width as f32 / height as f32,
            NEAR,
        ),
        depths: depths.collect(),
    }
}

pub(super) fn lights(seen: &Seen, random: &mut Random) -> Vec<LightRow> {
    let light = |number: usize| {
        let mut signed = || 2.0 * random.unit_f32() - 1.0;
        let away = 2.0 + 14.0 * (1.0 + signed());
        let aside = Vec3::new(0.9 * away * signed(), 0.7 * away * signed(), -away);
        let cone = number.is_multiple_of(3).then(|| Cone {
            direction: Vec3::new(signed(), signed(), signed()).normalize_or(Vec3::NEG_Y),
            inner: 0.1,
            outer: 0.35 + 0.3 * (1.0 + signed()),
        });
        LightRow::new(&LightSource {
            position: seen.world_from_view.transform_point3(aside),
            range: 0.6 + 1.6 * (1.0 + signed()),
            intensity: Vec3::splat(30.0),
            radius: 0.0,
            cone,
            shadows: Shadows {
                map: number.is_multiple_of(5),
                contact: false,
            },
        })
        .ok()
    };
    (0..LIGHTS).filter_map(light).collect()
}
