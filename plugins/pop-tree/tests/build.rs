//! Trees of all manner of meshes have the nodes they should, and every node holds what is below it.

mod meshes;

use meshes::{Columns, any_mesh, colour, inward_sphere, sheet, slivers};
use pointstage_plugin_api::columns::{self, linear_from_srgb, srgb_from_linear};
use pointstage_plugin_api::glam::{DVec3, Vec3};
use pointstage_pop_tree::{BuildError, NO_CONE, Node, Tree, build, decode_half_angle};
use proptest::prelude::*;
use std::time::{Duration, Instant};

/// Rounding of this test's own angles; radians.
const ANGLE_ROUNDING: f64 = 1e-6;

fn groups(count: usize) -> usize {
    if count <= 4 {
        1
    } else {
        groups(count / 2) + groups(count - count / 2)
    }
}

/// Number of the first node of each level, by the recursion itself.
fn expected_starts(leaf_count: usize) -> Vec<u32> {
    let mut sizes = vec![];
    let mut size = leaf_count;
    while size > 0 {
        sizes.push(size as u32);
        size = if size == 1 { 0 } else { groups(size) };
    }
    let mut end = 0;
    let start = |&size: &u32| {
        end += size;
        end - size
    };
    sizes.iter().rev().map(start).collect()
}

fn check_counts(mesh: &Columns, tree: &Tree) {
    assert_eq!(tree.level_starts, expected_starts(mesh.triangles.len()));
    let mut seen = vec![false; mesh.triangles.len()];
    for triangle in tree.leaf_triangles() {
        assert!(
            !std::mem::replace(&mut seen[triangle as usize], true),
            "triangle {triangle} twice"
        );
    }
    assert!(seen.iter().all(|&seen| seen));
    let mut next = 1;
    for node in &tree.nodes[..tree.first_leaf() as usize] {
        assert_eq!(node.children().start, next);
        next = node.children().end;
    }
    assert_eq!(next as usize, tree.nodes.len().max(1));
}

fn sphere(tree: &Tree, node: Node) -> (DVec3, f64) {
    (
        tree.grid.position(node.place()).as_dvec3(),
        f64::from(node.radius()),
    )
}

fn check_spheres(mesh: &Columns, tree: &Tree) {
    let (inner, leaves) = tree.nodes.split_at(tree.first_leaf() as usize);
    for (number, node) in inner.iter().enumerate() {
        let (centre, radius) = sphere(tree, *node);
        assert!(radius.is_finite() && centre.is_finite());
        for child in node.children() {
            let child = tree.nodes[child as usize];
            let (child_centre, child_radius) = sphere(tree, child);
            assert!(
                centre.distance(child_centre) + child_radius <= radius,
                "node {number}"
            );
            assert!(child.radius_code() < node.radius_code(), "node {number}");
        }
    }
    for leaf in leaves {
        let (centre, radius) = sphere(tree, *leaf);
        for corner in mesh.corners(leaf.link()) {
            assert!(
                centre.distance(corner.as_dvec3()) <= radius,
                "triangle {}",
                leaf.link()
            );
        }
    }
}

/// Leaves below each node: a range, as children lie in their parents' order.
fn leaves_below(tree: &Tree, node: usize) -> std::ops::Range<usize> {
    let (mut first, mut last) = (node, node);
    while first < tree.first_leaf() as usize {
        first = tree.nodes[first].children().start as usize;
        last = tree.nodes[last].children().end as usize - 1;
    }
    first..last + 1
}

fn vertex_normal(mesh: &Columns, triangle: u32) -> Option<Vec3> {
    let normals = mesh.normals.as_ref()?;
    let bits = mesh.triangles[triangle as usize].map(|vertex| normals[vertex as usize]);
    let known = bits.iter().filter(|&&bits| bits != columns::NO_NORMAL);
    known
        .map(|&bits| columns::decode_normal(bits))
        .sum::<Vec3>()
        .try_normalize()
}

/// A triangle's own normal and its area; none if it has no area to speak of.
fn face(mesh: &Columns, triangle: u32) -> Option<(DVec3, f64)> {
    let [a, b, c] = mesh.corners(triangle).map(Vec3::as_dvec3);
    let cross = (b - a).cross(c - a);
    let area = 0.5 * cross.length();
    if area <= 1e-11 * (b - a).length() * (c - a).length() {
        return None;
    }
    let vertex = vertex_normal(mesh, triangle)
        .unwrap_or(Vec3::ZERO)
        .as_dvec3();
    let normal = cross.normalize();
    Some((
        if normal.dot(vertex) < -1e-7 {
            -normal
        } else {
            normal
        },
        area,
    ))
}

fn check_cones(mesh: &Columns, tree: &Tree) {
    for (number, node) in tree.nodes.iter().enumerate() {
        if node.cone_code() == NO_CONE {
            continue;
        }
        let half_angle = f64::from(decode_half_angle(node.cone_code())) + ANGLE_ROUNDING;
        let axis = node.normal().as_dvec3();
        for leaf in &tree.nodes[leaves_below(tree, number)] {
            if let Some((normal, _)) = face(mesh, leaf.link()) {
                let is_turned = vertex_normal(mesh, leaf.link())
                    .is_some_and(|vertex| vertex.as_dvec3().dot(normal).abs() < 1e-6);
                let angle = axis.angle_between(normal);
                assert!(
                    angle <= half_angle || is_turned,
                    "node {number}: {angle} of {half_angle}"
                );
            }
            let has_normal =
                face(mesh, leaf.link()).is_some() || vertex_normal(mesh, leaf.link()).is_some();
            let angle = axis.angle_between(leaf.normal().as_dvec3());
            assert!(
                !has_normal || angle <= half_angle,
                "node {number}: leaf at {angle} of {half_angle}"
            );
        }
    }
}

/// Normals and colours of nodes are means weighted by area, colours as light; for meshes of triangles that all have area.
fn check_means(mesh: &Columns, tree: &Tree) {
    for (number, node) in tree.nodes.iter().enumerate() {
        let (mut normal, mut light, mut weight) = (DVec3::ZERO, Vec3::ZERO, 0.0);
        for leaf in &tree.nodes[leaves_below(tree, number)] {
            let (own, area) = face(mesh, leaf.link()).expect("a triangle with area");
            normal += own * area;
            weight += area as f32;
            let vertices = mesh.triangles[leaf.link() as usize];
            let mean = mesh.colours.as_ref().map(|colours| {
                vertices
                    .iter()
                    .map(|&vertex| colour(colours[vertex as usize]).map(linear_from_srgb))
                    .sum::<Vec3>()
                    / 3.0
            });
            let grey = Vec3::splat(linear_from_srgb(0.5));
            light += mean.unwrap_or(grey) * area as f32;
        }
        if number >= tree.first_leaf() as usize {
            let vertex = vertex_normal(mesh, node.link()).map(Vec3::as_dvec3);
            normal = vertex.unwrap_or(normal);
        }
        let off = node
            .normal()
            .as_dvec3()
            .angle_between(normal.normalize())
            .to_degrees();
        assert!(off < 0.3, "node {number} is off by {off} degrees");
        let off = (Vec3::from_array(node.colour()) - (light / weight).map(srgb_from_linear)).abs();
        assert!(
            off.max_element() < 1.0 / 126.0 + 1e-4 && off.y < 1.0 / 254.0 + 1e-4,
            "node {number} is off by {off}"
        );
    }
}

fn check(mesh: &Columns, tree: &Tree) {
    check_counts(mesh, tree);
    check_spheres(mesh, tree);
    check_cones(mesh, tree);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_mesh_has_a_sound_tree(mesh in any_mesh()) {
        check(&mesh, &mesh.tree());
    }
}

#[test]
fn no_triangle_is_no_node() {
    let none = Columns::default().tree();
    assert!(none.nodes.is_empty() && none.level_starts.is_empty());
    assert_eq!((none.first_leaf(), none.leaf_triangles().len()), (0, 0));
}

#[test]
fn one_triangle_is_root_and_leaf() {
    let corners = [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y];
    let mesh = Columns::bare(&corners, vec![[0, 1, 2]]);
    let tree = mesh.tree();
    check(&mesh, &tree);
    assert_eq!(
        (tree.nodes.len(), tree.level_starts.as_slice()),
        (1, [0].as_slice())
    );
    let root = tree.nodes[0];
    let (centre, radius) = sphere(&tree, root);
    assert!(centre.distance(DVec3::new(1.0, 0.5, 0.0)) < 1e-5);
    assert!((5.0_f64.sqrt() / 2.0..1.13).contains(&radius));
    assert_eq!(root.normal(), Vec3::Z);
    assert!(root.colour().iter().all(|level| (level - 0.5).abs() < 0.01));
}

#[test]
fn every_number_of_triangles_up_to_200() {
    for count in 1..200 {
        let mut mesh = sheet(10, 10);
        mesh.triangles.truncate(count);
        check(&mesh, &mesh.tree());
    }
}

#[test]
fn means_are_weighted_by_area() {
    let mut mesh = sheet(30, 20);
    for (number, position) in mesh.positions.iter_mut().enumerate() {
        position[2] = (number as f32 * 0.7).sin() * 0.4;
        position[0] *= position[0];
    }
    check_means(&mesh, &mesh.tree());
    mesh.normals = None;
    mesh.colours = None;
    check_means(&mesh, &mesh.tree());
}

#[test]
fn a_sphere_wound_inward_has_normals_outward() {
    let mesh = inward_sphere(64);
    let tree = mesh.tree();
    check(&mesh, &tree);
    let centre = |node: Node| tree.grid.position(node.place());
    for leaf in &tree.nodes[tree.first_leaf() as usize..] {
        assert!(leaf.normal().dot(centre(*leaf)) > 0.0);
    }
    // Sixteen to a node or so: those see a part of the sphere only.
    let [.., level, _, _] = tree.level_starts.as_slice() else {
        panic!("few levels")
    };
    for node in &tree.nodes[*level as usize..] {
        assert!(node.normal().dot(centre(*node)) > 0.5 && node.cone_code() != NO_CONE);
    }
    assert_eq!(tree.nodes[0].cone_code(), NO_CONE);
}

#[test]
fn triangles_without_area_do_not_widen_cones() {
    let mut mesh = sheet(20, 20);
    mesh.normals = None;
    let flat = mesh.tree();
    mesh.triangles
        .extend((0..100).map(|vertex| [vertex, vertex, vertex + 1]));
    for position in &mut mesh.positions {
        // In the plane x = 0: the normal that stands for none is not theirs.
        *position = [0.0, position[0], position[1], 0.0];
    }
    let tree = mesh.tree();
    check(&mesh, &tree);
    assert!(
        flat.nodes
            .iter()
            .all(|node| node.normal() == Vec3::Z && node.cone_code() < 20)
    );
    let root = tree.nodes[0];
    assert!(
        root.normal() == Vec3::X && root.cone_code() < 20,
        "{} {}",
        root.normal(),
        root.cone_code()
    );
}

#[test]
fn degenerate_meshes_have_sound_trees() {
    let point = Columns::bare(&[Vec3::splat(3.0)], vec![[0, 0, 0]; 70]);
    let line = Columns::bare(
        &[Vec3::ZERO, Vec3::X, Vec3::X * 2.0],
        vec![[0, 1, 2], [2, 1, 0], [0, 2, 2]],
    );
    let same = Columns::bare(&[Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]; 1000]);
    let both_sides = Columns::bare(
        &[Vec3::ZERO, Vec3::X, Vec3::Y],
        [[0, 1, 2], [0, 2, 1]].repeat(20),
    );
    let fan: Vec<Vec3> = (0..40_u8)
        .map(|at| Vec3::new(f32::from(at).cos(), f32::from(at).sin(), 0.0))
        .collect();
    let on_one_edge = Columns::bare(
        &[&[Vec3::Z, Vec3::NEG_Z], fan.as_slice()].concat(),
        (2..42).map(|at| [0, 1, at]).collect(),
    );
    let far: Vec<Vec3> = [9e36, -9e36, 1.0, 1e-30].map(Vec3::splat).to_vec();
    let far = Columns::bare(
        &far,
        vec![
            [0, 1, 2],
            [0, 1, 3],
            [2, 3, 3],
            [0, 0, 0],
            [1, 1, 1],
            [2, 2, 2],
        ],
    );
    let tiny: Vec<Vec3> = (0..30_u16)
        .map(|at| Vec3::new(1e-45, 2e-45, 3e-45) * f32::from(at % 7))
        .collect();
    let tiny = Columns::bare(&tiny, (0..28).map(|at| [at, at + 1, at + 2]).collect());
    for mesh in [point, line, same, both_sides, on_one_edge, far, tiny] {
        check(&mesh, &mesh.tree());
    }
}

#[test]
fn the_tree_does_not_depend_on_threads_or_blocks() {
    let mut mesh = inward_sphere(200);
    let one = mesh.tree_on(1);
    check_counts(&mesh, &one);
    check_spheres(&mesh, &one);
    for threads in [0, 2, 3, 7] {
        assert!(mesh.tree_on(threads) == one, "{threads} threads");
    }
    mesh.block_size = 1000;
    assert!(mesh.tree() == one);
}

#[test]
fn a_million_slivers() {
    let mesh = slivers(1_000_000);
    let tree = mesh.tree();
    assert_eq!(tree.nodes.len(), 1_349_525);
    check_counts(&mesh, &tree);
    check_spheres(&mesh, &tree);
}

#[test]
fn progress_rises_to_the_end_on_the_calling_thread() {
    let mesh = sheet(150, 150);
    let caller = std::thread::current().id();
    let mut fractions = vec![];
    let built = mesh.with(|mesh| {
        build(mesh, 2, &mut |fraction, stage| {
            assert!(std::thread::current().id() == caller && !stage.is_empty());
            fractions.push(fraction);
            true
        })
    });
    assert!(built.is_ok());
    assert_eq!(
        (fractions.first(), fractions.last()),
        (Some(&0.0), Some(&1.0))
    );
    assert!(fractions.is_sorted(), "{fractions:?}");
}

#[test]
fn a_cancelled_build_ends_within_a_tenth_of_a_second() {
    let mesh = slivers(300_000);
    for after in [0_u64, 5, 30, 60, 90] {
        let start = Instant::now();
        let mut refused = None;
        let built = mesh.with(|mesh| {
            build(mesh, 2, &mut |_, _| {
                if start.elapsed() >= Duration::from_millis(after) {
                    assert_eq!(refused, None, "asked again after a no");
                    refused = Some(start.elapsed());
                }
                refused.is_none()
            })
        });
        let Some(refused) = refused else { continue };
        assert_eq!(built, Err(BuildError::Cancelled));
        let late = start.elapsed().saturating_sub(refused);
        // Twice the promise: other tests run beside this one.
        assert!(late < Duration::from_millis(200), "{late:?}");
    }
}

#[test]
fn vertices_that_are_not_there_are_named() {
    let mut mesh = sheet(100, 100);
    mesh.triangles[19_000][1] = 10_201;
    mesh.triangles[500][2] = 10_202;
    let message = |mesh: &Columns| {
        let built = mesh.with(|mesh| build(mesh, 2, &mut |_, _| true));
        built.expect_err("an unsound mesh").to_string()
    };
    assert!(
        message(&mesh)
            .starts_with("triangle 500: has the vertex 10202, but the mesh has 10201 vertices")
    );
    let mut mesh = sheet(100, 100);
    mesh.positions[7][1] = f32::NAN;
    assert!(
        message(&mesh).contains("its vertex 7 lies at [7.0, NaN, 0.0]"),
        "{}",
        message(&mesh)
    );
    mesh.positions[7][1] = f32::INFINITY;
    assert!(message(&mesh).contains("inf"));
    // Vertices of no triangle may lie anywhere.
    mesh.triangles.retain(|triangle| !triangle.contains(&7));
    check_spheres(&mesh, &mesh.tree());
}
