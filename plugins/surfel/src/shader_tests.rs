//! The footprint's shader: all variants validate, the uniform has its layout; and the manifest fits the code.

#[path = "../../visibility/src/shader_checks.rs"]
mod shader_checks;

use crate::{DISK, DiskUniform};
use core::mem::offset_of;
use pointstage_visibility::linked_variants;
use shader_checks::{assert_manifest, assert_variants};

#[test]
fn every_variant_validates_with_the_uniform_of_the_rust_side() {
    let fields = [("scale", offset_of!(DiskUniform, scale))];
    for features in [&[][..], &["cull_backs", "direct"], &["clipped"]] {
        let variants = linked_variants(&DISK, features).unwrap();
        let uniform = "footprint_shape_DiskUniform";
        assert_variants(variants, uniform, &fields, DISK.uniform_size);
    }
}

#[test]
fn the_manifest_is_valid() {
    assert_manifest(include_bytes!("../plugin.json"), "surfel");
}
