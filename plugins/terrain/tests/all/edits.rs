//! Edits: what brushes do, that it is the same in f32, f64 and bounds, that work follows the brush, undo, and files.

use crate::support;

use bevy::math::DVec2;
use bevy::prelude::*;
use dolomite_terrain::editing::{self, FILE_NAME, MAX_TILES};
use dolomite_terrain::edits::STEP;
use dolomite_terrain::{
    Edit, EditError, EditFileError, EditKind, Edits, Filter, Fractal, Ground, GroundPoint,
    GroundProbe, GroundRect, HeightMap, Source, Terrain, TerrainEdits, TerrainPlugin,
};
use std::path::PathBuf;
use support::{Random, plain, terrain};

/// A square of 2 km of noise, or of a map of 4 m, about the origin.
fn grounds() -> [Terrain; 3] {
    let fractal = Fractal {
        amplitude: 60.0,
        wavelength: 300.0,
        octaves: 6,
        seed: 3,
        ..Fractal::default()
    };
    let map = |filter| {
        let samples = (0..501 * 501)
            .map(|k| ((k * 7919) % 101) as f32 * 0.1)
            .collect();
        let corner = DVec2::splat(-1000.0);
        let map = HeightMap::new(501, 501, samples, corner, DVec2::splat(4.0), filter);
        terrain(2000.0, 5.0, vec![plain(Source::Map(map.expect("valid")))])
    };
    [
        terrain(2000.0, 5.0, vec![plain(Source::Fractal(fractal))]),
        map(Filter::Bilinear),
        map(Filter::Bicubic),
    ]
}

fn brush(kind: EditKind, place: DVec2, radius: f64, strength: f64) -> Edit {
    Edit {
        kind,
        place,
        radius,
        strength,
        falloff: 0.5,
    }
}

/// Some edits of each kind about a place.
fn edited(ground: &Terrain, edits: &mut TerrainEdits, about: DVec2, seed: u32) -> Terrain {
    let mut random = Random(seed);
    let mut now = ground.clone();
    let stamp = HeightMap::new(
        3,
        3,
        vec![0.0, 1.0, 0.0, 1.0, 4.0, 1.0, 0.0, 1.0, 0.0],
        DVec2::ZERO,
        DVec2::ONE,
        Filter::Bicubic,
    );
    let stamp = stamp.expect("valid");
    for kind in [
        EditKind::Raise,
        EditKind::Lower,
        EditKind::Flatten { height: Some(12.0) },
        EditKind::Flatten { height: None },
        EditKind::Smooth,
        EditKind::Stamp(stamp),
    ] {
        let place = about + DVec2::new(random.between(-30.0, 30.0), random.between(-30.0, 30.0));
        let strength = match kind {
            EditKind::Raise | EditKind::Lower => 7.0,
            _ => 0.8,
        };
        let radius = random.between(8.0, 40.0);
        let made = edits.apply(&now, &brush(kind, place, radius, strength));
        now = made.expect("valid").terrain;
    }
    now
}

#[test]
fn each_kind_does_what_it_says() {
    for ground in grounds() {
        let at = DVec2::new(100.0, -60.0);
        let mut edits = TerrainEdits::new(&ground).expect("fits");
        let mut with = |kind, strength| {
            let made = edits.apply(&ground, &brush(kind, at, 20.0, strength));
            made.expect("valid").terrain
        };
        // The middle half of the brush is level: what interpolation reaches from it is too, to a step.
        let near = |terrain: &Terrain, by: f64| {
            for offset in [DVec2::ZERO, DVec2::new(3.3, -2.1), DVec2::new(-4.0, 4.0)] {
                let rise = terrain.height(at + offset) - ground.height(at + offset);
                assert!((rise - by).abs() < STEP, "{rise} {by}");
            }
            let outside = at + DVec2::new(23.5, 0.0);
            assert_eq!(terrain.sample_f64(outside), ground.sample_f64(outside));
        };
        near(&with(EditKind::Raise, 3.0), 3.0);
        near(&with(EditKind::Lower, 2.5), -2.5);
        near(&with(EditKind::Flatten { height: None }, 0.0), 0.0);
        let level = with(EditKind::Flatten { height: Some(40.0) }, 1.0);
        let lattice = *level.edits().expect("edited").lattice();
        for offset in [DVec2::ZERO, DVec2::new(3.0, -2.0), DVec2::new(-4.0, 4.0)] {
            let sample = lattice.place(sample_near(&lattice, at + offset));
            let off = (level.height(sample) - 40.0).abs();
            assert!(off <= STEP, "{off}");
        }
        // On the layer's samples: between them the ground keeps what is finer than they are.
        let middle = sample_near(&lattice, at);
        let rough = |terrain: &Terrain| -> f64 {
            let height = |k: i64| terrain.height(lattice.place([middle[0] + k, middle[1]]));
            (-8..=8)
                .map(|k| (height(k - 1) - 2.0 * height(k) + height(k + 1)).abs())
                .sum()
        };
        let mut smooth = with(EditKind::Smooth, 1.0);
        for _ in 0..39 {
            let again = brush(EditKind::Smooth, at, 20.0, 1.0);
            let made = editing::edit(&smooth, &lattice, &again);
            smooth = made.expect("valid").terrain;
        }
        // The shortest waves, of some 9 m, lose 3 % each time on samples half a metre apart: (1 - cos(2 pi 0.5 / 9)) / 2.
        let (before, after) = (rough(&ground), rough(&smooth));
        assert!(after < 0.7 * before, "{after} {before}");
        let map = HeightMap::new(
            2,
            2,
            vec![3.0; 4],
            DVec2::ZERO,
            DVec2::ONE,
            Filter::Bilinear,
        );
        near(&with(EditKind::Stamp(map.expect("valid")), 1.5), 4.5);
    }
}

fn sample_near(lattice: &dolomite_terrain::EditLattice, xz: DVec2) -> [i64; 2] {
    let steps = (xz - lattice.place([0, 0])) / lattice.spacing();
    steps.round().as_i64vec2().to_array()
}

/// f32, f64, lists and bounds are the same function, and the gradient its derivative.
#[test]
fn every_form_is_one_function() {
    for (k, ground) in grounds().into_iter().enumerate() {
        let mut edits = TerrainEdits::new(&ground).expect("fits");
        let now = edited(&ground, &mut edits, DVec2::ZERO, 9 + k as u32);
        let layer = now.edits().expect("edited");
        let mut random = Random(77);
        let mut points = Vec::new();
        for _ in 0..3000 {
            let xz = DVec2::new(random.between(-90.0, 90.0), random.between(-90.0, 90.0));
            let exact = layer.sample_f64(xz);
            let near = layer.sample(GroundPoint::new(xz));
            // Of relief of some 20 m.
            assert!((f64::from(near.value) - exact.height).abs() < 3e-5, "{xz}");
            assert!((near.gradient.as_dvec2() - exact.gradient).length() < 5e-5);
            let all = now.sample_f64(xz);
            let base = ground.sample_f64(xz);
            assert!((all.height - base.height - exact.height).abs() < 1e-10);
            points.push(GroundPoint::new(xz));
            // Rectangles of every size hold what is in them.
            let half = DVec2::new(random.between(0.1, 40.0), random.between(0.1, 40.0));
            let rect = GroundRect::new(xz - half, xz + half);
            let bounds = now.bounds(&rect);
            for _ in 0..8 {
                let inside =
                    xz + half * DVec2::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0));
                let sample = now.sample_f64(inside);
                assert!(f64::from(bounds.min) <= sample.height, "{rect:?}");
                assert!(f64::from(bounds.max) >= sample.height, "{rect:?}");
                assert!(f64::from(bounds.max_slope) >= sample.gradient.length());
            }
        }
        let mut planes = [(); 3].map(|()| vec![0.0; points.len()]);
        let [value, dx, dz] = &mut planes;
        let planes_of = dolomite_terrain::Planes { value, dx, dz };
        now.fill_points(&points, planes_of).expect("as long");
        for (point, value) in points.iter().zip(&planes[0]) {
            assert_eq!(now.sample(*point).value.to_bits(), value.to_bits());
        }
    }
}

/// What lies between samples that stand apart is within the bound of it, near edits and far, at every spacing; and the
/// bound is not a guess: it is met to a good part.
#[test]
fn nothing_between_samples_is_missed_by_more() {
    for (k, ground) in grounds().into_iter().enumerate() {
        let flat = terrain(2000.0, 0.0, Vec::new());
        let mut edits = TerrainEdits::new(&ground).expect("fits");
        let now = edited(&ground, &mut edits, DVec2::new(40.0, 10.0), 31 + k as u32);
        // The layer alone: what the ground below misses is tested elsewhere.
        let now = flat.with_edits(now.edits().cloned());
        let mut random = Random(5);
        let mut tightest = 0.0_f64;
        for n in 0..3000 {
            let spacing = [1.5, 2.3, 5.0, 9.0, 21.0, 50.0, 300.0][n % 7];
            let low = DVec2::new(random.between(-60.0, 140.0), random.between(-90.0, 110.0))
                - 0.5 * spacing;
            let rect = GroundRect::new(low, low + spacing);
            let bound = f64::from(now.unseen(&rect, spacing));
            let corners = [low, low + DVec2::new(spacing, 0.0), low + spacing];
            let corners = corners.map(|corner| now.height(corner));
            for _ in 0..30 {
                let (u, v) = (random.unit(), random.unit());
                let (u, v) = (u.max(v), u.min(v));
                let plane = corners[0] * (1.0 - u) + corners[1] * (u - v) + corners[2] * v;
                let off = (now.height(low + DVec2::new(u, v) * spacing) - plane).abs();
                assert!(off <= bound + 1e-9, "{spacing} {rect:?}: {off} > {bound}");
                if bound > 0.0 {
                    tightest = tightest.max(off / bound);
                }
            }
        }
        assert!(tightest > 0.3, "{tightest}");
    }
}

/// Work follows the brush: as many samples and tiles wherever and however much has been edited before, and rectangles no
/// larger than the brush needs.
#[test]
fn work_follows_the_brush() {
    let ground = &grounds()[0];
    let mut edits = TerrainEdits::new(ground).expect("fits");
    let mut now = ground.clone();
    let mut most = (0, 0);
    let start = std::time::Instant::now();
    for k in 0..400 {
        let place = DVec2::new(f64::from(k % 20) * 90.0, f64::from(k / 20) * 90.0) - 860.0;
        let before = now.clone();
        let edit = brush(EditKind::Raise, place, 20.0, 0.5);
        let made = edits.apply(&now, &edit).expect("valid");
        most = (most.0.max(made.samples), most.1.max(made.tiles));
        now = made.terrain;
        let rects = now.changed_since(&before).expect("the same base");
        let area: f64 = rects.iter().map(|rect| rect.size().element_product()).sum();
        assert!(area > 30.0 * 30.0 && area < 1.6 * 46.0 * 46.0, "{rects:?}");
        let reach = edit.rect(edits.lattice());
        for rect in &rects {
            assert!(rect.min.cmpge(reach.min - 1.0).all() && rect.max.cmple(reach.max + 1.0).all());
        }
        for _ in 0..4 {
            let outside = place + DVec2::new(24.0, 0.0);
            assert_eq!(now.sample_f64(outside), before.sample_f64(outside));
        }
    }
    println!(
        "{most:?} samples and tiles at most; {:.3} ms a stroke with its checks",
        start.elapsed().as_secs_f64() * 1e3 / 400.0
    );
    assert!(most.0 <= 41 * 41 && most.1 <= 9, "{most:?}");
    // The table of a GPU writes as much for one more: tiles of 1225 words, and nodes above them.
    let data = now.gpu();
    let (_, mut table) = data.edits.expect("edited");
    let edit = brush(EditKind::Lower, DVec2::new(7.0, 3.0), 20.0, 0.5);
    let next = edits.apply(&now, &edit).expect("valid").terrain;
    let writes = table.update(next.edits().expect("edited")).expect("room");
    let words: usize = writes.iter().map(|write| write.words.len()).sum();
    println!("{words} words for the GPU");
    assert!(words <= 9 * (1225 + 12) + 4 * 12 * 8, "{words}");
    assert!(
        table
            .update(next.edits().expect("edited"))
            .expect("room")
            .is_empty(),
        "nothing differs"
    );
}

/// A table that was updated again and again answers as one that is made anew, through what is gone too.
#[test]
fn tables_keep_up() {
    let ground = &grounds()[0];
    let mut edits = TerrainEdits::new(ground).expect("fits");
    let first = edited(ground, &mut edits, DVec2::ZERO, 3);
    let data = first.gpu();
    let (at, mut table) = data.edits.clone().expect("edited");
    let mut words = data.data[at..].to_vec();
    let mut now = first;
    for k in 0..60 {
        let place = DVec2::new(f64::from(k % 12) * 150.0, f64::from(k / 12) * 150.0) - 700.0;
        now = match k % 3 {
            2 => edits.undo(&now).expect("a step"),
            _ => {
                let edit = brush(EditKind::Raise, place, 25.0, 3.0);
                edits.apply(&now, &edit).expect("valid").terrain
            }
        };
        for write in table.update(now.edits().expect("edited")).expect("room") {
            words[write.at..][..write.words.len()].copy_from_slice(&write.words);
        }
    }
    let mut fresh = dolomite_terrain::EditTable::new(table.room(), table.edits());
    let writes = fresh.update(now.edits().expect("edited")).expect("room");
    // Every tile that a fresh table has stands in the other with the same samples.
    let entry = |words: &[u32], key: [u32; 3]| {
        words
            .chunks_exact(12)
            .take(1 << table.room().entries_log2)
            .find(|entry| [entry[0], entry[1], entry[2]] == key)
            .map(<[u32]>::to_vec)
    };
    let mut own = vec![0; table.room().words()];
    for write in &writes {
        own[write.at..][..write.words.len()].copy_from_slice(&write.words);
    }
    let tiles_at = 12 << table.room().entries_log2;
    let mut tiles = 0;
    for fresh in own[..tiles_at]
        .chunks_exact(12)
        .filter(|entry| entry[2] > 0)
    {
        let kept = entry(&words, [fresh[0], fresh[1], fresh[2]]).expect("an entry");
        assert_eq!(kept[4..9], fresh[4..9]);
        if fresh[2] == 1 {
            let samples = |words: &[u32], entry: &[u32]| {
                words[tiles_at + entry[3] as usize * 1225..][..1225].to_vec()
            };
            assert_eq!(samples(&words, &kept), samples(&own, fresh));
            tiles += 1;
        }
    }
    assert_eq!(tiles, now.edits().expect("edited").counts()[0]);
}

#[test]
fn undo_and_redo_are_to_the_bit() {
    for ground in grounds() {
        let mut edits = TerrainEdits::new(&ground).expect("fits");
        let mut states = vec![ground.clone()];
        for k in 0..5 {
            let last = states.last().expect("one").clone();
            states.push(edited(
                &last,
                &mut edits,
                DVec2::splat(f64::from(k) * 9.0),
                k + 1,
            ));
        }
        let places: Vec<DVec2> = (0..500)
            .map(|k| DVec2::new(f64::from(k % 25) * 6.3, f64::from(k / 25) * 7.1) - 60.0)
            .collect();
        let bits = |terrain: &Terrain| {
            let each = places.iter().map(|xz| {
                let height = terrain.height(*xz).to_bits();
                (
                    height,
                    terrain.sample(GroundPoint::new(*xz)).value.to_bits(),
                )
            });
            each.collect::<Vec<_>>()
        };
        let mut now = states.last().expect("one").clone();
        let [steps, _] = edits.steps();
        assert_eq!(steps, 30);
        for k in 0..steps {
            now = edits.undo(&now).expect("a step");
            if k % 6 == 5 {
                let state = &states[4 - k / 6];
                assert_eq!(bits(&now), bits(state));
                assert_eq!(now.changed_since(state), Some(Vec::new()));
            }
        }
        assert!(edits.undo(&now).is_none());
        assert!(now.edits().is_some_and(Edits::is_empty));
        for _ in 0..steps {
            now = edits.redo(&now).expect("a step");
        }
        assert!(now.same(states.last().expect("one")));
        assert!(edits.redo(&now).is_none());
        // A stroke of many edits is one step.
        let before = now.clone();
        for k in 0..20 {
            let edit = brush(EditKind::Raise, DVec2::splat(f64::from(k)), 10.0, 0.1);
            let made = match k {
                0 => edits.apply(&now, &edit),
                _ => edits.apply_to_last(&now, &edit),
            };
            now = made.expect("valid").terrain;
        }
        now = edits.undo(&now).expect("a step");
        assert!(now.same(&before));
    }
}

#[test]
fn what_cannot_be_is_refused_before_memory_is_taken() {
    let ground = &grounds()[0];
    let mut edits = TerrainEdits::new(ground).expect("fits");
    let good = brush(EditKind::Raise, DVec2::ZERO, 20.0, 3.0);
    let mut refused = |edit: Edit| edits.apply(ground, &edit).expect_err("refused");
    for place in [
        DVec2::new(f64::NAN, 0.0),
        DVec2::INFINITY,
        DVec2::splat(1e300),
    ] {
        let edit = Edit {
            place,
            ..good.clone()
        };
        assert!(matches!(refused(edit), EditError::Place(_)));
    }
    for radius in [0.0, -3.0, f64::NAN, f64::INFINITY] {
        let edit = Edit {
            radius,
            ..good.clone()
        };
        assert!(matches!(refused(edit), EditError::Radius(_)));
    }
    for strength in [f64::NAN, f64::INFINITY, -1.0, 1e9] {
        let edit = Edit {
            strength,
            ..good.clone()
        };
        assert!(matches!(refused(edit), EditError::Strength { .. }));
    }
    for falloff in [f64::NAN, -0.1, 1.1] {
        let edit = Edit {
            falloff,
            ..good.clone()
        };
        assert!(matches!(refused(edit), EditError::Falloff(_)));
    }
    let edit = Edit {
        kind: EditKind::Flatten {
            height: Some(f64::NAN),
        },
        strength: 1.0,
        ..good.clone()
    };
    assert!(matches!(refused(edit), EditError::Height(_)));
    // 10⁹ samples, and 10¹⁸ of them.
    for radius in [17_000.0, 1e9] {
        let edit = Edit {
            radius,
            ..good.clone()
        };
        assert!(matches!(refused(edit), EditError::TooManySamples { .. }));
    }
    assert_eq!(edits.steps(), [0, 0]);
    // Beyond the ground: nothing to edit.
    let edit = Edit {
        place: DVec2::splat(5e4),
        ..good.clone()
    };
    let made = edits.apply(ground, &edit).expect("valid");
    assert!(made.terrain.same(ground) && made.tiles == 0);
    // A layer that is full.
    let wide = terrain(40_000.0, 0.0, Vec::new());
    let mut edits = TerrainEdits::new(&wide).expect("fits");
    let mut now = wide.clone();
    let fault = (0..40).find_map(|k| {
        let place = DVec2::new(f64::from(k % 6) * 2000.0, f64::from(k / 6) * 2000.0) - 5000.0;
        match edits.apply(&now, &brush(EditKind::Raise, place, 1000.0, 1.0)) {
            Ok(made) => {
                now = made.terrain;
                None
            }
            Err(fault) => Some(fault),
        }
    });
    assert!(
        matches!(fault, Some(EditError::TooManyTiles { .. })),
        "{fault:?}"
    );
    assert!(u64::from(now.edits().expect("edited").counts()[0]) <= MAX_TILES);
    let endless = terrain(1.9e8, 0.0, Vec::new());
    assert!(matches!(
        TerrainEdits::new(&endless),
        Err(EditError::Lattice { .. })
    ));
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("dolomite-edits-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

#[test]
fn files_come_back_to_the_bit_and_damage_is_refused() {
    let folder = folder("files");
    let path = folder.join(FILE_NAME);
    for (k, ground) in grounds().into_iter().enumerate() {
        let mut edits = TerrainEdits::new(&ground).expect("fits");
        // Over the border of tiles, so that some have nothing but what they share.
        let now = edited(&ground, &mut edits, DVec2::splat(3.0), 40 + k as u32);
        let layer = now.edits().expect("edited");
        editing::save(&path, layer).expect("written");
        assert!(!folder.join(format!("{FILE_NAME}.new")).exists());
        let back = editing::load(&path, layer.lattice()).expect("read");
        assert_eq!(back.counts(), layer.counts());
        assert_eq!(back.changed_since(layer), Some(Vec::new()));
        let again = now.with_edits(Some(back));
        let at = DVec2::new(11.7, -3.9);
        assert_eq!(again.height(at).to_bits(), now.height(at).to_bits());
    }
    let [noise, map, _] = grounds();
    let mut edits = TerrainEdits::new(&noise).expect("fits");
    let now = edited(&noise, &mut edits, DVec2::ZERO, 2);
    let layer = now.edits().expect("edited");
    editing::save(&path, layer).expect("written");
    let whole = std::fs::read(&path).expect("there");
    let lattice = layer.lattice();
    let load = |bytes: &[u8]| {
        std::fs::write(&path, bytes).expect("written");
        editing::load(&path, lattice).expect_err("refused")
    };
    // Every truncation.
    let cut = (1..whole.len())
        .step_by(1 + whole.len() / 700)
        .chain([whole.len() - 1]);
    for length in cut {
        let fault = load(&whole[..length]);
        let named = fault.to_string().contains(FILE_NAME);
        assert!(
            named && matches!(fault, EditFileError::Truncated { at, .. } if at == length),
            "{length}: {fault}"
        );
    }
    assert!(matches!(load(&[]), EditFileError::Foreign { .. }));
    assert!(matches!(
        load(b"\x89PNG\r\n\x1a\n........"),
        EditFileError::Foreign { .. }
    ));
    let with = |at: usize, byte: u8| {
        let mut bytes = whole.clone();
        bytes[at] ^= byte;
        bytes
    };
    assert!(matches!(
        load(&with(8, 2)),
        EditFileError::Newer { version: 3, .. }
    ));
    // Every byte counts.
    for at in (12..whole.len()).step_by(1 + whole.len() / 500) {
        let fault = load(&with(at, 0x41));
        assert!(
            matches!(
                fault,
                EditFileError::Damaged { .. } | EditFileError::Truncated { .. }
            ),
            "{at}: {fault}"
        );
    }
    let mut longer = whole.clone();
    longer.push(0);
    assert!(matches!(load(&longer), EditFileError::Damaged { .. }));
    std::fs::write(&path, &whole).expect("written");
    let other = TerrainEdits::new(&map).expect("fits");
    assert!(matches!(
        editing::load(&path, other.lattice()),
        Err(EditFileError::OtherGround { .. })
    ));
    assert!(matches!(
        editing::load(&folder.join("none"), lattice),
        Err(EditFileError::Io { .. })
    ));
    std::fs::remove_dir_all(&folder).expect("removed");
}

/// Probes on what was edited are asked again, and no others.
#[test]
fn probes_on_edited_ground_are_asked_again() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TerrainPlugin));
    let ground = grounds()[0].clone();
    let entity = app.world_mut().spawn(ground.clone()).id();
    let places = [Vec3::new(5.0, 0.0, 5.0), Vec3::new(300.0, 0.0, 0.0)];
    let probes = places.map(|place| {
        let probe = (GroundProbe::default(), Transform::from_translation(place));
        app.world_mut().spawn(probe).id()
    });
    app.update();
    let of = |app: &App, k: usize| *app.world().get::<GroundProbe>(probes[k]).expect("a probe");
    let before = [of(&app, 0), of(&app, 1)];
    let mut edits = TerrainEdits::new(&ground).expect("fits");
    let edit = brush(EditKind::Raise, DVec2::ZERO, 30.0, 2.0);
    let now = edits.apply(&ground, &edit).expect("valid").terrain;
    app.world_mut().entity_mut(entity).insert(now.clone());
    app.update();
    let height = of(&app, 0).sample.expect("ground").height;
    assert_eq!(height, now.height(DVec2::splat(5.0)));
    assert!(of(&app, 0).frame > before[0].frame);
    assert_eq!(of(&app, 1), before[1], "nobody asked");
}
