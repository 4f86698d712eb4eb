//! Colours: item RGB12, version 2, and RGB14, version 3, which is the same in a layer of its own.

use super::decoder::Decoder;
use super::model::Symbols;

/// Bytes of a record.
pub(super) const BYTES: usize = 6;

/// Bit of a change that says that green or blue differs from red.
const IS_COLOURED: u8 = 1 << 6;

/// Models of colours. One is read in steps, so that another chunk's can go between.
pub(super) struct Colours {
    /// Lower and upper bytes of red, green, blue.
    last: [[u8; 2]; 3],
    next: [[u8; 2]; 3],
    change: u8,
    changes: Symbols,
    /// Of each byte, lower before upper.
    bytes: Box<[Symbols; BYTES]>,
}

impl Colours {
    pub(super) fn new() -> Self {
        let bytes = Symbols::new(256);
        Self {
            last: [[0; 2]; 3],
            next: [[0; 2]; 3],
            change: 0,
            changes: Symbols::new(128),
            bytes: Box::new(std::array::from_fn(|_| bytes.clone())),
        }
    }

    /// Begins a colour that is foretold from another.
    #[inline(always)]
    pub(super) fn read_change(&mut self, decoder: &mut Decoder<'_>, last: [u8; BYTES]) {
        let [a, b, c, d, e, f] = last;
        self.last = [[a, b], [c, d], [e, f]];
        self.next = self.last;
        self.change = decoder.foretold_symbol(&mut self.changes);
    }

    #[inline(always)]
    fn read(&mut self, decoder: &mut Decoder<'_>, byte: usize, foretold: u8) {
        if self.change & (1 << byte) != 0 {
            let difference = decoder.symbol(&mut self.bytes[byte]);
            self.next[byte / 2][byte % 2] = foretold.wrapping_add(difference);
        }
    }

    /// Reads the lower or upper (0 or 1) byte of red.
    #[inline(always)]
    pub(super) fn read_red(&mut self, decoder: &mut Decoder<'_>, half: usize) {
        self.read(decoder, half, self.last[0][half]);
        if self.change & IS_COLOURED == 0 {
            self.next[1][half] = self.next[0][half];
            self.next[2][half] = self.next[0][half];
        }
    }

    /// Reads the lower or upper byte of green, which mostly changes as red does.
    #[inline(always)]
    pub(super) fn read_green(&mut self, decoder: &mut Decoder<'_>, half: usize) {
        if self.change & IS_COLOURED != 0 {
            let foretold = self.last(1, half) + self.change_of(0, half);
            self.read(decoder, 2 + half, foretold.clamp(0, 255) as u8);
        }
    }

    /// Reads the lower or upper byte of blue, which mostly changes as red and green do.
    #[inline(always)]
    pub(super) fn read_blue(&mut self, decoder: &mut Decoder<'_>, half: usize) {
        if self.change & IS_COLOURED != 0 {
            let change = self.change_of(0, half).midpoint(self.change_of(1, half));
            let foretold = self.last(2, half) + change;
            self.read(decoder, 4 + half, foretold.clamp(0, 255) as u8);
        }
    }

    #[inline(always)]
    fn last(&self, channel: usize, half: usize) -> i32 {
        self.last[channel][half].into()
    }

    #[inline(always)]
    fn change_of(&self, channel: usize, half: usize) -> i32 {
        i32::from(self.next[channel][half]) - self.last(channel, half)
    }

    /// The colour that has been read.
    #[inline(always)]
    pub(super) fn colour(&self) -> [u8; BYTES] {
        let [[a, b], [c, d], [e, f]] = self.next;
        [a, b, c, d, e, f]
    }
}

/// Reads the bytes of a colour of each lane. `of` gives a lane's decoder and models, if its colours are compressed.
#[inline(always)]
pub(super) fn read_bytes<'a, L, const LANES: usize>(
    lanes: &mut [L; LANES],
    of: impl for<'l> Fn(&'l mut L) -> Option<(&'l mut Decoder<'a>, &'l mut Colours)> + Copy,
) {
    let is_same = |lane| of(lane).is_none_or(|(_, colours)| colours.change == 0);
    if lanes.iter_mut().all(is_same) {
        return;
    }
    each(lanes, of, |colours, stream| colours.read_red(stream, 0));
    each(lanes, of, |colours, stream| colours.read_red(stream, 1));
    each(lanes, of, |colours, stream| colours.read_green(stream, 0));
    each(lanes, of, |colours, stream| colours.read_blue(stream, 0));
    each(lanes, of, |colours, stream| colours.read_green(stream, 1));
    each(lanes, of, |colours, stream| colours.read_blue(stream, 1));
}

#[inline(always)]
fn each<'a, L, const LANES: usize>(
    lanes: &mut [L; LANES],
    of: impl for<'l> Fn(&'l mut L) -> Option<(&'l mut Decoder<'a>, &'l mut Colours)>,
    step: impl Fn(&mut Colours, &mut Decoder<'a>),
) {
    for lane in lanes {
        if let Some((decoder, colours)) = of(lane) {
            step(colours, decoder);
        }
    }
}
