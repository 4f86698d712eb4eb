//! Decompression of LAZ, about twice as fast as by the crate `laz`, which damaged data could make panic or overflow its stack.
//!
//! A LAZ file is a row of chunks, each of which begins afresh: its first record lies there as it is, all others are differences
//! from what the records before foretell, packed by an adaptive arithmetic coder (Isenburg, *LASzip: lossless compression of LiDAR
//! data*, PE&RS 79(2), 2013). Such a coder is one long chain: each symbol narrows the interval in which the next is looked up, so
//! a processor waits most of the time. So each thread decompresses two chunks at once, in lockstep ([`lanes`]): the steps of one
//! fill the waits of the other, as long as no branch depends on what is read ([`decoder`], [`model`]).
//!
//! * [`table`]: the chunks of a file; [`layout`]: what its records consist of
//! * [`sharing`]: chunks to threads, and what comes of them in order; [`lanes`]: two at once on each thread
//! * [`chunked`]: one stream of all fields, of [`point10`], [`gps_time`], [`colour`] and [`wave`]; [`version1`]: of old files
//! * [`layered`]: a stream for each field of a point ([`point14`]), and of its [`colour`], [`infrared`] and [`wave`] ([`by_channel`])
//! * [`integer`], [`median`]: numbers and what foretells them
//! * [`model`], [`decoder`]: the arithmetic coder
//!
//! Bytes are the same as those of LASzip, also where it has oddities; the tests compare them with what the crate `laz` compresses.

#![allow(
    clippy::inline_always,
    reason = "the steps of two chunks run side by side only if they lie in one function"
)]

mod by_channel;
mod chunked;
mod colour;
mod decoder;
mod gps_time;
mod infrared;
mod integer;
mod lanes;
mod layered;
mod layout;
mod median;
mod model;
mod point10;
mod point14;
mod sharing;
mod table;
#[cfg(test)]
mod tests;
mod version1;
mod wave;

pub(crate) use lanes::Taker;
pub(crate) use sharing::{Ended, Limits};
pub(crate) use table::Chunks;
