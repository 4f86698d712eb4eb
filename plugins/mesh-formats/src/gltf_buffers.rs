//! Buffers of glTF, and accessors whose values lie in them one behind the other.

use std::borrow::Cow;
use std::path::Path;

use gltf::accessor::{DataType, Dimensions};
use gltf::{Accessor, Document, Glb, Gltf, buffer};

/// The document of a file and its buffers.
pub(crate) struct Buffers<'f> {
    pub(crate) document: Document,
    all: Vec<Cow<'f, [u8]>>,
}

impl<'f> Buffers<'f> {
    /// Reads the document. The buffer inside a binary file is not copied; others are read by [`Buffers::import`].
    pub(crate) fn of_file(file: &'f [u8]) -> gltf::Result<(Document, Option<Cow<'f, [u8]>>)> {
        if file.starts_with(b"glTF") {
            let Glb { json, bin, .. } = Glb::from_slice(file)?;
            return Ok((Gltf::from_slice(&json)?.document, bin));
        }
        Ok((Gltf::from_slice(file)?.document, None))
    }

    /// Reads the buffers of the document of a file at `path`.
    pub(crate) fn import(
        document: Document,
        mut inside: Option<Cow<'f, [u8]>>,
        path: &Path,
    ) -> gltf::Result<Self> {
        let mut all = Vec::new();
        for buffer in document.buffers() {
            let bytes = match buffer.source() {
                buffer::Source::Bin => inside.take().ok_or(gltf::Error::MissingBlob)?,
                source @ buffer::Source::Uri(_) => {
                    Cow::Owned(buffer::Data::from_source(source, path.parent())?.0)
                }
            };
            if bytes.len() < buffer.length() {
                return Err(gltf::Error::BufferLength {
                    buffer: buffer.index(),
                    expected: buffer.length(),
                    actual: bytes.len(),
                });
            }
            all.push(bytes);
        }
        Ok(Self { document, all })
    }

    /// The bytes of the buffer of this index.
    pub(crate) fn get(&self, index: usize) -> Option<&[u8]> {
        self.all.get(index).map(|bytes| &**bytes)
    }

    /// The bytes of an accessor of this type, if they lie one behind the other and nothing takes the place of any.
    pub(crate) fn packed(
        &self,
        accessor: &Accessor<'_>,
        data_type: DataType,
        dimensions: Dimensions,
    ) -> Option<&[u8]> {
        let is_of_type = accessor.data_type() == data_type && accessor.dimensions() == dimensions;
        let view = accessor
            .view()
            .filter(|_| is_of_type && accessor.sparse().is_none())?;
        let size = accessor.size();
        if view.stride().is_some_and(|stride| stride != size) {
            return None;
        }
        let of_view = slice(
            self.get(view.buffer().index())?,
            view.offset(),
            view.length(),
        )?;
        slice(
            of_view,
            accessor.offset(),
            accessor.count().checked_mul(size)?,
        )
    }
}

fn slice(bytes: &[u8], start: usize, length: usize) -> Option<&[u8]> {
    bytes.get(start..start.checked_add(length)?)
}
