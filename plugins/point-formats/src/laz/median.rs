//! The median of the last differences, roughly.

/// Five values in order, of which the largest or the smallest gives way to each new one, mostly in turn.
#[derive(Clone, Copy)]
pub(super) struct Median {
    values: [i32; 5],
    /// Whether the largest gives way.
    is_high: bool,
}

impl Median {
    pub(super) const NEW: Self = Self {
        values: [0; 5],
        is_high: true,
    };

    #[inline(always)]
    pub(super) fn get(&self) -> i32 {
        self.values[2]
    }

    /// Sorts a value in, without a branch: where it goes nobody can foretell.
    #[inline(always)]
    pub(super) fn add(&mut self, value: i32) {
        let middle = self.get();
        let from = usize::from(!self.is_high);
        let [a, b, c, d] = [0, 1, 2, 3].map(|at| self.values[at + from]);
        self.is_high = if self.is_high {
            value < middle
        } else {
            value <= middle
        };
        self.values = [
            a.min(value),
            a.max(b.min(value)),
            b.max(c.min(value)),
            c.max(d.min(value)),
            d.max(value),
        ];
    }
}
