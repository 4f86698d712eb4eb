//! One to four of something, one of which is active: what each view of the window has.

/// The most views beside each other.
pub(crate) const MOST_VIEWS: usize = 4;

/// One or more of something, in the order of the views. Panels, menus and keys act on the active one.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Several<T> {
    /// The active one.
    pub(crate) active: T,
    /// The others, in order.
    others: Vec<T>,
    /// The place of the active one among all.
    index: usize,
}

impl<T> Several<T> {
    /// A single one.
    pub(crate) fn one(active: T) -> Self {
        Self {
            active,
            others: Vec::new(),
            index: 0,
        }
    }

    /// How many there are; at least 1.
    pub(crate) fn count(&self) -> usize {
        self.others.len() + 1
    }

    /// The place of the active one, from 0.
    pub(crate) fn active_index(&self) -> usize {
        self.index
    }

    /// All, in order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &T> {
        let (before, after) = self.others.split_at(self.index.min(self.others.len()));
        before.iter().chain([&self.active]).chain(after)
    }

    /// All, in order, to change.
    pub(crate) fn iter_mut(&mut self) -> impl Iterator<Item = &mut T> {
        let at = self.index.min(self.others.len());
        let (before, after) = self.others.split_at_mut(at);
        before.iter_mut().chain([&mut self.active]).chain(after)
    }

    /// All but the active one, each beside it, to take over from it.
    pub(crate) fn others_beside_active(&mut self) -> (&T, &mut [T]) {
        (&self.active, &mut self.others)
    }

    /// The one at a place.
    pub(crate) fn get(&self, index: usize) -> Option<&T> {
        self.iter().nth(index)
    }

    /// The one at a place, to change.
    pub(crate) fn get_mut(&mut self, index: usize) -> Option<&mut T> {
        self.iter_mut().nth(index)
    }

    /// Makes another one the active one; whether it was not that already. A place that is not there changes nothing.
    pub(crate) fn activate(&mut self, index: usize) -> bool {
        if index == self.index || index >= self.count() {
            return false;
        }
        // In order without gaps: first the active one goes back to its place, then the other one comes out.
        let at = if index > self.index { index - 1 } else { index };
        let next = self.others.remove(at);
        let was = std::mem::replace(&mut self.active, next);
        let back = if self.index > index {
            self.index - 1
        } else {
            self.index
        };
        self.others.insert(back, was);
        self.index = index;
        true
    }

    /// Adds one at the end.
    pub(crate) fn push(&mut self, another: T) {
        self.others.push(another);
    }

    /// Keeps the first `count`, at least one; returns the rest. If the active one goes, the last that stays is active.
    pub(crate) fn truncate(&mut self, count: usize) -> Vec<T> {
        let count = count.max(1);
        if count >= self.count() {
            return Vec::new();
        }
        if self.index >= count {
            self.activate(count - 1);
        }
        self.others.split_off(count - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn letters(count: usize) -> Several<char> {
        let mut several = Several::one('a');
        for letter in ('b'..).take(count - 1) {
            several.push(letter);
        }
        several
    }

    #[test]
    fn the_order_stays_whichever_is_active() {
        let mut several = letters(4);
        for index in [2, 0, 3, 3, 1, 2, 0] {
            several.activate(index);
            assert_eq!(several.iter().collect::<String>(), "abcd", "{index}");
            assert_eq!(several.active, b"abcd"[index] as char);
            assert_eq!(several.get(index), Some(&several.active));
            assert_eq!(several.active_index(), index);
            let by_change: String = several.clone().iter_mut().map(|letter| *letter).collect();
            assert_eq!(by_change, "abcd");
        }
        assert!(!several.activate(4));
        assert_eq!(several.get(4), None);
    }

    #[test]
    fn of_fewer_the_first_stay() {
        for active in 0..4 {
            let mut several = letters(4);
            several.activate(active);
            let gone: String = several.truncate(2).into_iter().collect();
            assert_eq!(gone, "cd");
            assert_eq!(several.iter().collect::<String>(), "ab");
            assert_eq!(several.active_index(), active.min(1));
            assert!(several.truncate(3).is_empty());
            assert_eq!(several.truncate(0), ['b']);
            assert_eq!((several.active, several.count()), ('a', 1));
        }
    }
}
