// Finds the least and the greatest value of a target of floats; what is nothing or not finite does not count.
//
// reads   floats
// writes  range_keys: least and greatest, as keys that sort as the floats do

@group(0) @binding(1) var floats: texture_2d<f32>;

var<workgroup> least_key: atomic<u32>;
var<workgroup> greatest_key: atomic<u32>;

@compute @workgroup_size(64, 4)
fn range_floats(
    @builtin(global_invocation_id) pixel: vec3u,
    @builtin(local_invocation_index) local_index: u32,
) {
    if local_index == 0u {
        atomicStore(&least_key, 0xffffffffu);
        atomicStore(&greatest_key, 0u);
    }
    workgroupBarrier();
    if all(pixel.xy < composition.size_px) {
        let value = textureLoad(floats, pixel.xy, 0).x;
        if is_drawn(value) && is_finite(value) {
            let key = key_of_float(value);
            atomicMin(&least_key, key);
            atomicMax(&greatest_key, key);
        }
    }
    workgroupBarrier();
    if local_index == 0u {
        atomicMin(&range_keys[0], atomicLoad(&least_key));
        atomicMax(&range_keys[1], atomicLoad(&greatest_key));
    }
}
