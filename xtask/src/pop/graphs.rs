//! The thesis's graphs, ours beside it.

use pointstage_plot::{Axis, Plot, Scale, Series, Stroke};

use super::Findings;
use super::measured::Measured;
use super::plan::{Case, DISTANCES, THRESHOLD, THRESHOLDS, threshold_distance};
use super::quantity::QUANTITIES;
use super::thesis::{self, Drawn};

/// A file's name without its ending, and what is on it.
pub(super) type Graph = (&'static str, Plot);

/// Colours that the colour-blind can tell apart: Okabe and Ito's.
const COLOURS: [(&str, &str); 6] = [
    ("horse", "#0072b2"),
    ("hand", "#56b4e9"),
    ("dragon", "#d55e00"),
    ("sphere", "#009e73"),
    ("torus", "#cc79a7"),
    ("brain", "#e69f00"),
];
const SQUARES_COLOUR: &str = "#222222";

/// Graph 5.1.
pub(super) fn trees(found: &Findings) -> Graph {
    let theirs = |model: &thesis::Model| model.tree_secs;
    let title = "Graph 5.1: building the tree";
    let y = "seconds";
    (
        "5.1-tree",
        by_size(found, [title, y], Measured::tree_secs, theirs),
    )
}

/// Graph 5.8.
pub(super) fn nodes(found: &Findings) -> Graph {
    let theirs = |model: &thesis::Model| f64::from(model.node_count);
    let title = "Graph 5.8: nodes of the tree";
    let y = "nodes";
    (
        "5.8-nodes",
        by_size(found, [title, y], Measured::node_count, theirs),
    )
}

/// Graphs 5.2 to 5.4.
pub(super) fn by_distance(found: &Findings) -> [Graph; 3] {
    const NAMES: [(&str, &str); 3] = [
        ("5.2-frames-by-distance", "Graph 5.2: frames a second"),
        ("5.3-triangles-by-distance", "Graph 5.3: triangles drawn"),
        ("5.4-points-by-distance", "Graph 5.4: points drawn"),
    ];
    let of_model = |name: &str| {
        let cases = DISTANCES.map(|z| (f64::from(z), Case::pop(z, THRESHOLD)));
        let theirs = thesis::model(name).map(|model| model.by_distance.to_vec());
        (cases.to_vec(), theirs.unwrap_or_default())
    };
    drawn(found, NAMES, "z, distance of the eye", of_model)
}

/// Graphs 5.5 to 5.7.
pub(super) fn by_threshold(found: &Findings) -> [Graph; 3] {
    const NAMES: [(&str, &str); 3] = [
        ("5.5-frames-by-threshold", "Graph 5.5: frames a second"),
        ("5.6-triangles-by-threshold", "Graph 5.6: triangles drawn"),
        ("5.7-points-by-threshold", "Graph 5.7: points drawn"),
    ];
    let of_model = |name: &str| {
        let distance = threshold_distance(name);
        let cases = THRESHOLDS.map(|px| (f64::from(px), Case::pop(distance, px)));
        let theirs = thesis::model(name).map(|model| model.by_threshold.to_vec());
        (cases.to_vec(), theirs.unwrap_or_default())
    };
    drawn(found, NAMES, "threshold, px", of_model)
}

/// One graph for each quantity; a solid line and a dashed one for each model.
///
/// * `of_model`: abscissae and cases of a model, and what the thesis drew at the same.
fn drawn(
    found: &Findings,
    names: [(&'static str, &str); 3],
    x: &'static str,
    of_model: impl Fn(&str) -> (Vec<(f64, Case)>, Vec<Drawn>),
) -> [Graph; 3] {
    let graph = |index: usize| {
        let (file, title) = names[index];
        let quantity = &QUANTITIES[index];
        let mut series = Vec::new();
        for model in &found.models {
            let (cases, theirs) = of_model(model.name);
            let ours = cases.iter().filter_map(|(x, case)| {
                let frames = model.measured.frames(*case)?;
                Some([*x, (quantity.ours)(frames)?])
            });
            let theirs = cases.iter().zip(&theirs);
            let theirs = theirs.map(|((x, _), drawn)| [*x, (quantity.theirs)(drawn)]);
            series.extend(pair(model.name, [ours.collect(), theirs.collect()]));
        }
        let plot = Plot {
            title: title.to_owned(),
            x: Axis {
                title: x.to_owned(),
                scale: Scale::Linear,
            },
            y: Axis {
                title: quantity.name.to_owned(),
                scale: Scale::Log,
            },
            series,
            notes: Vec::new(),
        };
        (file, plot)
    };
    [graph(0), graph(1), graph(2)]
}

/// A model's two lines; the thesis's only if it has the model.
fn pair(name: &str, points: [Vec<[f64; 2]>; 2]) -> impl Iterator<Item = Series> {
    let named = [
        (name.to_owned(), Stroke::Solid),
        (format!("{name}, thesis"), Stroke::Dashed),
    ];
    let colour = colour(name);
    let pair = named.into_iter().zip(points);
    let there = pair.filter(|(_, points)| !points.is_empty());
    there.map(move |((name, stroke), points)| Series {
        name,
        colour,
        stroke,
        points,
    })
}

/// Something about trees over the triangles of their models: a line of squares, and dots and rings of models.
///
/// * `[title, y]`: of the plot and of its ordinate.
fn by_size(
    found: &Findings,
    [title, y]: [&'static str; 2],
    ours: fn(&Measured) -> Option<f64>,
    theirs: fn(&thesis::Model) -> f64,
) -> Plot {
    let squares = found.squares.iter();
    let squares = squares.filter_map(|(count, tree)| Some([*count as f64, ours(tree)?]));
    let mut series = vec![Series {
        name: "squares".to_owned(),
        colour: SQUARES_COLOUR,
        stroke: Stroke::Solid,
        points: squares.collect(),
    }];
    series.extend(found.models.iter().filter_map(|model| {
        let measured = &model.measured;
        Some(Series {
            name: model.name.to_owned(),
            colour: colour(model.name),
            stroke: Stroke::Dots,
            points: vec![[measured.triangle_count()?, ours(measured)?]],
        })
    }));
    series.extend(thesis::MODELS.iter().map(|model| Series {
        name: format!("{}, thesis", model.name),
        colour: colour(model.name),
        stroke: Stroke::Rings,
        points: vec![[model.triangle_count.into(), theirs(model)]],
    }));
    let axis = |title: &str| Axis {
        title: title.to_owned(),
        scale: Scale::Log,
    };
    Plot {
        title: title.to_owned(),
        x: axis("triangles"),
        y: axis(y),
        series,
        notes: Vec::new(),
    }
}

fn colour(name: &str) -> &'static str {
    let mut colours = COLOURS.iter();
    let found = colours.find(|(model, _)| *model == name);
    found.map_or(SQUARES_COLOUR, |(_, colour)| colour)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pop::tests::findings;

    #[test]
    fn each_model_has_its_line_and_the_thesis_its_own() {
        let names = |plot: &Plot| -> Vec<String> {
            plot.series
                .iter()
                .map(|series| series.name.clone())
                .collect()
        };
        let found = findings();
        for (file, plot) in by_distance(&found) {
            let expected: &[&str] = if file.contains("triangles") {
                &["horse, thesis"]
            } else {
                &["horse", "horse, thesis", "brain"]
            };
            assert_eq!(names(&plot), expected, "{file}");
        }
        let (_, plot) = trees(&found);
        assert_eq!(plot.series[0].points.len(), 2, "squares");
        // Squares, horse, brain, and the thesis's five.
        assert_eq!(plot.series.len(), 1 + 2 + 5);
    }

    #[test]
    fn each_model_has_a_colour_of_its_own() {
        let ours = super::super::models::MODELS.iter().map(|model| model.name);
        for name in thesis::MODELS.iter().map(|model| model.name).chain(ours) {
            assert_ne!(colour(name), SQUARES_COLOUR, "{name}");
        }
    }
}
