//! Which of its two sides is the outside of a piece.
//!
//! Where a closed surface ends along an axis, its normal points along that axis. Each of the six ends votes for the side
//! that its normal lies on, by the cosine between normal and axis: a closed surface gets nearly six votes, an open one such
//! as a terrain has ends that contradict each other. Where fewer than [`FEWEST_VOTES`] are left, the piece has no inside;
//! its mean normal then points along the axis that it is nearest to, so that a terrain is seen from above.

use glam::{DVec3, Vec3};

use super::Sides;
use crate::estimate::tree::TreePoint;

/// Votes for an inside, of the six that a closed surface has.
const FEWEST_VOTES: f32 = 1.5;

/// The directions in which a piece ends.
const DIRECTIONS: [Vec3; 6] = [
    Vec3::X,
    Vec3::Y,
    Vec3::Z,
    Vec3::NEG_X,
    Vec3::NEG_Y,
    Vec3::NEG_Z,
];

/// A piece in the making.
#[derive(Clone, Debug)]
struct Piece {
    /// How far it reaches along each direction, and the point there.
    ends: [(f32, u32); 6],
    /// Sum of its normals, as they are turned so far.
    sum: DVec3,
}

/// Turns whole pieces so that their normals point outward. `turned` is relative to the `root` of each point.
pub(super) fn settle(
    points: &[TreePoint],
    normals: &[Vec3],
    root: &[u32],
    mut turned: Vec<bool>,
) -> Sides {
    let mut piece_of_root = vec![u32::MAX; points.len()];
    let mut pieces = Vec::new();
    for (place, at) in root.iter().enumerate() {
        let slot = &mut piece_of_root[*at as usize];
        if *slot == u32::MAX {
            *slot = pieces.len() as u32;
            pieces.push(Piece {
                ends: [(f32::NEG_INFINITY, 0); 6],
                sum: DVec3::ZERO,
            });
        }
        let piece: &mut Piece = &mut pieces[*slot as usize];
        let centre = Vec3::from(points[place].centre);
        for (end, direction) in piece.ends.iter_mut().zip(DIRECTIONS) {
            let reach = centre.dot(direction);
            // Equally far ones: the first, so that runs agree.
            if reach > end.0 {
                *end = (reach, place as u32);
            }
        }
        piece.sum += turned_by(normals[place], turned[place]).as_dvec3();
    }
    let inward: Vec<bool> = pieces
        .iter()
        .map(|piece| points_inward(piece, normals, &turned))
        .collect();
    for (turned, at) in turned.iter_mut().zip(root) {
        *turned ^= inward[piece_of_root[*at as usize] as usize];
    }
    Sides {
        turned,
        pieces: pieces.len(),
    }
}

fn points_inward(piece: &Piece, normals: &[Vec3], turned: &[bool]) -> bool {
    let ends = piece.ends.iter().zip(DIRECTIONS);
    let votes: f32 = ends
        .map(|((_, place), direction)| {
            let place = *place as usize;
            turned_by(normals[place], turned[place]).dot(direction)
        })
        .sum();
    if votes.abs() >= FEWEST_VOTES {
        return votes < 0.0;
    }
    let nearest = piece
        .sum
        .to_array()
        .into_iter()
        .max_by(|a, b| a.abs().total_cmp(&b.abs()));
    nearest.is_some_and(|along| along < 0.0)
}

fn turned_by(normal: Vec3, turned: bool) -> Vec3 {
    if turned { -normal } else { normal }
}
