//! GPS times: item GPSTIME11, version 2, and the times of POINT14, version 3, whose codes begin one later.

use super::decoder::Decoder;
use super::integer::Integers;
use super::model::{Symbols, WideSymbols};

/// Multiples of the last difference that have a code.
const MULTIPLES: i32 = 500;
/// Negative ones.
const LEAST: i32 = -10;
/// Times of other sequences before one comes; LASzip writes one at most, damaged data may switch for ever.
const MOST_SWITCHES: usize = 8;

/// Four sequences of times that are woven into each other.
pub(super) struct GpsTimes {
    last: usize,
    next: usize,
    times: [i64; 4],
    differences: [i32; 4],
    extremes: [u32; 4],
    multiples: WideSymbols,
    without_difference: Symbols,
    numbers: Integers,
    /// Whether there is a code for a time that stays.
    can_stay: bool,
}

impl GpsTimes {
    /// Times of the item GPSTIME11.
    pub(super) fn gps_time11(first: i64) -> Self {
        Self::new(first, true)
    }

    /// Times of the item POINT14, in which another code says whether one stays.
    pub(super) fn point14(first: i64) -> Self {
        Self::new(first, false)
    }

    fn new(first: i64, can_stay: bool) -> Self {
        let stay = usize::from(can_stay);
        Self {
            last: 0,
            next: 0,
            times: [first, 0, 0, 0],
            differences: [0; 4],
            extremes: [0; 4],
            multiples: WideSymbols::new((MULTIPLES - LEAST) as usize + 5 + stay),
            without_difference: Symbols::new(5 + stay),
            numbers: Integers::new(32, 9),
            can_stay,
        }
    }

    /// The next time, as the bits of a double.
    pub(super) fn next(&mut self, decoder: &mut Decoder<'_>) -> i64 {
        for _ in 0..MOST_SWITCHES {
            if self.read(decoder) {
                break;
            }
        }
        self.times[self.last & 3]
    }

    /// Reads a code and what belongs to it; `false` if a time of another sequence follows.
    fn read(&mut self, decoder: &mut Decoder<'_>) -> bool {
        let last = self.last & 3;
        let difference = self.differences[last];
        if difference == 0 {
            return self.read_without_difference(decoder);
        }
        let code = decoder.wide_symbol(&mut self.multiples) as i32;
        let stay = MULTIPLES - LEAST + 1;
        let full = stay + i32::from(self.can_stay);
        if code == full {
            self.begin(decoder);
        } else if code > full {
            self.last = (last + (code - full) as usize) & 3;
            return false;
        } else if code < stay {
            self.read_multiple(decoder, code, difference);
        }
        true
    }

    fn read_without_difference(&mut self, decoder: &mut Decoder<'_>) -> bool {
        let last = self.last & 3;
        let code = usize::from(decoder.foretold_symbol(&mut self.without_difference));
        match code + usize::from(!self.can_stay) {
            0 => {}
            1 => {
                let difference = self.numbers.read(decoder, 0, 0);
                self.differences[last] = difference;
                self.advance(difference);
                self.extremes[last] = 0;
            }
            2 => self.begin(decoder),
            code => {
                self.last = (last + code - 2) & 3;
                return false;
            }
        }
        true
    }

    /// A time that is about a multiple of the last difference later.
    fn read_multiple(&mut self, decoder: &mut Decoder<'_>, code: i32, difference: i32) {
        let (multiple, context, is_extreme) = match code {
            0 => (0, 7, true),
            1 => (1, 1, false),
            2..10 => (code, 2, false),
            10..MULTIPLES => (code, 3, false),
            MULTIPLES => (code, 4, true),
            _ if MULTIPLES - code > LEAST => (MULTIPLES - code, 5, false),
            _ => (LEAST, 6, true),
        };
        let foretold = difference.wrapping_mul(multiple);
        let found = self.numbers.read(decoder, foretold, context);
        self.advance(found);
        let last = self.last & 3;
        if code == 1 {
            self.extremes[last] = 0;
        }
        if is_extreme {
            self.extremes[last] += 1;
            if self.extremes[last] > 3 {
                self.differences[last] = found;
                self.extremes[last] = 0;
            }
        }
    }

    fn advance(&mut self, difference: i32) {
        let time = &mut self.times[self.last & 3];
        *time = time.wrapping_add(difference.into());
    }

    /// A sequence of its own begins.
    fn begin(&mut self, decoder: &mut Decoder<'_>) {
        let upper = (self.times[self.last & 3] >> 32) as i32;
        let upper = self.numbers.read(decoder, upper, 8);
        let lower = decoder.bits(32);
        self.next = (self.next + 1) & 3;
        self.last = self.next;
        self.times[self.last] = (i64::from(upper) << 32) | i64::from(lower);
        self.differences[self.last] = 0;
        self.extremes[self.last] = 0;
    }
}
