//! Views that were kept: ten by number, any number by name. Plain data.

use pointstage_scene::ViewRecord;

/// Views by number.
pub(crate) const SLOT_COUNT: usize = 10;

/// The views of a session.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct StoredViews {
    /// By number: Ctrl+N stores, N recalls. The first is that of the key 1, the last that of 0.
    pub(crate) slots: [Option<ViewRecord>; SLOT_COUNT],
    /// By name, in the list's order.
    pub(crate) named: Vec<NamedView>,
}

/// A view with a name.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NamedView {
    /// For people; unique in the list.
    pub(crate) name: String,
    /// Camera and picture size.
    pub(crate) record: ViewRecord,
    /// A small picture of it, encoded as PNG; empty if there is none.
    pub(crate) thumbnail: Vec<u8>,
}

/// A way in the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ListWay {
    /// Towards the first.
    Up,
    /// Towards the last.
    Down,
}

/// The key of a slot: 1 to 9, then 0.
pub(crate) fn slot_key(slot: usize) -> char {
    char::from_digit((slot as u32 + 1) % 10, 10).unwrap_or('0')
}

/// The slot of a key, 0 to 9.
pub(crate) fn slot_of_key(key: u8) -> usize {
    (usize::from(key) + SLOT_COUNT - 1) % SLOT_COUNT
}

impl StoredViews {
    /// Appends a view under a name that is free.
    pub(crate) fn add(&mut self, record: ViewRecord, thumbnail: Vec<u8>) {
        let name = self.free_name("View 1", None);
        self.named.push(NamedView {
            name,
            record,
            thumbnail,
        });
    }

    /// Gives a view another name. An empty one changes nothing, and one that is taken gets a number.
    pub(crate) fn rename(&mut self, index: usize, name: &str) {
        let name = name.trim();
        if name.is_empty() || index >= self.named.len() {
            return;
        }
        self.named[index].name = self.free_name(name, Some(index));
    }

    /// Moves a view in the list by one place; at the end it stays.
    pub(crate) fn shift(&mut self, index: usize, way: ListWay) {
        let other = match way {
            ListWay::Up => index.checked_sub(1),
            ListWay::Down => index.checked_add(1),
        };
        if let Some(other) = other.filter(|&other| other.max(index) < self.named.len()) {
            self.named.swap(index, other);
        }
    }

    /// `wanted`, or with the next free number at its end if another view than that at `own` has it.
    fn free_name(&self, wanted: &str, own: Option<usize>) -> String {
        let is_taken = |name: &str| {
            let mut others = self.named.iter().enumerate();
            others.any(|(index, view)| Some(index) != own && view.name == name)
        };
        if !is_taken(wanted) {
            return wanted.to_owned();
        }
        let stem = wanted.trim_end_matches(|letter: char| letter.is_ascii_digit());
        let number: Option<u32> = wanted[stem.len()..].parse().ok();
        let first = u64::from(number.unwrap_or(1)) + 1;
        let stem = stem.trim_end();
        let names = (first..).map(|number| format!("{stem} {number}").trim_start().to_owned());
        // One number more than there are views: one of them is free.
        let mut names = names.take(self.named.len() + 1);
        names
            .find(|name| !is_taken(name))
            .unwrap_or_else(|| wanted.to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_scene::Camera;

    fn names(views: &StoredViews) -> Vec<&str> {
        views.named.iter().map(|view| view.name.as_str()).collect()
    }

    fn add(views: &mut StoredViews) {
        views.add(ViewRecord::new(Camera::default(), 800, 600), Vec::new());
    }

    fn with(names: &[&str]) -> StoredViews {
        let mut views = StoredViews::default();
        for (index, name) in names.iter().enumerate() {
            add(&mut views);
            views.rename(index, name);
        }
        views
    }

    #[test]
    fn new_views_are_numbered() {
        let mut views = StoredViews::default();
        for _ in 0..3 {
            add(&mut views);
        }
        views.named.remove(1);
        add(&mut views);
        assert_eq!(names(&views), ["View 1", "View 3", "View 2"]);
    }

    #[test]
    fn a_name_is_taken_by_one_view_only() {
        let mut views = with(&["Front", "Face", "Face"]);
        assert_eq!(names(&views), ["Front", "Face", "Face 2"]);
        views.rename(0, "  Face ");
        assert_eq!(names(&views), ["Face 3", "Face", "Face 2"]);
        views.rename(1, "Face");
        views.rename(2, " ");
        views.rename(9, "Nobody");
        assert_eq!(names(&views), ["Face 3", "Face", "Face 2"]);
        // A number that is greater than any is a name like another.
        let long = with(&["99999999999999999999", "99999999999999999999"]);
        assert_eq!(names(&long), ["99999999999999999999", "2"]);
    }

    #[test]
    fn the_list_can_be_put_in_order() {
        let mut views = with(&["a", "b", "c"]);
        views.shift(2, ListWay::Up);
        assert_eq!(names(&views), ["a", "c", "b"]);
        views.shift(0, ListWay::Up);
        views.shift(2, ListWay::Down);
        views.shift(7, ListWay::Up);
        assert_eq!(names(&views), ["a", "c", "b"]);
        views.shift(0, ListWay::Down);
        assert_eq!(names(&views), ["c", "a", "b"]);
    }

    #[test]
    fn slots_are_called_by_their_keys() {
        let keys: String = (0..SLOT_COUNT).map(slot_key).collect();
        assert_eq!(keys, "1234567890");
        for slot in 0..SLOT_COUNT {
            let key = slot_key(slot)
                .to_digit(10)
                .and_then(|key| u8::try_from(key).ok());
            assert_eq!(key.map(slot_of_key), Some(slot));
        }
    }
}
