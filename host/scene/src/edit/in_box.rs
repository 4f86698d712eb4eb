//! Surfels in a box.

use crate::bounds::Bounds;
use crate::job::{Cancelled, Job};
use crate::marks::Marks;
use crate::scene::Object;

use super::on_screen::marks_where;

/// Surfels of an object whose centres lie in a box of the world, its faces included. None lies in an empty box.
///
/// # Errors
/// [`Cancelled`] if the job is.
pub fn marks_in_box(object: &Object, bounds_world: &Bounds, job: &Job) -> Result<Marks, Cancelled> {
    let world_from_local = object.world_from_local();
    marks_where(&object.geometry, job, |centre, _| {
        let at = world_from_local.transform_point3(centre);
        bounds_world.min.cmple(at).all() && at.cmple(bounds_world.max).all()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Block, Geometry, Origins};
    use glam::{DAffine3, DVec3};

    #[test]
    fn a_box_of_the_world_holds_centres_after_the_transform() {
        let centres = [0.0, 1.0, 2.0, 3.0].map(|x| [x, 0.0, 0.0, 9.0]);
        let block = Block {
            position_radius: centres.into_iter().collect(),
            ..Block::default()
        };
        let geometry = Geometry::new(vec![block], None, Origins::default());
        let mut object = Object::new("row", DVec3::new(1e6, 0.0, 0.0), geometry);
        object.world_from_object = DAffine3::from_scale(DVec3::splat(2.0));
        let bounds = |from: f64, to: f64| {
            Bounds::new(
                DVec3::new(2e6 + from, -1.0, -1.0),
                DVec3::new(2e6 + to, 1.0, 1.0),
            )
        };
        let found = |bounds: &Bounds| -> Vec<usize> {
            let marks = marks_in_box(&object, bounds, &Job::new());
            marks.expect("not cancelled").iter().collect()
        };
        assert_eq!(found(&bounds(2.0, 4.0)), [1, 2], "faces belong to the box");
        assert_eq!(found(&bounds(2.1, 3.9)), [0_usize; 0]);
        assert_eq!(found(&Bounds::EMPTY), [0_usize; 0]);
        let job = Job::new();
        job.cancel();
        assert_eq!(
            marks_in_box(&object, &bounds(0.0, 9.0), &job),
            Err(Cancelled)
        );
    }
}
