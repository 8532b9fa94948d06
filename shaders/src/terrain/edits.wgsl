#define_import_path dolomite::terrain::edits

// What was edited: heights between the samples of tiles, which are found by hashing their places. CPU reference:
// plugins/terrain/src/edits/layer.rs; the table is laid out by table.rs there.

#import dolomite::terrain::fixed::{Fixed, coordinate, fixed_sub, fraction}
#import dolomite::terrain::layer::{Layer, EDITS_BILINEAR}
#import dolomite::terrain::bindings::terrain_data
#import dolomite::terrain::cubic::{cubic_slopes, cubic_weights}

const ENTRY_WORDS: u32 = 12u;
// Cells along a side of a tile, samples along it, and all of them: from one before the tile to one behind its last line.
const TILE_CELLS: u32 = 32u;
const TILE_CELLS_LOG2: u32 = 5u;
const TILE_SIDE: u32 = 35u;
const TILE_SAMPLES: u32 = 1225u;
const NO_ENTRY: u32 = 0xffffffffu;

fn edits_hash(place: vec2<u32>, level: u32) -> u32 {
    var h = (place.x * 0x9e3779b9u) ^ (place.y * 0x85ebca6bu) ^ (level * 0xc2b2ae35u);
    h = (h ^ (h >> 15u)) * 0x846ca68bu;
    return h ^ (h >> 13u);
}

// First word of the entry of a node; NO_ENTRY where nothing is edited.
fn edits_entry(layer: Layer, place: vec2<u32>, level: u32) -> u32 {
    let mask = (1u << layer.octaves) - 1u;
    var slot = edits_hash(place, level) & mask;
    // Half of the entries are free at least.
    for (var k = 0u; k <= mask; k++) {
        let at = layer.data + slot * ENTRY_WORDS;
        let key = terrain_data[at + 2u];
        if key == 0u {
            break;
        }
        if key == level + 1u && terrain_data[at] == place.x && terrain_data[at + 1u] == place.y {
            return at;
        }
        slot = (slot + 1u) & mask;
    }
    return NO_ENTRY;
}

fn edits_sample(at: u32) -> f32 {
    return bitcast<f32>(terrain_data[at]);
}

fn edits_height(layer: Layer, x: Fixed, z: Fixed) -> vec3<f32> {
    let origin_x = Fixed(bitcast<u32>(layer.origin_cell.x), layer.origin_frac.x);
    let origin_z = Fixed(bitcast<u32>(layer.origin_cell.y), layer.origin_frac.y);
    let cx = coordinate(fixed_sub(x, origin_x), layer.mantissa.x, layer.shift.x);
    let cz = coordinate(fixed_sub(z, origin_z), layer.mantissa.y, layer.shift.y);
    let cell = vec2(cx.whole, cz.whole);
    // What lies before the first sample has a sign bit.
    if any(cell >= layer.size) {
        return vec3(0.0);
    }
    let entry = edits_entry(layer, cell >> vec2(TILE_CELLS_LOG2), 0u);
    if entry == NO_ENTRY {
        return vec3(0.0);
    }
    let tile = layer.warp_data + terrain_data[entry + 3u] * TILE_SAMPLES;
    let inside = cell & vec2(TILE_CELLS - 1u);
    // Of the sample one before the cell along both axes.
    let first = tile + inside.y * TILE_SIDE + inside.x;
    let fx = fraction(cx);
    let fz = fraction(cz);
    let middle = edits_sample(first + TILE_SIDE + 1u);
    if layer.kind == EDITS_BILINEAR {
        let east = edits_sample(first + TILE_SIDE + 2u) - middle;
        let south = edits_sample(first + 2u * TILE_SIDE + 1u) - middle;
        let far = edits_sample(first + 2u * TILE_SIDE + 2u) - middle;
        let twist = (far - south) - east;
        return vec3(
            middle + (fx * east + fz * (south + fx * twist)),
            vec2(east + fz * twist, south + fx * twist) * layer.scale,
        );
    }
    let wx = cubic_weights(fx);
    let sx = cubic_slopes(fx);
    let wz = cubic_weights(fz);
    let sz = cubic_slopes(fz);
    var value = 0.0;
    var gradient = vec2(0.0);
    for (var dj = 0u; dj < 4u; dj++) {
        let at = first + dj * TILE_SIDE;
        let row = vec4(edits_sample(at), edits_sample(at + 1u), edits_sample(at + 2u), edits_sample(at + 3u)) - middle;
        let across = dot(wx, row);
        value += wz[dj] * across;
        gradient += vec2(wz[dj] * dot(sx, row), sz[dj] * across);
    }
    return vec3(middle + value, gradient * layer.scale);
}

// What samples `apart` of the layer's own may miss over a rectangle from `low` to `high`, all in their units. CPU
// reference: Edits::missed in plugins/terrain/src/edits/bounds.rs.
fn missed_of_edits(layer: Layer, low: vec2<f32>, high: vec2<f32>, apart: vec2<f32>) -> f32 {
    let least = low - vec2(1.0);
    let most = high + vec2(1.0);
    let longest = max(most.x - least.x, most.y - least.y);
    var level = 0u;
    while level < layer.warp_octaves && f32(TILE_CELLS << level) < longest {
        level++;
    }
    let side = f32(TILE_CELLS << level);
    // Before the first node and behind the last there is nothing.
    let across = vec2(f32(1u << (layer.warp_octaves - level)));
    let first = vec2<i32>(clamp(floor(least / side), vec2(-1.0), across));
    let last = vec2<i32>(clamp(floor(most / side), vec2(-1.0), across));
    var lowest = 0.0;
    var highest = 0.0;
    var bends = vec3(0.0);
    // Whether something that is not edited lies in it: heights of 0.
    var any_flat = false;
    var any_edited = false;
    for (var z = first.y; z <= last.y; z++) {
        for (var x = first.x; x <= last.x; x++) {
            var entry = NO_ENTRY;
            if x >= 0 && z >= 0 {
                entry = edits_entry(layer, vec2(u32(x), u32(z)), level);
            }
            if entry == NO_ENTRY {
                any_flat = true;
                continue;
            }
            let own_low = edits_sample(entry + 4u);
            let own_high = edits_sample(entry + 5u);
            lowest = select(own_low, min(lowest, own_low), any_edited);
            highest = select(own_high, max(highest, own_high), any_edited);
            bends = max(bends, vec3(edits_sample(entry + 6u), edits_sample(entry + 7u), edits_sample(entry + 8u)));
            any_edited = true;
        }
    }
    if !any_edited {
        return 0.0;
    }
    if any_flat {
        lowest = min(lowest, 0.0);
        highest = max(highest, 0.0);
    }
    let range = highest - lowest;
    // As in bounds.rs.
    const UP: f32 = 1.000001;
    if layer.kind == EDITS_BILINEAR {
        return range * UP;
    }
    let bend = 3.75 * (bends.x * apart.x * apart.x + bends.y * apart.y * apart.y) + 4.5 * bends.z * apart.x * apart.y;
    return min(1.5625 * range, 0.125 * bend) * UP;
}
