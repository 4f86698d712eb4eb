//! Several objects made one.

use std::ops::Range;
use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3, Vec3, Vec4};
use pointstage_plugin_api::columns::{
    MAX_BLOCK_SURFELS, NO_NORMAL, decode_normal, encode_colour, encode_normal, srgb_from_linear,
};
use rayon::prelude::*;

use super::named::{Union, unions};
use crate::bounds::Bounds;
use crate::geometry::{Block, Geometry, NamedColumn, Origins, Provenance};
use crate::load::origin_for;
use crate::moved::Moved;
use crate::scene::Object;
use crate::textures::{NO_PICTURE, Textures, TriangleTextures};

/// Linear grey of surfels without a colour, as renderers draw them.
const MID_GREY: f32 = 0.5;

/// Objects that cannot be merged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MergeError {
    /// There is nothing to merge.
    #[error("merging takes two objects or more, found {0}; select the objects to merge")]
    TooFew(usize),
    /// Triangles cannot name so many surfels.
    #[error(
        "the objects have {0} surfels together, and triangles can name 4294967295 at most; merge fewer objects"
    )]
    TooManySurfels(usize),
}

/// One object on its way into the union.
struct Part<'a> {
    object: &'a Object,
    /// Number of its first surfel in the union.
    first: usize,
    /// Into the union's space; `None` where the object is in it.
    moved: Option<Moved>,
    /// Whether directions stay as they are.
    is_shifted_only: bool,
}

/// What the union has.
struct Columns {
    normals: bool,
    colours: bool,
    axes: bool,
    named: Vec<Union>,
}

/// One object of all surfels and triangles of `objects`, in their order, with the first one's material.
///
/// Transforms, origins and radius scales are applied; objects that stand in the same place keep it, and their positions to
/// the last bit. A column that one of the objects has, all surfels get: colours are the grey in which renderers draw surfels
/// without one, normals are 'not known', axes are those of the disk of normal and radius (the disk in the plane of x and y
/// where no normal is known), and named columns are 0. Named columns of the same name and of different types become f64.
/// Where normals of one object are estimated, all count as estimated, and are lit from both sides.
///
/// # Errors
/// There are fewer than two objects, or too many surfels for the triangles.
pub fn merge(objects: &[&Object], name: impl Into<String>) -> Result<Object, MergeError> {
    let [first, others @ ..] = objects else {
        return Err(MergeError::TooFew(0));
    };
    if others.is_empty() {
        return Err(MergeError::TooFew(1));
    }
    let count = objects
        .iter()
        .map(|object| object.geometry.surfel_count)
        .sum();
    let has_triangles = objects
        .iter()
        .any(|object| object.geometry.triangles.is_some());
    if has_triangles && u32::try_from(count).is_err() {
        return Err(MergeError::TooManySurfels(count));
    }
    let stand_together = others.iter().all(|object| {
        (object.origin, object.world_from_object) == (first.origin, first.world_from_object)
    });
    let (origin, world_from_object) = if stand_together {
        (first.origin, first.world_from_object)
    } else {
        let bounds = objects.iter().fold(Bounds::EMPTY, |bounds, object| {
            bounds.union(object.bounds_world())
        });
        (origin_for(&bounds), DAffine3::IDENTITY)
    };
    let parts = parts(objects, (!stand_together).then_some(origin));
    let columns = Columns {
        normals: has(objects, |block| block.normal.is_some()),
        colours: has(objects, |block| block.colour.is_some()),
        axes: has(objects, |block| block.axes.is_some()),
        named: unions(objects),
    };
    let starts: Vec<usize> = (0..count).step_by(MAX_BLOCK_SURFELS).collect();
    let blocks = starts
        .into_par_iter()
        .map(|start| columns.block(&parts, start..count.min(start + MAX_BLOCK_SURFELS)))
        .collect();
    let triangles = has_triangles.then(|| triangles(&parts));
    let mut geometry = Geometry::new(blocks, triangles, origins(objects));
    geometry.textures = textures(&parts);
    let mut merged = Object::new(name, origin, geometry);
    merged.world_from_object = world_from_object;
    merged.placed = world_from_object;
    merged.material = first.material;
    Ok(merged)
}

fn parts<'a>(objects: &[&'a Object], origin: Option<DVec3>) -> Vec<Part<'a>> {
    let mut next = 0;
    let parts = objects.iter().map(|object| {
        let first = next;
        next += object.geometry.surfel_count;
        let local_from_local = origin
            .map(|origin| DAffine3::from_translation(-origin) * object.world_from_local())
            .filter(|map| *map != DAffine3::IDENTITY);
        Part {
            object,
            first,
            moved: local_from_local.map(Moved::new),
            is_shifted_only: local_from_local.is_none_or(|map| map.matrix3 == DMat3::IDENTITY),
        }
    });
    parts.collect()
}

/// Whether a block of any object has a column.
fn has(objects: &[&Object], column: impl Fn(&Block) -> bool) -> bool {
    let mut blocks = objects
        .iter()
        .flat_map(|object| object.geometry.blocks.iter());
    blocks.any(column)
}

impl Part<'_> {
    /// A surfel of the union in its block; `None` for one of another part.
    fn find(&self, number: usize) -> Option<(&Block, usize)> {
        self.object.geometry.locate(number.checked_sub(self.first)?)
    }

    fn position_radius(&self, block: &Block, surfel: usize) -> [f32; 4] {
        let [x, y, z, radius] = block.position_radius[surfel];
        let [x, y, z, radius] = match &self.moved {
            None => [x, y, z, radius],
            Some(moved) => {
                let position = moved.position(block.centre(surfel).as_dvec3()).as_vec3();
                let radius = moved.radius(radius);
                [position.x, position.y, position.z, radius]
            }
        };
        [x, y, z, radius * self.object.radius_scale]
    }

    fn normal(&self, block: &Block, surfel: usize) -> u32 {
        let packed = block.normal.as_ref().and_then(|all| all.get(surfel));
        let packed = packed.copied().unwrap_or(NO_NORMAL);
        let Some(moved) = self.moved.filter(|_| !self.is_shifted_only) else {
            return packed;
        };
        if packed == NO_NORMAL {
            return NO_NORMAL;
        }
        match moved.normal(decode_normal(packed)) {
            // Of an object that is flat in one direction nothing is known.
            normal if normal == Vec3::ZERO => NO_NORMAL,
            normal => encode_normal(normal),
        }
    }

    fn axes(&self, block: &Block, surfel: usize) -> [f32; 8] {
        let own = block.axes.as_ref().and_then(|all| all.get(surfel));
        let axes = if let Some(&[ux, uy, uz, _, vx, vy, vz, _]) = own {
            let axes = [Vec3::new(ux, uy, uz), Vec3::new(vx, vy, vz)];
            let axes = match &self.moved {
                Some(moved) => moved.axes(axes),
                None => axes,
            };
            axes.map(|axis| axis * self.object.radius_scale)
        } else {
            let [.., radius] = self.position_radius(block, surfel);
            let normal = match self.normal(block, surfel) {
                NO_NORMAL => Vec3::Z,
                packed => decode_normal(packed),
            };
            let (u, v) = normal.any_orthonormal_pair();
            [u * radius, v * radius]
        };
        let [u, v] = axes;
        [u.x, u.y, u.z, 0.0, v.x, v.y, v.z, 0.0]
    }
}

impl Columns {
    /// One block of the union.
    fn block(&self, parts: &[Part<'_>], range: Range<usize>) -> Block {
        let grey = srgb_from_linear(MID_GREY);
        let grey = encode_colour(Vec4::new(grey, grey, grey, 1.0));
        let position_radius =
            |part: &Part<'_>, block: &Block, at: usize| part.position_radius(block, at);
        let normal = |part: &Part<'_>, block: &Block, at: usize| part.normal(block, at);
        let axes = |part: &Part<'_>, block: &Block, at: usize| part.axes(block, at);
        let colour = |_: &Part<'_>, block: &Block, surfel: usize| {
            let own = block.colour.as_ref().and_then(|all| all.get(surfel));
            own.copied().unwrap_or(grey)
        };
        let named = self.named.iter().map(|union| {
            let mut bytes =
                Vec::with_capacity(range.len() * union.scalar.size() * union.components as usize);
            each(parts, &range, |number, _, block, surfel| {
                union.push(&mut bytes, number, block, surfel);
            });
            NamedColumn {
                name: Arc::clone(&union.name),
                scalar: union.scalar,
                components: union.components,
                bytes: bytes.into(),
            }
        });
        Block {
            position_radius: column(parts, &range, position_radius),
            normal: self.normals.then(|| column(parts, &range, normal)),
            colour: self.colours.then(|| column(parts, &range, colour)),
            axes: self.axes.then(|| column(parts, &range, axes)),
            named: named.collect(),
        }
    }
}

/// A column of one block of the union.
fn column<T>(
    parts: &[Part<'_>],
    range: &Range<usize>,
    value: impl Fn(&Part<'_>, &Block, usize) -> T,
) -> Arc<[T]> {
    let mut values = Vec::with_capacity(range.len());
    each(parts, range, |_, part, block, surfel| {
        values.push(value(part, block, surfel));
    });
    values.into()
}

/// Visits the surfels of a range of the union: the number of the part, the part, and the surfel in its block.
fn each(
    parts: &[Part<'_>],
    range: &Range<usize>,
    mut visit: impl FnMut(usize, &Part<'_>, &Block, usize),
) {
    for (number, part) in parts.iter().enumerate() {
        let end = part.first + part.object.geometry.surfel_count;
        for surfel in range.start.max(part.first)..range.end.min(end) {
            if let Some((block, inside)) = part.find(surfel) {
                visit(number, part, block, inside);
            }
        }
    }
}

/// All triangles, each over its own part's surfels; those of mirrored parts are turned around, so that outside stays outside.
fn triangles(parts: &[Part<'_>]) -> Arc<[[u32; 3]]> {
    let of_part = |part: &Part<'_>| {
        let first = part.first as u32;
        let is_mirrored = part.moved.is_some_and(|moved| moved.mirror < 0.0);
        let triangles = part.object.geometry.triangles.clone();
        let shifted = move |&[a, b, c]: &[u32; 3]| {
            let [b, c] = if is_mirrored { [c, b] } else { [b, c] };
            [a, b, c].map(|corner| first + corner)
        };
        let triangles = triangles.iter().flat_map(|all| all.iter().map(&shifted));
        triangles.collect::<Vec<_>>()
    };
    parts.iter().flat_map(of_part).collect()
}

/// What all triangles take from pictures; `None` if no part has any.
fn textures(parts: &[Part<'_>]) -> Option<Arc<Textures>> {
    let (mut all, mut pictures, mut triangles) = (TriangleTextures::default(), Vec::new(), 0);
    for part in parts {
        let geometry = &part.object.geometry;
        if let Some(own) = &geometry.textures {
            let first = pictures.len() as u32;
            let is_mirrored = part.moved.is_some_and(|moved| moved.mirror < 0.0);
            pictures.extend(own.pictures.iter().cloned());
            for (picture, &[a, b, c]) in own.of_triangle.iter().zip(own.uvs.iter()) {
                let [b, c] = if is_mirrored { [c, b] } else { [b, c] };
                let picture = match *picture {
                    NO_PICTURE => NO_PICTURE,
                    picture => first + picture,
                };
                all.push(picture, [a, b, c]);
            }
        }
        triangles += geometry.triangle_count();
        all.fill(triangles);
    }
    all.with(pictures)
}

/// Of each column, what is least certain of those that have it.
fn origins(objects: &[&Object]) -> Origins {
    let of = |column: fn(&Origins) -> Provenance| {
        let all = || {
            objects
                .iter()
                .map(|object| column(&object.geometry.origins))
        };
        [
            Provenance::Estimated,
            Provenance::FromFaces,
            Provenance::FromFile,
        ]
        .into_iter()
        .find(|kind| all().any(|own| own == *kind))
        .unwrap_or(Provenance::Missing)
    };
    Origins {
        normals: of(|origins| origins.normals),
        radii: of(|origins| origins.radii),
        colours: of(|origins| origins.colours),
        axes: of(|origins| origins.axes),
    }
}

#[cfg(test)]
#[path = "merge_tests.rs"]
mod tests;
