//! What the renderers are measured by: one more renderer, or pictures that are there already.

use std::path::{Path, PathBuf};

use image::RgbImage;
use pointstage_engine::stage::{Background, Stage};
use pointstage_plugin_api::targets;

use super::arguments::ComparisonArguments;
use crate::cli::measuring::entries::Entry;
use crate::cli::{Failure, Outcome};
use crate::output::names;

/// Where the reference's pictures come from.
#[derive(Debug)]
pub(super) enum Reference {
    /// A renderer draws them.
    Renderer {
        /// Which.
        entry: Entry,
        /// Key of its target that says what it covers.
        silhouette: &'static str,
    },
    /// They are in a folder, under the names that a comparison gives them.
    Images {
        /// As it was named.
        folder: PathBuf,
        /// 8-bit sRGB; what differs from it is what they cover.
        background: [u8; 3],
    },
}

impl Reference {
    /// Looks up what the command line names.
    pub(super) fn find(stage: &Stage, arguments: &ComparisonArguments) -> Outcome<Self> {
        match (&arguments.reference, &arguments.reference_images) {
            (Some(text), None) => {
                let entry = Entry::find(stage, text)?;
                let silhouette = silhouette_target(stage, &entry)?;
                Ok(Self::Renderer { entry, silhouette })
            }
            (None, Some(folder)) => Ok(Self::Images {
                folder: folder.clone(),
                background: one_colour(arguments.look.background)?,
            }),
            _ => Err(Failure::usage(
                "a comparison needs one reference: --reference RENDERER, or --reference-images DIR",
            )),
        }
    }

    /// The renderer; none if there are pictures already.
    pub(super) fn entry(&self) -> Option<&Entry> {
        match self {
            Self::Renderer { entry, .. } => Some(entry),
            Self::Images { .. } => None,
        }
    }

    /// Fails if a picture is missing or of another size, before anything is drawn.
    pub(super) fn check_images(&self, count: usize, size_px: [u32; 2]) -> Outcome {
        let Self::Images { folder, .. } = self else {
            return Ok(());
        };
        (0..count).try_for_each(|index| {
            let path = image_path(folder, index, count);
            let (width, height) =
                image::image_dimensions(&path).map_err(|error| unreadable(&path, &error))?;
            if [width, height] == size_px {
                return Ok(());
            }
            Err(Failure::Failed(anyhow::anyhow!(
                "{}: the picture is {width}×{height}, expected {}×{} as the others are drawn; set --size",
                path.display(),
                size_px[0],
                size_px[1]
            )))
        })
    }
}

/// The reference's picture for a view.
pub(super) fn image_path(folder: &Path, index: usize, count: usize) -> PathBuf {
    folder.join(format!("reference_{}.png", names::number(index, count)))
}

/// Reads a picture that has no transparency.
pub(super) fn read_image(path: &Path) -> Outcome<RgbImage> {
    let picture = image::open(path)
        .map_err(|error| unreadable(path, &error))?
        .into_rgba8();
    if picture.pixels().any(|pixel| pixel[3] < 255) {
        return Err(Failure::Failed(anyhow::anyhow!(
            "{}: the picture has transparency, and pictures are compared over one opaque background; put one behind it",
            path.display()
        )));
    }
    Ok(image::DynamicImage::ImageRgba8(picture).into_rgb8())
}

/// The pixels of a picture that differ from the background.
pub(super) fn covered(picture: &RgbImage, background: [u8; 3]) -> Vec<bool> {
    picture
        .pixels()
        .map(|pixel| pixel.0 != background)
        .collect()
}

fn unreadable(path: &Path, error: &image::ImageError) -> Failure {
    Failure::Failed(anyhow::anyhow!(
        "{}: the reference's picture cannot be read: {error}; each view needs its picture in the folder, numbered from 000",
        path.display()
    ))
}

/// A background's colour in 8 bits.
fn one_colour(background: Background) -> Outcome<[u8; 3]> {
    match background {
        Background::Solid(colour) => Ok(colour.map(|channel| (channel * 255.0).round() as u8)),
        Background::Transparent | Background::Gradient(..) => Err(Failure::usage(
            "--reference-images needs a --background of one colour: what differs from it is what a picture covers",
        )),
    }
}

/// The target that says which pixels a renderer covers.
fn silhouette_target(stage: &Stage, entry: &Entry) -> Outcome<&'static str> {
    let given = stage
        .given_targets(&entry.id)
        .map_err(Failure::usage_from)?;
    let is_given = |key: &&str| given.iter().any(|spec| spec.key == *key);
    let found = [targets::ID, targets::DEPTH].into_iter().find(is_given);
    found.ok_or_else(|| {
        Failure::usage(format!(
            "renderer '{}' writes neither '{}' nor '{}', which say what a reference covers; choose another reference",
            entry.label,
            targets::ID,
            targets::DEPTH
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{Rgb, Rgba, RgbaImage};

    #[test]
    fn what_differs_from_the_background_is_covered() {
        let mut picture = RgbImage::from_pixel(2, 1, Rgb([255, 255, 254]));
        picture.put_pixel(0, 0, Rgb([255; 3]));
        assert_eq!(covered(&picture, [255; 3]), [false, true]);
        assert_eq!(one_colour(Background::Solid([1.0; 3])).ok(), Some([255; 3]));
        one_colour(Background::Gradient([0.0; 3], [1.0; 3])).expect_err("two colours");
    }

    #[test]
    fn a_picture_with_transparency_is_refused() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.png");
        let picture = RgbaImage::from_pixel(1, 1, Rgba([1, 2, 3, 254]));
        picture.save(&path).expect("written");
        match read_image(&path) {
            Err(Failure::Failed(error)) => {
                assert!(
                    error
                        .to_string()
                        .contains("a.png: the picture has transparency")
                );
            }
            other => panic!("{other:?}"),
        }
    }
}
