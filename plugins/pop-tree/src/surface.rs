//! Whether a mesh is a closed surface, and which way its normals point.

use crate::mesh::Mesh;
use pointstage_plugin_api::glam::DVec3;

/// What a mesh bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Surface {
    /// Whether every edge is run through as often one way as the other: then no back can be seen from outside.
    pub is_closed: bool,
    /// Whether normals point inward on the whole: the volume that they bound is negative.
    pub is_inward: bool,
}

impl Surface {
    /// Of a mesh; triangles whose vertices do not exist are left out. None if `goes_on`, which is asked every few milliseconds, says
    /// no.
    pub fn of(mesh: &Mesh<'_>, goes_on: &dyn Fn() -> bool) -> Option<Self> {
        let first = mesh
            .triangles
            .first()
            .and_then(|triangle| mesh.position(triangle[0]));
        let origin = first.unwrap_or_default().as_dvec3();
        let (mut edges, mut volume) = (0_u64, 0.0);
        for (number, triangle) in mesh.triangles.iter().enumerate() {
            if number % ASK_EVERY == 0 && !goes_on() {
                return None;
            }
            let [a, b, c] = *triangle;
            for (from, to) in [(a, b), (b, c), (c, a)] {
                edges = edges.wrapping_add(edge_sign(from, to));
            }
            let [Some(pa), Some(pb), Some(pc)] = triangle.map(|vertex| mesh.position(vertex))
            else {
                continue;
            };
            let [pa, pb, pc] = [pa, pb, pc].map(|place| place.as_dvec3() - origin);
            let across = (pb - pa).cross(pc - pa);
            let normals = triangle.map(|vertex| mesh.normal(vertex).unwrap_or_default().as_dvec3());
            let mean: DVec3 = normals.into_iter().sum();
            let sign = if across.dot(mean) < 0.0 { -1.0 } else { 1.0 };
            volume += sign * across.dot(pa);
        }
        Some(Self {
            is_closed: edges == 0,
            is_inward: volume < 0.0,
        })
    }
}

/// Triangles from one question whether to go on to the next.
const ASK_EVERY: usize = 1 << 16;

/// A number for an edge, and its negative for the way back; 0 for an edge without length. The sum over a surface is 0 if
/// the edges cancel, and otherwise only by a chance of one in 2⁶⁴.
fn edge_sign(from: u32, to: u32) -> u64 {
    let key = u64::from(from.min(to)) << 32 | u64::from(from.max(to));
    let value = mixed(key);
    match from.cmp(&to) {
        core::cmp::Ordering::Less => value,
        core::cmp::Ordering::Equal => 0,
        core::cmp::Ordering::Greater => value.wrapping_neg(),
    }
}

/// Steele, Lea, Flood, Fast Splittable Pseudorandom Number Generators, OOPSLA 2014: the finalizer of SplitMix64.
fn mixed(key: u64) -> u64 {
    let mut bits = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::VertexBlock;

    const CORNERS: [[f32; 4]; 4] = [
        [5.0, 5.0, 5.0, 0.0],
        [6.0, 5.0, 5.0, 0.0],
        [5.0, 6.0, 5.0, 0.0],
        [5.0, 5.0, 6.0, 0.0],
    ];

    fn surface(triangles: &[[u32; 3]]) -> Surface {
        let blocks = [VertexBlock {
            position_radius: &CORNERS,
            normals: None,
            colours: None,
        }];
        let mesh = Mesh {
            block_size: 4,
            blocks: &blocks,
            triangles,
        };
        assert_eq!(
            Surface::of(&mesh, &|| triangles.is_empty()).is_some(),
            triangles.is_empty()
        );
        Surface::of(&mesh, &|| true).unwrap()
    }

    #[test]
    fn a_tetrahedron_is_closed_and_knows_its_outside() {
        let outward = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let inward = outward.map(|[a, b, c]| [a, c, b]);
        assert_eq!(
            surface(&outward),
            Surface {
                is_closed: true,
                is_inward: false
            }
        );
        assert_eq!(
            surface(&inward),
            Surface {
                is_closed: true,
                is_inward: true
            }
        );
    }

    #[test]
    fn a_missing_or_turned_face_opens_it() {
        assert!(!surface(&[[0, 2, 1], [0, 1, 3], [0, 3, 2]]).is_closed);
        assert!(!surface(&[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 3, 2]]).is_closed);
        assert!(!surface(&[[0, 1, 2]]).is_closed);
        assert!(surface(&[]).is_closed, "nothing has no edge");
    }
}
