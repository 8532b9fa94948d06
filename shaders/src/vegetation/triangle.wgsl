#define_import_path dolomite::vegetation::triangle

// A drawn triangle as roots see it: from above, in steps, going round the positive way.

#import dolomite::vegetation::bindings::{corner_bed, corner_position}
#import dolomite::vegetation::edges::{side_of, to_steps}

struct Triangle {
    // Places of its corners among the indices.
    corners: vec3<u32>,
    a: vec2<i32>,
    b: vec2<i32>,
    c: vec2<i32>,
    // Of the ground: below water those of its bed.
    heights: vec3<f32>,
    // Whether it has an area.
    exists: bool,
}

fn triangle_at(first: u32) -> Triangle {
    let pa = corner_position(first);
    let pb = corner_position(first + 1u);
    let pc = corner_position(first + 2u);
    let a = to_steps(pa.xz);
    let b = to_steps(pb.xz);
    let c = to_steps(pc.xz);
    let side = side_of(a, b, c);
    let heights = vec3(corner_bed(first, pa.y), corner_bed(first + 1u, pb.y), corner_bed(first + 2u, pc.y));
    if side < 0 {
        return Triangle(vec3(first, first + 2u, first + 1u), a, c, b, heights.xzy, true);
    }
    return Triangle(vec3(first, first + 1u, first + 2u), a, b, c, heights, side > 0);
}

fn least_of(t: Triangle) -> vec2<i32> {
    return min(min(t.a, t.b), t.c);
}

fn most_of(t: Triangle) -> vec2<i32> {
    return max(max(t.a, t.b), t.c);
}
