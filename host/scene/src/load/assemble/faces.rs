//! Corners as the file has them into triangles over the vertices that were kept.

use std::collections::HashSet;
use std::sync::Arc;

use glam::DVec3;
use pointstage_texels::polygon::{Cut, triangulate};

use super::corners::{CornerLists, Corners, FaceData, FaceKind, STRIP_END};
use crate::estimate::Polygons;
use crate::job::{Cancelled, Job};
use crate::textures::TriangleTextures;
use crate::warnings::{WarningKind, Warnings};

/// Rows treated between two looks at the cancel flag.
const ROWS_A_PIECE: usize = 1 << 14;

/// Triangles, and the polygons that they were cut from.
#[derive(Debug)]
pub(in crate::load) struct Faces {
    pub(in crate::load) triangles: Arc<[[u32; 3]]>,
    /// `None` when every face was a triangle.
    pub(in crate::load) polygons: Option<Polygons>,
    /// What triangles take from pictures, where faces say so.
    pub(in crate::load) textures: Option<TriangleTextures>,
}

/// The vertices as faces see them.
pub(in crate::load) struct Vertices<'a> {
    /// Rows of the vertex element.
    pub(in crate::load) row_count: usize,
    /// New index of each row, `u32::MAX` for dropped ones; `None` when all were kept.
    pub(in crate::load) new_index: Option<&'a [u32]>,
    /// Local centre of a vertex by its new index.
    pub(in crate::load) centre: &'a dyn Fn(u32) -> DVec3,
}

impl Vertices<'_> {
    fn resolve(&self, corner: u32) -> Option<u32> {
        match self.new_index {
            None => (corner as usize) < self.row_count,
            Some(new_index) => {
                return new_index
                    .get(corner as usize)
                    .copied()
                    .filter(|index| *index != u32::MAX);
            }
        }
        .then_some(corner)
    }
}

/// Joins the faces of all elements; what cannot be drawn is dropped and counted. `None` if the file has no faces at all.
pub(in crate::load) fn resolve(
    elements: Vec<Corners>,
    vertices: &Vertices<'_>,
    job: &Job,
    warnings: &mut Warnings,
) -> Result<Option<Faces>, Cancelled> {
    // The usual file: one element of triangles, nothing to drop, nothing to copy.
    if let [Corners::Triangles(only)] = elements.as_slice() {
        let in_range =
            vertices.new_index.is_none() && (only.max_corner as usize) < vertices.row_count;
        if in_range && only.degenerate_count == 0 && !only.corners.is_empty() {
            return Ok(Some(Faces {
                triangles: only.corners.clone(),
                polygons: None,
                textures: None,
            }));
        }
    }
    let mut builder = Builder {
        vertices,
        triangles: Vec::new(),
        polygons: None,
        textures: None,
        warnings,
    };
    for corners in elements {
        match corners {
            Corners::Triangles(triangles) => {
                for piece in triangles.corners.chunks(ROWS_A_PIECE) {
                    job.check()?;
                    for triangle in piece {
                        builder.add_triangle(*triangle, None);
                    }
                }
            }
            Corners::Lists(lists) => builder.add_lists(&lists, job)?,
        }
    }
    let Builder {
        triangles,
        polygons,
        mut textures,
        ..
    } = builder;
    if let Some(textures) = &mut textures {
        textures.fill(triangles.len());
    }
    let faces = Faces {
        triangles: triangles.into(),
        polygons,
        textures,
    };
    Ok((!faces.triangles.is_empty()).then_some(faces))
}

struct Builder<'a, 'v> {
    vertices: &'a Vertices<'v>,
    triangles: Vec<[u32; 3]>,
    /// Every face, triangles too, from the first one on that is no triangle.
    polygons: Option<Polygons>,
    /// From the first face on that has a picture; of no more triangles than there are.
    textures: Option<TriangleTextures>,
    warnings: &'a mut Warnings,
}

/// What a face takes from a picture.
#[derive(Clone, Copy)]
struct Look<'a> {
    picture: u32,
    /// Of its corners.
    uvs: &'a [[f32; 2]],
}

impl<'a> Look<'a> {
    /// Of face `face`, whose corners begin with `first` of all; `None` without a picture.
    fn of(data: &'a FaceData, face: usize, first: usize) -> Option<Self> {
        Some(Self {
            picture: *data.pictures.get(face)?,
            uvs: data.uvs.get(first..)?,
        })
    }

    fn of_corners(self, corners: [usize; 3]) -> [[f32; 2]; 3] {
        corners.map(|corner| self.uvs.get(corner).copied().unwrap_or([f32::NAN; 2]))
    }
}

impl Builder<'_, '_> {
    /// A triangle as the file has it.
    fn add_triangle(&mut self, corners: [u32; 3], look: Option<Look<'_>>) {
        let resolved = corners.map(|corner| self.vertices.resolve(corner));
        let [Some(a), Some(b), Some(c)] = resolved else {
            self.warnings.add(WarningKind::FacesOutOfRangeDropped, 1);
            return;
        };
        if a == b || b == c || a == c {
            self.warnings.add(WarningKind::DegenerateFacesDropped, 1);
            return;
        }
        self.triangles.push([a, b, c]);
        self.add_look(look, [0, 1, 2]);
        if let Some(polygons) = &mut self.polygons {
            polygons.push(&[a, b, c]);
        }
    }

    /// What the last triangle takes, whose corners are these of its face.
    fn add_look(&mut self, look: Option<Look<'_>>, corners: [usize; 3]) {
        if let Some(look) = look {
            let textures = self.textures.get_or_insert_default();
            textures.fill(self.triangles.len() - 1);
            textures.push(look.picture, look.of_corners(corners));
        }
    }

    fn add_lists(&mut self, lists: &CornerLists, job: &Job) -> Result<(), Cancelled> {
        self.warnings
            .add(WarningKind::PolygonHolesFilled, lists.with_holes);
        let mut scratch = Scratch::default();
        let mut rest = lists.corners.as_slice();
        for (row, length) in lists.lengths.iter().enumerate() {
            if row % ROWS_A_PIECE == 0 {
                job.check()?;
            }
            let first = lists.corners.len() - rest.len();
            let (corners, others) = rest.split_at((*length as usize).min(rest.len()));
            rest = others;
            match lists.kind {
                FaceKind::Polygons => {
                    let look = Look::of(&lists.data, row, first);
                    self.add_polygon(corners, look, &mut scratch);
                }
                FaceKind::Strips => {
                    for strip in corners.split(|corner| *corner == STRIP_END) {
                        self.add_strip(strip);
                    }
                }
            }
        }
        Ok(())
    }

    /// A strip: each corner makes a triangle with the two before it, every second one turned over.
    fn add_strip(&mut self, strip: &[u32]) {
        for (index, window) in strip.windows(3).enumerate() {
            let [a, b, c] = [window[0], window[1], window[2]];
            // Strips repeat corners to turn; such triangles are no faces.
            if a != b && b != c && a != c {
                let turned = if index % 2 == 0 { [a, b, c] } else { [b, a, c] };
                self.add_triangle(turned, None);
            }
        }
    }

    fn add_polygon(&mut self, corners: &[u32], look: Option<Look<'_>>, scratch: &mut Scratch) {
        if let [a, b, c] = *corners {
            self.add_triangle([a, b, c], look);
            return;
        }
        let Scratch {
            indices,
            places,
            centres,
            seen,
            triangles,
        } = scratch;
        indices.clear();
        places.clear();
        for (place, corner) in corners.iter().enumerate() {
            let Some(index) = self.vertices.resolve(*corner) else {
                self.warnings.add(WarningKind::FacesOutOfRangeDropped, 1);
                return;
            };
            if indices.last() != Some(&index) {
                indices.push(index);
                places.push(place);
            }
        }
        // Some files repeat the first corner at the end.
        while indices.len() > 1 && indices.first() == indices.last() {
            indices.pop();
        }
        seen.clear();
        seen.extend(indices.iter().copied());
        if seen.len() < 3 {
            self.warnings.add(WarningKind::DegenerateFacesDropped, 1);
            return;
        }
        centres.clear();
        centres.extend(indices.iter().map(|index| (self.vertices.centre)(*index)));
        triangles.clear();
        if triangulate(centres, triangles) == Cut::Ears {
            self.warnings.add(WarningKind::NonConvexPolygonsCut, 1);
        }
        self.polygons
            .get_or_insert_with(|| Polygons::from_triangles(&self.triangles))
            .push(indices);
        for triangle in &*triangles {
            let [a, b, c] = triangle.map(|corner| indices[corner]);
            if a != b && b != c && a != c {
                self.triangles.push([a, b, c]);
                self.add_look(look, triangle.map(|corner| places[corner]));
            }
        }
    }
}

/// Memory that polygons share.
#[derive(Default)]
struct Scratch {
    indices: Vec<u32>,
    /// Which of the face's corners they are.
    places: Vec<usize>,
    centres: Vec<DVec3>,
    seen: HashSet<u32>,
    triangles: Vec<[usize; 3]>,
}

#[cfg(test)]
mod tests {
    use super::super::corners::FaceData;
    use super::*;

    fn resolve_lists(kind: FaceKind, rows: &[&[u32]]) -> (Option<Faces>, Warnings) {
        let lists = CornerLists {
            kind,
            lengths: rows.iter().map(|row| row.len() as u32).collect(),
            corners: rows.concat(),
            with_holes: 0,
            data: FaceData::default(),
        };
        let centre = |index: u32| DVec3::new(f64::from(index % 2), f64::from(index / 2), 0.0);
        let vertices = Vertices {
            row_count: 6,
            new_index: None,
            centre: &centre,
        };
        let mut warnings = Warnings::new();
        let faces = resolve(
            vec![Corners::Lists(lists)],
            &vertices,
            &Job::new(),
            &mut warnings,
        )
        .unwrap();
        (faces, warnings)
    }

    #[test]
    fn strips_turn_every_second_triangle_and_end_at_minus_one() {
        let (faces, warnings) = resolve_lists(
            FaceKind::Strips,
            &[&[0, 1, 2, 3, STRIP_END, 2, 3, 4, STRIP_END]],
        );
        assert_eq!(*faces.unwrap().triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
        assert!(warnings.is_empty());
    }

    #[test]
    fn bad_faces_are_dropped_and_counted() {
        let rows: [&[u32]; 5] = [
            &[0, 1, 3, 2],
            &[0, 1, 6],
            &[0, 1, 3, STRIP_END],
            &[0, 0, 1, 1],
            &[2, 3],
        ];
        let (faces, warnings) = resolve_lists(FaceKind::Polygons, &rows);
        let faces = faces.unwrap();
        assert_eq!(*faces.triangles, [[0, 1, 3], [0, 3, 2]]);
        assert_eq!(faces.polygons.map(|polygons| polygons.len()), Some(1));
        assert_eq!(warnings.count(&WarningKind::FacesOutOfRangeDropped), 2);
        assert_eq!(warnings.count(&WarningKind::DegenerateFacesDropped), 2);
    }

    #[test]
    fn a_repeated_first_corner_closes_the_polygon() {
        let (faces, _) = resolve_lists(FaceKind::Polygons, &[&[0, 1, 3, 2, 0]]);
        assert_eq!(faces.unwrap().triangles.len(), 2);
    }
}
