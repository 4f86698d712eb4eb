//! A node in 20 bytes: sphere, normal, normal cone, colour and link; and the grid that its centre lies on.
//!
//! | word | bits, from the lowest |
//! |---|---|
//! | 0 | centre x, 21; centre y, lower 11 |
//! | 1 | centre y, upper 10; centre z, 21; 1 unused |
//! | 2 | radius, 16; half-angle of the normal cone, 8; green, 7; 1 unused |
//! | 3 | octahedral normal, 10 and 10; red, 6; blue, 6 |
//! | 4 | link |
//!
//! Errors of this form: the centre lies within 0.64 steps of [`Grid`] in each axis, beside the rounding of floats of its
//! size (a step is extent / 2²¹, 0.5 px where the whole object is a million pixels wide); the radius, which is taken from
//! the centre as stored, is rounded up, by at most 1 / 256; the normal is off by at most 0.24 degrees, which the cone includes;
//! the half-angle is rounded up, by at most 0.36 degrees; colours are off by at most 1 / 126 in red and blue and 1 / 254 in
//! green, in sRGB. `tests/codes.rs` measures all of them. The twin in WGSL is `shaders/pop/node.wesl`.

use bytemuck::{Pod, Zeroable};
use pointstage_plugin_api::glam::{UVec3, Vec2, Vec3};

const AXIS_BITS: u32 = 21;
const AXIS_MAX: u32 = (1 << AXIS_BITS) - 1;
/// A float's bits that a radius leaves out, below: 8 of its mantissa stay.
const RADIUS_SHIFT: u32 = 15;
pub(crate) const NORMAL_MAX: f32 = 511.0;
/// Codes of half-angles: 0 to 254 are 0 to 90 degrees in even steps.
const ANGLE_STEPS: f32 = 254.0;

/// Stands for a cone of more than 90 degrees to each side: such a node is never wholly turned away.
pub const NO_CONE: u8 = 255;

/// The lattice of quantised centres; object space.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Grid {
    /// Least corner of the object's bounds.
    pub origin: [f32; 3],
    /// Scene units from a point to the next, alike in all axes; above 0.
    pub step: f32,
}

impl Grid {
    /// The finest grid over bounds; `greatest` not less than `least`.
    pub fn over(least: Vec3, greatest: Vec3) -> Self {
        let extent = (greatest - least).max_element();
        let step = extent / AXIS_MAX as f32;
        Self {
            origin: least.to_array(),
            step: step.max(f32::MIN_POSITIVE),
        }
    }

    /// The nearest point of the grid.
    pub fn quantise(&self, position: Vec3) -> UVec3 {
        let place = (position - Vec3::from_array(self.origin)) / self.step;
        // Rounds as `round` does, which is a call on processors that have no instruction for it.
        (place.clamp(Vec3::ZERO, Vec3::splat(AXIS_MAX as f32)) + 0.5).as_uvec3()
    }

    /// Object space from the grid.
    #[inline]
    pub fn position(&self, place: UVec3) -> Vec3 {
        Vec3::from_array(self.origin) + place.as_vec3() * self.step
    }
}

/// A radius in 16 bits: the upper half of a float's bits below the sign, rounded up. `radius` is finite and not negative.
pub fn encode_radius(radius: f32) -> u16 {
    let bits = radius.max(0.0).to_bits();
    (bits.div_ceil(1 << RADIUS_SHIFT)).min(0xfeff) as u16
}

/// The radius that a code stands for; scene units, object space.
#[inline]
pub fn decode_radius(code: u16) -> f32 {
    f32::from_bits(u32::from(code) << RADIUS_SHIFT)
}

/// The code of a half-angle, rounded up; radians.
pub fn encode_half_angle(half_angle: f32) -> u8 {
    let steps = (half_angle.max(0.0) * (ANGLE_STEPS / core::f32::consts::FRAC_PI_2)).ceil();
    if steps <= ANGLE_STEPS {
        steps as u8
    } else {
        NO_CONE
    }
}

/// The half-angle that a code other than [`NO_CONE`] stands for; radians.
#[inline]
pub fn decode_half_angle(code: u8) -> f32 {
    f32::from(code) * (core::f32::consts::FRAC_PI_2 / ANGLE_STEPS)
}

/// A normal in 20 bits, 10 an axis of the octahedral map (Cigolle et al., JCGT 3(2), 2014). `direction` is not zero.
pub fn encode_normal20(direction: Vec3) -> u32 {
    let sum = direction.abs().element_sum();
    let square = Vec2::new(direction.x, direction.y) / sum;
    let folded = (Vec2::ONE - Vec2::new(square.y, square.x).abs()) * sign_not_zero(square);
    let square = if direction.z >= 0.0 { square } else { folded };
    let code = |value: f32| (value.clamp(-1.0, 1.0) * NORMAL_MAX + (NORMAL_MAX + 0.5)) as u32;
    code(square.x) | code(square.y) << 10
}

/// The unit normal of a code.
#[inline]
pub fn decode_normal20(code: u32) -> Vec3 {
    let value = |code: u32| code as f32 * (1.0 / NORMAL_MAX) - 1.0;
    let square = Vec2::new(value(code & 1023), value(code >> 10 & 1023));
    let z = 1.0 - square.x.abs() - square.y.abs();
    let folded = (Vec2::ONE - Vec2::new(square.y, square.x).abs()) * sign_not_zero(square);
    let square = if z >= 0.0 { square } else { folded };
    Vec3::new(square.x, square.y, z).normalize()
}

fn sign_not_zero(value: Vec2) -> Vec2 {
    let sign = |value: f32| if value >= 0.0 { 1.0 } else { -1.0 };
    Vec2::new(sign(value.x), sign(value.y))
}

/// What a node holds, unpacked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeParts {
    /// Centre of the sphere, on the grid.
    pub place: UVec3,
    /// See [`encode_radius`].
    pub radius_code: u16,
    /// See [`encode_half_angle`].
    pub cone_code: u8,
    /// See [`encode_normal20`].
    pub normal_code: u32,
    /// sRGB, 0 to 1.
    pub colour: [f32; 3],
    /// Inner nodes: see [`Node::children`]. Leaves: the triangle's number in the mesh.
    pub link: u32,
}

/// A node of the tree, packed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Node(pub [u32; 5]);

impl Node {
    /// Packs the parts.
    pub fn new(parts: &NodeParts) -> Self {
        let UVec3 { x, y, z } = parts.place;
        let level = |value: f32, max: f32| (value.clamp(0.0, 1.0) * max + 0.5) as u32;
        let [red, green, blue] = parts.colour;
        Self([
            x | y << 21,
            y >> 11 | z << 10,
            u32::from(parts.radius_code)
                | u32::from(parts.cone_code) << 16
                | level(green, 127.0) << 24,
            parts.normal_code | level(red, 63.0) << 20 | level(blue, 63.0) << 26,
            parts.link,
        ])
    }

    /// An inner node's link: its children are `first..first + count`, 1 to 4 of them; `first` less than 2³⁰.
    pub const fn link_to(first: u32, count: u32) -> u32 {
        first << 2 | (count - 1)
    }

    /// The same node with another link.
    pub(crate) const fn with_link(self, link: u32) -> Self {
        let [a, b, c, d, _] = self.0;
        Self([a, b, c, d, link])
    }

    /// Centre, on the grid.
    #[inline]
    pub fn place(self) -> UVec3 {
        let [low, high, ..] = self.0;
        UVec3::new(
            low & AXIS_MAX,
            low >> 21 | (high & 1023) << 11,
            high >> 10 & AXIS_MAX,
        )
    }

    /// Code of the radius.
    #[inline]
    pub fn radius_code(self) -> u16 {
        self.0[2] as u16
    }

    /// Radius of the sphere; scene units, object space.
    #[inline]
    pub fn radius(self) -> f32 {
        decode_radius(self.radius_code())
    }

    /// Code of the normal cone's half-angle.
    #[inline]
    pub fn cone_code(self) -> u8 {
        (self.0[2] >> 16) as u8
    }

    /// Mean normal, the cone's axis; unit, object space.
    #[inline]
    pub fn normal(self) -> Vec3 {
        decode_normal20(self.0[3])
    }

    /// Mean colour; sRGB, 0 to 1.
    pub fn colour(self) -> [f32; 3] {
        let [red, green, blue] = self.colour_codes();
        [red as f32 / 63.0, green as f32 / 127.0, blue as f32 / 63.0]
    }

    /// Codes of the mean colour: 6, 7 and 6 bits.
    #[inline]
    pub fn colour_codes(self) -> [usize; 3] {
        [
            (self.0[3] >> 20 & 63) as usize,
            (self.0[2] >> 24 & 127) as usize,
            (self.0[3] >> 26 & 63) as usize,
        ]
    }

    /// The link, whichever it is.
    #[inline]
    pub fn link(self) -> u32 {
        self.0[4]
    }

    /// An inner node's children: numbers of nodes.
    #[inline]
    pub fn children(self) -> core::ops::Range<u32> {
        let first = self.0[4] >> 2;
        first..first + (self.0[4] & 3) + 1
    }
}
