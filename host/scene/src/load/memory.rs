//! Memory for columns, in large pages where the system has them.
//!
//! A page of 4 KB costs a microsecond or two when it is first touched, which for a large cloud is more than reading it; one of
//! 2 MB costs little more. The advice must come before the first touch, so the memory is taken without being written, and
//! those who fill it write it first, on all cores.

use std::mem::MaybeUninit;
use std::sync::Arc;

use bytemuck::Zeroable;
use bytes::{Bytes, BytesMut};
use rayon::prelude::*;

/// Bytes that are worth more threads than one.
pub(crate) const MANY_BYTES: usize = 1 << 19;

/// A slice of zeros that nobody else has yet.
pub(crate) fn zeroed_slice<T: Zeroable + Send + Sync>(length: usize) -> Arc<[T]> {
    const PART: usize = 1 << 16;
    let fill = |_: usize, _: &mut [T]| Ok::<(), std::convert::Infallible>(());
    match filled_slice(length, PART, fill, |(), ()| ()) {
        Ok((slice, ())) => slice,
        Err(never) => match never {},
    }
}

/// A slice that is filled in parts of `part` values at most, on all cores: `fill` gets the number of a part and its values,
/// which are zeros, and what it returns is joined by `merge`, in any order.
///
/// # Errors
/// One of those of `fill`.
pub(crate) fn filled_slice<T, S, E>(
    length: usize,
    part: usize,
    fill: impl Fn(usize, &mut [T]) -> Result<S, E> + Sync,
    merge: impl Fn(S, S) -> S + Sync,
) -> Result<(Arc<[T]>, S), E>
where
    T: Zeroable + Send + Sync,
    S: Default + Send,
    E: Send,
{
    let mut slice = uninit_slice(length);
    let slots = Arc::get_mut(&mut slice).expect("just made, nobody else has it");
    let summary = fill_uninit(slots, part, fill, merge)?;
    #[allow(unsafe_code, reason = "there is no safe way to fill memory in parts")]
    // SAFETY: `fill_uninit` has written every value, or it would have returned an error.
    let slice = unsafe { slice.assume_init() };
    Ok((slice, summary))
}

/// The same as bytes.
///
/// # Errors
/// One of those of `fill`.
pub(crate) fn filled_bytes<S, E>(
    length: usize,
    part: usize,
    fill: impl Fn(usize, &mut [u8]) -> Result<S, E> + Sync,
    merge: impl Fn(S, S) -> S + Sync,
) -> Result<(Bytes, S), E>
where
    S: Default + Send,
    E: Send,
{
    let mut bytes = room(length);
    let slots = &mut bytes.spare_capacity_mut()[..length];
    let summary = fill_uninit(slots, part, fill, merge)?;
    #[allow(unsafe_code, reason = "there is no safe way to fill memory in parts")]
    // SAFETY: the capacity is at least `length`, and `fill_uninit` has written every one of those bytes.
    unsafe {
        bytes.set_len(length);
    }
    Ok((bytes.freeze(), summary))
}

/// A slice of which nothing has been touched, and that nobody else has yet.
pub(crate) fn uninit_slice<T>(length: usize) -> Arc<[MaybeUninit<T>]> {
    let mut slice = Arc::new_uninit_slice(length);
    if let Some(slots) = Arc::get_mut(&mut slice) {
        prefer_large_pages(slots);
    }
    slice
}

/// Zeros each part and gives it to `fill`; every value has been written when it returns without an error.
fn fill_uninit<T, S, E>(
    slots: &mut [MaybeUninit<T>],
    part: usize,
    fill: impl Fn(usize, &mut [T]) -> Result<S, E> + Sync,
    merge: impl Fn(S, S) -> S + Sync,
) -> Result<S, E>
where
    T: Zeroable + Send,
    S: Default + Send,
    E: Send,
{
    let parts = slots.par_chunks_mut(part.max(1)).enumerate();
    let filled = parts.map(|(number, slots)| {
        for slot in &mut *slots {
            slot.write(T::zeroed());
        }
        #[allow(unsafe_code, reason = "there is no safe way to fill memory in parts")]
        // SAFETY: the loop above has written every value.
        let values = unsafe { slots.assume_init_mut() };
        fill(number, values)
    });
    filled.try_reduce(S::default, |a, b| Ok(merge(a, b)))
}

/// Room for so many bytes, of which none has been touched.
pub(crate) fn room(capacity: usize) -> BytesMut {
    let mut bytes = BytesMut::with_capacity(capacity);
    prefer_large_pages(bytes.spare_capacity_mut());
    bytes
}

/// Copies a slice to the room behind the bytes that are there, on all cores if it is long. What does not fit there makes them
/// move.
pub(crate) fn append(to: &mut BytesMut, from: &[u8]) {
    /// Bytes copied by one thread at a time.
    const SEGMENT: usize = 1 << 17;
    let length = to.len() + from.len();
    if from.len() < MANY_BYTES || to.capacity() < length {
        to.extend_from_slice(from);
        return;
    }
    let slots = &mut to.spare_capacity_mut()[..from.len()];
    let segments = slots.par_chunks_mut(SEGMENT).zip(from.par_chunks(SEGMENT));
    segments.for_each(|(to, from)| {
        to.write_copy_of_slice(from);
    });
    #[allow(unsafe_code, reason = "there is no safe way to fill memory in parts")]
    // SAFETY: the capacity is at least `length`, and the segments, of two slices of one length, have written all bytes from
    // the old length to it.
    unsafe {
        to.set_len(length);
    }
}

/// Asks the system to back memory that has not been touched yet by large pages.
fn prefer_large_pages<T>(memory: &mut [T]) {
    #[cfg(target_os = "linux")]
    {
        /// Memory that is worth it, bytes.
        const LARGE: usize = 4 << 20;
        // What a large page would reach beyond is not asked for; whole ones are aligned to pages of any size.
        const LARGE_PAGE: usize = 2 << 20;
        let range = memory.as_mut_ptr_range();
        let start = range.start.addr().next_multiple_of(LARGE_PAGE);
        let end = range.end.addr() / LARGE_PAGE * LARGE_PAGE;
        if size_of_val(memory) < LARGE || start >= end {
            return;
        }
        #[allow(unsafe_code, reason = "the advice is a call of the system")]
        // SAFETY: the range lies within memory that is borrowed mutably, and the advice changes none of its bytes, only the
        // size of the pages that hold them.
        let advised = unsafe {
            libc::madvise(
                range.start.with_addr(start).cast(),
                end - start,
                libc::MADV_HUGEPAGE,
            )
        };
        // Without large pages, which a system need not have, it takes longer and is as right.
        let _ = advised;
    }
    #[cfg(not(target_os = "linux"))]
    let _ = memory;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_are_zeros_in_large_pages_too() {
        for length in [0, 7, 300_000, 3_000_001] {
            let mut slice: Arc<[[u32; 2]]> = zeroed_slice(length);
            assert_eq!(slice.len(), length);
            assert!(slice.iter().all(|value| *value == [0; 2]), "{length}");
            let slots = Arc::get_mut(&mut slice).expect("nobody else has it");
            slots.fill([7, 9]);
            assert!(slice.iter().all(|value| *value == [7, 9]), "{length}");
            let fill = |number: usize, part: &mut [u8]| {
                assert!(part.iter().all(|byte| *byte == 0));
                part.fill(number as u8);
                Ok::<usize, ()>(part.len())
            };
            let (bytes, sum) = filled_bytes(length, 1000, fill, |a, b| a + b).expect("no error");
            assert_eq!((bytes.len(), sum), (length, length));
            let is_right = |(index, byte): (usize, &u8)| *byte == (index / 1000) as u8;
            assert!(bytes.iter().enumerate().all(is_right), "{length}");
        }
    }
}
