// Lays a target of colours over the background. A pass of its own, since it makes nearly every picture, and software
// devices run all that a pass could do.
//
// reads   colours (colour, or a declared target)
// writes  words: one a pixel, sRGB, straight alpha, red in the lowest byte

@group(0) @binding(1) var colours: texture_2d<f32>;

/// Premultiplied linear light over the background.
fn over_background(colour: vec4f, y: u32) -> u32 {
    let alpha = min(positive(colour.a), 1.0);
    let exposed = colour.rgb * composition.exposure;
    var light = vec3f(positive(exposed.r), positive(exposed.g), positive(exposed.b));
    if alpha == 0.0 && all(light == vec3f(0.0)) {
        return background_bytes(y);
    }
    var alpha_byte = 255u;
    if composition.background_top.w > 0.0 {
        let srgb = background_srgb(y);
        let behind = vec3f(linear_from_srgb(srgb.r), linear_from_srgb(srgb.g), linear_from_srgb(srgb.b));
        light += behind * (1.0 - alpha);
    } else if alpha > 0.0 {
        light /= alpha;
        alpha_byte = unorm8(alpha);
    } else {
        return 0u;
    }
    return pack(
        unorm8(srgb_from_linear(light.r)),
        unorm8(srgb_from_linear(light.g)),
        unorm8(srgb_from_linear(light.b)),
        alpha_byte,
    );
}

@compute @workgroup_size(64, 4)
fn compose_colours(@builtin(global_invocation_id) pixel: vec3u) {
    if !in_band(pixel.xy) {
        return;
    }
    let y = composition.first_row + pixel.y;
    let colour = textureLoad(colours, vec2u(pixel.x, y), 0);
    words[pixel.y * composition.size_px.x + pixel.x] = over_background(colour, y);
}
