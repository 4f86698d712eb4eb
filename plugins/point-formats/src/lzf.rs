//! LZF, the compression of binary_compressed PCD files: M. Lehmann, liblzf.
//!
//! Behind a control byte below 32 stand literal bytes, one more than it says. Any other begins a copy of bytes written before:
//! its upper three bits are the length less 2 (if they are 7, a byte follows that is added), its lower five bits and the next
//! byte are the distance less 1.

/// Bytes unpacked between two looks at whether to go on: a few milliseconds.
const BYTES_A_PIECE: usize = 1 << 22;

/// Unpacks `packed` to exactly `length` bytes; `None` if it is damaged, or once `goes_on` says no.
pub(crate) fn unpack(packed: &[u8], length: usize, goes_on: impl Fn() -> bool) -> Option<Vec<u8>> {
    // The longest copy makes 264 bytes of 3, so a small file never takes much memory.
    if length / 88 > packed.len() {
        return None;
    }
    let mut out = Vec::with_capacity(length);
    let mut rest = packed;
    let mut next_look = BYTES_A_PIECE;
    while let Some((&control, tail)) = rest.split_first() {
        if control < 32 {
            let (literals, tail) = tail.split_at_checked(usize::from(control) + 1)?;
            out.extend_from_slice(literals);
            rest = tail;
        } else {
            let (mut copied, mut tail) = (usize::from(control >> 5), tail);
            if copied == 7 {
                let (&more, after) = tail.split_first()?;
                copied += usize::from(more);
                tail = after;
            }
            let (&low, after) = tail.split_first()?;
            let distance = (usize::from(control & 31) << 8 | usize::from(low)) + 1;
            let start = out.len().checked_sub(distance)?;
            for index in start..start + copied + 2 {
                // What is copied may be what this copy has just written.
                out.push(out[index]);
            }
            rest = after;
        }
        if out.len() > length {
            return None;
        }
        if out.len() > next_look {
            next_look += BYTES_A_PIECE;
            if !goes_on() {
                return None;
            }
        }
    }
    (out.len() == length).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_and_overlapping_copies_are_unpacked() {
        // "ab", then 8 bytes from 2 back, then 2 + 7 + 5 bytes from 1 back.
        let packed = [1, b'a', b'b', 0b110_00000, 1, 0b111_00000, 5, 0];
        let unpacked = unpack(&packed, 24, || true).expect("sound");
        assert_eq!(
            unpacked,
            b"ababababab"
                .iter()
                .chain(b"bbbbbbbbbbbbbb")
                .copied()
                .collect::<Vec<u8>>()
        );
    }

    #[test]
    fn what_is_damaged_gives_nothing() {
        for (packed, length) in [
            (&[5, 1, 2][..], 6),
            (&[0b001_00000, 9], 3),
            (&[0, 1], 2),
            (&[0, 1, 0, 2], 1),
            (&[0b111_00000], 9),
            (&[0, 1], 1 << 40),
        ] {
            assert_eq!(unpack(packed, length, || true), None, "{packed:?}");
        }
    }
}
