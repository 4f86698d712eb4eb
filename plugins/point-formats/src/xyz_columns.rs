//! Which column of a text file is what: by the option, by a heading, or by the numbers.

use pointstage_plugin_api::lines::{Line, Lines, number, scan_f64};

use crate::columns::{Kept, Value};

/// Lines that are looked at to guess what the numbers are.
const LINES_LOOKED_AT: usize = 200;

/// What may stand between two values.
fn is_between(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b',' | b';' | 0x0b | 0x0c)
}

/// The numbers at the start of a line, up to the first word that is none.
pub(crate) fn read_numbers(text: &[u8], numbers: &mut Vec<f64>) {
    let mut rest = text;
    loop {
        while let [first, behind @ ..] = rest
            && is_between(*first)
        {
            rest = behind;
        }
        // What nearly every number looks like need not be cut out first.
        let behind = scan_f64(rest).map(|(number, length)| (number, &rest[length..]));
        match behind.filter(|(_, behind)| behind.first().is_none_or(|byte| is_between(*byte))) {
            Some((number, behind)) => {
                numbers.push(number);
                rest = behind;
            }
            None => break,
        }
    }
    numbers.extend(words(rest).map_while(number));
}

/// What stands between blanks, commas and semicolons, without quotes.
pub(crate) fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(|byte| is_between(*byte))
        .filter(|word| !word.is_empty())
        .map(|word| word.strip_prefix(b"\"").unwrap_or(word))
        .map(|word| word.strip_suffix(b"\"").unwrap_or(word))
}

/// What a line is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LineKind {
    /// Nothing, or a comment.
    Empty,
    /// One whole number: how many points follow.
    Count,
    /// Numbers; how many.
    Numbers(usize),
    /// Words, among which x, y and z are.
    Heading(Vec<String>),
    /// Something else.
    Other,
}

/// What `line` is.
pub(crate) fn kind_of(line: &Line<'_>) -> LineKind {
    let text = line.text.trim_ascii();
    let all: Vec<&[u8]> = words(text).collect();
    // A heading may stand in a comment: CloudCompare writes '//X Y Z'.
    let bare = text.trim_ascii_start();
    let bare = bare.strip_prefix(b"//").or_else(|| bare.strip_prefix(b"#"));
    let names: Vec<String> = words(bare.unwrap_or(text))
        .map(|word| String::from_utf8_lossy(word).into_owned())
        .collect();
    let has = |name: &str| names.iter().any(|own| own.eq_ignore_ascii_case(name));
    if all.is_empty() {
        return LineKind::Empty;
    }
    if all.iter().all(|word| number(word).is_some()) {
        let is_count = all.len() == 1 && all[0].iter().all(u8::is_ascii_digit);
        return if is_count {
            LineKind::Count
        } else {
            LineKind::Numbers(all.len())
        };
    }
    if has("x") && has("y") && has("z") {
        return LineKind::Heading(names);
    }
    if bare.is_some() {
        LineKind::Empty
    } else {
        LineKind::Other
    }
}

/// The values of each point, from the file's first lines; `None` if there is no point among them.
pub(crate) fn guess(text: &[u8]) -> Option<Vec<Value>> {
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for line in Lines::new(text) {
        match kind_of(&line) {
            LineKind::Heading(names) if rows.is_empty() => return Some(named(&names)),
            LineKind::Numbers(count) if rows.first().is_none_or(|first| first.len() == count) => {
                rows.push(words(line.text).filter_map(number).collect());
            }
            _ => {}
        }
        if rows.len() == LINES_LOOKED_AT {
            break;
        }
    }
    let width = rows.first()?.len();
    if width < 3 {
        return None;
    }
    let all = |columns: std::ops::Range<usize>, holds: &dyn Fn(&[f64]) -> bool| {
        columns.end <= width && rows.iter().all(|row| holds(&row[columns.clone()]))
    };
    let is_bytes = |values: &[f64]| {
        values
            .iter()
            .all(|value| value.fract() == 0.0 && (0.0..=255.0).contains(value))
    };
    let is_unit = |values: &[f64]| {
        let square: f64 = values.iter().map(|value| value * value).sum();
        (square - 1.0).abs() < 0.02
    };
    let mut names = vec!["x", "y", "z"];
    while names.len() < width {
        let at = names.len();
        let three = at..at + 3;
        let is_free = |name: &str| !names.contains(&name);
        if is_free("nx") && all(three.clone(), &is_unit) {
            names.extend(["nx", "ny", "nz"]);
        } else if is_free("r") && all(three, &is_bytes) {
            names.extend(["r", "g", "b"]);
        } else if is_free("intensity") {
            names.push("intensity");
        } else {
            names.push("value");
        }
    }
    Some(named(&names))
}

/// Values of these names, kept as their names suggest.
pub(crate) fn named<N: AsRef<str>>(names: &[N]) -> Vec<Value> {
    let is_any = |name: &str, of: &[&str]| of.iter().any(|other| name.eq_ignore_ascii_case(other));
    let value = |name: &N| {
        let name = name.as_ref();
        let kept = if is_any(name, &["x", "y", "z"]) {
            Kept::F64
        } else {
            Kept::F32
        };
        // Headings of other programs, by the names that the rest knows.
        let name = match name.to_ascii_lowercase().as_str() {
            "rf" => "r",
            "gf" => "g",
            "bf" => "b",
            _ => name,
        };
        Value {
            name: name.to_owned(),
            kept,
        }
    };
    names.iter().map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guessed(text: &str) -> String {
        let values = guess(text.as_bytes()).unwrap_or_default();
        let names: Vec<String> = values.into_iter().map(|value| value.name).collect();
        names.join(" ")
    }

    #[test]
    fn columns_are_guessed_from_the_numbers() {
        for (text, expected) in [
            ("1 2 3\n", "x y z"),
            ("1 2 3 0.5\n", "x y z intensity"),
            ("1 2 3 255 0 7\n", "x y z r g b"),
            ("1 2 3 0 0 1\n4 5 6 0.6 0 -0.8\n", "x y z nx ny nz"),
            (
                "2\n1 2 3 -1200 255 0 7\n1 2 3 5 1 0 7",
                "x y z intensity r g b",
            ),
            ("1,2,3,9,8,7,0.6,0.8,0", "x y z r g b nx ny nz"),
            ("1;2;3;0.5;0.25", "x y z intensity value"),
            (
                "# a comment\n\n//X Y Z Rf Gf Bf Time\n1 2 3 0.1 0.2 0.3 9",
                "X Y Z r g b Time",
            ),
            ("\"x\",\"y\",\"z\"\n1,2,3", "x y z"),
            ("1 2\n", ""),
            ("hello world\n", ""),
        ] {
            assert_eq!(guessed(text), expected, "{text}");
        }
    }
}
