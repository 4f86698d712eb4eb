// Turns a target of floats into a picture: the colours over the background, normals as colours, or a ramp.
//
// reads   floats (colour, normal, depth, weight, or a declared target), range_keys for ramps
// writes  words: one a pixel, sRGB, straight alpha, red in the lowest byte

@group(0) @binding(1) var floats: texture_2d<f32>;

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

/// A direction as a colour: −1..1 to 0..1.
fn show_normal(normal: vec3f, y: u32) -> u32 {
    let length_squared = dot(normal, normal);
    if !(length_squared > 0.0 && is_finite(length_squared)) {
        return background_bytes(y);
    }
    return opaque_bytes(normal / sqrt(length_squared) * 0.5 + 0.5);
}

fn show_on_ramp(value: f32, y: u32) -> u32 {
    let least = atomicLoad(&range_keys[0]);
    let greatest = atomicLoad(&range_keys[1]);
    if !is_drawn(value) || least > greatest {
        return background_bytes(y);
    }
    let ends = ramp_ends(float_of_key(least), float_of_key(greatest));
    if composition.appearance == DEPTH {
        return on_ramp(distance_with(value), ends);
    }
    return on_ramp(value, ends);
}

@compute @workgroup_size(64, 4)
fn compose_floats(@builtin(global_invocation_id) pixel: vec3u) {
    if !in_band(pixel.xy) {
        return;
    }
    let y = composition.first_row + pixel.y;
    let value = textureLoad(floats, vec2u(pixel.x, y), 0);
    var word = 0u;
    switch composition.appearance {
        case COLOURS: { word = over_background(value, y); }
        case NORMALS: { word = show_normal(value.xyz, y); }
        default: { word = show_on_ramp(value.x, y); }
    }
    words[pixel.y * composition.size_px.x + pixel.x] = word;
}
