//! Packed normals of SFL files: a direction is projected on a face of the cube, and what it has beside the face's axis is
//! quantised.

use glam::DVec3;

/// Packing of a normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CubicCode {
    /// 16 bits, 6 for each component.
    Bits16,
    /// 32 bits, 14 for each component.
    Bits32,
}

impl CubicCode {
    /// Bits of a component and of the whole.
    const fn bits(self) -> (u32, u32) {
        match self {
            Self::Bits16 => (6, 16),
            Self::Bits32 => (14, 32),
        }
    }

    /// The unit vector of a code; zero for the null vector and for codes without a face.
    ///
    /// ```text
    /// H = (2^B − 1) / 2,  a = first − H,  b = second − H,  n = (a, b, ±H) / √(a² + b² + H²), in the face's axes
    /// ```
    #[inline]
    pub(super) fn decode(self, code: u32) -> DVec3 {
        let (component_bits, all_bits) = self.bits();
        let mask = (1_u32 << component_bits) - 1;
        let half = f64::from(mask) / 2.0;
        let a = f64::from(code & mask) - half;
        let b = f64::from((code >> component_bits) & mask) - half;
        let scale = 1.0 / (a * a + b * b + half * half).sqrt();
        let (a, b, major) = (a * scale, b * scale, half * scale);
        match code >> (all_bits - 3) {
            0 => DVec3::new(a, b, major),
            1 => DVec3::new(a, b, -major),
            2 => DVec3::new(a, major, b),
            3 => DVec3::new(a, -major, b),
            4 => DVec3::new(major, a, b),
            5 => DVec3::new(-major, a, b),
            _ => DVec3::ZERO,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_of_the_reference_library_decode() {
        for (direction, code16, code32) in [
            (DVec3::new(-0.6, 0.0, 0.8), 0x0808, 0x0800_0800),
            (DVec3::new(0.6, -0.8, 0.0), 0x6837, 0x6800_37FF),
            (DVec3::ONE.normalize(), 0x8FFF, 0x8FFF_FFFF),
        ] {
            assert!(CubicCode::Bits16.decode(code16).distance(direction) < 0.032);
            assert!(CubicCode::Bits32.decode(code32).distance(direction) < 0.00013);
        }
        let corner = CubicCode::Bits16.decode(0);
        assert!(corner.distance(DVec3::new(-1.0, -1.0, 1.0).normalize()) < 1e-12);
        assert_eq!(CubicCode::Bits16.decode(0xC000), DVec3::ZERO);
        assert_eq!(CubicCode::Bits32.decode(0xFFFF_FFFF), DVec3::ZERO);
    }
}
