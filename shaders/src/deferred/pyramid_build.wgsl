// Makes up to four levels of a depth pyramid: from a view's depth by FROM_DEPTH, else from a level that is there.

#import dolomite::deferred::pyramid::halved

struct Task {
    // Of the level below the ones that are made.
    size: vec2<u32>,
    // Its first texel in the array; with FROM_DEPTH the corner of the view in its target.
    source: vec2<u32>,
    // Of the first level that is made.
    first: u32,
    // How many are made.
    levels: u32,
    pad: vec2<u32>,
}

@group(0) @binding(0) var<uniform> task: Task;
@group(0) @binding(1) var<storage, read_write> texels: array<f32>;
#ifdef FROM_DEPTH
@group(0) @binding(2) var depths: texture_depth_2d;
#endif

// More than any depth: what lies outside counts for nothing.
const OUTSIDE: f32 = 1e30;

var<workgroup> tile: array<f32, 64>;

fn below(at: vec2<u32>) -> f32 {
    if any(at >= task.size) {
        return OUTSIDE;
    }
#ifdef FROM_DEPTH
    return textureLoad(depths, vec2<i32>(at + task.source), 0);
#else
    return texels[task.source.x + at.y * task.size.x + at.x];
#endif
}

@compute @workgroup_size(8, 8)
fn halve(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    var size = halved(task.size);
    var first = task.first;
    let at = group.xy * 8u + local.xy;
    let low = at * 2u;
    var least = min(
        min(below(low), below(low + vec2(1u, 0u))),
        min(below(low + vec2(0u, 1u)), below(low + vec2(1u, 1u))),
    );
    if all(at < size) {
        texels[first + at.y * size.x + at.x] = least;
    }
    let own = local.y * 8u + local.x;
    tile[own] = least;
    for (var k = 1u; k < task.levels; k++) {
        workgroupBarrier();
        let side = 8u >> k;
        let works = all(local.xy < vec2(side));
        if works {
            let corner = local.y * 16u + local.x * 2u;
            least = min(min(tile[corner], tile[corner + 1u]), min(tile[corner + 8u], tile[corner + 9u]));
        }
        workgroupBarrier();
        first += size.x * size.y;
        size = halved(size);
        if works {
            tile[own] = least;
            let place = group.xy * side + local.xy;
            if all(place < size) {
                texels[first + place.y * size.x + place.x] = least;
            }
        }
    }
}
