//! Targets as OpenEXR: floats stay 32-bit floats, ids stay 32-bit whole numbers.

use std::io::{BufWriter, Cursor, Seek, Write};

use exr::meta::header::ImageAttributes;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, IntegerBounds, Layer,
    LayerAttributes, Text, WritableImage as _,
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

/// The values of a target, channel by channel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LayerSamples {
    /// The target, and the layer's name.
    pub(crate) key: String,
    /// One for each of [`channel_names`], rows from the top.
    pub(crate) channels: Vec<FlatSamples>,
}

/// The bytes of an EXR file with one layer named `key`, losslessly compressed.
///
/// Channels: `R G B A` for four floats a pixel, `X Y Z` for three, `Z` for depth, else the key.
pub(crate) fn encode(key: &str, size_px: [u32; 2], plane: &Plane) -> Result<Vec<u8>, ExrError> {
    let [width, height] = size_px.map(|side| side as usize);
    let pixel_count = width * height;
    let channels = match plane {
        Plane::Float { channels, values } => {
            let count = *channels as usize;
            check_length(key, pixel_count * count, values.len())?;
            let of_channel = |channel| values.iter().skip(channel).step_by(count).copied();
            (0..count)
                .map(|channel| FlatSamples::F32(of_channel(channel).collect()))
                .collect()
        }
        Plane::Uint(values) => {
            check_length(key, pixel_count, values.len())?;
            vec![FlatSamples::U32(values.to_vec())]
        }
    };
    let layer = LayerSamples {
        key: key.to_owned(),
        channels,
    };
    let mut bytes = Cursor::new(Vec::new());
    write_layers(&mut bytes, size_px, vec![layer], None, |_| ())?;
    Ok(bytes.into_inner())
}

/// Writes an EXR file with a layer for each target, losslessly compressed; `on_progress` hears of 0..1.
///
/// `record` goes into the attribute `Pointstage` of the first layer: what the picture was made from, as JSON in ASCII.
pub(crate) fn write_layers(
    file: impl Write + Seek,
    [width, height]: [u32; 2],
    layers: Vec<LayerSamples>,
    record: Option<&serde_json::Value>,
    on_progress: impl FnMut(f64),
) -> Result<(), ExrError> {
    let size = (width as usize, height as usize);
    let mut record = record.map(ascii_json);
    let layers = layers.into_iter().map(|LayerSamples { key, channels }| {
        let names = channel_names(&key, channels.len());
        let channels = names
            .iter()
            .zip(channels)
            .map(|(name, samples)| AnyChannel::new(name.as_str(), samples))
            .collect();
        let mut attributes = LayerAttributes::named(key.as_str());
        attributes.software_name = Some(Text::from(concat!(
            "Pointstage ",
            env!("CARGO_PKG_VERSION")
        )));
        // Escaped, so that it has a form in EXR's alphabet.
        if let Some(text) = record.take().and_then(Text::new_or_none) {
            let value = AttributeValue::Text(text);
            attributes.other.insert(Text::from("Pointstage"), value);
        }
        let channels = AnyChannels::sort(channels);
        Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels)
    });
    let layers: Vec<_> = layers.collect();
    let attributes = ImageAttributes::new(IntegerBounds::from_dimensions(size));
    let image = Image::from_layers(attributes, layers);
    let mut file = BufWriter::new(file);
    image
        .write()
        .on_progress(on_progress)
        .to_buffered(&mut file)?;
    file.flush().map_err(exr::error::Error::from)?;
    Ok(())
}

/// JSON with everything beyond ASCII escaped.
fn ascii_json(value: &serde_json::Value) -> String {
    let mut text = String::new();
    for unit in value.to_string().encode_utf16() {
        match char::from_u32(unit.into()).filter(char::is_ascii) {
            Some(letter) => text.push(letter),
            None => text.extend(["\\u", &format!("{unit:04x}")]),
        }
    }
    text
}

/// Names of a target's channels.
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
    fn the_record_comes_back_whatever_letters_it_has() {
        let layer = |key: &str| LayerSamples {
            key: key.to_owned(),
            channels: vec![FlatSamples::U32(vec![7])],
        };
        let record = serde_json::json!({"file": "Büste 🗿.ply"});
        let mut bytes = Cursor::new(Vec::new());
        let layers = vec![layer("id"), layer("kind")];
        write_layers(&mut bytes, [1, 1], layers, Some(&record), |_| ()).expect("written");
        let image = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .from_buffered(Cursor::new(bytes.into_inner()))
            .expect("an EXR file");
        assert_eq!(image.layer_data.len(), 2);
        let value = &image.layer_data[0].attributes.other[&Text::from("Pointstage")];
        let AttributeValue::Text(text) = value else {
            panic!("{value:?} is no text")
        };
        let read: serde_json::Value = serde_json::from_str(&text.to_string()).expect("JSON");
        assert_eq!(read, record);
    }

    #[test]
    fn a_plane_of_the_wrong_length_is_refused() {
        let plane = Plane::Uint([1].into());
        let error = encode("id", [2, 2], &plane).expect_err("too short");
        assert!(error.to_string().contains("'id' holds 1"), "{error}");
    }
}
