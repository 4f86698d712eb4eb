//! Colours of vertices from pictures and from colours of faces.
//!
//! A picture (`comment TextureFile NAME`) comes before the vertices' own colours, these before those of faces. Texture coordinates
//! are those of the faces' corners (`texcoord`, with `texnumber` where there are several pictures), else those of the vertices
//! (`texture_u`, `u` or `s`, and their partners). `pointstage_texels` says what a vertex takes.
//!
//! A comment `TextureColours` says that the vertices have the colours of these very pictures already, as files have that were saved
//! here: then nothing is divided, and all colours and columns are as they were.
//!
//! Texture coordinates of corners become the columns `texture_u` and `texture_v`: of a vertex that has several, those of the
//! first face that names it.

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use pointstage_texels::{
    Alpha, LightSum, MOST_VERTICES, Material, Picture, PictureFile, Surface, colours, divide,
    face_colours, linear, picture_files, polygon::triangulate, read_beside, srgb_byte,
};

use super::body::{Body, Stop};
use super::header::NamedPictures;
use super::places::{keep_pictures, triangles_of};
use super::textures::Textures;
use crate::geometry::{Provenance, ScalarType};
use crate::job::Job;
use crate::load::assemble::{
    Built, ByteOrder, CornerLists, Corners, FaceKind, Roles, RowSelection, Table, TableColumn,
    write_native,
};
use crate::textures::fingerprint;
use crate::warnings::{WarningKind, Warnings};

/// Names of columns that hold the texture coordinates of vertices.
const UV_NAMES: [[&str; 2]; 4] = [
    ["texture_u", "texture_v"],
    ["texture_s", "texture_t"],
    ["u", "v"],
    ["s", "t"],
];

/// What pictures and faces give.
#[derive(Default)]
pub(super) struct Found {
    /// Colours for rows of the vertices.
    pub(super) lights: Option<Vec<LightSum>>,
    /// What the faces' data count then.
    pub(super) pictures: Vec<PictureFile>,
}

/// Colours for rows of the vertices, where pictures or faces give any. Adds rows to the body where triangles are divided.
pub(super) fn find(
    body: &mut Body<'_>,
    named: &NamedPictures,
    file: &Path,
    how: Textures,
    job: &Job,
    warnings: &mut Warnings,
) -> Result<Found, Stop> {
    let Some(positions) = positions(body) else {
        return Ok(Found::default());
    };
    let corner_uvs = body.faces.iter().any(|faces| match faces {
        Corners::Lists(lists) => !lists.data.uvs.is_empty(),
        Corners::Triangles(_) => false,
    });
    let row_uvs = if corner_uvs { None } else { row_uvs(body) };
    if how != Textures::None && !named.names.is_empty() && (corner_uvs || row_uvs.is_some()) {
        let materials = read_pictures(&named.names, file, warnings);
        let (pictures, indices) = picture_files(&materials);
        let is_coloured = named
            .coloured_by
            .is_some_and(|known| known == fingerprint(&pictures));
        if is_coloured && !pictures.is_empty() {
            keep_pictures(body, row_uvs.as_deref(), &indices);
            let lights = None;
            return Ok(Found { lights, pictures });
        }
        if !pictures.is_empty() {
            let mut surface = surface(body, positions.clone(), row_uvs.as_deref());
            let is_divided = how == Textures::Divide
                && !has_strips(body)
                && divide_triangles(body, &mut surface, &materials, job, warnings)?;
            job.set_stage("taking colours from textures");
            let lights = Some(colours(&surface, &materials, |_| job.check())?);
            if corner_uvs {
                add_uvs(body, &surface);
            }
            if is_divided {
                body.faces = vec![triangles_of(&surface, &indices)];
            } else {
                keep_pictures(body, row_uvs.as_deref(), &indices);
            }
            return Ok(Found { lights, pictures });
        }
    }
    if corner_uvs {
        let surface = surface(body, positions.clone(), None);
        add_uvs(body, &surface);
    }
    let mut lights = None;
    for faces in &body.faces {
        if let Corners::Lists(CornerLists {
            lengths,
            corners,
            data,
            ..
        }) = faces
            && !data.colours.is_empty()
        {
            job.check()?;
            let position = |corner: u32| {
                let place = positions.get(corner as usize);
                place.map_or(DVec3::NAN, |place| DVec3::from_array(*place))
            };
            let colour = |face: usize| {
                let [red, green, blue, alpha] = *data.colours.get(face)?;
                Some([linear(red), linear(green), linear(blue), alpha])
            };
            let lengths = lengths.iter().copied();
            lights = Some(face_colours(
                positions.len(),
                lengths,
                corners,
                position,
                colour,
            ));
        }
    }
    Ok(Found {
        lights,
        pictures: Vec::new(),
    })
}

/// Divides triangles that are coarser than their picture, and adds rows for the new vertices; whether there were any.
fn divide_triangles(
    body: &mut Body<'_>,
    surface: &mut Surface,
    materials: &[Material],
    job: &Job,
    warnings: &mut Warnings,
) -> Result<bool, Stop> {
    job.set_stage("dividing triangles");
    let divided = divide(surface, materials, MOST_VERTICES, || job.check())?;
    warnings.add(
        WarningKind::Other(format!(
            "texture finer than {MOST_VERTICES} vertices can show: they take the mean of many texels"
        )),
        u64::from(divided.is_cut_short),
    );
    if !divided.parents.is_empty() {
        extend_tables(body, &divided.parents);
    }
    Ok(!divided.parents.is_empty())
}

/// Gives surfels the colours of their rows; where a row has none, the surfel keeps its own, or is white.
pub(super) fn apply(built: &mut Built, sums: &[LightSum]) {
    let is_kept = |row: &usize| match &built.new_index {
        None => true,
        Some(new_index) => new_index.get(*row).is_some_and(|index| *index != u32::MAX),
    };
    let mut rows = (0..sums.len()).filter(is_kept);
    for block in &mut built.blocks {
        let own = block.colour.take();
        let mut colour_of = |surfel: usize| {
            let mean = rows.next().and_then(|row| sums.get(row)?.mean());
            let own = own.as_ref().and_then(|own| own.get(surfel).copied());
            mean.map_or(own.unwrap_or(u32::MAX), |[red, green, blue, alpha]| {
                let [red, green, blue] = [red, green, blue].map(srgb_byte);
                let alpha = (alpha.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
                u32::from_le_bytes([red, green, blue, alpha])
            })
        };
        block.colour = Some((0..block.len()).map(&mut colour_of).collect());
    }
    built.origins.colours = Provenance::FromFile;
}

/// The pictures as materials; one without a picture in place of one that cannot be read, which is a warning.
fn read_pictures(names: &[String], file: &Path, warnings: &mut Warnings) -> Vec<Material> {
    let read = |name: &String| {
        let bytes = read_beside(file, name).map_err(|error| error.to_string())?;
        Picture::of_file(name, bytes, Alpha::Respected).map_err(|error| error.to_string())
    };
    names
        .iter()
        .map(|name| match read(name) {
            Ok(picture) => Material::of_picture(Arc::new(picture)),
            Err(error) => {
                warnings.add(
                    WarningKind::Other(format!(
                        "texture '{name}' cannot be read ({error}): its colours are left out"
                    )),
                    1,
                );
                Material::nothing()
            }
        })
        .collect()
}

/// Positions of all rows; `None` if the vertices have none, which the plan rules out.
fn positions(body: &Body<'_>) -> Option<Vec<[f64; 3]>> {
    let rows = body.tables.first()?.1.rows;
    let roles = Roles::assign(&body.tables)?;
    let read = |field: crate::load::assemble::Field<'_>| {
        let mut values = vec![0.0; rows];
        field.read(&RowSelection::All(rows), 0..rows, &mut values);
        values
    };
    let (xs, ys) = (read(roles.x), read(roles.y));
    let zs = roles.z.map_or_else(|| vec![0.0; rows], read);
    let all = xs.into_iter().zip(ys).zip(zs);
    Some(all.map(|((x, y), z)| [x, y, z]).collect())
}

/// Texture coordinates of all rows.
fn row_uvs(body: &Body<'_>) -> Option<Vec<[f32; 2]>> {
    let column = |name: &str| {
        body.tables.iter().find_map(|(_, table)| {
            let is_named = |column: &TableColumn| column.name.eq_ignore_ascii_case(name);
            let index = table.columns.iter().position(is_named)?;
            let mut values = vec![0.0; table.rows];
            let rows = RowSelection::All(table.rows);
            table.field(index).read(&rows, 0..table.rows, &mut values);
            Some(values)
        })
    };
    UV_NAMES.iter().find_map(|[u, v]| {
        let pairs = column(u)?.into_iter().zip(column(v)?);
        Some(pairs.map(|(u, v)| [u as f32, v as f32]).collect())
    })
}

fn has_strips(body: &Body<'_>) -> bool {
    body.faces.iter().any(|faces| match faces {
        Corners::Lists(lists) => lists.kind == FaceKind::Strips,
        Corners::Triangles(_) => false,
    })
}

/// The faces as triangles, with texture coordinates from the top of the picture; strips are left out.
fn surface(body: &Body<'_>, positions: Vec<[f64; 3]>, row_uvs: Option<&[[f32; 2]]>) -> Surface {
    let mut surface = Surface {
        positions,
        ..Surface::default()
    };
    let from_top = |[u, v]: [f32; 2]| [u, 1.0 - v];
    let of_row = |row: u32| {
        let uv = row_uvs.and_then(|uvs| uvs.get(row as usize));
        uv.map_or([f32::NAN; 2], |uv| from_top(*uv))
    };
    let mut places: Vec<DVec3> = Vec::new();
    let mut parts: Vec<[usize; 3]> = Vec::new();
    for faces in &body.faces {
        match faces {
            Corners::Triangles(triangles) => {
                for triangle in triangles.corners.iter() {
                    surface.triangles.push(*triangle);
                    surface.uvs.push(triangle.map(of_row));
                    surface.materials.push(0);
                }
            }
            Corners::Lists(lists) if lists.kind == FaceKind::Polygons => {
                let mut start = 0;
                for (face, length) in lists.lengths.iter().enumerate() {
                    let range = start..start + *length as usize;
                    start = range.end;
                    let Some(own) = lists.corners.get(range.clone()) else {
                        continue;
                    };
                    if own.len() < 3 {
                        continue;
                    }
                    places.clear();
                    places.extend(own.iter().map(|corner| {
                        let place = surface.positions.get(*corner as usize);
                        place.map_or(DVec3::NAN, |place| DVec3::from_array(*place))
                    }));
                    parts.clear();
                    triangulate(&places, &mut parts);
                    let picture = lists.data.pictures.get(face).copied();
                    let uv = |corner: usize| {
                        let own_uv = lists.data.uvs.get(range.start + corner);
                        own_uv.map_or_else(|| of_row(own[corner]), |uv| from_top(*uv))
                    };
                    for part in &parts {
                        surface.triangles.push(part.map(|corner| own[corner]));
                        surface.uvs.push(part.map(uv));
                        surface.materials.push(picture.unwrap_or(0));
                    }
                }
            }
            Corners::Lists(_) => {}
        }
    }
    surface
}

/// Adds a row for each pair of rows, in their middle: means of floats, bytes and 16-bit numbers, which measure; of longer whole
/// numbers, which rather count or name, those of the first row.
fn extend_tables(body: &mut Body<'_>, parents: &[[u32; 2]]) {
    for (_, table) in &mut body.tables {
        let rows = table.rows + parents.len();
        let widened = |column: &TableColumn| {
            let is_place = ["x", "y", "z"]
                .iter()
                .any(|name| column.name.eq_ignore_ascii_case(name));
            if is_place {
                ScalarType::F64
            } else {
                column.scalar
            }
        };
        let mut stride = 0;
        let mut columns = Vec::new();
        for column in &table.columns {
            let scalar = widened(column);
            columns.push(TableColumn {
                name: column.name.clone(),
                scalar,
                offset: stride,
            });
            stride += scalar.size();
        }
        let stride = stride.max(1);
        let mut bytes = vec![0; rows * stride];
        for (index, column) in columns.iter().enumerate() {
            let field = table.field(index);
            let mut values = vec![0.0; table.rows];
            field.read(&RowSelection::All(table.rows), 0..table.rows, &mut values);
            let is_first = matches!(field.scalar, ScalarType::I32 | ScalarType::U32)
                && column.scalar != ScalarType::F64;
            for [a, b] in parents {
                let (a, b) = (values[*a as usize], values[*b as usize]);
                values.push(if is_first { a } else { f64::midpoint(a, b) });
            }
            for (value, slot) in values.iter().zip(bytes.chunks_exact_mut(stride)) {
                write_native(column.scalar, *value, &mut slot[column.offset..]);
            }
        }
        *table = Table {
            bytes: bytes.into(),
            stride,
            rows,
            order: ByteOrder::NATIVE,
            columns,
        };
    }
}

/// Keeps the texture coordinates of corners as two columns, as the file has them.
fn add_uvs(body: &mut Body<'_>, surface: &Surface) {
    let rows = surface.positions.len();
    let is_named = |column: &TableColumn| column.name.eq_ignore_ascii_case(UV_NAMES[0][0]);
    if body
        .tables
        .iter()
        .any(|(_, table)| table.columns.iter().any(is_named))
    {
        return;
    }
    let mut uvs = vec![[f32::NAN; 2]; rows];
    for (corners, own) in surface.triangles.iter().zip(&surface.uvs) {
        for (corner, [u, v]) in corners.iter().zip(own) {
            if let Some(slot) = uvs.get_mut(*corner as usize)
                && slot[0].is_nan()
            {
                *slot = [*u, 1.0 - v];
            }
        }
    }
    let column = |index: usize| TableColumn {
        name: UV_NAMES[0][index].to_owned(),
        scalar: ScalarType::F32,
        offset: 4 * index,
    };
    let table = Table {
        bytes: bytemuck::cast_slice::<_, u8>(&uvs).to_vec().into(),
        stride: 8,
        rows,
        order: ByteOrder::NATIVE,
        columns: vec![column(0), column(1)],
    };
    body.tables.push(("vertex", table));
}
