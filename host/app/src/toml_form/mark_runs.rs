//! Which surfels of an object are selected, as text.

use std::io::{Read as _, Write as _};
use std::sync::Arc;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use pointstage_scene::Marks;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The most text that a session keeps of an object's selection, bytes: half the largest file that is read back. Runs that take
/// it hold tens of millions of surfels.
const MOST_BYTES: usize = 8 << 20;

/// The longest text of plain numbers, bytes; what takes more is packed.
const MOST_PLAIN_BYTES: usize = 4 << 10;

/// Begins packed text.
const PACKED: &str = "packed ";

/// The most bytes that packed text is unpacked to: runs of one surfel each, of the largest object that anybody selects in by hand.
const MOST_UNPACKED_BYTES: u64 = 1 << 28;

/// Lengths of runs of surfels, in turns not selected and selected, from the object's first surfel on; what comes after them is
/// not selected.
///
/// A few are text with spaces between: `"120 30 7 1"`. Many are the word `packed` and base 64 of a zlib stream of the same numbers,
/// each in bytes of 7 bits from the lowest on, all but its last with the highest bit set (unsigned LEB128).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct MarkRuns(Vec<usize>);

impl MarkRuns {
    /// The runs of an object's marks; none, and a line in the log, if they are too many for a file.
    pub(crate) fn of(marks: Option<&Arc<Marks>>, object: &str) -> Self {
        let runs = Self(marks.map_or_else(Vec::new, |marks| marks.runs()));
        if runs.0.len() > MOST_BYTES || runs.text().len() > MOST_BYTES {
            tracing::warn!(
                "{object}: the selected surfels lie in {} runs, too many for a session file; they are not kept in it",
                runs.0.len() / 2
            );
            return Self::default();
        }
        runs
    }

    /// Whether nothing is selected.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The marks in an object of so many surfels; none, and a line in the log, if they are of a larger one.
    pub(crate) fn marks(&self, surfel_count: usize, object: &str) -> Option<Arc<Marks>> {
        let marks = Marks::from_runs(&self.0, surfel_count);
        if marks.is_none() {
            tracing::warn!(
                "{object}: the session's selected surfels go beyond its {surfel_count} surfels; the file has changed, select again"
            );
        }
        marks.filter(|marks| !marks.is_empty()).map(Arc::new)
    }

    fn text(&self) -> String {
        // Two bytes a number at least.
        if self.0.len() <= MOST_PLAIN_BYTES / 2 {
            let lengths: Vec<String> = self.0.iter().map(usize::to_string).collect();
            let text = lengths.join(" ");
            if text.len() <= MOST_PLAIN_BYTES {
                return text;
            }
        }
        format!("{PACKED}{}", BASE64_STANDARD.encode(packed(&self.0)))
    }
}

/// Numbers as a zlib stream of LEB128.
fn packed(numbers: &[usize]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(numbers.len());
    for number in numbers {
        let mut rest = *number;
        while rest >= 0x80 {
            bytes.push((rest & 0x7f) as u8 | 0x80);
            rest >>= 7;
        }
        bytes.push(rest as u8);
    }
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    // Memory takes all that is written.
    let written = encoder.write_all(&bytes);
    debug_assert!(written.is_ok(), "{written:?}");
    encoder.finish().unwrap_or_default()
}

/// The numbers of a zlib stream of LEB128; what is wrong with it otherwise.
fn unpacked(stream: &[u8]) -> Result<Vec<usize>, String> {
    let mut bytes = Vec::new();
    ZlibDecoder::new(stream)
        .take(MOST_UNPACKED_BYTES)
        .read_to_end(&mut bytes)
        .map_err(|error| error.to_string())?;
    let (mut numbers, mut number, mut shift) = (Vec::new(), 0_usize, 0);
    for byte in bytes {
        let bits = usize::from(byte & 0x7f);
        number |= bits
            .checked_shl(shift)
            .filter(|value| value >> shift == bits)
            .ok_or("a number is too large")?;
        shift += 7;
        if byte < 0x80 {
            numbers.push(number);
            (number, shift) = (0, 0);
        }
    }
    if shift > 0 {
        return Err("it ends within a number".to_owned());
    }
    Ok(numbers)
}

impl Serialize for MarkRuns {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.text())
    }
}

impl<'de> Deserialize<'de> for MarkRuns {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        if let Some(base64) = text.strip_prefix(PACKED) {
            let numbers = BASE64_STANDARD
                .decode(base64.trim())
                .map_err(|error| error.to_string())
                .and_then(|stream| unpacked(&stream));
            return numbers.map(Self).map_err(|error| {
                D::Error::custom(format!(
                    "selected_surfels: the packed runs are damaged ({error}); delete the line, and select again"
                ))
            });
        }
        let lengths = text.split_ascii_whitespace().map(|word| {
            word.parse().map_err(|_| {
                D::Error::custom(format!(
                    "selected_surfels: expected lengths of runs such as \"120 30\", found '{word}'"
                ))
            })
        });
        lengths.collect::<Result<_, _>>().map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[derive(Serialize, Deserialize)]
    struct Kept {
        selected_surfels: MarkRuns,
    }

    /// Through a file.
    fn again(runs: MarkRuns) -> Result<MarkRuns, toml::de::Error> {
        let kept = Kept {
            selected_surfels: runs,
        };
        let text = toml::to_string(&kept).expect("text");
        toml::from_str::<Kept>(&text).map(|kept| kept.selected_surfels)
    }

    fn read(text: &str) -> Result<MarkRuns, String> {
        let read = toml::from_str::<Kept>(&format!("selected_surfels = '{text}'"));
        read.map(|kept| kept.selected_surfels)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn marks_come_back_unless_the_object_has_become_smaller() {
        let marks = Arc::new(Marks::from_fn(50, |surfel| surfel % 7 > 4));
        let runs = MarkRuns::of(Some(&marks), "object");
        assert_eq!(runs.marks(50, "object"), Some(Arc::clone(&marks)));
        assert!(runs.text().starts_with("5 2 5 2"), "{}", runs.text());
        assert_eq!(runs.marks(40, "object"), None);
        assert!(MarkRuns::of(None, "object").is_empty());
        assert_eq!(MarkRuns::default().marks(9, "object"), None);
    }

    #[test]
    fn the_front_of_a_scan_in_no_order_is_kept() {
        // Every surfel is selected or not by chance: the most runs there can be, and the least that can be packed.
        let mut state = 1_u64;
        let marks = Marks::from_fn(8_000_000, |_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005) + 1;
            state >> 63 == 1
        });
        let marks = Arc::new(marks);
        let runs = MarkRuns::of(Some(&marks), "object");
        assert!(runs.0.len() > 3_900_000);
        let text = runs.text();
        assert!(text.len() < 3 << 20, "{} bytes", text.len());
        assert_eq!(read(&text).unwrap().marks(8_000_000, "object"), Some(marks));
    }

    #[test]
    fn what_would_fill_the_file_is_not_kept() {
        let marks = Marks::from_fn(MOST_BYTES * 2, |surfel| surfel % 2 == 1);
        assert!(MarkRuns::of(Some(&Arc::new(marks)), "object").is_empty());
    }

    #[test]
    fn damaged_runs_say_so() {
        let encoded = |bytes: &[u8]| {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
            encoder.write_all(bytes).unwrap();
            format!(
                "packed {}",
                BASE64_STANDARD.encode(encoder.finish().unwrap())
            )
        };
        assert_eq!(read(&encoded(&[5, 0x82, 0x01])).unwrap().0, [5, 130]);
        for (text, said) in [
            ("12 x", "found 'x'"),
            ("packed !", "damaged"),
            ("packed AAAA", "damaged"),
            (&encoded(&[0x80]), "ends within a number"),
            (&encoded(&[0xff; 12]), "too large"),
        ] {
            let error = read(text).expect_err(text);
            assert!(error.contains(said), "{error}");
        }
    }

    proptest! {
        #[test]
        fn any_runs_come_back(runs in prop::collection::vec(any::<usize>(), 0..3000)) {
            let runs = MarkRuns(runs);
            prop_assert_eq!(again(runs.clone()).unwrap(), runs);
        }
    }
}
