//! First look at a mesh: whether it can be built over, and its bounds.

use crate::build::BuildError;
use crate::crew::{Crew, Hand};
use crate::mesh::Mesh;
use pointstage_plugin_api::glam::Vec3;

/// Triangles that a task measures.
const STRETCH: usize = 1 << 14;

/// Units of work that a triangle is; see [`Crew::new`].
pub(crate) const MEASURE_UNITS: u64 = 11;

/// Coordinates of greater size leave no room for radii and extents in a float.
const FARTHEST: f32 = 1e37;

/// Least and greatest corner.
type Bounds = (Vec3, Vec3);

const NOTHING: Bounds = (Vec3::INFINITY, Vec3::NEG_INFINITY);

/// The bounds of all triangles; all zero if there are none.
pub(crate) fn bounds(mesh: &Mesh<'_>, crew: &mut Crew<'_>) -> Result<Bounds, BuildError> {
    let stretches = mesh.triangles.chunks(STRETCH);
    let mut parts = vec![Ok(NOTHING); stretches.len()];
    let tasks = parts.iter_mut().zip(stretches).enumerate().collect();
    crew.run(
        "measuring",
        mesh.triangles.len(),
        tasks,
        |(number, (part, stretch)), hand: &Hand<'_, _>| {
            *part = bounds_of(mesh, number * STRETCH, stretch);
            hand.advance(MEASURE_UNITS * stretch.len() as u64);
        },
    )?;
    let mut all = NOTHING;
    for part in parts {
        let (least, greatest) = part?;
        all = (all.0.min(least), all.1.max(greatest));
    }
    Ok(if mesh.triangles.is_empty() {
        (Vec3::ZERO, Vec3::ZERO)
    } else {
        all
    })
}

fn bounds_of(mesh: &Mesh<'_>, first: usize, stretch: &[[u32; 3]]) -> Result<Bounds, BuildError> {
    let (mut least, mut greatest) = NOTHING;
    for (place, corners) in stretch.iter().enumerate() {
        for &vertex in corners {
            let Some(position) = mesh.position(vertex) else {
                let vertex_count = mesh.vertex_count();
                return Err(BuildError::VertexOutOfRange {
                    triangle: first + place,
                    vertex,
                    vertex_count,
                });
            };
            if !(position.abs().max_element() <= FARTHEST && position.is_finite()) {
                let [x, y, z] = position.to_array();
                return Err(BuildError::VertexNotFinite {
                    triangle: first + place,
                    vertex,
                    position: [x, y, z],
                });
            }
            least = least.min(position);
            greatest = greatest.max(position);
        }
    }
    Ok((least, greatest))
}
