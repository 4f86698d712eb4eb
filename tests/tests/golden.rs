//! Does the picture stay? Each first-party renderer draws each made scene and both samples as it did when a person
//! last looked. `cargo xtask bless` draws them anew.

use std::path::PathBuf;

use anyhow::{Result, bail};
use pointstage_tests::models::dented_mesh;
use pointstage_tests::render::Studio;
use pointstage_tests::{data, golden, scenes};

/// Another version of the CPU driver may round an edge the other way; a changed shape or light costs far more.
const LEAST_PSNR_DB: f64 = 38.0;

/// Draws every scene with `renderer` and `arguments` and compares with the golden images in `folder`; all failures are
/// told together.
fn check(folder: &str, renderer: &str, arguments: &[&str]) -> Result<()> {
    check_files(&scene_files()?, folder, renderer, arguments)
}

/// The same with scenes of its own: name, eye and file of each.
fn check_files(
    files: &[(&'static str, [f64; 3], PathBuf)],
    folder: &str,
    renderer: &str,
    arguments: &[&str],
) -> Result<()> {
    let mut failures = Vec::new();
    for (scene, eye, file) in files {
        let studio = Studio::new(*eye)?;
        let outcome = studio
            .render(file, renderer, arguments)
            .and_then(|rendering| golden::check(folder, scene, &rendering.picture, LEAST_PSNR_DB));
        if let Err(error) = outcome {
            failures.push(format!("{scene}: {error:#}"));
        }
    }
    if failures.is_empty() {
        Ok(())
    } else {
        bail!("{folder}\n{}", failures.join("\n"))
    }
}

/// Name, eye and file of each scene.
fn scene_files() -> Result<Vec<(&'static str, [f64; 3], PathBuf)>> {
    let folder = golden::output_folder().join("scenes");
    std::fs::create_dir_all(&folder)?;
    let made = [
        ("sphere", [1.5, 1.0, 2.6], scenes::sphere(3000, 1.0)),
        (
            "crossing_planes",
            [1.0, 1.2, 3.2],
            scenes::crossing_planes(40),
        ),
        ("grid", [0.9, 0.7, 1.6], scenes::grid(24)),
        ("ellipse", [0.3, 0.2, 3.2], scenes::ellipse()),
    ];
    let mut files = Vec::new();
    for (name, eye, surfels) in made {
        files.push((name, eye, scenes::write(&folder, name, &surfels)?));
    }
    files.push(("bust", [60.0, 20.0, 150.0], data::sample("bust_200k.ply")));
    files.push(("snake", [3.0, -6.0, 9.0], data::sample("knotted_snake.ply")));
    Ok(files)
}

#[test]
fn square_points_of_fixed_size_draw_as_before() -> Result<()> {
    check("points", "points", &[])
}

#[test]
fn round_points_of_the_surfels_size_draw_as_before() -> Result<()> {
    check(
        "points_round",
        "points",
        &["--set", "size_mode=attenuated", "--set", "shape=round"],
    )
}

#[test]
fn blended_splats_draw_as_before() -> Result<()> {
    check("hqss", "hqss", &[])
}

#[test]
fn the_reference_draws_as_before() -> Result<()> {
    check("ewa_reference", "ewa-reference", &[])
}

#[test]
fn disks_draw_as_before() -> Result<()> {
    check("surfel", "surfel", &[])
}

#[test]
fn hybrids_of_points_and_polygons_draw_as_before() -> Result<()> {
    let folder = golden::output_folder().join("scenes");
    std::fs::create_dir_all(&folder)?;
    let mut files = Vec::new();
    for (name, [rings, sides]) in [("fine", [200, 400]), ("coarse", [14, 24])] {
        let (vertices, triangles) = dented_mesh(rings, sides);
        let file = scenes::write_mesh(&folder, name, &vertices, &triangles)?;
        files.push((name, [1.5, 1.0, 2.6], file));
    }
    check_files(&files, "pop", "pop", &["--set", "threshold=3"])?;
    let coloured = ["--set", "threshold=3", "--set", "pop_colours=true"];
    check_files(&files, "pop_colours", "pop", &coloured)?;
    let blended = ["--set", "threshold=5", "--set", "splat=blended"];
    check_files(&files, "pop_blended", "pop", &blended)
}
