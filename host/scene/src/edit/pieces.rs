//! Parts of an object: what is copied, and what is left.

use std::sync::Arc;

use bytemuck::Pod;
use bytes::Bytes;
use pointstage_plugin_api::columns::MAX_BLOCK_SURFELS;
use rayon::prelude::*;

use crate::geometry::{Block, Geometry, NamedColumn};
use crate::job::{Cancelled, Job};
use crate::marks::Marks;
use crate::scene::{Object, ObjectId, Revision};
use crate::textures::{Textures, TriangleTextures};

/// The marked surfels of a geometry with all their columns, in their order; where these came from is kept. Of a mesh, those
/// triangles remain whose three corners are marked.
///
/// # Errors
/// [`Cancelled`] if the job is.
pub fn extract(geometry: &Geometry, marks: &Marks, job: &Job) -> Result<Geometry, Cancelled> {
    job.set_stage("copying surfels");
    let kept: Vec<usize> = marks
        .iter()
        .take_while(|&surfel| surfel < geometry.surfel_count)
        .collect();
    let mut blocks = Vec::with_capacity(kept.len().div_ceil(MAX_BLOCK_SURFELS));
    for (number, surfels) in kept.chunks(MAX_BLOCK_SURFELS).enumerate() {
        job.check()?;
        blocks.push(block_of(&geometry.blocks, surfels));
        let done = (number + 1) * MAX_BLOCK_SURFELS;
        job.set_progress_within(&(0.0..0.8), done.min(kept.len()), kept.len());
    }
    let left = match &geometry.triangles {
        Some(triangles) => remaining(triangles, &kept, geometry.surfel_count, job)?,
        None => Vec::new(),
    };
    job.check()?;
    let triangles = (!left.is_empty()).then(|| left.iter().map(|(_, corners)| *corners).collect());
    let mut piece = Geometry::new(blocks, triangles, geometry.origins);
    piece.textures = textures(geometry, &left);
    Ok(piece)
}

/// What is left of an object's geometry when its marked surfels are deleted; `None` if nothing is.
///
/// # Errors
/// [`Cancelled`] if the job is.
pub fn without_marked(
    geometry: &Geometry,
    marks: &Marks,
    job: &Job,
) -> Result<Option<Geometry>, Cancelled> {
    let rest = extract(geometry, &marks.inverted(), job)?;
    Ok((rest.surfel_count > 0).then_some(rest))
}

/// The marked surfels of an object as an object of their own, in the same place and of the same looks, without marks and
/// without a file; `None` if none is marked.
///
/// # Errors
/// [`Cancelled`] if the job is.
pub fn piece_of(object: &Object, job: &Job) -> Result<Option<Object>, Cancelled> {
    let Some(marks) = object.marked() else {
        return Ok(None);
    };
    let geometry = extract(&object.geometry, marks, job)?;
    Ok(Some(Object {
        id: ObjectId::next(),
        name: format!("{} (part)", object.name.trim_end_matches(" (part)")),
        source: None,
        loader: None,
        loaded: None,
        selected: false,
        geometry: Arc::new(geometry),
        marks: None,
        revision: Revision::next(),
        ..object.clone()
    }))
}

/// A block of these surfels, counted over all of `blocks`; as many as fit into one.
fn block_of(blocks: &[Block], surfels: &[usize]) -> Block {
    let Some(first) = blocks.first() else {
        return Block::default();
    };
    // All blocks have the same columns.
    let named = first.named.iter().enumerate().map(|(index, column)| {
        let bytes = |block: &Block| block.named.get(index).map(|column| column.bytes.clone());
        let size = column.components as usize * column.scalar.size();
        NamedColumn {
            bytes: gather_bytes(blocks.iter().map(bytes), surfels, size),
            ..column.clone()
        }
    });
    Block {
        position_radius: gather(
            blocks.iter().map(|block| Some(&block.position_radius)),
            surfels,
        )
        .unwrap_or_default(),
        normal: gather(blocks.iter().map(|block| block.normal.as_ref()), surfels),
        colour: gather(blocks.iter().map(|block| block.colour.as_ref()), surfels),
        axes: gather(blocks.iter().map(|block| block.axes.as_ref()), surfels),
        named: named.collect(),
    }
}

/// Values of these surfels from a column's parts, one a block; `None` if a block lacks the column.
fn gather<'a, T: Pod + Send + Sync>(
    parts: impl Iterator<Item = Option<&'a Arc<[T]>>>,
    surfels: &[usize],
) -> Option<Arc<[T]>> {
    let parts: Vec<&Arc<[T]>> = parts.collect::<Option<_>>()?;
    let value = |&surfel: &usize| parts[surfel / MAX_BLOCK_SURFELS][surfel % MAX_BLOCK_SURFELS];
    Some(surfels.par_iter().map(value).collect::<Vec<T>>().into())
}

/// The same for a column of `size` bytes a surfel.
fn gather_bytes(
    parts: impl Iterator<Item = Option<Bytes>>,
    surfels: &[usize],
    size: usize,
) -> Bytes {
    let parts: Vec<Option<Bytes>> = parts.collect();
    let mut bytes = vec![0; surfels.len() * size];
    if size > 0 {
        let values = bytes.par_chunks_exact_mut(size).zip(surfels);
        values.for_each(|(value, &surfel)| {
            let part = parts[surfel / MAX_BLOCK_SURFELS].as_deref();
            let start = surfel % MAX_BLOCK_SURFELS * size;
            if let Some(found) = part.and_then(|part| part.get(start..start + size)) {
                value.copy_from_slice(found);
            }
        });
    }
    bytes.into()
}

/// Number of a surfel that is not kept: no object has so many.
const GONE: u32 = u32::MAX;

/// What these triangles of a geometry take from its pictures.
fn textures(geometry: &Geometry, left: &[(usize, [u32; 3])]) -> Option<Arc<Textures>> {
    let all = geometry.textures.as_ref()?;
    let mut own = TriangleTextures::default();
    for (triangle, _) in left {
        own.push(*all.of_triangle.get(*triangle)?, *all.uvs.get(*triangle)?);
    }
    own.with(all.pictures.clone())
}

/// Triangles whose corners are all kept: the number that each has, and those that its corners have then.
fn remaining(
    triangles: &[[u32; 3]],
    kept: &[usize],
    surfel_count: usize,
    job: &Job,
) -> Result<Vec<(usize, [u32; 3])>, Cancelled> {
    job.check()?;
    let mut numbers = vec![GONE; surfel_count];
    for (number, &surfel) in (0..GONE).zip(kept) {
        numbers[surfel] = number;
    }
    job.check()?;
    let renumbered = |(number, triangle): (usize, &[u32; 3])| {
        let corners = triangle.map(|corner| numbers.get(corner as usize).copied().unwrap_or(GONE));
        (!corners.contains(&GONE)).then_some((number, corners))
    };
    let all = triangles.par_iter().enumerate();
    Ok(all.filter_map(renumbered).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Origins, Provenance, ScalarType};
    use glam::DVec3;
    use proptest::prelude::*;

    const ORIGINS: Origins = Origins {
        normals: Provenance::Estimated,
        radii: Provenance::FromFile,
        colours: Provenance::FromFile,
        axes: Provenance::FromFile,
    };

    /// Surfels in which every column says which one they are.
    fn block(numbers: std::ops::Range<usize>) -> Block {
        let time = numbers.clone().flat_map(|number| {
            [number as u16, 7 * number as u16]
                .map(u16::to_ne_bytes)
                .concat()
        });
        Block {
            position_radius: numbers.clone().map(|n| [n as f32, 1.0, 2.0, 0.5]).collect(),
            normal: Some(numbers.clone().map(|n| n as u32).collect()),
            colour: Some(numbers.clone().map(|n| !(n as u32)).collect()),
            axes: Some(numbers.clone().map(|n| [n as f32; 8]).collect()),
            named: vec![NamedColumn {
                name: "pair".into(),
                scalar: ScalarType::U16,
                components: 2,
                bytes: time.collect(),
            }],
        }
    }

    fn strip(count: usize) -> Geometry {
        let triangle = |corner| [corner, corner + 1, corner + 2];
        let triangles = (0..count.saturating_sub(2) as u32).map(triangle);
        Geometry::new(vec![block(0..count)], Some(triangles.collect()), ORIGINS)
    }

    /// The numbers of the surfels, after a look whether all columns agree.
    fn numbers(geometry: &Geometry) -> Vec<usize> {
        let mut numbers = Vec::new();
        for block in &geometry.blocks {
            for index in 0..block.len() {
                let number = block.centre(index).x as usize;
                assert_eq!(block.normal.as_ref().unwrap()[index], number as u32);
                assert_eq!(block.colour.as_ref().unwrap()[index], !(number as u32));
                assert_eq!(block.axes.as_ref().unwrap()[index], [number as f32; 8]);
                let named = |component| block.named[0].value(index, component);
                assert_eq!(named(0), Some(number as f64));
                assert_eq!(named(1), Some(7.0 * number as f64));
                numbers.push(number);
            }
        }
        numbers
    }

    proptest! {
        #[test]
        fn what_is_copied_and_what_is_left_are_all_of_it(bits in prop::collection::vec(any::<bool>(), 1..120)) {
            let geometry = strip(bits.len());
            let marks = Marks::from_fn(bits.len(), |surfel| bits[surfel]);
            let piece = extract(&geometry, &marks, &Job::new()).unwrap();
            let rest = without_marked(&geometry, &marks, &Job::new()).unwrap();
            let taken = numbers(&piece);
            prop_assert_eq!(&taken, &marks.iter().collect::<Vec<_>>());
            let left = rest.as_ref().map_or_else(Vec::new, numbers);
            prop_assert_eq!(left, marks.inverted().iter().collect::<Vec<_>>());
            prop_assert_eq!(piece.origins, ORIGINS);
            prop_assert!(piece.revision > geometry.revision);
            // Triangles with all corners in one part, and those alone, are in that part.
            let corners = |geometry: &Geometry| -> Vec<[usize; 3]> {
                let numbers = numbers(geometry);
                let triangles = geometry.triangles.iter().flat_map(|triangles| triangles.iter());
                triangles.map(|triangle| triangle.map(|corner| numbers[corner as usize])).collect()
            };
            let whole = corners(&geometry);
            let side = |is_marked: bool| -> Vec<[usize; 3]> {
                let of_side = |triangle: &&[usize; 3]| triangle.iter().all(|&corner| bits[corner] == is_marked);
                whole.iter().filter(of_side).copied().collect()
            };
            prop_assert_eq!(corners(&piece), side(true));
            prop_assert_eq!(rest.as_ref().map_or_else(Vec::new, corners), side(false));
        }
    }

    #[test]
    fn blocks_are_filled_up_and_bounds_measured_again() {
        let whole = MAX_BLOCK_SURFELS;
        let flat = |count: usize, x: f32| Block {
            position_radius: vec![[x, 0.0, 0.0, 1.0]; count].into(),
            ..Block::default()
        };
        let blocks = vec![flat(whole, 1.0), flat(10, 2.0)];
        let geometry = Geometry::new(blocks, None, ORIGINS);
        let marks = Marks::from_fn(whole + 10, |surfel| surfel >= 5);
        let piece = extract(&geometry, &marks, &Job::new()).unwrap();
        let sizes: Vec<usize> = piece.blocks.iter().map(Block::len).collect();
        assert_eq!(sizes, [whole, 5]);
        assert_eq!(piece.blocks[0].centre(whole - 6).x, 1.0);
        assert_eq!(
            piece.blocks[0].centre(whole - 5).x,
            2.0,
            "from the next block"
        );
        let last = Marks::from_fn(whole + 10, |surfel| surfel == whole);
        let piece = extract(&geometry, &last, &Job::new()).unwrap();
        assert_eq!((piece.bounds.min.x, piece.bounds.max.x), (2.0, 2.0));
    }

    #[test]
    fn a_piece_has_the_place_and_the_looks_but_not_the_file() {
        let mut object = Object::new("strip", DVec3::X, strip(6));
        object.source = Some("strip.ply".into());
        object.material.ks = 0.75;
        assert!(
            piece_of(&object, &Job::new()).unwrap().is_none(),
            "nothing is marked"
        );
        object.marks = Some(Arc::new(Marks::from_fn(6, |surfel| surfel < 4)));
        let piece = piece_of(&object, &Job::new()).unwrap().unwrap();
        assert_eq!((piece.origin, piece.material.ks), (DVec3::X, 0.75));
        assert_eq!(piece.geometry.surfel_count, 4);
        assert!(piece.id != object.id && piece.source.is_none() && piece.marks.is_none());
        assert_eq!(piece.name, "strip (part)");
        let marks = Marks::all(6);
        let rest = without_marked(&object.geometry, &marks, &Job::new());
        assert!(rest.unwrap().is_none(), "nothing is left");
        let job = Job::new();
        job.cancel();
        assert!(extract(&object.geometry, &marks, &job).is_err());
    }
}
