#define_import_path dolomite::geometry::vertex

// A vertex as it is stored: 5 words, of which three are the position. CPU reference:
// plugins/geometry/src/vertex.rs.

const VERTEX_WORDS: u32 = 5u;

// The octahedron unfolded onto the square [-1, 1] (Meyer et al. 2010; Cigolla et al. 2014).
fn octahedral(n: vec3<f32>) -> vec2<f32> {
    let p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    let folded = (1.0 - abs(p.yx)) * select(vec2(-1.0), vec2(1.0), p >= vec2(0.0));
    return select(folded, p, n.z >= 0.0);
}

// Normal (12 bits a coordinate) and material (8 bits).
fn pack_normal(normal: vec3<f32>, material: u32) -> u32 {
    let p = vec2<u32>(round((octahedral(normal) * 0.5 + 0.5) * 4095.0));
    return p.x | (p.y << 12u) | (min(material, 255u) << 24u);
}

fn unpack_normal(word: u32) -> vec3<f32> {
    let p = vec2(f32(word & 0xfffu), f32((word >> 12u) & 0xfffu)) / 4095.0 * 2.0 - 1.0;
    let z = 1.0 - abs(p.x) - abs(p.y);
    let folded = (1.0 - abs(p.yx)) * select(vec2(-1.0), vec2(1.0), p >= vec2(0.0));
    let n = select(folded, p, z >= 0.0);
    return normalize(vec3(n.x, n.y, z));
}

fn unpack_material(word: u32) -> u32 {
    return word >> 24u;
}
