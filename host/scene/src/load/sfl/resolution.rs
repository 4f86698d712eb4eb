//! Which resolution of each set is loaded.

use pointstage_plugin_api::settings_schema::SettingSchema;

use crate::load::choice::ChoiceSetting;

/// The loader's option.
pub(super) const RESOLUTION: ChoiceSetting<Resolution> = ChoiceSetting {
    id: "resolution",
    label: "Resolution",
    options: &[
        (Resolution::AsFile, "as_file", "As the file says"),
        (Resolution::Finest, "finest", "Finest"),
        (Resolution::Coarsest, "coarsest", "Coarsest"),
    ],
};

/// The option as the loader's info has it.
pub(super) fn schema() -> SettingSchema {
    RESOLUTION.schema("Which of several samplings of the same object is loaded.")
}

/// The loader's choice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Resolution {
    /// That which the file names; the last one if it names none.
    #[default]
    AsFile,
    /// The one with the most surfels.
    Finest,
    /// The one with the fewest surfels, empty ones left aside.
    Coarsest,
}

impl Resolution {
    /// The level to load of those with these counts of surfels; `named` is the file's own.
    pub(super) fn choose(self, counts: &[u32], named: usize) -> usize {
        let with_count = counts
            .iter()
            .enumerate()
            .map(|(level, count)| (*count, level));
        let chosen = match self {
            Self::AsFile => None,
            // Of equal ones the first.
            Self::Finest => {
                with_count.max_by_key(|&(count, level)| (count, std::cmp::Reverse(level)))
            }
            Self::Coarsest => with_count.filter(|(count, _)| *count > 0).min(),
        };
        chosen.map_or(named, |(_, level)| level)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_chosen_by_their_counts() {
        let counts = [50, 0, 200, 7, 200];
        assert_eq!(Resolution::AsFile.choose(&counts, 3), 3);
        assert_eq!(Resolution::Finest.choose(&counts, 3), 2);
        assert_eq!(Resolution::Coarsest.choose(&counts, 0), 3);
        assert_eq!(Resolution::Coarsest.choose(&[0], 0), 0);
    }
}
