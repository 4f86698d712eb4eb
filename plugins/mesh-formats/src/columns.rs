//! A mesh in memory, handed over to the host in runs.

use pointstage_plugin_api::abi::ScalarType;
use pointstage_plugin_api::glam::DVec3;
use pointstage_plugin_api::loading::{Column, Output, bytes_of};
use pointstage_plugin_api::{ColumnRole, Progress, Result};
use pointstage_texels::{PictureFile, face_colours};

use crate::textured::Meets;

/// Surfels handed over at once: a few milliseconds between two looks at the cancel flag.
const RUN: usize = 1 << 16;

/// Colours that are given as floats.
const RGB_F32: Column<'static> = Column::of(ColumnRole::COLOUR, ScalarType::F32, 3);
/// Texture coordinates, for which there is no column of the host's own.
const UV: Column<'static> = Column::named("uv", ScalarType::F32, 2);

/// Vertices and polygons. A column that is empty is not handed over; any other has a value for each vertex.
#[derive(Debug, Default)]
pub(crate) struct Mesh {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) normals: Vec<[f32; 3]>,
    pub(crate) colours: Vec<[f32; 3]>,
    pub(crate) uvs: Vec<[f32; 2]>,
    /// Length of each polygon.
    pub(crate) lengths: Vec<u32>,
    /// Corners of all polygons.
    pub(crate) corners: Vec<u32>,
    pub(crate) textures: FaceTextures,
}

/// Pictures that polygons take.
#[derive(Debug, Default)]
pub(crate) struct FaceTextures {
    pub(crate) files: Vec<PictureFile>,
    /// Index of each polygon's file, or `NO_TEXTURE`; nothing without files.
    pub(crate) faces: Vec<u32>,
    /// Texture coordinates of all corners, v from the top.
    pub(crate) uvs: Vec<[f32; 2]>,
}

impl Mesh {
    /// Gives vertices the mean of their faces' colours, linear with straight alpha, in linear light and weighted by area.
    pub(crate) fn take_face_colours(&mut self, colours: &[Option<[f32; 4]>]) {
        let sums = face_colours(
            self.positions.len(),
            self.lengths.iter().copied(),
            &self.corners,
            |corner| {
                let place = self.positions.get(corner as usize);
                place.map_or(DVec3::NAN, |place| DVec3::from_array(*place))
            },
            |face| colours.get(face).copied().flatten(),
        );
        self.take_light(&sums, Meets::Replaces);
    }

    /// Adds vertices and polygons that follow.
    pub(crate) fn append(&mut self, piece: &Self) {
        self.positions.extend_from_slice(&piece.positions);
        self.normals.extend_from_slice(&piece.normals);
        self.colours.extend_from_slice(&piece.colours);
        self.uvs.extend_from_slice(&piece.uvs);
        self.lengths.extend_from_slice(&piece.lengths);
        self.corners.extend_from_slice(&piece.corners);
    }

    /// Hands everything over.
    pub(crate) fn write(&self, out: &mut Output<'_>, progress: &Progress<'_>) -> Result<()> {
        let count = self.positions.len();
        let columns: [(Column<'_>, bool); 4] = [
            (Column::POSITION_F64, true),
            (Column::NORMAL_F32, !self.normals.is_empty()),
            (RGB_F32, !self.colours.is_empty()),
            (UV, !self.uvs.is_empty()),
        ];
        let declared: Vec<Column<'_>> = columns
            .iter()
            .filter(|(_, is_there)| *is_there)
            .map(|(column, _)| *column)
            .collect();
        out.columns(&declared, count as u64)?;
        for start in (0..count).step_by(RUN) {
            progress.check()?;
            let range = start..count.min(start + RUN);
            let mut run: Vec<&[u8]> = vec![bytes_of(&self.positions[range.clone()])];
            if !self.normals.is_empty() {
                run.push(bytes_of(&self.normals[range.clone()]));
            }
            if !self.colours.is_empty() {
                run.push(bytes_of(&self.colours[range.clone()]));
            }
            if !self.uvs.is_empty() {
                run.push(bytes_of(&self.uvs[range.clone()]));
            }
            out.rows(range.len(), &run)?;
        }
        let (triangles, rest) = self.corners.as_chunks::<3>();
        if rest.is_empty() && self.lengths.iter().all(|length| *length == 3) {
            out.triangles(triangles)?;
            return self.textures.write(out);
        }
        let mut rest = self.corners.as_slice();
        for lengths in self.lengths.chunks(RUN) {
            let corner_count: usize = lengths.iter().map(|length| *length as usize).sum();
            let (corners, others) = rest.split_at(corner_count.min(rest.len()));
            rest = others;
            out.polygons(lengths, corners)?;
        }
        self.textures.write(out)
    }
}

impl FaceTextures {
    fn write(&self, out: &mut Output<'_>) -> Result<()> {
        let mut is_kept = !self.files.is_empty();
        for file in &self.files {
            is_kept &= out.texture(&file.name, &file.bytes)?.is_some();
        }
        if is_kept {
            out.polygon_textures(&self.faces, &self.uvs)?;
        }
        Ok(())
    }
}
