//! Which resolution of each set is loaded.

use pointstage_plugin_api::settings_schema::{
    ChoiceOption, SettingCost, SettingKind, SettingSchema, SettingValue, SettingValues, ValueError,
    snapshot,
};

/// Id of the setting.
const SETTING: &str = "resolution";

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
    const ALL: [Self; 3] = [Self::AsFile, Self::Finest, Self::Coarsest];

    const fn id(self) -> &'static str {
        match self {
            Self::AsFile => "as_file",
            Self::Finest => "finest",
            Self::Coarsest => "coarsest",
        }
    }

    const fn label(self) -> &'static str {
        match self {
            Self::AsFile => "As the file says",
            Self::Finest => "Finest",
            Self::Coarsest => "Coarsest",
        }
    }

    /// The settings of the loader.
    pub(super) fn settings() -> Vec<SettingSchema> {
        let option = |resolution: Self| ChoiceOption {
            id: resolution.id().to_owned(),
            label: resolution.label().to_owned(),
        };
        vec![SettingSchema {
            id: SETTING.to_owned(),
            kind: SettingKind::Choice {
                default: Self::default().id().to_owned(),
                options: Self::ALL.into_iter().map(option).collect(),
            },
            label: "Resolution".to_owned(),
            help: "Which of several samplings of the same object is loaded.".to_owned(),
            group: String::new(),
            visible_if: None,
            cost: SettingCost::Prepare,
            shortcut: None,
            value_shortcuts: Vec::new(),
        }]
    }

    /// The choice that these values make.
    pub(super) fn from_values(
        settings: &[SettingSchema],
        values: &SettingValues,
    ) -> Result<Self, ValueError> {
        let values = snapshot(settings, values)?;
        let chosen = values.get(SETTING);
        let is_chosen =
            |resolution: &Self| chosen == Some(&SettingValue::Choice(resolution.id().to_owned()));
        Ok(Self::ALL.into_iter().find(is_chosen).unwrap_or_default())
    }

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

    #[test]
    fn values_are_checked() {
        let settings = Resolution::settings();
        let choose = |id: &str, value: &str| {
            let value = SettingValue::Choice(value.to_owned());
            let values = SettingValues::from([(id.to_owned(), value)]);
            Resolution::from_values(&settings, &values)
        };
        assert_eq!(choose(SETTING, "finest"), Ok(Resolution::Finest));
        assert!(choose(SETTING, "best").is_err() && choose("level", "finest").is_err());
        let none = Resolution::from_values(&settings, &SettingValues::new());
        assert_eq!(none, Ok(Resolution::AsFile));
    }
}
