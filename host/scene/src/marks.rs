//! Which surfels of an object are marked: one bit a surfel.

use std::fmt;

/// Bits of a word.
const BITS: usize = u64::BITS as usize;

/// A set of surfels of one object, counted over all its blocks: one bit a surfel.
#[derive(Clone, PartialEq, Eq, Default)]
pub struct Marks {
    /// Bits beyond `len` are 0.
    words: Vec<u64>,
    len: usize,
    count: usize,
}

/// What a new set of surfels does to the one that is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum MarkMode {
    /// Takes its place.
    #[default]
    Replace,
    /// Joins it.
    Add,
    /// Is taken out of it.
    Subtract,
}

impl Marks {
    /// No surfel of `len`.
    pub fn none(len: usize) -> Self {
        Self {
            words: vec![0; len.div_ceil(BITS)],
            len,
            count: 0,
        }
    }

    /// All surfels of `len`.
    pub fn all(len: usize) -> Self {
        Self::none(len).inverted()
    }

    /// Surfel 0 is the lowest bit of the first word. Words that are missing count as 0, bits beyond `len` do not count.
    pub fn from_words(mut words: Vec<u64>, len: usize) -> Self {
        words.resize(len.div_ceil(BITS), 0);
        if let Some(last) = words.last_mut()
            && !len.is_multiple_of(BITS)
        {
            *last &= (1 << (len % BITS)) - 1;
        }
        let count = words.iter().map(|word| word.count_ones() as usize).sum();
        Self { words, len, count }
    }

    /// Surfels of which `is_marked` says yes.
    pub fn from_fn(len: usize, mut is_marked: impl FnMut(usize) -> bool) -> Self {
        let word = |first: usize| {
            let bits = first..len.min(first + BITS);
            bits.filter(|&surfel| is_marked(surfel))
                .fold(0, |word, surfel| word | (1 << (surfel - first)))
        };
        Self::from_words((0..len).step_by(BITS).map(word).collect(), len)
    }

    /// Surfels of the object, marked or not.
    pub fn len(&self) -> usize {
        self.len
    }

    /// How many are marked.
    pub fn count(&self) -> usize {
        self.count
    }

    /// True when none is marked.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Whether a surfel is marked; none beyond the object is.
    pub fn contains(&self, surfel_index: usize) -> bool {
        let word = self.words.get(surfel_index / BITS).copied();
        word.is_some_and(|word| word >> (surfel_index % BITS) & 1 == 1)
    }

    /// The marked surfels, in order.
    pub fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        self.words.iter().enumerate().flat_map(|(number, &word)| {
            let mut rest = word;
            std::iter::from_fn(move || {
                let bit = rest.trailing_zeros() as usize;
                // The lowest bit goes; 0 has none.
                rest &= rest.wrapping_sub(1);
                (bit < BITS).then_some(number * BITS + bit)
            })
        })
    }

    /// Those that are not marked.
    #[must_use]
    pub fn inverted(&self) -> Self {
        Self::from_words(self.words.iter().map(|word| !word).collect(), self.len)
    }

    /// These after `others` came by `mode`; a set of another length counts as far as it goes.
    #[must_use]
    pub fn combined(&self, others: &Self, mode: MarkMode) -> Self {
        let other = |index: usize| others.words.get(index).copied().unwrap_or(0);
        let words = self.words.iter().enumerate();
        let words = words.map(|(index, &word)| match mode {
            MarkMode::Replace => other(index),
            MarkMode::Add => word | other(index),
            MarkMode::Subtract => word & !other(index),
        });
        Self::from_words(words.collect(), self.len)
    }

    /// Lengths of runs, in turns not marked and marked, from surfel 0 on; the rest is not marked.
    pub fn runs(&self) -> Vec<usize> {
        let (mut runs, mut at, mut is_on) = (Vec::new(), 0, false);
        let mut previous = None;
        for surfel in self.iter() {
            if previous.is_none_or(|previous| previous + 1 != surfel) {
                if is_on {
                    let end = previous.map_or(0, |previous| previous + 1);
                    runs.push(end - at);
                    at = end;
                }
                runs.push(surfel - at);
                (at, is_on) = (surfel, true);
            }
            previous = Some(surfel);
        }
        if let Some(last) = previous {
            runs.push(last + 1 - at);
        }
        runs
    }

    /// The set with these [`runs`](Self::runs); `None` if they go beyond `len`.
    pub fn from_runs(runs: &[usize], len: usize) -> Option<Self> {
        let mut words = vec![0_u64; len.div_ceil(BITS)];
        let mut at = 0_usize;
        for (number, &run) in runs.iter().enumerate() {
            let end = at.checked_add(run).filter(|&end| end <= len)?;
            if number % 2 == 1 {
                (at..end).for_each(|surfel| words[surfel / BITS] |= 1 << (surfel % BITS));
            }
            at = end;
        }
        Some(Self::from_words(words, len))
    }
}

impl fmt::Debug for Marks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Marks({} of {})", self.count, self.len)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn marks(bits: &[bool]) -> Marks {
        Marks::from_fn(bits.len(), |surfel| bits[surfel])
    }

    fn bits() -> impl Strategy<Value = Vec<bool>> {
        prop::collection::vec(any::<bool>(), 0..200)
    }

    proptest! {
        #[test]
        fn a_set_holds_what_it_was_made_of(bits in bits()) {
            let marks = marks(&bits);
            let expected: Vec<usize> = (0..bits.len()).filter(|&surfel| bits[surfel]).collect();
            prop_assert_eq!(marks.iter().collect::<Vec<_>>(), expected.clone());
            prop_assert_eq!((marks.len(), marks.count()), (bits.len(), expected.len()));
            prop_assert!(bits.iter().enumerate().all(|(surfel, &bit)| marks.contains(surfel) == bit));
            prop_assert!(!marks.contains(bits.len()));
        }

        #[test]
        fn inverting_twice_changes_nothing(bits in bits()) {
            let marks = marks(&bits);
            prop_assert_eq!(marks.inverted().count(), bits.len() - marks.count());
            prop_assert_eq!(marks.inverted().inverted(), marks);
        }

        #[test]
        fn modes_are_those_of_sets(pairs in prop::collection::vec(any::<(bool, bool)>(), 0..200)) {
            let (one, other): (Vec<bool>, Vec<bool>) = pairs.iter().copied().unzip();
            let expect = |mode, says: fn(bool, bool) -> bool| {
                let bits: Vec<bool> = pairs.iter().map(|&(one, other)| says(one, other)).collect();
                prop_assert_eq!(marks(&one).combined(&marks(&other), mode), marks(&bits));
                Ok(())
            };
            expect(MarkMode::Replace, |_, other| other)?;
            expect(MarkMode::Add, |one, other| one || other)?;
            expect(MarkMode::Subtract, |one, other| one && !other)?;
        }

        #[test]
        fn runs_come_back(bits in bits()) {
            let marks = marks(&bits);
            prop_assert_eq!(Marks::from_runs(&marks.runs(), bits.len()), Some(marks));
        }
    }

    #[test]
    fn runs_alternate_from_what_is_not_marked() {
        let set = marks(&[true, true, false, true, false, false]);
        assert_eq!(set.runs(), [0, 2, 1, 1]);
        assert_eq!(Marks::none(9).runs(), [0_usize; 0]);
        assert_eq!(Marks::from_runs(&[3, 4], 6), None, "beyond the object");
        assert_eq!(Marks::from_runs(&[1, usize::MAX], 6), None);
    }
}
