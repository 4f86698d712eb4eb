//! Near infrared: the second part of the item RGBNIR14, version 3.

use super::decoder::Decoder;
use super::model::Symbols;

/// Bytes of a record.
pub(super) const BYTES: usize = 2;

/// Models of near infrared.
pub(super) struct Infrared {
    changes: Symbols,
    /// Of the lower and the upper byte.
    bytes: [Symbols; BYTES],
}

impl Infrared {
    pub(super) fn new() -> Self {
        let bytes = Symbols::new(256);
        Self {
            changes: Symbols::new(4),
            bytes: [bytes.clone(), bytes],
        }
    }

    /// Reads a value in place of the one before.
    pub(super) fn read(&mut self, decoder: &mut Decoder<'_>, value: &mut [u8; BYTES]) {
        let change = decoder.symbol(&mut self.changes);
        for (half, (model, byte)) in self.bytes.iter_mut().zip(value).enumerate() {
            if change & (1 << half) != 0 {
                *byte = byte.wrapping_add(decoder.symbol(model));
            }
        }
    }
}
