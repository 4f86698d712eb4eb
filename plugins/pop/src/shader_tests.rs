//! The shaders: all variants validate, the uniform has its layout; and the manifest fits the code.

#[path = "../../visibility/src/shader_checks.rs"]
mod shader_checks;

use crate::cpu_pixels::UNIT;
use crate::device_cut::NODE_BITS;
use crate::passes::{
    COMPUTE, Kernel, Kind, MODULES, SELECT_LEVEL, link_compute, link_raster, link_shading,
    linked_selection,
};
use crate::split::NUMBER_MARK;
use crate::uniforms::TreeUniform;
use crate::{blending, cpu_splats};
use core::mem::offset_of;
use pointstage_visibility::{LARGE_COUNT, SUMS, Source, TargetSet};
use shader_checks::{assert_constants, assert_manifest, assert_variants, validated};

const KINDS: [Kind; 4] = [
    Kind::Splats,
    Kind::Triangles,
    Kind::AllTriangles,
    Kind::Points,
];
const KERNELS: [Kernel; 3] = [
    Kernel::Whole,
    Kernel::NearestDepth,
    Kernel::GreatestPrimitive,
];
const LOOKS: [&[&str]; 8] = [
    &["nodes", "triangles"],
    &["triangles", "gouraud"],
    &["nodes", "pop_colours"],
    &["nodes", "triangles", "gouraud", "pop_colours"],
    &["points", "pop_colours"],
    &["nodes", "triangles", "blended"],
    &["points", "blended", "pop_colours"],
    &["nodes", "blended", "gouraud"],
];

#[test]
fn every_visibility_variant_validates_with_the_uniform_of_the_rust_side() {
    let fields = [
        ("origin", offset_of!(TreeUniform, origin)),
        ("step", offset_of!(TreeUniform, step)),
        ("base", offset_of!(TreeUniform, base)),
        ("node_count", offset_of!(TreeUniform, node_count)),
        ("triangle_count", offset_of!(TreeUniform, triangle_count)),
        ("vertex_count", offset_of!(TreeUniform, vertex_count)),
        ("first_leaf", offset_of!(TreeUniform, first_leaf)),
        ("count_at", offset_of!(TreeUniform, count_at)),
        ("list_first", offset_of!(TreeUniform, list_first)),
        ("list_step", offset_of!(TreeUniform, list_step)),
        ("stretch", offset_of!(TreeUniform, stretch)),
        ("point_px", offset_of!(TreeUniform, point_px)),
        ("owns_vertices", offset_of!(TreeUniform, owns_vertices)),
        ("level_count", offset_of!(TreeUniform, level_count)),
        ("level_starts", offset_of!(TreeUniform, level_starts)),
    ];
    let mut variants = Vec::new();
    for kind in KINDS {
        for is_disk in [false, true] {
            for (kernel, is_wide) in KERNELS.into_iter().zip([true, false, true]) {
                let wgsl = link_compute(kind, is_disk, kernel, is_wide).unwrap();
                variants.push((format!("compute {kind:?} {is_disk} {kernel:?}"), wgsl));
            }
            let wgsl = link_raster(kind, is_disk).unwrap();
            variants.push((format!("raster {kind:?} {is_disk}"), wgsl));
        }
    }
    assert_variants(
        variants,
        "pop_tree_TreeUniform",
        &fields,
        size_of::<TreeUniform>() as u64,
    );
}

#[test]
fn the_selection_validates() {
    for wgsl in linked_selection().unwrap() {
        validated("selection", &wgsl);
    }
}

#[test]
fn the_shading_pass_validates() {
    let mut looks = LOOKS.iter().cycle();
    for set in TargetSet::each().step_by(5) {
        for source in [Source::Ids, Source::Pixels] {
            let look = looks.next().unwrap();
            let wgsl = link_shading(source, set, look).unwrap();
            validated(&format!("shading {set:?} {source:?} {look:?}"), &wgsl);
        }
    }
}

#[test]
fn the_attribute_passes_of_blended_splats_validate() {
    for kind in [Kind::Splats, Kind::Points] {
        for flag in [false, true] {
            let raster = blending::link_raster(kind, flag).unwrap();
            validated(&format!("blended {kind:?} {flag}, raster"), &raster);
            for adds_64 in [false, true] {
                let compute = blending::link_compute(kind, flag, adds_64, !flag).unwrap();
                validated(&format!("blended {kind:?} {flag}, compute"), &compute);
            }
        }
    }
}

#[test]
fn constants_are_those_of_the_shaders() {
    let module = |path: &str| {
        let mut modules = MODULES.iter();
        modules.find(|module| module.path == path).unwrap().source
    };
    let kernel = [
        ("REACH", cpu_splats::REACH),
        ("DEEP", cpu_splats::DEEP),
        ("BACK", cpu_splats::BACK),
    ];
    assert_constants(
        module("pop::blending"),
        &kernel.map(|(name, value)| (name, f64::from(value))),
    );
    let mark = f64::from(NUMBER_MARK);
    assert_constants(module("pop::tree"), &[("NUMBER_MARK", mark)]);
    let bits = f64::from(NODE_BITS);
    assert_constants(SELECT_LEVEL.source, &[("NODE_BITS", bits)]);
    let large = f64::from(LARGE_COUNT);
    assert_constants(COMPUTE.source, &[("LARGE_COUNT", large)]);
    assert_constants(SUMS.source, &[("UNIT", f64::from(UNIT))]);
}

#[test]
fn the_manifest_is_valid() {
    assert_manifest(include_bytes!("../plugin.json"), "pop");
}
