#define_import_path dolomite::city::relief

// Displacement along the normal of a flat face. The CPU reference, which says how it fades: plugins/city/src/relief.rs.

// As PatchData in Rust.
struct PatchData {
    // Share of the width before the patch, its own, behind it; width of the face's foot.
    across: vec4<f32>,
    // The same of the height; height of the face.
    up: vec4<f32>,
    // Width of the face's top; borders by bits; amplitude; material.
    face: vec4<f32>,
    // Where the face begins in the map, texels; greatest displacement; number of the map.
    map: vec4<f32>,
}

// A place on the face: metres along and up, the product of the fades, its derivatives.
struct FacePlace {
    at: vec2<f32>,
    share: f32,
    by: vec2<f32>,
}

fn fade(d: f32, band: f32) -> vec2<f32> {
    let t = clamp(d / band, 0.0, 1.0);
    return vec2(t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) / band);
}

// With one more side, at a distance with these derivatives, if it is a border.
fn faded(place: FacePlace, border: bool, d: f32, by: vec2<f32>, band: f32) -> FacePlace {
    let s = fade(d, band);
    var next = place;
    next.by = select(place.by, place.by * s.x + place.share * (s.y * by), border);
    next.share = select(place.share, place.share * s.x, border);
    return next;
}

fn face_place(data: PatchData, band: f32, uv: vec2<f32>) -> FacePlace {
    let s = data.across.x + uv.x * data.across.y;
    let t = data.up.x + uv.y * data.up.y;
    let high = data.up.w;
    let taper = data.face.x - data.across.w;
    let wide = data.across.w + taper * t;
    let lean = 0.5 * taper / high;
    let y = t * high;
    let behind = vec2(data.across.z + (1.0 - uv.x) * data.across.y, data.up.z + (1.0 - uv.y) * data.up.y);
    let bits = u32(data.face.y);
    var place = FacePlace(vec2(0.5 * data.across.w + (s - 0.5) * wide, y), 1.0, vec2(0.0));
    place = faded(place, (bits & 1u) != 0u, s * wide, vec2(1.0, lean), band);
    place = faded(place, (bits & 2u) != 0u, y, vec2(0.0, 1.0), band);
    place = faded(place, (bits & 4u) != 0u, behind.x * wide, vec2(-1.0, lean), band);
    place = faded(place, (bits & 8u) != 0u, behind.y * high, vec2(0.0, -1.0), band);
    return place;
}

fn comes_first(a: vec3<f32>, b: vec3<f32>) -> bool {
    return select(select(a.z < b.z, a.y < b.y, a.y != b.y), a.x < b.x, a.x != b.x);
}

// The point of the flat face: on a side from the two ends of the side alone, in one order.
fn face_base(c0: vec3<f32>, c1: vec3<f32>, c2: vec3<f32>, c3: vec3<f32>, uv: vec2<f32>) -> vec3<f32> {
    var a = c0 * (1.0 - uv.y) + c3 * uv.y;
    var b = c1 * (1.0 - uv.y) + c2 * uv.y;
    var t = uv.x;
    var side = true;
    if uv.x == 0.0 {
        a = c0;
        b = c3;
        t = uv.y;
    } else if uv.x == 1.0 {
        a = c1;
        b = c2;
        t = uv.y;
    } else if uv.y == 0.0 {
        a = c0;
        b = c1;
    } else if uv.y == 1.0 {
        a = c3;
        b = c2;
    } else {
        side = false;
    }
    if side && !comes_first(a, b) {
        let first = b;
        b = a;
        a = first;
        t = 1.0 - t;
    }
    return a * (1.0 - t) + b * t;
}

// Whether a side (u = 0, v = 0, u = 1, v = 1) of the patch lies on a border.
fn is_border(data: PatchData, side: u32) -> bool {
    let ends = vec4(data.across.x, data.up.x, data.across.z, data.up.z);
    return ends[side] == 0.0 && (u32(data.face.y) & (1u << side)) != 0u;
}
