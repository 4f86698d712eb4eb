//! Adaptive models: how often each symbol is, counted as they come.
//!
//! The frequencies are brought up to date in ever longer cycles, as in Said's FastAC. All that a symbol needs lies together, in
//! arrays of fixed sizes that a byte cannot leave.

use wide::u16x8;

/// Bits that a cumulative frequency has.
pub(super) const FREQUENCY_BITS: u32 = 15;
/// Bits that the frequency of a bit has.
const BIT_BITS: u32 = 13;
/// Symbols that are compared at once.
const AT_ONCE: usize = 8;
/// Larger than any place in the interval.
const NEVER: u16 = 1 << FREQUENCY_BITS;
/// The upper bits of a place choose a slot of this table.
const SLOTS: usize = 64;
/// How many of numbers that ascend are not above a place, without a branch.
#[inline(always)]
fn not_above(starts: &[u16; AT_ONCE], place: u16) -> u32 {
    let behind = u16x8::new(*starts).saturating_sub(u16x8::splat(place));
    let are_not = behind.simd_eq(u16x8::splat(0)).to_bitmask();
    (!are_not).trailing_zeros()
}

/// How often each of at most 256 symbols is, or how often a bit is 0.
#[derive(Clone)]
pub(super) struct Symbols {
    /// Symbols until the frequencies are brought up to date.
    left: u32,
    cycle: u32,
    total: u32,
    likely_low: u32,
    likely_high: u32,
    likely: u8,
    last: u8,
    precision: u8,
    /// By how much a place is shifted for its slot.
    shift: u8,
    /// For each slot a symbol to begin the search with.
    slots: [u8; SLOTS],
    /// Sums of the frequencies before each symbol, then [`NEVER`].
    starts: [u16; 256 + AT_ONCE],
    counts: [u16; 256],
}

impl Symbols {
    /// A model of so many symbols, 1 to 256.
    pub(super) fn new(count: usize) -> Self {
        let slot_bits = match count {
            ..=AT_ONCE => 0,
            9..=16 => 3,
            17..=64 => 4,
            _ => 6,
        };
        let mut model = Self {
            left: 0,
            cycle: count as u32,
            total: 0,
            likely_low: 0,
            likely_high: 0,
            likely: 0,
            last: (count - 1) as u8,
            precision: FREQUENCY_BITS as u8,
            shift: FREQUENCY_BITS as u8 - slot_bits,
            slots: [0; SLOTS],
            starts: [NEVER; _],
            counts: [1; _],
        };
        model.update();
        model.cycle = 3 + count as u32 / 2;
        model.left = model.cycle;
        model
    }

    /// A model of a bit, of which LASzip reckons the frequency somewhat differently.
    pub(super) fn bit() -> Self {
        let mut model = Self::new(2);
        model.precision = BIT_BITS as u8;
        (model.cycle, model.left, model.total) = (4, 4, 2);
        model.starts[1] = 1 << (BIT_BITS - 1);
        model
    }

    #[inline(always)]
    pub(super) fn last(&self) -> u8 {
        self.last
    }

    /// Bits that its frequencies have.
    #[inline(always)]
    pub(super) fn precision(&self) -> u32 {
        u32::from(self.precision) & 31
    }

    /// The likeliest symbol and its range.
    #[inline(always)]
    pub(super) fn likeliest(&self) -> (u8, u32, u32) {
        (self.likely, self.likely_low, self.likely_high)
    }

    /// The symbol at a place in the interval.
    #[inline(always)]
    pub(super) fn find(&self, place: u32) -> u8 {
        if place >= u32::from(NEVER) {
            // Within the last one's: the interval need not be a multiple of its unit.
            return self.last;
        }
        let mut symbol = self.slots[(place >> (self.shift & 31)) as usize % SLOTS];
        loop {
            let at = usize::from(symbol) + 1;
            let starts = self.starts[at..].first_chunk();
            let before = starts.map_or(0, |starts| not_above(starts, place as u16));
            symbol = symbol.wrapping_add(before as u8);
            if before < AT_ONCE as u32 {
                return symbol;
            }
        }
    }

    /// The frequencies of all symbols before one, and with it.
    #[inline(always)]
    pub(super) fn range(&self, symbol: u8) -> (u32, u32) {
        let at = usize::from(symbol);
        (self.starts[at].into(), self.starts[at + 1].into())
    }

    /// Counts a symbol that has come.
    #[inline(always)]
    pub(super) fn count(&mut self, symbol: u8) {
        self.counts[usize::from(symbol)] += 1;
        self.left -= 1;
        if self.left == 0 {
            self.update();
        }
    }

    #[inline(never)]
    fn update(&mut self) {
        self.total += self.cycle;
        if u32::from(self.precision) == BIT_BITS {
            self.update_bit();
            return;
        }
        let count = u32::from(self.last) + 1;
        let counts = &mut self.counts[..count as usize];
        if self.total > 1 << FREQUENCY_BITS {
            self.total = halve(counts);
        }
        let scale = (1 << 31) / self.total;
        let (mut sum, mut most) = (0, 0);
        for (count, start) in counts.iter().zip(&mut self.starts) {
            *start = ((scale * sum) >> (31 - FREQUENCY_BITS)) as u16;
            sum += u32::from(*count);
            most = most.max(*count);
        }
        let likely = counts.iter().position(|count| *count == most);
        self.likely = likely.unwrap_or_default() as u8;
        (self.likely_low, self.likely_high) = self.range(self.likely);
        self.fill_slots();
        self.next_cycle((count + 6) * 8);
    }

    fn fill_slots(&mut self) {
        let mut symbol = 0;
        let count = 1 << (FREQUENCY_BITS - u32::from(self.shift));
        for (slot, first) in self.slots[..count].iter_mut().enumerate() {
            let place = (slot << self.shift) as u16;
            while self.starts[usize::from(symbol) + 1] <= place {
                symbol += 1;
            }
            *first = symbol;
        }
    }

    fn update_bit(&mut self) {
        let mut zeros = u32::from(self.counts[0]);
        if self.total > 1 << BIT_BITS {
            self.total = self.total.div_ceil(2);
            zeros = zeros.div_ceil(2);
            if zeros == self.total {
                self.total += 1;
            }
            self.counts[0] = zeros as u16;
        }
        let scale = (1 << 31) / self.total;
        self.starts[1] = ((zeros * scale) >> (31 - BIT_BITS)) as u16;
        // That of the ones is never asked for.
        self.counts[1] = 0;
        self.next_cycle(64);
    }

    fn next_cycle(&mut self, longest: u32) {
        self.cycle = (5 * self.cycle / 4).min(longest);
        self.left = self.cycle;
    }
}

/// Halves all counts, none to zero; returns their sum.
fn halve(counts: &mut [u16]) -> u32 {
    let mut total = 0;
    for count in counts {
        *count = count.div_ceil(2);
        total += u32::from(*count);
    }
    total
}

/// How often each of any number of symbols is; slower.
pub(super) struct WideSymbols {
    left: u32,
    cycle: u32,
    total: u32,
    starts: Vec<u16>,
    counts: Vec<u16>,
}

impl WideSymbols {
    pub(super) fn new(count: usize) -> Self {
        let mut model = Self {
            left: 0,
            cycle: count as u32,
            total: 0,
            starts: vec![0; count],
            counts: vec![1; count],
        };
        model.update();
        model.cycle = 3 + count as u32 / 2;
        model.left = model.cycle;
        model
    }

    /// The symbol at a place in the interval, and its range, which the end of the interval ends for the last.
    pub(super) fn find(&self, place: u32) -> (usize, u32, Option<u32>) {
        let behind = self
            .starts
            .partition_point(|start| u32::from(*start) <= place);
        let symbol = behind.saturating_sub(1);
        let start = |at: usize| self.starts.get(at).copied().map(u32::from);
        (symbol, start(symbol).unwrap_or_default(), start(behind))
    }

    /// Counts a symbol that has come.
    pub(super) fn count(&mut self, symbol: usize) {
        if let Some(count) = self.counts.get_mut(symbol) {
            *count += 1;
        }
        self.left -= 1;
        if self.left == 0 {
            self.update();
        }
    }

    fn update(&mut self) {
        self.total += self.cycle;
        if self.total > 1 << FREQUENCY_BITS {
            self.total = halve(&mut self.counts);
        }
        let scale = (1 << 31) / self.total;
        let mut sum = 0;
        for (count, start) in self.counts.iter().zip(&mut self.starts) {
            *start = ((scale * sum) >> (31 - FREQUENCY_BITS)) as u16;
            sum += u32::from(*count);
        }
        let longest = (self.counts.len() as u32 + 6) * 8;
        self.cycle = (5 * self.cycle / 4).min(longest);
        self.left = self.cycle;
    }
}

/// Models that are made when they are first used: most files use few of many.
pub(super) struct Models {
    models: Vec<Option<Box<Symbols>>>,
    symbols: usize,
}

impl Models {
    /// `count` models of so many symbols each.
    pub(super) fn new(count: usize, symbols: usize) -> Self {
        let mut models = Vec::new();
        models.resize_with(count, || None);
        Self { models, symbols }
    }

    /// The model of a context below `count`.
    #[inline(always)]
    pub(super) fn get(&mut self, context: usize) -> &mut Symbols {
        let symbols = self.symbols;
        self.models[context].get_or_insert_with(|| boxed(symbols))
    }
}

#[cold]
#[inline(never)]
fn boxed(symbols: usize) -> Box<Symbols> {
    Box::new(Symbols::new(symbols))
}
