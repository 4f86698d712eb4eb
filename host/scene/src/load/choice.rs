//! Options of built-in loaders that choose one of several.

use pointstage_plugin_api::settings_schema::{
    ChoiceOption, SettingCost, SettingKind, SettingSchema, SettingValue, SettingValues, ValueError,
    snapshot,
};

/// An option that chooses one of several values of `T`, and its default until the user does.
#[derive(Debug)]
pub(super) struct ChoiceSetting<T: 'static> {
    /// Id of the setting.
    pub(super) id: &'static str,
    /// Its name for people.
    pub(super) label: &'static str,
    /// Each value with its id and its name for people; the default is among them.
    pub(super) options: &'static [(T, &'static str, &'static str)],
}

impl<T: Copy + Default + PartialEq> ChoiceSetting<T> {
    /// The setting as the loader's info has it.
    pub(super) fn schema(&self, help: impl Into<String>) -> SettingSchema {
        let option = |&(_, id, label): &(T, &str, &str)| ChoiceOption {
            id: id.to_owned(),
            label: label.to_owned(),
        };
        let is_default = |(value, ..): &&(T, &str, &str)| *value == T::default();
        let default = self.options.iter().find(is_default);
        SettingSchema {
            id: self.id.to_owned(),
            kind: SettingKind::Choice {
                default: default.map_or_else(String::new, |(_, id, _)| (*id).to_owned()),
                options: self.options.iter().map(option).collect(),
            },
            label: self.label.to_owned(),
            help: help.into(),
            group: String::new(),
            visible_if: None,
            cost: SettingCost::Prepare,
            shortcut: None,
            value_shortcuts: Vec::new(),
        }
    }

    /// What these values of the loader's `settings` choose.
    ///
    /// # Errors
    /// A value is of no setting, or none that its setting may have.
    pub(super) fn chosen(
        &self,
        settings: &[SettingSchema],
        values: &SettingValues,
    ) -> Result<T, ValueError> {
        let values = snapshot(settings, values)?;
        let chosen = values.get(self.id);
        let is_chosen =
            |(_, id, _): &&(T, &str, &str)| chosen == Some(&SettingValue::Choice((*id).to_owned()));
        let found = self.options.iter().find(is_chosen);
        Ok(found.map_or_else(T::default, |(value, ..)| *value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTING: ChoiceSetting<u8> = ChoiceSetting {
        id: "size",
        label: "Size",
        options: &[(1, "small", "Small"), (0, "large", "Large")],
    };

    #[test]
    fn the_default_is_chosen_until_another_one_is() {
        let settings = [SETTING.schema("How large.")];
        let SettingKind::Choice { default, options } = &settings[0].kind else {
            panic!("{:?}", settings[0].kind)
        };
        assert_eq!((default.as_str(), options.len()), ("large", 2));
        let choose = |id: &str, value: &str| {
            let value = SettingValue::Choice(value.to_owned());
            SETTING.chosen(&settings, &SettingValues::from([(id.to_owned(), value)]))
        };
        assert_eq!(SETTING.chosen(&settings, &SettingValues::new()), Ok(0));
        assert_eq!(choose("size", "small"), Ok(1));
        assert!(choose("size", "huge").is_err() && choose("weight", "small").is_err());
    }
}
