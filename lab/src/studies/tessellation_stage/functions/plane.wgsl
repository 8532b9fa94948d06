
// A place in the patch's plane, counted from one of its points: from another side the same place
// rounds otherwise.
fn plane(input: Patch, at: vec3<f32>) -> vec3<f32> {
    let a = patch_point(input, 0u, 0u).xyz;
    let b = patch_point(input, 1u, 0u).xyz;
    let c = patch_point(input, 2u, 0u).xyz;
#ifdef STAGE_FOUR_POINTS
    let d = patch_point(input, 3u, 0u).xyz;
    return a + (b - a) * at.x + (d - a) * at.y + (a - b + c - d) * (at.x * at.y);
#else
    return c + (a - c) * at.x + (b - c) * at.y;
#endif
}
