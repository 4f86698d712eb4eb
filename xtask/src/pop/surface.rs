//! Meshes made by sampling a parametric surface on a grid.

use std::f64::consts::{PI, TAU};

use crate::ply;

/// What is sampled, over s and t from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// Radius 1; s is the longitude, t goes from the upper pole to the lower one.
    Sphere,
    /// Ring of radius 1, tube of radius [`TUBE`]; s goes around the ring, t around the tube.
    Torus,
    /// The unit square around the origin, facing +z.
    Square,
}

/// Radius of the torus's tube. The thesis names none.
const TUBE: f64 = 0.4;

/// A shape and its grid. Each cell is two triangles. Seams and poles have their vertices twice and more, as in the thesis: only
/// so do its counts come out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Surface {
    pub(super) shape: Shape,
    /// Cells along s and t.
    pub(super) cells: [usize; 2],
}

/// Position and normal, six f32.
const VERTEX_BYTES: usize = 24;
/// The number of corners, a byte, and three i32.
const FACE_BYTES: usize = 13;

impl Surface {
    /// A million triangles with 501,501 vertices.
    pub(super) const SPHERE: Self = Self {
        shape: Shape::Sphere,
        cells: [1000, 500],
    };

    /// Four million triangles with 2,020,101 vertices. (a + 1)(b + 1) = 2,020,101 with 2ab = 4,000,000 leaves but one grid, of
    /// 20,000 and 100 cells: the triangles are thin. Which of them goes around the tube, the thesis does not say.
    pub(super) const TORUS: Self = Self {
        shape: Shape::Torus,
        cells: [20_000, 100],
    };

    /// The unit square in so many triangles, its cells as square as whole numbers allow.
    pub(super) fn square(triangle_count: usize) -> Self {
        let cell_count = triangle_count / 2;
        let mut rows = (1..=cell_count.isqrt()).rev();
        let rows = rows.find(|rows| cell_count.is_multiple_of(*rows));
        let rows = rows.unwrap_or(1);
        Self {
            shape: Shape::Square,
            cells: [cell_count / rows, rows],
        }
    }

    pub(super) fn vertex_count(self) -> usize {
        let [columns, rows] = self.cells;
        (columns + 1) * (rows + 1)
    }

    pub(super) fn triangle_count(self) -> usize {
        let [columns, rows] = self.cells;
        2 * columns * rows
    }

    /// Length of what [`Surface::ply`] gives.
    pub(super) fn byte_count(self) -> usize {
        self.header().len()
            + self.vertex_count() * VERTEX_BYTES
            + self.triangle_count() * FACE_BYTES
    }

    /// The mesh as binary PLY, with normals; triangles are counter-clockwise seen from where the normals point.
    pub(super) fn ply(self) -> Vec<u8> {
        let [columns, rows] = self.cells;
        let mut bytes = self.header().into_bytes();
        bytes.reserve(self.byte_count() - bytes.len());
        for row in 0..=rows {
            for column in 0..=columns {
                let (s, t) = (column as f64 / columns as f64, row as f64 / rows as f64);
                let numbers = self.shape.at(s, t).into_iter().flatten();
                bytes.extend(numbers.flat_map(|number| (number as f32).to_le_bytes()));
            }
        }
        for row in 0..rows {
            for column in 0..columns {
                let first = row * (columns + 1) + column;
                let [a, b, c, d] = [first, first + columns + 1, first + columns + 2, first + 1];
                for corners in [[a, b, c], [a, c, d]] {
                    bytes.push(3);
                    bytes.extend(
                        corners
                            .into_iter()
                            .flat_map(|corner| (corner as i32).to_le_bytes()),
                    );
                }
            }
        }
        bytes
    }

    fn header(self) -> String {
        ply::mesh_header(
            &["made by `cargo xtask pop`"],
            [self.vertex_count(), self.triangle_count()],
            &[("float", "x y z nx ny nz")],
        )
    }
}

impl Shape {
    /// Position and unit normal. t runs down where s runs to the right, seen from outside.
    fn at(self, s: f64, t: f64) -> [[f64; 3]; 2] {
        match self {
            Self::Sphere => {
                let ((sin_s, cos_s), (sin_t, cos_t)) = ((s * TAU).sin_cos(), (t * PI).sin_cos());
                [[sin_t * sin_s, cos_t, sin_t * cos_s]; 2]
            }
            Self::Torus => {
                let ((sin_s, cos_s), (sin_t, cos_t)) = ((s * TAU).sin_cos(), (-t * TAU).sin_cos());
                let out = 1.0 + TUBE * cos_t;
                [
                    [out * sin_s, TUBE * sin_t, out * cos_s],
                    [cos_t * sin_s, sin_t, cos_t * cos_s],
                ]
            }
            Self::Square => [[s - 0.5, 0.5 - t, 0.0], [0.0, 0.0, 1.0]],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_those_of_the_thesis() {
        let counts = |surface: Surface| (surface.vertex_count(), surface.triangle_count());
        assert_eq!(counts(Surface::SPHERE), (501_501, 1_000_000));
        assert_eq!(counts(Surface::TORUS), (2_020_101, 4_000_000));
    }

    #[test]
    fn squares_have_the_triangles_asked_for_in_cells_that_are_nearly_square() {
        for count in super::super::models::SQUARES {
            let square = Surface::square(count);
            assert_eq!(square.triangle_count(), count);
            let [columns, rows] = square.cells;
            assert!(columns <= 2 * rows, "{count}: {columns} x {rows}");
        }
        assert_eq!(Surface::square(100_000).cells, [250, 200]);
        assert_eq!(Surface::square(2_000_000).cells, [1000, 1000]);
    }

    #[test]
    fn the_file_holds_what_its_header_says() {
        let surface = Surface::square(12);
        let ply = surface.ply();
        let header = surface.header();
        assert!(ply.starts_with(header.as_bytes()));
        assert!(header.contains("element vertex 12\n"), "{header}");
        assert!(header.contains("element face 12\n"), "{header}");
        assert_eq!(ply.len(), surface.byte_count());
        assert_eq!(ply.len(), header.len() + 12 * 24 + 12 * 13);
    }

    #[test]
    fn triangles_face_where_their_normals_point() {
        for shape in [Shape::Sphere, Shape::Torus, Shape::Square] {
            let surface = Surface {
                shape,
                cells: [7, 5],
            };
            let ply = surface.ply();
            let (vertices, faces) =
                ply[surface.header().len()..].split_at(surface.vertex_count() * VERTEX_BYTES);
            let number = |bytes: &[u8], at: usize| -> [u8; 4] {
                bytes[4 * at..4 * at + 4].try_into().expect("four bytes")
            };
            let vector = |vertex: usize, first: usize| {
                let bytes = &vertices[vertex * VERTEX_BYTES..];
                [0, 1, 2].map(|axis| f64::from(f32::from_le_bytes(number(bytes, first + axis))))
            };
            for face in faces.chunks(FACE_BYTES) {
                assert_eq!(face[0], 3);
                let [a, b, c] =
                    [0, 1, 2].map(|at| i32::from_le_bytes(number(&face[1..], at)) as usize);
                let edge = |to: usize| {
                    let (from, to) = (vector(a, 0), vector(to, 0));
                    [0, 1, 2].map(|axis| to[axis] - from[axis])
                };
                let (u, v) = (edge(b), edge(c));
                let cross = [
                    u[1] * v[2] - u[2] * v[1],
                    u[2] * v[0] - u[0] * v[2],
                    u[0] * v[1] - u[1] * v[0],
                ];
                let normal = vector(a, 3);
                let facing: f64 = (0..3).map(|axis| cross[axis] * normal[axis]).sum();
                // Triangles at the poles have no area.
                assert!(facing > -1e-9, "{shape:?}: {a} {b} {c}: {facing}");
            }
        }
    }
}
