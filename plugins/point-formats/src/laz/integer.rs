//! Whole numbers as LASzip writes them: how many bits the difference from a prediction has, then the difference.

use super::decoder::Decoder;
use super::model::Symbols;

/// Of longer differences only so many upper bits have a model.
const MODELLED_BITS: u32 = 8;
/// Bits that a difference may have.
const MOST_BITS: usize = 32;

/// Models of the differences of numbers of one kind. A number is read in steps, so that another chunk's can go between:
/// [`Self::read_size`], [`Self::read_upper`], [`Self::read_lower`] if any [`Self::is_long`], then [`Self::number`].
#[derive(Clone)]
pub(super) struct Integers {
    /// Bits of the last difference; a context of others.
    pub(super) size: u32,
    difference: u32,
    /// One for each context.
    sizes: Vec<Symbols>,
    /// One for each size. That of 32 is a single symbol, for which nothing is read.
    uppers: Box<[Symbols]>,
    /// Numbers are modulo this; 0 if they have 32 bits.
    modulus: i32,
}

impl Integers {
    /// Numbers of so many bits, at most 32.
    pub(super) fn new(bits: usize, contexts: usize) -> Self {
        let upper = |size: usize| match size {
            0 => Symbols::bit(),
            MOST_BITS => Symbols::new(1),
            _ => Symbols::new(1 << size.min(MODELLED_BITS as usize)),
        };
        Self {
            size: 0,
            difference: 0,
            sizes: vec![Symbols::new(bits + 1); contexts],
            uppers: (0..=bits).map(upper).collect(),
            modulus: if bits < MOST_BITS { 1 << bits } else { 0 },
        }
    }

    /// The same as long as nothing has been read, with other contexts: cheaper than new ones.
    pub(super) fn with_contexts(&self, contexts: usize) -> Self {
        Self {
            sizes: vec![Symbols::new(self.uppers.len()); contexts],
            ..self.clone()
        }
    }

    #[inline(always)]
    pub(super) fn read_size(&mut self, decoder: &mut Decoder<'_>, context: usize) {
        self.size = decoder.symbol(&mut self.sizes[context]).into();
    }

    #[inline(always)]
    pub(super) fn read_upper(&mut self, decoder: &mut Decoder<'_>) {
        let model = &mut self.uppers[self.size as usize];
        self.difference = decoder.symbol_or_bit(model).into();
    }

    /// Whether bits follow that no model foretells.
    #[inline(always)]
    pub(super) fn is_long(&self) -> bool {
        self.size > MODELLED_BITS
    }

    /// Reads what follows, if anything does.
    #[inline(always)]
    pub(super) fn read_lower(&mut self, decoder: &mut Decoder<'_>) {
        if self.size < MOST_BITS as u32 {
            let bits = self.size.saturating_sub(MODELLED_BITS);
            self.difference = (self.difference << bits) | decoder.bits(bits);
        }
    }

    /// The number that has been read.
    ///
    /// With k bits a difference is one of −2ᵏ + 1 … −2ᵏ⁻¹ and 2ᵏ⁻¹ + 1 … 2ᵏ; with none it is 0 or 1, with all −2³¹.
    #[inline(always)]
    pub(super) fn number(&self, prediction: i32) -> i32 {
        let half = (1_u64 << self.size >> 1) as u32;
        let offset = if self.difference < half {
            1_u32.wrapping_sub(half << 1)
        } else {
            u32::from(self.size > 0)
        };
        let difference = if self.size < MOST_BITS as u32 {
            self.difference.wrapping_add(offset) as i32
        } else {
            i32::MIN
        };
        let number = prediction.wrapping_add(difference);
        if self.modulus == 0 {
            return number;
        }
        let back = if number < 0 {
            self.modulus
        } else if number >= self.modulus {
            -self.modulus
        } else {
            0
        };
        number.wrapping_add(back)
    }

    /// Reads a number in one go.
    #[inline]
    pub(super) fn read(
        &mut self,
        decoder: &mut Decoder<'_>,
        prediction: i32,
        context: usize,
    ) -> i32 {
        self.read_size(decoder, context);
        self.read_upper(decoder);
        if self.is_long() {
            self.read_lower(decoder);
        }
        self.number(prediction)
    }
}

/// Reads what follows the sizes of a number of each lane. `of` gives a lane's decoder and models, if it has such numbers.
#[inline(always)]
pub(super) fn read_numbers<'a, L, const LANES: usize>(
    lanes: &mut [L; LANES],
    of: impl for<'l> Fn(&'l mut L) -> Option<(&'l mut Decoder<'a>, &'l mut Integers)>,
) {
    for lane in &mut *lanes {
        if let Some((decoder, integers)) = of(lane) {
            integers.read_upper(decoder);
        }
    }
    for lane in lanes {
        if let Some((decoder, integers)) = of(lane)
            && integers.is_long()
        {
            integers.read_lower(decoder);
        }
    }
}
