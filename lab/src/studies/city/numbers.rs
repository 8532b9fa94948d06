//! The numbers of a city on the CPU: what the crate promises, counted.

use std::collections::HashMap;
use std::time::Instant;

use bevy::math::{DVec3, Vec3};
use dolomite_city::hash::{pcg, unit};
use dolomite_city::levels::Eye;
use dolomite_city::maps::maps;
use dolomite_city::tube::{PIECES, catmull_rom, double_reflection, piece_points, post_points};
use dolomite_city::{
    Block, Cells, CityBox, CityPart, CityPatch, CityRules, DisplacementMap, ErrorBound, Faces, Lamp,
};
use dolomite_tessellation::{Domain, Levels, Spacing, tessellate};
use serde_json::{Value, json};

/// How much is counted.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Points on facing sides.
    pub sides: usize,
    /// Samples of the error, of each of four tolerances.
    pub samples: usize,
    /// Timed runs, of which the median counts.
    pub repeats: usize,
}

/// Pixels of a radian: 1080 lines over 60 degrees.
pub const PIXELS: f32 = 935.0;

/// All of them, of a city with this seed.
pub fn numbers(seed: u32, effort: Effort) -> Value {
    let rules = CityRules {
        seed,
        blocks: Some((125, 125)),
        ..CityRules::default()
    };
    let maps = maps();
    let patches = patches(&rules, &maps);
    let mut all = making(&rules, effort.repeats);
    let mut add = |name: &str, value: Value| {
        if let Value::Object(all) = &mut all {
            all.insert(name.to_owned(), value);
        }
    };
    add("seams", seams(&rules, &maps, &patches, effort.sides));
    add("borders", borders(&rules, &maps, &patches));
    let errors: Vec<Value> = [0.5, 1.0, 2.0, 4.0]
        .into_iter()
        .map(|tolerance| error(&rules, &maps, &patches, tolerance, effort.samples))
        .collect();
    let above: u64 = errors.iter().filter_map(|e| e["above"].as_u64()).sum();
    add("error_above_tolerance", json!(above));
    let samples: u64 = errors.iter().filter_map(|e| e["samples"].as_u64()).sum();
    add("error_samples", json!(samples));
    add("error", json!(errors));
    add("normals_deg", json!(normals(&rules, &maps, &patches)));
    add("boxes", boxes(&rules, &maps, &patches));
    add("tubes", tubes(&rules));
    add(
        "bytes",
        json!({
            "block_record": size_of::<Block>(),
            "lamp_record": size_of::<Lamp>(),
            "patches_a_block": patches.len() as f64 / 25.0,
            "near_block_on_gpu": patch_bytes(&patches) as f64 / 25.0,
        }),
    );
    all
}

/// Those of 5 × 5 blocks.
pub fn patches(rules: &CityRules, maps: &[DisplacementMap]) -> Vec<CityPatch> {
    let mut faces = Faces::new(rules, maps, [0, 0]);
    for x in 0..5 {
        for z in 0..5 {
            let within = |c: [i32; 2]| (0..5).contains(&c[0]) && (0..5).contains(&c[1]);
            faces.block(&Block::new(rules, [x, z]), within);
        }
    }
    faces.patches
}

/// Bytes of patches on the GPU: control points, of which equal ones are one, and 20 words of tables each.
fn patch_bytes(patches: &[CityPatch]) -> usize {
    let mut points = std::collections::HashSet::new();
    for patch in patches {
        let data = patch.data;
        let rows = [data.across, data.up, data.face, data.map];
        for row in patch.corners.iter().chain(&rows) {
            points.insert(row.map(|x| (x + 0.0).to_bits()));
        }
    }
    points.len() * 16 + patches.len() * 80
}

fn making(rules: &CityRules, repeats: usize) -> Value {
    let Some(cells) = Cells::all(rules) else {
        return json!({});
    };
    let made = |threads| CityPart::new(rules, cells, threads).unwrap_or_default();
    let (mut times, mut on_core) = (Vec::new(), Vec::new());
    for _ in 0..repeats.max(1) {
        let (start, before) = (Instant::now(), core_ms());
        let city = made(1);
        times.push(start.elapsed().as_secs_f64() * 1e3);
        on_core.extend(core_ms().zip(before).map(|(after, before)| after - before));
        assert!(!city.blocks.is_empty(), "a city that is made has blocks");
    }
    let median = |times: &mut Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times.get(times.len() / 2).copied()
    };
    let (one, two) = (made(1), made(2));
    json!({
        "order_differs": order_differs(rules, &one),
        "blocks": one.blocks.len(),
        "lamps": one.lamps.len(),
        "make_ms": median(&mut times),
        "make_core_ms": median(&mut on_core),
        "hash_1_thread": format!("{:016x}", one.hash()),
        "hash_2_threads": format!("{:016x}", two.hash()),
        "same_bits": one == two,
    })
}

/// Records that are other ones when blocks are made one by one in a shuffled order.
fn order_differs(rules: &CityRules, city: &CityPart) -> usize {
    let mut order: Vec<usize> = (0..city.blocks.len()).collect();
    order.sort_by_key(|k| pcg(*k as u32 ^ 0x00c1_7100));
    let differs = |k: &&usize| Block::new(rules, city.blocks[**k].cell) != city.blocks[**k];
    order.iter().filter(differs).count()
}

/// Milliseconds that this thread has had a core, where the system says so: on a machine with other work the wall says
/// more about that.
fn core_ms() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(nanoseconds * 1e-6)
}

/// (u, v) of a place on side u = 0, v = 0, u = 1 or v = 1.
fn on(side: usize, t: f32) -> [f32; 2] {
    match side {
        0 => [0.0, t],
        1 => [t, 0.0],
        2 => [1.0, t],
        _ => [t, 1.0],
    }
}

fn seams(
    rules: &CityRules,
    maps: &[DisplacementMap],
    patches: &[CityPatch],
    wanted: usize,
) -> Value {
    let mut sides: HashMap<[[u32; 3]; 2], Vec<(usize, usize, bool)>> = HashMap::new();
    for (k, patch) in patches.iter().enumerate() {
        for (side, [a, b]) in [[0, 3], [0, 1], [1, 2], [3, 2]].into_iter().enumerate() {
            let [a, b] = [a, b].map(|c: usize| {
                let [x, y, z, _] = patch.corners[c];
                [x, y, z].map(f32::to_bits)
            });
            let (line, turned) = if a < b {
                ([a, b], false)
            } else {
                ([b, a], true)
            };
            sides.entry(line).or_default().push((k, side, turned));
        }
    }
    let facing: Vec<_> = sides
        .values()
        .filter_map(|users| match users[..] {
            [a, b] if patches[a.0].corners[0][3] != patches[b.0].corners[0][3] => Some([a, b]),
            _ => None,
        })
        .collect();
    let (mut points, mut bits, mut different) = (0_usize, 0_u32, 0_usize);
    let each = wanted.div_ceil(facing.len().max(1));
    for users in &facing {
        for k in 0..each {
            // A multiple of 2⁻²⁴, as the stage's coordinates are.
            let t = match k {
                0 => 0.0,
                1 => 1.0,
                k => unit(pcg(k as u32 ^ (points as u32))),
            };
            let [a, b] = users.map(|(k, side, turned)| {
                let patch = &patches[k];
                let [u, v] = on(side, if turned { 1.0 - t } else { t });
                let map = &maps[patch.data.map[3] as usize];
                let (place, _) = patch.evaluate(map, rules.relief.band, u, v);
                place.to_array().map(f32::to_bits)
            });
            let wrong: u32 = (0..3).map(|c| (a[c] ^ b[c]).count_ones()).sum();
            bits += wrong;
            different += usize::from(wrong > 0);
            points += 1;
        }
    }
    json!({ "points": points, "differing_points": different, "differing_bits": bits })
}

fn borders(rules: &CityRules, maps: &[DisplacementMap], patches: &[CityPatch]) -> Value {
    let (mut points, mut displaced, mut sloped) = (0, 0, 0);
    for patch in patches {
        let map = &maps[patch.data.map[3] as usize];
        for side in (0..4).filter(|side| patch.data.is_border(*side)) {
            for k in 0..=48 {
                let [u, v] = on(side, k as f32 / 48.0);
                let found = patch.data.relief(map, rules.relief.band, u, v);
                points += 1;
                displaced += usize::from(found.height != 0.0);
                sloped += usize::from(found.slope != [0.0; 2]);
            }
        }
    }
    json!({ "points": points, "displaced": displaced, "sloped": sloped })
}

/// Samples of drawn triangles against the surface in f64, over rectangles that the greatest level does not cut off.
fn error(
    rules: &CityRules,
    maps: &[DisplacementMap],
    patches: &[CityPatch],
    tolerance: f32,
    samples: usize,
) -> Value {
    let bound = ErrorBound::new(rules, maps, tolerance);
    let band = rules.relief.band;
    let flat: Vec<&CityPatch> = patches
        .iter()
        .filter(|p| p.data.face[0] == p.data.across[3])
        .collect();
    // So many samples of a patch as make tessellating it cheap beside them.
    let each = 200;
    let (mut taken, mut above, mut cut, mut kept) = (0_usize, 0_usize, 0_usize, 0_usize);
    let mut worst = 0.0_f64;
    let mut round = 0_u32;
    while taken < samples {
        round += 1;
        let [x, y, z] = [1, 2, 3].map(|salt| unit(pcg(round ^ (salt << 24))));
        let eye = Eye {
            at: Vec3::new(x * 160.0, 1.7 + y * y * 25.0, z * 160.0),
            pixels_per_radian: PIXELS,
        };
        let patch = flat[pcg(round ^ 0x5555) as usize % flat.len()];
        let levels = bound.levels(&eye, patch);
        if !ErrorBound::is_kept(&levels) {
            cut += 1;
            continue;
        }
        kept += 1;
        let mesh = tessellate(
            Domain::Quads,
            Spacing::FractionalOdd,
            Levels {
                outer: levels.outer,
                inner: levels.inner,
            },
        );
        let map = &maps[patch.data.map[3] as usize];
        let drawn: Vec<[f64; 3]> = mesh
            .coordinates
            .iter()
            .map(|[u, v, _]| {
                let height = patch.data.relief(map, band, *u, *v).height;
                [f64::from(*u), f64::from(*v), f64::from(height)]
            })
            .collect();
        let triangles = mesh.primitives.triangles();
        for k in 0..each {
            let hash = pcg(k ^ pcg(round));
            let triangle = triangles[hash as usize % triangles.len()];
            let [a, b] = [pcg(hash), pcg(hash ^ 77)].map(|h| f64::from(unit(h)));
            let (a, b) = if a + b > 1.0 {
                (1.0 - a, 1.0 - b)
            } else {
                (a, b)
            };
            let mut at = [0.0; 3];
            for (weight, corner) in [1.0 - a - b, a, b].into_iter().zip(triangle) {
                for (sum, value) in at.iter_mut().zip(drawn[corner as usize]) {
                    *sum += weight * value;
                }
            }
            let [u, v, height] = at;
            let exact = patch.data.exact(map, f64::from(band), u, v);
            let away = patch
                .exact(map, f64::from(band), u, v)
                .distance(eye.at.as_dvec3());
            let pixels = (exact - height).abs() * f64::from(PIXELS) / away;
            worst = worst.max(pixels);
            above += usize::from(pixels > f64::from(tolerance));
            taken += 1;
        }
    }
    json!({
        "tolerance_px": tolerance, "samples": taken, "above": above, "worst_px": worst,
        "patches": kept, "patches_cut_off_at_level_64": cut,
    })
}

/// Greatest angle in degrees between a normal and that of differences of the surface in f64.
fn normals(rules: &CityRules, maps: &[DisplacementMap], patches: &[CityPatch]) -> f64 {
    let band = f64::from(rules.relief.band);
    let mut worst = 0.0_f64;
    for (k, patch) in patches.iter().enumerate() {
        let map = &maps[patch.data.map[3] as usize];
        for n in 0..8_u32 {
            let hash = pcg(n ^ ((k as u32) << 3) ^ 0x0a0a_0000);
            let [u, v] = [hash, pcg(hash)].map(|h| 0.01 + 0.98 * unit(h));
            let (_, normal) = patch.evaluate(map, rules.relief.band, u, v);
            let (u, v, step) = (f64::from(u), f64::from(v), 1e-5);
            let at = |du: f64, dv: f64| patch.exact(map, band, u + du * step, v + dv * step);
            let exact = (at(1.0, 0.0) - at(-1.0, 0.0)).cross(at(0.0, 1.0) - at(0.0, -1.0));
            let sine = exact.normalize().cross(normal.as_dvec3().normalize());
            worst = worst.max(sine.length().min(1.0).asin_degrees());
        }
    }
    worst
}

fn boxes(rules: &CityRules, maps: &[DisplacementMap], patches: &[CityPatch]) -> Value {
    let (mut vertices, mut outside) = (0, 0);
    for (k, patch) in patches.iter().enumerate() {
        let bounds = CityBox::of_patch(patch);
        let map = &maps[patch.data.map[3] as usize];
        for n in 0..100_u32 {
            let hash = pcg(n ^ ((k as u32) << 8));
            let (place, _) = patch.evaluate(map, rules.relief.band, unit(hash), unit(pcg(hash)));
            vertices += 1;
            outside += usize::from(!bounds.holds(place));
        }
    }
    json!({ "vertices": vertices, "outside": outside })
}

/// Frames along a post, ours and by double reflection in f64 over 2 000 steps a piece; and what is not finite.
fn tubes(rules: &CityRules) -> Value {
    let points = post_points(rules, rules.lamp.height);
    let (mut places, mut tangents) = (Vec::new(), Vec::new());
    let mut not_finite = 0;
    for piece in 0..PIECES {
        for k in 0..=2000 {
            let (p, t) = catmull_rom(piece_points(points, piece), k as f32 / 2000.0);
            not_finite += usize::from(!p.is_finite() || !t.is_finite());
            if k > 0 || piece == 0 {
                places.push(Vec3::new(p.x, p.y, 0.0));
                tangents.push(Vec3::new(t.x, t.y, 0.0).normalize());
            }
        }
    }
    let mirror = |v: DVec3, n: DVec3| v - n * (2.0 * n.dot(v) / n.length_squared());
    let mut axis = DVec3::X;
    let mut twist = 0.0_f64;
    for k in 1..places.len() {
        let [a, b] = [k - 1, k].map(|k| tangents[k].as_dvec3().normalize());
        let step = (places[k] - places[k - 1]).as_dvec3();
        axis = mirror(mirror(axis, step), b - mirror(a, step));
        let ours = b.cross(DVec3::Z);
        let sine = axis.cross(ours).length().min(1.0);
        twist = twist.max(sine.asin_degrees());
    }
    let single = double_reflection(&places, &tangents, Vec3::X);
    not_finite += single.iter().filter(|a| !a.is_finite()).count();
    json!({ "twist_deg": twist, "not_finite": not_finite, "places": places.len() })
}

/// The arc sine of a small number in degrees, by its series: exact to 1e-9 below a hundredth.
trait ArcSine {
    fn asin_degrees(self) -> f64;
}

impl ArcSine for f64 {
    fn asin_degrees(self) -> f64 {
        let square = self * self;
        (self * (1.0 + square * (1.0 / 6.0 + square * (3.0 / 40.0)))).to_degrees()
    }
}
