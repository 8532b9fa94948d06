//! A picture of the relief.

/// Shades, 0 to 255, and where there is none (no data): the cosine between the ground's normal and light from the north-west, 45° high,
/// with slopes after B. Horn (1981), as `gdaldem hillshade` takes them.
///
/// `metres`: distance of samples and metres a unit of height, so that slopes are true. Every `every`th sample of each row and column is shaded.
#[must_use]
pub fn hillshade(
    samples: &[f32],
    [columns, rows]: [u32; 2],
    (spacing, unit): ([f64; 2], f64),
    every: u32,
) -> ([u32; 2], Vec<Option<u8>>) {
    let every = every.max(1);
    let (wide, high) = (columns as usize, rows as usize);
    let size = [columns.div_ceil(every), rows.div_ceil(every)];
    let [x_step, z_step] = spacing.map(|metres| unit / (8.0 * metres * f64::from(every)));
    let mut shades = Vec::with_capacity(size[0] as usize * size[1] as usize);
    let step = every as usize;
    for row in (0..high).step_by(step) {
        for column in (0..wide).step_by(step) {
            let middle = samples[row * wide + column];
            // Beyond the border and where there is no data the middle goes on.
            let at = |dx: usize, dz: usize| {
                let x = (column + dx * step).saturating_sub(step).min(wide - 1);
                let z = (row + dz * step).saturating_sub(step).min(high - 1);
                let sample = samples[z * wide + x];
                f64::from(if sample.is_nan() { middle } else { sample })
            };
            let along = |f: &dyn Fn(usize, usize) -> f64| f(0, 2) + 2.0 * f(1, 2) + f(2, 2);
            let back = |f: &dyn Fn(usize, usize) -> f64| f(0, 0) + 2.0 * f(1, 0) + f(2, 0);
            let by_z = |a: usize, b: usize| at(a, b);
            let by_x = |a: usize, b: usize| at(b, a);
            let to_east = (along(&by_x) - back(&by_x)) * x_step;
            let to_south = (along(&by_z) - back(&by_z)) * z_step;
            // Light from (−½, √½, −½); the normal is (−east, 1, −south).
            let half = std::f64::consts::FRAC_1_SQRT_2;
            let light = 0.5 * (to_east + to_south) + half;
            let length = (1.0 + to_east * to_east + to_south * to_south).sqrt();
            let shade = (255.0 * light / length).clamp(0.0, 255.0);
            shades.push((!middle.is_nan()).then_some(shade as u8));
        }
    }
    (size, shades)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_towards_the_light_are_bright() {
        let ground = |f: &dyn Fn(u32, u32) -> f32| -> u8 {
            let samples: Vec<f32> = (0..25).map(|k| f(k % 5, k / 5)).collect();
            let (size, shades) = hillshade(&samples, [5, 5], ([2.0, 2.0], 1.0), 1);
            assert_eq!(size, [5, 5]);
            shades[12].unwrap()
        };
        // Level ground: sin 45°.
        assert_eq!(ground(&|_, _| 7.0), 180);
        // Rising to the south-east by 45°: the light meets it head-on.
        let rise = 2.0 * std::f32::consts::FRAC_1_SQRT_2;
        assert!(ground(&|x, z| rise * (x + z) as f32) >= 254);
        assert_eq!(ground(&|x, z| -rise * (x + z) as f32), 0);
        let mut holed = vec![1.0; 25];
        holed[12] = f32::NAN;
        assert_eq!(hillshade(&holed, [5, 5], ([1.0; 2], 1.0), 1).1[12], None);
        assert_eq!(hillshade(&holed, [5, 5], ([1.0; 2], 1.0), 2).0, [3, 3]);
    }
}
