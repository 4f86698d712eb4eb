//! URIs of glTF: data URLs, and names with percent signs.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

/// Whether a URI holds what it names.
pub(crate) fn is(uri: &str) -> bool {
    uri.starts_with("data:")
}

/// What a data URL holds; `None` if it is not in base 64, or not soundly.
pub(crate) fn bytes(uri: &str) -> Option<Vec<u8>> {
    let (kind, content) = uri.strip_prefix("data:")?.split_once(',')?;
    kind.ends_with(";base64")
        .then(|| STANDARD.decode(content.trim()).ok())?
}

/// A URI with `%20` and its like as the bytes that they stand for.
pub(crate) fn percent_decoded(uri: &str) -> Vec<u8> {
    let mut decoded = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, behind @ ..] = rest {
        let digit = |index: usize| {
            let digit = behind.get(index)?;
            char::from(*digit).to_digit(16)
        };
        if let (b'%', Some(high), Some(low)) = (first, digit(0), digit(1)) {
            decoded.push((high * 16 + low) as u8);
            rest = &behind[2..];
        } else {
            decoded.push(*first);
            rest = behind;
        }
    }
    decoded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percent_signs_stand_for_bytes() {
        assert_eq!(percent_decoded("a%20b%c3%A4.png"), "a bä.png".as_bytes());
        assert_eq!(percent_decoded("100%.png%2"), b"100%.png%2");
    }

    #[test]
    fn data_urls_are_in_base_64() {
        assert!(is("data:image/png;base64,aGk=") && !is("data.png"));
        assert_eq!(bytes("data:image/png;base64,aGk="), Some(b"hi".to_vec()));
        for bad in ["data:image/png;base64,a!", "data:image/png,hi", "data:"] {
            assert_eq!(bytes(bad), None, "{bad}");
        }
    }
}
