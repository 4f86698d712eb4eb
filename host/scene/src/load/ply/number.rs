//! Numbers from text: fast for what files hold, exact for all.
//!
//! Everything is read as f64. A column of f32 rounds a second time, which gives another f32 than rounding once only for
//! numbers of more than 15 digits that lie within 2⁻⁵³ of the middle between two; what prints an f32 never writes one.

pub(super) use pointstage_plugin_api::lines::{scan_f64, scan_i64};

/// Reads a decimal number, correctly rounded to f64; also `nan`, `inf`, and what Microsoft's C library prints for them.
pub(in crate::load) fn parse_f64(word: &[u8]) -> Option<f64> {
    match scan_f64(word) {
        Some((value, length)) if length == word.len() => Some(value),
        _ => parse_slowly(word),
    }
}

#[cold]
fn parse_slowly(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    if let Ok(value) = text.parse() {
        return Some(value);
    }
    // 1.#INF, -1.#IND, 1.#QNAN, and -nan(ind)
    let lower = text.to_ascii_lowercase();
    let special = lower.trim_start_matches(['-', '+']);
    if special.starts_with("1.#inf") {
        return Some(if lower.starts_with('-') {
            f64::NEG_INFINITY
        } else {
            f64::INFINITY
        });
    }
    (special.starts_with("1.#") || special.starts_with("nan(")).then_some(f64::NAN)
}

/// Reads an integer; a number with a fraction is cut, one out of range saturates.
pub(super) fn parse_i64(word: &[u8]) -> Option<i64> {
    match scan_i64(word) {
        Some((value, length)) if length == word.len() => Some(value),
        _ => parse_f64(word)
            .filter(|value| !value.is_nan())
            .map(|value| value as i64),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn usual_and_odd_spellings_are_read() {
        for (word, expected) in [
            ("0", 0.0),
            ("-0.0378297", -0.037_829_7),
            (".5", 0.5),
            ("5.", 5.0),
            ("+7e-2", 0.07),
            ("1E3", 1000.0),
            (
                "123456789012345678901234567890",
                123_456_789_012_345_678_901_234_567_890.0,
            ),
            ("1e400", f64::INFINITY),
            ("4.9406564584124654e-324", 5e-324),
            ("-inf", f64::NEG_INFINITY),
            ("1.#INF", f64::INFINITY),
        ] {
            assert_eq!(parse_f64(word.as_bytes()), Some(expected), "{word}");
        }
        for word in ["nan", "-nan", "NaN", "1.#QNAN", "-1.#IND", "-nan(ind)"] {
            assert!(
                parse_f64(word.as_bytes()).is_some_and(f64::is_nan),
                "{word}"
            );
        }
    }

    #[test]
    fn what_is_no_number_is_refused() {
        for word in [
            "", "-", ".", "e5", "1e", "1e+", "1.2.3", "0x10", "12a", "1,5", "--1", "\u{663}",
        ] {
            assert_eq!(parse_f64(word.as_bytes()), None, "{word:?}");
        }
    }

    #[test]
    fn integers_may_have_a_point_and_saturate() {
        assert_eq!(parse_i64(b"-12"), Some(-12));
        assert_eq!(parse_i64(b"3.0"), Some(3));
        assert_eq!(parse_i64(b"99999999999999999999"), Some(i64::MAX));
        assert_eq!((parse_i64(b"nan"), parse_i64(b"")), (None, None));
    }

    proptest! {
        #[test]
        fn every_f64_is_read_back_exactly(value in proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL) {
            prop_assert_eq!(parse_f64(format!("{value}").as_bytes()), Some(value));
            prop_assert_eq!(parse_f64(format!("{value:e}").as_bytes()), Some(value));
        }

        #[test]
        fn short_decimals_equal_the_standard_library(text in "-?[0-9]{1,9}\\.[0-9]{0,9}(e-?[0-9]{1,2})?") {
            prop_assert_eq!(parse_f64(text.as_bytes()), text.parse().ok());
        }

        #[test]
        fn any_spelling_equals_the_standard_library(
            text in "[-+]?[0-9]{0,24}(\\.[0-9]{0,24})?([eE][-+]?[0-9]{0,6})?|[-+]?(inf|nan|infinity)",
        ) {
            let ours = parse_f64(text.as_bytes()).map(f64::to_bits);
            prop_assert_eq!(ours, text.parse().ok().map(f64::to_bits));
        }

        #[test]
        fn integers_equal_the_standard_library(value: i64, short in -999_999..999_999_i64) {
            for value in [value, short, value >> 20] {
                // 19 digits go by way of f64, like a number that has a point.
                let expected = if value.unsigned_abs() < 1_000_000_000_000_000_000 { value } else { value as f64 as i64 };
                prop_assert_eq!(parse_i64(value.to_string().as_bytes()), Some(expected));
            }
        }

        #[test]
        fn every_f32_is_read_back_exactly(value in proptest::num::f32::NORMAL | proptest::num::f32::SUBNORMAL) {
            prop_assert_eq!(parse_f64(value.to_string().as_bytes()).map(|read| read as f32), Some(value));
        }

        #[test]
        fn arbitrary_words_never_panic(word: Vec<u8>) {
            let _ = (parse_f64(&word), parse_i64(&word));
        }
    }
}
