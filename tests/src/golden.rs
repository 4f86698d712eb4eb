//! Golden images: pictures that a person has looked at, `tests/golden/<renderer>/<scene>.png`.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use image::RgbaImage;

use crate::compare;
use crate::data;
use crate::program;

/// Holds `actual` against the golden image of `renderer` and `scene`.
///
/// When they are further apart than `least_psnr_db` dB, the actual picture and the difference are written to
/// `target/test-output/<renderer>/` and named in the error. With `POINTSTAGE_BLESS=1` in the environment the golden
/// image is written instead.
///
/// # Errors
/// When the picture is too far from the golden one, or there is none.
pub fn check(renderer: &str, scene: &str, actual: &RgbaImage, least_psnr_db: f64) -> Result<()> {
    let golden = data::repository()
        .join("tests/golden")
        .join(renderer)
        .join(format!("{scene}.png"));
    if std::env::var_os("POINTSTAGE_BLESS").is_some_and(|value| value == "1") {
        return write(actual, &golden);
    }
    check_against(
        &golden,
        actual,
        least_psnr_db,
        &output_folder().join(renderer),
        scene,
    )
}

/// Where tests leave pictures for a person to look at.
pub fn output_folder() -> PathBuf {
    program::target_folder().join("test-output")
}

/// Writes `picture` as PNG, with the folders on the way.
///
/// # Errors
/// When the file cannot be written.
pub fn write(picture: &RgbaImage, path: &Path) -> Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).with_context(|| format!("making {}", folder.display()))?;
    }
    picture
        .save(path)
        .with_context(|| format!("writing {}", path.display()))
}

fn check_against(
    golden: &Path,
    actual: &RgbaImage,
    least_psnr_db: f64,
    output: &Path,
    scene: &str,
) -> Result<()> {
    let actual_path = output.join(format!("{scene}_actual.png"));
    if !golden.exists() {
        write(actual, &actual_path)?;
        bail!(
            "there is no golden image {}; look at {} and run `cargo xtask bless`",
            golden.display(),
            actual_path.display()
        );
    }
    let expected = compare::read(golden)?;
    let difference = compare::compare(actual, &expected)?;
    if difference.psnr_db >= least_psnr_db {
        return Ok(());
    }
    let difference_path = output.join(format!("{scene}_difference.png"));
    write(actual, &actual_path)?;
    write(
        &compare::difference_image(actual, &expected)?,
        &difference_path,
    )?;
    bail!(
        "{difference}, expected at least {least_psnr_db} dB from {}; see {} and {}, and run `cargo xtask bless` if the \
         picture is right",
        golden.display(),
        actual_path.display(),
        difference_path.display()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    #[test]
    fn a_changed_picture_is_refused_and_its_difference_written() {
        let folder = tempfile::tempdir().unwrap();
        let golden = folder.path().join("golden.png");
        let old = RgbaImage::from_pixel(8, 8, Rgba([10, 20, 30, 255]));
        let new = RgbaImage::from_pixel(8, 8, Rgba([10, 60, 30, 255]));
        write(&old, &golden).unwrap();
        check_against(&golden, &old, 60.0, folder.path(), "same").unwrap();
        let error = check_against(&golden, &new, 40.0, folder.path(), "changed")
            .unwrap_err()
            .to_string();
        assert!(error.contains("expected at least 40 dB"), "{error}");
        assert!(folder.path().join("changed_difference.png").exists());
        assert!(!folder.path().join("same_actual.png").exists());
    }

    #[test]
    fn a_missing_golden_image_says_how_to_make_it() {
        let folder = tempfile::tempdir().unwrap();
        let picture = RgbaImage::new(2, 2);
        let missing = folder.path().join("none.png");
        let error = check_against(&missing, &picture, 40.0, folder.path(), "new")
            .unwrap_err()
            .to_string();
        assert!(error.contains("cargo xtask bless"), "{error}");
        assert!(folder.path().join("new_actual.png").exists());
    }
}
