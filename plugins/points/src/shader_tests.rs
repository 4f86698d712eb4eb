//! The footprint's shader: all variants validate, the uniform has its layout; and the manifest fits the code.

#[path = "../../visibility/src/shader_checks.rs"]
mod shader_checks;

use crate::SPRITE;
use crate::settings::SpriteUniform;
use core::mem::offset_of;
use pointstage_visibility::linked_variants;
use shader_checks::{assert_manifest, assert_variants};

#[test]
fn every_variant_validates_with_the_uniform_of_the_rust_side() {
    let fields = [
        ("size", offset_of!(SpriteUniform, size)),
        ("least_px", offset_of!(SpriteUniform, least_px)),
        ("greatest_px", offset_of!(SpriteUniform, greatest_px)),
    ];
    for features in [
        &[][..],
        &["round"],
        &["attenuated"],
        &["cull_backs", "direct"],
    ] {
        let variants = linked_variants(&SPRITE, features).unwrap();
        let uniform = "footprint_shape_SpriteUniform";
        assert_variants(variants, uniform, &fields, SPRITE.uniform_size);
    }
}

#[test]
fn the_manifest_is_valid() {
    assert_manifest(include_bytes!("../plugin.json"), "points");
}
