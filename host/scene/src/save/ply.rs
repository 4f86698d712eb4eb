//! PLY files, in all three encodings.

use std::io::Write;

use glam::DAffine3;

use super::columns::{Present, axes_of, bytes_of, normal_of};
use super::ply_faces::Faces;
use super::ply_row::{PlyEncoding, Row};
use super::{SaveError, Saving};
use crate::geometry::{Block, NamedColumn, ScalarType};
use crate::job::Job;
use crate::moved::Moved;
use crate::scene::Object;
use crate::warnings::{WarningKind, Warnings};

/// Names that a reader of PLY takes for something else than a column of its own, by what has to be missing for that. A
/// set is taken if it is there as a whole.
const MEANINGS: [(Role, &[&str]); 11] = [
    (Role::Normal, &["nx", "ny", "nz"]),
    (Role::Normal, &["normal_x", "normal_y", "normal_z"]),
    (Role::Colour, &["red", "green", "blue"]),
    (
        Role::Colour,
        &["diffuse_red", "diffuse_green", "diffuse_blue"],
    ),
    (Role::Colour, &["r", "g", "b"]),
    (Role::Radius, &["radius"]),
    (Role::Radius, &["rad"]),
    (Role::Radius, &["psz"]),
    (Role::Radius, &["point_size"]),
    (Role::Radius, &["pointsize"]),
    (Role::Axes, &["ux", "uy", "uz", "vx", "vy", "vz"]),
];

#[derive(Clone, Copy, PartialEq, Eq)]
enum Role {
    Normal,
    Colour,
    Radius,
    Axes,
}

/// Writes an object as a PLY file, where it stands in the scene, with all columns and triangles.
///
/// | column | properties |
/// |---|---|
/// | centre | `x` `y` `z`: floats, or doubles where the object has an origin or a transform |
/// | normal | `nx` `ny` `nz`; zero where it is not known |
/// | radius | `radius`, if any is known |
/// | colour | `red` `green` `blue` `alpha` |
/// | tangent half-axes | `ux` `uy` `uz` `vx` `vy` `vz` |
/// | named | its name; several components as `NAME[0]`, `NAME[1]` … |
///
/// Radii and axes take the object's radius scale; a transform that scales takes radii by the cube root of its determinant. A named column whose name would be taken for one
/// of the others gets another name, with a warning. Textures are left out, with a warning: their pictures are files of their own,
/// which only [`save`](super::save()) has a place for.
///
/// # Errors
/// `out` does not take it, or the job was cancelled.
pub fn write_ply(
    object: &Object,
    encoding: PlyEncoding,
    job: &Job,
    out: &mut impl Write,
) -> Result<Warnings, SaveError> {
    write(object, encoding, &[], job, out)
}

/// Writes an object whose pictures have these names; without names, textures are left out.
pub(super) fn write(
    object: &Object,
    encoding: PlyEncoding,
    picture_names: &[String],
    job: &Job,
    out: &mut impl Write,
) -> Result<Warnings, SaveError> {
    let geometry = &object.geometry;
    let present = Present::of(geometry);
    let mut warnings = Warnings::new();
    let world_from_local = object.world_from_local();
    let moved = (world_from_local != DAffine3::IDENTITY).then(|| Moved::new(world_from_local));
    let names = names(&present, &mut warnings);
    if let Some(textures) = &geometry.textures
        && picture_names.is_empty()
    {
        let text = "textures are left out: the surfels keep the colours of their texels";
        warnings.add(
            WarningKind::Other(text.into()),
            textures.pictures.len() as u64,
        );
    }
    let is_mirrored = moved.as_ref().is_some_and(|moved| moved.mirror < 0.0);
    let faces = Faces::of(geometry, picture_names, is_mirrored);
    let header = header(object, encoding, &present, &names, moved.is_some(), &faces);
    out.write_all(header.as_bytes())?;
    let mut saving = Saving::new(job, geometry.surfel_count + geometry.triangle_count());
    let mut row = Row::new(encoding);
    for block in &geometry.blocks {
        for surfel in 0..block.len() {
            saving.one_more()?;
            push_surfel(
                &mut row,
                block,
                surfel,
                &present,
                moved.as_ref(),
                object.radius_scale,
            );
            row.end(out)?;
        }
    }
    for face in 0..faces.len() {
        saving.one_more()?;
        faces.push(&mut row, face);
        row.end(out)?;
    }
    Ok(warnings)
}

fn header(
    object: &Object,
    encoding: PlyEncoding,
    present: &Present<'_>,
    names: &[String],
    is_moved: bool,
    faces: &Faces<'_>,
) -> String {
    let geometry = &object.geometry;
    let mut lines = vec![
        "ply".to_owned(),
        format!("format {} 1.0", encoding.name()),
        "comment written by Pointstage".to_owned(),
    ];
    lines.extend(faces.comments(present.colours));
    lines.push(format!("element vertex {}", geometry.surfel_count));
    let mut add = |kind: &str, names: &[&str]| {
        lines.extend(names.iter().map(|name| format!("property {kind} {name}")));
    };
    add(if is_moved { "double" } else { "float" }, &["x", "y", "z"]);
    if present.normals {
        add("float", &["nx", "ny", "nz"]);
    }
    if present.radii {
        add("float", &["radius"]);
    }
    if present.colours {
        add("uchar", &["red", "green", "blue", "alpha"]);
    }
    if present.axes {
        add("float", &["ux", "uy", "uz", "vx", "vy", "vz"]);
    }
    for (column, name) in present.named.iter().zip(names) {
        let kind = type_name(column.scalar);
        if column.components == 1 {
            add(kind, &[name]);
        } else {
            for component in 0..column.components {
                add(kind, &[&format!("{name}[{component}]")]);
            }
        }
    }
    if geometry.triangles.is_some() {
        lines.push(format!("element face {}", geometry.triangle_count()));
        lines.extend(faces.properties(geometry.surfel_count));
    }
    lines.push("end_header\n".to_owned());
    lines.join("\n")
}

fn type_name(scalar: ScalarType) -> &'static str {
    match scalar {
        ScalarType::I8 => "char",
        ScalarType::U8 => "uchar",
        ScalarType::I16 => "short",
        ScalarType::U16 => "ushort",
        ScalarType::I32 => "int",
        ScalarType::U32 => "uint",
        ScalarType::F32 => "float",
        ScalarType::F64 => "double",
    }
}

/// The names under which the named columns are written.
fn names(present: &Present<'_>, warnings: &mut Warnings) -> Vec<String> {
    let is_missing = |role: Role| match role {
        Role::Normal => !present.normals,
        Role::Colour => !present.colours,
        Role::Radius => !present.radii,
        Role::Axes => !present.axes,
    };
    let is_there = |name: &str| {
        present
            .named
            .iter()
            .any(|column| column.components == 1 && column.name.eq_ignore_ascii_case(name))
    };
    let is_taken = |column: &NamedColumn| {
        column.components == 1
            && MEANINGS.iter().any(|(role, set)| {
                is_missing(*role)
                    && set
                        .iter()
                        .any(|name| column.name.eq_ignore_ascii_case(name))
                    && set.iter().all(|name| is_there(name))
            })
    };
    let name = |column: &NamedColumn| {
        let word = |c: char| if c.is_ascii_graphic() { c } else { '_' };
        let mut name: String = column.name.chars().map(word).collect();
        if name.is_empty() || is_taken(column) {
            name.insert_str(0, "named_");
        }
        if *name != *column.name {
            let text = format!("column '{}' is saved as '{name}'", column.name);
            warnings.add(WarningKind::Other(text), 1);
        }
        name
    };
    present.named.iter().map(name).collect()
}

fn push_surfel(
    row: &mut Row,
    block: &Block,
    surfel: usize,
    present: &Present<'_>,
    moved: Option<&Moved>,
    radius_scale: f32,
) {
    let [x, y, z, radius] = block.position_radius[surfel];
    let radius = radius * radius_scale;
    let normal = normal_of(block, surfel);
    let axes = axes_of(block, surfel).map(|axis| axis * radius_scale);
    let (normal, axes, radius) = match moved {
        None => {
            row.push_f32s(&[x, y, z]);
            (normal, axes, radius)
        }
        Some(moved) => {
            let position = moved.position(block.centre(surfel).as_dvec3());
            for value in position.to_array() {
                row.push_f64(value);
            }
            (moved.normal(normal), moved.axes(axes), moved.radius(radius))
        }
    };
    if present.normals {
        row.push_f32s(&normal.to_array());
    }
    if present.radii {
        row.push_f32s(&[radius]);
    }
    if present.colours {
        let colours = block.colour.as_ref().map(|colours| colours[surfel]);
        let rgba = colours.unwrap_or(u32::MAX).to_le_bytes();
        for value in rgba {
            row.push_u8(value);
        }
    }
    if present.axes {
        row.push_f32s(axes.map(|axis| axis.to_array()).as_flattened());
    }
    for column in &block.named {
        row.push_values(column.scalar, bytes_of(column, surfel));
    }
}
