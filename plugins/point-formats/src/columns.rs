//! What each value of a point means, by its name, and runs of points as the host takes them; for formats whose values have
//! names (PCD, text).

use std::collections::{HashMap, HashSet};

use pointstage_plugin_api::abi::ScalarType;
use pointstage_plugin_api::loading::{Column, Output, bytes_of};
use pointstage_plugin_api::{ColumnRole, Error, Result};

/// Points handed over at once: a few milliseconds between two looks at the cancel flag.
pub(crate) const RUN: usize = 1 << 16;

/// Points of so many values handed over at once.
pub(crate) fn run_of(width: usize) -> usize {
    const MOST_VALUES: usize = 1 << 22;
    (MOST_VALUES / width.max(1)).clamp(1, RUN)
}

/// How a value is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kept {
    U8,
    U16,
    I32,
    U32,
    F32,
    F64,
    /// Red, green and blue in the lower three bytes.
    PackedColour,
}

impl Kept {
    fn scalar(self) -> ScalarType {
        match self {
            Self::U8 | Self::PackedColour => ScalarType::U8,
            Self::U16 => ScalarType::U16,
            Self::I32 => ScalarType::I32,
            Self::U32 => ScalarType::U32,
            Self::F32 => ScalarType::F32,
            Self::F64 => ScalarType::F64,
        }
    }

    /// Writes a value in native byte order; integers saturate.
    fn write(self, value: f64, out: &mut Vec<u8>) {
        match self {
            Self::U8 => out.push(value as u8),
            Self::U16 => out.extend((value as u16).to_ne_bytes()),
            Self::I32 => out.extend((value as i32).to_ne_bytes()),
            Self::U32 => out.extend((value as u32).to_ne_bytes()),
            Self::F32 => out.extend((value as f32).to_ne_bytes()),
            Self::F64 => out.extend(value.to_ne_bytes()),
            Self::PackedColour => {
                let [blue, green, red, _] = (value as u32).to_le_bytes();
                out.extend([red, green, blue]);
            }
        }
    }
}

/// One value of a point: its name, and how it is kept.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Value {
    pub(crate) name: String,
    pub(crate) kept: Kept,
}

/// A column of the host's, and the places of its components among a point's values.
#[derive(Clone, Debug, PartialEq)]
struct Group {
    role: ColumnRole,
    name: String,
    kept: Kept,
    places: Vec<usize>,
}

/// Columns of the host's made of named values.
#[derive(Clone, Debug)]
pub(crate) struct Columns {
    groups: Vec<Group>,
    /// Values a point.
    width: usize,
}

/// Names that mean the same, lower case.
const POSITIONS: [[&str; 3]; 2] = [["x", "y", "z"], ["//x", "y", "z"]];
const NORMALS: [[&str; 3]; 2] = [["nx", "ny", "nz"], ["normal_x", "normal_y", "normal_z"]];
const COLOURS: [[&str; 3]; 2] = [["r", "g", "b"], ["red", "green", "blue"]];

impl Columns {
    /// The columns of a point's values. A value called `_` is left out.
    ///
    /// # Errors
    /// There is no x, y and z.
    pub(crate) fn new(values: &[Value]) -> Result<Self> {
        let mut is_taken = vec![false; values.len()];
        let mut groups = Vec::new();
        let find = |is_taken: &[bool], name: &str| {
            let fits = |(index, value): (usize, &Value)| {
                !is_taken[index] && value.name.eq_ignore_ascii_case(name)
            };
            values.iter().enumerate().position(fits)
        };
        for (role, sets) in [
            (ColumnRole::POSITION, POSITIONS),
            (ColumnRole::NORMAL, NORMALS),
            (ColumnRole::COLOUR, COLOURS),
        ] {
            let places = sets.iter().find_map(|names| {
                let places = names.iter().map(|name| find(&is_taken, name));
                places.collect::<Option<Vec<usize>>>()
            });
            let Some(places) = places else { continue };
            for place in &places {
                is_taken[*place] = true;
            }
            let own = places.iter().map(|place| values[*place].kept);
            groups.push(Group {
                role,
                name: String::new(),
                kept: common(own),
                places,
            });
        }
        if groups
            .first()
            .is_none_or(|group| group.role != ColumnRole::POSITION)
        {
            let names: Vec<&str> = values.iter().map(|value| value.name.as_str()).collect();
            return Err(Error::failed(format!(
                "expected values called x, y and z, found {}; there is nothing to show, export the file with positions",
                if names.is_empty() {
                    "none".to_owned()
                } else {
                    names.join(", ")
                }
            )));
        }
        let has_colour = groups.iter().any(|group| group.role == ColumnRole::COLOUR);
        let packed = values
            .iter()
            .position(|value| value.kept == Kept::PackedColour)
            .filter(|_| !has_colour);
        if let Some(place) = packed {
            is_taken[place] = true;
            groups.push(Group {
                role: ColumnRole::COLOUR,
                name: String::new(),
                kept: Kept::PackedColour,
                places: vec![place],
            });
        }
        if let Some(place) = find(&is_taken, "radius") {
            is_taken[place] = true;
            groups.push(Group {
                role: ColumnRole::RADIUS,
                name: String::new(),
                kept: values[place].kept,
                places: vec![place],
            });
        }
        let mut names = Names::default();
        // What comes without a name gets a number.
        names.taken.insert(String::new());
        for (place, value) in values.iter().enumerate() {
            if is_taken[place] || value.name == "_" || value.kept == Kept::PackedColour {
                continue;
            }
            // Values of one name, one behind the other, are components of one column.
            match groups.last_mut() {
                Some(last)
                    if last.role == ColumnRole::NAMED
                        && last.name == value.name
                        && last.kept == value.kept
                        && last.places.last() == Some(&(place.wrapping_sub(1))) =>
                {
                    last.places.push(place);
                }
                _ => groups.push(Group {
                    role: ColumnRole::NAMED,
                    name: names.unique(&value.name),
                    kept: value.kept,
                    places: vec![place],
                }),
            }
        }
        Ok(Self {
            groups,
            width: values.len(),
        })
    }

    /// Tells the host what will come.
    pub(crate) fn declare(&self, out: &mut Output<'_>, expected: u64) -> Result<()> {
        let declared: Vec<Column<'_>> = self
            .groups
            .iter()
            .map(|group| Column {
                role: group.role,
                scalar: group.kept.scalar(),
                components: match group.kept {
                    Kept::PackedColour => 3,
                    _ => group.places.len() as u32,
                },
                name: &group.name,
            })
            .collect();
        out.columns(&declared, expected)
    }

    /// Hands over points: the values of each, one after the other.
    pub(crate) fn write(&self, out: &mut Output<'_>, values: &[f64]) -> Result<()> {
        self.bytes(values).write(out)
    }

    /// Points as the host takes them: the values of each, one after the other.
    pub(crate) fn bytes(&self, values: &[f64]) -> Bytes {
        let count = values.len() / self.width.max(1);
        let columns = self
            .groups
            .iter()
            .map(|group| {
                let mut bytes = Vec::with_capacity(count * group.places.len() * 8);
                for point in values.chunks_exact(self.width) {
                    for place in &group.places {
                        group.kept.write(point[*place], &mut bytes);
                    }
                }
                bytes
            })
            .collect();
        Bytes { count, columns }
    }
}

/// Points as the host takes them.
pub(crate) struct Bytes {
    count: usize,
    columns: Vec<Vec<u8>>,
}

impl Bytes {
    /// Hands them over.
    pub(crate) fn write(&self, out: &mut Output<'_>) -> Result<()> {
        let columns: Vec<&[u8]> = self.columns.iter().map(|bytes| bytes_of(bytes)).collect();
        out.rows(self.count, &columns)
    }
}

/// Names that columns have.
#[derive(Default)]
struct Names<'v> {
    taken: HashSet<String>,
    /// The last number behind each name that came again.
    numbers: HashMap<&'v str, u64>,
}

impl<'v> Names<'v> {
    /// A name that no column has yet: a number is put behind one that comes again.
    fn unique(&mut self, name: &'v str) -> String {
        let mut own = name.to_owned();
        while !self.taken.insert(own.clone()) {
            let number = self.numbers.entry(name).or_insert(1);
            *number += 1;
            own = format!("{name}_{number}");
        }
        own
    }
}

/// The one way to keep several values: their own if they agree, else f64.
fn common(mut kept: impl Iterator<Item = Kept>) -> Kept {
    let first = kept.next().unwrap_or(Kept::F64);
    if kept.all(|other| other == first) {
        first
    } else {
        Kept::F64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(name: &str, kept: Kept) -> Value {
        Value {
            name: name.to_owned(),
            kept,
        }
    }

    #[test]
    fn names_find_their_role_and_the_rest_stays() {
        let values = [
            value("X", Kept::F32),
            value("y", Kept::F32),
            value("z", Kept::F64),
            value("time", Kept::F64),
            value("_", Kept::U8),
            value("d", Kept::F32),
            value("d", Kept::F32),
            value("time", Kept::F64),
            value("rgb", Kept::PackedColour),
            value("time_2", Kept::F64),
            value("time", Kept::F64),
        ];
        let columns = Columns::new(&values).expect("has positions");
        let found: Vec<(ColumnRole, &str, Kept, usize)> = columns
            .groups
            .iter()
            .map(|group| {
                (
                    group.role,
                    group.name.as_str(),
                    group.kept,
                    group.places.len(),
                )
            })
            .collect();
        assert_eq!(
            found,
            [
                (ColumnRole::POSITION, "", Kept::F64, 3),
                (ColumnRole::COLOUR, "", Kept::PackedColour, 1),
                (ColumnRole::NAMED, "time", Kept::F64, 1),
                (ColumnRole::NAMED, "d", Kept::F32, 2),
                (ColumnRole::NAMED, "time_2", Kept::F64, 1),
                (ColumnRole::NAMED, "time_2_2", Kept::F64, 1),
                (ColumnRole::NAMED, "time_3", Kept::F64, 1),
            ]
        );
        let error = Columns::new(&values[1..]).expect_err("no x").to_string();
        assert!(
            error.contains("x, y and z") && error.contains("time"),
            "{error}"
        );
    }

    /// To look through all names for each would take hours.
    #[test]
    fn many_columns_may_have_few_names() {
        let mut values = ["x", "y", "z"].map(|name| value(name, Kept::F32)).to_vec();
        for _ in 0..20_000 {
            values.extend(["a", "b"].map(|name| value(name, Kept::F32)));
        }
        let columns = Columns::new(&values).expect("has positions");
        let last = columns.groups.last().map(|group| group.name.as_str());
        assert_eq!(last, Some("b_20000"));
    }
}
