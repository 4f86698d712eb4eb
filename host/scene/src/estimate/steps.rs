//! What the user asks to be estimated, step by step.

use std::sync::Arc;

use pointstage_plugin_api::columns::{NO_NORMAL, TangentAxes, decode_normal, encode_normal};

use super::neighbours::{MOST_MEDIANS, place_of, tree_of};
use super::survey::{Survey, Wanted, survey};
use super::tree::Tree;
use super::{DEFAULT_NEIGHBOURS, NEIGHBOURS_RANGE, faces, orient};
use crate::geometry::{Block, Geometry, Provenance};
use crate::job::{Cancelled, Job};
use crate::load::FaceRadius;
use crate::warnings::{WarningKind, Warnings};

/// What to estimate. A step replaces what the object has; what no step names stays as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Steps {
    /// Normals: from the faces of a mesh, else those of the planes through the nearest neighbours.
    pub normals: bool,
    /// Normals of points on one side all over the object, outside where it is closed. Those of a mesh follow its faces.
    pub orientation: bool,
    /// Radii: disks that hold the faces around them, or that leave no holes between neighbours.
    pub radii: bool,
    /// Tangent half-axes: ellipses that leave no holes between neighbours.
    pub axes: bool,
    /// How many neighbours a point is compared with, [`NEIGHBOURS_RANGE`]; what is outside is taken as the nearest inside.
    pub neighbours: usize,
}

impl Default for Steps {
    /// No step, with the usual number of neighbours.
    fn default() -> Self {
        Self {
            normals: false,
            orientation: false,
            radii: false,
            axes: false,
            neighbours: DEFAULT_NEIGHBOURS,
        }
    }
}

impl Steps {
    /// True if nothing is to be done.
    pub fn is_empty(&self) -> bool {
        !(self.normals || self.orientation || self.radii || self.axes)
    }
}

/// Estimates what `steps` names, and gives the new geometry with what there is to say.
///
/// Orientation and axes need normals: where there are none they are estimated too. Ellipses (see `Cell::ellipse`) have the
/// shape of the covariance of the point's Voronoi cell in the tangent plane and are as large as the cell needs, and a tenth
/// more. An object without radii gets the longer half-axis for them.
///
/// Thread: any. The result is the same for any number of threads.
///
/// # Errors
/// [`Cancelled`] when the job was.
pub fn estimate(
    geometry: &Geometry,
    steps: &Steps,
    job: &Job,
) -> Result<(Geometry, Warnings), Cancelled> {
    let mut estimated = geometry.clone();
    let mut warnings = Warnings::new();
    if steps.is_empty() || geometry.surfel_count == 0 {
        return Ok((estimated, warnings));
    }
    let mut steps = *steps;
    let lacks_normals = estimated.origins.normals == Provenance::Missing;
    steps.normals |= lacks_normals && (steps.orientation || steps.axes);
    let is_mesh = estimated.triangles.is_some();
    if is_mesh && steps.orientation {
        let text = "normals of a mesh follow its faces and were not oriented; flip it to turn them";
        warnings.add(WarningKind::Other(text.into()), 1);
        steps.orientation = false;
    }
    clear(&mut estimated, &steps, &mut warnings);
    if is_mesh && (steps.normals || steps.radii) {
        from_faces(&mut estimated, &steps, job)?;
    }
    from_neighbours(&mut estimated, &steps, job, &mut warnings)?;
    estimated.touch();
    job.set_progress(1.0);
    Ok((estimated, warnings))
}

/// Takes away what is estimated anew.
fn clear(geometry: &mut Geometry, steps: &Steps, warnings: &mut Warnings) {
    let drops_axes = steps.normals && !steps.axes && geometry.origins.axes != Provenance::Missing;
    if drops_axes {
        let text =
            "tangent axes do not lie in the planes of the new normals: left out; estimate axes too";
        warnings.add(WarningKind::Other(text.into()), 1);
    }
    let Geometry {
        blocks, origins, ..
    } = geometry;
    for block in blocks {
        if steps.normals {
            block.normal = None;
        }
        if steps.radii {
            let slots = Arc::make_mut(&mut block.position_radius);
            for slot in slots.iter_mut() {
                slot[3] = 0.0;
            }
        }
        if steps.axes || drops_axes {
            block.axes = None;
        }
    }
    for (cleared, provenance) in [
        (steps.normals, &mut origins.normals),
        (steps.radii, &mut origins.radii),
        (steps.axes || drops_axes, &mut origins.axes),
    ] {
        if cleared {
            *provenance = Provenance::Missing;
        }
    }
}

/// What the faces of a mesh give, but only for what is asked.
fn from_faces(geometry: &mut Geometry, steps: &Steps, job: &Job) -> Result<(), Cancelled> {
    let Some(triangles) = geometry.triangles.clone() else {
        return Ok(());
    };
    job.set_stage("computing normals and radii from faces");
    let (origins, blocks) = (geometry.origins, geometry.blocks.clone());
    faces::complete(geometry, &triangles, None, FaceRadius::default(), job)?;
    for (block, before) in geometry.blocks.iter_mut().zip(blocks) {
        if !steps.normals {
            block.normal = before.normal;
        }
        if !steps.radii {
            block.position_radius = before.position_radius;
        }
    }
    if !steps.normals {
        geometry.origins.normals = origins.normals;
    }
    if !steps.radii {
        geometry.origins.radii = origins.radii;
    }
    Ok(())
}

/// What the neighbours give: all of a point set, or the vertices of a mesh that no face uses; axes of both.
fn from_neighbours(
    geometry: &mut Geometry,
    steps: &Steps,
    job: &Job,
    warnings: &mut Warnings,
) -> Result<(), Cancelled> {
    let wants_normals = steps.normals && geometry.blocks.iter().any(lacks_normals);
    let wants_radii = steps.radii && geometry.blocks.iter().any(lacks_radii);
    if !(wants_normals || wants_radii || steps.orientation || steps.axes) {
        return Ok(());
    }
    let tree = tree_of(geometry, &(0.0..0.1), job)?;
    job.set_stage("looking at the neighbours of each point");
    let wanted = Wanted {
        neighbours: steps
            .neighbours
            .clamp(*NEIGHBOURS_RANGE.start(), *NEIGHBOURS_RANGE.end()),
        radii: wants_radii,
        axes: steps.axes,
        graph: steps.orientation,
    };
    let search_end = if steps.orientation { 0.7 } else { 1.0 };
    let mut found = survey(geometry, &tree, wanted, &(0.1..search_end), job)?;
    if let Some(graph) = found.graph.take() {
        job.set_stage("orienting normals");
        let part = search_end..1.0;
        let sides = orient::sides(tree.points(), &found.normals, &graph, &part, job)?;
        for (normal, turned) in found.normals.iter_mut().zip(&sides.turned) {
            *normal = if *turned { -*normal } else { *normal };
        }
        warnings.add(WarningKind::NormalsOriented, geometry.surfel_count as u64);
        if sides.pieces > 1 {
            warnings.add(WarningKind::OrientedInPieces, sides.pieces as u64);
        }
    }
    job.check()?;
    if wants_normals || steps.orientation {
        write_normals(geometry, &tree, &found, steps, warnings);
    }
    if wants_radii {
        write_radii(geometry, &tree, &mut found, warnings);
    }
    if steps.axes {
        write_axes(geometry, &tree, &mut found, warnings);
    }
    Ok(())
}

fn lacks_normals(block: &Block) -> bool {
    block
        .normal
        .as_ref()
        .is_none_or(|normals| normals.contains(&NO_NORMAL))
}

fn lacks_radii(block: &Block) -> bool {
    block.position_radius.iter().any(|slot| slot[3] <= 0.0)
}

/// Fills in normals, and turns those that are there if they were oriented.
fn write_normals(
    geometry: &mut Geometry,
    tree: &Tree,
    found: &Survey,
    steps: &Steps,
    warnings: &mut Warnings,
) {
    let Geometry {
        blocks, origins, ..
    } = geometry;
    let mut count = 0;
    /// Normals of a block, and its half-axes if it has them.
    type Columns<'a> = (&'a mut [u32], Option<&'a mut [[f32; 8]]>);
    let mut columns: Vec<Columns<'_>> = blocks
        .iter_mut()
        .map(|block| {
            let length = block.len();
            let normals = block
                .normal
                .get_or_insert_with(|| std::iter::repeat_n(NO_NORMAL, length).collect());
            let axes = block.axes.as_mut().map(Arc::make_mut);
            (Arc::make_mut(normals), axes)
        })
        .collect();
    for (point, normal) in tree.points().iter().zip(&found.normals) {
        let (block, inside) = place_of(point.index);
        let (normals, axes) = &mut columns[block];
        let slot = &mut normals[inside];
        if *slot == NO_NORMAL {
            if steps.normals {
                *slot = encode_normal(*normal);
                count += 1;
            }
        } else if steps.orientation && decode_normal(*slot).dot(*normal) < 0.0 {
            *slot = encode_normal(*normal);
            if let Some(axes) = axes {
                // Their cross product is the normal.
                axes[inside][4..]
                    .iter_mut()
                    .for_each(|value| *value = -*value);
            }
        }
    }
    if steps.orientation {
        if [Provenance::Missing, Provenance::Estimated].contains(&origins.normals) {
            origins.normals = Provenance::Oriented;
        }
    } else {
        warnings.add(WarningKind::NormalsEstimated, count);
        if origins.normals == Provenance::Missing {
            origins.normals = Provenance::Estimated;
        }
    }
}

fn write_radii(geometry: &mut Geometry, tree: &Tree, found: &mut Survey, warnings: &mut Warnings) {
    let median = median_of(found.radii.iter().copied());
    let mut blocks: Vec<&mut [[f32; 4]]> = slots_of(geometry);
    let mut count = 0;
    for (point, radius) in tree.points().iter().zip(&found.radii) {
        let (block, inside) = place_of(point.index);
        let slot = &mut blocks[block][inside][3];
        if *slot <= 0.0 {
            *slot = bounded(*radius, median);
            count += 1;
        }
    }
    warnings.add(WarningKind::RadiiEstimated, count);
    if geometry.origins.radii == Provenance::Missing {
        geometry.origins.radii = Provenance::Estimated;
    }
}

fn write_axes(geometry: &mut Geometry, tree: &Tree, found: &mut Survey, warnings: &mut Warnings) {
    let lengths = found
        .ellipses
        .iter()
        .map(|ellipse| ellipse.long.length() as f32);
    let median = median_of(lengths);
    let mut columns: Vec<Vec<[f32; 8]>> = geometry
        .blocks
        .iter()
        .map(|block| vec![[0.0; 8]; block.len()])
        .collect();
    for ((point, normal), ellipse) in tree
        .points()
        .iter()
        .zip(&found.normals)
        .zip(&found.ellipses)
    {
        let (block, inside) = place_of(point.index);
        let long = ellipse.long.as_vec3();
        let (length, short) = (long.length(), ellipse.short_length as f32);
        let along = if length > 0.0 {
            long / length
        } else {
            normal.any_orthonormal_vector()
        };
        // Both as much smaller as the longer one has to be.
        let kept = bounded(length, median);
        let short = if length > 0.0 {
            short * kept / length
        } else {
            kept
        };
        let axes = TangentAxes::new(along * kept, normal.cross(along) * short);
        columns[block][inside] = axes.0;
    }
    let has_radii = geometry.origins.radii != Provenance::Missing;
    for (block, column) in geometry.blocks.iter_mut().zip(columns) {
        if !has_radii {
            let slots = Arc::make_mut(&mut block.position_radius);
            for (slot, axes) in slots.iter_mut().zip(&column) {
                slot[3] = TangentAxes(*axes).u().length();
            }
        }
        block.axes = Some(column.into());
    }
    warnings.add(WarningKind::AxesEstimated, geometry.surfel_count as u64);
    geometry.origins.axes = Provenance::Estimated;
    if !has_radii {
        geometry.origins.radii = Provenance::Estimated;
    }
}

fn slots_of(geometry: &mut Geometry) -> Vec<&mut [[f32; 4]]> {
    let blocks = geometry.blocks.iter_mut();
    blocks
        .map(|block| Arc::make_mut(&mut block.position_radius))
        .collect()
}

/// The middle one of the lengths above 0; 1 if there is none.
fn median_of(lengths: impl Iterator<Item = f32>) -> f32 {
    let mut lengths: Vec<f32> = lengths.filter(|length| *length > 0.0).collect();
    if lengths.is_empty() {
        return 1.0;
    }
    let middle = lengths.len() / 2;
    *lengths.select_nth_unstable_by(middle, f32::total_cmp).1
}

/// A length as it is kept: the median where nothing was found, and no more than lone points may have.
fn bounded(length: f32, median: f32) -> f32 {
    if length > 0.0 {
        length.min(MOST_MEDIANS * median)
    } else {
        median
    }
}

#[cfg(test)]
mod tests;
