// Heights of the vertices of the geomorph. CPU reference: Finder::height in
// plugins/ground/src/detail/mesh.rs, where they are derived. A thread a vertex.

#import dolomite::detail::bindings::{counts, detail, MORPHING, GROUP}
#import dolomite::detail::records::{RECORD, records}
#import dolomite::geometry::vertex::VERTEX_WORDS

@group(1) @binding(1) var<storage, read_write> vertices: array<u32>;

// A vertex as the height of others depends on it.
struct Term {
    number: u32,
    weight: f32,
    // Its share of the way, and the surface where its geomorph is done.
    share: f32,
    surface: f32,
}

fn term(number: u32, weight: f32) -> Term {
    let base = RECORD * number;
    return Term(number, weight, bitcast<f32>(records[base]), bitcast<f32>(records[base + 1u]));
}

// Height of the drawn surface at a vertex.
fn drawn_height(number: u32) -> f32 {
    var terms: array<Term, 4>;
    terms[0] = term(number, 1.0);
    var count = 1u;
    var since = 0.0;
    var height = 0.0;
    loop {
        var least = 0u;
        var surface = 0.0;
        for (var k = 0u; k < count; k++) {
            surface += terms[k].weight * terms[k].surface;
            if terms[k].share < terms[least].share {
                least = k;
            }
        }
        let until = max(terms[least].share, since);
        height += (until - since) * surface;
        if until >= 1.0 {
            break;
        }
        since = until;
        let leaving = terms[least];
        count -= 1u;
        terms[least] = terms[count];
        for (var e = 0u; e < 2u; e++) {
            let end = records[RECORD * leaving.number + 2u + e];
            var known = false;
            for (var k = 0u; k < count; k++) {
                if terms[k].number == end {
                    terms[k].weight += 0.5 * leaving.weight;
                    known = true;
                }
            }
            // Never more than the three corners of one triangle.
            if !known && count < 4u {
                terms[count] = term(end, 0.5 * leaving.weight);
                count += 1u;
            }
        }
    }
    return height;
}

@compute @workgroup_size(64)
fn raise_vertices(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let last = min(atomicLoad(&counts[MORPHING]), detail.max_vertices);
    for (var k = id.x; k < last; k += groups.x * GROUP) {
        let number = records[RECORD * detail.max_vertices + k];
        vertices[VERTEX_WORDS * number + 1u] = bitcast<u32>(drawn_height(number) - detail.anchor_height);
    }
}
