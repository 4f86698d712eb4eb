//! The arithmetic decoder of LASzip.
//!
//! Said, *Introduction to Arithmetic Coding: Theory and Practice*, HP Labs report HPL-2004-76 (the coder FastAC), as Isenburg,
//! *LASzip: lossless compression of LiDAR data*, PE&RS 79(2), 2013, uses it: an interval of 32 bits, renewed by whole bytes.
//!
//! A symbol is found without a branch that depends on it, since symbols are what nobody can foretell: a mispredicted branch costs
//! as much as all the rest. What remains is a chain (division, look-up, product, the next division) in which the processor mostly
//! waits, and [`super::chunked`] and [`super::layered`] fill that time with a second chunk.

use std::hint::select_unpredictable;

use super::model::{FREQUENCY_BITS, Symbols, WideSymbols};

/// The interval never gets smaller.
const LEAST_LENGTH: u32 = 1 << 24;
/// Bits that are read at once at most.
const BITS_AT_ONCE: u32 = 19;

/// Reads symbols from bytes. Behind their end it reads zeros; [`Self::is_whole`] tells.
pub(super) struct Decoder<'a> {
    input: &'a [u8],
    at: usize,
    value: u32,
    length: u32,
}

impl<'a> Decoder<'a> {
    pub(super) fn new(input: &'a [u8]) -> Self {
        let mut decoder = Self {
            input,
            at: 0,
            value: 0,
            length: u32::MAX,
        };
        for _ in 0..4 {
            decoder.value = decoder.value << 8 | decoder.byte();
            decoder.at += 1;
        }
        decoder
    }

    /// Whether all that was read was there.
    pub(super) fn is_whole(&self) -> bool {
        self.at <= self.input.len()
    }

    #[inline(always)]
    fn byte(&self) -> u32 {
        self.input.get(self.at).copied().unwrap_or_default().into()
    }

    /// Takes a place and an interval, and makes it large enough again: nearly always by one byte or none, and on which of the two
    /// no branch depends.
    #[inline(always)]
    fn renew(&mut self, value: u32, length: u32) {
        let is_short = length < LEAST_LENGTH;
        let longer = value << 8 | self.byte();
        self.value = select_unpredictable(is_short, longer, value);
        self.length = select_unpredictable(is_short, length << 8, length);
        self.at += usize::from(is_short);
        if self.length < LEAST_LENGTH {
            self.renew_more();
        }
    }

    #[cold]
    #[inline(never)]
    fn renew_more(&mut self) {
        // Only damaged data makes it 0.
        self.length = self.length.max(1);
        while self.length < LEAST_LENGTH {
            self.value = self.value << 8 | self.byte();
            self.length <<= 8;
            self.at += 1;
        }
    }

    /// The next symbol, of a model that is not of a bit.
    #[inline(always)]
    pub(super) fn symbol(&mut self, model: &mut Symbols) -> u8 {
        let unit = self.length >> FREQUENCY_BITS;
        self.symbol_in_units(model, unit)
    }

    /// The next symbol, of any model.
    #[inline(always)]
    pub(super) fn symbol_or_bit(&mut self, model: &mut Symbols) -> u8 {
        let unit = self.length >> model.precision();
        self.symbol_in_units(model, unit)
    }

    /// The next symbol; a `unit` is the length of the interval by the sum of the frequencies.
    #[inline(always)]
    fn symbol_in_units(&mut self, model: &mut Symbols, unit: u32) -> u8 {
        let symbol = model.find(self.value.checked_div(unit).unwrap_or_default());
        let (low, high) = model.range(symbol);
        // That a symbol is the last is as likely as others: bytes that differ by -1.
        let is_last = symbol == model.last();
        let high = select_unpredictable(is_last, self.length, unit.wrapping_mul(high));
        self.narrow(unit.wrapping_mul(low), high);
        model.count(symbol);
        symbol
    }

    /// The next symbol where one is nearly always right: it is tried first, and the processor goes on before it knows.
    #[inline(always)]
    pub(super) fn foretold_symbol(&mut self, model: &mut Symbols) -> u8 {
        let unit = self.length >> FREQUENCY_BITS;
        let (symbol, low, high) = model.likeliest();
        let low = unit * low;
        let high = if symbol == model.last() {
            self.length
        } else {
            unit * high
        };
        if self.value < low || self.value >= high {
            return self.unforetold_symbol(model);
        }
        (self.value, self.length) = (self.value - low, high - low);
        if self.length < LEAST_LENGTH {
            self.renew(self.value, self.length);
        }
        model.count(symbol);
        symbol
    }

    #[inline(never)]
    fn unforetold_symbol(&mut self, model: &mut Symbols) -> u8 {
        self.symbol(model)
    }

    /// The next symbol of a model of many.
    #[inline(never)]
    pub(super) fn wide_symbol(&mut self, model: &mut WideSymbols) -> usize {
        let unit = self.length >> FREQUENCY_BITS;
        let (symbol, low, high) = model.find(self.value / unit.max(1));
        let high = high.map_or(self.length, |high| unit * high);
        self.narrow(unit * low, high);
        model.count(symbol);
        symbol
    }

    /// Takes the part of the interval from `low` to `high`. Damaged data may wrap around.
    #[inline(always)]
    fn narrow(&mut self, low: u32, high: u32) {
        self.renew(self.value.wrapping_sub(low), high.wrapping_sub(low));
    }

    /// Bits that no model foretells, at most 32; none reads nothing.
    #[inline(always)]
    pub(super) fn bits(&mut self, bits: u32) -> u32 {
        if bits > BITS_AT_ONCE {
            return self.many_bits(bits);
        }
        let length = self.length >> bits;
        let number = self.value.checked_div(length).unwrap_or_default();
        let number = number.min((1 << bits) - 1);
        self.renew(self.value.wrapping_sub(length * number), length);
        number
    }

    /// A number of 64 bits that no model foretells.
    pub(super) fn full(&mut self) -> i64 {
        let lower = i64::from(self.bits(32));
        i64::from(self.bits(32)) << 32 | lower
    }

    #[cold]
    #[inline(never)]
    fn many_bits(&mut self, bits: u32) -> u32 {
        let low = self.bits(16);
        (self.bits(bits.min(32) - 16) << 16) | low
    }
}
