// Copies a target of numbers to a buffer.
//
// reads   numbers
// writes  words: one number a pixel

@group(0) @binding(1) var numbers: texture_2d<u32>;

@compute @workgroup_size(64, 4)
fn read_numbers(@builtin(global_invocation_id) pixel: vec3u) {
    if !in_band(pixel.xy) {
        return;
    }
    let number = textureLoad(numbers, vec2u(pixel.x, composition.first_row + pixel.y), 0).x;
    words[pixel.y * composition.size_px.x + pixel.x] = number;
}
