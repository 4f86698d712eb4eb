//! What the codes of QSplat nodes mean: spheres inside their parent's, normals on a warped cube, colours of 16 bits.

use std::f64::consts::FRAC_PI_4;
use std::sync::LazyLock;

use glam::DVec3;

/// Cells along an edge of the cube around a parent's sphere.
const CELLS: u32 = 13;

/// Spheres inside the unit sphere that a code can tell: centre and radius, by code.
static SPHERES: LazyLock<Vec<(DVec3, f64)>> = LazyLock::new(spheres);

/// Components of normals along an edge of a cube's face, by step.
static STEPS: LazyLock<[f64; NORMAL_STEPS as usize]> = LazyLock::new(|| {
    std::array::from_fn(|step| {
        let along = (step as f64 + 0.5) * 2.0 / f64::from(NORMAL_STEPS) - 1.0;
        (FRAC_PI_4 * along).tan().clamp(-1.0, 1.0)
    })
});

/// Steps along an edge of a cube's face.
const NORMAL_STEPS: u16 = 52;

/// Balls inscribed in cubes of s³ of the 13³ cells, small ones first, less those outside the unit sphere.
fn spheres() -> Vec<(DVec3, f64)> {
    let cells = f64::from(CELLS);
    let mut spheres = Vec::new();
    for size in 1..=CELLS {
        let radius = f64::from(size) / cells;
        let reach = 1.0 + 3_f64.sqrt() * radius;
        let along = |cell: u32| f64::from(size + 2 * cell) / cells - 1.0;
        let free = 0..=CELLS - size;
        for x in free.clone() {
            for y in free.clone() {
                for z in free.clone() {
                    let centre = DVec3::new(along(x), along(y), along(z));
                    if centre.length_squared() <= reach * reach {
                        spheres.push((centre, radius));
                    }
                }
            }
        }
    }
    spheres
}

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sphere {
    pub(super) centre: DVec3,
    pub(super) radius: f64,
}

impl Sphere {
    /// The child of this code; `None` if there is no such code.
    #[inline]
    pub(super) fn child(&self, code: u16) -> Option<Self> {
        let (centre, radius) = SPHERES.get(usize::from(code))?;
        Some(Self {
            centre: self.centre + *centre * self.radius,
            radius: self.radius * radius,
        })
    }

    /// How many codes there are.
    pub(super) fn code_count() -> usize {
        SPHERES.len()
    }
}

/// The unit normal of a code of 14 bits; (0, 0, 1) where the code has none, as in the original.
#[inline]
pub(super) fn normal(code: u16) -> DVec3 {
    let of_step = |step: u16| STEPS[usize::from(step % NORMAL_STEPS)];
    let (u, v) = (of_step(code / NORMAL_STEPS), of_step(code));
    // Beyond the face's circle lies nothing that a unit normal could have been.
    let w = (1.0 - u * u - v * v).max(0.0).sqrt();
    let normal = match code / (NORMAL_STEPS * NORMAL_STEPS) {
        0 => DVec3::new(w, u, v),
        1 => DVec3::new(-w, u, v),
        2 => DVec3::new(v, w, u),
        3 => DVec3::new(v, -w, u),
        4 => DVec3::new(u, v, w),
        5 => DVec3::new(u, v, -w),
        _ => DVec3::Z,
    };
    normal.normalize()
}

/// Red, green and blue of a colour of 5, 6 and 5 bits.
#[inline]
pub(super) fn colour(code: u16) -> [u8; 3] {
    let (red, green, blue) = (code >> 11, code >> 5 & 63, code & 31);
    [
        red << 3 | red >> 2,
        green << 2 | green >> 4,
        blue << 3 | blue >> 2,
    ]
    .map(|byte| byte as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_as_many_spheres_as_the_format_has() {
        assert_eq!(Sphere::code_count(), 7621);
        let of_size = |size: u32| {
            let radius = f64::from(size) / 13.0;
            SPHERES.iter().filter(|sphere| sphere.1 == radius).count()
        };
        let counts: Vec<usize> = (1..=13).map(of_size).collect();
        assert_eq!(
            counts,
            [
                1617, 1648, 1331, 1000, 729, 512, 343, 216, 125, 64, 27, 8, 1
            ]
        );
        let root = Sphere {
            centre: DVec3::ONE,
            radius: 2.0,
        };
        assert_eq!(
            root.child(7620),
            Some(root),
            "the last is the parent itself"
        );
        assert_eq!(root.child(7621), None);
    }

    #[test]
    fn normals_are_of_unit_length_on_all_six_faces() {
        for code in 0..1 << 14 {
            assert!((normal(code).length() - 1.0).abs() < 1e-12, "{code}");
        }
        // The middle of each face, half a step beside its axis.
        let middle = 26 * NORMAL_STEPS + 26;
        let axes = [
            DVec3::X,
            DVec3::NEG_X,
            DVec3::Y,
            DVec3::NEG_Y,
            DVec3::Z,
            DVec3::NEG_Z,
        ];
        for (face, axis) in (0..).zip(axes) {
            let found = normal(face * NORMAL_STEPS * NORMAL_STEPS + middle);
            assert!(found.distance(axis) < 0.03, "{found} for {axis}");
        }
        assert_eq!(normal(16_224), DVec3::Z);
    }

    #[test]
    fn colours_reach_black_and_white() {
        assert_eq!(colour(0), [0, 0, 0]);
        assert_eq!(colour(0xFFFF), [255, 255, 255]);
        assert_eq!(colour(0x7924), [123, 36, 33]);
    }
}
