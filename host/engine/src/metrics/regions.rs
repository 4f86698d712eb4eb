//! Which pixels count: the whole picture, the interior of what the reference covers, and its edge.
//!
//! Renderers differ most along outlines, where they also have the least in common: one fades what another cuts. A number over
//! the whole picture hides a fault of the shading behind that, and the reverse; so each metric is given for both.

use crate::frame::Plane;

/// How far the edge reaches to either side of the outline, px: the filters of splats are about that wide.
pub const REACH_PX: i32 = 2;

/// Masks of a picture: one bool a pixel, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Regions {
    /// Every pixel.
    pub whole: Vec<bool>,
    /// The silhouette, eroded by [`REACH_PX`].
    pub interior: Vec<bool>,
    /// The silhouette, dilated by [`REACH_PX`], less the interior.
    pub edge: Vec<bool>,
}

impl Regions {
    /// The regions of a picture whose reference covers the pixels `covered`; none if that is not one bool a pixel.
    ///
    /// The structuring element is a disc, all pixels whose centres are at most [`REACH_PX`] away: 13 of them. What lies beyond
    /// the picture's border is unknown and counts for nothing, so an object that the border cuts has no edge there.
    pub fn new([width, height]: [u32; 2], covered: &[bool]) -> Option<Self> {
        if covered.len() as u64 != u64::from(width) * u64::from(height) {
            return None;
        }
        let [width, height] = [i64::from(width), i64::from(height)];
        let disc = disc();
        let around = |index: usize| {
            let (x, y) = (index as i64 % width, index as i64 / width);
            disc.iter().filter_map(move |[dx, dy]| {
                let (x, y) = (x + dx, y + dy);
                let is_inside = (0..width).contains(&x) && (0..height).contains(&y);
                is_inside.then(|| covered[(y * width + x) as usize])
            })
        };
        let interior: Vec<bool> = (0..covered.len())
            .map(|index| around(index).all(|covered| covered))
            .collect();
        let edge = (0..covered.len())
            .map(|index| !interior[index] && around(index).any(|covered| covered))
            .collect();
        Some(Self {
            whole: vec![true; covered.len()],
            interior,
            edge,
        })
    }
}

/// Offsets of the disc's pixels.
fn disc() -> Vec<[i64; 2]> {
    let reach = i64::from(REACH_PX);
    let side = -reach..=reach;
    let square = side
        .clone()
        .flat_map(|dy| side.clone().map(move |dx| [dx, dy]));
    square
        .filter(|[dx, dy]| dx * dx + dy * dy <= reach * reach)
        .collect()
}

/// The pixels that a target says something is in: an id that is not 0, a depth above 0 (reversed z, 0 where nothing is).
pub fn silhouette(plane: &Plane) -> Vec<bool> {
    match plane {
        Plane::Uint(values) => values.iter().map(|value| *value != 0).collect(),
        Plane::Float { channels, values } => values
            .chunks_exact((*channels).max(1) as usize)
            .map(|pixel| pixel[0] > 0.0)
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: u32 = 20;

    /// A square of 8 by 8 pixels from (6, 6).
    fn square() -> Vec<bool> {
        let is_in = |value: u32| (6..14).contains(&value);
        (0..SIDE * SIDE)
            .map(|index| is_in(index % SIDE) && is_in(index / SIDE))
            .collect()
    }

    fn count(mask: &[bool]) -> usize {
        mask.iter().filter(|is_in| **is_in).count()
    }

    #[test]
    fn a_square_loses_two_pixels_a_side_and_its_edge_has_round_corners() {
        let regions = Regions::new([SIDE, SIDE], &square()).expect("one a pixel");
        assert_eq!(count(&regions.whole), 400);
        assert_eq!(count(&regions.interior), 4 * 4);
        // Dilated by a disc: the square of 12 by 12 without three pixels a corner.
        assert_eq!(count(&regions.edge), 12 * 12 - 4 * 3 - 4 * 4);
        let at = |mask: &[bool], x: u32, y: u32| mask[(y * SIDE + x) as usize];
        assert!(at(&regions.edge, 4, 10) && !at(&regions.edge, 3, 10));
        assert!(at(&regions.edge, 7, 10) && at(&regions.interior, 8, 10));
        assert!(at(&regions.edge, 5, 5) && !at(&regions.edge, 4, 5));
    }

    #[test]
    fn the_border_of_the_picture_is_no_outline() {
        let regions = Regions::new([5, 4], &[true; 20]).expect("one a pixel");
        assert_eq!((count(&regions.interior), count(&regions.edge)), (20, 0));
    }

    #[test]
    fn nothing_covered_leaves_only_the_whole() {
        let regions = Regions::new([5, 4], &[false; 20]).expect("one a pixel");
        assert_eq!((count(&regions.interior), count(&regions.edge)), (0, 0));
        assert_eq!(Regions::new([5, 4], &[false; 19]), None, "one short");
    }

    #[test]
    fn ids_and_depths_tell_what_is_covered() {
        let ids = Plane::Uint([0, 7].as_slice().into());
        assert_eq!(silhouette(&ids), [false, true]);
        let depths = Plane::Float {
            channels: 1,
            values: [0.0, 0.25].as_slice().into(),
        };
        assert_eq!(silhouette(&depths), [false, true]);
    }
}
