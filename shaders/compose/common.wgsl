// Shared by the passes of this folder. The host puts this file before each of them; together they are plain WGSL.
//
// Each pass reads one target and writes words, one or more a pixel, row by row from `first_row` on. The names and formulas
// are those of the CPU twin, host/engine/src/frame/compose_cpu.rs.

/// What is composed; the field order is that of `Uniform` in host/engine/src/frame/compose.rs.
struct Composition {
    // Stops of the ramp, dark to bright, sRGB.
    ramp: array<vec4f, 10>,
    // Colours of the `kind` target by value, sRGB; the last stands for all others.
    kinds: array<vec4f, 5>,
    // sRGB; w is 1 for an opaque background and 0 for none.
    background_top: vec4f,
    background_bottom: vec4f,
    // Eye distance = (x + y·depth) / (z + w·depth).
    distance_terms: vec4f,
    size_px: vec2u,
    // The rows of this band.
    first_row: u32,
    row_count: u32,
    // One of the constants below.
    appearance: u32,
    // What means 'nothing' in a target of numbers.
    clear_number: u32,
    // What means 'nothing' in a target of floats, and how near to it still does.
    clear_value: f32,
    clear_tolerance: f32,
    exposure: f32,
    // The tile's place in the whole image, px.
    tile_origin_y_px: f32,
    image_height_px: f32,
    // Components of a pixel that are read back.
    channels: u32,
    // Values at the ramp's dark and bright end, if `has_given_ends` is 1; else they are those in view.
    given_ends: vec2f,
    has_given_ends: u32,
    padding: u32,
}

const COLOURS: u32 = 0u;
const NORMALS: u32 = 1u;
const DEPTH: u32 = 2u;
const IDENTITIES: u32 = 3u;
const KINDS: u32 = 4u;
const RAMP_FROM_ZERO: u32 = 5u;
const RAMP: u32 = 6u;

const GREATEST_FLOAT: f32 = 3.4028234e38;

@group(0) @binding(0) var<uniform> composition: Composition;
// The output: pictures as rgba8, planes as bits.
@group(0) @binding(2) var<storage, read_write> words: array<u32>;
// Least and greatest value in view, as keys; least above greatest where nothing is in view.
@group(0) @binding(3) var<storage, read_write> range_keys: array<atomic<u32>, 2>;

/// Whether the invocation has a pixel in this band.
fn in_band(pixel: vec2u) -> bool {
    return pixel.x < composition.size_px.x && pixel.y < composition.row_count;
}

/// The value if it is above 0, else 0; also for NaN.
fn positive(value: f32) -> f32 {
    return select(0.0, value, value > 0.0);
}

/// The nearest 8-bit code of a value in 0..1, without any curve.
fn unorm8(value: f32) -> u32 {
    return u32(floor(clamp(value, 0.0, 1.0) * 255.0 + 0.5));
}

fn pack(red: u32, green: u32, blue: u32, alpha: u32) -> u32 {
    return red | (green << 8u) | (blue << 16u) | (alpha << 24u);
}

fn opaque_bytes(srgb: vec3f) -> u32 {
    return pack(unorm8(srgb.r), unorm8(srgb.g), unorm8(srgb.b), 255u);
}

/// IEC 61966-2-1.
fn linear_from_srgb(srgb: f32) -> f32 {
    return select(pow((srgb + 0.055) / 1.055, 2.4), srgb / 12.92, srgb <= 0.04045);
}

/// IEC 61966-2-1; what is above 1 gives 1.
fn srgb_from_linear(linear: f32) -> f32 {
    let light = min(linear, 1.0);
    return select(1.055 * pow(light, 1.0 / 2.4) - 0.055, light * 12.92, light <= 0.0031308);
}

/// The background in a row, sRGB. Interpolated as it looks, in sRGB, and not as light.
fn background_srgb(y: u32) -> vec3f {
    let row_centre = composition.tile_origin_y_px + f32(y) + 0.5;
    let position = clamp(row_centre / composition.image_height_px, 0.0, 1.0);
    let top = composition.background_top.rgb;
    return top + (composition.background_bottom.rgb - top) * position;
}

fn background_bytes(y: u32) -> u32 {
    return select(0u, opaque_bytes(background_srgb(y)), composition.background_top.w > 0.0);
}

/// Distance along the line of sight, scene units, from reversed depth.
fn distance_with(depth: f32) -> f32 {
    let terms = composition.distance_terms;
    return (terms.x + terms.y * depth) / (terms.z + terms.w * depth);
}

/// Whether something was drawn where a float target has this value; NaN is nothing.
fn is_drawn(value: f32) -> bool {
    if composition.appearance == DEPTH {
        return value > 0.0;
    }
    return abs(value - composition.clear_value) > composition.clear_tolerance;
}

/// Whether a value is finite: NaN fails every comparison.
fn is_finite(value: f32) -> bool {
    return abs(value) <= GREATEST_FLOAT;
}

/// A number that sorts as the float does.
fn key_of_float(value: f32) -> u32 {
    let bits = bitcast<u32>(value);
    return select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
}

fn float_of_key(key: u32) -> f32 {
    return bitcast<f32>(select(~key, key & 0x7fffffffu, (key & 0x80000000u) != 0u));
}

/// The values at the ramp's dark and bright end: those given, or from the least and the greatest value in view.
fn ramp_ends(least: f32, greatest: f32) -> vec2f {
    if composition.has_given_ends == 1u {
        return composition.given_ends;
    }
    switch composition.appearance {
        // Reversed z: the least depth is the farthest, and the nearest is brightest.
        case DEPTH: { return vec2f(distance_with(least), distance_with(greatest)); }
        case RAMP_FROM_ZERO: { return vec2f(0.0, greatest); }
        default: { return vec2f(least, greatest); }
    }
}

/// Colour of the ramp at a position from 0 (dark) to 1 (bright), sRGB.
fn ramp_colour(position: f32) -> vec3f {
    let scaled = clamp(position, 0.0, 1.0) * 9.0;
    let below = min(u32(scaled), 8u);
    let low = composition.ramp[below].rgb;
    return low + (composition.ramp[below + 1u].rgb - low) * (scaled - f32(below));
}

/// The ramp's colour of a value.
fn on_ramp(value: f32, ends: vec2f) -> u32 {
    let span = ends.y - ends.x;
    let position = select((value - ends.x) / span, 0.0, span == 0.0);
    return opaque_bytes(ramp_colour(position));
}
