//! The shaders: all variants validate, the uniform has its layout; and the manifest fits the code.

#[path = "../../visibility/src/shader_checks.rs"]
pub(crate) mod shader_checks;

use crate::passes::{
    ATTRIBUTES_COMPUTE, ATTRIBUTES_PASS, SPLAT, Sums, link_compute, link_raster, link_shading,
};
use crate::settings::SplatUniform;
use core::mem::offset_of;
use pointstage_visibility::{LARGE_COUNT, QUADS_PER_INSTANCE, TargetSet, linked_variants};
use shader_checks::{assert_constants, assert_manifest, assert_variants, validated};

/// Of the shading pass.
const LOOKS: [&[&str]; 8] = [
    &[],
    &["phong"],
    &["lit_splats"],
    &["flat_normals"],
    &["toon"],
    &["shows_normals"],
    &["shows_weight"],
    &["shows_depth"],
];
const FEATURES: [&[&str]; 6] = [
    &[],
    &["low_pass"],
    &["low_pass", "cull_backs", "direct"],
    &["low_pass", "lit_splats"],
    &["clipped"],
    &["low_pass", "clipped", "direct"],
];

#[test]
fn every_visibility_variant_validates_with_the_uniform_of_the_rust_side() {
    let fields = [
        ("scale", offset_of!(SplatUniform, scale)),
        ("cutoff", offset_of!(SplatUniform, cutoff)),
        ("falloff", offset_of!(SplatUniform, falloff)),
        ("push", offset_of!(SplatUniform, push)),
        ("filter_px", offset_of!(SplatUniform, filter_px)),
        ("two_sided", offset_of!(SplatUniform, two_sided)),
        ("bands", offset_of!(SplatUniform, bands)),
        ("outline", offset_of!(SplatUniform, outline)),
    ];
    for features in FEATURES {
        let variants = linked_variants(&SPLAT, features).unwrap();
        let uniform = "footprint_shape_SplatUniform";
        assert_variants(variants, uniform, &fields, SPLAT.uniform_size);
    }
}

#[test]
fn the_attribute_and_shading_passes_validate() {
    for features in FEATURES {
        validated("attributes, raster", &link_raster(features).unwrap());
        for wide in [&[][..], &["wide"], &["wide", "int64_add"]] {
            let features = [features, wide].concat();
            validated("attributes, compute", &link_compute(&features).unwrap());
        }
        let mut looks = LOOKS.iter().cycle();
        for set in TargetSet::each().step_by(7) {
            // Shading clips nothing.
            let features: Vec<_> = features.iter().filter(|its| **its != "clipped").collect();
            let features: Vec<_> = features.into_iter().copied().collect();
            for sums in [Sums::Textures, Sums::Buffers, Sums::Resolved] {
                let features = [&features[..], looks.next().unwrap()].concat();
                let wgsl = link_shading(sums, set, &features).unwrap();
                validated(&format!("shading {set:?} {sums:?} {features:?}"), &wgsl);
            }
        }
    }
}

#[test]
fn quads_and_large_splats_are_as_many_as_their_buffers_hold() {
    let quads = f64::from(QUADS_PER_INSTANCE);
    assert_constants(ATTRIBUTES_PASS.source, &[("QUADS_PER_INSTANCE", quads)]);
    let large = f64::from(LARGE_COUNT);
    assert_constants(ATTRIBUTES_COMPUTE.source, &[("LARGE_COUNT", large)]);
}

#[test]
fn the_manifest_is_valid() {
    assert_manifest(include_bytes!("../plugin.json"), "hqss");
}
