//! The mean of the texels that a small convex part of the texture plane covers.
//!
//! Texels are boxes, each weighted by how much of it lies inside. A part that is wider than [`MOST_ACROSS`] texels is measured on
//! the first smaller version of the picture where it is not.

use glam::DVec2;

use crate::picture::{Level, Picture};

/// Texels across the widest part that is measured on one level; what its rim gets wrong is then below a tenth of it.
const MOST_ACROSS: f64 = 16.0;

/// Texture coordinates beyond this are no coordinates: f32 has no part of a texel left there.
const LARGEST: f64 = 1e6;

/// Points along each side of the grid that stands for a part without area.
const POINTS: usize = 4;

/// What lies outside the picture, in one direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// The picture again, every other one mirrored.
    Mirror,
    /// Its outermost texels.
    Clamp,
}

impl Wrap {
    /// The texel of `count` at a place that may be outside.
    fn texel(self, place: i64, count: usize) -> usize {
        let count = count as i64;
        let inside = match self {
            Self::Repeat => place.rem_euclid(count),
            Self::Clamp => place.clamp(0, count - 1),
            Self::Mirror => {
                let place = place.rem_euclid(2 * count);
                place.min(2 * count - 1 - place)
            }
        };
        inside as usize
    }
}

impl Picture {
    /// Mean of what a convex quadrangle covers: linear light times alpha, and alpha. Texture coordinates are 0 to 1 over the
    /// picture, v from its top. `None` where they are not finite or beyond all measure.
    pub fn mean(&self, corners: [DVec2; 4], wrap: [Wrap; 2]) -> Option<[f32; 4]> {
        // Written so that NaN is refused.
        let is_usable = |uv: &DVec2| uv.x.abs() <= LARGEST && uv.y.abs() <= LARGEST;
        if !corners.iter().all(is_usable) {
            return None;
        }
        let low = corners.iter().fold(corners[0], |low, uv| low.min(*uv));
        let high = corners.iter().fold(corners[0], |high, uv| high.max(*uv));
        let across = |level: &Level| {
            let size = DVec2::new(level.width as f64, level.height as f64);
            ((high - low) * size).max_element()
        };
        let levels = self.levels();
        let fits = levels.iter().find(|level| across(level) <= MOST_ACROSS);
        let Some(level) = fits else {
            // As many pictures side by side as the last level has texels across: all of it.
            return levels.last().map(|level| level.texel(0, 0));
        };
        let size = DVec2::new(level.width as f64, level.height as f64);
        let part = Part {
            level,
            wrap,
            corners: corners.map(|uv| uv * size),
        };
        Some(part.mean(low * size, high * size))
    }
}

/// A quadrangle on one level, in texels.
struct Part<'p> {
    level: &'p Level,
    wrap: [Wrap; 2],
    corners: [DVec2; 4],
}

impl Part<'_> {
    fn texel(&self, x: i64, y: i64) -> [f32; 4] {
        let Level { width, height, .. } = *self.level;
        let [wrap_x, wrap_y] = self.wrap;
        self.level
            .texel(wrap_x.texel(x, width), wrap_y.texel(y, height))
    }

    fn mean(&self, low: DVec2, high: DVec2) -> [f32; 4] {
        let (first, last) = (low.floor().as_i64vec2(), high.floor().as_i64vec2());
        if first == last {
            return self.texel(first.x, first.y);
        }
        let whole = Clipped::of(self.corners);
        let extent = high - low;
        // Thinner than a thousandth of a texel for its length: rounding, no area.
        if whole.area() <= 1e-3 * extent.max_element().min(1.0) * 1e-3 {
            return self.mean_of_points();
        }
        let mut sum = [0.0_f64; 4];
        let mut weight = 0.0;
        for y in first.y..=last.y {
            let row = whole.between(1, y as f64, (y + 1) as f64);
            let Some([left, right]) = row.range(0) else {
                continue;
            };
            for x in left.floor() as i64..=right.floor() as i64 {
                let area = row.between(0, x as f64, (x + 1) as f64).area();
                if area > 0.0 {
                    weight += area;
                    for (sum, value) in sum.iter_mut().zip(self.texel(x, y)) {
                        *sum += f64::from(value) * area;
                    }
                }
            }
        }
        if weight > 0.0 {
            sum.map(|sum| (sum / weight) as f32)
        } else {
            self.mean_of_points()
        }
    }

    /// For parts that are lines: the mean at points of a grid over the quadrangle.
    fn mean_of_points(&self) -> [f32; 4] {
        let [a, b, c, d] = self.corners;
        let mut sum = [0.0; 4];
        let at = |index: usize| (index as f64 + 0.5) / POINTS as f64;
        for (s, t) in (0..POINTS * POINTS).map(|index| (at(index % POINTS), at(index / POINTS))) {
            let point = a.lerp(b, s).lerp(d.lerp(c, s), t).floor().as_i64vec2();
            for (sum, value) in sum.iter_mut().zip(self.texel(point.x, point.y)) {
                *sum += value / (POINTS * POINTS) as f32;
            }
        }
        sum
    }
}

/// A convex polygon: four corners, and one more for each of four cuts.
#[derive(Clone, Copy, Debug)]
struct Clipped {
    corners: [DVec2; 8],
    count: usize,
}

impl Clipped {
    fn of(corners: [DVec2; 4]) -> Self {
        let mut all = [DVec2::ZERO; 8];
        all[..4].copy_from_slice(&corners);
        Self {
            corners: all,
            count: 4,
        }
    }

    fn push(&mut self, corner: DVec2) {
        // A cut adds one corner to a convex polygon; rounding may see a corner twice, which has no area.
        if let Some(slot) = self.corners.get_mut(self.count) {
            *slot = corner;
            self.count += 1;
        }
    }

    /// The part of it with `low ≤ axis ≤ high`.
    fn between(&self, axis: usize, low: f64, high: f64) -> Self {
        self.cut(|point| point[axis] - low)
            .cut(|point| high - point[axis])
    }

    /// The part of it where `inside` is not negative; that is linear.
    fn cut(&self, inside: impl Fn(DVec2) -> f64) -> Self {
        let mut out = Self {
            corners: [DVec2::ZERO; 8],
            count: 0,
        };
        for index in 0..self.count {
            let (from, to) = (self.corners[index], self.corners[(index + 1) % self.count]);
            let (in_from, in_to) = (inside(from), inside(to));
            if in_from >= 0.0 {
                out.push(from);
            }
            if (in_from >= 0.0) != (in_to >= 0.0) {
                out.push(from.lerp(to, in_from / (in_from - in_to)));
            }
        }
        out
    }

    fn area(&self) -> f64 {
        let corners = &self.corners[..self.count];
        let Some((first, rest)) = corners.split_first() else {
            return 0.0;
        };
        let twice: f64 = rest
            .windows(2)
            .map(|pair| (pair[0] - *first).perp_dot(pair[1] - *first))
            .sum();
        0.5 * twice.abs()
    }

    /// Least and greatest coordinate; `None` if nothing is left.
    fn range(&self, axis: usize) -> Option<[f64; 2]> {
        let mut values = self.corners[..self.count].iter().map(|point| point[axis]);
        let first = values.next()?;
        Some(values.fold([first; 2], |[low, high], value| {
            [low.min(value), high.max(value)]
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Alpha;
    use proptest::prelude::*;

    fn picture(width: usize, height: usize, seed: u32) -> Picture {
        let mut state = seed | 1;
        let bytes = (0..width * height * 4).map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        });
        Picture::from_rgba(width, height, bytes.collect(), Alpha::Respected)
    }

    /// The mean at very many points of the quadrangle, each of which takes the texel that it lies in.
    fn brute_force(picture: &Picture, corners: [DVec2; 4], wrap: [Wrap; 2]) -> [f32; 4] {
        const SIDE: usize = 400;
        let [width, height] = picture.size();
        let [a, b, c, d] = corners;
        let (mut sum, mut weight) = ([0.0_f64; 4], 0.0);
        for index in 0..SIDE * SIDE {
            let at = |index: usize| (index as f64 + 0.5) / SIDE as f64;
            let (s, t) = (at(index % SIDE), at(index / SIDE));
            let point = a.lerp(b, s).lerp(d.lerp(c, s), t);
            // Area that a step of s and t covers there.
            let along_s = (b - a).lerp(c - d, t);
            let along_t = (d - a).lerp(c - b, s);
            let area = along_s.perp_dot(along_t).abs();
            let place = |value: f64, count: usize, wrap: Wrap| {
                wrap.texel((value * count as f64).floor() as i64, count)
            };
            let texel = picture.levels()[0].texel(
                place(point.x, width, wrap[0]),
                place(point.y, height, wrap[1]),
            );
            weight += area;
            for (sum, value) in sum.iter_mut().zip(texel) {
                *sum += f64::from(value) * area;
            }
        }
        sum.map(|sum| (sum / weight) as f32)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn means_are_those_of_brute_force(
            seed in any::<u32>(),
            centre in prop::array::uniform2(-2.0_f64..3.0),
            sides in prop::array::uniform4(-0.4_f64..0.4),
            wraps in prop::array::uniform2(0_usize..3),
        ) {
            let picture = picture(23, 11, seed);
            let wrap = wraps.map(|index| [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp][index]);
            let (centre, u) = (DVec2::from(centre), DVec2::new(sides[0], sides[1]));
            let v = DVec2::new(sides[2], sides[3]);
            // A part of a triangle, as the mean is asked of.
            let corners = [centre, centre + 0.5 * u, centre + (u + v) / 3.0, centre + 0.5 * v];
            prop_assume!(u.perp_dot(v).abs() > 1e-3);
            let found = picture.mean(corners, wrap).unwrap();
            for (found, expected) in found.iter().zip(brute_force(&picture, corners, wrap)) {
                // 400 points a side find the rim of a texel to a part in 400 of the quadrangle, on each of few rims.
                prop_assert!((found - expected).abs() < 0.01, "{found} {expected}");
            }
        }
    }

    #[test]
    fn wide_parts_are_near_the_true_mean() {
        let picture = picture(301, 200, 5);
        let corners = [(0.1, 0.1), (0.9, 0.2), (0.8, 0.7), (0.2, 0.9)].map(DVec2::from);
        let found = picture.mean(corners, [Wrap::Repeat; 2]).unwrap();
        let expected = brute_force(&picture, corners, [Wrap::Repeat; 2]);
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 0.01, "{found} {expected}");
        }
    }

    #[test]
    fn parts_over_many_pictures_take_their_mean() {
        let picture = picture(16, 16, 9);
        let corners = [(0.0, 0.0), (40.0, 0.0), (40.0, 40.0), (0.0, 40.0)].map(DVec2::from);
        let all = picture.levels().last().unwrap().texel(0, 0);
        assert_eq!(picture.mean(corners, [Wrap::Repeat; 2]), Some(all));
    }

    #[test]
    fn points_and_lines_have_a_colour_too() {
        let mut bytes = vec![255; 4 * 4];
        bytes[..4].copy_from_slice(&[0, 0, 0, 255]);
        let picture = Picture::from_rgba(4, 1, bytes, Alpha::Respected);
        let point = [DVec2::new(0.1, 0.5); 4];
        assert_eq!(
            picture.mean(point, [Wrap::Clamp; 2]),
            Some([0.0, 0.0, 0.0, 1.0])
        );
        let line = [0.0, 0.25, 0.5, 0.25].map(|u| DVec2::new(u, 0.5));
        let [red, ..] = picture.mean(line, [Wrap::Clamp; 2]).unwrap();
        assert!((red - 0.5).abs() < 0.13, "half of it is black, got {red}");
        for bad in [f64::NAN, f64::INFINITY, 1e30] {
            let corners = [DVec2::ZERO, DVec2::X, DVec2::new(bad, 1.0), DVec2::Y];
            assert_eq!(picture.mean(corners, [Wrap::Repeat; 2]), None, "{bad}");
        }
    }
}
