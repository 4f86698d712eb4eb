//! The pictures of a glTF file: inside its buffers, in its text, or beside it.

use std::path::Path;

use gltf::image;
use pointstage_texels::{Alpha, Picture, read_beside};

use crate::data_url;
use crate::gltf_buffers::Buffers;

/// The picture of a source.
pub(crate) fn read_picture(
    source: &image::Source<'_>,
    file: &Path,
    buffers: &Buffers<'_>,
    alpha: Alpha,
) -> std::result::Result<Picture, String> {
    let decode = |name: &str, bytes: Vec<u8>| {
        Picture::of_file(name, bytes, alpha).map_err(|error| error.to_string())
    };
    match source {
        image::Source::View { view, .. } => {
            let end = view.offset().checked_add(view.length());
            let bytes = buffers
                .get(view.buffer().index())
                .zip(end)
                .and_then(|(buffer, end)| buffer.get(view.offset()..end));
            decode("", bytes.ok_or("it lies outside its buffer")?.to_vec())
        }
        image::Source::Uri { uri, .. } if data_url::is(uri) => {
            let bytes = data_url::bytes(uri).ok_or("its data URL cannot be decoded")?;
            decode("", bytes)
        }
        image::Source::Uri { uri, .. } => {
            let name = data_url::percent_decoded(uri);
            let name = String::from_utf8_lossy(&name);
            let bytes = read_beside(file, &name).map_err(|error| error.to_string())?;
            decode(&name, bytes)
        }
    }
}

/// What a warning calls a source.
pub(crate) fn name_of(source: &image::Source<'_>) -> String {
    match source {
        image::Source::Uri { uri, .. } if !data_url::is(uri) => format!("'{uri}'"),
        image::Source::Uri { .. } | image::Source::View { .. } => "inside the file".to_owned(),
    }
}
