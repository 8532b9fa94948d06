//! Mistakes put into our shaders one at a time: each must be seen, by the oracle, by Bevy's own pass, or by the ways
//! that differ. A check that misses one is a check that proves less than it says.

use bevy::prelude::*;
use bevy::shader::Shader;
use dolomite_deferred::{BlinnPhongPlugin, DeferredPlugin, Way};
use dolomite_light_oracle::ledger::Ledger;
use dolomite_light_oracle::model::SplitSum;
use dolomite_light_oracle::shade::{Lights, shade};
use dolomite_light_oracle::{Image, Recipe, generate};
use dolomite_testkit::light::{self as support, GBufferPlugin, Picture, WAYS};

/// A file, what stands there once, and what is put in its place.
type Mistake = (&'static str, &'static str, &'static str);

const MISTAKES: &[Mistake] = &[
    // Attenuation and cones.
    (
        "reach",
        "let window = (1.0 - part) * (1.0 + part);",
        "let window = 1.0 - part;",
    ),
    (
        "reach",
        "return window * window / max",
        "return window / max",
    ),
    (
        "reach",
        "/ max(distance_squared, 1e-4)",
        "/ max(sqrt(distance_squared), 1e-4)",
    ),
    ("reach", "return share * share;", "return share;"),
    (
        "reach",
        "(cosine - cos_outer) * cone_scale",
        "(cosine + cos_outer) * cone_scale",
    ),
    (
        "reach",
        "cone(-dot(light.direction, to_light)",
        "cone(dot(light.direction, to_light)",
    ),
    (
        "reach",
        "let offset = (light.position - camera) - position;",
        "let offset = (light.position - camera) + position;",
    ),
    (
        "reach",
        "let to_light = offset / max(distance, 1e-20);",
        "let to_light = offset;",
    ),
    (
        "reach",
        "attenuation(distance_squared, light.range * light.range)",
        "attenuation(distance_squared, light.range)",
    ),
    (
        "reach",
        "light.color * share, light.radius)",
        "light.color, light.radius)",
    ),
    (
        "reach",
        "return dot(offset, offset) < range * range;",
        "return dot(offset, offset) < 0.81 * range * range;",
    ),
    (
        "reach",
        "return dot(offset, normal) > -(radius",
        "return dot(offset, normal) > 0.2 * range - (radius",
    ),
    (
        "reach",
        "return -dot(direction, offset) >= (cos_outer - 1e-6)",
        "return -dot(direction, offset) >= (cos_outer + 0.05)",
    ),
    // What is read of the G-buffer.
    (
        "gbuffer",
        "vec4(0u, 8u, 16u, 24u)",
        "vec4(8u, 0u, 16u, 24u)",
    ),
    ("gbuffer", "vec3(0u, 9u, 18u)", "vec3(0u, 9u, 17u)"),
    (
        "gbuffer",
        "return mantissas * power_of_two(i32(word >> 27u) - 24);",
        "return mantissas * power_of_two(i32(word >> 27u) - 25);",
    ),
    ("gbuffer", "/ 4095.0 * 2.0 - 1.0;", "/ 4096.0 * 2.0 - 1.0;"),
    ("gbuffer", "let t = saturate(-z);", "let t = saturate(z);"),
    (
        "gbuffer",
        "return pow(encoded, vec3(2.2));",
        "return pow(encoded, vec3(2.4));",
    ),
    (
        "gbuffer",
        "return normalize(vec3(octahedral +",
        "return vec3(octahedral +",
    ),
    (
        "surface",
        "surface.diffuse = surface.base_color * (1.0 - third.y);",
        "surface.diffuse = surface.base_color;",
    ),
    (
        "surface",
        "0.16 * third.x * third.x",
        "0.08 * third.x * third.x",
    ),
    (
        "surface",
        "surface.base_color, third.y);",
        "surface.base_color, third.z);",
    ),
    (
        "surface",
        "surface.roughness = roughness_of(first.w);",
        "surface.roughness = first.w;",
    ),
    (
        "surface",
        "brighter.energy = 1.0 / share - 1.0;",
        "brighter.energy = 1.0 / share;",
    ),
    (
        "surface",
        "f32(coat & 15u) / 15.0",
        "f32(coat & 15u) / 16.0",
    ),
    (
        "surface",
        "f32(coat >> 4u) / 30.0",
        "f32(coat >> 4u) / 15.0",
    ),
    // Where a pixel lies.
    (
        "place",
        "vec2(2.0, -2.0) + vec2(-1.0, 1.0)",
        "vec2(2.0, 2.0) + vec2(-1.0, -1.0)",
    ),
    ("place", "return place.xyz / place.w;", "return place.xyz;"),
    (
        "place",
        "world_from_view[1].xyz * in_view.y",
        "world_from_view[2].xyz * in_view.y",
    ),
    (
        "place",
        "select(-from_camera, world_from_view[2].xyz, orthographic)",
        "select(from_camera, world_from_view[2].xyz, orthographic)",
    ),
    // The standard material.
    (
        "standard",
        "return square * square * x;",
        "return square * square;",
    ),
    (
        "standard",
        "let f90 = 0.5 + 2.0 * roughness",
        "let f90 = 1.0 + 2.0 * roughness",
    ),
    (
        "standard",
        "schlick(1.0, f90, n_dot_l) * schlick(1.0, f90, n_dot_v)",
        "schlick(1.0, f90, n_dot_l)",
    ),
    (
        "standard",
        "return k * k * INVERSE_PI;",
        "return k * INVERSE_PI;",
    ),
    (
        "standard",
        "let a2 = roughness * roughness;",
        "let a2 = roughness;",
    ),
    (
        "standard",
        "return 0.5 / (from_view + from_light);",
        "return 0.25 / (from_view + from_light);",
    ),
    (
        "standard",
        "let clamped = clamp(perceptual, 0.089, 1.0);",
        "let clamped = clamp(perceptual, 0.3, 1.0);",
    ),
    (
        "standard",
        "(burley(surface.roughness, surface.n_dot_v, n_dot_l, l_dot_h) * n_dot_l)",
        "burley(surface.roughness, surface.n_dot_v, n_dot_l, l_dot_h)",
    ),
    (
        "standard",
        "let scattered = 1.0 + surface.at_normal * surface.energy;",
        "let scattered = 1.0 + surface.energy;",
    ),
    (
        "standard",
        "fifth_power(1.0 - saturate(dot(shine.to_light, h)))",
        "fifth_power(saturate(dot(shine.to_light, h)))",
    ),
    ("standard", "vec3(50.0 * 0.33)", "vec3(0.33)"),
    (
        "standard",
        "return (diffuse + specular) * light.color;",
        "return diffuse * light.color;",
    ),
    (
        "standard",
        "roughness + light.radius / (2.0 * max",
        "roughness + light.radius / (8.0 * max",
    ),
    (
        "standard",
        "let peak = roughness / seeming;",
        "let peak = 1.0;",
    ),
    (
        "standard",
        "n_dot_l + ratio * ratio",
        "n_dot_l + 9.0 * ratio",
    ),
    (
        "standard",
        "let through = 1.0 - coat_fresnel;",
        "let through = 1.0;",
    ),
    ("standard", "let kelemen = 0.25 /", "let kelemen = 0.5 /"),
    (
        "standard",
        "let coat_light = coat_lobe * grazing(light, coat_n_dot_l) * coat_n_dot_l;",
        "let coat_light = 0.0;",
    ),
    // Blinn-Phong.
    ("blinn_phong", "/ 65535.0 * 16.0);", "/ 65535.0 * 15.0);"),
    (
        "blinn_phong",
        "(exponent + 2.0) * (exponent + 4.0) / (8.0",
        "(exponent + 2.0) / (8.0",
    ),
    (
        "blinn_phong",
        "0.5 * (exponent + 2.0), is_phong",
        "0.5 * (exponent + 1.0), is_phong",
    ),
    (
        "blinn_phong",
        "reflect(-light.to_light, surface.normal)",
        "reflect(light.to_light, surface.normal)",
    ),
    ("blinn_phong", "(n_dot_l * 0.318309886)", "0.318309886"),
    (
        "blinn_phong",
        "return exp(0.5 * exponent * logarithm);",
        "return exp(exponent * logarithm);",
    ),
    (
        "blinn_phong",
        "select(0.0, power_of_cosine(dot(across, across), exponent), facing)",
        "power_of_cosine(dot(across, across), exponent)",
    ),
    (
        "write_blinn_phong",
        "encode_color(saturate(diffuse))",
        "saturate(diffuse)",
    ),
    // The full-screen pass.
    (
        "light",
        "let reflected = directional_lights(surface, position.xy) + local_lights",
        "let reflected = local_lights",
    ),
    ("light", "+ indirect_light(surface, position.xy);", ";"),
    (
        "light",
        "radiance = reflected * bevy::view.exposure + emitted(surface);",
        "radiance = (reflected + emitted(surface)) * bevy::view.exposure;",
    ),
    (
        "light",
        "return surface.emissive * (1.0 - surface.clearcoat",
        "return surface.emissive * (1.0 + surface.clearcoat",
    ),
    (
        "light",
        "if reaches(index, surface) {\n                found = index;",
        "if reaches(index, surface) && *at > 1u {\n                found = index;",
    ),
    (
        "light",
        "return listed[list.rest + at - list.own];",
        "return listed[list.rest + at - list.own] - min(at, 1u);",
    ),
    (
        "light",
        "let tile = vec2<u32>(pixels - bevy::view.viewport.xy) / 16u;",
        "let tile = vec2<u32>(pixels - bevy::view.viewport.xy + 3.0) / 16u;",
    ),
    (
        "light",
        "let own = tiles[head + 2u];",
        "let own = max(tiles[head + 2u], 1u) - 1u;",
    ),
    (
        "light",
        "* bevy::lights.ambient_color.rgb * occlusion.diffuse;",
        "* occlusion.diffuse;",
    ),
    // Lists of tiles.
    (
        "tiles",
        "let reach = lights[index].range * 1.001",
        "let reach = lights[index].range * 0.8",
    ),
    (
        "tiles",
        "let first = slice_at(-middle.z - slack, tile);",
        "let first = slice_at(-middle.z, tile);",
    ),
    (
        "tiles",
        "if -middle.z - reach > tile.far || -middle.z + reach < tile.near {",
        "if -middle.z > tile.far || -middle.z < tile.near {",
    ),
    (
        "tiles",
        "dot(tile.sides[i].xyz, middle) + tile.sides[i].w < -reach",
        "dot(tile.sides[i].xyz, middle) + tile.sides[i].w < 0.0",
    ),
    (
        "tiles",
        "atomicMin(&farthest, bitcast<u32>(depth[k]));",
        "atomicMax(&farthest, bitcast<u32>(depth[k]));",
    ),
    ("tiles", "sums[thread] += before;", "sums[thread] = before;"),
    (
        "tiles",
        "return outside <= radius && along >= -radius;",
        "return outside <= 0.0 && along >= -radius;",
    ),
    (
        "tiles",
        "if reaches(listed[i], tile, slices) {",
        "if reaches(listed[i], tile, slices) && i % 7u != 3u {",
    ),
    // Hulls.
    (
        "volume",
        "const MARGIN: f32 = 1.001;",
        "const MARGIN: f32 = 0.9;",
    ),
    (
        "volume",
        "if depth < hull.depths.x || depth > hull.depths.y {",
        "if depth < hull.depths.y || depth > hull.depths.x {",
    ),
    (
        "volume",
        "axis * mix(-0.002, 1.0, corner.z)",
        "axis * mix(0.2, 1.0, corner.z)",
    ),
    (
        "volume",
        "let narrow = light.cos_outer > 0.5;",
        "let narrow = light.cos_outer > 0.0;",
    ),
    (
        "volume",
        "let distance = -(axes * middle).z;",
        "let distance = (axes * middle).z;",
    ),
];

/// The largest relative error that arithmetic may have at one pixel, that 99.9 % may have, and how far ways may be
/// apart: those of the other tests.
const WORST: f64 = 2e-3;
const MOST: f64 = 1e-5;
const APART: f32 = 1e-5;

/// Replaces a file's text under its own handle, so that every pipeline is made anew.
pub fn put(app: &mut App, file: &str, source: &str) {
    let path = format!("deferred/{file}.wgsl");
    let mut shaders = app.world_mut().resource_mut::<Assets<Shader>>();
    let ids: Vec<_> = shaders
        .iter()
        .filter(|(_, shader)| shader.path == path)
        .map(|(id, _)| id)
        .collect();
    assert!(!ids.is_empty(), "{path} is not loaded");
    for id in ids {
        // The plugin's own handle stays good.
        let _ = shaders.insert(id, Shader::from_wgsl(source.to_owned(), path.clone()));
    }
}

/// Why a frame is wrong, if it is.
type Verdict = Result<(), String>;

/// Whether the ways agree.
fn agree(ways: &[Way], pictures: &[Picture]) -> Verdict {
    for (way, picture) in ways.iter().zip(pictures) {
        if picture.nonsense() > 0 {
            return Err(format!(
                "{way:?} has {} pixels of no number",
                picture.nonsense()
            ));
        }
        let apart = picture.relative_difference(&pictures[0], 1e-3);
        if apart > APART {
            return Err(format!("{way:?} is {apart:.1e} from brute force"));
        }
    }
    Ok(())
}

fn pictures(app: &mut App, camera: Entity, ways: &[Way]) -> Vec<Picture> {
    ways.iter()
        .map(|way| support::lit_by(app, camera, Some(*way)))
        .collect()
}

/// Runs every mistake that is not seen yet, and what is right before and after.
fn run(app: &mut App, seen: &mut [Option<String>], check: &mut dyn FnMut(&mut App) -> Verdict) {
    assert_eq!(check(app), Ok(()), "without a mistake");
    for ((file, from, to), seen) in MISTAKES.iter().zip(seen) {
        if seen.is_some() {
            continue;
        }
        let source = dolomite_shaders::find(&format!("deferred/{file}.wgsl")).source;
        assert_eq!(source.matches(from).count(), 1, "{file}: `{from}`");
        put(app, file, &source.replace(from, to));
        let start = std::time::Instant::now();
        let verdict = check(app);
        eprintln!(
            "{file}: `{to}`: {} ({:.1} s)",
            verdict.as_ref().err().map_or("not seen", String::as_str),
            start.elapsed().as_secs_f32()
        );
        *seen = verdict.err();
        put(app, file, source);
    }
    assert_eq!(check(app), Ok(()), "after all mistakes");
}

/// Of the oracle's scene.
fn by_the_oracle(seen: &mut [Option<String>], ways: &[Way]) -> Option<()> {
    let mut app = support::app_with(|app| {
        app.add_plugins((DeferredPlugin, BlinnPhongPlugin, GBufferPlugin));
    })?;
    let recipe = Recipe {
        seed: 2,
        blinn_phong: 0.4,
        phong: 0.5,
        lights: 40,
        width: 80,
        height: 45,
        ..Recipe::default()
    };
    let scene = generate(&recipe);
    let spawned = support::spawn(&mut app, &scene, ());
    let lights = Lights::new(
        &scene.lamps,
        &scene.ambient,
        scene.camera.exposure,
        SplitSum::Karis,
    );
    // Of the right shaders: what a wrong writer would write is no excuse.
    let pictures_of_right = pictures(&mut app, spawned.camera, ways);
    assert!(agree(ways, &pictures_of_right).is_ok());
    let texels = support::decoded(&support::pixels(&app), &scene.camera);
    let fed = shade(
        &lights,
        recipe.width,
        recipe.height,
        scene.background,
        &texels,
    )
    .expect("an image");
    let mut check = |app: &mut App| {
        let pictures = pictures(app, spawned.camera, ways);
        agree(ways, &pictures)?;
        let frame =
            Image::from_rgba(recipe.width, recipe.height, &pictures[0].pixels).expect("an image");
        let ledger = Ledger::new(&frame, &fed, 1e-3).expect("of one size");
        if ledger.p999 > MOST || ledger.max > WORST || ledger.not_finite > 0 {
            return Err(format!(
                "the oracle: p99.9 {:.1e}, max {:.1e}",
                ledger.p999, ledger.max
            ));
        }
        Ok(())
    };
    run(&mut app, seen, &mut check);
    Some(())
}

/// Of a scene with clearcoats and lights that are spheres, against Bevy's pass.
fn by_bevy(seen: &mut [Option<String>], ways: &[Way]) -> Option<()> {
    let mut app = support::app_with(|app| {
        app.add_plugins((DeferredPlugin, BlinnPhongPlugin));
    })?;
    super::ways::scene(&mut app, 3, 30, 20);
    super::ways::sun(&mut app);
    let camera = support::camera(&mut app, [96, 54], super::ways::eye(), ());
    let bevys = support::lit_by(&mut app, camera, None);
    let mut check = |app: &mut App| {
        let pictures = pictures(app, camera, ways);
        agree(ways, &pictures)?;
        let apart = pictures[0].relative_difference(&bevys, 1e-2);
        // Bevy's highlights lose digits.
        if apart > 1e-2 {
            return Err(format!("{apart:.1e} from Bevy's"));
        }
        Ok(())
    };
    run(&mut app, seen, &mut check);
    Some(())
}

#[test]
#[ignore = "compiles each shader some hundred times: minutes"]
fn mistakes_put_into_our_shaders_are_seen() {
    let mut seen = vec![None; MISTAKES.len()];
    // An app compiles what it has drawn with again for each mistake: first those that every way has.
    let first = [Way::BruteForce];
    if by_the_oracle(&mut seen, &first).is_none() {
        return;
    }
    by_bevy(&mut seen, &first);
    by_the_oracle(&mut seen, &WAYS);
    by_bevy(&mut seen, &WAYS);
    let missed: Vec<_> = MISTAKES
        .iter()
        .zip(&seen)
        .filter(|(_, seen)| seen.is_none())
        .collect();
    eprintln!(
        "{} of {} mistakes seen",
        MISTAKES.len() - missed.len(),
        MISTAKES.len()
    );
    for ((file, from, to), _) in &missed {
        eprintln!("not seen: {file}: `{from}` -> `{to}`");
    }
    assert!(missed.is_empty(), "{} mistakes were not seen", missed.len());
}

/// The list fits the files: each text stands there once, and no mistake is none.
#[test]
fn every_mistake_has_its_place() {
    assert!(MISTAKES.len() >= 50);
    for (file, from, to) in MISTAKES {
        let source = dolomite_shaders::find(&format!("deferred/{file}.wgsl")).source;
        assert_eq!(source.matches(from).count(), 1, "{file}: `{from}`");
        assert_ne!(from, to, "{file}");
    }
}
