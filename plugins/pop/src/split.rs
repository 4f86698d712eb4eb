//! A mesh too large for one buffer, in pieces that fit: each with vertices of its own.

use pointstage_plugin_api::Result;
use pointstage_plugin_api::glam::Vec3;
use pointstage_pop_tree::Mesh;
use std::collections::HashMap;

/// Triangles that lie near each other, and their vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Piece {
    /// Position (xyz), and the vertex's number in the whole mesh, see [`NUMBER_MARK`].
    pub(crate) positions: Vec<[f32; 4]>,
    /// As many as positions, or none.
    pub(crate) normals: Vec<u32>,
    /// As many as positions, or none.
    pub(crate) colours: Vec<u32>,
    /// Over the piece's own vertices.
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// A bit beside a vertex's number, so that as a float it is an ordinary one, which no device flushes to zero; `NUMBER_MARK`
/// in the shader.
pub(crate) const NUMBER_MARK: u32 = 1 << 30;

/// Pieces of at most `most` triangles each, by halves along the longest side of their bounds.
///
/// # Errors
/// If the call is cancelled.
pub(crate) fn pieces(
    mesh: &Mesh<'_>,
    most: usize,
    check: &dyn Fn() -> Result<()>,
) -> Result<Vec<Piece>> {
    let mut numbers: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    let mut ranges = Vec::new();
    halve(mesh, &mut numbers, most.max(1), &mut ranges, check)?;
    let mut start = 0;
    let mut pieces = Vec::new();
    for length in ranges {
        check()?;
        pieces.push(piece_of(mesh, &numbers[start..start + length]));
        start += length;
    }
    Ok(pieces)
}

/// Orders triangles so that pieces lie side by side; adds the lengths of the pieces.
fn halve(
    mesh: &Mesh<'_>,
    numbers: &mut [u32],
    most: usize,
    lengths: &mut Vec<usize>,
    check: &dyn Fn() -> Result<()>,
) -> Result<()> {
    check()?;
    if numbers.len() <= most {
        lengths.push(numbers.len());
        return Ok(());
    }
    let middle = |number: u32| {
        let corners =
            mesh.triangles[number as usize].map(|vertex| mesh.position(vertex).unwrap_or_default());
        corners.into_iter().sum::<Vec3>() / 3.0
    };
    let (mut least, mut greatest) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for &number in numbers.iter() {
        least = least.min(middle(number));
        greatest = greatest.max(middle(number));
    }
    let axis = (greatest - least).max_position();
    let half = numbers.len() / 2;
    numbers.select_nth_unstable_by(half, |&a, &b| {
        middle(a)[axis].total_cmp(&middle(b)[axis]).then(a.cmp(&b))
    });
    let (low, high) = numbers.split_at_mut(half);
    halve(mesh, low, most, lengths, check)?;
    halve(mesh, high, most, lengths, check)
}

/// These triangles with their vertices.
fn piece_of(mesh: &Mesh<'_>, numbers: &[u32]) -> Piece {
    let mut piece = Piece::default();
    let mut places = HashMap::new();
    for &number in numbers {
        let triangle = mesh.triangles[number as usize].map(|vertex| {
            *places.entry(vertex).or_insert_with(|| {
                let place = piece.positions.len() as u32;
                let position = mesh.position(vertex).unwrap_or(Vec3::NAN);
                piece.positions.push(
                    position
                        .extend(f32::from_bits(vertex | NUMBER_MARK))
                        .to_array(),
                );
                piece.normals.extend(mesh.packed_normal(vertex));
                piece.colours.extend(mesh.packed_colour(vertex));
                place
            })
        });
        piece.triangles.push(triangle);
    }
    piece
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_pop_tree::VertexBlock;
    use std::collections::BTreeSet;

    #[test]
    fn pieces_hold_every_triangle_once_with_its_own_vertices() {
        // A strip over two blocks of vertices.
        let positions: Vec<[f32; 4]> = (0..42_u8)
            .map(|x| [f32::from(x), f32::from(x % 2), 0.0, 9.0])
            .collect();
        let normals: Vec<u32> = (100..142).collect();
        let blocks = [0..32, 32..42].map(|range: core::ops::Range<usize>| VertexBlock {
            position_radius: &positions[range.clone()],
            normals: Some(&normals[range]),
            colours: None,
        });
        let triangles: Vec<[u32; 3]> = (0..40).map(|first| [first, first + 1, first + 2]).collect();
        let mesh = Mesh {
            block_size: 32,
            blocks: &blocks,
            triangles: &triangles,
        };
        let pieces = pieces(&mesh, 7, &|| Ok(())).unwrap();
        assert!(pieces.len() > 5);
        let mut seen = BTreeSet::new();
        for piece in &pieces {
            assert!((1..=7).contains(&piece.triangles.len()));
            assert_eq!(piece.normals.len(), piece.positions.len());
            assert!(piece.colours.is_empty());
            for triangle in &piece.triangles {
                let whole = triangle.map(|vertex| {
                    let [x, y, z, number] = piece.positions[vertex as usize];
                    let number = number.to_bits() & !NUMBER_MARK;
                    assert_eq!(mesh.position(number), Some(Vec3::new(x, y, z)));
                    assert_eq!(piece.normals[vertex as usize], 100 + number);
                    number
                });
                assert!(seen.insert(whole));
            }
        }
        assert_eq!(seen, triangles.into_iter().collect());
    }

    #[test]
    fn a_cancelled_call_ends() {
        let mesh = Mesh {
            block_size: 1,
            blocks: &[],
            triangles: &[[0, 1, 2]],
        };
        assert!(pieces(&mesh, 1, &|| Err(pointstage_plugin_api::Error::cancelled())).is_err());
    }
}
