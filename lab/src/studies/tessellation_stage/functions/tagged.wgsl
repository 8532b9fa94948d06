
// Flat; the texture coordinates say which patch was evaluated, and on which of its sides.
fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
#ifdef STAGE_FOUR_POINTS
    let on = vec4(at.x == 0.0, at.y == 0.0, at.x == 1.0, at.y == 1.0);
#else
    let on = vec4(at.x == 0.0, at.y == 0.0, at.z == 0.0, false);
#endif
    let sides = dot(select(vec4(0.0), vec4(1.0, 2.0, 4.0, 8.0), on), vec4(1.0));
    let place = plane(input, at);
    return Vertex(place, vec3(0.0, 0.0, 1.0), vec2(f32(input.number), sides) / 32767.0, place, 0u);
}
