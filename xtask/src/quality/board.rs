//! A checkerboard of surfels: the pattern on which filters succeed or fail.

use super::view::View;
use crate::ply;

/// Surfels along each side.
const SIDE: usize = 600;

/// Surfels along each side of a check.
const CHECK: usize = 12;

/// Radius in distances between surfels: above √½, so that disks leave no holes.
const RADIUS: f64 = 0.8;

/// Grey of a dark and a bright check: neither is cut at the ends of the scale when it is lit.
const GREYS: [u8; 2] = [30, 225];

/// The board as binary PLY: the unit square in the x-z plane around the origin, seen from above.
pub(super) fn ply() -> Vec<u8> {
    let mut bytes = header().into_bytes();
    let spacing = 1.0 / SIDE as f64;
    let at = |index: usize| (index as f64 + 0.5) * spacing - 0.5;
    for row in 0..SIDE {
        for column in 0..SIDE {
            let numbers = [at(column), 0.0, at(row), 0.0, 1.0, 0.0, RADIUS * spacing];
            bytes.extend(
                numbers
                    .into_iter()
                    .flat_map(|number| (number as f32).to_le_bytes()),
            );
            bytes.extend([GREYS[(row / CHECK + column / CHECK) % 2]; 3]);
        }
    }
    bytes
}

fn header() -> String {
    let columns = [
        ("float", "x y z nx ny nz radius"),
        ("uchar", "red green blue"),
    ];
    ply::header(&["made by `cargo xtask quality`"], SIDE * SIDE, &columns)
}

/// From the middle distance, 10° above the board and 20° beside its axis: surfels in its middle are 1.2 px apart (3 px when it
/// is near, 0.3 px when it is far), and a sixth of that in depth.
pub(super) fn view() -> View {
    let (elevation, azimuth, distance) = (10_f64.to_radians(), 20_f64.to_radians(), 1.1);
    let level = distance * elevation.cos();
    View {
        eye: [
            level * azimuth.sin(),
            distance * elevation.sin(),
            level * azimuth.cos(),
        ],
        pivot: [0.0; 3],
        up: [0.0, 1.0, 0.0],
        fov_y_rad: 40_f64.to_radians(),
        near: distance / 1000.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_counts_what_follows() {
        let ply = ply();
        let header = header();
        assert!(ply.starts_with(header.as_bytes()));
        assert!(header.contains("element vertex 360000\n"), "{header}");
        // Seven floats and three bytes.
        assert_eq!(ply.len() - header.len(), 360_000 * 31);
    }

    #[test]
    fn colours_change_from_check_to_check() {
        let ply = ply();
        let grey =
            |row: usize, column: usize| ply[header().len() + (row * SIDE + column) * 31 + 28];
        assert_eq!([grey(0, 0), grey(11, 11)], [30; 2]);
        assert_eq!([grey(0, 12), grey(12, 0)], [225; 2]);
        assert_eq!(grey(12, 12), 30);
    }
}
