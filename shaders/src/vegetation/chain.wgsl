#define_import_path dolomite::vegetation::chain

// Kelp: a chain of segments from its root towards the surface. CPU reference: plugins/vegetation/src/chain.rs.

#import dolomite::terrain::hash::pcg
#import dolomite::vegetation::draw_types::Look
#import dolomite::vegetation::place::unit
#import dolomite::vegetation::shape::own

// How high what floats lies above the surface, metres.
const FLOAT: f32 = 0.03;
// Of what floats: width of a leaf, and between two leaves, as multiples of the ribbon's.
const LEAF: f32 = 2.4;
const STEM: f32 = 0.5;
// How much it winds, by the tilt that it would have under water.
const WINDING: f32 = 3.0;
// How much of a tilt is left after a segment: floats pull each one upright.
const UPRIGHT: f32 = 0.75;

// A chain at rest.
struct Chain {
    hash: u32,
    segments: u32,
    // Length of each, metres.
    segment: f32,
    // Greatest angle between two that follow each other.
    twist: f32,
    width: f32,
    // Of the water at the root.
    depth: f32,
    // Where what floats goes, of length 1.
    ahead: vec2<f32>,
}

// A node relative to the root, and the unit vector of the segment that ends there.
struct Node {
    place: vec3<f32>,
    along: vec3<f32>,
    // Whether it lies on the surface.
    floats: bool,
}

// Of a root in water of some depth, where the wind blows towards `wind`: as many whole segments as make up its length.
fn chain_of(look: Look, hash: u32, depth: f32, wind: vec2<f32>) -> Chain {
    let wanted = max(depth * mix(look.size.x, look.size.y, own(hash, 4u)), 0.0);
    let count = u32(clamp(wanted / look.head.x, 2.0, max(look.head.y, 2.0)));
    let angle = 6.2831853 * own(hash, 9u);
    let strength = length(wind);
    let blown = select(vec2(0.0), wind / max(strength, 1e-9), strength > 1e-6) + 0.45 * vec2(cos(angle), sin(angle));
    return Chain(
        hash,
        count,
        // Shallow water holds two short ones.
        min(look.head.x, wanted / f32(count)),
        look.head.z,
        look.size.z * (0.7 + 0.6 * own(hash, 7u)),
        depth,
        normalize(blown),
    );
}

// Node `number` at rest, 0 the root.
fn node_at_rest(chain: Chain, number: u32) -> Node {
    var place = vec3(0.0);
    var along = vec3(0.0, 1.0, 0.0);
    var tilt = vec2(0.0);
    var floats = false;
    for (var k = 0u; k < min(number, chain.segments); k++) {
        let word = pcg(chain.hash * 747796405u + 16u + k);
        let turn = vec2(unit(word), unit(word << 12u)) - 0.5;
        tilt = tilt * UPRIGHT + turn * (chain.twist * (1.0 / (2.0 - UPRIGHT)));
        along = vec3(sin(tilt.x) * cos(tilt.y), cos(tilt.x) * cos(tilt.y), sin(tilt.y));
        let left = chain.depth - place.y;
        floats = chain.segment * along.y >= left;
        if floats {
            // As far up as there is water, the rest of the segment along the surface; it winds as it does below.
            let up = clamp(left / chain.segment, 0.0, 1.0);
            let turned = vec2(-chain.ahead.y, chain.ahead.x) * (WINDING * (tilt.x + tilt.y));
            let flat = normalize(chain.ahead + turned) * sqrt(max(1.0 - up * up, 0.0));
            along = vec3(flat.x, up, flat.y);
        }
        place += chain.segment * along;
    }
    return Node(place, along, floats);
}

// The node where the water moves as `moved` says at its place and depth: held at its foot, by the square of the way.
fn node_moved(chain: Chain, number: u32, rest: Node, moved: vec3<f32>) -> vec3<f32> {
    let way = f32(min(number, chain.segments)) / f32(chain.segments);
    let place = rest.place + moved * (way * way);
    return vec3(place.x, select(min(place.y, chain.depth), chain.depth + FLOAT, rest.floats), place.z);
}

// Unit vector across the ribbon at a node: it turns on the way up, and lies flat where it floats.
fn ribbon_across(chain: Chain, number: u32, rest: Node) -> vec3<f32> {
    if rest.floats {
        let flat = vec2(-rest.along.z, rest.along.x) / max(length(rest.along.xz), 1e-9);
        return vec3(flat.x, 0.0, flat.y);
    }
    let angle = 6.2831853 * own(chain.hash, 5u) + f32(number) * 0.5 * (own(chain.hash, 8u) - 0.5);
    return vec3(cos(angle), 0.0, sin(angle));
}

// Width of the ribbon at a node: narrow at the root and at the end; leaves and stem by turns where it floats, and of each
// `step`-th node alone the mean of both.
fn ribbon_width(chain: Chain, number: u32, floats: bool, step: u32) -> f32 {
    let way = f32(number) / f32(chain.segments);
    var leaf = 1.0;
    if floats {
        leaf = select(0.5 * (STEM + LEAF), select(STEM, LEAF, (number & 1u) == 1u), step == 1u);
    }
    return chain.width * leaf * min(0.25 + 3.0 * way * (1.0 - way), 1.0);
}
