//! Cells of surfaces whose errors are known.

use super::*;

fn grid(surface: impl Fn(f32, f32) -> f32) -> Vec<Height> {
    let at = |k: usize| k as f32 / STEPS as f32;
    (0..SAMPLES * SAMPLES)
        .map(|k| height([surface(at(k % SAMPLES), at(k / SAMPLES)), 0.0, 0.0]))
        .collect()
}

#[test]
fn a_plane_has_no_error() {
    for outer in 0..4 {
        let cell = Cell::new(&grid(|u, v| 3.0 * u - 2.0 * v), -1e30, 12.0, outer, 0.0);
        // Roundings of numbers up to 3.
        assert!(cell.error < 5e-6, "{cell:?}");
    }
}

#[test]
fn a_bowl_has_the_error_of_its_diagonal() {
    // ½(u² + v²): the diagonal of length √2 leaves (√2)²/8 in its middle, whichever it is; then the
    // quarters 1/8 at the middles of the sides.
    for outer in 0..4 {
        let cell = Cell::new(&grid(|u, v| 0.5 * (u * u + v * v)), -1e30, 12.0, outer, 0.0);
        let tail = TAIL * 0.125 * 4.0 / (STEPS * STEPS) as f32;
        assert!((cell.error - 0.25 - tail).abs() < 1e-5, "{outer}: {cell:?}");
        for quarter in cell.quarters {
            assert!((quarter - 0.125 - tail).abs() < 1e-5, "{outer}: {cell:?}");
        }
    }
}

#[test]
fn a_saddle_tells_the_diagonals_apart() {
    // u·v is flat along both axes and bends along the diagonals, one up and one down.
    let along = Cell::new(&grid(|u, v| u * v), -1e30, 12.0, 0, 0.0);
    let across = Cell::new(&grid(|u, v| u * v), -1e30, 12.0, 1, 0.0);
    assert!((along.error - 0.25).abs() < 0.01 && (across.error - 0.25).abs() < 0.01);
}

#[test]
fn water_is_flat_and_its_bed_counts_by_half() {
    let dry = grid(|u, _| 40.0 * (u - 0.5) * (u - 0.5));
    let deep: Vec<_> = dry
        .iter()
        .map(|h| height([h.value - 100.0, 0.0, 0.0]))
        .collect();
    let error = |heights: &[Height]| Cell::new(heights, 0.0, 12.0, 0, 0.0).error;
    assert!(error(&deep) < 1e-6, "too deep to be seen");
    let shallow: Vec<_> = dry
        .iter()
        .map(|h| height([h.value - 11.0, 0.0, 0.0]))
        .collect();
    assert!((error(&shallow) - 0.5 * error(&dry)).abs() < 0.02 * error(&dry));
}

#[test]
fn samples_hold_the_corners_and_the_middles() {
    let lattice = DetailLattice::new(
        GroundRect::square(bevy::math::DVec2::splat(1e6), 777.0),
        0.01,
    );
    let mut cell = lattice.root_cells().next().expect("a root");
    while let Some(child) = cell.child(2) {
        let samples: Vec<_> = sample_places(&lattice, cell).collect();
        let at = |i, j| samples[place_of_sample(i, j)];
        assert_eq!(at(MIDDLE, MIDDLE), lattice.point(cell.centre));
        for (k, (i, j)) in MIDS.into_iter().enumerate() {
            assert_eq!(at(i, j), lattice.point(cell.mid(k)));
        }
        let corners = [(0, 0), (STEPS, 0), (STEPS, STEPS), (0, STEPS)];
        for (k, (i, j)) in corners.into_iter().enumerate() {
            assert_eq!(at(i, j), lattice.point(cell.corner(k)));
        }
        cell = child;
    }
}
