//! Surfels in a part of the screen.

use glam::{DMat4, DVec2, DVec3};
use pointstage_plugin_api::columns::MAX_BLOCK_SURFELS;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::geometry::Geometry;
use crate::job::{Cancelled, Job};
use crate::marks::Marks;
use crate::scene::Object;

use super::region::ScreenRegion;

/// Surfels that are looked at between two looks at the job; a multiple of a word's bits.
const CHUNK: usize = 1 << 16;

/// What the picture shows at its pixels, to tell what is hidden behind it.
pub trait Occluder: Sync {
    /// Distance of the surface at a pixel along the line of sight, scene units; infinite where nothing is drawn.
    ///
    /// * `pixel`: column and row from the upper left corner, within the picture.
    fn eye_distance(&self, pixel: [u32; 2]) -> f64;
}

/// How the scene is seen.
#[derive(Clone, Copy)]
pub struct ScreenView<'a> {
    /// The eye.
    pub camera: &'a Camera,
    /// Size of the picture, px.
    pub size_px: [u32; 2],
    /// Hides what lies behind it; everything is seen if there is none.
    pub occluder: Option<&'a dyn Occluder>,
}

/// Surfels of an object whose centres are seen in a region of the screen.
///
/// What is not between the near and the far plane is not seen. With an occluder, a surfel is seen if it lies in the picture and
/// no farther than two of its radii, and a 500th of the distance, behind what is drawn at its pixel: surfels of one surface
/// overlap, and the one drawn is not always the nearest.
///
/// # Errors
/// [`Cancelled`] if the job is.
pub fn marks_on_screen(
    object: &Object,
    view: ScreenView<'_>,
    region: &ScreenRegion,
    job: &Job,
) -> Result<Marks, Cancelled> {
    let projector = Projector::new(object, view);
    marks_where(&object.geometry, job, |centre, radius| {
        projector
            .project(centre)
            .is_some_and(|seen| region.contains(seen.at_px) && projector.is_visible(seen, radius))
    })
}

/// Surfels of which `is_marked` says yes, from centre and radius, object space; in parallel.
pub(super) fn marks_where(
    geometry: &Geometry,
    job: &Job,
    is_marked: impl Fn(DVec3, f64) -> bool + Sync,
) -> Result<Marks, Cancelled> {
    const { assert!(MAX_BLOCK_SURFELS.is_multiple_of(CHUNK)) };
    let mut words = Vec::with_capacity(geometry.surfel_count.div_ceil(u64::BITS as usize));
    let chunks = geometry
        .blocks
        .par_iter()
        .flat_map(|block| block.position_radius.par_chunks(CHUNK));
    let found: Result<Vec<Vec<u64>>, Cancelled> = chunks
        .map(|chunk| {
            job.check()?;
            let word = |surfels: &[[f32; 4]]| {
                let bits = surfels.iter().enumerate();
                bits.fold(0, |word, (bit, &[x, y, z, radius])| {
                    let centre = DVec3::new(x.into(), y.into(), z.into());
                    word | (u64::from(is_marked(centre, radius.into())) << bit)
                })
            };
            Ok(chunk.chunks(u64::BITS as usize).map(word).collect())
        })
        .collect();
    found?.into_iter().for_each(|part| words.extend(part));
    Ok(Marks::from_words(words, geometry.surfel_count))
}

/// Where a surfel is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen {
    at_px: DVec2,
    /// Along the line of sight, scene units.
    eye_distance: f64,
}

/// Projects centres of one object into the picture.
struct Projector<'a> {
    clip_from_local: DMat4,
    view_from_local: DMat4,
    /// How many times as large radii are in the world.
    radius_scale: f64,
    view: ScreenView<'a>,
}

impl<'a> Projector<'a> {
    fn new(object: &Object, view: ScreenView<'a>) -> Self {
        let [width, height] = view.size_px.map(|length| f64::from(length.max(1)));
        let world_from_local = object.world_from_local();
        let view_from_local = view.camera.view_from_world() * DMat4::from(world_from_local);
        let axes = [
            world_from_local.x_axis,
            world_from_local.y_axis,
            world_from_local.z_axis,
        ];
        Self {
            clip_from_local: view.camera.clip_from_view(width / height) * view_from_local,
            view_from_local,
            radius_scale: axes.map(DVec3::length).into_iter().fold(0.0, f64::max)
                * f64::from(object.radius_scale),
            view,
        }
    }

    /// Where a centre is seen; `None` if it lies before the near or behind the far plane, or is no place at all.
    fn project(&self, centre: DVec3) -> Option<Seen> {
        let clip = self.clip_from_local * centre.extend(1.0);
        // Written so that NaN fails.
        if !(clip.w > 0.0 && clip.z >= 0.0 && clip.z <= clip.w) {
            return None;
        }
        let [width, height] = self.view.size_px.map(f64::from);
        let ndc = DVec2::new(clip.x, clip.y) / clip.w;
        Some(Seen {
            at_px: DVec2::new((ndc.x + 1.0) * 0.5 * width, (1.0 - ndc.y) * 0.5 * height),
            eye_distance: -self.view_from_local.transform_point3(centre).z,
        })
    }

    fn is_visible(&self, seen: Seen, radius: f64) -> bool {
        let Some(occluder) = self.view.occluder else {
            return true;
        };
        let [width, height] = self.view.size_px.map(f64::from);
        let Seen {
            at_px: DVec2 { x, y },
            eye_distance,
        } = seen;
        if !(x >= 0.0 && y >= 0.0 && x < width && y < height) {
            return false;
        }
        let slack = (2.0 * radius.max(0.0) * self.radius_scale).max(eye_distance.abs() / 500.0);
        eye_distance <= occluder.eye_distance([x as u32, y as u32]) + slack
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Projection;
    use crate::geometry::{Block, Origins};
    use glam::DAffine3;
    use proptest::prelude::*;

    fn object(centres: &[[f32; 3]]) -> Object {
        let block = Block {
            position_radius: centres.iter().map(|&[x, y, z]| [x, y, z, 0.01]).collect(),
            ..Block::default()
        };
        let geometry = Geometry::new(vec![block], None, Origins::default());
        Object::new("points", DVec3::ZERO, geometry)
    }

    fn camera(projection: Projection) -> Camera {
        Camera {
            projection,
            near: 0.5,
            far: 8.0,
            ..Camera::default()
        }
    }

    const SIZE_PX: [u32; 2] = [400, 300];

    /// All of the picture and far beyond.
    fn everywhere() -> ScreenRegion {
        ScreenRegion::rectangle(DVec2::splat(-1e6), DVec2::splat(1e6))
    }

    fn found(object: &Object, camera: &Camera, region: &ScreenRegion) -> Vec<usize> {
        let view = ScreenView {
            camera,
            size_px: SIZE_PX,
            occluder: None,
        };
        let marks = marks_on_screen(object, view, region, &Job::new());
        marks.expect("not cancelled").iter().collect()
    }

    /// What the eye cannot see is not selected: behind it, before the near plane, behind the far plane, nowhere.
    #[test]
    fn only_what_is_between_the_planes_is_found() {
        let far = [0.0, 0.0, -20.0];
        let centres = [
            [0.0, 0.0, 0.0],
            [0.0, 0.0, 2.8],
            [0.0, 0.0, 4.0],
            [f32::NAN, 0.0, 0.0],
            far,
        ];
        let object = object(&centres);
        let perspective = camera(Projection::Perspective { fov_y_rad: 0.7 });
        assert_eq!(found(&object, &perspective, &everywhere()), [0, 4]);
        let orthographic = camera(Projection::Orthographic { height: 2.0 });
        assert_eq!(found(&object, &orthographic, &everywhere()), [0]);
    }

    #[test]
    fn hidden_surfels_are_left_out_where_the_picture_is_known() {
        struct Wall;
        impl Occluder for Wall {
            fn eye_distance(&self, [x, _]: [u32; 2]) -> f64 {
                if x < SIZE_PX[0] / 2 {
                    3.0
                } else {
                    f64::INFINITY
                }
            }
        }
        let (left, right) = (-0.1, 0.1);
        let object = object(&[
            [left, 0.0, 0.0],
            [left, 0.0, -0.015],
            [left, 0.0, -1.0],
            [right, 0.0, -1.0],
            [99.0, 0.0, 0.0],
        ]);
        let camera = camera(Projection::Orthographic { height: 2.0 });
        let view = ScreenView {
            camera: &camera,
            size_px: SIZE_PX,
            occluder: Some(&Wall),
        };
        let marks = marks_on_screen(&object, view, &everywhere(), &Job::new());
        let marks: Vec<usize> = marks.expect("not cancelled").iter().collect();
        assert_eq!(marks, [0, 1, 3], "on the wall, on it, and beside it");
    }

    proptest! {
        #[test]
        fn a_rectangle_finds_the_points_that_project_into_it(
            centres in prop::collection::vec([-2.0..2.0_f32, -2.0..2.0_f32, -2.0..2.0_f32], 1..300),
            corners in [0.0..400.0_f64, 0.0..300.0_f64, 0.0..400.0_f64, 0.0..300.0_f64],
            shift in -1.0..1.0_f64, turn in -3.0..3.0_f64,
        ) {
            let mut object = object(&centres);
            object.origin = DVec3::new(1e6, -1e6, 0.0);
            object.world_from_object = DAffine3::from_rotation_y(turn)
                * DAffine3::from_translation(DVec3::new(shift, 0.0, 0.0) - object.origin);
            let [x0, y0, x1, y1] = corners;
            let region = ScreenRegion::rectangle(DVec2::new(x0, y0), DVec2::new(x1, y1));
            let camera = camera(Projection::Perspective { fov_y_rad: 0.7 });
            let expected = centres.iter().enumerate().filter(|(_, centre)| {
                let local = DVec3::from(centre.map(f64::from));
                let world = object.world_from_object.transform_point3(object.origin + local);
                let view = camera.view_from_world().transform_point3(world);
                let height = -view.z * (0.35_f64).tan();
                let x = (view.x / height * 3.0 / 4.0 + 1.0) * 200.0;
                let y = (1.0 - view.y / height) * 150.0;
                -view.z >= 0.5 && x >= x0.min(x1) && x <= x0.max(x1) && y >= y0.min(y1) && y <= y0.max(y1)
            });
            let expected: Vec<usize> = expected.map(|(index, _)| index).collect();
            prop_assert_eq!(found(&object, &camera, &region), expected);
        }
    }
}
