use glam::Vec3;

use super::*;
use crate::geometry::Origins;

/// Numbers from 0 to 1 that are the same in all runs (splitmix64).
struct Dice(u64);

impl Dice {
    fn throw(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (bits >> 40) as f32 / (1_u32 << 24) as f32
    }

    /// A direction, every one as likely as any other.
    fn direction(&mut self) -> Vec3 {
        let (z, turn) = (
            self.throw() * 2.0 - 1.0,
            self.throw() * std::f32::consts::TAU,
        );
        let level = (1.0 - z * z).sqrt();
        Vec3::new(level * turn.cos(), level * turn.sin(), z)
    }
}

fn points(centres: impl IntoIterator<Item = Vec3>) -> Geometry {
    let slots = centres.into_iter();
    let block = Block {
        position_radius: slots.map(|centre| centre.extend(0.0).to_array()).collect(),
        ..Block::default()
    };
    Geometry::new(vec![block], None, Origins::default())
}

fn sphere(count: usize, centre: Vec3, seed: u64) -> Vec<Vec3> {
    let mut dice = Dice(seed);
    (0..count).map(|_| centre + dice.direction()).collect()
}

const ORIENTED: Steps = Steps {
    normals: true,
    orientation: true,
    radii: false,
    axes: false,
    neighbours: DEFAULT_NEIGHBOURS,
};

fn done(geometry: &Geometry, steps: Steps) -> (Geometry, Warnings) {
    estimate(geometry, &steps, &Job::new()).expect("nobody cancels")
}

/// How many normals point along what is expected of each.
fn outward(geometry: &Geometry, expected: impl Fn(Vec3) -> Vec3) -> usize {
    let block = &geometry.blocks[0];
    (0..block.len())
        .filter(|&surfel| {
            let normal = block.normal_at(surfel).expect("estimated");
            normal.dot(expected(block.centre(surfel))) > 0.0
        })
        .count()
}

#[test]
fn a_sphere_s_normals_point_outward() {
    let geometry = points(sphere(5000, Vec3::new(3.0, -2.0, 7.0), 1));
    let (oriented, warnings) = done(&geometry, ORIENTED);
    assert_eq!(
        outward(&oriented, |centre| centre - Vec3::new(3.0, -2.0, 7.0)),
        5000
    );
    assert_eq!(oriented.origins.normals, Provenance::Oriented);
    assert_eq!(warnings.count(&WarningKind::NormalsOriented), 5000);
    assert_eq!(warnings.count(&WarningKind::OrientedInPieces), 0);
    assert_eq!(
        oriented.origins.radii,
        Provenance::Missing,
        "nobody asked for radii"
    );
}

#[test]
fn a_torus_s_normals_point_away_from_its_ring() {
    let mut dice = Dice(2);
    let ring = |centre: Vec3| Vec3::new(centre.x, centre.y, 0.0).normalize() * 2.0;
    let torus = (0..12_000).map(|_| {
        let (around, across) = (
            dice.throw() * std::f32::consts::TAU,
            dice.throw() * std::f32::consts::TAU,
        );
        let out = Vec3::new(around.cos(), around.sin(), 0.0);
        out * (2.0 + 0.6 * across.cos()) + Vec3::Z * 0.6 * across.sin()
    });
    let (oriented, _) = done(&points(torus), ORIENTED);
    assert_eq!(outward(&oriented, |centre| centre - ring(centre)), 12_000);
}

#[test]
fn spheres_apart_are_oriented_each_for_itself_and_that_is_said() {
    let far = Vec3::new(9.0, 0.0, 0.0);
    let both = sphere(2000, Vec3::ZERO, 3)
        .into_iter()
        .chain(sphere(1500, far, 4));
    let (oriented, warnings) = done(&points(both), ORIENTED);
    let nearest = |centre: Vec3| if centre.x > 4.5 { centre - far } else { centre };
    assert_eq!(outward(&oriented, nearest), 3500);
    assert_eq!(warnings.count(&WarningKind::OrientedInPieces), 2);
}

#[test]
fn an_open_plane_looks_along_its_axis() {
    let mut dice = Dice(5);
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        let (u, v) = axis.any_orthonormal_pair();
        let plane = (0..900).map(|_| u * dice.throw() + v * dice.throw());
        let (oriented, _) = done(&points(plane), ORIENTED);
        assert_eq!(outward(&oriented, |_| axis), 900, "{axis}");
    }
}

#[test]
fn normals_of_a_file_are_turned_and_not_replaced_and_axes_turn_along() {
    let mut dice = Dice(6);
    let mut geometry = points(sphere(2000, Vec3::ZERO, 7));
    let block = &mut geometry.blocks[0];
    // Bent by up to 6 degrees and turned at random: that is what must come back, but for the turn.
    let centres: Vec<Vec3> = (0..block.len())
        .map(|surfel| block.centre(surfel))
        .collect();
    let given: Vec<Vec3> = centres
        .iter()
        .map(|centre| {
            let bent = (*centre + 0.1 * dice.direction()).normalize();
            if dice.throw() < 0.5 { -bent } else { bent }
        })
        .collect();
    let axes = given.iter().map(|normal| {
        let (u, v) = normal.any_orthonormal_pair();
        TangentAxes::new(u, v).0
    });
    block.axes = Some(axes.collect());
    block.normal = Some(given.iter().map(|normal| encode_normal(*normal)).collect());
    geometry.origins.normals = Provenance::FromFile;
    geometry.origins.axes = Provenance::FromFile;
    let steps = Steps {
        normals: false,
        ..ORIENTED
    };
    let (oriented, _) = done(&geometry, steps);
    assert_eq!(outward(&oriented, |centre| centre), 2000);
    assert_eq!(oriented.origins.normals, Provenance::FromFile);
    let block = &oriented.blocks[0];
    for (surfel, given) in given.iter().enumerate() {
        let normal = block.normal_at(surfel).expect("it has one");
        assert!(normal.dot(*given).abs() > 0.999_999, "{normal} was {given}");
        let axes = TangentAxes(block.axes.as_ref().expect("kept")[surfel]);
        assert!(
            axes.u().cross(axes.v()).dot(normal) > 0.99,
            "surfel {surfel}"
        );
    }
}

#[test]
fn threads_do_not_change_what_comes_out() {
    let geometry = points(sphere(30_000, Vec3::ZERO, 8));
    let steps = Steps {
        radii: true,
        axes: true,
        ..ORIENTED
    };
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| done(&geometry, steps).0.blocks.remove(0))
    };
    let (one, four) = (with(1), with(4));
    assert_eq!(one.normal, four.normal);
    assert_eq!(one.position_radius, four.position_radius);
    assert_eq!(one.axes, four.axes);
}

#[test]
fn ellipses_cover_scan_lines_with_less_than_disks_need() {
    let mut dice = Dice(9);
    // Along a line 1 apart, from line to line 5.
    let lines: Vec<Vec3> = (0..100_u8)
        .flat_map(|x| (0..20_u8).map(move |y| Vec3::new(f32::from(x), f32::from(y) * 5.0, 0.0)))
        .map(|centre| centre + 0.2 * Vec3::new(dice.throw(), dice.throw(), 0.0))
        .collect();
    let steps = Steps {
        normals: true,
        radii: true,
        axes: true,
        neighbours: 32,
        ..Steps::default()
    };
    let (estimated, warnings) = done(&points(lines), steps);
    assert_eq!(warnings.count(&WarningKind::AxesEstimated), 2000);
    let block = &estimated.blocks[0];
    let axes: Vec<TangentAxes> = block
        .axes
        .as_ref()
        .expect("estimated")
        .iter()
        .map(|axes| TangentAxes(*axes))
        .collect();
    let (mut ellipse_area, mut disk_area) = (0.0, 0.0);
    for (surfel, axes) in axes.iter().enumerate() {
        let normal = block.normal_at(surfel).expect("estimated");
        assert!(axes.u().dot(axes.v()).abs() < 1e-3 && axes.u().dot(normal).abs() < 1e-3);
        assert!(axes.u().cross(axes.v()).dot(normal) > 0.0);
        ellipse_area += axes.u().length() * axes.v().length();
        disk_area += block.position_radius[surfel][3].powi(2);
    }
    assert!(
        ellipse_area < 0.5 * disk_area,
        "{ellipse_area} of {disk_area}"
    );
    let open = (0..3000)
        .filter(|_| {
            let probe = Vec3::new(5.0 + 90.0 * dice.throw(), 5.0 + 85.0 * dice.throw(), 0.0);
            !axes.iter().enumerate().any(|(surfel, axes)| {
                let offset = probe - block.centre(surfel);
                let (u, v) = (axes.u(), axes.v());
                let (x, y) = (
                    offset.dot(u) / u.length_squared(),
                    offset.dot(v) / v.length_squared(),
                );
                x * x + y * y <= 1.0
            })
        })
        .count();
    assert_eq!(open, 0, "of 3000 places are open");
}

#[test]
fn axes_alone_bring_normals_and_radii_along() {
    let steps = Steps {
        axes: true,
        ..Steps::default()
    };
    let (estimated, warnings) = done(&points(sphere(1000, Vec3::ZERO, 10)), steps);
    assert_eq!(warnings.count(&WarningKind::NormalsEstimated), 1000);
    assert_eq!(estimated.origins.radii, Provenance::Estimated);
    let block = &estimated.blocks[0];
    for (slot, axes) in block
        .position_radius
        .iter()
        .zip(block.axes.iter().flat_map(|all| all.iter()))
    {
        assert!(slot[3] > 0.0 && slot[3] >= TangentAxes(*axes).v().length());
    }
}

#[test]
fn new_normals_drop_axes_that_no_longer_fit() {
    let steps = Steps {
        axes: true,
        ..Steps::default()
    };
    let (with_axes, _) = done(&points(sphere(500, Vec3::ZERO, 11)), steps);
    let steps = Steps {
        normals: true,
        ..Steps::default()
    };
    let (without, warnings) = done(&with_axes, steps);
    assert!(without.blocks[0].axes.is_none());
    assert_eq!(without.origins.axes, Provenance::Missing);
    assert!(
        warnings
            .iter()
            .any(|warning| warning.to_string().contains("tangent axes"))
    );
}

#[test]
fn a_mesh_takes_normals_from_its_faces_and_nothing_that_was_not_asked() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let mut mesh = points(corners);
    mesh.triangles = Some(Arc::from([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]));
    let (estimated, warnings) = done(&mesh, ORIENTED);
    assert_eq!(estimated.origins.normals, Provenance::FromFaces);
    assert_eq!(outward(&estimated, |centre| centre - Vec3::splat(0.25)), 4);
    assert_eq!(estimated.origins.radii, Provenance::Missing);
    assert!(
        estimated.blocks[0]
            .position_radius
            .iter()
            .all(|slot| slot[3] == 0.0)
    );
    assert!(
        warnings
            .iter()
            .any(|warning| warning.to_string().contains("faces"))
    );
}

#[test]
fn few_points_and_points_at_one_place_are_no_trouble() {
    let steps = Steps {
        radii: true,
        axes: true,
        ..ORIENTED
    };
    for count in 0..6_usize {
        for at in [Vec3::ZERO, Vec3::X] {
            let centres = (0..count).map(|number| at * number as f32);
            let (estimated, _) = done(&points(centres), steps);
            for block in &estimated.blocks {
                let axes = block.axes.iter().flat_map(|all| all.iter());
                let are_useful = axes.clone().all(|axes| {
                    let axes = TangentAxes(*axes);
                    axes.u().length() > 0.0 && axes.v().length() > 0.0 && axes.u().is_finite()
                });
                assert!(are_useful || count == 0, "{count} points");
                assert!(
                    block.position_radius.iter().all(|slot| slot[3] > 0.0),
                    "{count} points"
                );
            }
        }
    }
}

#[test]
fn a_cancel_at_any_check_ends_it() {
    let geometry = points(sphere(5000, Vec3::ZERO, 12));
    let steps = Steps {
        neighbours: 4,
        ..ORIENTED
    };
    let mut orienting = 0;
    for check in 0.. {
        let job = Job::cancelled_at_check(check);
        match estimate(&geometry, &steps, &job) {
            Err(Cancelled) => orienting += u32::from(job.stage().starts_with("orient")),
            Ok(_) => break,
        }
    }
    // Two pieces and a look more in each of several rounds.
    assert!(
        orienting > 10,
        "{orienting} looks at the flag while orienting"
    );
}
