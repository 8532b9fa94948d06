//! Lights by tiles: which lights reach which tile of a picture, against a reference in f64 of what `deferred/tiles.wgsl`
//! says of itself. Lights that a rounding would decide over are left out of the scene.
//!
//! The depths lie in 16 bits, the one format that WebGPU copies into. Bevy's view is put in by the four members that the
//! pass reads.

mod reference;
mod scene;

use std::sync::LazyLock;

use bevy::math::Vec4;
use bytemuck::{Pod, Zeroable, bytes_of, cast_slice};
use dolomite_deferred::cull::{Listed, Sides};
use dolomite_deferred::render::LightingUniform;
use dolomite_shaders::{ALL, ShaderFile};
use dolomite_testkit::random::Random;

use super::CapsuleError;
use super::builder::Builder;
use super::format::{BindingKind, Capsule, Command, Field, From};
use reference::{Tile, decided, tile};
use scene::{TEXTURE, TILES, VIEWPORT, lights, seen};

/// Words for all lists.
const ROOM: u32 = 1 << 12;
const FILE: &str = "deferred/tiles.wgsl";

/// The members of Bevy's view that the pass reads.
const VIEW: &str = "#define_import_path bevy_render::view
struct View {
    world_from_view: mat4x4<f32>,
    view_from_clip: mat4x4<f32>,
    world_position: vec3<f32>,
    viewport: vec4<f32>,
}
";

#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct ViewUniform {
    world_from_view: [[f32; 4]; 4],
    view_from_clip: [[f32; 4]; 4],
    world_position: [f32; 4],
    viewport: [f32; 4],
}

/// The pass with memory for as many lights as a small scene takes.
static SOURCE: LazyLock<String> = LazyLock::new(|| {
    let file = ALL.iter().find(|file| file.path == FILE);
    file.map_or("", |file| file.source)
        .replace("#{MASK_WORDS}", "128")
});

/// The lights of twenty tiles.
///
/// # Errors
/// If the shader is wrong.
pub fn capsule(name: &str, about: &str, seed: u32) -> Result<Capsule, CapsuleError> {
    let mut random = Random::new(seed);
    let seen = seen(&mut random);
    let all: Vec<[u32; 2]> = (0..TILES[0] * TILES[1])
        .map(|k| [k % TILES[0], k / TILES[0]])
        .collect();
    let tiles: Vec<Option<Tile>> = all.iter().map(|at| tile(&seen, *at)).collect();
    let mut rows = lights(&seen, &mut random);
    rows.retain(|light| {
        tiles
            .iter()
            .all(|tile| decided(&seen, light, tile.as_ref()).is_some())
    });
    let mut listed = Listed::default();
    let sides = Sides::new(seen.clip_from_view, seen.world_from_view);
    listed.fill(&rows, Some(&sides), |_| true);

    let count = listed.indices.len() as u32;
    let lighting = LightingUniform {
        lights: count,
        in_tiles: count,
        tiles: TILES,
        room: ROOM,
        brightest: 65_504.0,
        open: listed.open(),
        pad: 0,
    };
    let view = ViewUniform {
        world_from_view: seen.world_from_view.to_cols_array_2d(),
        view_from_clip: seen.clip_from_view.inverse().to_cols_array_2d(),
        world_position: seen.world_from_view.w_axis.to_array(),
        viewport: Vec4::from(VIEWPORT.map(|x| x as f32)).to_array(),
    };
    let (mut heads, mut lists, mut taken) = (Vec::new(), Vec::new(), 0_u32);
    for tile in &tiles {
        let in_tile = |at: &usize| {
            let light = &rows[listed.indices[*at] as usize];
            decided(&seen, light, tile.as_ref()) == Some(true)
        };
        let places: Vec<usize> = (0..listed.indices.len()).filter(in_tile).collect();
        let open = places
            .iter()
            .filter(|&&at| at < listed.open() as usize)
            .count();
        heads.push([0, open as u32, places.len() as u32]);
        lists.push(places.len() as u32);
        lists.extend(places.iter().map(|&at| listed.indices[at]));
        taken += places.len() as u32;
    }

    let mut builder = Builder::new(name, about);
    let others = [
        ShaderFile {
            path: FILE,
            source: SOURCE.as_str(),
        },
        ShaderFile {
            path: "bevy_render/view.wgsl",
            source: VIEW,
        },
    ];
    let module = dolomite_shaders::compose_with(FILE, &[], &others)?;
    let module = builder.module(FILE, &["MASK_WORDS = 128"], &module)?;
    let (uniform, read, write) = (
        BindingKind::Uniform,
        BindingKind::ReadOnlyStorage,
        BindingKind::Storage,
    );
    let layout = builder.layout(&[
        uniform,
        uniform,
        read,
        read,
        BindingKind::DepthTexture,
        write,
        write,
    ]);
    let pipeline = builder.pipeline(module, "list", &[layout]);
    let used = builder.filled("used", 16, 0);
    let words = 1 + 3 * TILES[0] * TILES[1];
    let found = builder.filled("tiles", 4 * u64::from(words + ROOM), 0xAB);
    let bound = [
        builder.buffer("view", bytes_of(&view)),
        builder.buffer("lighting", bytes_of(&lighting)),
        builder.buffer("lights", cast_slice(&rows)),
        builder.buffer("listed", cast_slice(&listed.indices)),
        builder.depths("depths", TEXTURE, &seen.depths),
        used,
        found,
    ];
    let group = builder.group(layout, &bound);
    builder.dispatch(pipeline, &[group], [TILES[0], TILES[1], 1]);
    let from = From::CpuReference;
    let fields = vec![Field::words("words", 0, 1)];
    builder.check("used", (used, 0, 4), fields, bytes_of(&taken), from);
    let fields = vec![Field::words("open and all", 4, 2)];
    builder.check("counts", (found, 4, 12), fields, cast_slice(&heads), from);
    let expected = builder.data(cast_slice(&lists));
    builder.command(Command::Lists {
        name: "lights".to_owned(),
        buffer: found,
        offset: 4,
        stride: 12,
        count: tiles.len() as u64,
        first: 0,
        length: 8,
        expected,
        from,
    });
    Ok(builder.finish())
}

#[cfg(test)]
mod tests {
    use super::reference::in_view;
    use super::*;
    use bevy::math::DVec2;
    use dolomite_deferred::light::SPOT;
    use dolomite_deferred::render::TILE;

    /// Of each pixel with a surface: a light that reaches it is one of its tile's.
    #[test]
    fn a_light_that_reaches_a_surface_is_listed_in_its_tile() {
        let mut random = Random::new(1);
        let seen = seen(&mut random);
        let rows = lights(&seen, &mut random);
        let view_from_clip = seen.clip_from_view.as_dmat4().inverse();
        let [x0, y0, width, height] = VIEWPORT;
        let (mut lit, mut listed, mut decided_by) = (0, 0, 0);
        for k in 0..TILES[0] * TILES[1] {
            let at = [k % TILES[0], k / TILES[0]];
            let tile = tile(&seen, at);
            for light in &rows {
                let Some(reaches) = decided(&seen, light, tile.as_ref()) else {
                    decided_by += 1;
                    continue;
                };
                listed += u32::from(reaches);
                let offset = light.position.map(f64::from);
                let light_in_view = seen
                    .world_from_view
                    .as_dmat4()
                    .inverse()
                    .transform_point3(offset.into());
                for pixel in 0..TILE * TILE {
                    let [x, y] = [at[0] * TILE + pixel % TILE, at[1] * TILE + pixel / TILE];
                    if x >= width || y >= height {
                        continue;
                    }
                    let depth = seen.depths[((y + y0) * TEXTURE[0] + x + x0) as usize];
                    if depth == 0 {
                        continue;
                    }
                    let ndc = (DVec2::new(x.into(), y.into()) + 0.5)
                        / DVec2::new(width.into(), height.into())
                        * DVec2::new(2.0, -2.0)
                        + DVec2::new(-1.0, 1.0);
                    let place = in_view(view_from_clip, ndc.extend(f64::from(depth) / 65_535.0));
                    let inside = place.distance(light_in_view) < f64::from(light.range);
                    if inside && light.kind & SPOT == 0 {
                        assert!(reaches, "{at:?} {light:?}");
                        lit += 1;
                    }
                }
            }
        }
        let pairs = rows.len() as u32 * TILES[0] * TILES[1];
        assert!(
            lit > 100 && listed > 100 && listed < pairs / 2,
            "{lit} {listed}"
        );
        assert!(decided_by * 100 < pairs, "{decided_by} of {pairs}");
    }
}
