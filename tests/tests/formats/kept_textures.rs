//! Pictures of textures stay with the object, and so do the triangles' places on them, whatever is done to the triangles.

use std::sync::Arc;

use anyhow::{Context as _, Result, ensure};
use glam::DVec3;
use image::{ImageFormat, Rgb, RgbImage};
use pointstage_scene::edit::{extract, merge};
use pointstage_scene::{
    Geometry, Job, LoadOptions, Loaded, LoaderChoice, Marks, NO_PICTURE, PlyEncoding, Textures,
    Winding, load_with, write_ply,
};
use pointstage_tests::loaders::first_party;
use serde_json::json;

use crate::meshes::lines;
use crate::textures::{LIBRARY, SQUARE, encoded, glb, halves, load};

/// A square whose corners lie on a picture, and a triangle on one that is not there.
pub(crate) const CORNERS: &str = "\
ply
format ascii 1.0
comment TextureFile there is none.png
comment TextureFile wood.png
element vertex 7
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
property list uchar float texcoord
property int texnumber
end_header
0 0 0
1 0 0
1 1 0
0 1 0
2 0 0
3 0 0
3 1 0
4 0 1 2 3 8 0 0 1 0 1 1 0 1 1
3 4 5 6 6 0 0 0 0 0 0 0
";

/// The same square with texture coordinates of vertices.
const ROWS: &str = "\
ply
format ascii 1.0
comment TextureFile wood.png
element vertex 4
property float x
property float y
property float z
property float u
property float v
element face 2
property list uchar int vertex_indices
end_header
0 0 0 0 0
1 0 0 1 0
1 1 0 1 1
0 1 0 0 1
3 0 1 2
3 0 2 3
";

/// How many triangles lie on a picture; each at (x, 1 − y).
pub(crate) fn placed(geometry: &Geometry) -> Result<usize> {
    let textures = textures(geometry)?;
    let triangles = geometry.triangles.as_deref().context("no triangles")?;
    ensure!(textures.of_triangle.len() == triangles.len());
    ensure!(textures.uvs.len() == triangles.len());
    let mut count = 0;
    for ((triangle, uvs), picture) in triangles
        .iter()
        .zip(textures.uvs.iter())
        .zip(textures.of_triangle.iter())
    {
        if *picture == NO_PICTURE {
            continue;
        }
        ensure!((*picture as usize) < textures.pictures.len());
        count += 1;
        for (corner, uv) in triangle.iter().zip(uvs) {
            let at = geometry.centre(*corner as usize).context("no corner")?;
            let expected = [at.x, 1.0 - at.y].map(|value| value as f32);
            let is_there = (0..2).all(|axis| (uv[axis] - expected[axis]).abs() < 1e-5);
            ensure!(is_there, "{at} has {uv:?}");
        }
    }
    Ok(count)
}

pub(crate) fn textures(geometry: &Geometry) -> Result<&Arc<Textures>> {
    geometry.textures.as_ref().context("no textures")
}

/// Loads the file and looks whether `count` of its triangles lie on the picture `file`, called `name`.
fn check(loaded: &Loaded, name: &str, file: &[u8], count: usize) -> Result<()> {
    let geometry = &loaded.object.geometry;
    let pictures = &textures(geometry)?.pictures;
    ensure!(pictures.len() == 1, "{pictures:?}");
    assert_eq!((&*pictures[0].name, pictures[0].extension()), (name, "png"));
    assert_eq!(&*pictures[0].bytes, file);
    assert_eq!(placed(geometry)?, count, "{}", lines(&loaded.warnings));
    Ok(())
}

#[test]
fn every_format_with_textures_keeps_them() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let at = |name: &str| folder.path().join(name);
    let loaders = first_party()?;
    let wood = encoded(&halves(64), ImageFormat::Png)?;
    std::fs::write(at("square.obj"), SQUARE)?;
    std::fs::write(at("square.mtl"), LIBRARY)?;
    std::fs::create_dir(at("maps"))?;
    std::fs::write(at("maps/my wood.png"), &wood)?;
    std::fs::write(at("wood.png"), &wood)?;
    std::fs::write(at("corners.ply"), CORNERS)?;
    std::fs::write(at("rows.ply"), ROWS)?;
    let material = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    std::fs::write(at("a.glb"), glb(&wood, &material))?;

    for (file, loader, name) in [
        ("square.obj", "obj", "maps\\my wood.png"),
        ("corners.ply", "ply", "wood.png"),
        ("rows.ply", "ply", "wood.png"),
        ("a.glb", "gltf", ""),
    ] {
        let path = at(file);
        let plain = load(&loaders, &path, loader, "vertices")?;
        check(&plain, name, &wood, 2).with_context(|| file.to_owned())?;
        let divided = load(&loaders, &path, loader, "divide")?;
        let triangles = divided.object.geometry.triangle_count();
        assert!(triangles > 900, "{file}: {triangles}");
        // One of them names a picture that is not there.
        let without = usize::from(file == "corners.ply");
        check(&divided, name, &wood, triangles - without).with_context(|| file.to_owned())?;
        let none = load(&loaders, &path, loader, "none")?;
        assert!(none.object.geometry.textures.is_none(), "{file}");
        // Flipped, each corner has its own place.
        let options = LoadOptions {
            winding: Winding::Flipped,
            loader: Some(LoaderChoice {
                loader: loader.to_owned(),
                settings: [].into(),
            }),
            ..LoadOptions::default()
        };
        let flipped = load_with(&loaders, &path, &options, &Job::new())?;
        assert_eq!(placed(&flipped.object.geometry)?, triangles - without);
    }
    Ok(())
}

#[test]
fn parts_and_unions_keep_their_textures() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let at = |name: &str| folder.path().join(name);
    let loaders = first_party()?;
    std::fs::write(at("rows.ply"), ROWS)?;
    std::fs::write(at("wood.png"), encoded(&halves(64), ImageFormat::Png)?)?;
    let square = load(&loaders, &at("rows.ply"), "ply", "vertices")?.object;
    std::fs::write(at("plain.ply"), ROWS.replace("TextureFile", ""))?;
    let plain = load(&loaders, &at("plain.ply"), "ply", "vertices")?.object;
    assert!(plain.geometry.textures.is_none());
    let blue = encoded(
        &RgbImage::from_pixel(4, 4, Rgb([0, 0, 255])),
        ImageFormat::Png,
    )?;
    std::fs::write(at("wood.png"), blue)?;
    let second = load(&loaders, &at("rows.ply"), "ply", "vertices")?.object;

    let marks = Marks::from_fn(4, |surfel| surfel != 1);
    let part = extract(&square.geometry, &marks, &Job::new())?;
    assert_eq!((part.triangle_count(), placed(&part)?), (1, 1));

    let union = merge(&[&square, &plain, &second], "all")?.geometry;
    assert_eq!(union.triangle_count(), 6);
    assert_eq!(placed(&union)?, 4);
    let kept = textures(&union)?;
    assert_eq!(*kept.of_triangle, [0, 0, NO_PICTURE, NO_PICTURE, 1, 1]);
    let files = |geometry: &Geometry| textures(geometry).map(|textures| textures.pictures.clone());
    let expected = [files(&square.geometry)?, files(&second.geometry)?].concat();
    assert_eq!(kept.pictures, expected);
    let union = merge(&[&plain, &plain], "none")?.geometry;
    assert!(union.textures.is_none());

    // Mirrored, an object has its triangles turned, and each corner its own place still.
    let mut mirrored = square.clone();
    mirrored.world_from_object = glam::DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
    let union = merge(&[&square, &mirrored], "both")?.geometry;
    assert_eq!(placed(&union)?, 4);

    let warnings = write_ply(&square, PlyEncoding::Ascii, &Job::new(), &mut Vec::new())?;
    assert!(
        lines(&warnings).contains("textures are left out"),
        "{}",
        lines(&warnings)
    );
    Ok(())
}
