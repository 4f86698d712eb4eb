//! Numbers at the start of a text: fast for what files hold, and exact.

/// Powers of ten that f64 holds exactly.
const EXACT_POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// Largest integer up to which f64 holds all.
const EXACT_INTEGER: u64 = 1 << 53;

/// The number at the start of `text` and the bytes it takes, for what nearly every number in a file looks like; `None` for
/// the rest, of which some are numbers too.
///
/// With a mantissa up to 2⁵³ and a power of ten up to 22 one multiplication or division of exact values rounds correctly
/// (Clinger, *How to Read Floating Point Numbers Accurately*, PLDI 1990).
#[inline]
pub fn scan_f64(text: &[u8]) -> Option<(f64, usize)> {
    let mut position = usize::from(matches!(text.first(), Some(b'-' | b'+')));
    let mut mantissa = 0_u64;
    let whole_digits = scan_digits(text, &mut position, &mut mantissa);
    let mut decimals = 0;
    if text.get(position) == Some(&b'.') {
        position += 1;
        decimals = scan_digits(text, &mut position, &mut mantissa);
    }
    // 19 digits fit into 64 bits.
    if !(1..=19).contains(&(whole_digits + decimals)) || mantissa > EXACT_INTEGER {
        return None;
    }
    let mut power = -(decimals as i32);
    if let Some(b'e' | b'E') = text.get(position) {
        position += 1;
        let negative = text.get(position) == Some(&b'-');
        position += usize::from(matches!(text.get(position), Some(b'-' | b'+')));
        let mut exponent = 0;
        if !(1..=4).contains(&scan_digits(text, &mut position, &mut exponent)) {
            return None;
        }
        power += if negative {
            -(exponent as i32)
        } else {
            exponent as i32
        };
    }
    let scale = *EXACT_POWERS.get(power.unsigned_abs() as usize)?;
    let magnitude = if power < 0 {
        mantissa as f64 / scale
    } else {
        mantissa as f64 * scale
    };
    Some((
        if text.first() == Some(&b'-') {
            -magnitude
        } else {
            magnitude
        },
        position,
    ))
}

/// The integer at the start of `text` and the bytes it takes; `None` unless it has 1 to 18 digits.
#[inline]
pub fn scan_i64(text: &[u8]) -> Option<(i64, usize)> {
    let negative = text.first() == Some(&b'-');
    let mut position = usize::from(negative);
    let mut magnitude = 0;
    // 18 digits fit into 63 bits.
    if !(1..=18).contains(&scan_digits(text, &mut position, &mut magnitude)) {
        return None;
    }
    let magnitude = magnitude as i64;
    Some((if negative { -magnitude } else { magnitude }, position))
}

/// Appends the digits at `position` to `value`, wrapping around, and passes over them; how many there were.
#[inline]
fn scan_digits(text: &[u8], position: &mut usize, value: &mut u64) -> usize {
    let start = *position;
    while let Some(digit) = text
        .get(*position)
        .map(|byte| byte.wrapping_sub(b'0'))
        .filter(|digit| *digit < 10)
    {
        *value = value.wrapping_mul(10).wrapping_add(u64::from(digit));
        *position += 1;
    }
    *position - start
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_scan_reads_the_number_and_no_more(value: f64, text in "[-+]?[0-9]{1,9}(\\.[0-9]{0,9})?", after in "([ \n\r\tx][ -~]*)?") {
            let value = if value.is_finite() { value } else { 0.5 };
            for word in [format!("{value}"), format!("{value:e}"), text] {
                if let Some((scanned, length)) = scan_f64(format!("{word}{after}").as_bytes()) {
                    prop_assert_eq!(length, word.len());
                    prop_assert_eq!(scanned.to_bits(), word.parse::<f64>().unwrap().to_bits());
                }
            }
        }

        #[test]
        fn whole_numbers_equal_the_standard_library(value: i64, after in "([ /\n\rx][ -~]*)?") {
            for value in [value, value >> 20, value >> 50] {
                if let Some((scanned, length)) = scan_i64(format!("{value}{after}").as_bytes()) {
                    prop_assert_eq!((scanned, length), (value, value.to_string().len()));
                }
            }
        }
    }
}
