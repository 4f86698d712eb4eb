//! The projected ellipse against brute force: rays through pixel centres, met with the surfel's plane in view space.

use glam::{DMat4, DVec2, DVec3, DVec4};
use pointstage_plugin_api::twin::camera::Camera;
use pointstage_plugin_api::twin::ellipse::{Axes, project_ellipse};

/// Random numbers from a fixed seed (splitmix64).
struct Random(u64);

impl Random {
    /// Uniform in `range`.
    fn uniform(&mut self, range: std::ops::Range<f64>) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let unit = (bits >> 11) as f64 / (1_u64 << 53) as f64;
        range.start + unit * (range.end - range.start)
    }
}

const NEAR: f64 = 0.1;
const SIZE_PX: DVec2 = DVec2::new(64.0, 48.0);

/// Reversed z, infinite far plane.
fn perspective() -> Camera {
    let scale_y = 1.5;
    let scale_x = scale_y * SIZE_PX.y / SIZE_PX.x;
    Camera {
        clip_from_view: DMat4::from_cols(
            DVec4::new(scale_x, 0.0, 0.0, 0.0),
            DVec4::new(0.0, scale_y, 0.0, 0.0),
            DVec4::new(0.0, 0.0, 0.0, -1.0),
            DVec4::new(0.0, 0.0, NEAR, 0.0),
        ),
        tile_size_px: SIZE_PX,
        pixels_per_unit: 0.5 * scale_y * SIZE_PX.y,
        is_orthographic: false,
    }
}

/// Reversed z from 1 at `NEAR` to 0 at distance 10.
fn orthographic() -> Camera {
    let far = 10.0;
    let scale_y = 0.5;
    let scale_x = scale_y * SIZE_PX.y / SIZE_PX.x;
    Camera {
        clip_from_view: DMat4::from_cols(
            DVec4::new(scale_x, 0.0, 0.0, 0.0),
            DVec4::new(0.0, scale_y, 0.0, 0.0),
            DVec4::new(0.0, 0.0, 1.0 / (far - NEAR), 0.0),
            DVec4::new(0.0, 0.0, far / (far - NEAR), 1.0),
        ),
        tile_size_px: SIZE_PX,
        pixels_per_unit: 0.5 * scale_y * SIZE_PX.y,
        is_orthographic: true,
    }
}

/// Distance along the view direction at which the ray of a pixel position meets the disk, in front of the near plane.
fn cast(camera: &Camera, pixel: DVec2, centre: DVec3, axes: Axes) -> Option<f64> {
    let (origin, direction) = camera.ray(pixel);
    let normal = axes.u.cross(axes.v);
    let distance = normal.dot(centre - origin) / normal.dot(direction);
    let offset = origin + distance * direction - centre;
    // Coordinates of the offset over the two half-axes, by their Gram matrix.
    let (uu, uv, vv) = (axes.u.dot(axes.u), axes.u.dot(axes.v), axes.v.dot(axes.v));
    let (ou, ov) = (offset.dot(axes.u), offset.dot(axes.v));
    let determinant = uu * vv - uv * uv;
    let u = (ou * vv - ov * uv) / determinant;
    let v = (ov * uu - ou * uv) / determinant;
    (u * u + v * v <= 1.0 && distance >= NEAR).then_some(distance)
}

/// A random surfel: anywhere in the view, or (half of them) round the near plane and the eye.
fn random_surfel(random: &mut Random, index: usize) -> (DVec3, Axes) {
    let mut vector = |size: f64| DVec3::from([(); 3].map(|()| random.uniform(-size..size)));
    let tilt = vector(1.0);
    let (u, v) = tilt.normalize().any_orthonormal_pair();
    let skew = vector(0.6).x;
    let position = vector(1.0);
    let (centre, size) = if index.is_multiple_of(2) {
        (
            position * DVec3::new(1.5, 1.2, 2.5) - DVec3::Z * 3.5,
            0.05 + 0.9 * vector(1.0).x.abs(),
        )
    } else {
        (
            position * DVec3::new(0.6, 0.6, 0.4) - DVec3::Z * 0.15,
            0.1 + 2.0 * vector(1.0).x.abs(),
        )
    };
    let aspect = 0.15 + 0.85 * vector(1.0).x.abs();
    // Conjugate half-axes that are not orthogonal give ellipses too.
    (
        centre,
        Axes {
            u: u * size,
            v: (v + skew * u) * size * aspect,
        },
    )
}

#[test]
fn bounds_hold_every_pixel_that_a_ray_hits() {
    let mut random = Random(7);
    let (mut cut_and_seen, mut whole_and_seen) = (0, 0);
    for index in 0..2_000 {
        let camera = if index % 5 == 4 {
            orthographic()
        } else {
            perspective()
        };
        let (centre, axes) = random_surfel(&mut random, index);
        let image = project_ellipse(&camera, centre, axes);
        // Four rays a pixel in each direction.
        let step = 0.25;
        let mut is_seen = false;
        let (columns, rows) = ((SIZE_PX.x / step) as u32, (SIZE_PX.y / step) as u32);
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)))
        {
            let pixel = (DVec2::new(f64::from(column), f64::from(row)) + 0.5) * step;
            let Some(distance) = cast(&camera, pixel, centre, axes) else {
                continue;
            };
            is_seen = true;
            let image = image
                .unwrap_or_else(|| panic!("surfel {index} is hit at {pixel} but not projected"));
            let inside = pixel.cmpge(image.lower_px - 1e-9).all()
                && pixel.cmple(image.upper_px + 1e-9).all();
            assert!(
                inside,
                "surfel {index} is hit at {pixel}, outside {} .. {}",
                image.lower_px, image.upper_px
            );
            let clip = camera.clip_from_view(DVec3::new(0.0, 0.0, -distance));
            let expected = clip.z / clip.w;
            let depth = image.ellipse_depth(pixel);
            assert!(
                (depth - expected).abs() < 1e-9,
                "surfel {index} at {pixel}: depth {depth}, by ray {expected}"
            );
        }
        match image {
            Some(image) if is_seen && image.is_cut => cut_and_seen += 1,
            Some(_) if is_seen => whole_and_seen += 1,
            _ => {}
        }
    }
    assert!(
        cut_and_seen > 200 && whole_and_seen > 500,
        "{cut_and_seen} cut by the near plane, {whole_and_seen} whole"
    );
}

#[test]
fn bounds_touch_the_outline() {
    // Tightness without a grid: points of the circle, projected one by one.
    let mut random = Random(8);
    for index in 0..2_000 {
        let camera = if index % 5 == 4 {
            orthographic()
        } else {
            perspective()
        };
        let (centre, axes) = random_surfel(&mut random, index);
        let Some(image) = project_ellipse(&camera, centre, axes) else {
            continue;
        };
        let outline = (0..20_000).filter_map(|step| {
            let (sin, cos) = (f64::from(step) / 20_000.0 * std::f64::consts::TAU).sin_cos();
            let clip = camera.clip_from_view(centre + cos * axes.u + sin * axes.v);
            (clip.w >= clip.z).then(|| camera.pixel_from_clip(clip))
        });
        let (low, high) = outline.fold(
            (DVec2::INFINITY, DVec2::NEG_INFINITY),
            |(low, high), pixel| (low.min(pixel), high.max(pixel)),
        );
        let size = (image.upper_px - image.lower_px).max(DVec2::splat(1.0));
        let outside = (image.lower_px - low)
            .max(high - image.upper_px)
            .max_element();
        assert!(
            outside < 1e-6 * size.max_element(),
            "surfel {index}: outline {low} .. {high}, bounds {image:?}"
        );
        // Far below a pixel where nothing is cut: a grid of rays would miss slim tips and see less.
        // The last visible step before the near plane can be far from it on the screen, so cut outlines get more room.
        let room = if image.is_cut {
            0.05 * size
        } else {
            1e-4 * size
        };
        let slack = ((low - image.lower_px) - room)
            .max((image.upper_px - high) - room)
            .max_element();
        assert!(
            slack < 0.0,
            "surfel {index}: outline {low} .. {high}, bounds {image:?}"
        );
    }
}

#[test]
fn a_disk_round_the_eye_has_finite_bounds_or_none() {
    let camera = perspective();
    let wide = Axes {
        u: DVec3::X * 50.0,
        v: DVec3::Z * 50.0,
    };
    let image = project_ellipse(&camera, DVec3::new(0.0, -0.2, 0.0), wide)
        .expect("a floor under the eye is visible");
    assert!(
        image.is_cut && image.lower_px.is_finite() && image.upper_px.is_finite(),
        "{image:?}"
    );
    // The floor's horizon is a little below the middle of the target: bounds do not take the sky along.
    assert!(image.lower_px.y > 0.5 * SIZE_PX.y, "{image:?}");
    let behind = Axes {
        u: DVec3::X,
        v: DVec3::Y,
    };
    assert_eq!(project_ellipse(&camera, DVec3::Z, behind), None);
    assert_eq!(project_ellipse(&camera, DVec3::NAN, behind), None);
    assert_eq!(
        project_ellipse(
            &camera,
            DVec3::NEG_Z,
            Axes {
                u: DVec3::Z * 0.5,
                v: DVec3::Y * 0.0
            }
        ),
        None
    );
}
