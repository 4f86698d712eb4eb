//! What the window says that it shows: the file of the environment variable `POINTSTAGE_UI_STATE`.

use std::path::Path;

use anyhow::{Context as _, Result};
use serde_json::Value;

/// The state after one pass of the window.
#[derive(Clone, Debug, PartialEq)]
pub struct State(Value);

/// One widget, as a screen reader is told of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Widget {
    /// Left, top, right and bottom edge; pixels of the window.
    pub rect: [i16; 4],
    /// Whether it is chosen or ticked, for those that can be.
    pub is_on: bool,
    /// Whether it can be used.
    pub is_enabled: bool,
    /// Whether it has the keyboard.
    pub is_focused: bool,
    /// Its text or number, if it has one.
    pub value: Value,
}

impl State {
    /// The newest state; `None` before the first.
    pub(super) fn read(path: &Path) -> Result<Option<Self>> {
        let text = match std::fs::read_to_string(path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            text => text.with_context(|| format!("reading {}", path.display()))?,
        };
        let value = serde_json::from_str(&text).context("reading the window's state")?;
        Ok(Some(Self(value)))
    }

    /// The field `key` of the session.
    pub fn session(&self, key: &str) -> &Value {
        &self.0["session"][key]
    }

    /// Whether the picture on the screen is the final one of what the session holds, and nothing is under way.
    pub fn is_settled(&self) -> bool {
        self.session("settled") == true
    }

    /// Whether the window has seen the pointer at (x, y), pixels of the window.
    pub(super) fn has_pointer_at(&self, x: i16, y: i16) -> bool {
        let at = &self.0["pointer"]["at"];
        at[0] == f64::from(x) && at[1] == f64::from(y)
    }

    /// How often the window has seen a button go up.
    pub(super) fn releases(&self) -> Option<u64> {
        self.0["pointer"]["releases"].as_u64()
    }

    /// The first widget of this role and name, from top to bottom.
    pub fn widget(&self, role: &str, name: &str) -> Option<Widget> {
        let found = self
            .widgets()
            .find(|widget| widget["role"] == *role && widget["name"] == *name)?;
        Widget::from(found)
    }

    /// The first label with this text, from top to bottom.
    pub fn label(&self, text: &str) -> Option<Widget> {
        let found = self
            .widgets()
            .find(|widget| widget["role"] == "Label" && widget["value"] == *text)?;
        Widget::from(found)
    }

    /// Whether any text in the window contains `part`.
    pub fn shows(&self, part: &str) -> bool {
        let texts = self
            .widgets()
            .flat_map(|widget| [&widget["name"], &widget["value"]]);
        texts
            .filter_map(Value::as_str)
            .any(|text| text.contains(part))
    }

    /// The messages in the log, oldest first.
    pub fn messages(&self) -> Vec<&str> {
        let messages = self.session("messages").as_array();
        let texts = messages
            .into_iter()
            .flatten()
            .map(|message| &message["text"]);
        texts.filter_map(Value::as_str).collect()
    }

    /// The errors in the log, oldest first.
    pub fn errors(&self) -> Vec<&str> {
        let messages = self.session("messages").as_array().into_iter().flatten();
        let errors = messages.filter(|message| message["severity"] == "error");
        errors
            .filter_map(|message| message["text"].as_str())
            .collect()
    }

    /// Passes that the window has made over itself.
    pub fn passes(&self) -> Option<u64> {
        self.0["passes"].as_u64()
    }

    /// Every widget of these roles that can be used, with its name.
    pub fn usable(&self, roles: &[&str]) -> Vec<(String, Widget)> {
        let of_roles = self
            .widgets()
            .filter(|widget| roles.iter().any(|role| widget["role"] == *role));
        let named = of_roles.filter_map(|widget| {
            let name = widget["name"].as_str().unwrap_or_default();
            Some((name.to_owned(), Widget::from(widget)?))
        });
        named.filter(|(_, widget)| widget.is_enabled).collect()
    }

    /// The names of the objects on the stage.
    pub fn objects(&self) -> Vec<&str> {
        let objects = self.session("objects").as_array();
        let names = objects.into_iter().flatten().map(|object| &object["name"]);
        names.filter_map(Value::as_str).collect()
    }

    /// Every widget on a line of its own, for the message of a test that failed.
    pub fn describe(&self) -> String {
        let mut text = format!("{:#}\n", self.0["session"]);
        for widget in self.widgets() {
            text.push_str(&widget.to_string());
            text.push('\n');
        }
        text
    }

    fn widgets(&self) -> impl Iterator<Item = &Value> {
        self.0["widgets"].as_array().into_iter().flatten()
    }
}

impl Widget {
    fn from(value: &Value) -> Option<Self> {
        let edges = value["rect"].as_array()?;
        let edge = |index: usize| i16::try_from(edges.get(index)?.as_i64()?).ok();
        Some(Self {
            rect: [edge(0)?, edge(1)?, edge(2)?, edge(3)?],
            is_on: value["on"] == true,
            is_enabled: value["disabled"] != true,
            is_focused: value["focused"] == true,
            value: value["value"].clone(),
        })
    }

    /// Its middle, pixels of the window.
    pub fn middle(&self) -> (i16, i16) {
        let [left, top, right, bottom] = self.rect;
        (left.midpoint(right), top.midpoint(bottom))
    }
}
