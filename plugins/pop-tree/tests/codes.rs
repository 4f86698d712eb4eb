//! The codes of a node are off by no more than their documentation says.

use pointstage_plugin_api::glam::Vec3;
use pointstage_pop_tree::{
    Grid, NO_CONE, Node, NodeParts, decode_half_angle, decode_normal20, decode_radius,
    encode_half_angle, encode_normal20, encode_radius,
};
use proptest::prelude::*;

fn error_degrees(direction: Vec3) -> f64 {
    let decoded = decode_normal20(encode_normal20(direction));
    decoded
        .as_dvec3()
        .angle_between(direction.as_dvec3())
        .to_degrees()
}

#[test]
fn normals_are_off_by_a_bounded_angle() {
    let mut worst = (0.0, Vec3::ZERO);
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let count = 3_000_000;
    for number in 0..count {
        let z = 1.0 - (f64::from(number) + 0.5) * 2.0 / f64::from(count);
        let (sin, cos) = (golden * f64::from(number)).sin_cos();
        let across = (1.0 - z * z).sqrt();
        let direction = Vec3::new((across * cos) as f32, (across * sin) as f32, z as f32);
        let error = error_degrees(direction);
        if error > worst.0 {
            worst = (error, direction);
        }
    }
    assert!(worst.0 < 0.24, "{worst:?}");
}

#[test]
fn axes_are_exact() {
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        assert_eq!(decode_normal20(encode_normal20(axis)), axis);
        assert_eq!(decode_normal20(encode_normal20(-axis)), -axis);
    }
}

#[test]
fn every_normal_code_decodes_to_unit_length() {
    for code in 0..1 << 20 {
        let length = decode_normal20(code).length();
        assert!((length - 1.0).abs() < 1e-6, "{code}");
    }
}

proptest! {
    #[test]
    fn centres_are_off_by_at_most_0_64_steps(
        origin in prop::array::uniform3(-100.0_f32..100.0),
        extent in prop::array::uniform3(0.001_f32..100.0),
        at in prop::array::uniform3(0.0_f32..=1.0),
    ) {
        let (least, extent) = (Vec3::from_array(origin), Vec3::from_array(extent));
        let grid = Grid::over(least, least + extent);
        let position = least + extent * Vec3::from_array(at);
        let off = (grid.position(grid.quantise(position)).as_dvec3() - position.as_dvec3()).abs().max_element();
        // A float in this range has that much rounding of its own, twice.
        let rounding = f64::from(position.abs().max_element().max(least.abs().max_element())) * 2.0_f64.powi(-23);
        prop_assert!(off <= 0.64 * f64::from(grid.step) + rounding, "{} steps", off / f64::from(grid.step));
    }

    #[test]
    fn radii_are_rounded_up_by_at_most_one_in_256(radius in 1e-37_f32..1e37) {
        let decoded = decode_radius(encode_radius(radius));
        prop_assert!(decoded >= radius && f64::from(decoded) <= f64::from(radius) * (1.0 + 1.0 / 256.0));
    }

    #[test]
    fn half_angles_are_rounded_up_by_at_most_a_step(degrees in 0.0_f32..=90.0) {
        let code = encode_half_angle(degrees.to_radians());
        // Right under 90 degrees, rounding may make it more.
        prop_assume!(code != NO_CONE || degrees < 89.999);
        let decoded = decode_half_angle(code).to_degrees();
        prop_assert!(decoded >= degrees - 1e-5 && decoded <= degrees + 0.36, "{degrees} is {decoded}");
    }

    #[test]
    fn parts_come_back(
        place in prop::array::uniform3(0_u32..1 << 21),
        radius_code: u16, cone_code: u8, normal_code in 0_u32..1 << 20,
        colour in prop::array::uniform3(0.0_f32..=1.0), link: u32,
    ) {
        let place = place.into();
        let node = Node::new(&NodeParts { place, radius_code, cone_code, normal_code, colour, link });
        prop_assert_eq!((node.place(), node.radius_code(), node.cone_code(), node.link()), (place, radius_code, cone_code, link));
        prop_assert_eq!(node.normal(), decode_normal20(normal_code));
        for ((found, expected), levels) in node.colour().into_iter().zip(colour).zip([63.0, 127.0, 63.0]) {
            prop_assert!((found - expected).abs() <= 0.5 / levels + 1e-6);
        }
    }
}

#[test]
fn extreme_codes() {
    assert_eq!(decode_radius(encode_radius(0.0)), 0.0);
    assert!(decode_radius(encode_radius(f32::MAX)).is_finite());
    assert!(decode_radius(encode_radius(f32::from_bits(1))) >= f32::from_bits(1));
    assert_eq!(encode_half_angle(1.6), NO_CONE);
    assert_eq!(encode_half_angle(0.0), 0);
    assert_eq!(encode_half_angle(std::f32::consts::PI), NO_CONE);
    let children = Node([0, 0, 0, 0, Node::link_to((1 << 30) - 4, 4)]).children();
    assert_eq!(children, (1 << 30) - 4..1 << 30);
}
