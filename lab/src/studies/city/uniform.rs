//! What the shaders of a city read.

use bevy::render::render_resource::encase::UniformBuffer;
use dolomite_city::render::CityParams;
use dolomite_city::{City, CityDetail, CityPatch, CityRules, CityView, DisplacementMap};

/// The uniform of a city by a rule of detail, as bytes.
pub fn params(rules: &CityRules, maps: &[DisplacementMap], detail: CityDetail) -> Vec<u8> {
    let city = City {
        rules: rules.clone(),
        detail,
        ..City::default()
    };
    let params = CityParams::new(&city, rules, maps, &CityView::default(), 1.0, 0.0);
    let mut buffer = UniformBuffer::new(Vec::new());
    buffer.write(&params).expect("room in memory");
    buffer.into_inner()
}

/// Eight control points a patch.
pub fn points(patches: &[CityPatch]) -> Vec<[f32; 4]> {
    let of_patch = |patch: &CityPatch| {
        let [a, b, c, d] = patch.corners;
        let data = patch.data;
        [a, b, c, d, data.across, data.up, data.face, data.map]
    };
    patches.iter().flat_map(of_patch).collect()
}
