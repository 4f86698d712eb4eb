//! Targets as OpenEXR: floats stay 32-bit floats, ids stay 32-bit whole numbers.

use std::io::Cursor;

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    WritableImage as _,
};
use pointstage_engine::stage::Plane;

/// Why a target has no EXR form.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ExrError {
    /// The values do not fill the picture.
    #[error("target '{key}' holds {found} values where {expected} fill the picture")]
    Length {
        /// The target.
        key: String,
        /// Values that the picture has.
        expected: usize,
        /// Values that there are.
        found: usize,
    },
    /// The library refused.
    #[error("the picture cannot be encoded as EXR: {0}")]
    Encode(#[from] exr::error::Error),
}

/// The bytes of an EXR file with one layer named `key`, losslessly compressed.
///
/// Channels: `R G B A` for four floats a pixel, `X Y Z` for three, `Z` for depth, else the key.
pub(crate) fn encode(
    key: &str,
    [width, height]: [u32; 2],
    plane: &Plane,
) -> Result<Vec<u8>, ExrError> {
    let pixel_count = width as usize * height as usize;
    let (names, samples) = match plane {
        Plane::Float { channels, values } => {
            let names = channel_names(key, *channels as usize);
            check_length(key, pixel_count * names.len(), values.len())?;
            let samples: Vec<FlatSamples> = (0..names.len())
                .map(|channel| {
                    let of_channel = values.iter().skip(channel).step_by(names.len());
                    FlatSamples::F32(of_channel.copied().collect())
                })
                .collect();
            (names, samples)
        }
        Plane::Uint(values) => {
            check_length(key, pixel_count, values.len())?;
            (
                vec![key.to_owned()],
                vec![FlatSamples::U32(values.to_vec())],
            )
        }
    };
    let channels = names
        .iter()
        .zip(samples)
        .map(|(name, samples)| AnyChannel::new(name.as_str(), samples))
        .collect();
    let layer = Layer::new(
        (width as usize, height as usize),
        LayerAttributes::named(key),
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(channels),
    );
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes)?;
    Ok(bytes.into_inner())
}

fn channel_names(key: &str, count: usize) -> Vec<String> {
    let fixed: &[&str] = match (key, count) {
        ("depth", 1) => &["Z"],
        (_, 3) => &["X", "Y", "Z"],
        (_, 4) => &["R", "G", "B", "A"],
        (_, 1) => &[key],
        _ => &[],
    };
    if fixed.is_empty() {
        return (0..count.max(1))
            .map(|channel| format!("{key}.{channel}"))
            .collect();
    }
    fixed.iter().map(|&name| name.to_owned()).collect()
}

fn check_length(key: &str, expected: usize, found: usize) -> Result<(), ExrError> {
    if expected == found {
        return Ok(());
    }
    Err(ExrError::Length {
        key: key.to_owned(),
        expected,
        found,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::{ReadChannels as _, ReadLayers as _};

    fn channels_of(bytes: Vec<u8>) -> Vec<(String, FlatSamples)> {
        let image = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_buffered(Cursor::new(bytes))
            .expect("an EXR file");
        let list = image.layer_data.channel_data.list;
        list.into_iter()
            .map(|channel| (channel.name.to_string(), channel.sample_data))
            .collect()
    }

    #[test]
    fn ids_stay_whole_numbers() {
        let plane = Plane::Uint([0, 7, u32::MAX, 16_777_217].into());
        let bytes = encode("id", [2, 2], &plane).expect("encodes");
        let expected = FlatSamples::U32(vec![0, 7, u32::MAX, 16_777_217]);
        assert_eq!(channels_of(bytes), [("id".to_owned(), expected)]);
    }

    #[test]
    fn depth_is_channel_z_with_infinity_kept() {
        let plane = Plane::Float {
            channels: 1,
            values: [1.5, f32::INFINITY].into(),
        };
        let bytes = encode("depth", [2, 1], &plane).expect("encodes");
        let expected = FlatSamples::F32(vec![1.5, f32::INFINITY]);
        assert_eq!(channels_of(bytes), [("Z".to_owned(), expected)]);
    }

    #[test]
    fn interleaved_floats_come_apart_into_channels() {
        let plane = Plane::Float {
            channels: 4,
            values: [1.0, 2.0, 3.0, 4.0].into(),
        };
        let bytes = encode("normal", [1, 1], &plane).expect("encodes");
        let names: Vec<String> = channels_of(bytes)
            .into_iter()
            .map(|(name, _)| name)
            .collect();
        assert_eq!(names, ["A", "B", "G", "R"]);
    }

    #[test]
    fn a_plane_of_the_wrong_length_is_refused() {
        let plane = Plane::Uint([1].into());
        let error = encode("id", [2, 2], &plane).expect_err("too short");
        assert!(error.to_string().contains("'id' holds 1"), "{error}");
    }
}
