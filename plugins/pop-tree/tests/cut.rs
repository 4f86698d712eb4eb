//! Cuts: every triangle is drawn once or cannot be seen, and what is kept from the last cut changes none.

mod meshes;

use meshes::{Columns, any_mesh, inward_sphere, sheet};
use pointstage_plugin_api::glam::{Mat4, Quat, Vec3, Vec4};
use pointstage_pop_tree::Tree;
use pointstage_pop_tree::cut::{CoherentCut, Cut, Keep, Projection, Root, View, full};
use proptest::prelude::*;

const SIZE_PX: [f32; 2] = [400.0, 300.0];

/// Perspective, 40 degrees high, reversed depth, infinite far plane; or orthographic.
fn projection(view_from_object: Mat4, height: Option<f32>, threshold_px: f32) -> Projection {
    let aspect = SIZE_PX[0] / SIZE_PX[1];
    let (clip_from_view, pixels_per_unit) = match height {
        None => {
            let focal = 1.0 / 20_f32.to_radians().tan();
            let columns = [
                Vec4::X * (focal / aspect),
                Vec4::Y * focal,
                Vec4::new(0.0, 0.0, 0.0, -1.0),
                Vec4::new(0.0, 0.0, 0.01, 0.0),
            ];
            let [x, y, z, w] = columns;
            (Mat4::from_cols(x, y, z, w), focal * SIZE_PX[1] / 2.0)
        }
        Some(height) => {
            let half = height / 2.0;
            // Near at 0.01, far at 100, depth 1 to 0.
            let depth = 1.0 / 99.99;
            let matrix = Mat4::from_cols(
                Vec4::X / (half * aspect),
                Vec4::Y / half,
                Vec4::Z * depth,
                Vec4::new(0.0, 0.0, 100.0 * depth, 1.0),
            );
            (matrix, SIZE_PX[1] / height)
        }
    };
    Projection {
        view_from_object,
        clip_from_view,
        size_px: SIZE_PX,
        pixels_per_unit,
        is_orthographic: height.is_some(),
        threshold_px,
        cull_backs: false,
        is_inward: false,
    }
}

/// The camera at a distance from a centre, turned round it.
fn orbit(centre: Vec3, distance: f32, yaw: f32, pitch: f32) -> Mat4 {
    let turn = Quat::from_rotation_x(pitch) * Quat::from_rotation_y(yaw);
    Mat4::from_translation(Vec3::NEG_Z * distance)
        * Mat4::from_quat(turn)
        * Mat4::from_translation(-centre)
}

fn cut_of(tree: &Tree, projection: &Projection) -> Cut {
    let mut cut = Cut::default();
    full(tree, &View::new(projection, &tree.grid), &mut cut);
    cut
}

/// Triangles below a node.
fn below(tree: &Tree, node: u32, found: &mut Vec<u32>) {
    let packed = tree.nodes[node as usize];
    if node >= tree.first_leaf() {
        found.push(packed.link());
    } else {
        packed
            .children()
            .for_each(|child| below(tree, child, found));
    }
}

/// How often each triangle of the mesh is drawn, by itself or by a splat.
fn covers(tree: &Tree, cut: &Cut) -> Vec<u32> {
    let mut drawn = cut.triangles.clone();
    for &node in &cut.splats {
        below(tree, node, &mut drawn);
    }
    let mut counts = vec![0; tree.leaves().len()];
    for triangle in drawn {
        counts[triangle as usize] += 1;
    }
    counts
}

/// Whether a vertex of the triangle is in the picture, in front of the near plane.
fn is_in_view(mesh: &Columns, triangle: u32, projection: &Projection) -> bool {
    let matrix = projection.clip_from_view * projection.view_from_object;
    mesh.corners(triangle).into_iter().any(|corner| {
        let clip = matrix * corner.extend(1.0);
        clip.w > 0.0
            && clip.x.abs() <= clip.w
            && clip.y.abs() <= clip.w
            && (0.0..=clip.w).contains(&clip.z)
    })
}

/// Whether the triangle's face, seen from outside by its vertices' order, is turned to the eye by more than rounding.
fn faces_eye(mesh: &Columns, triangle: u32, projection: &Projection, sign: f32) -> bool {
    let [a, b, c] = mesh
        .corners(triangle)
        .map(|corner| projection.view_from_object.transform_point3(corner));
    let normal = (b - a).cross(c - a).normalize_or_zero() * sign;
    let to_eye = if projection.is_orthographic {
        Vec3::Z
    } else {
        -a.normalize()
    };
    normal.dot(to_eye) > 1e-3
}

fn centre_and_extent(tree: &Tree) -> (Vec3, f32) {
    tree.nodes.first().map_or((Vec3::ZERO, 1.0), |root| {
        (tree.grid.position(root.place()), root.radius().max(1e-20))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn every_triangle_is_drawn_once_or_out_of_view(
        mesh in any_mesh(),
        yaw in -4.0_f32..4.0,
        pitch in -1.5_f32..1.5,
        distance in 0.1_f32..60.0,
        threshold_px in 0.3_f32..30.0,
        height in proptest::option::of(0.2_f32..8.0),
    ) {
        let tree = mesh.tree();
        let (centre, extent) = centre_and_extent(&tree);
        // Units of the object, so that near plane and picture fit it.
        let matrix = Mat4::from_translation(Vec3::NEG_Z * distance)
            * orbit(Vec3::ZERO, 0.0, yaw, pitch)
            * Mat4::from_scale(Vec3::splat(1.0 / extent))
            * Mat4::from_translation(-centre);
        let projection = projection(matrix, height, threshold_px);
        let cut = cut_of(&tree, &projection);
        for (triangle, count) in (0..).zip(covers(&tree, &cut)) {
            let is_seen = is_in_view(&mesh, triangle, &projection);
            prop_assert!(count == 1 || (count == 0 && !is_seen), "triangle {triangle} {count} times");
        }
        let view = View::new(&projection, &tree.grid);
        let mut coherent = CoherentCut::default();
        let mut kept = Cut::default();
        for _ in 0..2 {
            coherent.update(&tree, &view, Keep::Always, 1, &mut kept);
            prop_assert!(kept.splats == cut.splats && kept.triangles == cut.triangles);
            prop_assert_eq!(kept.counts.culled, cut.counts.culled);
        }
    }
}

#[test]
fn culling_leaves_out_only_what_is_turned_away() {
    // The faces of this sphere are wound inward; the nodes' normals too, once the vertices have none.
    let outward = inward_sphere(120);
    let inward = Columns {
        normals: None,
        ..inward_sphere(120)
    };
    for (mesh, is_inward) in [(outward, false), (inward, true)] {
        let tree = mesh.tree();
        let (centre, extent) = centre_and_extent(&tree);
        for (height, distance) in [(None, 1.5), (None, 4.0), (Some(2.5 * extent), 3.0)] {
            for step in 0..10 {
                let matrix = orbit(centre, distance * extent, 0.7 * step as f32, 0.3);
                let plain = projection(matrix, height, 2.0);
                let culling = Projection {
                    cull_backs: true,
                    is_inward,
                    ..plain
                };
                let cut = cut_of(&tree, &culling);
                let mut left_out = 0;
                for (triangle, count) in (0..).zip(covers(&tree, &cut)) {
                    let is_needed = is_in_view(&mesh, triangle, &plain)
                        && faces_eye(&mesh, triangle, &plain, -1.0);
                    assert!(
                        count == 1 || (count == 0 && !is_needed),
                        "triangle {triangle} {count} times"
                    );
                    left_out += usize::from(count == 0);
                }
                let all = mesh.triangles.len();
                assert!(left_out * 5 > all, "{left_out} of {all} left out");
            }
        }
    }
}

/// Views along a way: slow turns, a zoom, a stand, a jump, and back.
fn way(centre: Vec3, extent: f32) -> Vec<Projection> {
    let mut views = Vec::new();
    for step in 0..40 {
        views.push(projection(
            orbit(centre, 3.0 * extent, 0.01 * step as f32, 0.2),
            None,
            2.0,
        ));
    }
    for step in 0..25 {
        let distance = extent * (3.0 - 0.1 * step as f32);
        views.push(projection(
            orbit(centre, distance, 0.4, 0.2 + 0.01 * step as f32),
            None,
            2.0,
        ));
    }
    views.push(views[views.len() - 1]);
    views.push(projection(
        orbit(centre, 20.0 * extent, 2.0, -0.5),
        None,
        2.0,
    ));
    views.push(projection(
        orbit(centre, 20.0 * extent, 2.0, -0.5),
        None,
        5.0,
    ));
    for step in 0..20 {
        let height = Some(2.2 * extent);
        views.push(projection(
            orbit(centre, 3.0 * extent, 0.01 * step as f32, 0.2),
            height,
            1.5,
        ));
    }
    views
}

#[test]
fn a_kept_cut_is_the_full_one_along_any_way() {
    for mesh in [inward_sphere(240), sheet(160, 90)] {
        let tree = mesh.tree();
        let (centre, extent) = centre_and_extent(&tree);
        for cull_backs in [false, true] {
            let ways = [
                (Keep::Always, 1),
                (Keep::Always, 3),
                (Keep::WhereItPays, 2),
                (Keep::Never, 3),
            ];
            let mut cuts = ways.map(|_| CoherentCut::default());
            for (step, plain) in way(centre, extent).iter().enumerate() {
                let projection = Projection {
                    cull_backs,
                    ..*plain
                };
                let view = View::new(&projection, &tree.grid);
                let expected = cut_of(&tree, &projection);
                for (cut, (keep, threads)) in cuts.iter_mut().zip(ways) {
                    let mut found = Cut::default();
                    cut.update(&tree, &view, keep, threads, &mut found);
                    assert!(found.splats == expected.splats, "splats, step {step}");
                    assert!(
                        found.triangles == expected.triangles,
                        "triangles, step {step}"
                    );
                    assert_eq!(found.counts.culled, expected.counts.culled, "step {step}");
                    assert!(found.counts.evaluated <= expected.counts.evaluated);
                }
            }
        }
    }
}

#[test]
fn a_slow_orbit_asks_few_nodes_and_a_stand_fewer() {
    let tree = inward_sphere(500).tree();
    let (centre, extent) = centre_and_extent(&tree);
    let mut coherent = CoherentCut::default();
    let (mut asked, mut all) = (0, 0);
    let mut cut = Cut::default();
    for step in 0..20 {
        let projection = projection(
            orbit(centre, 3.0 * extent, 0.005 * step as f32, 0.2),
            None,
            2.0,
        );
        coherent.update(
            &tree,
            &View::new(&projection, &tree.grid),
            Keep::Always,
            1,
            &mut cut,
        );
        if step > 0 {
            asked += cut.counts.evaluated;
            all += cut_of(&tree, &projection).counts.evaluated;
        }
    }
    assert!(2 * asked <= all, "{asked} of {all} asked");
    let projection = projection(orbit(centre, 3.0 * extent, 0.005 * 19.0, 0.2), None, 2.0);
    coherent.update(
        &tree,
        &View::new(&projection, &tree.grid),
        Keep::Always,
        1,
        &mut cut,
    );
    assert!(
        cut.counts.evaluated < 2_000,
        "{} asked of a picture that stands",
        cut.counts.evaluated
    );
}

#[test]
fn the_root_is_what_the_full_cut_says() {
    let tree = sheet(20, 20).tree();
    let (centre, extent) = centre_and_extent(&tree);
    let at = |distance: f32| {
        View::new(
            &projection(orbit(centre, distance, 0.3, 0.2), None, 4.0),
            &tree.grid,
        )
    };
    assert_eq!(at(-10.0 * extent).root(&tree), Root::Culled);
    assert_eq!(at(1e4 * extent).root(&tree), Root::Splat);
    assert!(matches!(at(2.0 * extent).root(&tree), Root::Open(_)));
    let empty = Tree {
        nodes: Vec::new(),
        level_starts: Vec::new(),
        ..tree
    };
    assert_eq!(at(2.0).root(&empty), Root::Culled);
    let mut cut = Cut::default();
    full(&empty, &at(2.0), &mut cut);
    assert!(cut.is_empty());
    CoherentCut::default().update(&empty, &at(2.0), Keep::Always, 2, &mut cut);
    assert!(cut.is_empty());
}
