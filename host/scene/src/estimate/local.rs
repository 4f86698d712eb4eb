//! What the nearest neighbours of one point tell: the plane through them, and the cell that the point has in it.

use glam::{DVec3, Vec3};

use super::cell::Cell;
use super::plane::plane_normal;
use super::tree::{Nearest, Tree, TreePoint};

/// Length of a disk or an ellipse over what the corners of its cell would need: neighbouring ones lie in different planes.
pub(super) const MARGIN: f64 = 1.1;

/// Most that a radius is of the distance of the 8th neighbour: 1.5 times the side of the square that a point has to
/// itself, 9 of them in a disk of that distance. At the border of a scan, where cells have no end, it is this.
const MOST_OF_DISTANCE: f64 = 0.886;

/// The neighbours of a point, nearest first, the point itself among them.
pub(super) struct Local<'t> {
    centre: DVec3,
    points: &'t [TreePoint],
    places: &'t [u32],
    /// Square of the distance that tells how dense the points are; 0 if all are at one place.
    squared: f32,
    /// How many points lie within that distance, the point itself included.
    within: usize,
}

impl<'t> Local<'t> {
    /// Of a point: the `neighbours` nearest ones of those found.
    pub(super) fn new<const N: usize>(
        tree: &'t Tree,
        point: &TreePoint,
        near: &'t Nearest<N>,
        neighbours: usize,
    ) -> Self {
        let count = near.count().min(neighbours + 1);
        let squared = &near.squared[..count];
        // Half of the neighbours: the distance of the farthest says less about the place itself.
        let middle = (neighbours / 2).max(1);
        let farthest = squared.last().copied().unwrap_or(0.0);
        let chosen = squared.get(middle).copied().unwrap_or(farthest);
        // Where many points coincide, the farthest found may still be apart.
        let squared = if chosen > 0.0 { chosen } else { farthest };
        Self {
            centre: Vec3::from(point.centre).as_dvec3(),
            points: tree.points(),
            places: &near.places[..count],
            squared,
            within: middle + 1,
        }
    }

    fn around(&self) -> impl Iterator<Item = DVec3> + Clone {
        let points = self
            .places
            .iter()
            .filter_map(|place| self.points.get(*place as usize));
        points.map(|near| Vec3::from(near.centre).as_dvec3())
    }

    /// Unit normal of the plane that fits best; on a side that is the same in all runs.
    pub(super) fn normal(&self) -> DVec3 {
        plane_normal(self.around())
    }

    /// Most that a radius may be, scene units; with another number of points within the distance, that square is as much
    /// larger or smaller.
    pub(super) fn greatest(&self) -> f64 {
        let sides = (9.0 / self.within as f64).sqrt();
        MOST_OF_DISTANCE * sides * f64::from(self.squared).sqrt()
    }

    /// The point's cell in the plane with this normal.
    pub(super) fn cell(&self, normal: DVec3) -> Cell {
        // The point itself, and others at the same place, are no neighbours.
        let offsets = self
            .around()
            .map(|near| near - self.centre)
            .filter(|offset| offset.length_squared() > 0.0);
        Cell::new(normal, offsets, self.greatest())
    }
}
