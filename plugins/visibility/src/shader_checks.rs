//! Checks of shaders and manifests that the tests of this crate and of the renderers made of it share. The renderers'
//! tests take this file by its path, so that no library carries it.

#![allow(
    dead_code,
    unreachable_pub,
    reason = "each crate's tests use their own part of this file"
)]

use naga::valid::{Capabilities, ValidationFlags, Validator};
use pointstage_plugin_api::manifest::Manifest;

/// The module of valid WGSL; `name` says which it is.
///
/// # Panics
/// When it is not valid, with the diagnosis and the whole text.
pub fn validated(name: &str, wgsl: &str) -> naga::Module {
    let module = naga::front::wgsl::parse_str(wgsl)
        .unwrap_or_else(|error| panic!("{name}: {}\n{wgsl}", error.emit_to_string(wgsl)));
    Validator::new(ValidationFlags::all(), Capabilities::all())
        .validate(&module)
        .unwrap_or_else(|error| panic!("{name}: {}\n{wgsl}", error.emit_to_string(wgsl)));
    module
}

/// Validates linked variants of a footprint's passes, and compares the struct `uniform` in each of them with the fields
/// and offsets of the Rust side.
///
/// # Panics
/// When a variant is not valid or has another layout.
pub fn assert_variants(
    variants: impl IntoIterator<Item = (String, String)>,
    uniform: &str,
    fields: &[(&str, usize)],
    size: u64,
) {
    for (name, wgsl) in variants {
        let module = validated(&name, &wgsl);
        let mut structs = module.types.iter().filter_map(|(_, found)| {
            let naga::TypeInner::Struct { members, span } = &found.inner else {
                return None;
            };
            (found.name.as_deref() == Some(uniform)).then_some((members, *span))
        });
        let Some((members, span)) = structs.next() else {
            panic!("{name} has no struct {uniform}");
        };
        let found: Vec<_> = members
            .iter()
            .map(|member| {
                let name = member.name.as_deref().unwrap_or_default();
                (name, member.offset as usize)
            })
            .collect();
        assert_eq!(found, fields, "{name}");
        assert_eq!(u64::from(span), size, "{name}");
    }
}

/// Values of a shader's constants of this name, in the order of its text: one, or one for each condition.
///
/// # Panics
/// When a constant of the name is no number.
pub fn constants(source: &str, name: &str) -> Vec<f64> {
    let declarations = source.lines().filter_map(|line| {
        let declaration = &line[line.find("const ")?..];
        let is_whole = line.starts_with("const ") || line.starts_with("@if");
        let named = declaration.strip_prefix("const ")?.strip_prefix(name)?;
        (is_whole && named.starts_with(':')).then_some(declaration)
    });
    let value = |declaration: &str| {
        let module = validated(name, declaration);
        let (_, constant) = module.constants.iter().next().expect("it was declared");
        match module.global_expressions[constant.init] {
            naga::Expression::Literal(naga::Literal::F32(value)) => f64::from(value),
            naga::Expression::Literal(naga::Literal::U32(value)) => f64::from(value),
            ref other => panic!("{name} is {other:?}"),
        }
    };
    declarations.map(value).collect()
}

/// Compares constants of the Rust side with those of a shader.
///
/// # Panics
/// When one differs, or is missing.
pub fn assert_constants(source: &str, expected: &[(&str, f64)]) {
    for (name, value) in expected {
        assert_eq!(constants(source, name), [*value], "{name}");
    }
}

/// Checks that a manifest parses, and that its first plugin has this alias and explains and groups all its settings.
///
/// # Panics
/// When it does not.
pub fn assert_manifest(json: &[u8], alias: &str) {
    let manifest = Manifest::parse(json).unwrap_or_else(|error| panic!("{alias}: {error}"));
    let entry = &manifest.plugins[0];
    assert_eq!(entry.alias, alias);
    for setting in &entry.settings {
        let is_explained = !setting.help.is_empty() && !setting.group.is_empty();
        assert!(
            is_explained,
            "{alias}: setting '{}' has no help or no group",
            setting.id
        );
    }
}
