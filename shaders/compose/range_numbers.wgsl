// Finds the least and the greatest number of a target of numbers; what is nothing does not count.
//
// reads   numbers
// writes  range_keys: least and greatest, as they are

@group(0) @binding(1) var numbers: texture_2d<u32>;

var<workgroup> least_number: atomic<u32>;
var<workgroup> greatest_number: atomic<u32>;

@compute @workgroup_size(64, 4)
fn range_numbers(
    @builtin(global_invocation_id) pixel: vec3u,
    @builtin(local_invocation_index) local_index: u32,
) {
    if local_index == 0u {
        atomicStore(&least_number, 0xffffffffu);
        atomicStore(&greatest_number, 0u);
    }
    workgroupBarrier();
    if all(pixel.xy < composition.size_px) {
        let number = textureLoad(numbers, pixel.xy, 0).x;
        if number != composition.clear_number {
            atomicMin(&least_number, number);
            atomicMax(&greatest_number, number);
        }
    }
    workgroupBarrier();
    if local_index == 0u {
        atomicMin(&range_keys[0], atomicLoad(&least_number));
        atomicMax(&range_keys[1], atomicLoad(&greatest_number));
    }
}
