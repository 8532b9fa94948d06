//! The kernels, and their convolution along rows and columns. Beyond its border an image goes on as the pixel there.

use std::f64::consts::PI;

use crate::rows::in_parallel;

/// `N` planes of an image, a value a pixel.
#[derive(Debug, Clone)]
pub struct Planes<const N: usize> {
    pub width: usize,
    pub height: usize,
    pub values: Vec<[f64; N]>,
}

impl<const N: usize> Planes<N> {
    /// Each plane, filtered by kernels of one length, first along the rows, then along the columns.
    pub fn filtered(&self, along_x: &[Vec<f64>; N], along_y: &[Vec<f64>; N]) -> Self {
        let radius = (along_x.first().map_or(1, Vec::len) / 2) as isize;
        let (w, h) = (self.width, self.height);
        let clamp = |k: isize, n: usize| k.clamp(0, n as isize - 1) as usize;
        let taps = |kernels: &[Vec<f64>; N], at: &dyn Fn(isize) -> [f64; N]| {
            let mut sum = [0.0; N];
            for k in -radius..=radius {
                let value = at(k);
                for (plane, sum) in sum.iter_mut().enumerate() {
                    *sum += kernels[plane][(k + radius) as usize] * value[plane];
                }
            }
            sum
        };
        let rows = in_parallel(h as u32, |y| {
            let row = &self.values[y as usize * w..][..w];
            let at = |x: usize| taps(along_x, &|k| row[clamp(x as isize + k, w)]);
            (0..w).map(at).collect()
        });
        let values = in_parallel(h as u32, |y| {
            let at = |x: usize| taps(along_y, &|k| rows[clamp(y as isize + k, h) * w + x]);
            (0..w).map(at).collect()
        });
        Self { values, ..*self }
    }
}

/// Half the width of the kernels of contrast sensitivity, in pixels: three deviations of the widest Gaussian.
pub fn contrast_radius(pixels_per_degree: f64) -> isize {
    (3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as isize
}

/// The kernels of contrast sensitivity (the paper's table 1): in frequency `a exp(−b f²)`, so in space
/// `a √(π/b) exp(−π² x² / b)`; two Gaussians for blue against yellow. Returns the kernels of Y, Cx and the two parts of
/// Cz, along one axis, such that the sum over both axes is 1.
pub fn contrast(pixels_per_degree: f64) -> [Vec<f64>; 4] {
    let radius = contrast_radius(pixels_per_degree);
    // The root of the factor belongs to each of the two axes.
    let kernel = |a: f64, b: f64| -> Vec<f64> {
        let factor = (a * (PI / b).sqrt()).sqrt();
        let at = |k: isize| {
            let x = k as f64 / pixels_per_degree;
            factor * (-PI * PI * x * x / b).exp()
        };
        (-radius..=radius).map(at).collect()
    };
    let sum = |kernel: &[f64]| kernel.iter().sum::<f64>();
    let scaled = |kernel: Vec<f64>, by: f64| kernel.iter().map(|x| x * by).collect::<Vec<_>>();
    let (y, cx) = (kernel(1.0, 0.0047), kernel(1.0, 0.0053));
    let (cz1, cz2) = (kernel(34.1, 0.04), kernel(13.5, 0.025));
    let cz = sum(&cz1).hypot(sum(&cz2)).recip();
    let (by_y, by_cx) = (sum(&y).recip(), sum(&cx).recip());
    [
        scaled(y, by_y),
        scaled(cx, by_cx),
        scaled(cz1, cz),
        scaled(cz2, cz),
    ]
}

/// A Gaussian of the deviation of an edge's width, and its first and second derivative. The Gaussian has the sum 1, the
/// positive and the negative weights of the others 1 and −1.
pub fn features(pixels_per_degree: f64) -> [Vec<f64>; 3] {
    let deviation = 0.5 * 0.082 * pixels_per_degree;
    let radius = (3.0 * deviation).ceil() as isize;
    let along = |f: &dyn Fn(f64) -> f64| -> Vec<f64> {
        let at = |k: isize| {
            let x = k as f64;
            f(x) * (-x * x / (2.0 * deviation * deviation)).exp()
        };
        (-radius..=radius).map(at).collect()
    };
    let balanced = |kernel: Vec<f64>| -> Vec<f64> {
        let positive: f64 = kernel.iter().filter(|x| **x > 0.0).sum();
        let negative: f64 = -kernel.iter().filter(|x| **x < 0.0).sum::<f64>();
        let by = |x: &f64| {
            x / if *x > 0.0 {
                positive
            } else {
                negative.max(1e-300)
            }
        };
        kernel.iter().map(by).collect()
    };
    [
        balanced(along(&|_| 1.0)),
        balanced(along(&|x| -x)),
        balanced(along(&|x| x * x / (deviation * deviation) - 1.0)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_image_stays_and_has_no_features() {
        let flat = Planes {
            width: 5,
            height: 3,
            values: vec![[0.25; 3]; 15],
        };
        let [g, d, dd] = features(67.0);
        let along_x = [g.clone(), d, dd];
        let along_y = [g.clone(), g.clone(), g];
        for [a, b, c] in flat.filtered(&along_x, &along_y).values {
            assert!((a - 0.25).abs() < 1e-15 && b.abs() < 1e-15 && c.abs() < 1e-15);
        }
        let [y, cx, cz1, cz2] = contrast(67.0);
        let sum = |k: &[f64]| k.iter().sum::<f64>();
        assert!((sum(&y) - 1.0).abs() < 1e-14 && (sum(&cx) - 1.0).abs() < 1e-14);
        assert!((sum(&cz1).powi(2) + sum(&cz2).powi(2) - 1.0).abs() < 1e-14);
        assert_eq!(y.len(), 21);
    }
}
