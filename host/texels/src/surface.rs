//! A textured mesh, and the colours of its vertices.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::footprint::Wrap;
use crate::light::LightSum;
use crate::picture::{Picture, PictureFile};

/// Stands for the material of a triangle that has none.
pub const NO_MATERIAL: u32 = u32::MAX;

/// Triangles treated between two looks at the cancel flag.
const TRIANGLES_A_PIECE: usize = 1 << 14;

/// Triangles with texture coordinates at their corners.
#[derive(Clone, Debug, Default)]
pub struct Surface {
    /// Of the vertices.
    pub positions: Vec<[f64; 3]>,
    /// Corners; a triangle with one that is no vertex is passed over.
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates of each triangle's corners, v from the top of the picture; NaN where there are none.
    pub uvs: Vec<[[f32; 2]; 3]>,
    /// Index of each triangle's material, or [`NO_MATERIAL`].
    pub materials: Vec<u32>,
}

/// What gives a face its colour.
#[derive(Clone, Debug)]
pub struct Material {
    /// The picture, if it has one.
    pub picture: Option<Arc<Picture>>,
    /// What the picture's light is multiplied by, linear with straight alpha.
    pub factor: [f32; 4],
    /// What lies outside the picture, to the sides and above and below.
    pub wrap: [Wrap; 2],
    /// The colour without a picture, or without texture coordinates, linear with straight alpha; `None` gives none.
    pub plain: Option<[f32; 4]>,
}

impl Material {
    /// One of a picture that repeats.
    pub fn of_picture(picture: Arc<Picture>) -> Self {
        Self {
            picture: Some(picture),
            ..Self::nothing()
        }
    }

    /// One that gives no colour, such as that of a picture which cannot be read.
    pub fn nothing() -> Self {
        Self {
            picture: None,
            factor: [1.0; 4],
            wrap: [Wrap::Repeat; 2],
            plain: None,
        }
    }

    /// One of a single colour, linear with straight alpha.
    pub fn of_colour(colour: [f32; 4]) -> Self {
        Self {
            plain: Some(colour),
            ..Self::nothing()
        }
    }

    /// Light times alpha that a part of the texture plane gives.
    pub fn light(&self, part: [DVec2; 4]) -> Option<[f32; 4]> {
        let cover =
            |[red, green, blue, alpha]: [f32; 4]| [red * alpha, green * alpha, blue * alpha, alpha];
        let picture = self.picture.as_ref();
        let light = picture.and_then(|picture| picture.mean(part, self.wrap));
        let factor = cover(self.factor);
        let multiplied =
            light.map(|light| std::array::from_fn(|channel| light[channel] * factor[channel]));
        multiplied.or_else(|| self.plain.map(cover))
    }
}

/// The files of the materials' pictures, each once, and for each material the index of its own, if it has one.
pub fn picture_files(materials: &[Material]) -> (Vec<PictureFile>, Vec<Option<u32>>) {
    let mut files: Vec<PictureFile> = Vec::new();
    let index = |material: &Material| {
        let file = material.picture.as_ref()?.file()?;
        let known = files.iter().position(|known| known == file);
        let index = known.unwrap_or_else(|| {
            files.push(file.clone());
            files.len() - 1
        });
        Some(index as u32)
    };
    let indices = materials.iter().map(index).collect();
    (files, indices)
}

impl Surface {
    /// Corners of a triangle, if all of them are vertices.
    pub(crate) fn corners(&self, triangle: usize) -> Option<[DVec3; 3]> {
        let [a, b, c] = *self.triangles.get(triangle)?;
        let at = |corner: u32| {
            let position = self.positions.get(corner as usize)?;
            Some(DVec3::from_array(*position))
        };
        Some([at(a)?, at(b)?, at(c)?])
    }

    fn material<'m>(&self, triangle: usize, materials: &'m [Material]) -> Option<&'m Material> {
        materials.get(*self.materials.get(triangle)? as usize)
    }

    /// Area of a triangle, and the light at its three corners; `None` where it has no colour.
    fn lights(&self, triangle: usize, materials: &[Material]) -> Option<(f64, [[f32; 4]; 3])> {
        let [a, b, c] = self.corners(triangle)?;
        let material = self.material(triangle, materials)?;
        let uvs = self
            .uvs
            .get(triangle)
            .copied()
            .unwrap_or([[f32::NAN; 2]; 3])
            .map(|[u, v]| DVec2::new(f64::from(u), f64::from(v)));
        let middle = (uvs[0] + uvs[1] + uvs[2]) / 3.0;
        let light = |corner: usize| {
            let (own, next, last) = (uvs[corner], uvs[(corner + 1) % 3], uvs[(corner + 2) % 3]);
            material.light([own, own.midpoint(next), middle, own.midpoint(last)])
        };
        // A triangle without area, or too small for a number, still colours a vertex that has no other.
        let area = (0.5 * (b - a).cross(c - a).length()).max(f64::MIN_POSITIVE);
        let lights = [light(0)?, light(1)?, light(2)?];
        area.is_finite().then_some((area, lights))
    }
}

/// Sums of light for each vertex; `check` is asked between pieces, with the part that is done.
///
/// # Errors
/// Those of `check`.
pub fn colours<E>(
    surface: &Surface,
    materials: &[Material],
    mut check: impl FnMut(f32) -> Result<(), E>,
) -> Result<Vec<LightSum>, E> {
    let mut sums = vec![LightSum::default(); surface.positions.len()];
    let count = surface.triangles.len();
    for start in (0..count).step_by(TRIANGLES_A_PIECE) {
        check(start as f32 / count as f32)?;
        let piece = start..count.min(start + TRIANGLES_A_PIECE);
        let lights: Vec<_> = piece
            .clone()
            .into_par_iter()
            .map(|triangle| surface.lights(triangle, materials))
            .collect();
        // One after the other, so that sums do not depend on threads.
        for (triangle, found) in piece.zip(lights) {
            let Some((area, lights)) = found else {
                continue;
            };
            for (corner, light) in surface.triangles[triangle].iter().zip(lights) {
                sums[*corner as usize].add(light, area);
            }
        }
    }
    Ok(sums)
}

/// Sums of light for each vertex from colours of faces: each face counts with its area, divided by its corners.
///
/// `lengths` are those of the polygons, whose corners follow each other in `corners`; `colour` is a face's, linear with straight
/// alpha. What names no vertex is passed over.
pub fn face_colours(
    vertex_count: usize,
    lengths: impl IntoIterator<Item = u32>,
    corners: &[u32],
    position: impl Fn(u32) -> DVec3,
    colour: impl Fn(usize) -> Option<[f32; 4]>,
) -> Vec<LightSum> {
    let mut sums = vec![LightSum::default(); vertex_count];
    let mut rest = corners;
    let mut places: Vec<DVec3> = Vec::new();
    for (face, length) in lengths.into_iter().enumerate() {
        let (own, others) = rest.split_at((length as usize).min(rest.len()));
        rest = others;
        let Some([red, green, blue, alpha]) = colour(face) else {
            continue;
        };
        let are_vertices = own.iter().all(|corner| (*corner as usize) < vertex_count);
        if own.len() < 3 || !are_vertices {
            continue;
        }
        places.clear();
        places.extend(own.iter().map(|corner| position(*corner)));
        let area = 0.5 * crate::polygon::newell_normal(&places).length();
        let share = (area / own.len() as f64).max(f64::MIN_POSITIVE);
        if share.is_finite() {
            for corner in own {
                sums[*corner as usize]
                    .add([red * alpha, green * alpha, blue * alpha, alpha], share);
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::srgb_byte;
    use crate::picture::Alpha;

    fn halves() -> Arc<Picture> {
        // Left red, right blue.
        let texel = |index: usize| {
            if index % 8 < 4 {
                [255, 0, 0, 255]
            } else {
                [0, 0, 255, 255]
            }
        };
        let bytes = (0..64).flat_map(texel).collect();
        Arc::new(Picture::from_rgba(8, 8, bytes, Alpha::Respected))
    }

    fn of_all(surface: &Surface, materials: &[Material]) -> Vec<Option<[u8; 3]>> {
        let never = |_| Ok::<(), std::convert::Infallible>(());
        let Ok(sums) = colours(surface, materials, never);
        sums.iter()
            .map(|sum| sum.mean().map(|[r, g, b, _]| [r, g, b].map(srgb_byte)))
            .collect()
    }

    #[test]
    fn a_vertex_takes_what_lies_nearest_and_both_sides_of_a_seam() {
        let surface = Surface {
            positions: vec![
                [0.0; 3],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [-1.0, 0.0, 0.0],
                [9.0; 3],
            ],
            triangles: vec![[0, 1, 2], [0, 2, 3], [0, 1, 77]],
            uvs: vec![
                [[0.0, 0.0], [0.4, 0.0], [0.0, 0.4]],
                [[0.6, 0.0], [0.9, 0.0], [0.6, 0.4]],
                [[0.0; 2]; 3],
            ],
            materials: vec![0, 0, 0],
        };
        let found = of_all(&surface, &[Material::of_picture(halves())]);
        // Half of the light of each: 188 of 255.
        let half = Some([188, 0, 188]);
        assert_eq!(
            found,
            [half, Some([255, 0, 0]), half, Some([0, 0, 255]), None]
        );
    }

    #[test]
    fn larger_faces_count_more_and_factors_multiply() {
        let surface = Surface {
            positions: vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            uvs: vec![[[0.1, 0.1]; 3], [[f32::NAN; 2]; 3]],
            materials: vec![0, 1],
        };
        let mut half = Material::of_picture(halves());
        half.factor = [0.5, 1.0, 1.0, 1.0];
        let green = Material::of_colour([0.0, 1.0, 0.0, 1.0]);
        let never = |_| Ok::<(), std::convert::Infallible>(());
        let Ok(sums) = colours(&surface, &[half, green], never);
        let [red, green, blue, alpha] = sums[0].mean().unwrap();
        assert!(
            (red - 0.375).abs() < 1e-6 && (green - 0.25).abs() < 1e-6,
            "{red} {green}"
        );
        assert_eq!((blue, alpha), (0.0, 1.0));
    }

    #[test]
    fn colours_of_faces_are_weighted_by_area() {
        let places = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 0.0]]
            .map(|[x, y]| DVec3::new(x, y, 0.0));
        let sums = face_colours(
            5,
            [4, 3, 3],
            &[0, 1, 2, 3, 0, 3, 4, 0, 1, 9],
            |corner| places[corner as usize],
            |face| {
                Some(if face == 0 {
                    [1.0, 0.0, 0.0, 1.0]
                } else {
                    [0.0, 0.0, 1.0, 1.0]
                })
            },
        );
        // A quarter of area 1 and a third of area 1/2.
        let [red, _, blue, _] = sums[0].mean().unwrap();
        assert!(
            (red - 0.6).abs() < 1e-6 && (blue - 0.4).abs() < 1e-6,
            "{red} {blue}"
        );
        assert_eq!(sums[1].mean(), Some([1.0, 0.0, 0.0, 1.0]));
        assert_eq!(sums[4].mean(), Some([0.0, 0.0, 1.0, 1.0]));
    }
}
