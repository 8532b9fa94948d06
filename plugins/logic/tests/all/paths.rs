//! Ways for one, beside the shortest: a graph of all corners that see each other, in f64.

use bevy::math::{IVec2, UVec2, Vec2};
use dolomite_logic::movement::{PathScratch, UNITS, WalkGrid, find_path, is_clear, path_length};
use dolomite_logic::random::Random;

fn random_grid(random: &mut Random, side: u32, closed: f32) -> WalkGrid {
    let mut grid =
        WalkGrid::flat(Vec2::new(-3.0, 7.0), 0.5, UVec2::splat(side)).expect("the test made it so");
    // Walls of some cells, along an axis, and single cells.
    let count = (side * side) as f32 * closed / 4.0;
    for _ in 0..count as u32 {
        let at = IVec2::new(random.below(side) as i32, random.below(side) as i32);
        let way = if random.bits() & 1 == 0 {
            IVec2::X
        } else {
            IVec2::Y
        };
        for i in 0..1 + random.below(7) as i32 {
            grid.set(at + way * i, false);
        }
    }
    grid
}

fn open_place(grid: &WalkGrid, random: &mut Random) -> Vec2 {
    loop {
        let span = grid.size().as_vec2() * grid.cell();
        let at = grid.origin() + Vec2::new(random.unit(), random.unit()) * span;
        if grid.is_open(at) {
            return at;
        }
    }
}

fn units(grid: &WalkGrid, at: Vec2) -> [i64; 2] {
    let at = ((at - grid.origin()) / grid.cell() * UNITS as f32).round();
    [at.x as i64, at.y as i64]
}

/// The length of the shortest way, metres: A* over all corners that stick out, each seen by each. Slow and simple.
fn shortest(grid: &WalkGrid, corners: &[[i64; 2]], from: Vec2, to: Vec2) -> Option<f64> {
    let mut places = corners.to_vec();
    places.push(units(grid, from));
    places.push(units(grid, to));
    let (start, goal) = (places.len() - 2, places.len() - 1);
    let apart = |a: usize, b: usize| {
        let (x, z) = (places[a][0] - places[b][0], places[a][1] - places[b][1]);
        ((x * x + z * z) as f64).sqrt()
    };
    let mut lengths = vec![f64::INFINITY; places.len()];
    let mut done = vec![false; places.len()];
    lengths[start] = 0.0;
    loop {
        let open = (0..places.len()).filter(|&i| !done[i] && lengths[i].is_finite());
        let key = |i: &usize| lengths[*i] + apart(*i, goal);
        let next = open.min_by(|a, b| key(a).total_cmp(&key(b)))?;
        if next == goal {
            return Some(lengths[goal] / UNITS as f64 * f64::from(grid.cell()));
        }
        done[next] = true;
        for other in 0..places.len() {
            let length = lengths[next] + apart(next, other);
            if !done[other]
                && length < lengths[other]
                && is_clear(grid, places[next], places[other])
            {
                lengths[other] = length;
            }
        }
    }
}

/// Corners at which exactly one of four cells is closed: the shortest way turns nowhere else.
fn corners(grid: &WalkGrid) -> Vec<[i64; 2]> {
    let mut all = Vec::new();
    let size = grid.size().as_ivec2();
    for z in 0..=size.y {
        for x in 0..=size.x {
            let cells = [
                IVec2::new(x - 1, z - 1),
                IVec2::new(x, z - 1),
                IVec2::new(x - 1, z),
                IVec2::new(x, z),
            ];
            let closed = cells
                .iter()
                .filter(|cell| !grid.is_walkable(**cell))
                .count();
            if closed == 1 {
                all.push([i64::from(x) * UNITS, i64::from(z) * UNITS]);
            }
        }
    }
    all
}

#[test]
fn lines_are_clear_where_a_thousand_places_on_them_are() {
    let mut random = Random::new(2);
    let grid = random_grid(&mut random, 24, 0.25);
    let (mut clear, mut blocked) = (0, 0);
    for _ in 0..4000 {
        let ends = [0; 2].map(|_| units(&grid, open_place(&grid, &mut random)));
        let [a, b] = ends;
        let answer = is_clear(&grid, a, b);
        assert_eq!(answer, is_clear(&grid, b, a), "the same from either end");
        // Places in the open inside of cells, by exact integers: a place is (a (n - i) + b i) / n.
        let n = 1009;
        let closed = (0..=n).any(|i| {
            let cell = |axis: usize| {
                let at = a[axis] * (n - i) + b[axis] * i;
                let inside = at.rem_euclid(UNITS * n) != 0;
                inside.then(|| at.div_euclid(UNITS * n) as i32)
            };
            cell(0)
                .zip(cell(1))
                .is_some_and(|(x, z)| !grid.is_walkable(IVec2::new(x, z)))
        });
        if answer {
            clear += 1;
            assert!(!closed, "{a:?} {b:?}");
        } else {
            blocked += 1;
        }
    }
    assert!(clear > 300 && blocked > 300, "{clear} {blocked}");
}

#[test]
fn between_two_that_meet_in_a_corner_nobody_passes() {
    let mut grid = WalkGrid::flat(Vec2::ZERO, 1.0, UVec2::splat(4)).expect("the test made it so");
    grid.set(IVec2::new(1, 2), false);
    grid.set(IVec2::new(2, 1), false);
    let u = UNITS;
    assert!(!is_clear(&grid, [u + 9, u + 9], [3 * u - 9, 3 * u - 9]));
    assert!(is_clear(&grid, [u, 2 * u], [2 * u, 2 * u]), "along a side");
    assert!(
        !is_clear(&grid, [u, 2 * u], [3 * u, 2 * u]),
        "from below one to above the other"
    );
    let way = find_path(
        &grid,
        Vec2::splat(1.5),
        Vec2::splat(2.5),
        &mut PathScratch::default(),
    );
    assert!(path_length(&way.expect("around")) > 3.0);
    grid.set(IVec2::new(0, 3), false);
    grid.set(IVec2::new(3, 0), false);
    let none = find_path(
        &grid,
        Vec2::splat(1.5),
        Vec2::splat(2.5),
        &mut PathScratch::default(),
    );
    assert_eq!(none, None, "a diagonal wall has no hole");
    assert_eq!(
        find_path(&grid, Vec2::NAN, Vec2::ONE, &mut PathScratch::default()),
        None
    );
    assert_eq!(
        find_path(
            &grid,
            Vec2::ONE,
            Vec2::new(2.5, 1.5),
            &mut PathScratch::default()
        ),
        None
    );
}

#[test]
fn ways_are_nearly_the_shortest_and_none_is_missed() {
    let mut random = Random::new(4);
    let mut scratch = PathScratch::default();
    let (mut sum, mut worst, mut count, mut none) = (0.0, 1.0_f64, 0, 0);
    for number in 0..24 {
        let grid = random_grid(&mut random, 40, 0.1 + 0.02 * (number % 8) as f32);
        let corners = corners(&grid);
        for _ in 0..24 {
            let (from, to) = (
                open_place(&grid, &mut random),
                open_place(&grid, &mut random),
            );
            let best = shortest(&grid, &corners, from, to);
            let Some(path) = find_path(&grid, from, to, &mut scratch) else {
                assert_eq!(best, None, "there is a way");
                none += 1;
                continue;
            };
            let best = best.expect("a way that is none");
            assert_eq!((path[0], path[path.len() - 1]), (from, to));
            for pair in path.windows(2) {
                assert!(is_clear(
                    &grid,
                    units(&grid, pair[0]),
                    units(&grid, pair[1])
                ));
            }
            // Ends are rounded to 1/512 of a cell.
            let ratio = path_length(&path) / best;
            assert!(
                path_length(&path) > best - 0.01,
                "shorter than the shortest"
            );
            if best > 1.0 {
                sum += ratio;
                count += 1;
                worst = worst.max(ratio);
            }
        }
    }
    println!(
        "{count} ways: {:.5} of the shortest on the mean, {worst:.4} at most; {none} without",
        sum / f64::from(count)
    );
    assert!(count > 300 && none > 0, "{count} {none}");
    assert!(sum / f64::from(count) <= 1.02 && worst <= 1.10, "{worst}");
}
