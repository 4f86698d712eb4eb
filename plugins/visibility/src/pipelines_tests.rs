//! Every variant of every pass links and validates.

use super::*;
use crate::buffers::LARGE_COUNT;
use crate::shader_checks::{assert_constants, constants, validated};

/// A footprint of one pixel, for tests of the passes alone.
const PIXEL: &str = "
    import lib::camera::{clip_from_view, pixel_from_clip, view_from_object};
    import lib::surfel::{load_position_radius, surfel_number};
    struct PixelUniform { depth_scale: f32 }
    @group(2) @binding(0) var<uniform> settings: PixelUniform;
    struct Footprint { number: u32, pixels: vec4i, depth: f32 }
    fn footprint_of(index: u32) -> Footprint {
        let number = surfel_number(index);
        let clip = clip_from_view(view_from_object(load_position_radius(number).xyz));
        let pixel = vec2i(pixel_from_clip(clip));
        return Footprint(number, vec4i(pixel, pixel + vec2i(1)), settings.depth_scale * clip.z / clip.w);
    }
    fn footprint_covers(footprint: Footprint, pixel: vec2f) -> bool { return true; }
    fn footprint_depth(footprint: Footprint, pixel: vec2f) -> f32 { return footprint.depth; }
    fn footprint_flat(footprint: Footprint) -> vec3f { return vec3f(0.0); }
    fn flat_covers(flat: vec3f, pixel: vec2f) -> bool { return true; }
    fn footprint_linear(footprint: Footprint, pixel: vec2f) -> vec3f { return vec3f(0.0); }
    fn linear_covers(linear: vec3f) -> bool { return true; }
    fn both_cover(flat: vec3f, linear: vec3f, depth: f32) -> bool { return true; }
";

fn footprint(varying: Varying) -> Footprint {
    Footprint {
        name: "pixel",
        source: PIXEL,
        varying,
        uniform_size: 4,
    }
}

#[test]
fn every_visibility_variant_validates() {
    for varying in [Varying::Flat, Varying::Linear, Varying::Both] {
        for (name, wgsl) in linked_variants(&footprint(varying), &[]).unwrap() {
            validated(&name, &wgsl);
        }
    }
}

#[test]
fn every_set_of_targets_shades() {
    // Opaque splats have no weights.
    let is_opaque = |set: &TargetSet| !set.features().contains(&"weight");
    for set in TargetSet::each().filter(is_opaque) {
        let wgsl = link_shading(Source::Pixels, set).unwrap();
        validated(&format!("pixels {set:?}"), &wgsl);
        let colours_only = !set.has_depth() && set.formats().next().is_some();
        if colours_only {
            validated(
                &format!("ids {set:?}"),
                &link_shading(Source::Ids, set).unwrap(),
            );
        }
    }
}

#[test]
fn constants_are_those_of_the_shaders() {
    let quads = f64::from(QUADS_PER_INSTANCE);
    assert_constants(VISIBILITY_PASS.source, &[("QUADS_PER_INSTANCE", quads)]);
    let large = f64::from(LARGE_COUNT);
    assert_constants(VISIBILITY_COMPUTE.source, &[("LARGE_COUNT", large)]);
    let sizes = [GROUP, WIDE_GROUP].map(f64::from);
    assert_eq!(constants(VISIBILITY_COMPUTE.source, "GROUP_SIZE"), sizes);
}
