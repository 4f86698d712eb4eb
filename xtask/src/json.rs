//! As much JSON as it takes to read what the program says about its plugins, its pictures and its comparisons.

/// A JSON value; `true`, `false` and `null` keep their word.
#[derive(Debug, PartialEq)]
pub(crate) enum Value {
    Word(String),
    Number(f64),
    Text(String),
    List(Vec<Value>),
    Object(Vec<(String, Value)>),
}

impl Value {
    /// Reads a whole document; `None` when it is not JSON.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let mut reader = Reader { rest: text };
        let value = reader.value()?;
        reader.skip_space();
        reader.rest.is_empty().then_some(value)
    }

    /// The value under `key`, when this is an object that has one.
    pub(crate) fn get(&self, key: &str) -> Option<&Self> {
        let Self::Object(entries) = self else {
            return None;
        };
        let mut named = entries.iter().filter(|(name, _)| name == key);
        named.next().map(|(_, value)| value)
    }

    /// The text under `key`.
    pub(crate) fn text(&self, key: &str) -> Option<&str> {
        match self.get(key)? {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The number under `key`.
    pub(crate) fn number(&self, key: &str) -> Option<f64> {
        self.get(key)?.as_number()
    }

    /// Whether `true` is under `key`.
    pub(crate) fn is_true(&self, key: &str) -> bool {
        matches!(self.get(key), Some(Self::Word(word)) if word == "true")
    }

    /// The number, when this is one.
    pub(crate) fn as_number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            _ => None,
        }
    }

    /// The items of a list; none of anything else.
    pub(crate) fn items(&self) -> &[Self] {
        match self {
            Self::List(items) => items,
            _ => &[],
        }
    }

    /// This value and all values inside it, in the document's order.
    pub(crate) fn all(&self) -> Vec<&Self> {
        let mut found = vec![self];
        match self {
            Self::List(items) => found.extend(items.iter().flat_map(Self::all)),
            Self::Object(entries) => {
                found.extend(entries.iter().flat_map(|(_, value)| value.all()));
            }
            Self::Word(_) | Self::Number(_) | Self::Text(_) => {}
        }
        found
    }
}

struct Reader<'a> {
    rest: &'a str,
}

impl Reader<'_> {
    fn value(&mut self) -> Option<Value> {
        self.skip_space();
        match self.rest.chars().next()? {
            '"' => self.string().map(Value::Text),
            '[' => self.sequence('[', ']', Self::value).map(Value::List),
            '{' => self.sequence('{', '}', Self::entry).map(Value::Object),
            _ => {
                let end = self
                    .rest
                    .find([',', ']', '}', ' ', '\n', '\r', '\t'])
                    .unwrap_or(self.rest.len());
                let (word, rest) = self.rest.split_at(end);
                self.rest = rest;
                match word {
                    "true" | "false" | "null" => Some(Value::Word(word.to_owned())),
                    _ => word.parse().ok().map(Value::Number),
                }
            }
        }
    }

    fn entry(&mut self) -> Option<(String, Value)> {
        self.skip_space();
        let key = self.string()?;
        self.take(':').then_some(())?;
        Some((key, self.value()?))
    }

    fn sequence<T>(
        &mut self,
        open: char,
        close: char,
        item: fn(&mut Self) -> Option<T>,
    ) -> Option<Vec<T>> {
        self.take(open).then_some(())?;
        let mut items = Vec::new();
        if self.take(close) {
            return Some(items);
        }
        loop {
            items.push(item(self)?);
            if self.take(close) {
                return Some(items);
            }
            self.take(',').then_some(())?;
        }
    }

    fn string(&mut self) -> Option<String> {
        let mut text = String::new();
        let mut chars = self.rest.strip_prefix('"')?.chars();
        loop {
            match chars.next()? {
                '"' => break,
                '\\' => text.push(match chars.next()? {
                    'n' => '\n',
                    't' => '\t',
                    'r' => '\r',
                    'b' => '\u{8}',
                    'f' => '\u{c}',
                    'u' => {
                        let digits: String = chars.by_ref().take(4).collect();
                        // Half of a surrogate pair has no character of its own; no key or id uses one.
                        char::from_u32(u32::from_str_radix(&digits, 16).ok()?)
                            .unwrap_or(char::REPLACEMENT_CHARACTER)
                    }
                    other => other,
                }),
                other => text.push(other),
            }
        }
        self.rest = chars.as_str();
        Some(text)
    }

    fn take(&mut self, expected: char) -> bool {
        self.skip_space();
        match self.rest.strip_prefix(expected) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn skip_space(&mut self) {
        self.rest = self.rest.trim_start();
    }
}

#[cfg(test)]
mod tests {
    use super::Value;

    #[test]
    fn nested_text_is_found_in_order() {
        let value =
            Value::parse(r#" {"a": [1, -2.5e3, {"id": "x\"y"}], "b": {}, "id": "z", "c": null} "#)
                .unwrap();
        let ids: Vec<_> = value
            .all()
            .iter()
            .filter_map(|value| value.text("id"))
            .collect();
        assert_eq!(ids, ["z", "x\"y"]);
    }

    #[test]
    fn values_are_found_by_their_keys() {
        let value = Value::parse(r#"{"a": [1, -2.5e3], "b": true, "c": {"d": 7}, "e": null}"#)
            .expect("well formed");
        let list = value.get("a").expect("a list");
        let numbers: Vec<_> = list.items().iter().map(Value::as_number).collect();
        assert_eq!(numbers, [Some(1.0), Some(-2500.0)]);
        assert!(value.is_true("b") && !value.is_true("e"));
        assert_eq!(value.get("c").and_then(|c| c.number("d")), Some(7.0));
        assert_eq!(value.number("e"), None);
    }

    #[test]
    fn what_is_not_json_is_refused() {
        for text in ["", "{", "[1,]", "{\"a\" 1}", "nonsense", "[] []", "\"open"] {
            assert_eq!(Value::parse(text), None, "{text}");
        }
    }
}
