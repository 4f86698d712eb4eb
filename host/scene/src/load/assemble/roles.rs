//! What each property of the vertices means.
//!
//! | meaning | names (upper or lower case) |
//! |---|---|
//! | position | `x` `y` `z`; without `z` it is 0 |
//! | normal | `nx` `ny` `nz`, or `normal_x` `normal_y` `normal_z` |
//! | colour | `red` `green` `blue` `alpha`; `r` `g` `b` `a`; `diffuse_red` …; bytes, 16 bits, or floats from 0 to 1 |
//! | radius | `radius`, `rad`, or `psz`, `point_size`, `pointsize` taken as a radius too; scene units |
//! | tangent half-axes | `ux` `uy` `uz` `vx` `vy` `vz` |
//!
//! In files that split the vertices over several elements, `x` of `vertex_normal` is `nx`, `r` of `vertex_color` (or of an
//! element `color`) is `red`, and `0`, `1` of `vertex_NAME` are components of `NAME`. Whatever has no meaning here is kept
//! under its name; `NAME[0]`, `NAME[1]` … become one column. Some renderers know such names: `clip_a0` … are lines that end surfels
//! at sharp edges (`pointstage_plugin_api::clip`).

use super::table::{Field, Table};
use crate::bounds::Bounds;
use crate::geometry::ScalarType;

/// The properties of the vertices by meaning.
#[derive(Debug)]
pub(in crate::load) struct Roles<'t> {
    pub(in crate::load) x: Field<'t>,
    pub(in crate::load) y: Field<'t>,
    pub(in crate::load) z: Option<Field<'t>>,
    /// Box of the positions, if it is known that all of them can be placed.
    pub(in crate::load) bounds: Option<Bounds>,
    pub(in crate::load) normal: Option<[Field<'t>; 3]>,
    /// Red, green, blue.
    pub(in crate::load) colour: Option<[Field<'t>; 3]>,
    pub(in crate::load) alpha: Option<Field<'t>>,
    pub(in crate::load) radius: Option<Field<'t>>,
    /// ux, uy, uz, vx, vy, vz.
    pub(in crate::load) axes: Option<[Field<'t>; 6]>,
    pub(in crate::load) named: Vec<NamedRole<'t>>,
}

/// A property kept under its name.
#[derive(Debug)]
pub(in crate::load) struct NamedRole<'t> {
    pub(in crate::load) name: String,
    pub(in crate::load) scalar: ScalarType,
    /// One a component.
    pub(in crate::load) fields: Vec<Field<'t>>,
}

/// Properties that nobody has claimed yet.
struct Pool<'t> {
    fields: Vec<Option<(String, Field<'t>)>>,
}

impl<'t> Roles<'t> {
    /// Sorts the columns of the vertex elements; `None` without x or y.
    pub(in crate::load) fn assign(tables: &'t [(&str, Table<'_>)]) -> Option<Self> {
        let fields = tables
            .iter()
            .flat_map(|(element, table)| {
                let name = |index: usize| {
                    vertex_name(element, &table.columns[index].name, table.columns.len())
                };
                (0..table.columns.len()).map(move |index| Some((name(index), table.field(index))))
            })
            .collect();
        let mut pool = Pool { fields };
        let [x, y] = pool.take_all(["x", "y"])?;
        let z = pool.take("z");
        let normal = pool
            .take_all(["nx", "ny", "nz"])
            .or_else(|| pool.take_all(["normal_x", "normal_y", "normal_z"]));
        let (colour, alpha) = [
            (["red", "green", "blue"], "alpha"),
            (
                ["diffuse_red", "diffuse_green", "diffuse_blue"],
                "diffuse_alpha",
            ),
            (["r", "g", "b"], "a"),
        ]
        .into_iter()
        .find_map(|(colour, alpha)| Some((Some(pool.take_all(colour)?), pool.take(alpha))))
        .unwrap_or_default();
        let radius = ["radius", "rad", "psz", "point_size", "pointsize"]
            .into_iter()
            .find_map(|name| pool.take(name));
        let axes = pool.take_all(["ux", "uy", "uz", "vx", "vy", "vz"]);
        Some(Self {
            x,
            y,
            z,
            bounds: None,
            normal,
            colour,
            alpha,
            radius,
            axes,
            named: pool.into_named(),
        })
    }
}

impl<'t> Pool<'t> {
    fn position(&self, name: &str) -> Option<usize> {
        self.fields.iter().position(|field| {
            field
                .as_ref()
                .is_some_and(|(own, _)| own.eq_ignore_ascii_case(name))
        })
    }

    fn take(&mut self, name: &str) -> Option<Field<'t>> {
        let position = self.position(name)?;
        self.fields[position].take().map(|(_, field)| field)
    }

    /// All of them, or none is taken.
    fn take_all<const N: usize>(&mut self, names: [&str; N]) -> Option<[Field<'t>; N]> {
        if names.iter().any(|name| self.position(name).is_none()) {
            return None;
        }
        let fields: Vec<Field<'t>> = names.iter().filter_map(|name| self.take(name)).collect();
        fields.try_into().ok()
    }

    /// The rest, with `NAME[0]`, `NAME[1]` … of one type joined.
    fn into_named(self) -> Vec<NamedRole<'t>> {
        let mut named: Vec<NamedRole<'t>> = Vec::new();
        for (name, field) in self.fields.into_iter().flatten() {
            let (base, component) = component_name(&name);
            match named.last_mut() {
                Some(last)
                    if component.is_some_and(|index| index == last.fields.len())
                        && last.name == base
                        && last.scalar == field.scalar =>
                {
                    last.fields.push(field);
                }
                _ => {
                    let name = if component == Some(0) {
                        base.to_owned()
                    } else {
                        name
                    };
                    named.push(NamedRole {
                        name,
                        scalar: field.scalar,
                        fields: vec![field],
                    });
                }
            }
        }
        named
    }
}

/// `a[3]` is component 3 of `a`.
fn component_name(name: &str) -> (&str, Option<usize>) {
    let parts = name
        .strip_suffix(']')
        .and_then(|name| name.rsplit_once('['));
    match parts.and_then(|(base, index)| Some((base, index.parse().ok()?))) {
        Some((base, index)) => (base, Some(index)),
        None => (name, None),
    }
}

/// The name that a property has as one of the vertex.
fn vertex_name(element: &str, property: &str, property_count: usize) -> String {
    let lower = property.to_ascii_lowercase();
    match (element, lower.as_str()) {
        ("vertex_normal", "x" | "y" | "z") => format!("n{lower}"),
        ("vertex_color" | "vertex_colour" | "color" | "colour", "r") => "red".to_owned(),
        ("vertex_color" | "vertex_colour" | "color" | "colour", "g") => "green".to_owned(),
        ("vertex_color" | "vertex_colour" | "color" | "colour", "b") => "blue".to_owned(),
        ("vertex_color" | "vertex_colour" | "color" | "colour", "a") => "alpha".to_owned(),
        (
            "vertex" | "vertex_position" | "vertex_color" | "vertex_colour" | "color" | "colour",
            _,
        ) => property.to_owned(),
        _ => match element.strip_prefix("vertex_") {
            Some(base) if property_count == 1 => base.to_owned(),
            Some(base) if property.parse::<usize>().is_ok() => format!("{base}[{property}]"),
            Some(base) => format!("{base}_{property}"),
            None => property.to_owned(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::super::table::{ByteOrder, TableColumn};
    use super::*;

    fn table(names: &[&str]) -> Table<'static> {
        let column = |(index, name): (usize, &&str)| TableColumn {
            name: (*name).into(),
            scalar: ScalarType::U8,
            offset: index,
        };
        let columns: Vec<TableColumn> = names.iter().enumerate().map(column).collect();
        Table {
            bytes: vec![0; names.len()].into(),
            stride: names.len(),
            rows: 1,
            order: ByteOrder::NATIVE,
            columns,
        }
    }

    fn names(roles: &Roles<'_>) -> Vec<(String, usize)> {
        roles
            .named
            .iter()
            .map(|role| (role.name.clone(), role.fields.len()))
            .collect()
    }

    #[test]
    fn known_names_find_their_role_and_the_rest_stays() {
        let tables = [(
            "vertex",
            table(&[
                "z",
                "X",
                "y",
                "diffuse_blue",
                "diffuse_green",
                "diffuse_red",
                "psz",
                "time",
                "nx",
                "ny",
            ]),
        )];
        let roles = Roles::assign(&tables).unwrap();
        assert!(roles.z.is_some() && roles.colour.is_some() && roles.radius.is_some());
        assert!(roles.normal.is_none(), "nz is missing");
        assert_eq!(
            names(&roles),
            [("time".into(), 1), ("nx".into(), 1), ("ny".into(), 1)]
        );
    }

    #[test]
    fn bracketed_names_are_components_of_one_column() {
        let tables = [("vertex", table(&["x", "y", "a[0]", "a[1]", "b[1]", "b[2]"]))];
        let roles = Roles::assign(&tables).unwrap();
        assert_eq!(
            names(&roles),
            [("a".into(), 2), ("b[1]".into(), 1), ("b[2]".into(), 1)]
        );
    }

    #[test]
    fn split_elements_are_one_vertex() {
        let tables = [
            ("vertex_position", table(&["x", "y", "z"])),
            ("vertex_normal", table(&["x", "y", "z"])),
            ("vertex_color", table(&["r", "g", "b"])),
            ("vertex_a", table(&["0", "1"])),
            ("vertex_time", table(&["t"])),
        ];
        let roles = Roles::assign(&tables).unwrap();
        assert!(roles.normal.is_some() && roles.colour.is_some());
        assert_eq!(names(&roles), [("a".into(), 2), ("time".into(), 1)]);
    }
}
