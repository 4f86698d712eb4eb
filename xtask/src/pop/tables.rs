//! The thesis's tables, ours beside it.

use super::measured::{Frames, Measured};
use super::plan::{CLASSIC_DISTANCES, Case, DISTANCES, THRESHOLD, THRESHOLDS, threshold_distance};
use super::quantity::{QUANTITIES, Quantity};
use super::thesis::{self, Drawn};
use super::{Findings, ModelFound};
use crate::markdown;

/// What stands where nothing was measured.
const NOTHING: &str = "–";

/// Table 5.2: building the tree.
pub(super) fn trees(found: &Findings) -> String {
    let head = ["model", "triangles", "here, s", "thesis, s", "levels"].map(String::from);
    let rows = names(found).into_iter().map(|name| {
        let (ours, theirs) = (measured(found, name), thesis::model(name));
        vec![
            name.to_owned(),
            count(triangle_count(ours, theirs)),
            number(ours.and_then(Measured::tree_secs)),
            number(theirs.map(|theirs| theirs.tree_secs)),
            count(ours.and_then(Measured::level_count)),
        ]
    });
    table(1, head.into(), rows)
}

/// Table 5.6: nodes of the tree.
pub(super) fn nodes(found: &Findings) -> String {
    let head = [
        "model",
        "triangles",
        "here",
        "thesis",
        "here, nodes a triangle",
        "thesis, nodes a triangle",
    ]
    .map(String::from);
    let rows = names(found).into_iter().map(|name| {
        let (ours, theirs) = (measured(found, name), thesis::model(name));
        let triangles = triangle_count(ours, theirs);
        let nodes = [
            ours.and_then(Measured::node_count),
            theirs.map(|theirs| theirs.node_count.into()),
        ];
        let [here, there] = nodes;
        let [ours_each, theirs_each] = nodes.map(|nodes| ratio(nodes, triangles));
        vec![
            name.to_owned(),
            count(triangles),
            count(here),
            count(there),
            number(ours_each),
            number(theirs_each),
        ]
    });
    table(1, head.into(), rows)
}

/// Behind graphs 5.1 and 5.8: trees of squares.
pub(super) fn squares(found: &Findings) -> String {
    let head = [
        "triangles",
        "tree, s",
        "µs a triangle",
        "nodes",
        "nodes a triangle",
    ]
    .map(String::from);
    let rows = found.squares.iter().map(|(triangles, measured)| {
        let triangles = Some(*triangles as f64);
        let (secs, nodes) = (measured.tree_secs(), measured.node_count());
        vec![
            count(triangles),
            number(secs),
            number(ratio(secs.map(|secs| secs * 1e6), triangles)),
            count(nodes),
            number(ratio(nodes, triangles)),
        ]
    });
    table(0, head.into(), rows)
}

/// Table 5.3: frames a second and what is drawn, by distance.
pub(super) fn by_distance(found: &Findings) -> String {
    let columns = DISTANCES.map(|distance| format!("z = {distance}"));
    let rows = found.models.iter().flat_map(|model| {
        let cases = DISTANCES.map(|distance| Case::pop(distance, THRESHOLD));
        let theirs = thesis::model(model.name).map(|theirs| theirs.by_distance);
        drawn_rows(
            model,
            model.name,
            &cases,
            theirs.as_ref().map(<[_; 7]>::as_slice),
        )
    });
    table(3, head(&["model", "what", "where"], &columns), rows)
}

/// Table 5.5: the same by threshold.
pub(super) fn by_threshold(found: &Findings) -> String {
    let columns = THRESHOLDS.map(|threshold| format!("{threshold} px"));
    let rows = found.models.iter().flat_map(|model| {
        let distance = threshold_distance(model.name);
        let cases = THRESHOLDS.map(|threshold| Case::pop(distance, threshold));
        let theirs = thesis::model(model.name).map(|theirs| theirs.by_threshold);
        let name = format!("{}, z = {distance}", model.name);
        drawn_rows(
            model,
            &name,
            &cases,
            theirs.as_ref().map(<[_; 5]>::as_slice),
        )
    });
    table(3, head(&["model", "what", "where"], &columns), rows)
}

/// Frames a second, triangles and points, each here and in the thesis if it has the model.
fn drawn_rows(
    model: &ModelFound,
    name: &str,
    cases: &[Case],
    theirs: Option<&[Drawn]>,
) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for Quantity {
        name: what,
        ours,
        theirs: of_theirs,
        written,
    } in QUANTITIES
    {
        let words = |place: &str| [name, what, place].map(String::from).to_vec();
        let ours = cases
            .iter()
            .map(|case| written(model.measured.frames(*case).and_then(ours)));
        rows.push(words("here").into_iter().chain(ours).collect());
        if let Some(theirs) = theirs {
            let theirs = theirs.iter().map(|drawn| written(Some(of_theirs(drawn))));
            rows.push(words("thesis").into_iter().chain(theirs).collect());
        }
    }
    rows
}

/// Table 5.4, and how many times faster POP is.
pub(super) fn classic(found: &Findings) -> String {
    let columns = CLASSIC_DISTANCES.map(|distance| format!("classic, z = {distance}"));
    let faster = CLASSIC_DISTANCES.map(|distance| format!("POP : classic, z = {distance}"));
    let columns: Vec<String> = columns.into_iter().chain(faster).collect();
    let mut rows = Vec::new();
    for name in names(found) {
        if let Some(ours) = measured(found, name) {
            let fps = |case| ours.frames(case).and_then(Frames::fps);
            let classic = CLASSIC_DISTANCES.map(|distance| fps(Case::classic(distance)));
            let pop = CLASSIC_DISTANCES.map(|distance| fps(Case::pop(distance, THRESHOLD)));
            rows.push(classic_row(name, "here", &classic, &pop));
        }
        if let Some(theirs) = thesis::model(name) {
            let classic = CLASSIC_DISTANCES.map(|_| Some(theirs.classic_fps));
            let pop = CLASSIC_DISTANCES
                .map(|distance| Some(theirs.by_distance[usize::from(distance) - 1].fps));
            rows.push(classic_row(name, "thesis", &classic, &pop));
        }
    }
    table(2, head(&["model", "where"], &columns), rows)
}

fn classic_row(
    name: &str,
    place: &str,
    classic: &[Option<f64>],
    pop: &[Option<f64>],
) -> Vec<String> {
    let faster = pop.iter().zip(classic);
    let faster = faster.map(|(pop, classic)| number(ratio(*pop, *classic)));
    let words = [name, place].map(String::from).into_iter();
    let classic = classic.iter().map(|fps| number(*fps));
    words.chain(classic).chain(faster).collect()
}

/// Where a frame's time goes; the thesis has no such table.
pub(super) fn parts(found: &Findings) -> String {
    type Part = fn(&Frames) -> Option<f64>;
    type Written = fn(Option<f64>) -> String;
    const PARTS: [(&str, Part, Written); 6] = [
        ("frame, ms", Frames::frame_ms, number),
        ("renderer and device, ms", Frames::drawing_ms, number),
        (
            "selection, ms",
            |frames| frames.reported("selection_ms"),
            number,
        ),
        (
            "nodes visited",
            |frames| frames.reported("nodes_visited"),
            count,
        ),
        (
            "nodes culled",
            |frames| frames.reported("nodes_culled"),
            count,
        ),
        ("front", |frames| frames.reported("front_length"), count),
    ];
    let columns = DISTANCES.map(|distance| format!("z = {distance}"));
    let rows = found.models.iter().flat_map(|model| {
        PARTS.map(|(what, of, written)| {
            let cells = DISTANCES.map(|distance| {
                let frames = model.measured.frames(Case::pop(distance, THRESHOLD));
                written(frames.and_then(of))
            });
            let words = [model.name, what].map(String::from).into_iter();
            words.chain(cells).collect()
        })
    });
    table(2, head(&["model", "what"], &columns), rows)
}

/// The thesis's models in its order, then ours.
fn names(found: &Findings) -> Vec<&'static str> {
    let mut names: Vec<&str> = thesis::MODELS.iter().map(|model| model.name).collect();
    let ours = found.models.iter().map(|model| model.name);
    let others: Vec<&str> = ours.filter(|name| !names.contains(name)).collect();
    names.extend(others);
    names
}

fn measured<'a>(found: &'a Findings, name: &str) -> Option<&'a Measured> {
    let model = found.models.iter().find(|model| model.name == name)?;
    Some(&model.measured)
}

fn triangle_count(ours: Option<&Measured>, theirs: Option<&thesis::Model>) -> Option<f64> {
    let theirs = theirs.map(|theirs| theirs.triangle_count.into());
    ours.and_then(Measured::triangle_count).or(theirs)
}

fn head(words: &[&str], columns: &[String]) -> Vec<String> {
    let words = words.iter().map(|word| (*word).to_owned());
    words.chain(columns.iter().cloned()).collect()
}

fn table(words: usize, head: Vec<String>, rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let cells: Vec<Vec<String>> = std::iter::once(head).chain(rows).collect();
    markdown::table(words, &cells)
}

/// One quantity over another.
pub(super) fn ratio(above: Option<f64>, below: Option<f64>) -> Option<f64> {
    let ratio = above? / below?;
    ratio.is_finite().then_some(ratio)
}

/// Three digits, or the whole part where it has more.
pub(super) fn number(value: Option<f64>) -> String {
    let Some(value) = value else {
        return NOTHING.to_owned();
    };
    let digits = match value.abs() {
        size if size >= 100.0 => 0,
        size if size >= 10.0 => 1,
        size if size >= 1.0 || size == 0.0 => 2,
        _ => 3,
    };
    format!("{value:.digits$}")
}

/// A whole number in groups of three digits.
pub(super) fn count(value: Option<f64>) -> String {
    let Some(value) = value else {
        return NOTHING.to_owned();
    };
    let digits = format!("{value:.0}");
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pop::tests::findings;

    #[test]
    fn numbers_have_three_digits_and_counts_have_groups() {
        let numbers = [123.4, 12.345, 1.2345, 0.0123, 0.0].map(|value| number(Some(value)));
        assert_eq!(numbers, ["123", "12.3", "1.23", "0.012", "0.00"]);
        let counts = [0.0, 999.0, 1000.0, 1_234_567.0].map(|value| count(Some(value)));
        assert_eq!(counts, ["0", "999", "1,000", "1,234,567"]);
        assert_eq!([number(None), count(None)], ["–", "–"]);
        assert_eq!(ratio(Some(1.0), Some(0.0)), None);
    }

    #[test]
    fn trees_stand_beside_the_thesis() {
        let text = trees(&findings());
        let rows: Vec<&str> = text.lines().skip(2).collect();
        assert_eq!(rows.len(), 6, "{text}");
        assert_eq!(
            rows[0],
            "| horse  |    96,966 |   0.500 |      1.05 |      9 |"
        );
        assert!(
            rows[1].starts_with("| hand   |   654,666 |       – |"),
            "{text}"
        );
        assert!(rows[5].starts_with("| brain  |"), "{text}");
    }

    #[test]
    fn distances_have_rows_for_both() {
        let text = by_distance(&findings());
        let has = |start: &str, cells: &[&str]| {
            let mut lines = text.lines();
            lines.any(|line| {
                let words: Vec<&str> = line.split('|').map(str::trim).collect();
                words[1..4].join(" ") == start && words[4..4 + cells.len()] == *cells
            })
        };
        assert!(has("horse frames a second here", &["250", "–"]), "{text}");
        assert!(has("horse points here", &["12,345", "–"]), "{text}");
        assert!(
            has("horse triangles thesis", &["29,014", "2,229"]),
            "{text}"
        );
        assert!(has("brain points here", &["12,345"]), "{text}");
        assert!(!text.contains("hand"), "{text}");
        // The brain is not in the thesis.
        assert_eq!(text.lines().count(), 2 + 6 + 3);
    }

    #[test]
    fn pop_is_held_against_the_classic_method() {
        let text = classic(&findings());
        let mut lines = text.lines().map(|line| line.replace(' ', ""));
        assert!(
            lines.any(|line| line == "|horse|here|25.0|–|–|10.0|–|–|"),
            "{text}"
        );
        let mut lines = text.lines().map(|line| line.replace(' ', ""));
        assert!(
            lines.any(|line| line == "|sphere|thesis|7.10|7.10|7.10|1.24|2.09|13.4|"),
            "{text}"
        );
    }
}
