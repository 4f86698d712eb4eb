// Copies a target of floats to a buffer. A copy command would do on Vulkan; GL copies no depth, and every other format would
// need a decoder of its own on the CPU.
//
// reads   floats
// writes  words: the bits of `channels` floats a pixel

@group(0) @binding(1) var floats: texture_2d<f32>;

@compute @workgroup_size(64, 4)
fn read_floats(@builtin(global_invocation_id) pixel: vec3u) {
    if !in_band(pixel.xy) {
        return;
    }
    let value = textureLoad(floats, vec2u(pixel.x, composition.first_row + pixel.y), 0);
    let start = (pixel.y * composition.size_px.x + pixel.x) * composition.channels;
    words[start] = bitcast<u32>(value.x);
    if composition.channels == 4u {
        words[start + 1u] = bitcast<u32>(value.y);
        words[start + 2u] = bitcast<u32>(value.z);
        words[start + 3u] = bitcast<u32>(value.w);
    }
}
