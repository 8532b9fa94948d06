#define_import_path dolomite::vegetation::law

// How many of those that stand are drawn at a distance, and how wide. `reach`: up to the first distance all are drawn,
// then 1/d of them, from the second on 1/d^2; between the others they end. CPU reference: plugins/vegetation/src/law.rs.

// Ranks between this share of the greatest that is drawn and the greatest are on their way in.
const BAND: f32 = 0.25;
// From this share of the distance of the fade on colours settle.
const SETTLE_FROM: f32 = 0.7;
// How much more of the ground fewer and wider blades hide, by how much wider they are in the distances between roots.
const EVEN: f32 = 0.165;
// Share of the ranks that is still drawn where all end: the rest of the way goes by width.
const LAST: f32 = 0.25;

// The share that has its full width at a distance.
fn kept_share(reach: vec4<f32>, distance: f32) -> f32 {
    let d = max(distance, 1e-3);
    return min(1.0, reach.x / d) * min(1.0, reach.y / d);
}

// What is left of the cover towards the end.
fn left_share(reach: vec4<f32>, distance: f32) -> f32 {
    let t = clamp((distance - reach.z) / max(reach.w - reach.z, 1e-3), 0.0, 1.0);
    return 1.0 - t * t * (3.0 - 2.0 * t);
}

// The part of that by which ranks become fewer; the other part is that of the widths.
fn left_ranks(left: f32) -> f32 {
    return LAST + (1.0 - LAST) * left;
}

// Ranks below this share of those that stand are drawn: more than 1 where all have come in, none beyond the reach.
fn drawn_share(reach: vec4<f32>, distance: f32) -> f32 {
    let left = left_share(reach, distance);
    if left <= 0.0 {
        return 0.0;
    }
    return kept_share(reach, distance) / (1.0 - BAND) * left_ranks(left);
}

// How far a rank has come in, of which `part` is the ratio to the greatest that is drawn.
fn entered(part: f32) -> f32 {
    return clamp((1.0 - part) / BAND, 0.0, 1.0);
}

// The mean of that over all ranks that stand.
fn mean_entered(drawn: f32) -> f32 {
    if drawn <= 1.0 {
        return drawn * (1.0 - 0.5 * BAND);
    }
    let whole = min(drawn * (1.0 - BAND), 1.0);
    let last = min((drawn - 1.0) / (drawn * BAND), 1.0);
    return whole + 0.5 * (1.0 + last) * (1.0 - whole);
}

// Width as a multiple of a plant's own: what is missing and what is on its way in is made up for.
fn widened(reach: vec4<f32>, distance: f32, come: f32) -> f32 {
    let left = left_share(reach, distance);
    return come / mean_entered(kept_share(reach, distance) / (1.0 - BAND)) * left / left_ranks(left);
}

// A factor of the widths where so much is kept; `crowding`: width of a blade in mean distances of roots.
fn evened(crowding: f32, kept: f32) -> f32 {
    return 1.0 / (1.0 + EVEN * crowding * (1.0 / sqrt(max(kept, 1e-6)) - 1.0));
}

// How far the colours of blades have settled to those that the ground shows beyond them.
fn settled_share(reach: vec4<f32>, distance: f32) -> f32 {
    let begin = SETTLE_FROM * reach.z;
    let t = clamp((distance - begin) / max(reach.z - begin, 1e-3), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

// The share of the whole cover's optical depth that is drawn: the rest is the ground's.
fn cover_share(reach: vec4<f32>, distance: f32) -> f32 {
    let left = left_share(reach, distance);
    let all = kept_share(reach, distance) / (1.0 - BAND);
    return mean_entered(all * left_ranks(left)) / mean_entered(all) * left / left_ranks(left);
}
