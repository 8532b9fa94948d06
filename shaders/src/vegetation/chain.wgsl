#define_import_path dolomite::vegetation::chain

// Kelp: a chain of segments from its root towards the surface. CPU reference: plugins/vegetation/src/chain.rs.

#import dolomite::terrain::hash::pcg
#import dolomite::vegetation::draw_types::Look
#import dolomite::vegetation::place::unit
#import dolomite::vegetation::shape::own

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
}

// A node relative to the root, and the unit vector of the segment that ends there.
struct Node {
    place: vec3<f32>,
    along: vec3<f32>,
}

// Of a root in water of some depth: as many whole segments as reach its height.
fn chain_of(look: Look, hash: u32, depth: f32) -> Chain {
    let wanted = max(depth * mix(look.size.x, look.size.y, own(hash, 4u)), 0.0);
    let count = u32(clamp(wanted / look.head.x, 2.0, max(look.head.y, 2.0)));
    return Chain(
        hash,
        count,
        // Shallow water holds two short ones.
        min(look.head.x, wanted / f32(count)),
        look.head.z,
        look.size.z * (0.7 + 0.6 * own(hash, 7u)),
        depth,
    );
}

// Node `number` at rest, 0 the root.
fn node_at_rest(chain: Chain, number: u32) -> Node {
    var place = vec3(0.0);
    var along = vec3(0.0, 1.0, 0.0);
    var tilt = vec2(0.0);
    for (var k = 0u; k < min(number, chain.segments); k++) {
        let word = pcg(chain.hash * 747796405u + 16u + k);
        let turn = vec2(unit(word), unit(word << 12u)) - 0.5;
        tilt = tilt * UPRIGHT + turn * (chain.twist * (1.0 / (2.0 - UPRIGHT)));
        along = vec3(sin(tilt.x) * cos(tilt.y), cos(tilt.x) * cos(tilt.y), sin(tilt.y));
        place += chain.segment * along;
    }
    return Node(place, along);
}

// The node where the water moves as `moved` says at its place and depth: held at its foot, by the square of the way.
fn node_moved(chain: Chain, number: u32, rest: vec3<f32>, moved: vec3<f32>) -> vec3<f32> {
    let way = f32(min(number, chain.segments)) / f32(chain.segments);
    return rest + moved * (way * way);
}

// Unit vector across the ribbon at a node: it turns on the way up.
fn ribbon_across(chain: Chain, number: u32) -> vec3<f32> {
    let angle = 6.2831853 * own(chain.hash, 5u) + f32(number) * 0.5 * (own(chain.hash, 8u) - 0.5);
    return vec3(cos(angle), 0.0, sin(angle));
}

// Width of the ribbon at a node: narrow at the root and at the end.
fn ribbon_width(chain: Chain, number: u32) -> f32 {
    let way = f32(number) / f32(chain.segments);
    return chain.width * min(0.25 + 3.0 * way * (1.0 - way), 1.0);
}
