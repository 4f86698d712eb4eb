// Turns a target of floats into a picture: normals as colours, or a ramp.
//
// reads   floats (normal, depth, weight, or a declared target), range_keys for ramps
// writes  words: one a pixel, sRGB, straight alpha, red in the lowest byte

@group(0) @binding(1) var floats: texture_2d<f32>;

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
    let has_ends = least <= greatest || composition.has_given_ends == 1u;
    if !is_drawn(value) || !has_ends {
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
    if composition.appearance == NORMALS {
        word = show_normal(value.xyz, y);
    } else {
        word = show_on_ramp(value.x, y);
    }
    words[pixel.y * composition.size_px.x + pixel.x] = word;
}
