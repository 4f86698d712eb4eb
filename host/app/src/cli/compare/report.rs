//! `metrics.json`. Its form is documented in `docs/user-guide/comparing.md`; what is there keeps its name and meaning within
//! one [`FORMAT`].

use std::collections::BTreeMap;

use pointstage_engine::metrics::Measures;
use pointstage_engine::stage::Stage;
use pointstage_scene::ViewRecord;
use serde::Serialize;

use super::reference::Reference;
use super::view::Comparison;
use crate::cli::Outcome;
use crate::cli::drawing::Cost;
use crate::cli::measuring::made_by::MadeBy;
use crate::cli::measuring::times::Times;
use crate::cli::measuring::who::Who;
use crate::output::record::background_text;

/// Version of the form.
const FORMAT: u32 = 1;

/// All that was found.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    format: u32,
    pub(super) scene: Vec<String>,
    /// The scene's objects.
    pub(super) objects: Vec<ObjectFacts>,
    pub(crate) size: [u32; 2],
    pub(super) background: String,
    pub(super) exposure: f32,
    pub(super) radius_scale: f32,
    pub(super) reference: MeasuredBy,
    device: Option<String>,
    pub(crate) made_by: MadeBy,
    pub(super) views: Vec<ViewReport>,
    pub(crate) means: Vec<Mean>,
}

/// An object of the scene.
#[derive(Debug, Serialize)]
pub(super) struct ObjectFacts {
    pub(super) name: String,
    pub(super) surfels: usize,
    pub(super) triangles: usize,
    /// Where its normals come from: `File`, `Estimated`, …
    pub(super) normals: String,
    /// Where its radii come from.
    pub(super) radii: String,
}

/// What the renderers are measured by.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub(super) enum MeasuredBy {
    /// Another one.
    Renderer(Who),
    /// Pictures in a folder.
    Images {
        /// As it was named.
        images: String,
    },
}

impl MeasuredBy {
    /// As the command line says.
    pub(super) fn of(reference: &Reference) -> Outcome<Self> {
        Ok(match reference {
            Reference::Renderer { entry, .. } => Self::Renderer(Who::of(entry)?),
            Reference::Images { folder, .. } => Self::Images {
                images: folder.to_string_lossy().into_owned(),
            },
        })
    }
}

/// One view.
#[derive(Debug, Serialize)]
pub(super) struct ViewReport {
    pub(super) view: ViewRecord,
    pub(super) reference: DrawnReference,
    pub(super) renderers: Vec<RendererReport>,
}

/// The reference's picture.
#[derive(Debug, Serialize)]
pub(super) struct DrawnReference {
    /// Wall time of its frames, without preparation; none if it was there already.
    pub(super) ms: Option<f64>,
    /// Name of its file; with its folder if it was there already.
    pub(super) picture: String,
    /// Files of its targets, by key.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) targets: BTreeMap<String, String>,
    /// Values at the dark and the bright end of the targets' ramps, for everybody.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) ranges: BTreeMap<String, [f32; 2]>,
}

/// One renderer in one view.
#[derive(Debug, Serialize)]
pub(super) struct RendererReport {
    #[serde(flatten)]
    pub(super) who: Who,
    #[serde(flatten)]
    pub(super) found: Found,
    /// What the pictures that count for time cost.
    pub(super) times: Option<Times>,
}

/// What was found of one renderer in one view.
#[derive(Debug, Serialize)]
pub(super) struct Found {
    /// Wall time of its frames until it was finished, without preparation.
    pub(super) ms: f64,
    /// Of the pictures that count for time.
    #[serde(skip)]
    pub(super) costs: Vec<Cost>,
    /// Names of its files.
    pub(super) files: Files,
    /// Over every pixel.
    pub(super) whole: Measures,
    /// Over the interior of what the reference covers.
    pub(super) interior: Measures,
    /// Over its edge.
    pub(super) edge: Measures,
}

/// Names of a renderer's files for one view.
#[derive(Debug, Serialize)]
pub(super) struct Files {
    pub(super) picture: String,
    pub(super) flip: Option<String>,
    pub(super) difference: String,
    /// Its targets, by key.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) targets: BTreeMap<String, String>,
}

/// One renderer over all views.
#[derive(Debug, Serialize)]
pub(crate) struct Mean {
    pub(crate) label: String,
    ms: Option<f64>,
    /// Of the timed pictures of all views.
    pub(crate) times: Option<Times>,
    pub(crate) whole: Measures,
    pub(super) interior: Measures,
    pub(super) edge: Measures,
}

/// What was found in one view, in the order of the renderers.
pub(super) struct FoundView {
    pub(super) view: ViewRecord,
    pub(super) reference: DrawnReference,
    pub(super) found: Vec<Found>,
}

impl Report {
    /// Puts together what was found.
    pub(super) fn new(
        stage: &Stage,
        comparison: &Comparison<'_>,
        found: Vec<FoundView>,
    ) -> Outcome<Self> {
        let Comparison {
            arguments,
            reference,
            renderers,
            scene,
            ..
        } = comparison;
        let who: Vec<Who> = renderers.iter().map(Who::of).collect::<Outcome<_>>()?;
        let of_renderer = |(who, found): (Who, Found)| RendererReport {
            who,
            times: Times::of(&found.costs),
            found,
        };
        let views: Vec<ViewReport> = found
            .into_iter()
            .map(|found| ViewReport {
                view: found.view,
                reference: found.reference,
                renderers: who
                    .iter()
                    .cloned()
                    .zip(found.found)
                    .map(of_renderer)
                    .collect(),
            })
            .collect();
        let objects = scene.objects().iter().map(|object| ObjectFacts {
            name: object.name.clone(),
            surfels: object.geometry.surfel_count,
            triangles: object.geometry.triangle_count(),
            normals: format!("{:?}", object.geometry.origins.normals),
            radii: format!("{:?}", object.geometry.origins.radii),
        });
        let look = &arguments.look;
        Ok(Self {
            format: FORMAT,
            scene: arguments
                .files
                .iter()
                .map(|path| path.to_string_lossy().into_owned())
                .collect(),
            objects: objects.collect(),
            size: look.size,
            background: background_text(look.background),
            exposure: look.exposure,
            radius_scale: look.radius_scale,
            reference: MeasuredBy::of(reference)?,
            device: stage.adapter().map(|adapter| adapter.name),
            made_by: MadeBy::now(stage),
            means: who
                .iter()
                .enumerate()
                .map(|(index, who)| Mean::of(who, index, &views))
                .collect(),
            views,
        })
    }

    /// As JSON.
    pub(crate) fn json(&self) -> Outcome<String> {
        Ok(serde_json::to_string_pretty(self)?)
    }
}

impl Mean {
    /// Of the renderer that is `index` in every view.
    fn of(who: &Who, index: usize, views: &[ViewReport]) -> Self {
        let found = || views.iter().map(|view| &view.renderers[index].found);
        Self {
            label: who.label.clone(),
            times: Times::of(
                &found()
                    .flat_map(|found| found.costs.clone())
                    .collect::<Vec<_>>(),
            ),
            ms: mean(found().map(|found| Some(found.ms))),
            whole: mean_measures(&found().map(|found| found.whole)),
            interior: mean_measures(&found().map(|found| found.interior)),
            edge: mean_measures(&found().map(|found| found.edge)),
        }
    }
}

/// Means of each number over the views that have it; pixels are summed, and identical are only views that all are.
fn mean_measures(views: &(impl Iterator<Item = Measures> + Clone)) -> Measures {
    let over = |number: fn(Measures) -> Option<f64>| mean(views.clone().map(number));
    let pixels = views.clone().map(|measures| measures.pixels).sum();
    Measures {
        pixels,
        psnr_db: over(|measures| measures.psnr_db),
        // A view whose region has no pixels says neither.
        identical: pixels > 0
            && views
                .clone()
                .all(|measures| measures.identical || measures.pixels == 0),
        ssim: over(|measures| measures.ssim),
        flip_mean: over(|measures| measures.flip_mean),
        flip_p99: over(|measures| measures.flip_p99),
    }
}

/// The mean of those that are there and finite: an infinite PSNR would hide every other.
fn mean(numbers: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let there: Vec<f64> = numbers
        .flatten()
        .filter(|number| number.is_finite())
        .collect();
    (!there.is_empty()).then(|| there.iter().sum::<f64>() / there.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measures(psnr_db: Option<f64>) -> Measures {
        Measures {
            pixels: usize::from(psnr_db.is_some()),
            psnr_db,
            identical: psnr_db == Some(f64::INFINITY),
            ssim: psnr_db.map(|_| 0.5),
            ..Measures::default()
        }
    }

    #[test]
    fn means_are_over_the_views_that_have_a_number() {
        let views = [Some(20.0), Some(f64::INFINITY), None, Some(30.0)].map(measures);
        let mean = mean_measures(&views.into_iter());
        assert_eq!((mean.psnr_db, mean.pixels), (Some(25.0), 3));
        assert_eq!((mean.ssim, mean.flip_mean), (Some(0.5), None));
        assert!(!mean.identical);
    }

    #[test]
    fn identical_in_all_views_is_identical() {
        let of = |views: [Option<f64>; 2]| mean_measures(&views.map(measures).into_iter());
        let equal = Some(f64::INFINITY);
        assert!(of([equal, equal]).identical && of([equal, None]).identical);
        assert!(!of([None, None]).identical);
        assert_eq!(of([equal, equal]).psnr_db, None);
    }
}
