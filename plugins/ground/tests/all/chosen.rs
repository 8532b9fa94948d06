//! Ground that is chosen in blocks, in an app: coarse at once, finer from frame to frame, then at rest.

use crate::app;
use crate::app::bytes;
use crate::app::seen::{PIXELS, Seen, detail, hills, meadow};

use bevy::prelude::*;
use dolomite_geometry::GeometryStats;
use dolomite_ground::TerrainView;
use dolomite_ground::detail::{MakingBudget, Metric, TerrainLod};
use dolomite_ground::render::DrawnProbeStats;
use dolomite_terrain::GroundProbe;

fn place(x: f32) -> Transform {
    Transform::from_xyz(x, 70.0, 300.0).looking_at(Vec3::new(0.0, 0.0, -100.0), Vec3::Y)
}

/// Hills, of which so many blocks are made in a frame.
fn seen(blocks: Option<u32>) -> Option<Seen> {
    Seen::new(&hills(), place(0.0), blocks)
}

/// The picture, kept for whoever wants to look: as PPM in the folder `DOLOMITE_PICTURES`.
fn shot(seen: &mut Seen, name: &str) -> Image {
    let picture = seen.picture();
    if let Some(folder) = std::env::var_os("DOLOMITE_PICTURES") {
        let [width, height] = [picture.width(), picture.height()];
        let mut bytes = format!("P6 {width} {height} 255\n").into_bytes();
        bytes.extend(pixels(&picture).flat_map(|[r, g, b, _]| [r, g, b]));
        let file = std::path::Path::new(&folder).join(format!("{name}.ppm"));
        std::fs::write(file, bytes).expect("the folder is there");
    }
    picture
}

fn pixels(image: &Image) -> impl Iterator<Item = [u8; 4]> {
    let data = image.data.as_ref().expect("pixels");
    data.as_chunks::<4>().0.iter().copied()
}

/// Share of the pixels where there is ground in one picture and none in the other; mean difference of the channels elsewhere.
fn difference(a: &Image, b: &Image) -> (f64, f64) {
    let is_sky = |pixel: [u8; 4]| pixel[..3] == [0, 0, 0];
    let (mut borders, mut sum, mut count) = (0.0, 0.0, 0.0);
    for (a, b) in pixels(a).zip(pixels(b)) {
        count += 1.0;
        if is_sky(a) == is_sky(b) {
            let apart = (0..3).map(|k| f64::from(a[k].abs_diff(b[k])));
            sum += apart.sum::<f64>() / 3.0;
        } else {
            borders += 1.0;
        }
    }
    (borders / count, sum / count)
}

#[test]
fn gpu_blocks_draw_coarse_ground_at_once_and_rest_when_all_is_made() {
    let Some(mut seen) = seen(Some(24)) else {
        return;
    };
    let held = seen.rest();
    println!("held {held:?}");
    let known: Vec<f32> = held.iter().copied().flatten().collect();
    assert!(held.len() > 6 && known.len() > 3, "{held:?}");
    // Coarse at first; each block that is made brings it closer.
    assert!(known[0] > 2.0 * PIXELS);
    assert!(known.windows(2).all(|pair| pair[1] <= pair[0]), "{held:?}");
    assert_eq!(known.last(), Some(&PIXELS));
    let finest = shot(&mut seen, "finest");
    for _ in 0..6 {
        let ground = seen.frame().expect("ground");
        assert!(ground.settled && ground.held == Some(PIXELS));
        assert_eq!(seen.dispatches(), 0, "at rest");
    }

    // Elsewhere: drawn in every frame, and at rest again.
    seen.set(Transform::from_xyz(-350.0, 60.0, -350.0).looking_at(Vec3::ZERO, Vec3::Y));
    let ground = seen.frame().expect("ground");
    assert!(ground.drawn && !ground.settled, "{ground:?}");
    // What is counted arrives with the next frame.
    seen.frame();
    let dispatches = seen.dispatches();
    assert!(dispatches > 0 && dispatches <= 20, "{dispatches}");
    let held = seen.rest();
    assert_eq!(held.last(), Some(&Some(PIXELS)));
    // And back: all that it takes is still there.
    seen.set(place(0.0));
    let held = seen.rest();
    assert!(held.len() < 8, "{held:?}");
    assert!(finest.data == seen.picture().data, "the same to the byte");
}

#[test]
fn gpu_coarser_ground_has_the_shapes_of_finer_and_nothing_that_is_seen_is_left_out() {
    // As many as this device makes in its time.
    let Some(mut seen) = seen(None) else {
        return;
    };
    seen.rest();
    let coarse = shot(&mut seen, "coarse");
    // What is left out of view is not seen without that either.
    for (culled, occluded) in [(false, false), (true, false)] {
        seen.set(TerrainLod {
            culled,
            occluded,
            ..detail()
        });
        seen.rest();
        assert!(coarse.data == seen.picture().data, "the same to the byte");
    }
    let blocks = Some(u32::MAX);
    seen.app.insert_resource(MakingBudget { blocks });
    seen.set(TerrainLod {
        metric: Metric::ErrorBound {
            pixels: PIXELS / 4.0,
        },
        ..detail()
    });
    seen.rest();
    let fine = shot(&mut seen, "fine");
    let (borders, mean) = difference(&coarse, &fine);
    println!("{borders} of the pixels show ground in one alone, {mean} apart");
    // One errs by two pixels of 90 lines at most.
    // Finer ground has slopes that coarser has not.
    assert!(borders < 0.02 && mean < 8.0);
    assert!(coarse.data != fine.data, "each by its own triangles");
}

#[test]
fn gpu_without_time_or_room_blocks_draw_what_there_is() {
    let Some(mut seen) = seen(Some(0)) else {
        return;
    };
    let held = seen.rest().last().copied().flatten();
    assert!(held.is_some_and(|held| held > 4.0 * PIXELS), "{held:?}");
    let coarsest = shot(&mut seen, "coarsest");
    assert_eq!(seen.frame().map(|ground| ground.settled), Some(true));
    assert_eq!(seen.dispatches(), 0);
    // Little room for vertices, and for blocks with it.
    seen.app.insert_resource(MakingBudget { blocks: Some(64) });
    seen.set(TerrainLod {
        metric: Metric::ErrorBound { pixels: 0.25 },
        max_vertices: 1 << 12,
        ..detail()
    });
    let frames = seen.rest();
    let held = frames.last().copied().flatten();
    println!(
        "held {held:?} with 4096 vertices, after {} frames",
        frames.len()
    );
    assert!(held.is_some_and(|held| held > 0.5), "{held:?}");
    // What is counted arrives with the next frame.
    seen.frame();
    let stats = seen.app.world().resource::<GeometryStats>().clone();
    assert!(stats.vertices <= 1 << 12, "{}", stats.vertices);
    assert_eq!(stats.dispatches, 0);
    // As much as a view may have.
    let blocks = Some(u32::MAX);
    seen.app.insert_resource(MakingBudget { blocks });
    seen.set(detail());
    let held = seen.rest();
    assert_eq!(held.last(), Some(&Some(PIXELS)));
    // All in the first frame; counters come back in the third or fourth.
    assert!(held.len() <= 6, "{held:?}");
    let (borders, _) = difference(&coarsest, &seen.picture());
    // The coarsest shows the same hills.
    assert!(borders < 0.1, "{borders}");
}

#[test]
fn gpu_blocks_are_kept_once_within_their_memory() {
    let Some(mut seen) = seen(Some(0)) else {
        return;
    };
    seen.rest();
    let (shared, one) = bytes(&seen.app);
    println!("{shared} bytes a terrain, {one:?} a view");
    // As `TerrainLod::max_vertices` says; the ground's own data and its relief map are less than 1 MiB here.
    assert!(shared <= 96 << 20, "{shared} bytes a terrain");
    assert!(one.len() == 1 && one[0] <= 4 << 20, "{one:?} bytes a view");
    // A second camera shares them; a second terrain has its own.
    let target = app::target(&mut seen.app, 32, 32);
    app::camera(&mut seen.app, &target, (TerrainView, detail(), place(50.0)));
    app::frames(&mut seen.app, 12);
    let (both, two) = bytes(&seen.app);
    // The relief map comes when it has been made.
    assert!(both - shared < 1 << 20 && two.len() == 2, "{both} {two:?}");
    seen.app.world_mut().spawn((hills(), meadow()));
    app::frames(&mut seen.app, 12);
    let (twice, four) = bytes(&seen.app);
    assert!(
        twice > 2 * shared - (1 << 20) && four.len() == 4,
        "{twice} {four:?}"
    );
    // Where less is allowed less is kept.
    let mut cameras = seen
        .app
        .world_mut()
        .query_filtered::<Entity, With<TerrainView>>();
    let cameras: Vec<Entity> = cameras.iter(seen.app.world()).collect();
    for camera in cameras {
        seen.app.world_mut().entity_mut(camera).insert(TerrainLod {
            max_vertices: 1 << 10,
            ..detail()
        });
    }
    app::frames(&mut seen.app, 8);
    let (least, _) = bytes(&seen.app);
    assert!(least < 16 << 20, "{least}");
}

#[test]
fn gpu_pools_of_blocks_grow_as_a_view_needs_them() {
    let Some(mut seen) = seen(Some(u32::MAX)) else {
        return;
    };
    seen.rest();
    let (_, before) = bytes(&seen.app);
    println!("{before:?} bytes at {PIXELS} px");
    assert!(before[0] <= 8 << 20, "{before:?} bytes a view");
    // Ten times as many vertices, for which there is no room at first: the tolerance says so, and nothing is missing.
    let pixels = 0.25;
    let finer = TerrainLod {
        metric: Metric::ErrorBound { pixels },
        ..detail()
    };
    seen.set(finer);
    let held = seen.rest();
    println!("held {held:?}");
    assert!(held.iter().flatten().any(|&held| held > pixels), "{held:?}");
    assert_eq!(held.last(), Some(&Some(pixels)));
    let (_, after) = bytes(&seen.app);
    let vertices = seen.app.world().resource::<GeometryStats>().vertices;
    println!("{after:?} bytes at {pixels} px, {vertices} vertices drawn");
    assert!(after[0] > before[0] + (1 << 20), "{before:?} {after:?}");
    // Not more than a view may have.
    let room = 1 << 14;
    seen.set(TerrainLod {
        max_vertices: room,
        ..finer
    });
    let held = seen.rest();
    assert!(held.last().copied().flatten() > Some(pixels), "{held:?}");
    let (_, least) = bytes(&seen.app);
    assert!(least[0] < before[0], "{least:?}");
}

#[test]
fn gpu_probes_find_the_triangles_of_blocks() {
    let Some(mut seen) = seen(Some(u32::MAX)) else {
        return;
    };
    // In the picture, at some 100 to 400 m.
    let probes: Vec<Entity> = (0..64_u8)
        .map(|k| {
            let at = (
                f32::from(k % 8) * 11.3 - 40.0,
                f32::from(k / 8) * -37.7 + 190.0,
            );
            let place = Transform::from_xyz(at.0, 0.0, at.1);
            let probe = (GroundProbe::default(), place);
            seen.app.world_mut().spawn(probe).id()
        })
        .collect();
    seen.rest();
    app::frames(&mut seen.app, 6);
    let before = *seen.app.world().resource::<DrawnProbeStats>();
    assert_eq!((before.asked, before.drawn), (64, 64), "{before:?}");
    let mut farthest = 0.0_f64;
    for probe in probes {
        let probe = seen.app.world().get::<GroundProbe>(probe).expect("there");
        let (found, truth) = (probe.drawn.expect("drawn"), probe.sample.expect("true"));
        let off = (found.sample.height - truth.height).abs();
        assert!(off <= found.bound, "{off} of {}", found.bound);
        farthest = farthest.max(off);
    }
    // A drawn triangle is not the true ground: two pixels of 180 lines are metres at that distance.
    println!("up to {farthest} m from the true ground");
    assert!(farthest > 0.05 && farthest < 10.0, "{farthest}");
    app::frames(&mut seen.app, 6);
    let after = *seen.app.world().resource::<DrawnProbeStats>();
    assert_eq!(
        after.dispatches, before.dispatches,
        "at rest nothing is asked anew"
    );
}
