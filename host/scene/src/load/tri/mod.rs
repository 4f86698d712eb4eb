//! TRI: text meshes in named sections, as of the Modular Visualization Environment 2; experimental.
//!
//! No description of the format and no file of it could be found; only the names of four sections are known: *Vertices*,
//! *Vertices' Normals*, *Triangles*, *Triangles' Normals*. This reader takes the spellings that are plausible (`sections`):
//!
//! * text with any line ends; `#`, `;` and `//` start comments; blanks, tabs and commas part numbers;
//! * a head is the name of a section, in any case, in brackets or quotes or with `:` or `=` behind it, perhaps with a count;
//!   a lone whole number in the line below is a count too; what follows an unknown head is passed over;
//! * a row is three numbers, perhaps behind its own running number; more behind them are ignored;
//! * corners count from 0, or from 1 if none is 0 and the largest is the number of vertices.
//!
//! Normals of vertices win over those of triangles, which are averaged by area; without either they come from the faces.

mod error;
mod sections;

use std::sync::Arc;

use glam::{DVec3, Vec3};
use pointstage_plugin_api::columns::{NO_NORMAL, encode_normal};

pub use error::TriError;

use super::assemble::{Built, Corners, Triangles, finish, origin_for};
use super::columns::Columns;
use super::error::LoadStop;
use super::loader::{Claim, Contents, FileStart, Loader, LoaderInfo, SourceFile};
use super::source::Source;
use super::{LoadOptions, Winding};
use crate::bounds::Bounds;
use crate::geometry::{Origins, Provenance};
use crate::job::Job;
use crate::warnings::{WarningKind, Warnings};
use sections::{Kind, Section, head, lines, sections, without_comment};

/// The loader of TRI files.
#[derive(Debug)]
pub(super) struct TriLoader {
    info: LoaderInfo,
}

impl TriLoader {
    pub(super) fn new() -> Self {
        Self {
            info: LoaderInfo::built_in("tri", "Text meshes in sections (TRI)", &["tri"]),
        }
    }
}

impl Loader for TriLoader {
    fn info(&self) -> &LoaderInfo {
        &self.info
    }

    fn claims(&self, start: &FileStart<'_>) -> Claim {
        let has_head = || {
            lines(start.bytes).any(|line| {
                matches!(
                    head(without_comment(line)),
                    Some((Kind::Vertices | Kind::Triangles, _))
                )
            })
        };
        if start.bytes.contains(&0) || !has_head() {
            // A comment may be longer than what is seen here.
            let may_come = start.bytes.len() < start.length as usize && !start.bytes.contains(&0);
            return if may_come && start.extension() == "tri" {
                Claim::Possible
            } else {
                Claim::No
            };
        }
        if start.extension() == "tri" {
            Claim::Likely
        } else {
            Claim::Possible
        }
    }

    fn load(
        &self,
        file: &SourceFile,
        options: &LoadOptions,
        job: &Job,
    ) -> Result<Contents, LoadStop> {
        read(file.source(), options, job)
    }
}

/// Reads the bytes of a TRI file.
fn read(file: &Source, options: &LoadOptions, job: &Job) -> Result<Contents, LoadStop> {
    let mut warnings = Warnings::new();
    job.set_stage("reading the file");
    let (sections, last_line) = sections(file, job)?;
    let find = |kind: Kind| sections.iter().find(|section| section.kind == kind);
    let vertices = find(Kind::Vertices)
        .filter(|vertices| vertices.len() > 0)
        .ok_or(TriError::NoVertices { line: last_line })?;
    let vertex_count = vertices.len();
    let triangles = find(Kind::Triangles)
        .map(|section| corners(section, vertex_count))
        .transpose()?
        .unwrap_or_default();
    job.check()?;
    let mut fitting = |kind: Kind, expected: usize| {
        let section = find(kind)?;
        if section.len() == expected {
            return Some(section);
        }
        let text = format!(
            "section '{}' has {} rows, not {expected}: left out",
            kind.name(),
            section.len()
        );
        warnings.add(WarningKind::Other(text), 1);
        None
    };
    let of_vertices = fitting(Kind::VertexNormals, vertex_count);
    let of_triangles = fitting(Kind::TriangleNormals, triangles.len());
    let normals: Option<Vec<DVec3>> = if let Some(section) = of_vertices {
        Some(section.rows().map(DVec3::from_array).collect())
    } else {
        of_triangles.map(|section| mean_normals(vertices, &triangles, section))
    };
    let built = build(vertices, normals, options.winding, &mut warnings);
    let has_triangles = !triangles.is_empty();
    drop(sections);
    file.release(0..file.len());
    let faces = if has_triangles {
        vec![Corners::Triangles(Triangles {
            max_corner: triangles.iter().flatten().copied().max().unwrap_or(0),
            degenerate_count: triangles
                .iter()
                .filter(|[a, b, c]| a == b || b == c || a == c)
                .count() as u64,
            corners: Arc::from(triangles),
        })]
    } else {
        Vec::new()
    };
    Ok(finish(
        built,
        vertex_count,
        faces.into(),
        options,
        job,
        warnings,
    )?)
}

/// The corners of the triangles, from 0.
fn corners(section: &Section, vertex_count: usize) -> Result<Vec<[u32; 3]>, TriError> {
    let smallest = section.rows().flatten().fold(f64::INFINITY, f64::min);
    let largest = section.rows().flatten().fold(0.0, f64::max);
    let base = if smallest != 0.0 && largest == vertex_count as f64 {
        1.0
    } else {
        0.0
    };
    let mut corners = Vec::with_capacity(section.len());
    for (row, numbers) in section.rows().enumerate() {
        let mut triangle = [0; 3];
        for (corner, number) in triangle.iter_mut().zip(numbers) {
            let index = number - base;
            if index.fract() != 0.0 || index < 0.0 || index >= vertex_count as f64 {
                return Err(TriError::Corner {
                    line: section.line,
                    row: row as u64 + 1,
                    vertices: vertex_count as u64,
                    found: number.to_string(),
                });
            }
            *corner = index as u32;
        }
        corners.push(triangle);
    }
    Ok(corners)
}

/// For each vertex, the mean of the given normals of its triangles, by area.
fn mean_normals(vertices: &Section, triangles: &[[u32; 3]], normals: &Section) -> Vec<DVec3> {
    let centres: Vec<DVec3> = vertices.rows().map(DVec3::from_array).collect();
    let mut means = vec![DVec3::ZERO; centres.len()];
    for (triangle, normal) in triangles.iter().zip(normals.rows()) {
        let [a, b, c] = triangle.map(|corner| centres[corner as usize]);
        let area = (b - a).cross(c - a).length() / 2.0;
        let part = DVec3::from_array(normal).normalize_or_zero() * area;
        for corner in triangle {
            means[*corner as usize] += part;
        }
    }
    means
}

/// The columns.
fn build(
    vertices: &Section,
    normals: Option<Vec<DVec3>>,
    winding: Winding,
    warnings: &mut Warnings,
) -> Built {
    let around = vertices
        .rows()
        .fold(Bounds::EMPTY, |bounds, row| bounds.with_point(row.into()));
    let origin = origin_for(&around);
    let mut columns = Columns::default();
    let mut bounds = Bounds::EMPTY;
    columns.position_radius = vertices
        .rows()
        .map(|row| {
            let local: Vec3 = (DVec3::from_array(row) - origin).as_vec3();
            bounds = bounds.with_point(local.as_dvec3());
            [local.x, local.y, local.z, 0.0]
        })
        .collect();
    let mut origins = Origins::default();
    if let Some(normals) = normals {
        let sign = winding.sign();
        let mut useless = 0;
        let packed = normals.into_iter().map(|normal| {
            let normal = normal.normalize_or_zero();
            if normal == DVec3::ZERO {
                useless += 1;
                return NO_NORMAL;
            }
            encode_normal((normal * sign).as_vec3())
        });
        columns.normal = packed.collect();
        warnings.add(WarningKind::UnusableNormalsReplaced, useless as u64);
        if useless < columns.normal.len() {
            origins.normals = Provenance::FromFile;
        } else {
            columns.normal.clear();
        }
    }
    Built {
        blocks: columns.into_blocks(),
        origin,
        bounds,
        new_index: None,
        origins,
    }
}
