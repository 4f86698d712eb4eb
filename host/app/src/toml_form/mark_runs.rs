//! Which surfels of an object are selected, as text.

use std::sync::Arc;

use pointstage_scene::Marks;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The most text that a session keeps of an object's selection, bytes: an eighth of the largest file that is read back.
const MOST_BYTES: usize = 2 << 20;

/// Lengths of runs of surfels, in turns not selected and selected, from the object's first surfel on; what comes after them is
/// not selected. As text, with spaces between: `"120 30 7 1"`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct MarkRuns(Vec<usize>);

impl MarkRuns {
    /// The runs of an object's marks; none, and a line in the log, if they are too many for a file.
    pub(crate) fn of(marks: Option<&Arc<Marks>>, object: &str) -> Self {
        let runs = Self(marks.map_or_else(Vec::new, |marks| marks.runs()));
        if runs.0.len() > MOST_BYTES / 2 || runs.text().len() > MOST_BYTES {
            tracing::warn!(
                "{object}: the selected surfels lie in {} runs, too many for a session file; they are not kept in it",
                runs.0.len() / 2
            );
            return Self::default();
        }
        runs
    }

    /// Whether nothing is selected.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The marks in an object of so many surfels; none, and a line in the log, if they are of a larger one.
    pub(crate) fn marks(&self, surfel_count: usize, object: &str) -> Option<Arc<Marks>> {
        let marks = Marks::from_runs(&self.0, surfel_count);
        if marks.is_none() {
            tracing::warn!(
                "{object}: the session's selected surfels go beyond its {surfel_count} surfels; the file has changed, select again"
            );
        }
        marks.filter(|marks| !marks.is_empty()).map(Arc::new)
    }

    fn text(&self) -> String {
        let lengths: Vec<String> = self.0.iter().map(usize::to_string).collect();
        lengths.join(" ")
    }
}

impl Serialize for MarkRuns {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.text())
    }
}

impl<'de> Deserialize<'de> for MarkRuns {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let lengths = text.split_ascii_whitespace().map(|word| {
            word.parse().map_err(|_| {
                D::Error::custom(format!(
                    "selected_surfels: expected lengths of runs such as \"120 30\", found '{word}'"
                ))
            })
        });
        lengths.collect::<Result<_, _>>().map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_come_back_unless_the_object_has_become_smaller() {
        let marks = Arc::new(Marks::from_fn(50, |surfel| surfel % 7 > 4));
        let runs = MarkRuns::of(Some(&marks), "object");
        assert_eq!(runs.marks(50, "object"), Some(Arc::clone(&marks)));
        assert!(runs.text().starts_with("5 2 5 2"), "{}", runs.text());
        assert_eq!(runs.marks(40, "object"), None);
        assert!(MarkRuns::of(None, "object").is_empty());
        assert_eq!(MarkRuns::default().marks(9, "object"), None);
    }

    #[test]
    fn what_would_fill_the_file_is_not_kept() {
        let marks = Marks::from_fn(MOST_BYTES * 2, |surfel| surfel % 2 == 1);
        assert!(MarkRuns::of(Some(&Arc::new(marks)), "object").is_empty());
    }
}
