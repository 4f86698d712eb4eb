//! The faces' places on pictures.

use pointstage_texels::Surface;

use super::body::Body;
use crate::load::assemble::{CornerLists, Corners, FaceData, FaceKind};
use crate::textures::NO_PICTURE;

/// A surface's triangles as corners of a file, with what they take from pictures.
pub(super) fn triangles_of(surface: &Surface, indices: &[Option<u32>]) -> Corners {
    let pictures = surface.materials.iter();
    Corners::Lists(CornerLists {
        kind: FaceKind::Polygons,
        lengths: vec![3; surface.triangles.len()],
        corners: surface.triangles.as_flattened().to_vec(),
        with_holes: 0,
        data: FaceData {
            uvs: surface.uvs.as_flattened().to_vec(),
            pictures: pictures.map(|number| index_of(*number, indices)).collect(),
            colours: Vec::new(),
        },
    })
}

/// Gives the faces their places on pictures, which they name by number.
pub(super) fn keep_pictures(
    body: &mut Body<'_>,
    row_uvs: Option<&[[f32; 2]]>,
    indices: &[Option<u32>],
) {
    for faces in &mut body.faces {
        keep_places(faces, row_uvs);
        if let Corners::Lists(lists) = faces {
            for picture in &mut lists.data.pictures {
                *picture = index_of(*picture, indices);
            }
        }
    }
}

/// Index of a picture among those that were read.
fn index_of(number: u32, indices: &[Option<u32>]) -> u32 {
    let index = indices.get(number as usize).copied();
    index.flatten().unwrap_or(NO_PICTURE)
}

/// Texture coordinates of all corners from the top of the picture, those of `row_uvs` where faces have none of their own; the first
/// picture where faces name none. Strips have neither.
fn keep_places(faces: &mut Corners, row_uvs: Option<&[[f32; 2]]>) {
    if let Corners::Triangles(triangles) = faces {
        *faces = Corners::Lists(CornerLists {
            kind: FaceKind::Polygons,
            lengths: vec![3; triangles.corners.len()],
            corners: triangles.corners.as_flattened().to_vec(),
            with_holes: 0,
            data: FaceData::default(),
        });
    }
    let Corners::Lists(lists) = faces else {
        return;
    };
    if lists.kind == FaceKind::Strips {
        lists.data = FaceData::default();
        return;
    }
    let FaceData { uvs, pictures, .. } = &mut lists.data;
    if uvs.is_empty() {
        let of_row = |row: &u32| {
            let uv = row_uvs.and_then(|uvs| uvs.get(*row as usize));
            uv.copied().unwrap_or([f32::NAN; 2])
        };
        uvs.extend(lists.corners.iter().map(of_row));
    }
    for [_, v] in uvs {
        *v = 1.0 - *v;
    }
    pictures.resize(lists.lengths.len(), 0);
}
