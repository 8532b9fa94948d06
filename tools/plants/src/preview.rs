//! A picture of models in sunlight, to look at without a renderer: parallel rays, a depth buffer, four samples a pixel.

use glam::{Mat3, Quat, Vec3};
use image::{Rgb, RgbImage};

use crate::model::Model;

/// Samples along each side of a pixel.
const FINE: usize = 2;

fn srgb(linear: f32) -> u8 {
    // A soft shoulder in place of a tone curve.
    let x = (linear / (1.0 + 0.25 * linear)).clamp(0.0, 1.0);
    let curved = if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * power(x, 1.0 / 2.4) - 0.055
    };
    (curved * 255.0).round() as u8
}

#[expect(clippy::disallowed_methods, reason = "a picture to look at")]
fn power(x: f32, y: f32) -> f32 {
    x.powf(y)
}

/// Models beside each other, each scaled to the same height, with its shadow side seen a little.
#[must_use]
pub fn preview(rows: &[Vec<Model>], tile: usize) -> RgbImage {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let mut picture = RgbImage::new((columns * tile) as u32, (rows.len() * tile) as u32);
    for (row, models) in rows.iter().enumerate() {
        for (column, model) in models.iter().enumerate() {
            let shown = draw(model, tile);
            for (k, colour) in shown.iter().enumerate() {
                let [x, y] = [column * tile + k % tile, row * tile + k / tile];
                let [r, g, b] = colour.to_array().map(srgb);
                picture.put_pixel(x as u32, y as u32, Rgb([r, g, b]));
            }
        }
    }
    picture
}

fn draw(model: &Model, tile: usize) -> Vec<Vec3> {
    let side = tile * FINE;
    let turn = Mat3::from_quat(Quat::from_rotation_x(0.22) * Quat::from_rotation_y(0.7));
    let sun = Vec3::new(-0.45, 0.72, 0.53).normalize();
    let places: Vec<Vec3> = model
        .vertices
        .iter()
        .map(|v| turn * Vec3::from(v.place))
        .collect();
    let (low, high) = places
        .iter()
        .fold((Vec3::MAX, Vec3::MIN), |(a, b), p| (a.min(*p), b.max(*p)));
    let scale = 0.92 * side as f32 / (high - low).truncate().max_element();
    let middle = 0.5 * (low + high);
    let sky = Vec3::new(0.30, 0.42, 0.60);
    let mut colours = vec![sky; side * side];
    let mut depths = vec![f32::MIN; side * side];
    for triangle in model.indices.chunks_exact(3) {
        let corner = |k: usize| {
            let place = (places[triangle[k] as usize] - middle) * scale;
            Vec3::new(
                0.5 * side as f32 + place.x,
                0.5 * side as f32 - place.y,
                place.z,
            )
        };
        let [a, b, c] = [corner(0), corner(1), corner(2)];
        let area = (b - a).truncate().perp_dot((c - a).truncate());
        if area >= 0.0 {
            continue;
        }
        let shade = |k: usize| {
            let vertex = &model.vertices[triangle[k] as usize];
            let normal = turn * Vec3::from(vertex.normal);
            let up = 0.5 + 0.5 * normal.y;
            Vec3::from(vertex.colour)
                * (normal.dot(sun).max(0.0) * 3.1 * Vec3::new(1.0, 0.95, 0.85)
                    + sky * (0.5 + 1.2 * up))
        };
        let shades = [shade(0), shade(1), shade(2)];
        let least = a.min(b).min(c).max(Vec3::ZERO);
        let most = a.max(b).max(c).min(Vec3::splat(side as f32 - 1.0));
        for y in least.y as usize..=most.y.max(0.0) as usize {
            for x in least.x as usize..=most.x.max(0.0) as usize {
                let at = Vec3::new(x as f32 + 0.5, y as f32 + 0.5, 0.0);
                let weight =
                    |p: Vec3, q: Vec3| (q - p).truncate().perp_dot((at - p).truncate()) / area;
                let [u, v, w] = [weight(b, c), weight(c, a), weight(a, b)];
                let depth = u * a.z + v * b.z + w * c.z;
                let k = y * side + x;
                if u >= 0.0 && v >= 0.0 && w >= 0.0 && depth > depths[k] {
                    depths[k] = depth;
                    colours[k] = u * shades[0] + v * shades[1] + w * shades[2];
                }
            }
        }
    }
    (0..tile * tile)
        .map(|k| {
            let [x, y] = [k % tile * FINE, k / tile * FINE];
            let sum: Vec3 = (0..FINE * FINE)
                .map(|s| colours[(y + s / FINE) * side + x + s % FINE])
                .sum();
            sum / (FINE * FINE) as f32
        })
        .collect()
}
