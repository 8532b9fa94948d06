//! Patches of some blocks, and what the shaders read for them.

use std::sync::LazyLock;

use bevy::render::render_resource::encase::UniformBuffer;
use dolomite_city::maps::maps;
use dolomite_city::render::CityParams;
use dolomite_city::{
    Block, City, CityDetail, CityPatch, CityRules, CityView, DisplacementMap, Faces,
};

/// The crate's maps.
pub static MAPS: LazyLock<Vec<DisplacementMap>> = LazyLock::new(|| maps().to_vec());

/// Patches of `side` × `side` blocks from cell (0, 0) on.
pub fn patches(rules: &CityRules, side: i32) -> Vec<CityPatch> {
    let mut faces = Faces::new(rules, &MAPS, [0, 0]);
    for x in 0..side {
        for z in 0..side {
            let within = |c: [i32; 2]| (0..side).contains(&c[0]) && (0..side).contains(&c[1]);
            faces.block(&Block::new(rules, [x, z]), within);
        }
    }
    faces.patches
}

/// The uniform of a city by a rule of detail.
pub fn params(rules: &CityRules, detail: CityDetail) -> CityParams {
    let city = City {
        rules: rules.clone(),
        detail,
        hour: 20.5,
        lamps: 1.0,
    };
    CityParams::new(&city, rules, &MAPS, &CityView::default(), 1.0, 0.0)
}

/// As bytes.
pub fn bytes(params: &CityParams) -> Vec<u8> {
    let mut buffer = UniformBuffer::new(Vec::new());
    buffer.write(params).expect("room in memory");
    buffer.into_inner()
}

/// Eight control points a patch, as the shaders have them.
pub fn points(patches: &[CityPatch]) -> Vec<[f32; 4]> {
    patches
        .iter()
        .flat_map(|patch| {
            let [a, b, c, d] = patch.corners;
            [
                a,
                b,
                c,
                d,
                patch.data.across,
                patch.data.up,
                patch.data.face,
                patch.data.map,
            ]
        })
        .collect()
}
