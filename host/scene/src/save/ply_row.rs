//! A row of a PLY file: values one behind the other, as bytes or as words.

use std::io::Write as _;

use crate::geometry::ScalarType;

/// How numbers are written in a PLY file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PlyEncoding {
    /// Binary, smallest byte first.
    #[default]
    LittleEndian,
    /// Binary, largest byte first.
    BigEndian,
    /// Words, with as many digits as it takes to read the same number again.
    Ascii,
}

impl PlyEncoding {
    /// What the header calls it.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::LittleEndian => "binary_little_endian",
            Self::BigEndian => "binary_big_endian",
            Self::Ascii => "ascii",
        }
    }
}

/// The row in the making.
pub(super) struct Row {
    encoding: PlyEncoding,
    bytes: Vec<u8>,
}

impl Row {
    pub(super) fn new(encoding: PlyEncoding) -> Self {
        Self {
            encoding,
            bytes: Vec::new(),
        }
    }

    /// Takes the row's bytes, with what ends it, and begins the next.
    pub(super) fn end(&mut self, out: &mut impl std::io::Write) -> std::io::Result<()> {
        if self.encoding == PlyEncoding::Ascii {
            // The last word's space becomes the end of the line.
            self.bytes.pop();
            self.bytes.push(b'\n');
        }
        out.write_all(&self.bytes)?;
        self.bytes.clear();
        Ok(())
    }

    pub(super) fn push_u8(&mut self, value: u8) {
        self.push(ScalarType::U8, [value]);
    }

    pub(super) fn push_u32(&mut self, value: u32) {
        self.push(ScalarType::U32, value.to_ne_bytes());
    }

    pub(super) fn push_i32(&mut self, value: i32) {
        self.push(ScalarType::I32, value.to_ne_bytes());
    }

    pub(super) fn push_f64(&mut self, value: f64) {
        self.push(ScalarType::F64, value.to_ne_bytes());
    }

    pub(super) fn push_f32s(&mut self, values: &[f32]) {
        for value in values {
            self.push(ScalarType::F32, value.to_ne_bytes());
        }
    }

    /// Adds values of one type, given as bytes in the machine's order.
    pub(super) fn push_values(&mut self, scalar: ScalarType, bytes: &[u8]) {
        for value in bytes.chunks_exact(scalar.size()) {
            let mut word = [0; 8];
            word[..value.len()].copy_from_slice(value);
            match *value {
                [a] => self.push(scalar, [a]),
                [a, b] => self.push(scalar, [a, b]),
                [a, b, c, d] => self.push(scalar, [a, b, c, d]),
                _ => self.push(scalar, word),
            }
        }
    }

    fn push<const N: usize>(&mut self, scalar: ScalarType, value: [u8; N]) {
        let mut ordered = value;
        match self.encoding {
            PlyEncoding::Ascii => return self.push_word(scalar, &value),
            PlyEncoding::LittleEndian if cfg!(target_endian = "big") => ordered.reverse(),
            PlyEncoding::BigEndian if cfg!(target_endian = "little") => ordered.reverse(),
            PlyEncoding::LittleEndian | PlyEncoding::BigEndian => {}
        }
        self.bytes.extend(ordered);
    }

    fn push_word(&mut self, scalar: ScalarType, value: &[u8]) {
        // An f32 read as an f64 would get digits that it does not have.
        let single = match (scalar, value) {
            (ScalarType::F32, &[a, b, c, d]) => Some(f32::from_ne_bytes([a, b, c, d])),
            _ => None,
        };
        let written = match (single, scalar.read(value)) {
            (Some(single), _) => write!(self.bytes, "{single} "),
            (None, Some(double)) => write!(self.bytes, "{double} "),
            (None, None) => Ok(()),
        };
        written.expect("memory takes everything");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(encoding: PlyEncoding) -> Vec<u8> {
        let mut row = Row::new(encoding);
        row.push_f32s(&[0.1, -0.0]);
        row.push_u8(7);
        row.push_values(ScalarType::I16, &(-2_i16).to_ne_bytes());
        row.push_f64(1e-9);
        let mut out = Vec::new();
        row.end(&mut out).expect("memory takes everything");
        out
    }

    #[test]
    fn words_have_the_digits_that_tell_numbers_apart() {
        assert_eq!(row(PlyEncoding::Ascii), b"0.1 -0 7 -2 0.000000001\n");
    }

    #[test]
    fn the_orders_of_bytes_mirror_each_other() {
        let (little, big) = (row(PlyEncoding::LittleEndian), row(PlyEncoding::BigEndian));
        assert_eq!(little.len(), 4 + 4 + 1 + 2 + 8);
        assert_eq!(&little[..4], &0.1_f32.to_le_bytes());
        assert_eq!(&big[..4], &0.1_f32.to_be_bytes());
        assert_eq!(&big[9..11], &(-2_i16).to_be_bytes());
        assert_eq!(&big[11..], &1e-9_f64.to_be_bytes());
    }
}
