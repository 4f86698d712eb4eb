//! Dividing triangles that are coarser than their picture.
//!
//! Round by round every edge that covers more texels than are fine enough gets a vertex in its middle, and triangles are cut by
//! their divided edges into two, three or four. An edge is divided for both of its faces, whichever asks for it, so no gap
//! opens. When the vertices that may still come are fewer than a round asks for, its longest edges get them, and it is the last.

use rustc_hash::FxHashMap;

use crate::surface::{Material, Surface};

/// Texels that an edge may cover.
pub const FINE_ENOUGH: f32 = 3.0;

/// Vertices up to which meshes are divided: those of all the file's objects together.
pub const MOST_VERTICES: usize = 1 << 21;

/// Triangles looked at between two looks at the cancel flag.
const TRIANGLES_A_PIECE: usize = 1 << 16;

/// What dividing added.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Divided {
    /// For each new vertex the two whose middle it is; they may be new ones that came before.
    pub parents: Vec<[u32; 2]>,
    /// Whether the most vertices were reached before all edges were fine enough.
    pub is_cut_short: bool,
}

/// Divides a surface until its edges cover at most [`FINE_ENOUGH`] texels, or it has `most_vertices`. `check` is asked between
/// pieces.
///
/// # Errors
/// Those of `check`.
pub fn divide<E>(
    surface: &mut Surface,
    materials: &[Material],
    most_vertices: usize,
    mut check: impl FnMut() -> Result<(), E>,
) -> Result<Divided, E> {
    let mut divided = Divided::default();
    while !divided.is_cut_short {
        let mut edges = long_edges(surface, materials, &mut check)?;
        if edges.is_empty() {
            break;
        }
        let room = most_vertices.saturating_sub(surface.positions.len());
        if edges.len() > room {
            divided.is_cut_short = true;
            edges.sort_by(|a, b| b.texels.total_cmp(&a.texels).then(a.ends.cmp(&b.ends)));
            edges.truncate(room);
        }
        let mut middles: FxHashMap<[u32; 2], u32> = FxHashMap::default();
        for Edge { ends, .. } in edges {
            middles.insert(ends, surface.positions.len() as u32);
            let [from, to] = ends.map(|end| surface.positions[end as usize]);
            let middle = std::array::from_fn(|axis| f64::midpoint(from[axis], to[axis]));
            surface.positions.push(middle);
            divided.parents.push(ends);
        }
        cut(surface, &middles, &mut check)?;
    }
    Ok(divided)
}

/// An edge that covers too much.
#[derive(Debug)]
struct Edge {
    /// Vertices, the lower one first.
    ends: [u32; 2],
    /// Its length on the picture.
    texels: f32,
}

fn key(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Those of the surface, in the order in which its triangles name them.
fn long_edges<E>(
    surface: &Surface,
    materials: &[Material],
    check: &mut impl FnMut() -> Result<(), E>,
) -> Result<Vec<Edge>, E> {
    let mut edges: Vec<Edge> = Vec::new();
    let mut known: FxHashMap<[u32; 2], usize> = FxHashMap::default();
    for triangle in 0..surface.triangles.len() {
        if triangle % TRIANGLES_A_PIECE == 0 {
            check()?;
        }
        let (corners, uvs) = (surface.triangles[triangle], surface.uvs[triangle]);
        let material = materials.get(surface.materials[triangle] as usize);
        let Some(picture) = material.and_then(|material| material.picture.as_ref()) else {
            continue;
        };
        let [width, height] = picture.size().map(|size| size as f32);
        for side in 0..3 {
            let next = (side + 1) % 3;
            let [du, dv] = [0, 1].map(|axis| uvs[next][axis] - uvs[side][axis]);
            let texels = (du * width).hypot(dv * height);
            // Written so that NaN is not divided; nor is what ends at one place, where more vertices show nothing.
            if !(texels > FINE_ENOUGH && texels.is_finite()) {
                continue;
            }
            let Some(places) = surface.corners(triangle) else {
                continue;
            };
            if places[side] == places[next] || !(places[side] - places[next]).is_finite() {
                continue;
            }
            let ends = key(corners[side], corners[next]);
            let index = *known.entry(ends).or_insert_with(|| {
                edges.push(Edge { ends, texels });
                edges.len() - 1
            });
            edges[index].texels = edges[index].texels.max(texels);
        }
    }
    Ok(edges)
}

/// Cuts the triangles whose edges have a middle.
fn cut<E>(
    surface: &mut Surface,
    middles: &FxHashMap<[u32; 2], u32>,
    check: &mut impl FnMut() -> Result<(), E>,
) -> Result<(), E> {
    let old = std::mem::take(&mut surface.triangles);
    let old_uvs = std::mem::take(&mut surface.uvs);
    let old_materials = std::mem::take(&mut surface.materials);
    let parts = old.iter().zip(&old_uvs).zip(&old_materials);
    for (triangle, ((corners, uvs), material)) in parts.enumerate() {
        if triangle % TRIANGLES_A_PIECE == 0 {
            check()?;
        }
        let middle = |side: usize| {
            let next = (side + 1) % 3;
            let vertex = *middles.get(&key(corners[side], corners[next]))?;
            let uv = [0, 1].map(|axis| f32::midpoint(uvs[side][axis], uvs[next][axis]));
            Some(Corner { vertex, uv })
        };
        let ends = [0, 1, 2].map(|side| Corner {
            vertex: corners[side],
            uv: uvs[side],
        });
        let mut add = |part: [Corner; 3]| {
            surface.triangles.push(part.map(|corner| corner.vertex));
            surface.uvs.push(part.map(|corner| corner.uv));
            surface.materials.push(*material);
        };
        let places = &surface.positions;
        let distance = |a: Corner, b: Corner| {
            let place = |corner: Corner| {
                let place = places.get(corner.vertex as usize);
                place.map_or(glam::DVec3::NAN, |place| glam::DVec3::from_array(*place))
            };
            place(a).distance_squared(place(b))
        };
        cut_triangle(ends, [0, 1, 2].map(middle), distance, &mut add);
    }
    Ok(())
}

#[derive(Clone, Copy, Debug)]
struct Corner {
    vertex: u32,
    uv: [f32; 2],
}

/// The parts of a triangle; `middles` are those of the sides behind each corner.
fn cut_triangle(
    [a, b, c]: [Corner; 3],
    middles: [Option<Corner>; 3],
    distance: impl Fn(Corner, Corner) -> f64,
    add: &mut impl FnMut([Corner; 3]),
) {
    // Turned so that the cases below suffice.
    match middles {
        [None, None, None] => add([a, b, c]),
        [Some(ab), Some(bc), Some(ca)] => {
            add([a, ab, ca]);
            add([ab, b, bc]);
            add([ca, bc, c]);
            add([ab, bc, ca]);
        }
        [Some(ab), None, None] => {
            add([a, ab, c]);
            add([ab, b, c]);
        }
        [Some(ab), Some(bc), None] => {
            add([ab, b, bc]);
            // The shorter way across what is left.
            if distance(a, bc) <= distance(ab, c) {
                add([a, ab, bc]);
                add([a, bc, c]);
            } else {
                add([a, ab, c]);
                add([ab, bc, c]);
            }
        }
        [first, second, third] => {
            cut_triangle([b, c, a], [second, third, first], distance, add);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{Alpha, Picture};
    use std::collections::HashMap;
    use std::sync::Arc;

    /// A closed tetrahedron of which one face covers a picture.
    fn tetrahedron() -> (Surface, Vec<Material>) {
        let surface = Surface {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            uvs: vec![
                [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]],
                [[0.0; 2]; 3],
                [[f32::NAN; 2]; 3],
                [[0.2, 0.2]; 3],
            ],
            materials: vec![0, 0, 0, 5],
        };
        let bytes = vec![255; 64 * 16 * 4];
        let picture = Picture::from_rgba(64, 16, bytes, Alpha::Respected);
        (surface, vec![Material::of_picture(Arc::new(picture))])
    }

    fn run(surface: &mut Surface, materials: &[Material], most: usize) -> Divided {
        let Ok(divided) = divide(surface, materials, most, || {
            Ok::<(), std::convert::Infallible>(())
        });
        divided
    }

    /// Each edge belongs to two triangles, once in each direction.
    fn is_closed(surface: &Surface) -> bool {
        let mut sides: HashMap<[u32; 2], i32> = HashMap::new();
        for [a, b, c] in &surface.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *sides.entry([*from, *to]).or_default() += 1;
            }
        }
        sides
            .iter()
            .all(|([from, to], count)| *count == 1 && sides.get(&[*to, *from]) == Some(&1))
    }

    fn area(surface: &Surface) -> f64 {
        let of = |triangle| {
            let [a, b, c] = surface.corners(triangle).unwrap();
            0.5 * (b - a).cross(c - a).length()
        };
        (0..surface.triangles.len()).map(of).sum()
    }

    #[test]
    fn edges_become_fine_enough_and_the_mesh_stays_closed() {
        let (mut surface, materials) = tetrahedron();
        let before = area(&surface);
        let divided = run(&mut surface, &materials, MOST_VERTICES);
        assert!(!divided.is_cut_short);
        assert_eq!(divided.parents.len() + 4, surface.positions.len());
        assert!(is_closed(&surface));
        assert!((area(&surface) - before).abs() < 1e-12);
        for (triangle, material) in surface.uvs.iter().zip(&surface.materials) {
            for side in 0..3 {
                let [a, b] = [triangle[side], triangle[(side + 1) % 3]];
                let texels = ((a[0] - b[0]) * 64.0).hypot((a[1] - b[1]) * 16.0);
                assert!(
                    *material != 0 || texels.is_nan() || texels <= FINE_ENOUGH,
                    "{texels}"
                );
            }
        }
        for (index, [a, b]) in divided.parents.iter().enumerate() {
            assert!((*a as usize) < index + 4 && (*b as usize) < index + 4);
        }
    }

    #[test]
    fn a_limit_ends_it_with_the_longest_edges_divided() {
        for most in [4, 5, 17, 100] {
            let (mut surface, materials) = tetrahedron();
            let divided = run(&mut surface, &materials, most);
            assert!(divided.is_cut_short);
            assert_eq!(surface.positions.len(), most);
            assert!(is_closed(&surface), "{most}");
        }
        let (mut surface, materials) = tetrahedron();
        run(&mut surface, &materials, 5);
        // The face's longest edge covers 66 texels.
        assert_eq!(surface.positions[4], [0.5, 0.5, 0.0]);
    }

    #[test]
    fn fine_meshes_and_those_without_pictures_stay() {
        let (mut surface, _) = tetrahedron();
        let plain = [Material::of_colour([1.0; 4])];
        assert_eq!(run(&mut surface, &plain, MOST_VERTICES), Divided::default());
        surface.positions = vec![[1.0; 3]; 4];
        let (_, materials) = tetrahedron();
        assert_eq!(
            run(&mut surface, &materials, MOST_VERTICES),
            Divided::default()
        );
    }
}
