//! Movers where nothing is kind: closed rooms full of triangles, numbers that are none, and the same moves by any number
//! of threads.

use super::*;

/// Never through a surface: thousands of wishes in a closed room full of triangles.
#[test]
fn hostile_rooms_hold_their_movers() {
    let mut random = Random::new(53);
    let mut crushed = 0;
    for room in 0..12 {
        let shift = if room % 3 == 2 {
            DVec3::new(1e5, 1e5, -1e5)
        } else {
            DVec3::ZERO
        };
        let walls = tree(TriangleMesh::cuboid(shift, Vec3::splat(4.0)).unwrap());
        let clutter: Vec<_> = soup(&mut random, 40, 3.5, if room % 2 == 0 { 1.5 } else { 0.2 })
            .into_iter()
            .map(|corners| corners.map(|c| c + shift))
            .collect();
        let clutter = tree(TriangleMesh::from_triangles(&clutter).unwrap());
        let bodies = [Body::fixed(&walls), Body::fixed(&clutter)];
        let mut walker = Walker::at([0.0; 3]);
        walker.settings.step_height = if room % 4 == 0 { 0.35 } else { 0.0 };
        walker.mover.radii = DVec3::new(
            size(&mut random, 0.1, 0.5),
            size(&mut random, 0.1, 0.9),
            0.3,
        );
        walker.mover.center = shift + place(&mut random, 3.0);
        // Moved out of what it was put into, it is somewhere in the room.
        walker.go(&bodies, DVec3::ZERO);
        let mut deepest = 0.0_f64;
        for step in 0..1500 {
            let wish = direction(&mut random) * size(&mut random, 1e-4, 10.0);
            let before = walker.mover.center;
            let c = walker.go(&bodies, wish);
            assert!(c.is_finite());
            let out = (c - shift).abs().max_element();
            assert!(out < 4.0, "{room} {step}: {before} {wish} {c}");
            if walker.outcome.crushed {
                crushed += 1;
            } else {
                deepest = deepest
                    .max(walker.depth(&bodies[0]))
                    .max(walker.depth(&bodies[1]));
            }
        }
        assert!(deepest <= 1e-4, "{room}: {deepest:e}");
    }
    // Said by everybody it would excuse any depth: here it is said of none but who is put into what is there.
    println!("crushed: {crushed}");
    assert!(crushed < 18, "{crushed} of 18 000");
}

#[test]
fn bad_movers_are_refused_and_the_others_go_on() {
    let ground = tree(floor(10, 1.0, |_, _| 0.0));
    let bodies = [
        Body::standing(&ground, Pose::at(DVec3::splat(f64::NAN))),
        Body::fixed(&ground),
    ];
    let nan = DVec3::splat(f64::NAN);
    let mut movers = [
        Mover::new(nan, FIGURE),
        Mover::new(DVec3::Y, DVec3::ZERO),
        Mover::new(DVec3::Y, FIGURE),
        Mover::new(DVec3::Y, FIGURE),
        // Within the ground, and outside of the world.
        Mover::new(DVec3::new(0.0, 0.2, 0.0), FIGURE),
        Mover::new(DVec3::splat(1e12), FIGURE),
        // Their squares are no numbers any more.
        Mover::new(DVec3::Y, FIGURE),
        Mover::new(DVec3::Y * 1e300, FIGURE),
    ];
    let wishes = [
        DVec3::X,
        DVec3::X,
        nan,
        DVec3::new(0.0, -1e6, 0.0),
        DVec3::ZERO,
        DVec3::NEG_Y,
        DVec3::Y * -1e300,
        DVec3::NEG_Y,
    ];
    let mut outcomes = vec![MoveOutcome::default(); 8];
    advance_all(
        &World::new(&bodies),
        &mut movers,
        &wishes,
        &MoveSettings::default(),
        &mut outcomes,
    );
    assert!(matches!(outcomes[0].error, Some(MoveError::Mover { .. })));
    assert!(matches!(outcomes[1].error, Some(MoveError::Mover { .. })));
    assert!(matches!(outcomes[2].error, Some(MoveError::Wish(_))));
    assert_eq!(movers[2].center, DVec3::Y);
    // An hour of falling ends on the ground.
    assert!(
        outcomes[3].grounded && (movers[3].center.y - 0.9).abs() < 1e-5,
        "{:?}",
        movers[3]
    );
    assert!((movers[4].center.y - 0.9).abs() < 1e-5, "{:?}", movers[4]);
    assert_eq!(outcomes[5].error, None);
    assert!(matches!(outcomes[6].error, Some(MoveError::Wish(_))));
    assert!(matches!(outcomes[7].error, Some(MoveError::Mover { .. })));
    let settings = MoveSettings {
        up: DVec3::ZERO,
        ..MoveSettings::default()
    };
    advance_all(
        &World::new(&bodies),
        &mut movers[3..4],
        &wishes[4..],
        &settings,
        &mut outcomes,
    );
    assert!(matches!(outcomes[0].error, Some(MoveError::Settings(_))));
    // Nothing at all.
    advance_all(
        &World::default(),
        &mut movers[3..4],
        &wishes[4..],
        &MoveSettings::default(),
        &mut outcomes,
    );
    assert_eq!((outcomes[0].error, outcomes[0].grounded), (None, false));
}

/// Steps and reaches that no place can be told over: refused, and the mover stays.
#[test]
fn settings_out_of_range_are_refused() {
    let ground = tree(floor(10, 1.0, |_, _| 0.0));
    let bodies = [Body::fixed(&ground)];
    let moved = |settings: MoveSettings| {
        let mut mover = Mover::new(DVec3::Y, FIGURE);
        mover.stands_on = Some(0);
        let mut outcome = MoveOutcome::default();
        let (world, mut scratch) = (World::new(&bodies), Scratch::default());
        let wish = DVec3::X * 0.1;
        advance(
            &world,
            &mut mover,
            wish,
            &settings,
            &mut scratch,
            &mut outcome,
        );
        (mover.center, outcome)
    };
    let none = [f64::NAN, f64::INFINITY, -f64::INFINITY, -1e300, -0.1];
    for value in none.into_iter().chain([1e300, f64::MAX, 1e8]) {
        type Set = fn(&mut MoveSettings, f64);
        let settings: [Set; 3] = [
            |settings, value| settings.walkable = value,
            |settings, value| settings.step_height = value,
            |settings, value| settings.snap = value,
        ];
        for (index, set) in settings.into_iter().enumerate() {
            let mut settings = MoveSettings::default();
            set(&mut settings, value);
            let (center, outcome) = moved(settings);
            assert!(
                matches!(outcome.error, Some(MoveError::Range { .. })),
                "{index} {value}: {outcome:?}"
            );
            assert_eq!(center, DVec3::Y);
            let said = outcome.error.expect("it was just seen").to_string();
            assert!(said.contains(&value.to_string()), "{value}: {said}");
        }
    }
    // Each by itself would do.
    let both = MoveSettings {
        step_height: 5e7,
        snap: 5e7,
        ..MoveSettings::default()
    };
    assert!(matches!(moved(both).1.error, Some(MoveError::Range { .. })));
    for up in [DVec3::splat(1e300), DVec3::Y * 1.1, DVec3::NAN] {
        let settings = MoveSettings {
            up,
            ..MoveSettings::default()
        };
        assert!(matches!(
            moved(settings).1.error,
            Some(MoveError::Settings(_))
        ));
    }
    // The counterpart: what they may be just so.
    for (walkable, heights) in [(0.0, 0.0), (1.0, 4.4e7)] {
        let settings = MoveSettings {
            walkable,
            step_height: heights,
            snap: heights,
            ..MoveSettings::default()
        };
        let (center, outcome) = moved(settings);
        assert_eq!(outcome.error, None, "{walkable} {heights}");
        assert!((center.x - 0.1).abs() < 1e-9, "{center}");
    }
}

/// As high as a step may be: a mover that was up there is set down as exactly as ever.
#[test]
fn the_highest_step_keeps_the_gap() {
    let ground = tree(floor(40, 1.0, |_, _| 0.0));
    let wall = cuboid([4.0, 1.5, 0.0], [0.5, 1.5, 5.0]);
    let bodies = [Body::fixed(&ground), Body::fixed(&wall)];
    let mut walker = Walker::at([0.0, 0.91, 0.0]);
    (walker.settings.step_height, walker.settings.snap) = (4.4e7, 4.4e7);
    walker.go(&bodies, DVec3::Y * -0.1);
    let mut highest = 0.0_f64;
    for step in 0..100 {
        let c = walker.go(&bodies, DVec3::new(0.08, -0.02, 0.0));
        assert!(walker.outcome.grounded, "{step} {c}");
        for body in &bodies {
            // Rounding takes some hundredths of the gap.
            assert_eq!(walker.depth(body), 0.0, "{step} {c}");
        }
        highest = highest.max(c.y);
    }
    // Over the wall of 3 m, and down on the other side.
    assert!((highest - 3.9).abs() < 1e-5, "{highest}");
    let c = walker.mover.center;
    assert!(c.x > 5.0 && (c.y - 0.9).abs() < 1e-5, "{c}");
}

fn hash_of_moves(threads: usize) -> u64 {
    ComputeTaskPool::get_or_init(|| TaskPoolBuilder::new().num_threads(threads).build());
    let mut random = Random::new(54);
    let ground = TriangleTree::new(
        floor(60, 0.5, |x, z| {
            0.3 * ((x * 0.7).fract() - (z * 0.3).fract()).abs()
        }),
        TreeSettings {
            kind: TreeKind::Octree,
            ..TreeSettings::default()
        },
    );
    let bodies = [Body::fixed(&ground)];
    let mut movers: Vec<Mover> = (0..1000)
        .map(|_| {
            Mover::new(
                place(&mut random, 12.0) * DVec3::new(1.0, 0.0, 1.0) + DVec3::Y * 2.0,
                FIGURE,
            )
        })
        .collect();
    let mut outcomes = vec![MoveOutcome::default(); movers.len()];
    let wishes: Vec<DVec3> = movers
        .iter()
        .map(|_| place(&mut random, 0.1) - DVec3::Y * 0.05)
        .collect();
    let mut hash = Hash64::default();
    for _ in 0..30 {
        advance_all(
            &World::new(&bodies),
            &mut movers,
            &wishes,
            &MoveSettings::default(),
            &mut outcomes,
        );
    }
    for (mover, outcome) in movers.iter().zip(&outcomes) {
        mover
            .center
            .to_array()
            .iter()
            .for_each(|x| hash.add(x.to_bits()));
        hash.add(u64::from(outcome.grounded) + 2 * u64::from(outcome.iterations));
    }
    let grounded = outcomes.iter().filter(|outcome| outcome.grounded).count();
    assert!(grounded > 500, "{grounded}");
    hash.finish()
}

const HASH: u64 = 3_738_107_886_644_932_815;

#[test]
fn one_thread_moves_the_same() {
    assert_eq!(hash_of_moves(1), HASH);
}

#[test]
fn two_threads_move_the_same() {
    assert_eq!(hash_of_moves(2), HASH);
}
