//! Ground that is edited while it is drawn in blocks: on whatever adapter there is those are made anew that the edit reaches, and
//! what these have in common with finer ones is refreshed there, as by the CPU reference, and no more.

use super::reference::{differences, made_again};
use super::support::{MOST, closed, laid_on_samples, mountain, params, terrain, view, view_at};
use bevy::math::DVec2;
use dolomite_ground::blocks::changed::{EditReach, edited_lines, meets};
use dolomite_ground::blocks::kept::KeptBlocks;
use dolomite_ground::blocks::record::Block;
use dolomite_ground::blocks::remade::Remade;
use dolomite_ground::detail::layout::{DetailParams, EditedRect};
use dolomite_ground::detail::{DetailGround, Metric, TerrainLod};
use dolomite_terrain::{Edit, EditKind, Edits, GroundRect, Terrain, TerrainEdits};
use dolomite_testkit::blocks::{BlockStage, MadeBlock, PassTime, RemadeBlocks};
use dolomite_testkit::gpu::for_test;
use std::collections::HashMap;

/// Side of the smallest cell, metres.
const FINEST: f32 = 0.5;

/// Ground that has a layer of edits in which nothing is yet, and its history.
fn editable(ground: &Terrain) -> (Terrain, TerrainEdits) {
    let edits = TerrainEdits::new(ground).expect("fits");
    let none = Edits::none(*edits.lattice());
    (ground.with_edits(Some(none)), edits)
}

fn brush(kind: EditKind, place: DVec2, radius: f64, strength: f64) -> Edit {
    Edit {
        kind,
        place,
        radius,
        strength,
        falloff: 0.7,
    }
}

/// Some strokes before the eye of [`view`] and behind it, one over the other.
fn strokes() -> [Edit; 5] {
    let eye = DVec2::new(1e5 + 37.25, -1e5 - 110.5);
    let at = |x: f64, z: f64| eye + DVec2::new(x, z);
    [
        brush(EditKind::Lower, at(0.0, -30.0), 8.0, 5.0),
        brush(EditKind::Raise, at(6.0, -60.0), 20.0, 6.0),
        brush(EditKind::Smooth, at(10.0, -45.0), 15.0, 1.0),
        brush(
            EditKind::Flatten { height: None },
            at(-4.0, 40.0),
            12.0,
            1.0,
        ),
        brush(EditKind::Lower, at(250.0, -300.0), 60.0, 30.0),
    ]
}

/// All that is kept of a block, to the bit, but for what says which choice looked at it.
fn words(block: &Block) -> Vec<u32> {
    let head = &block.head;
    let place = [head.centre.x, head.centre.y, head.half, head.parent];
    let numbers = [head.mixed_error, head.low, head.high];
    let parts = [
        &block.heights[..],
        &block.errors,
        &block.lows,
        &block.highs,
        &block.ring_errors,
        &block.cell_lows,
        &block.cell_highs,
        &numbers,
    ];
    let floats = parts.into_iter().flatten().map(|number| number.to_bits());
    place
        .into_iter()
        .chain(head.children)
        .chain(block.gradients)
        .chain(floats)
        .collect()
}

/// By their places, without slots.
fn by_place(blocks: &[MadeBlock]) -> HashMap<[u32; 2], Vec<u32>> {
    let of = |made: &MadeBlock| {
        let mut block = made.block.clone();
        block.head.parent = 0;
        block.head.children = [0; 4];
        (block.head.centre.to_array(), words(&block))
    };
    blocks.iter().map(of).collect()
}

/// How many blocks two grounds have in common by their places, and how many of these are others.
fn compared(ours: &[MadeBlock], theirs: &[MadeBlock]) -> [usize; 2] {
    let (ours, theirs) = (by_place(ours), by_place(theirs));
    let both = ours
        .iter()
        .filter_map(|(place, block)| Some((block, theirs.get(place)?)));
    let others = both.clone().filter(|(ours, theirs)| ours != theirs).count();
    [both.count(), others]
}

/// Two looks, north and south.
fn looks(laid: &DetailGround) -> [DetailParams; 2] {
    let metric = Metric::ErrorBound { pixels: 3.0 };
    [0.0, 3.0].map(|yaw| params(laid, view(laid.terrain(), yaw, 3.0, metric)))
}

/// A stage on which all is made that two looks ask for.
fn settled<'a>(
    gpu: &'a dolomite_testkit::gpu::Gpu,
    laid: &DetailGround,
    looks: &[DetailParams; 2],
) -> BlockStage<'a> {
    let mut stage = BlockStage::new(gpu, laid, 4096).expect("passes");
    for look in looks {
        stage.settle(*look, 64, MOST).expect("runs");
    }
    stage
}

/// How many blocks have samples that an edit reaches.
fn reached(blocks: &[MadeBlock], lines: &[EditedRect]) -> u32 {
    let places = blocks
        .iter()
        .map(|made| made.block.head.place().expect("a block"));
    places.filter(|&place| meets(place, lines)).count() as u32
}

/// As much is made anew as is reached, and half as much more at most: what cuts by coarse cells that have become others.
fn in_proportion(remade: RemadeBlocks, reached: u32) {
    let RemadeBlocks { made, dropped, .. } = remade;
    assert!(
        dropped == 0 && made >= reached && 2 * made <= 3 * reached,
        "{remade:?}, {reached} reached"
    );
}

/// After each of some strokes: blocks in their slots, made anew as by the CPU reference, and those of ground that has always been
/// so; the mesh is closed; and when all is taken back, all is what it was, to the bit.
#[test]
fn gpu_blocks_that_an_edit_reaches_are_made_anew_as_on_the_cpu_and_undone_to_the_bit() {
    let Some(gpu) = for_test() else { return };
    let (ground, mut edits) = editable(&terrain());
    let laid = laid_on_samples(&ground, FINEST);
    let looks = looks(&laid);
    let mut stage = settled(&gpu, &laid, &looks);
    let before = stage.blocks().expect("read");
    let mut kept = KeptBlocks::on(ground.clone(), laid.lattice);
    made_again(&mut kept, &before);
    let mut now = ground;
    for stroke in strokes() {
        let next = edits.apply(&now, &stroke).expect("valid").terrain;
        let changed = next.changed_since(&now).expect("the same ground");
        let reach = EditReach::between(&now, &next, &laid.lattice);
        let reached = reached(&before, &edited_lines(&laid.lattice, reach, &changed));
        now = next;
        stage.edit(&now);
        let run = stage.run(looks[0], 0).expect("runs");
        closed(&run);
        let remade = stage.remade().expect("read");
        let theirs = kept.change(now.clone(), FINEST, &changed);
        let all = before.len() as u32;
        println!("{reached} of {all} blocks reached; {remade:?}, {theirs:?} on the CPU");
        in_proportion(remade, reached);
        assert!(reached > 4 && remade.refreshed > 0, "{remade:?}");
        assert!(remade.made + remade.refreshed <= all, "{remade:?}");
        // A record that differs by roundings alone makes children others on one side.
        let Remade { made, refreshed } = theirs;
        let off = remade.made.abs_diff(made as u32);
        let off = off.max(remade.refreshed.abs_diff(refreshed as u32));
        assert!(off <= 2 + remade.made / 20, "{remade:?} {theirs:?}");
        let after = stage.blocks().expect("read");
        assert_eq!(after.len(), before.len());
        let slots = kept.by_place();
        let mut largest = [0.0_f32; 3];
        for (made, was) in after.iter().zip(&before) {
            let (head, old) = (made.block.head, was.block.head);
            assert_eq!(
                (
                    made.slot,
                    head.centre,
                    head.half,
                    head.parent,
                    head.children
                ),
                (was.slot, old.centre, old.half, old.parent, old.children)
            );
            let found = differences(&made.block, kept.block(slots[&head.centre]));
            largest = std::array::from_fn(|k| largest[k].max(found[k]));
        }
        println!("largest differences from the CPU: {largest:?} m");
        // As without edits, see reference.rs.
        assert!(
            largest[0] < 1e-4 && largest[1] < 1e-3 && largest[2] < 1e-3,
            "{largest:?}"
        );
        let fresh = settled(&gpu, &laid_on_samples(&now, FINEST), &looks);
        let [both, others] = compared(&after, &fresh.blocks().expect("read"));
        assert!(
            both * 10 > before.len() * 9 && others == 0,
            "{others} of {both}"
        );
    }
    while let Some(undone) = edits.undo(&now) {
        now = undone;
        stage.edit(&now);
        stage.run(looks[0], 0).expect("runs");
    }
    let undone = stage.blocks().expect("read");
    assert_eq!(undone.len(), before.len());
    for (undone, was) in undone.iter().zip(&before) {
        assert!(
            words(&undone.block) == words(&was.block),
            "slot {}",
            was.slot
        );
    }
}

/// The comparison above sees a block that was not made anew.
#[test]
fn gpu_blocks_of_a_wrong_rectangle_stay_those_of_the_old_ground() {
    let Some(gpu) = for_test() else { return };
    let (ground, mut edits) = editable(&terrain());
    let laid = laid_on_samples(&ground, FINEST);
    let looks = looks(&laid);
    let [stroke, ..] = strokes();
    let now = edits.apply(&ground, &stroke).expect("valid").terrain;
    let fresh = settled(&gpu, &laid_on_samples(&now, FINEST), &looks);
    let fresh = fresh.blocks().expect("read");
    // One that no block stands on: where a coarse one is made anew, so is what lies in it and has become another.
    let elsewhere = GroundRect::square(stroke.place + DVec2::new(0.0, 9000.0), 16.0);
    for (rect, is_right) in [
        (elsewhere, false),
        (GroundRect::square(stroke.place, 40.0), true),
    ] {
        let mut stage = settled(&gpu, &laid, &looks);
        stage.edit_within(&now, &[rect]);
        stage.run(looks[0], 0).expect("runs");
        let [both, others] = compared(&stage.blocks().expect("read"), &fresh);
        println!("{others} of {both} are others");
        assert_eq!(others == 0, is_right, "{others} of {both}");
    }
}

/// Strokes that gather before the GPU takes them over, more than it is told one by one; and one of which more blocks wait than
/// may be made anew: the rest is dropped and comes back, and the mesh is closed all the while.
#[test]
fn gpu_blocks_follow_many_strokes_and_what_is_too_much_comes_back() {
    let Some(gpu) = for_test() else { return };
    let (ground, mut edits) = editable(&terrain());
    let laid = laid_on_samples(&ground, FINEST);
    let looks = looks(&laid);
    let mut stage = settled(&gpu, &laid, &looks);
    let all = stage.blocks().expect("read").len();
    let mut now = ground;
    let eye = DVec2::new(1e5 + 37.25, -1e5 - 110.5);
    for k in 0..40 {
        let way = DVec2::from_angle(f64::from(k) * 2.4) * f64::from(k) * 9.0;
        let stroke = brush(EditKind::Raise, eye + way, 4.0, 1.0);
        now = edits.apply(&now, &stroke).expect("valid").terrain;
        stage.edit(&now);
    }
    closed(&stage.run(looks[0], 0).expect("runs"));
    println!(
        "40 strokes, {all} blocks: {:?}",
        stage.remade().expect("read")
    );
    let fresh = settled(&gpu, &laid_on_samples(&now, FINEST), &looks);
    let [both, others] = compared(
        &stage.blocks().expect("read"),
        &fresh.blocks().expect("read"),
    );
    assert!(both * 10 > all * 8 && others == 0, "{others} of {both}");

    // By as many as a slow device makes.
    let flat = EditKind::Flatten { height: Some(12.0) };
    now = edits
        .apply(&now, &brush(flat, eye, 900.0, 1.0))
        .expect("valid")
        .terrain;
    stage.edit(&now);
    stage.most_remade = Some(20);
    let run = stage.run(looks[0], 0).expect("runs");
    closed(&run);
    let remade = stage.remade().expect("read");
    println!("{remade:?} of {all}, coarsening {}", run.coarsening);
    assert!(remade.made == 20 && remade.dropped > 100 && run.coarsening > 1.0);
    assert_eq!(run.used as usize + remade.dropped as usize, all);
    let (run, _) = stage.settle(looks[0], 64, MOST).expect("runs");
    assert_eq!(run.coarsening, 1.0);
    closed(&run);
    let fresh = settled(&gpu, &laid_on_samples(&now, FINEST), &looks);
    let [both, others] = compared(
        &stage.blocks().expect("read"),
        &fresh.blocks().expect("read"),
    );
    assert!(both > 20 && others == 0, "{others} of {both}");
}

/// How many blocks strokes of a size make anew on 16 km of ground, and what the passes take beside a frame without: printed.
#[test]
#[ignore = "prints counts and times, for minutes"]
fn gpu_counts_of_blocks_that_strokes_make_anew() {
    let Some(gpu) = for_test() else { return };
    let (ground, mut edits) = editable(&mountain());
    let laid = laid_on_samples(&ground, TerrainLod::default().finest);
    let place = DVec2::new(1000.0, -2000.0);
    let seen = view_at(&ground, place, 1.7, [0.0, -0.1], 2.0);
    let given = DetailParams::new(&laid, seen, 0, [1 << 19, 1 << 20]);
    let mut stage = BlockStage::new(&gpu, &laid, 8192).expect("passes");
    let (run, _) = stage.settle(given, 64, MOST).expect("runs");
    stage.timed = true;
    let total = |passes: &[PassTime]| {
        passes
            .iter()
            .map(|pass| pass.time.as_secs_f64() * 1e3)
            .sum::<f64>()
    };
    let without = (0..5).map(|_| total(&stage.run_unread(given, 0).expect("runs").passes));
    let without = without.fold(f64::INFINITY, f64::min);
    println!(
        "{} blocks, {} drawn; {without:.1} ms without an edit",
        run.used, run.drawn
    );
    let reach = EditReach::new(&ground, &laid.lattice);
    println!("{reach:?}");
    // As many at most as a device makes of whom nothing is known, in four frames.
    let slow = 64;
    let mut last = 0;
    for (radius, ahead) in [(5.0, 30.0), (20.0, 60.0), (80.0, 120.0), (20.0, 3000.0)] {
        let at = place + DVec2::new(0.0, -ahead);
        let stroke = brush(EditKind::Lower, at, radius, 0.2 * radius);
        let now = edits.apply(&ground, &stroke).expect("valid").terrain;
        let changed = now.changed_since(&ground).expect("the same ground");
        let lines = edited_lines(&laid.lattice, reach, &changed);
        let reached = reached(&stage.blocks().expect("read"), &lines);
        stage.edit(&now);
        let passes = stage.run_unread(given, 0).expect("runs").passes;
        let with = total(&passes);
        let refreshing = passes.iter().filter(|pass| pass.entry == "refresh_blocks");
        let refreshing: Vec<_> = refreshing.copied().collect();
        let remade = stage.remade().expect("read");
        println!(
            "radius {radius} m, {ahead} m ahead: {reached} reached, {remade:?}; {with:.1} ms, {:.2} of them refreshing, {} dispatches",
            total(&refreshing),
            passes.len()
        );
        in_proportion(remade, reached);
        if ahead < 1000.0 {
            assert!(reached > last, "{reached} after {last}");
            last = reached;
        }
        let back = edits.undo(&now).expect("a step");
        stage.edit(&back);
        stage.most_remade = Some(slow);
        stage.run_unread(given, 0).expect("runs");
        println!(
            "undone by {slow} at most: {:?}",
            stage.remade().expect("read")
        );
        stage.most_remade = None;
        stage.settle(given, 64, MOST).expect("runs");
    }
    // Beyond all that is kept.
    let far = GroundRect::square(DVec2::new(30_000.0, 0.0), 40.0);
    assert_eq!(edited_lines(&laid.lattice, reach, &[far]), []);
}
