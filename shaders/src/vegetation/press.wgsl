#define_import_path dolomite::vegetation::press

// Who walks through grass presses it aside. CPU reference: plugins/vegetation/src/bend.rs.

#import dolomite::vegetation::blade::MOST_LEAN

// An upright capsule, or where one stood.
struct Press {
    foot: vec3<f32>,
    radius: f32,
    // x: 1 where somebody stands; falls to 0.
    strength: vec4<f32>,
}

// How far above its foot a capsule presses.
const OVER: f32 = 1.0;

// The lean of a blade of some length at a root, after one press.
fn pressed_by(press: Press, given: vec2<f32>, root: vec3<f32>, long: f32) -> vec2<f32> {
    var lean = given;
    let away = root.xz - press.foot.xz;
    let distance = length(away);
    let near = press.strength.x * clamp(1.0 - (distance - press.radius) / max(long, 1e-3), 0.0, 1.0);
    if near <= 0.0 || abs(root.y - press.foot.y) > OVER {
        return lean;
    }
    var out = away / max(distance, 1e-4);
    if distance <= 1e-4 {
        out = select(vec2(1.0, 0.0), lean / max(length(lean), 1e-6), length(lean) > 1e-6);
    }
    let wanted = near * (2.0 - near) * MOST_LEAN;
    let along = dot(lean, out);
    if along < wanted {
        let aside = (lean - out * along) * (1.0 - near);
        lean = out * (along + (wanted - along) * sqrt(near)) + aside;
    }
    return lean * min(1.0, MOST_LEAN / max(length(lean), 1e-6));
}
