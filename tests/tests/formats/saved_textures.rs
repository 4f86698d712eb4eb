//! Textures go into PLY files and come back: the pictures, and every triangle's place on them.

use std::path::Path;

use anyhow::{Context as _, Result, ensure};
use glam::{DAffine3, DVec3};
use image::{ImageFormat, Rgb, RgbImage};
use pointstage_scene::edit::merge;
use pointstage_scene::{
    Block, Geometry, Job, Loaded, Loaders, NO_PICTURE, Object, PlyEncoding, SaveFormat, Saved, save,
};
use pointstage_tests::loaders::first_party;
use serde_json::json;

use crate::kept_textures::{CORNERS, placed, textures};
use crate::meshes::{colours, lines};
use crate::textures::{LIBRARY, SQUARE, encoded, glb, halves, load};

const ENCODINGS: [PlyEncoding; 3] = [
    PlyEncoding::LittleEndian,
    PlyEncoding::BigEndian,
    PlyEncoding::Ascii,
];

fn save_ply(object: &Object, path: &Path, encoding: PlyEncoding) -> Result<Saved> {
    Ok(save(object, path, SaveFormat::Ply(encoding), &Job::new())?)
}

/// Textured files of all formats: name, loader.
fn write_files(folder: &Path) -> Result<[(&'static str, &'static str); 3]> {
    let at = |name: &str| folder.join(name);
    let wood = encoded(&halves(64), ImageFormat::Png)?;
    std::fs::write(at("square.obj"), SQUARE)?;
    std::fs::write(at("square.mtl"), LIBRARY)?;
    std::fs::create_dir(at("maps"))?;
    std::fs::write(at("maps/my wood.png"), &wood)?;
    std::fs::write(at("wood.png"), &wood)?;
    std::fs::write(at("corners.ply"), CORNERS)?;
    // A factor that the picture does not know of.
    let material = json!({"pbrMetallicRoughness": {
        "baseColorTexture": {"index": 0}, "baseColorFactor": [0.5, 0.25, 1.0, 1.0],
    }});
    std::fs::write(at("a.glb"), glb(&wood, &material))?;
    Ok([
        ("square.obj", "obj"),
        ("corners.ply", "ply"),
        ("a.glb", "gltf"),
    ])
}

/// Compares everything that a file holds.
fn check_same(found: &Geometry, expected: &Geometry) -> Result<()> {
    ensure!(found.triangles == expected.triangles, "other triangles");
    for (found, expected) in found.blocks.iter().zip(&expected.blocks) {
        let columns = |block: &Block| (block.position_radius.clone(), block.colour.clone());
        ensure!(columns(found) == columns(expected), "other surfels");
        ensure!(found.named == expected.named, "other named columns");
    }
    let (found, expected) = (textures(found)?, textures(expected)?);
    let bytes = |textures: &pointstage_scene::Textures| -> Vec<_> {
        let pictures = textures.pictures.iter();
        pictures.map(|picture| picture.bytes.clone()).collect()
    };
    ensure!(bytes(found) == bytes(expected), "other pictures");
    ensure!(found.of_triangle == expected.of_triangle, "other places");
    let pairs = found.uvs.iter().zip(expected.uvs.iter());
    for ((found, expected), picture) in pairs.zip(expected.of_triangle.iter()) {
        // 1 − v is exact to half a step of floats below 1.
        let values = found.as_flattened().iter().zip(expected.as_flattened());
        let is_same = values.clone().all(|(a, b)| (a - b).abs() <= f32::EPSILON);
        ensure!(
            *picture == NO_PICTURE || is_same,
            "{found:?}, not {expected:?}"
        );
    }
    Ok(())
}

#[test]
fn a_saved_ply_file_has_the_textures_of_every_format() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    for (file, loader) in write_files(folder.path())? {
        for how in ["vertices", "divide"] {
            let object = load(&loaders, &folder.path().join(file), loader, how)?.object;
            for encoding in ENCODINGS {
                let what = format!("{file}, {how}, {encoding:?}");
                let new = tempfile::tempdir()?;
                let path = new.path().join("saved.ply");
                let saved = save_ply(&object, &path, encoding)?;
                ensure!(
                    saved.warnings.is_empty(),
                    "{what}: {}",
                    lines(&saved.warnings)
                );
                assert_eq!(saved.pictures, [new.path().join("saved.png")], "{what}");
                // Whatever the loader would make of the pictures, all is as it was.
                let back = load(&loaders, &path, "ply", "divide")?;
                ensure!(
                    back.warnings.is_empty(),
                    "{what}: {}",
                    lines(&back.warnings)
                );
                check_same(&back.object.geometry, &object.geometry)
                    .with_context(|| what.clone())?;
                assert!(placed(&back.object.geometry)? > 0, "{what}");
            }
        }
    }
    Ok(())
}

#[test]
fn several_pictures_and_faces_without_one_are_told_apart() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let at = |name: &str| folder.path().join(name);
    let loaders = first_party()?;
    write_files(folder.path())?;
    let first = load(&loaders, &at("square.obj"), "obj", "vertices")?.object;
    let blue = RgbImage::from_pixel(4, 4, Rgb([0, 0, 255]));
    std::fs::write(at("wood.png"), encoded(&blue, ImageFormat::Jpeg)?)?;
    let second = load(&loaders, &at("corners.ply"), "ply", "vertices")?.object;
    let both = merge(&[&first, &second], "both")?;
    let path = at("both.ply");
    let saved = save_ply(&both, &path, PlyEncoding::LittleEndian)?;
    assert_eq!(saved.pictures, [at("both.png"), at("both.jpg")]);
    let back = load(&loaders, &path, "ply", "divide")?.object.geometry;
    check_same(&back, &both.geometry)?;
    assert_eq!(*textures(&back)?.of_triangle, [0, 0, 1, 1, NO_PICTURE]);

    // Mirrored, triangles are turned round, and each corner has its own place still.
    let mut mirrored = first.clone();
    mirrored.world_from_object = DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
    save_ply(&mirrored, &path, PlyEncoding::Ascii)?;
    let back = load(&loaders, &path, "ply", "vertices")?.object.geometry;
    assert_eq!(placed(&back)?, 2);
    let triangles = |geometry: &Geometry| geometry.triangles.clone().context("triangles");
    let turned: Vec<_> = triangles(&first.geometry)?
        .iter()
        .map(|&[a, b, c]| [a, c, b])
        .collect();
    assert_eq!(*triangles(&back)?, *turned);
    Ok(())
}

fn reload(loaders: &Loaders, path: &Path) -> Result<Loaded> {
    load(loaders, path, "ply", "vertices")
}

#[test]
fn colours_are_taken_anew_from_a_picture_that_was_changed() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let at = |name: &str| folder.path().join(name);
    let loaders = first_party()?;
    write_files(folder.path())?;
    let object = load(&loaders, &at("a.glb"), "gltf", "vertices")?.object;
    save_ply(&object, &at("b.ply"), PlyEncoding::LittleEndian)?;
    let before = colours(&reload(&loaders, &at("b.ply"))?);
    // Red, by half as light.
    assert_eq!(before[3], [188, 0, 0]);
    let blue = RgbImage::from_pixel(4, 4, Rgb([0, 0, 255]));
    std::fs::write(at("b.png"), encoded(&blue, ImageFormat::Png)?)?;
    assert_eq!(colours(&reload(&loaders, &at("b.ply"))?)[3], [0, 0, 255]);
    // Without the picture they are those of the file.
    std::fs::remove_file(at("b.png"))?;
    let without = reload(&loaders, &at("b.ply"))?;
    assert_eq!(colours(&without), before);
    let said = lines(&without.warnings);
    assert!(said.contains("'b.png' cannot be read"), "{said}");
    Ok(())
}

#[test]
fn a_file_of_a_pictures_name_stays_and_sfl_says_what_it_lacks() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let at = |name: &str| folder.path().join(name);
    let loaders = first_party()?;
    write_files(folder.path())?;
    std::fs::write(at("square.png"), b"somebody's own")?;
    let object = load(&loaders, &at("square.obj"), "obj", "vertices")?.object;
    for _ in 0..2 {
        let saved = save_ply(&object, &at("square.ply"), PlyEncoding::LittleEndian)?;
        assert_eq!(saved.pictures, [at("square_2.png")]);
    }
    assert_eq!(std::fs::read(at("square.png"))?, b"somebody's own");
    let back = load(&loaders, &at("square.ply"), "ply", "vertices")?.object;
    check_same(&back.geometry, &object.geometry)?;

    // What stops leaves no picture.
    let job = Job::new();
    job.cancel();
    let format = SaveFormat::Ply(PlyEncoding::Ascii);
    assert!(save(&object, &at("no folder/a.ply"), format, &Job::new()).is_err());
    assert!(save(&object, &at("stopped.ply"), format, &job).is_err());
    std::fs::create_dir(at("taken.ply"))?;
    assert!(save(&object, &at("taken.ply"), format, &Job::new()).is_err());
    assert!(!at("stopped.png").exists() && !at("taken.png").exists());

    let saved = save(&object, &at("square.sfl"), SaveFormat::Sfl, &Job::new())?;
    let said = lines(&saved.warnings);
    assert!(said.contains("SFL files hold no textures"), "{said}");
    Ok(())
}
