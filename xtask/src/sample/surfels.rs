//! Cuts the skin into elliptical surfels that cover it.

use std::f64::consts::TAU;

use super::knot::Knot;
use super::skin;
use super::vector::Vector;

/// An elliptical surfel.
#[derive(Clone, Debug)]
pub(super) struct Surfel {
    pub(super) centre: Vector,
    /// Unit, outward.
    pub(super) normal: Vector,
    /// Tangent half-axes; u × v points along the normal.
    pub(super) u: Vector,
    pub(super) v: Vector,
    /// sRGB.
    pub(super) colour: [u8; 3],
}

/// How much longer a cell is along the snake than around it: the relief changes faster around.
const ASPECT: f64 = 1.5;

/// Growth of a cell's inscribed ellipse. In staggered rows of unit squares the farthest point lies 0.625 from a
/// centre, 1.25 times the inscribed circle's radius; the rest allows for the skin's curvature.
const OVERLAP: f64 = 1.35;

/// Mean circumference of the body, scene units.
const CIRCUMFERENCE: f64 = 0.66 * TAU;

/// About `count` surfels, ring by ring.
pub(super) fn cut(count: usize) -> Vec<Surfel> {
    let knot = Knot::new();
    let cell_area = knot.length() * CIRCUMFERENCE / count as f64;
    let rings = ((knot.length() / (cell_area * ASPECT).sqrt()) / 2.0)
        .round()
        .max(2.0) as usize
        * 2;
    let ring_size = (count / rings).max(3);
    let steps = (1.0 / rings as f64, 1.0 / ring_size as f64);
    let mut surfels = Vec::with_capacity(rings * ring_size);
    for ring in 0..rings {
        let shift = if ring % 2 == 0 { 0.0 } else { 0.5 };
        for place in 0..ring_size {
            surfels.push(surfel(
                &knot,
                ring as f64 * steps.0,
                (place as f64 + shift) * steps.1,
                steps,
            ));
        }
    }
    surfels
}

/// The surfel of the cell of `steps` (in turns, along and around) around one place.
fn surfel(knot: &Knot, along: f64, around: f64, steps: (f64, f64)) -> Surfel {
    // Differences over half a cell: relief finer than the surfels must not tilt them.
    let (da, db) = (steps.0 * 0.25, steps.1 * 0.25);
    let half_along = (point(knot, along + da, around) - point(knot, along - da, around)) * OVERLAP;
    let half_around = (point(knot, along, around + db) - point(knot, along, around - db)) * OVERLAP;
    let (u, v) = half_axes(half_along, half_around);
    let normal = u.cross(v).normalized();
    let frame = knot.frame(along);
    let centre = point(knot, along, around);
    let outward = normal.dot(centre - frame.centre) >= 0.0;
    let (normal, v) = if outward { (normal, v) } else { (-normal, -v) };
    Surfel {
        centre,
        normal,
        u,
        v,
        colour: skin::colour(along, around),
    }
}

fn point(knot: &Knot, along: f64, around: f64) -> Vector {
    let frame = knot.frame(along);
    let (sin, cos) = (around * TAU).sin_cos();
    frame.centre + (frame.side * cos + frame.up * sin) * skin::radius(along.rem_euclid(1.0), around)
}

/// Half-axes of the ellipse { a·cos t + b·sin t }: the turn 2t₀ = atan2(2 a·b, a² − b²) makes them orthogonal.
fn half_axes(a: Vector, b: Vector) -> (Vector, Vector) {
    let turn = 0.5 * (2.0 * a.dot(b)).atan2(a.dot(a) - b.dot(b));
    let (sin, cos) = turn.sin_cos();
    (a * cos + b * sin, b * cos - a * sin)
}
