//! The textures of a mesh: pictures as their files hold them, and where the triangles lie on them.

use std::sync::Arc;

use pointstage_plugin_api::loading::NO_TEXTURE;
use pointstage_texels::PictureFile;

/// Stands for the picture of a triangle that has none; the number is the same at the border.
pub const NO_PICTURE: u32 = NO_TEXTURE;

/// Pictures, and what triangles take from them. Surfels have the means of their texels as colours; this is for who wants the
/// texels themselves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Textures {
    /// The pictures.
    pub pictures: Vec<PictureFile>,
    /// Index of each triangle's picture, or [`NO_PICTURE`]; as many as the geometry has triangles.
    pub of_triangle: Arc<[u32]>,
    /// Texture coordinates of each triangle's corners: v counts from the top of the picture, NaN stands for none, and what lies
    /// outside 0 to 1 repeats the picture. As many as the geometry has triangles.
    pub uvs: Arc<[[[f32; 2]; 3]]>,
}

/// A number that tells pictures from others: FNV-1a, 64 bits, of their lengths and bytes. It is stored in files.
pub(crate) fn fingerprint(pictures: &[PictureFile]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for picture in pictures {
        let length = (picture.bytes.len() as u64).to_le_bytes();
        for byte in length.iter().chain(picture.bytes.iter()) {
            hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
    hash
}

/// What triangles take from pictures, while they are collected.
#[derive(Clone, Debug, Default)]
pub(crate) struct TriangleTextures {
    pub(crate) pictures: Vec<u32>,
    pub(crate) uvs: Vec<[[f32; 2]; 3]>,
}

impl TriangleTextures {
    /// Fills up with triangles that have none.
    pub(crate) fn fill(&mut self, triangle_count: usize) {
        self.pictures.resize(triangle_count, NO_PICTURE);
        self.uvs.resize(triangle_count, [[f32::NAN; 2]; 3]);
    }

    /// What the next triangle takes.
    pub(crate) fn push(&mut self, picture: u32, uvs: [[f32; 2]; 3]) {
        self.pictures.push(picture);
        self.uvs.push(uvs);
    }

    /// Together with the pictures; `None` if no triangle has one of them.
    pub(crate) fn with(mut self, pictures: Vec<PictureFile>) -> Option<Arc<Textures>> {
        let mut is_any = false;
        for picture in &mut self.pictures {
            if (*picture as usize) < pictures.len() {
                is_any = true;
            } else {
                *picture = NO_PICTURE;
            }
        }
        is_any.then(|| {
            Arc::new(Textures {
                pictures,
                of_triangle: self.pictures.into(),
                uvs: self.uvs.into(),
            })
        })
    }
}
