//! Least balls: around a triangle and around up to four balls.
//!
//! A least ball touches a few of the things in it, its support, and its centre follows from those. So each possible support
//! gives a candidate for the centre, and the candidate that has to reach least far is taken. Reach is always measured
//! afresh, hence the ball holds everything whatever became of a degenerate candidate.
//!
//! source  Fischer, Gärtner, The Smallest Enclosing Ball of Balls, SoCG 2003, section 2 (what a support is)

use pointstage_plugin_api::glam::DVec3;

/// Rounding that a candidate's reach may show beyond the radius that its support gives.
const ROUNDING: f64 = 1e-12;

/// A ball.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Ball {
    /// Its centre.
    pub(crate) centre: DVec3,
    /// Its radius; not negative.
    pub(crate) radius: f64,
}

impl Ball {
    /// Radius of the least ball round `centre` that holds all balls.
    pub(crate) fn reach(centre: DVec3, balls: &[Ball]) -> f64 {
        balls.iter().fold(0.0, |reach: f64, ball| {
            reach.max(centre.distance(ball.centre) + ball.radius)
        })
    }
}

/// Centre of the least ball around a triangle.
///
/// If all angles are less than 90 degrees it is the circumcentre, otherwise the middle of the longest side.
pub(crate) fn centre_of_triangle(corners: [DVec3; 3]) -> DVec3 {
    let [a, b, c] = corners;
    let [ab, bc, ca] = [b - a, c - b, a - c];
    let [ab2, bc2, ca2] = [ab, bc, ca].map(DVec3::length_squared);
    // The corner opposite to the longest side comes first, so that its angle is the widest.
    let (from, u, v, longest) = if bc2 >= ab2 && bc2 >= ca2 {
        (a, ab, -ca, (b, c))
    } else if ca2 >= ab2 {
        (b, bc, -ab, (c, a))
    } else {
        (c, ca, -bc, (a, b))
    };
    let middle = (longest.0 + longest.1) * 0.5;
    if u.dot(v) <= 0.0 {
        return middle;
    }
    let normal = u.cross(v);
    let circumcentre = from
        + (v.cross(normal) * u.length_squared() + normal.cross(u) * v.length_squared())
            / (2.0 * normal.length_squared());
    // Three corners in a row leave nothing to divide by.
    if circumcentre.is_finite() {
        circumcentre
    } else {
        middle
    }
}

/// The least ball around up to four balls.
pub(crate) fn around_balls(balls: &[Ball]) -> Ball {
    let Some(pair) = widest_pair(balls) else {
        return balls.first().copied().unwrap_or_default();
    };
    let mut best = Ball {
        centre: pair.centre,
        radius: Ball::reach(pair.centre, balls),
    };
    // No ball is less than the least one around two of those in it.
    if best.radius <= pair.radius * (1.0 + ROUNDING) {
        return best;
    }
    let mut consider = |centre: DVec3| {
        let radius = Ball::reach(centre, balls);
        // A support that has no such ball gives no numbers, which nothing would seem to be far from.
        if centre.is_finite() && radius < best.radius {
            best = Ball { centre, radius };
        }
    };
    match *balls {
        [a, b, c] => tangent_to_three([a, b, c]).into_iter().for_each(consider),
        [a, b, c, d] => {
            for three in [[a, b, c], [a, b, d], [a, c, d], [b, c, d]] {
                tangent_to_three(three).into_iter().for_each(&mut consider);
            }
            tangent_to_four([a, b, c, d]).into_iter().for_each(consider);
        }
        _ => {}
    }
    best
}

/// The greatest of the least balls around two of the balls; none for fewer than two.
fn widest_pair(balls: &[Ball]) -> Option<Ball> {
    let mut widest: Option<Ball> = None;
    for (place, first) in balls.iter().enumerate() {
        for second in &balls[place + 1..] {
            let pair = around_two(first, second);
            if widest.is_none_or(|widest| pair.radius > widest.radius) {
                widest = Some(pair);
            }
        }
    }
    widest
}

/// The least ball around two.
fn around_two(first: &Ball, second: &Ball) -> Ball {
    let (large, small) = if first.radius >= second.radius {
        (first, second)
    } else {
        (second, first)
    };
    let apart = large.centre.distance(small.centre);
    if large.radius >= apart + small.radius {
        return *large;
    }
    let radius = (apart + large.radius + small.radius) * 0.5;
    let centre = large.centre + (small.centre - large.centre) * ((radius - large.radius) / apart);
    Ball { centre, radius }
}

/// Centres, in the plane of three balls' centres, of the balls that these touch from within.
fn tangent_to_three(balls: [Ball; 3]) -> [DVec3; 2] {
    let [base, others @ ..] = balls;
    let [d1, d2] = others.map(|ball| ball.centre - base.centre);
    let normal = d1.cross(d2);
    let scale = normal.length_squared().recip();
    tangent(
        base,
        others,
        [d2.cross(normal) * scale, normal.cross(d1) * scale],
    )
}

/// Centres of the balls that four balls touch from within.
fn tangent_to_four(balls: [Ball; 4]) -> [DVec3; 2] {
    let [base, others @ ..] = balls;
    let [d1, d2, d3] = others.map(|ball| ball.centre - base.centre);
    let scale = d1.dot(d2.cross(d3)).recip();
    tangent(
        base,
        others,
        [
            d2.cross(d3) * scale,
            d3.cross(d1) * scale,
            d1.cross(d2) * scale,
        ],
    )
}

/// Centres of the balls that the base and the others touch from within; not finite where there is none.
///
/// With x the centre and s = R − r₀ its distance from the base's centre, and dᵢ the others' centres, from there as well:
///
/// ```text
/// |x − dᵢ| = R − rᵢ   ⇒   x·dᵢ = ½ (dᵢ² − (rᵢ − r₀)²) + s (rᵢ − r₀)   ⇒   x = p + s q
/// |x| = s             ⇒   (q² − 1) s² + 2 (p·q) s + p² = 0
/// ```
///
/// `dual`: the vectors with dualᵢ·dⱼ = 1 if i = j, else 0.
fn tangent<const N: usize>(base: Ball, others: [Ball; N], dual: [DVec3; N]) -> [DVec3; 2] {
    let (mut p, mut q) = (DVec3::ZERO, DVec3::ZERO);
    for (other, dual) in others.iter().zip(dual) {
        let wider = other.radius - base.radius;
        p += dual * (0.5 * (other.centre.distance_squared(base.centre) - wider * wider));
        q += dual * wider;
    }
    let square = q.length_squared() - 1.0;
    let half = p.dot(q);
    let root = (half * half - square * p.length_squared()).max(0.0).sqrt();
    // Of the two forms of each root, those in which nothing cancels.
    let sum = -(half + root.copysign(half));
    [sum / square, p.length_squared() / sum].map(|s| base.centre + p + q * s)
}

#[cfg(test)]
mod tests {
    use super::{Ball, DVec3, around_balls, centre_of_triangle};
    use proptest::prelude::*;

    fn vector() -> impl Strategy<Value = DVec3> {
        // Few values, so that balls often coincide, touch or lie in a row or a plane.
        let coordinate = || prop_oneof![(-3_i32..=3).prop_map(f64::from), -3.0..3.0];
        [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from_array)
    }

    fn ball() -> impl Strategy<Value = Ball> {
        let radius = prop_oneof![Just(0.0), (0_i32..=2).prop_map(f64::from), 0.0..3.0];
        (vector(), radius).prop_map(|(centre, radius)| Ball { centre, radius })
    }

    /// The least reach that a walk of ever shorter steps finds; above the true one by less than 1e-6.
    fn least_reach(balls: &[Ball]) -> f64 {
        let mut centre = balls.iter().map(|ball| ball.centre).sum::<DVec3>() / balls.len() as f64;
        let mut step = 2.0;
        let mut reach = Ball::reach(centre, balls);
        let farthest = |centre: DVec3| {
            balls.iter().copied().max_by(|a, b| {
                (centre.distance(a.centre) + a.radius)
                    .total_cmp(&(centre.distance(b.centre) + b.radius))
            })
        };
        for _ in 0..3000 {
            let Some(ball) = farthest(centre) else { break };
            centre += (ball.centre - centre).normalize_or_zero() * step;
            step *= 0.99;
            reach = reach.min(Ball::reach(centre, balls));
        }
        reach
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]

        #[test]
        fn no_ball_is_less_than_the_least(balls in prop::collection::vec(ball(), 1..=4)) {
            let found = around_balls(&balls);
            prop_assert!(found.centre.is_finite());
            prop_assert!(found.radius >= Ball::reach(found.centre, &balls));
            prop_assert!(found.radius <= least_reach(&balls) + 1e-9, "{found:?} against {}", least_reach(&balls));
        }

        #[test]
        fn a_triangle_is_three_balls_without_extent(corners in [vector(), vector(), vector()]) {
            let balls = corners.map(|centre| Ball { centre, radius: 0.0 });
            let centre = centre_of_triangle(corners);
            prop_assert!(centre.is_finite());
            let expected = around_balls(&balls).radius;
            prop_assert!((Ball::reach(centre, &balls) - expected).abs() <= 1e-9 * (1.0 + expected));
        }
    }

    #[test]
    fn a_ball_that_is_there_twice_changes_nothing() {
        let at = |x: f64, z: f64| Ball {
            centre: DVec3::new(x, 2.0, z),
            radius: 0.0,
        };
        let three = [at(2.0, 3.0), at(0.0, 0.0), at(2.7, 0.0)];
        let expected = around_balls(&three);
        for twice in three {
            let found = around_balls(&[three[0], three[1], three[2], twice]);
            assert!(found.centre.distance(expected.centre) < 1e-12, "{found:?}");
            assert!((found.radius - expected.radius).abs() < 1e-12, "{found:?}");
        }
    }

    #[test]
    fn extreme_sizes_stay_finite() {
        for scale in [1e-45, 1e-30, 1e30, 1e38] {
            let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.4, 0.9, 0.1]]
                .map(|at| DVec3::from_array(at) * scale);
            let centre = centre_of_triangle(corners);
            let reach = corners.map(|corner| corner.distance(centre) / scale);
            assert!(
                reach
                    .iter()
                    .all(|reach| (reach - reach.clamp(0.5, 0.6)).abs() < 1e-6),
                "{reach:?}"
            );
            let apex = DVec3::new(0.3, 0.3, 0.8) * scale;
            let [a, b, c] = corners;
            let balls = [a, b, c, apex].map(|centre| Ball {
                centre,
                radius: 0.1 * scale,
            });
            let ball = around_balls(&balls);
            assert!((0.6..0.75).contains(&(ball.radius / scale)), "{ball:?}");
        }
    }

    #[test]
    fn no_ball_gives_the_empty_one() {
        assert_eq!(around_balls(&[]), Ball::default());
    }
}
