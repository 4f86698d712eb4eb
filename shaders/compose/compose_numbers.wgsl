// Turns a target of numbers into a picture: ids as distinct colours, kinds by their palette, or a ramp.
//
// reads   numbers (id, kind, lod, overdraw, or a declared target), range_keys for ramps
// writes  words: one a pixel, sRGB, straight alpha, red in the lowest byte

@group(0) @binding(1) var numbers: texture_2d<u32>;

/// A colour for a number, the same for the same number and far from that of its neighbours: the three bytes of a PCG hash
/// (Jarzynski and Olano, Hash Functions for GPU Rendering, JCGT 2020), lifted to 0.25..1 so that no number is black.
fn identity_colour(number: u32) -> vec3f {
    let state = number * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    let hash = (word >> 22u) ^ word;
    let bytes = vec3f(vec3u(hash, hash >> 8u, hash >> 16u) & vec3u(255u));
    return 0.25 + 0.75 * (bytes / 255.0);
}

@compute @workgroup_size(64, 4)
fn compose_numbers(@builtin(global_invocation_id) pixel: vec3u) {
    if !in_band(pixel.xy) {
        return;
    }
    let y = composition.first_row + pixel.y;
    let number = textureLoad(numbers, vec2u(pixel.x, y), 0).x;
    let least = atomicLoad(&range_keys[0]);
    let greatest = atomicLoad(&range_keys[1]);
    var word = 0u;
    if number == composition.clear_number {
        word = background_bytes(y);
    } else if composition.appearance == IDENTITIES {
        word = opaque_bytes(identity_colour(number));
    } else if composition.appearance == KINDS {
        word = opaque_bytes(composition.kinds[min(number, 4u)].rgb);
    } else {
        word = on_ramp(f32(number), ramp_ends(f32(least), f32(greatest)));
    }
    words[pixel.y * composition.size_px.x + pixel.x] = word;
}
