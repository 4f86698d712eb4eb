//! What each element of a file is for.

use super::error::PlyError;
use super::header::{Element, PlyHeader, PropertyKind};
use crate::geometry::ScalarType;
use crate::load::assemble::{FaceKind, MOST_VERTICES};

/// Names of the lists that hold the corners of faces.
const CORNER_LISTS: [&str; 4] = ["vertex_indices", "vertex_index", "vertex_list", "indices"];

/// Use of one element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ElementUse {
    /// Its scalars are columns of surfels.
    Vertices,
    /// One of its lists holds corners.
    Faces(FaceLists),
    /// Nothing here comes from it.
    Skipped,
}

/// The lists of a face element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FaceLists {
    /// Index of the property with the corners.
    pub(super) corners: usize,
    /// Index of a property that lists the corner counts of holes.
    pub(super) holes: Option<usize>,
    pub(super) kind: FaceKind,
    pub(super) extras: FaceExtras,
}

/// Indices of properties that say what colour a polygon has; of those that are wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct FaceExtras {
    /// A list of u and v of each corner.
    pub(super) uvs: Option<usize>,
    /// The number of the picture.
    pub(super) picture: Option<usize>,
    /// Red, green, blue.
    pub(super) colour: Option<[usize; 3]>,
    /// Alpha of that colour.
    pub(super) alpha: Option<usize>,
}

impl FaceExtras {
    /// Whether rows need to be read for more than their corners.
    pub(super) fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    fn of(element: &Element, wants_colours: bool) -> Self {
        let is_list =
            |index: &usize| matches!(element.properties[*index].kind, PropertyKind::List { .. });
        let scalar = |name: &str| element.find(name).filter(|index| !is_list(index));
        let uvs = element.find("texcoord").filter(is_list);
        let colour = || Some([scalar("red")?, scalar("green")?, scalar("blue")?]);
        let colour = wants_colours.then(colour).flatten();
        Self {
            uvs,
            picture: uvs.and_then(|_| scalar("texnumber")),
            colour,
            alpha: colour.and_then(|_| scalar("alpha")),
        }
    }
}

/// The use of each element, in file order.
///
/// Vertices are the element `vertex`; where there is none, the elements `vertex_…` around a `vertex_position`; where there
/// are none, the first element with x and y, whatever its name. An element `color` as long as the vertices belongs to them.
pub(super) fn plan(header: &PlyHeader) -> Result<Vec<ElementUse>, PlyError> {
    let elements = &header.elements;
    let has_position =
        |element: &Element| element.find("x").is_some() && element.find("y").is_some();
    let named = |name: &str| elements.iter().find(|element| element.name == name);
    let first = named("vertex")
        .filter(|element| has_position(element))
        .or_else(|| named("vertex_position").filter(|element| has_position(element)))
        .or_else(|| elements.iter().find(|element| has_position(element)))
        .ok_or_else(|| no_positions(elements))?;
    if first.count == 0 {
        return Err(PlyError::NoVertices {
            element: first.name.clone(),
        });
    }
    if first.count > MOST_VERTICES {
        return Err(PlyError::TooManyVertices {
            element: first.name.clone(),
            rows: first.count,
        });
    }
    let split = first.name == "vertex_position";
    let wants_colours = !elements.iter().any(|element| {
        let is_vertices = std::ptr::eq(element, first) || element.name.starts_with("vertex_");
        let is_coloured = ["red", "diffuse_red", "r"]
            .iter()
            .any(|name| element.find(name).is_some());
        (is_vertices || element.name.starts_with("colo")) && is_coloured
    });
    let use_of = |element: &Element| {
        let is_colour =
            matches!(element.name.as_str(), "color" | "colour") && element.count == first.count;
        if std::ptr::eq(element, first)
            || is_colour
            || (split && element.name.starts_with("vertex_"))
        {
            if element.count != first.count {
                return Err(PlyError::SplitRows {
                    first: first.name.clone(),
                    expected: first.count,
                    element: element.name.clone(),
                    found: element.count,
                });
            }
            return Ok(ElementUse::Vertices);
        }
        Ok(face_lists(element, wants_colours).map_or(ElementUse::Skipped, ElementUse::Faces))
    };
    elements.iter().map(use_of).collect()
}

fn no_positions(elements: &[Element]) -> PlyError {
    if elements
        .iter()
        .any(|element| element.find("packed_position").is_some())
    {
        return PlyError::CompressedSplat;
    }
    let found = elements
        .iter()
        .map(|element| {
            let names: Vec<&str> = element
                .properties
                .iter()
                .map(|property| property.name.as_str())
                .take(8)
                .collect();
            format!(
                "'{}' with {}",
                element.name,
                if names.is_empty() {
                    "nothing".into()
                } else {
                    names.join(", ")
                }
            )
        })
        .collect::<Vec<_>>()
        .join("; ");
    PlyError::NoPositions {
        found: if found.is_empty() {
            "no elements".into()
        } else {
            found
        },
    }
}

fn face_lists(element: &Element, wants_colours: bool) -> Option<FaceLists> {
    let kind = match element.name.as_str() {
        "face" | "faces" | "polygon" => FaceKind::Polygons,
        "tristrips" | "tristrip" => FaceKind::Strips,
        _ => return None,
    };
    let is_list =
        |index: &usize| matches!(element.properties[*index].kind, PropertyKind::List { .. });
    let is_integer_list = |index: &usize| {
        matches!(
            element.properties[*index].kind,
            PropertyKind::List {
                item: ScalarType::I8
                    | ScalarType::U8
                    | ScalarType::I16
                    | ScalarType::U16
                    | ScalarType::I32
                    | ScalarType::U32,
                ..
            }
        )
    };
    let corners = CORNER_LISTS
        .iter()
        .filter_map(|name| element.find(name))
        .find(is_list)
        .or_else(|| (0..element.properties.len()).find(is_integer_list))?;
    let holes = element.find("inner_vertex_counts").filter(is_list);
    let extras = match kind {
        FaceKind::Polygons => FaceExtras::of(element, wants_colours),
        FaceKind::Strips => FaceExtras::default(),
    };
    Some(FaceLists {
        corners,
        holes,
        kind,
        extras,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan_of(body: &str) -> Result<Vec<ElementUse>, PlyError> {
        let text = format!("ply\nformat ascii 1.0\n{body}\nend_header\n");
        plan(&PlyHeader::parse(text.as_bytes()).expect("header of the test"))
    }

    #[test]
    fn vertices_are_found_by_name_then_by_what_they_hold() {
        assert_eq!(
            plan_of("element point 1\nproperty int x\nproperty int y").unwrap(),
            [ElementUse::Vertices]
        );
        let split = "element vertex_position 1\nproperty float x\nproperty float y\nelement vertex_a 1\nproperty float 0";
        assert_eq!(plan_of(split).unwrap(), [ElementUse::Vertices; 2]);
    }

    #[test]
    fn the_corner_list_is_found_among_others() {
        let uses = plan_of("element vertex 1\nproperty int x\nproperty int y\nelement face 1\nproperty list uchar float texcoord\nproperty list uchar int corners").unwrap();
        let lists = FaceLists {
            corners: 1,
            holes: None,
            kind: FaceKind::Polygons,
            extras: FaceExtras {
                uvs: Some(0),
                ..FaceExtras::default()
            },
        };
        assert_eq!(uses[1], ElementUse::Faces(lists));
    }

    #[test]
    fn colours_of_faces_are_read_where_vertices_have_none() {
        let faces = "element face 1\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\nproperty uchar blue";
        for (vertex, colour) in [("", Some([1, 2, 3])), ("\nproperty uchar red", None)] {
            let text = format!("element vertex 1\nproperty int x\nproperty int y{vertex}\n{faces}");
            let uses = plan_of(&text).unwrap();
            let ElementUse::Faces(lists) = uses[1] else {
                panic!("faces are {:?}", uses[1]);
            };
            assert_eq!(lists.extras.colour, colour);
        }
    }

    #[test]
    fn files_without_positions_say_what_they_have() {
        for (body, part) in [
            (
                "element vertex 1\nproperty uint packed_position",
                "compressed Gaussian splat",
            ),
            ("element vertex 1\nproperty float u", "'vertex' with u"),
            (
                "element vertex 0\nproperty float x\nproperty float y",
                "0 rows",
            ),
            ("comment nothing", "no elements"),
        ] {
            let error = plan_of(body).expect_err(body).to_string();
            assert!(error.contains(part), "{body} gave: {error}");
        }
    }
}
