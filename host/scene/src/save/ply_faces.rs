//! Triangles in a PLY file, and their places on pictures: what MeshLab writes, and most others read.
//!
//! Each picture is a comment `TextureFile NAME`. A face has the list `texcoord`, u and v of each corner, v from the bottom of the
//! picture; and the number of its picture, `texnumber`, where there are several or it may have none, which is −1.

use super::ply_row::Row;
use crate::geometry::Geometry;
use crate::textures::{NO_PICTURE, Textures, fingerprint};

/// The triangles of an object.
pub(super) struct Faces<'a> {
    triangles: &'a [[u32; 3]],
    textures: Option<&'a Textures>,
    picture_names: &'a [String],
    has_numbers: bool,
    /// Which corner comes first, second, third.
    order: [usize; 3],
}

impl<'a> Faces<'a> {
    /// Those of `geometry`, with textures if their pictures have names; turned round if `is_mirrored`.
    pub(super) fn of(
        geometry: &'a Geometry,
        picture_names: &'a [String],
        is_mirrored: bool,
    ) -> Self {
        let textures = geometry.textures.as_deref();
        let textures = textures.filter(|_| !picture_names.is_empty());
        let count = geometry.triangle_count();
        let has_numbers = textures.is_some_and(|textures| {
            textures.pictures.len() > 1 || (0..count).any(|index| place(textures, index).is_none())
        });
        Self {
            triangles: geometry.triangles.as_deref().unwrap_or_default(),
            textures,
            picture_names,
            has_numbers,
            order: if is_mirrored { [0, 2, 1] } else { [0, 1, 2] },
        }
    }

    /// Comments of the header. `has_colours` says that surfels have the colours of these pictures.
    pub(super) fn comments(&self, has_colours: bool) -> Vec<String> {
        let Some(textures) = self.textures else {
            return Vec::new();
        };
        let names = self.picture_names.iter();
        let files = names.map(|name| format!("comment TextureFile {name}"));
        let colours = has_colours.then(|| {
            let fingerprint = fingerprint(&textures.pictures);
            format!("comment TextureColours {fingerprint:016x}")
        });
        files.chain(colours).collect()
    }

    /// Properties of a face.
    pub(super) fn properties(&self, surfel_count: usize) -> Vec<String> {
        // Most readers know no other type; only indices from 2³¹ on need it.
        let kind = if i32::try_from(surfel_count).is_ok() {
            "int"
        } else {
            "uint"
        };
        let mut lines = vec![format!("property list uchar {kind} vertex_indices")];
        if self.textures.is_some() {
            lines.push("property list uchar float texcoord".to_owned());
        }
        if self.has_numbers {
            lines.push("property int texnumber".to_owned());
        }
        lines
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Adds the values of a face.
    pub(super) fn push(&self, row: &mut Row, index: usize) {
        row.push_u8(3);
        for corner in self.order {
            row.push_u32(self.triangles[index][corner]);
        }
        let Some(textures) = self.textures else {
            return;
        };
        let place = place(textures, index);
        let (number, uvs) = place.map_or((-1, [[0.0; 2]; 3]), |(picture, uvs)| {
            (picture as i32, uvs.map(|[u, v]| [u, 1.0 - v]))
        });
        row.push_u8(6);
        for corner in self.order {
            row.push_f32s(&uvs[corner]);
        }
        if self.has_numbers {
            row.push_i32(number);
        }
    }
}

/// A triangle's picture, and where its corners lie on it.
fn place(textures: &Textures, triangle: usize) -> Option<(u32, [[f32; 2]; 3])> {
    let picture = *textures.of_triangle.get(triangle)?;
    let uvs = *textures.uvs.get(triangle)?;
    let is_placed = uvs.as_flattened().iter().all(|value| value.is_finite());
    (picture != NO_PICTURE && is_placed).then_some((picture, uvs))
}
