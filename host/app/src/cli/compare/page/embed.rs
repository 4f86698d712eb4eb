//! Pictures as data URLs, so that the page is one file: exact as long as they fit, compressed where they would not.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use base64::Engine as _;
use image::imageops::FilterType;
use jpeg_encoder::{ColorType, Encoder, SamplingFactor};

use crate::cli::Outcome;

/// Bytes of all pictures that a page may have: a third more in base64, and the page stays below 15 MB.
const MOST_BYTES: usize = 10_500_000;

/// What a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// What a renderer drew.
    Picture,
    /// Where it is wrong, or another target.
    Map,
}

/// How pictures of one kind are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    /// The PNG file without its texts.
    Exact,
    /// JPEG of this quality (1..100), each side divided.
    Jpeg { quality: u8, divisor: u32 },
}

/// From the best to the smallest: forms of pictures and of maps.
const RUNGS: [[Form; 2]; 7] = [
    [Form::Exact, Form::Exact],
    [Form::Exact, jpeg(88, 1)],
    [jpeg(92, 1), jpeg(85, 1)],
    [jpeg(85, 1), jpeg(75, 1)],
    [jpeg(85, 2), jpeg(80, 2)],
    [jpeg(80, 4), jpeg(75, 4)],
    [jpeg(70, 8), jpeg(70, 8)],
];

const fn jpeg(quality: u8, divisor: u32) -> Form {
    Form::Jpeg { quality, divisor }
}

/// The pictures of a page.
pub(super) struct Pictures {
    /// Data URLs, by the name that the report has for the file.
    urls: BTreeMap<String, String>,
    /// What was done to them, in a sentence.
    pub(super) note: String,
}

impl Pictures {
    /// Reads files and makes them fit; the best forms that do are taken.
    ///
    /// * `files`: a file's name in the report, where it is, and what it shows.
    pub(super) fn of(files: &[(String, PathBuf, Kind)]) -> Outcome<Self> {
        Self::within(MOST_BYTES, files)
    }

    fn within(most_bytes: usize, files: &[(String, PathBuf, Kind)]) -> Outcome<Self> {
        let mut found = None;
        for forms in RUNGS {
            let encoded = encode_all(files, forms)?;
            let bytes: usize = encoded.iter().map(Encoded::len).sum();
            let is_enough = bytes <= most_bytes;
            found = Some((forms, encoded));
            if is_enough {
                break;
            }
        }
        // There is at least one rung.
        let (forms, encoded) = found.context("no form for pictures")?;
        let names = files.iter().map(|(name, ..)| name.clone());
        Ok(Self {
            urls: names.zip(encoded.iter().map(Encoded::url)).collect(),
            note: note(forms),
        })
    }

    /// The data URL of a file; empty for one that is not there.
    pub(super) fn url(&self, name: &str) -> &str {
        self.urls.get(name).map_or("", String::as_str)
    }
}

/// A picture's bytes and what they are.
struct Encoded {
    mime: &'static str,
    bytes: Vec<u8>,
}

impl Encoded {
    fn len(&self) -> usize {
        self.bytes.len()
    }

    fn url(&self) -> String {
        let data = base64::engine::general_purpose::STANDARD.encode(&self.bytes);
        format!("data:{};base64,{data}", self.mime)
    }
}

fn note([pictures, maps]: [Form; 2]) -> String {
    let words = |form| match form {
        Form::Exact => "exact".to_owned(),
        Form::Jpeg { quality, divisor } => {
            let size = match divisor {
                1 => String::new(),
                divisor => format!(" and 1/{divisor} of the size"),
            };
            format!("JPEG of quality {quality}{size}")
        }
    };
    if [pictures, maps] == [Form::Exact, Form::Exact] {
        return "Pictures and maps in this page are exact.".to_owned();
    }
    format!(
        "To keep this page small, pictures in it are {}, and maps are {}; the exact ones are the files beside it. All numbers \
         were measured on the exact ones.",
        words(pictures),
        words(maps)
    )
}

/// Encodes all files, on all threads.
fn encode_all(
    files: &[(String, PathBuf, Kind)],
    [pictures, maps]: [Form; 2],
) -> Outcome<Vec<Encoded>> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let share = files.len().div_ceil(threads).max(1);
    let encode_share = |files: &[(String, PathBuf, Kind)]| -> anyhow::Result<Vec<Encoded>> {
        let encoded = files.iter().map(|(_, path, kind)| {
            let form = match kind {
                Kind::Picture => pictures,
                Kind::Map => maps,
            };
            encode(path, form)
        });
        encoded.collect()
    };
    std::thread::scope(|scope| {
        let shares: Vec<_> = files
            .chunks(share)
            .map(|share| scope.spawn(move || encode_share(share)))
            .collect();
        let mut all = Vec::new();
        for share in shares {
            let encoded = share.join().map_err(|_| {
                anyhow::anyhow!("a picture could not be encoded; please report this")
            })?;
            all.extend(encoded?);
        }
        Ok(all)
    })
}

fn encode(path: &Path, form: Form) -> anyhow::Result<Encoded> {
    let unreadable = || format!("{}: the picture cannot be read again", path.display());
    let bytes = std::fs::read(path).with_context(unreadable)?;
    let Form::Jpeg { quality, divisor } = form else {
        let bytes = without_texts(&bytes).unwrap_or(bytes);
        let mime = "image/png";
        return Ok(Encoded { mime, bytes });
    };
    let picture = image::load_from_memory(&bytes).with_context(unreadable)?;
    let mut picture = picture.into_rgb8();
    if divisor > 1 {
        let [width, height] =
            [picture.width(), picture.height()].map(|side| side.div_ceil(divisor).max(1));
        picture = image::imageops::resize(&picture, width, height, FilterType::Triangle);
    }
    let sides = [picture.width(), picture.height()].map(u16::try_from);
    let [Ok(width), Ok(height)] = sides else {
        anyhow::bail!(
            "{}: a picture of {}×{} pixels is too large for a page; choose a smaller --size",
            path.display(),
            picture.width(),
            picture.height()
        );
    };
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, quality);
    // Colours in full: thin lines of maps would lose theirs.
    encoder.set_sampling_factor(SamplingFactor::F_1_1);
    encoder.set_optimized_huffman_tables(true);
    encoder.encode(picture.as_raw(), width, height, ColorType::Rgb)?;
    let mime = "image/jpeg";
    Ok(Encoded { mime, bytes })
}

/// A PNG file without what says how it was made: the page says so once. None if it is no PNG file.
fn without_texts(png: &[u8]) -> Option<Vec<u8>> {
    const SIGNATURE: usize = 8;
    /// Length and name before a chunk's content, checksum behind it.
    const AROUND: usize = 12;
    const KEPT: [&[u8]; 6] = [b"IHDR", b"PLTE", b"tRNS", b"sRGB", b"IDAT", b"IEND"];
    let (signature, mut rest) = png.split_at_checked(SIGNATURE)?;
    let mut kept = signature.to_vec();
    while !rest.is_empty() {
        let length = u32::from_be_bytes(rest.first_chunk().copied()?);
        let whole = usize::try_from(length).ok()?.checked_add(AROUND)?;
        let (chunk, after) = rest.split_at_checked(whole)?;
        if KEPT.contains(&chunk.get(4..8)?) {
            kept.extend(chunk);
        }
        rest = after;
    }
    Some(kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{Rgb, RgbImage};

    /// Noise, which no form makes small.
    fn noise(size: u32) -> RgbImage {
        let mut state = 1_u32;
        RgbImage::from_fn(size, size, |_, _| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            Rgb([(state >> 24) as u8, (state >> 16) as u8, (state >> 8) as u8])
        })
    }

    fn files(folder: &Path) -> Vec<(String, PathBuf, Kind)> {
        [("a.png", Kind::Picture), ("b.png", Kind::Map)]
            .map(|(name, kind)| {
                let path = folder.join(name);
                let rgba = image::DynamicImage::ImageRgb8(noise(64)).into_rgba8();
                let record = serde_json::json!({"secret": "x".repeat(3000)});
                let png = crate::output::png_file::encode([64, 64], &rgba, &record);
                std::fs::write(&path, png.expect("encodes")).expect("written");
                (name.to_owned(), path, kind)
            })
            .to_vec()
    }

    fn bytes_of(url: &str) -> Vec<u8> {
        let (_, data) = url.split_once("base64,").expect("a data URL");
        let bytes = base64::engine::general_purpose::STANDARD.decode(data);
        bytes.expect("base64")
    }

    fn decoded(url: &str) -> image::DynamicImage {
        image::load_from_memory(&bytes_of(url)).expect("a picture")
    }

    /// Width that a JPEG's frame header says, px: behind its marker, length, precision and height.
    fn jpeg_width(url: &str) -> Option<u16> {
        let bytes = bytes_of(url);
        let header = bytes.windows(9).find(|at| at.starts_with(&[0xFF, 0xC0]))?;
        header.last_chunk().copied().map(u16::from_be_bytes)
    }

    #[test]
    fn what_fits_is_exact_and_has_lost_its_texts() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let pictures = Pictures::of(&files(folder.path())).expect("encoded");
        let url = pictures.url("a.png");
        assert!(url.starts_with("data:image/png;base64,"));
        assert_eq!(decoded(url).into_rgb8(), noise(64));
        assert!(url.len() < 64 * 64 * 3 * 4 / 3 + 1000, "{}", url.len());
        assert_eq!(pictures.url("none.png"), "");
        assert!(pictures.note.contains("are exact"), "{}", pictures.note);
    }

    #[test]
    fn what_does_not_fit_is_compressed_maps_first_and_then_made_smaller() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let files = files(folder.path());
        let within = |bytes| Pictures::within(bytes, &files).expect("encoded");
        let maps = within(23_000);
        assert!(maps.url("a.png").starts_with("data:image/png"));
        assert!(maps.url("b.png").starts_with("data:image/jpeg"));
        assert!(maps.note.contains("maps are JPEG"), "{}", maps.note);
        let small = within(1);
        assert_eq!(jpeg_width(small.url("a.png")), Some(8));
        assert!(small.note.contains("1/8 of the size"), "{}", small.note);
    }

    #[test]
    fn a_lying_png_is_left_as_it_is() {
        assert_eq!(without_texts(b"short"), None);
        assert_eq!(without_texts(b"8 bytes \xff\xff\xff\xffIDAT"), None);
    }
}
