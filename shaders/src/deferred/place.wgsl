#define_import_path dolomite::deferred::place

// Where a pixel's surface lies, relative to the camera: what is added to the camera's own place comes last or
// never, so that the result is as good a million metres from the origin as at it.

// `xy` of normalised device coordinates of a place in the target, in pixels; `viewport` is x, y, width, height.
fn ndc_of(pixels: vec2<f32>, viewport: vec4<f32>) -> vec2<f32> {
    return (pixels - viewport.xy) / viewport.zw * vec2(2.0, -2.0) + vec2(-1.0, 1.0);
}

// View space, metres; `ndc.z` is depth: 1 on the near plane, 0 at infinity.
fn in_view(ndc: vec3<f32>, view_from_clip: mat4x4<f32>) -> vec3<f32> {
    let place = view_from_clip * vec4(ndc, 1.0);
    return place.xyz / place.w;
}

// World axes, from the camera, metres.
fn from_camera(in_view: vec3<f32>, world_from_view: mat4x4<f32>) -> vec3<f32> {
    return world_from_view[0].xyz * in_view.x + world_from_view[1].xyz * in_view.y + world_from_view[2].xyz * in_view.z;
}

// Towards the camera, length 1.
fn towards_camera(from_camera: vec3<f32>, clip_from_view: mat4x4<f32>, world_from_view: mat4x4<f32>) -> vec3<f32> {
    // Orthographic: all rays run along the camera's own axis.
    let orthographic = clip_from_view[3].w == 1.0;
    return normalize(select(-from_camera, world_from_view[2].xyz, orthographic));
}
