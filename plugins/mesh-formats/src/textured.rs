//! Colours of a mesh from the pictures of its materials.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use pointstage_plugin_api::glam::DVec3;
use pointstage_plugin_api::loading::{NO_TEXTURE, Output};
use pointstage_plugin_api::{Error, Progress, Result, Settings};
use pointstage_texels::polygon::triangulate;
use pointstage_texels::{
    Alpha, LightSum, MOST_VERTICES, Material, NO_MATERIAL, Picture, Surface, colours, divide,
    linear, picture_files, read_beside, srgb,
};

use crate::columns::{FaceTextures, Mesh};

/// What is made of textures, as the setting `textures` says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Textures {
    /// They are not read.
    #[default]
    None,
    /// A vertex takes the mean of the texels round it.
    Vertices,
    /// The same, after triangles that are coarser than their texture have been divided.
    Divide,
}

impl Textures {
    pub(crate) fn of(settings: Settings<'_>) -> Result<Self> {
        match settings.choice("textures")? {
            "none" => Ok(Self::None),
            "vertices" => Ok(Self::Vertices),
            "divide" => Ok(Self::Divide),
            other => Err(Error::failed(format!(
                "expected none, vertices or divide for 'textures', found '{other}'"
            ))),
        }
    }
}

/// How a texture's colour meets a vertex's own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meets {
    /// It takes its place.
    Replaces,
    /// They are multiplied as light.
    Multiplies,
}

/// Pictures that were read, by name; none in place of one that cannot be read, which was a warning.
#[derive(Debug, Default)]
pub(crate) struct Pictures {
    known: HashMap<String, Option<Arc<Picture>>>,
}

impl Pictures {
    /// The picture that `file` calls `name`.
    pub(crate) fn beside(
        &mut self,
        file: &Path,
        name: &str,
        out: &mut Output<'_>,
    ) -> Option<Arc<Picture>> {
        if let Some(known) = self.known.get(name) {
            return known.clone();
        }
        let read = read_beside(file, name)
            .map_err(|error| error.to_string())
            .and_then(|bytes| {
                Picture::of_file(name, bytes, Alpha::Respected).map_err(|error| error.to_string())
            });
        let picture = match read {
            Ok(picture) => Some(Arc::new(picture)),
            Err(error) => {
                out.warn(
                    &format!(
                        "the texture '{name}' cannot be read ({error}): its colours are left out"
                    ),
                    1,
                );
                None
            }
        };
        self.known.insert(name.to_owned(), picture.clone());
        picture
    }
}

/// What a mesh's faces have beside their corners.
#[derive(Debug, Default)]
pub(crate) struct Textured {
    /// Texture coordinates of each corner of the mesh, v from the top; NaN, or missing at the end, where there are none.
    pub(crate) uvs: Vec<[f32; 2]>,
    /// Index of each face's material; [`NO_MATERIAL`], or missing at the end, where there is none.
    pub(crate) faces: Vec<u32>,
    pub(crate) materials: Vec<Material>,
    /// Whether the file counts v from the bottom of the picture, and so do the vertices' own texture coordinates.
    pub(crate) is_from_bottom: bool,
}

impl Textured {
    /// Whether any material has a picture.
    pub(crate) fn has_pictures(&self) -> bool {
        self.materials
            .iter()
            .any(|material| material.picture.is_some())
    }

    /// Colours the mesh, and divides it if `how` says so. The mesh takes over what faces say of their textures.
    pub(crate) fn colour(
        &mut self,
        mesh: &mut Mesh,
        how: Textures,
        meets: Meets,
        out: &mut Output<'_>,
        progress: &Progress<'_>,
    ) -> Result<()> {
        progress.set(0.5, "taking colours from textures");
        let mut surface = self.surface(mesh);
        let mut is_divided = false;
        if how == Textures::Divide {
            let divided = divide(&mut surface, &self.materials, MOST_VERTICES, || {
                progress.check()
            })?;
            out.warn(
                &format!("the texture is finer than {MOST_VERTICES} vertices can show: they take the mean of many texels"),
                u64::from(divided.is_cut_short),
            );
            is_divided = !divided.parents.is_empty();
            mesh.divide(&divided.parents, &surface, self.is_from_bottom);
        }
        self.keep(is_divided.then_some(&surface), mesh);
        let sums = colours(&surface, &self.materials, |done| {
            progress.set(0.5 + 0.5 * done, "taking colours from textures");
            progress.check()
        })?;
        mesh.take_light(&sums, meets);
        Ok(())
    }

    /// Gives the mesh the pictures of its faces: those of `divided` if it has become that.
    fn keep(&mut self, divided: Option<&Surface>, mesh: &mut Mesh) {
        let (files, indices) = picture_files(&self.materials);
        if files.is_empty() {
            return;
        }
        let of = |material: &u32| {
            let index = indices.get(*material as usize);
            index.copied().flatten().unwrap_or(NO_TEXTURE)
        };
        let (faces, mut uvs) = match divided {
            Some(surface) => (&surface.materials, surface.uvs.as_flattened().to_vec()),
            None => (&self.faces, std::mem::take(&mut self.uvs)),
        };
        let mut faces: Vec<u32> = faces.iter().map(of).collect();
        faces.resize(mesh.lengths.len(), NO_TEXTURE);
        uvs.resize(mesh.corners.len(), [f32::NAN; 2]);
        mesh.textures = FaceTextures { files, faces, uvs };
    }

    /// The mesh's faces as triangles; what names no vertex, or is no face, is left to the host, which counts it.
    fn surface(&self, mesh: &Mesh) -> Surface {
        let mut surface = Surface {
            positions: mesh.positions.clone(),
            ..Surface::default()
        };
        let (mut places, mut parts) = (Vec::new(), Vec::new());
        let mut start = 0;
        for (face, length) in mesh.lengths.iter().enumerate() {
            let corners = start..start + *length as usize;
            start = corners.end;
            let Some(own) = mesh
                .corners
                .get(corners.clone())
                .filter(|own| own.len() > 2)
            else {
                continue;
            };
            places.clear();
            places.extend(own.iter().map(|corner| {
                let place = mesh.positions.get(*corner as usize);
                place.map_or(DVec3::NAN, |place| DVec3::from_array(*place))
            }));
            parts.clear();
            triangulate(&places, &mut parts);
            for part in &parts {
                let uv = |corner: usize| {
                    let uv = self.uvs.get(corners.start + corner);
                    uv.copied().unwrap_or([f32::NAN; 2])
                };
                surface.triangles.push(part.map(|corner| own[corner]));
                surface.uvs.push(part.map(uv));
                let material = self.faces.get(face).copied().unwrap_or(NO_MATERIAL);
                surface.materials.push(material);
            }
        }
        surface
    }
}

impl Mesh {
    /// Takes over what dividing made: new vertices in the middle of two, and all faces as triangles.
    fn divide(&mut self, parents: &[[u32; 2]], surface: &Surface, is_from_bottom: bool) {
        if parents.is_empty() {
            return;
        }
        let count = surface.positions.len();
        self.positions.clone_from(&surface.positions);
        for [a, b] in parents {
            let (a, b) = (*a as usize, *b as usize);
            if !self.normals.is_empty() {
                let (a, b) = (self.normals[a], self.normals[b]);
                self.normals
                    .push(std::array::from_fn(|axis| a[axis] + b[axis]));
            }
            if !self.colours.is_empty() {
                let (a, b) = (self.colours[a], self.colours[b]);
                self.colours.push(std::array::from_fn(|channel| {
                    srgb(f32::midpoint(linear(a[channel]), linear(b[channel])))
                }));
            }
        }
        if !self.uvs.is_empty() {
            self.uvs.resize(count, [f32::NAN; 2]);
            for (corners, uvs) in surface.triangles.iter().zip(&surface.uvs) {
                for (corner, uv) in corners.iter().zip(uvs) {
                    if let Some(own) = self.uvs.get_mut(*corner as usize)
                        && own[0].is_nan()
                    {
                        let [u, v] = *uv;
                        *own = [u, if is_from_bottom { 1.0 - v } else { v }];
                    }
                }
            }
        }
        self.corners = surface.triangles.as_flattened().to_vec();
        self.lengths = vec![3; surface.triangles.len()];
    }

    /// Gives vertices the mean of what was summed for them; others keep their colour, or are white.
    pub(crate) fn take_light(&mut self, sums: &[LightSum], meets: Meets) {
        self.colours.resize(self.positions.len(), [1.0; 3]);
        for (colour, sum) in self.colours.iter_mut().zip(sums) {
            let Some([red, green, blue, _]) = sum.mean() else {
                continue;
            };
            let light = [red, green, blue];
            *colour = std::array::from_fn(|channel| {
                srgb(match meets {
                    Meets::Replaces => light[channel],
                    Meets::Multiplies => light[channel] * linear(colour[channel]),
                })
            });
        }
    }
}
