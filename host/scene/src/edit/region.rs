//! A part of the screen: the inside of a closed line, or what a brush went over.

use glam::DVec2;

/// A part of the screen, px from the picture's upper left corner.
///
/// Its lines are sorted into bands of one pixel's height, so that asking about a point looks at the lines of its band only: a
/// lasso of hundreds of corners is asked about millions of points.
#[derive(Clone, Debug)]
pub struct ScreenRegion {
    shape: Shape,
    lines: Vec<[DVec2; 2]>,
    /// Numbers of the lines that matter for points of a band.
    bands: Vec<Vec<u32>>,
    /// y where the first band begins.
    top: f64,
    /// Smallest box around the region.
    min: DVec2,
    max: DVec2,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    /// The line winds around a point.
    Inside,
    /// A point is no farther than this from a line, px.
    Near(f64),
}

/// Bands that a region may have: more than any screen has rows. What is taller gets higher bands.
const MOST_BANDS: f64 = 16_384.0;

impl ScreenRegion {
    /// The inside of a closed line through `corners`, the last one joined to the first. Where the line crosses itself,
    /// everything that it winds around is inside. Corners that are not finite are left out; of fewer than three there is no
    /// inside.
    pub fn polygon(corners: &[DVec2]) -> Self {
        let corners: Vec<DVec2> = finite(corners).collect();
        let next = corners.iter().cycle().skip(1);
        let lines = corners
            .iter()
            .zip(next)
            .map(|(from, to)| [*from, *to])
            .collect();
        Self::new(Shape::Inside, lines, 0.0)
    }

    /// The rectangle between two corners.
    pub fn rectangle(a: DVec2, b: DVec2) -> Self {
        let corners = [a, DVec2::new(b.x, a.y), b, DVec2::new(a.x, b.y)];
        Self::polygon(&corners)
    }

    /// What a round brush covers on its way through `path`; a single place is a disc.
    pub fn brush(path: &[DVec2], radius_px: f64) -> Self {
        let path: Vec<DVec2> = finite(path).collect();
        let lines = match path.as_slice() {
            [place] => vec![[*place; 2]],
            path => path.windows(2).map(|pair| [pair[0], pair[1]]).collect(),
        };
        let radius_px = if radius_px > 0.0 { radius_px } else { 0.0 };
        Self::new(Shape::Near(radius_px), lines, radius_px)
    }

    /// `reach`: how far beyond a line it matters, px.
    fn new(shape: Shape, lines: Vec<[DVec2; 2]>, reach: f64) -> Self {
        let ends = lines.iter().flatten();
        let (min, max) = ends.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(min, max), end| {
            (min.min(*end), max.max(*end))
        });
        let (min, max) = (min - reach, max + reach);
        let mut region = Self {
            shape,
            lines,
            bands: Vec::new(),
            top: min.y,
            min,
            max,
        };
        if region.lines.is_empty() {
            return region;
        }
        let last = region.band_of(max.y);
        region.bands = vec![Vec::new(); last + 1];
        for (number, [from, to]) in region.lines.iter().enumerate() {
            let first = region.band_of(from.y.min(to.y) - reach);
            let last = region.band_of(from.y.max(to.y) + reach);
            for band in &mut region.bands[first..=last] {
                band.push(number as u32);
            }
        }
        region
    }

    /// Number of the band in which points of this height lie; it grows with the height.
    fn band_of(&self, y: f64) -> usize {
        let height = (self.max.y - self.min.y).max(1.0);
        let bands_per_px = (MOST_BANDS / height).min(1.0);
        // Saturates: NaN and what is above the region are in the first band.
        ((y - self.top) * bands_per_px) as usize
    }

    /// Whether a point is in the region.
    pub fn contains(&self, point: DVec2) -> bool {
        if !(self.min.cmple(point).all() && point.cmple(self.max).all()) {
            return false;
        }
        let band = self.bands.get(self.band_of(point.y));
        let mut lines = band
            .into_iter()
            .flatten()
            .map(|&number| self.lines[number as usize]);
        match self.shape {
            Shape::Inside => lines.map(|line| crossing(line, point)).sum::<i32>() != 0,
            Shape::Near(radius) => {
                lines.any(|line| distance_squared(line, point) <= radius * radius)
            }
        }
    }
}

fn finite(points: &[DVec2]) -> impl Iterator<Item = DVec2> + '_ {
    points.iter().copied().filter(|point| point.is_finite())
}

/// How a line crosses the ray from `point` to the right: 1 downwards, −1 upwards, else 0. Each end belongs to the line that
/// leaves it downwards, so that a corner counts once.
fn crossing([from, to]: [DVec2; 2], point: DVec2) -> i32 {
    if (from.y <= point.y) == (to.y <= point.y) {
        return 0;
    }
    let direction = if from.y < to.y { 1 } else { -1 };
    let side = (to - from).perp_dot(point - from);
    // Downwards, what is to the left of the line on the screen has it to the right.
    i32::from(side * f64::from(direction) > 0.0) * direction
}

fn distance_squared([from, to]: [DVec2; 2], point: DVec2) -> f64 {
    let (way, arm) = (to - from, point - from);
    let length = way.length_squared();
    let part = if length > 0.0 {
        (arm.dot(way) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    arm.distance_squared(way * part)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points(count: impl Into<prop::collection::SizeRange>) -> impl Strategy<Value = Vec<DVec2>> {
        let point = (-20.0..120.0_f64, -20.0..120.0_f64).prop_map(|(x, y)| DVec2::new(x, y));
        prop::collection::vec(point, count)
    }

    /// How often the corners go around a point: the angles that the sides are seen under, summed.
    fn turns(corners: &[DVec2], point: DVec2) -> f64 {
        let next = corners.iter().cycle().skip(1);
        let angles = corners
            .iter()
            .zip(next)
            .map(|(from, to)| (*from - point).angle_to(*to - point));
        angles.sum::<f64>() / std::f64::consts::TAU
    }

    proptest! {
        #[test]
        fn a_polygon_holds_what_it_winds_around(corners in points(3..40), asked in points(40)) {
            let region = ScreenRegion::polygon(&corners);
            for point in asked {
                let is_inside = turns(&corners, point).round() != 0.0;
                prop_assert_eq!(region.contains(point), is_inside, "{}", point);
            }
        }

        #[test]
        fn a_brush_covers_discs_along_its_path(path in points(1..6), asked in points(20), radius in 0.1..30.0_f64) {
            let region = ScreenRegion::brush(&path, radius);
            for point in asked {
                // Discs a quarter of a pixel apart miss less than half of that of what is between them.
                let steps = path.windows(2).flat_map(|pair| {
                    let count = (pair[0].distance(pair[1]) * 4.0).ceil() as usize + 1;
                    (0..=count).map(move |step| pair[0].lerp(pair[1], step as f64 / count as f64))
                });
                let nearest = steps.chain([path[0]]).map(|place| place.distance(point)).fold(f64::INFINITY, f64::min);
                if (nearest - radius).abs() > 0.125 {
                    prop_assert_eq!(region.contains(point), nearest < radius, "{}", point);
                }
            }
        }
    }

    #[test]
    fn a_rectangle_is_the_same_from_every_corner() {
        let corners = [
            DVec2::new(10.0, 20.0),
            DVec2::new(30.0, 60.0),
            DVec2::new(10.0, 60.0),
            DVec2::new(30.0, 20.0),
        ];
        for pair in [[0, 1], [1, 0], [2, 3], [3, 2]] {
            let region = ScreenRegion::rectangle(corners[pair[0]], corners[pair[1]]);
            assert!(region.contains(DVec2::new(11.0, 59.0)), "{pair:?}");
            assert!(!region.contains(DVec2::new(31.0, 40.0)), "{pair:?}");
        }
    }

    #[test]
    fn what_is_no_region_holds_nothing() {
        let anywhere = DVec2::new(1.0, 1.0);
        for corners in [vec![], vec![anywhere], vec![DVec2::NAN; 5]] {
            assert!(!ScreenRegion::polygon(&corners).contains(anywhere));
        }
        assert!(!ScreenRegion::brush(&[], 5.0).contains(anywhere));
        let huge = [
            DVec2::splat(-1e300),
            DVec2::new(1e300, 0.0),
            DVec2::new(0.0, 1e300),
        ];
        assert!(!ScreenRegion::polygon(&huge).contains(DVec2::NAN));
        assert!(ScreenRegion::brush(&[anywhere], 5.0).contains(DVec2::new(4.0, 1.0)));
    }
}
