//! What tells one mesh from another, so that a tree on disk is only used for the mesh it was built over.

use crate::crew::{Crew, Hand};
use crate::mesh::Mesh;

/// Begins what is hashed; another layout of it gets another name.
const DOMAIN: &str = "pointstage pop-tree mesh fingerprint 1";

/// Triangles or vertices of a part that is hashed by itself.
const STRETCH: usize = 1 << 16;

/// Vertices whose positions are gathered before they are hashed.
const GATHERED: usize = 1 << 10;

/// One column's stretch.
#[derive(Clone, Copy)]
enum Part<'a> {
    Triangles(&'a [[u32; 3]]),
    Positions(&'a [[f32; 4]]),
    Normals(&'a [u32]),
    Colours(&'a [u32]),
}

/// BLAKE3 over the triangles, positions (without their fourth component), normals and colours of a mesh, on `thread_count`
/// threads.
///
/// Columns are hashed in parts, and then the parts' hashes with the lengths. The same vertices in other blocks have another
/// fingerprint.
pub fn fingerprint(mesh: &Mesh<'_>, thread_count: usize) -> [u8; 32] {
    let mut parts: Vec<Part<'_>> = mesh
        .triangles
        .chunks(STRETCH)
        .map(Part::Triangles)
        .collect();
    let mut lengths = vec![
        mesh.triangles.len() as u64,
        u64::from(mesh.block_size),
        mesh.blocks.len() as u64,
    ];
    for block in mesh.blocks {
        parts.extend(block.position_radius.chunks(STRETCH).map(Part::Positions));
        parts.extend(
            block
                .normals
                .unwrap_or_default()
                .chunks(STRETCH)
                .map(Part::Normals),
        );
        parts.extend(
            block
                .colours
                .unwrap_or_default()
                .chunks(STRETCH)
                .map(Part::Colours),
        );
        // No column is not the same as one of no entries.
        let length = |column: Option<&[u32]>| column.map_or(u64::MAX, |column| column.len() as u64);
        lengths.extend([
            block.position_radius.len() as u64,
            length(block.normals),
            length(block.colours),
        ]);
    }
    let mut hashes = vec![[0_u8; 32]; parts.len()];
    let mut go_on = |_: f32, _: &str| true;
    let tasks = parts.iter().zip(&mut hashes).collect();
    let items = mesh.triangles.len() + mesh.vertex_count();
    let ended = Crew::new(thread_count, 1, &mut go_on).run(
        "",
        items,
        tasks,
        |(part, hash), _: &Hand<'_, _>| {
            *hash = hash_of(*part);
        },
    );
    debug_assert!(ended.is_ok(), "nothing cancels");
    let mut hasher = blake3::Hasher::new_derive_key(DOMAIN);
    for length in lengths {
        hasher.update(&length.to_le_bytes());
    }
    hasher.update(hashes.as_flattened());
    *hasher.finalize().as_bytes()
}

fn hash_of(part: Part<'_>) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    match part {
        Part::Triangles(triangles) => update(&mut hasher, triangles.as_flattened().iter().copied()),
        Part::Positions(positions) => {
            let bits = positions
                .iter()
                .flat_map(|&[x, y, z, _]| [x, y, z])
                .map(f32::to_bits);
            update(&mut hasher, bits);
        }
        Part::Normals(words) | Part::Colours(words) => update(&mut hasher, words.iter().copied()),
    }
    *hasher.finalize().as_bytes()
}

/// Hashes words, little-endian.
fn update(hasher: &mut blake3::Hasher, words: impl Iterator<Item = u32>) {
    let mut gathered = [0_u32; 3 * GATHERED];
    let mut words = words.map(u32::to_le).peekable();
    while words.peek().is_some() {
        let count = gathered
            .iter_mut()
            .zip(&mut words)
            .map(|(place, word)| *place = word)
            .count();
        hasher.update(bytemuck::cast_slice(&gathered[..count]));
    }
}

#[cfg(test)]
mod tests {
    use super::fingerprint;
    use crate::{Mesh, VertexBlock};

    #[test]
    fn every_column_counts_and_the_fourth_component_does_not() {
        let positions: Vec<[f32; 4]> = (0..9000_u16)
            .map(|x| [f32::from(x), 1.0, 2.0, 3.0])
            .collect();
        let words: Vec<u32> = (0..9000).collect();
        let triangles = vec![[1, 2, 3]; 100_000];
        let of = |positions: &[[f32; 4]],
                  normals: Option<&[u32]>,
                  colours: Option<&[u32]>,
                  triangles: &[[u32; 3]]| {
            let block = VertexBlock {
                position_radius: positions,
                normals,
                colours,
            };
            let mesh = Mesh {
                block_size: 9000,
                blocks: &[block],
                triangles,
            };
            let found = fingerprint(&mesh, 1);
            assert_eq!(found, fingerprint(&mesh, 3));
            found
        };
        let first = of(&positions, Some(&words), Some(&words), &triangles);
        let mut others = positions.clone();
        others[8999][3] = 4.0;
        assert_eq!(first, of(&others, Some(&words), Some(&words), &triangles));
        others[8999][2] = 4.0;
        let mut other_words = words.clone();
        other_words[8999] = 0;
        let mut other_triangles = triangles.clone();
        other_triangles[99_999] = [1, 3, 2];
        let different = [
            first,
            of(&others, Some(&words), Some(&words), &triangles),
            of(&positions, Some(&other_words), Some(&words), &triangles),
            of(&positions, Some(&words), Some(&other_words), &triangles),
            of(&positions, Some(&words), None, &triangles),
            of(&positions, None, Some(&words), &triangles),
            of(&positions, Some(&[]), Some(&words), &triangles),
            of(&positions, Some(&words), Some(&words), &other_triangles),
            of(&positions, Some(&words), Some(&words), &triangles[1..]),
        ];
        let distinct: std::collections::BTreeSet<_> = different.into_iter().collect();
        assert_eq!(distinct.len(), different.len());
    }
}
