//! The footprint's shader: all variants validate, the uniform has its layout; and the manifest fits the code.

use crate::SPRITE;
use crate::settings::SpriteUniform;
use core::mem::offset_of;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use pointstage_plugin_api::manifest::Manifest;
use pointstage_visibility::linked_variants;

fn validated(name: &str, wgsl: &str) -> naga::Module {
    let module = naga::front::wgsl::parse_str(wgsl)
        .unwrap_or_else(|error| panic!("{name}: {}\n{wgsl}", error.emit_to_string(wgsl)));
    Validator::new(ValidationFlags::all(), Capabilities::all())
        .validate(&module)
        .unwrap_or_else(|error| panic!("{name}: {}\n{wgsl}", error.emit_to_string(wgsl)));
    module
}

#[test]
fn every_variant_validates_with_the_uniform_of_the_rust_side() {
    let rust = [
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
        for (name, wgsl) in linked_variants(&SPRITE, features).unwrap() {
            let module = validated(&name, &wgsl);
            let uniform = module
                .types
                .iter()
                .find_map(|(_, found)| match &found.inner {
                    naga::TypeInner::Struct { members, span }
                        if found.name.as_deref() == Some("footprint_shape_SpriteUniform") =>
                    {
                        Some((members, *span))
                    }
                    _ => None,
                });
            let (members, span) = uniform.unwrap_or_else(|| panic!("{name} has no uniform"));
            let shader: Vec<_> = members
                .iter()
                .map(|member| (member.name.as_deref().unwrap(), member.offset as usize))
                .collect();
            assert_eq!(shader, rust, "{name}");
            assert_eq!(u64::from(span), SPRITE.uniform_size, "{name}");
        }
    }
}

#[test]
fn the_manifest_is_valid() {
    let manifest = Manifest::parse(include_bytes!("../plugin.json")).unwrap();
    let entry = &manifest.plugins[0];
    assert_eq!(entry.alias, "points");
    assert!(
        entry
            .settings
            .iter()
            .all(|setting| !setting.help.is_empty() && !setting.group.is_empty())
    );
}
