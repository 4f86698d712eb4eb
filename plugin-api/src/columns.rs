//! Surfel columns: their names, their layouts and the packing of normals and colours.
//!
//! A column holds the same bytes on the CPU and on the GPU. Nobody unpacks by hand: this module is the Rust side, and each
//! function here has a WGSL twin of the same name in the shader library, built on WGSL's own `pack2x16snorm`,
//! `unpack2x16snorm`, `pack4x8unorm` and `unpack4x8unorm`, whose rounding is repeated here to the bit.
//!
//! | column | bytes a surfel | meaning |
//! |---|---|---|
//! | [`POSITION_RADIUS`] | 16, [`PositionRadius`] | centre relative to the object's origin, and radius, scene units |
//! | [`NORMAL`] | 4, [`encode_normal`] | unit, outward, object space |
//! | [`COLOUR`] | 4, [`encode_colour`] | sRGB with straight alpha |
//! | [`AXES`] | 32, [`TangentAxes`] | tangent half-axes u and v of an elliptical surfel, object space |
//! | [`TRIANGLES`] | 12 a triangle | three vertex indices, counted over the whole object |
//! | [`TRIANGLE_TEXTURES`] | 4 a triangle | number of its texture, `u32::MAX` for none |
//! | [`TRIANGLE_UVS`] | 24 a triangle | u and v of each corner, f32; v from the top |
//! | [`TEXTURE_FILE`] | as the file has | a whole PNG or JPEG file; one column for each texture, in the order of their numbers |
//!
//! What belongs to triangles, and the files, is on the CPU only, but for the triangles themselves.

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec4};

/// Name of the column of centres and radii.
pub const POSITION_RADIUS: &str = "position_radius";
/// Name of the column of packed normals.
pub const NORMAL: &str = "normal";
/// Name of the column of packed colours.
pub const COLOUR: &str = "colour";
/// Name of the column of tangent half-axes.
pub const AXES: &str = "axes";
/// Name of the triangle list of an object.
pub const TRIANGLES: &str = "triangles";

/// Name of an object's column that says which texture each triangle takes.
pub const TRIANGLE_TEXTURES: &str = "triangle_textures";
/// Name of an object's column of texture coordinates of its triangles' corners.
pub const TRIANGLE_UVS: &str = "triangle_uvs";
/// Name of an object's columns that are the files of its textures.
pub const TEXTURE_FILE: &str = "texture_file";

/// The most surfels that a block may hold: 4 Mi.
///
/// Its widest columns are then 64 MiB (centres and radii) and 128 MiB (axes); a storage buffer binding of software Vulkan
/// ends at 128 MiB.
pub const MAX_BLOCK_SURFELS: usize = 4 << 20;

/// Packed normal of a surfel whose normal is not known: [`encode_normal`] never gives it. Decodes to −z.
pub const NO_NORMAL: u32 = 0x8000_8000;

/// Centre (xyz, relative to the object's origin) and radius (w) of a surfel's disk, scene units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub struct PositionRadius(pub [f32; 4]);

impl PositionRadius {
    /// Joins a centre and a radius.
    #[inline]
    pub const fn new(centre_object: Vec3, radius: f32) -> Self {
        Self([centre_object.x, centre_object.y, centre_object.z, radius])
    }

    /// Centre, object space.
    #[inline]
    pub const fn centre(self) -> Vec3 {
        let [x, y, z, _] = self.0;
        Vec3::new(x, y, z)
    }

    /// Radius, scene units.
    #[inline]
    pub const fn radius(self) -> f32 {
        self.0[3]
    }
}

/// Tangent half-axes `u` and `v` of an elliptical surfel, object space, scene units: u.xyz, 0, v.xyz, 0.
///
/// Both are orthogonal to the normal; their lengths are the half-lengths of the ellipse's axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub struct TangentAxes(pub [f32; 8]);

impl TangentAxes {
    /// Joins two half-axes.
    #[inline]
    pub const fn new(u: Vec3, v: Vec3) -> Self {
        Self([u.x, u.y, u.z, 0.0, v.x, v.y, v.z, 0.0])
    }

    /// The half-axis `u`.
    #[inline]
    pub const fn u(self) -> Vec3 {
        let [x, y, z, ..] = self.0;
        Vec3::new(x, y, z)
    }

    /// The half-axis `v`.
    #[inline]
    pub const fn v(self) -> Vec3 {
        let [.., x, y, z, _] = self.0;
        Vec3::new(x, y, z)
    }
}

/// Packs a direction into 32 bits: the octahedral map, x in the low and y in the high 16 bits, as snorm16.
///
/// ```text
/// p = n.xy / (|n.x| + |n.y| + |n.z|);   n.z < 0:  p = (1 − |p.yx|) · sign(p),  sign(0) = +1
/// bits = floor(0.5 + 32767 · p), two's complement
/// ```
///
/// The length of `normal` does not matter. The error is below 0.004 degrees. A direction that is zero or not finite has no
/// image under the map; it gives 0, which decodes to +z. Callers that care count such normals first.
///
/// The map: Cigolle et al., *A Survey of Efficient Representations for Independent Unit Vectors*, JCGT 2014.
#[inline]
pub fn encode_normal(normal: Vec3) -> u32 {
    // Dividing by the largest component first keeps the sum below from overflowing or vanishing.
    let scaled = normal / normal.abs().max_element();
    let sum = scaled.x.abs() + scaled.y.abs() + scaled.z.abs();
    if !(sum.is_finite() && sum > 0.0) {
        return 0;
    }
    let upper = Vec2::new(scaled.x, scaled.y) / sum;
    let p = if scaled.z < 0.0 { fold(upper) } else { upper };
    u32::from(pack_snorm16(p.x)) | (u32::from(pack_snorm16(p.y)) << 16)
}

/// Unpacks a direction packed by [`encode_normal`]; unit length for every input.
#[inline]
pub fn decode_normal(bits: u32) -> Vec3 {
    let p = Vec2::new(
        unpack_snorm16(bits as u16),
        unpack_snorm16((bits >> 16) as u16),
    );
    let z = 1.0 - p.x.abs() - p.y.abs();
    let xy = if z < 0.0 { fold(p) } else { p };
    xy.extend(z).normalize()
}

/// Swaps the upper and the lower half of the octahedron: `(1 − |p.yx|) · sign(p)`, with sign(0) = +1.
#[inline]
fn fold(p: Vec2) -> Vec2 {
    let sign = |value: f32| if value < 0.0 { -1.0 } else { 1.0 };
    Vec2::new((1.0 - p.y.abs()) * sign(p.x), (1.0 - p.x.abs()) * sign(p.y))
}

/// `floor(0.5 + 32767 · value)` with `value` clamped to −1..1: the rounding of WGSL's `pack2x16snorm`.
#[inline]
fn pack_snorm16(value: f32) -> u16 {
    (0.5 + 32767.0 * value.clamp(-1.0, 1.0)).floor() as i16 as u16
}

/// `max(bits / 32767, −1)`: the rule of WGSL's `unpack2x16snorm`.
#[inline]
fn unpack_snorm16(bits: u16) -> f32 {
    (f32::from(bits as i16) / 32767.0).max(-1.0)
}

/// Packs a colour, sRGB with straight alpha, each component 0..1, into 32 bits: red in the lowest byte.
///
/// Each byte is `floor(0.5 + 255 · component)` of the clamped component, as WGSL's `pack4x8unorm`; NaN gives 0.
#[inline]
pub fn encode_colour(srgb_alpha: Vec4) -> u32 {
    let byte = |value: f32| (0.5 + 255.0 * value.clamp(0.0, 1.0)).floor() as u8;
    u32::from_le_bytes([
        byte(srgb_alpha.x),
        byte(srgb_alpha.y),
        byte(srgb_alpha.z),
        byte(srgb_alpha.w),
    ])
}

/// Unpacks a colour packed by [`encode_colour`]: sRGB with straight alpha, each component 0..1.
#[inline]
pub fn decode_colour(bits: u32) -> Vec4 {
    let [r, g, b, a] = bits.to_le_bytes().map(|byte| f32::from(byte) / 255.0);
    Vec4::new(r, g, b, a)
}

/// Packs four bytes (sRGB, straight alpha) into a colour.
#[inline]
pub const fn colour_from_bytes(rgba: [u8; 4]) -> u32 {
    u32::from_le_bytes(rgba)
}

/// Linear light from one sRGB component, 0..1 (IEC 61966-2-1).
#[inline]
pub fn linear_from_srgb(srgb: f32) -> f32 {
    if srgb <= 0.04045 {
        srgb / 12.92
    } else {
        ((srgb + 0.055) / 1.055).powf(2.4)
    }
}

/// sRGB component from linear light, 0..1 (IEC 61966-2-1).
#[inline]
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        linear * 12.92
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// Linear light of a packed colour; alpha stays straight.
#[inline]
pub fn decode_colour_linear(bits: u32) -> Vec4 {
    let srgb = decode_colour(bits);
    Vec4::new(
        linear_from_srgb(srgb.x),
        linear_from_srgb(srgb.y),
        linear_from_srgb(srgb.z),
        srgb.w,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn axis_directions_survive_exactly() {
        for axis in [
            Vec3::X,
            Vec3::NEG_X,
            Vec3::Y,
            Vec3::NEG_Y,
            Vec3::Z,
            Vec3::NEG_Z,
        ] {
            assert_eq!(decode_normal(encode_normal(axis)), axis, "{axis}");
        }
    }

    #[test]
    fn packed_bits_are_the_documented_ones() {
        assert_eq!(encode_normal(Vec3::X), 0x0000_7fff, "x in the low half");
        assert_eq!(encode_normal(Vec3::Y), 0x7fff_0000, "y in the high half");
        assert_eq!(
            encode_normal(Vec3::NEG_X),
            0x0000_8001,
            "−32767, never −32768"
        );
        assert_eq!(
            encode_normal(Vec3::NEG_Z),
            0x7fff_7fff,
            "sign(0) is +1 in the fold"
        );
        assert_eq!(
            encode_colour(Vec4::new(1.0, 0.0, 0.5, 0.25)),
            0x4080_00ff,
            "red in the lowest byte"
        );
    }

    #[test]
    fn directions_without_an_image_give_plus_z() {
        for bad in [Vec3::ZERO, Vec3::NAN, Vec3::new(f32::INFINITY, 1.0, 0.0)] {
            assert_eq!(encode_normal(bad), 0, "{bad}");
        }
        assert_eq!(decode_normal(0), Vec3::Z);
    }

    #[test]
    fn tiny_and_huge_directions_keep_their_direction() {
        for length in [1e-38_f32, 1e-20, 1e20, 3e38] {
            assert_eq!(
                encode_normal(Vec3::new(0.0, length, 0.0)),
                encode_normal(Vec3::Y),
                "length {length:e}"
            );
        }
    }

    #[test]
    fn nan_colour_components_are_black() {
        assert_eq!(encode_colour(Vec4::NAN), 0);
    }

    proptest! {
        #[test]
        fn normals_round_trip_within_the_stated_error(x in -1.0f32..1.0, y in -1.0f32..1.0, z in -1.0f32..1.0) {
            let direction = Vec3::new(x, y, z);
            prop_assume!(direction.length() > 1e-3);
            let unit = direction.as_dvec3().normalize();
            let decoded = decode_normal(encode_normal(direction)).as_dvec3();
            // The sine, since the cosine of so small an angle is lost in rounding.
            let error_degrees = unit.cross(decoded).length().asin().to_degrees();
            prop_assert!(error_degrees < 0.004 && unit.dot(decoded) > 0.0, "{error_degrees} degrees");
            prop_assert_ne!(encode_normal(direction), NO_NORMAL);
        }

        #[test]
        fn every_packed_normal_is_unit_and_finite(bits: u32) {
            let length = decode_normal(bits).length();
            prop_assert!((length - 1.0).abs() < 1e-6, "{length}");
        }

        #[test]
        fn packed_colours_round_trip_exactly(bits: u32) {
            prop_assert_eq!(encode_colour(decode_colour(bits)), bits);
        }

        #[test]
        fn srgb_and_linear_are_inverse(value in 0.0f32..=1.0) {
            let back = srgb_from_linear(linear_from_srgb(value));
            prop_assert!((back - value).abs() < 1e-5, "{value} gave {back}"); // 1e-5 is 0.003 of an 8-bit step
        }
    }
}
