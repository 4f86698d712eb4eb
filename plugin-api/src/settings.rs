//! The settings of one call: a snapshot that the host has checked against the manifest's schema.

use crate::abi::{SettingRecord, ValueKind};
use crate::error::{Error, Result};

/// Values of the plugin's settings. Every setting of the schema has one: what the user did not set takes its default.
#[derive(Clone, Copy)]
pub struct Settings<'a> {
    records: &'a [SettingRecord<'a>],
}

impl<'a> Settings<'a> {
    pub(crate) fn new(records: &'a [SettingRecord<'a>]) -> Self {
        Self { records }
    }

    fn find(&self, id: &str, kind: ValueKind) -> Result<&'a SettingRecord<'a>> {
        let record = self.records.iter().find(|record| record.id.as_str() == id);
        match record {
            Some(record) if record.kind == kind => Ok(record),
            Some(record) => Err(Error::failed(format!(
                "setting '{id}' was asked for as {kind:?}, but the manifest declares {:?}",
                record.kind
            ))),
            None => Err(Error::failed(format!(
                "setting '{id}' is not in the manifest; add it, or correct the id"
            ))),
        }
    }

    /// A `bool` setting.
    pub fn bool(&self, id: &str) -> Result<bool> {
        self.find(id, ValueKind::BOOL)
            .map(|record| record.integer != 0)
    }

    /// An `int` setting.
    pub fn int(&self, id: &str) -> Result<i64> {
        self.find(id, ValueKind::INT).map(|record| record.integer)
    }

    /// A `float` setting.
    pub fn float(&self, id: &str) -> Result<f32> {
        self.find(id, ValueKind::FLOAT)
            .map(|record| record.numbers[0] as f32)
    }

    /// A `choice` setting: the chosen option's id.
    pub fn choice(&self, id: &str) -> Result<&'a str> {
        self.find(id, ValueKind::CHOICE)
            .map(|record| record.text.as_str())
    }

    /// A `colour` setting: linear red, green, blue, alpha.
    pub fn colour(&self, id: &str) -> Result<[f32; 4]> {
        self.find(id, ValueKind::COLOUR)
            .map(|record| record.numbers.map(|number| number as f32))
    }

    /// A `text` setting.
    pub fn text(&self, id: &str) -> Result<&'a str> {
        self.find(id, ValueKind::TEXT)
            .map(|record| record.text.as_str())
    }
}
