#define_import_path dolomite::blocks::beside

#import dolomite::blocks::ratio::{Frame, place_in}
#import dolomite::detail::bindings::detail

// Whether the eye stands over a square of half cells of a block, or beside it.
fn is_beside(frame: Frame, least: vec2<u32>, most: vec2<u32>) -> bool {
    let eye = detail.horizon.eye.xz;
    let low = place_in(frame, least) - detail.horizon.near_reach;
    let high = place_in(frame, most) + detail.horizon.near_reach;
    return all(eye >= low) && all(eye <= high);
}
