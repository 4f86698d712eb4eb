use super::*;
use crate::test_camera::perspective;

const KERNEL: Kernel = Kernel {
    scale: 1.0,
    sigma: 0.5,
    cutoff: 1.0,
    push: 1.0,
    filter_radius: Some(0.75),
};

fn tilted() -> (DVec3, Axes) {
    let u = DVec3::new(0.3, 0.05, 0.2);
    let v = u.cross(DVec3::new(0.2, 1.0, 0.7)).normalize() * 0.15;
    (DVec3::new(0.2, -0.1, -2.0), Axes { u, v })
}

fn footprint(kernel: &Kernel) -> Footprint {
    let (centre, axes) = tilted();
    Footprint::new(&perspective(), kernel, centre, axes, false).expect("it is in view")
}

/// Sum of weights over fine steps, and their second moments about the mean.
fn moments(footprint: &Footprint) -> (f64, DVec2, DMat2) {
    let step = 0.05;
    let (mut sum, mut first, mut second) = (0.0, DVec2::ZERO, DMat2::ZERO);
    let size = ((footprint.upper - footprint.lower) / step).ceil();
    for row in 0..size.y as u32 {
        for column in 0..size.x as u32 {
            let at = footprint.lower + step * (DVec2::new(f64::from(column), f64::from(row)) + 0.5);
            let weight = footprint.share(at).map_or(0.0, |share| share.weight);
            sum += weight;
            first += weight * at;
            second += weight * DMat2::from_cols(at * at.x, at * at.y);
        }
    }
    let mean = first / sum;
    let about = second * (1.0 / sum) - DMat2::from_cols(mean * mean.x, mean * mean.y);
    (sum * step * step, mean, about)
}

#[test]
fn the_screens_gaussian_has_the_disks_contour() {
    let footprint = footprint(&KERNEL);
    let (centre, shape) = ellipse_of(footprint.uv1).expect("an ellipse");
    let inverse = shape.inverse();
    let camera = perspective();
    let (centre_view, axes) = tilted();
    for step in 0..16 {
        let (sine, cosine) = (f64::from(step) * 0.4).sin_cos();
        let rim = camera.clip_from_view(centre_view + axes.u * cosine + axes.v * sine);
        let offset = camera.pixel_from_clip(rim) - footprint.origin - centre;
        let level = offset.dot(inverse * offset);
        assert!((level - 1.0).abs() < 1e-9, "{level}");
    }
}

#[test]
fn covariances_add_and_the_volume_stays() {
    // Far beyond the usual cutoff, so that nothing of the Gaussian is cut off.
    let wide = Kernel {
        sigma: 0.2,
        ..KERNEL
    };
    let plain = moments(&footprint(&Kernel {
        filter_radius: Some(1e-3),
        ..wide
    }));
    let deviation = 3.0;
    let filtered = moments(&footprint(&Kernel {
        filter_radius: Some(deviation / wide.sigma),
        ..wide
    }));
    assert!((filtered.0 / plain.0 - 1.0).abs() < 1e-3, "volume");
    assert!(filtered.1.distance(plain.1) < 1e-2, "mean");
    let expected = plain.2 + DMat2::from_diagonal(DVec2::splat(deviation * deviation));
    let difference = filtered.2 - expected;
    let most = difference
        .to_cols_array()
        .into_iter()
        .fold(0.0, |most: f64, value| most.max(value.abs()));
    assert!(most < 0.05 * deviation * deviation, "{difference}");
}

#[test]
fn without_a_filter_the_weight_is_the_gaussian_in_the_plane() {
    let kernel = Kernel {
        filter_radius: None,
        ..KERNEL
    };
    let footprint = footprint(&kernel);
    let camera = perspective();
    let (centre, axes) = tilted();
    for (u, v) in [(0.0, 0.0), (0.3, -0.5), (-0.9, 0.1), (0.6, 0.7)] {
        let at = camera.pixel_from_clip(camera.clip_from_view(centre + axes.u * u + axes.v * v));
        let expected = (-2.0_f64 * (u * u + v * v)).exp();
        let share = footprint.share(at).expect("inside the disk");
        assert!((share.weight - expected).abs() < 1e-9 && share.coverage == 1.0);
        let clip = camera.clip_from_view(centre + axes.u * u + axes.v * v);
        let depth = footprint.depth(at).expect("in view");
        assert!((depth - clip.z / clip.w).abs() < 1e-12);
    }
    assert!(footprint.share(footprint.lower).is_none(), "a corner");
}

#[test]
fn a_splat_smaller_than_a_sample_covers_the_one_that_it_lies_in() {
    let tiny = Axes {
        u: DVec3::X * 1e-5,
        v: DVec3::Y * 1e-5,
    };
    let centre = DVec3::new(0.013, 0.027, -2.0);
    let camera = perspective();
    let footprint = Footprint::new(&camera, &KERNEL, centre, tiny, false).expect("it is in view");
    let place = camera.pixel_from_clip(camera.clip_from_view(centre));
    let sample = place.floor() + 0.5;
    assert!(sample.distance(place) < LEAST_RADIUS, "{place}");
    assert!(footprint.covers(sample));
    assert!(
        footprint
            .share(sample)
            .is_some_and(|share| share.weight > 0.0)
    );
    assert!(!footprint.covers(sample + DVec2::X * 2.0));
}

#[test]
fn nothing_comes_of_numbers_that_are_none() {
    let (centre, axes) = tilted();
    let camera = perspective();
    for bad in [f64::NAN, f64::INFINITY] {
        let broken = Axes {
            u: DVec3::new(bad, 0.0, 0.0),
            ..axes
        };
        assert!(Footprint::new(&camera, &KERNEL, centre, broken, false).is_none());
        let away = DVec3::new(0.0, bad, -2.0);
        assert!(Footprint::new(&camera, &KERNEL, away, axes, false).is_none());
    }
    let flat = Axes {
        u: axes.u,
        v: DVec3::ZERO,
    };
    assert!(Footprint::new(&camera, &KERNEL, centre, flat, false).is_none());
}

#[test]
fn a_back_lies_behind_a_front_at_its_place() {
    let (centre, axes) = tilted();
    let camera = perspective();
    let [front, back] = [false, true].map(|faces_away| {
        Footprint::new(&camera, &KERNEL, centre, axes, faces_away).expect("it is in view")
    });
    let at = camera.pixel_from_clip(camera.clip_from_view(centre));
    let depth = front.depth(at).expect("in view");
    assert_eq!(back.depth(at), Some(depth), "its place is the same");
    assert!(
        front.settled(depth) > front.pushed(depth),
        "it blends with itself"
    );
    assert!(
        back.settled(depth) > back.pushed(depth),
        "it blends with itself"
    );
    assert!(
        back.settled(depth) <= front.pushed(depth),
        "not with the front"
    );
}
