//! The page: tables and graphs in the thesis's order.

use pointstage_plot::Look;

use super::plan::{FRAMES, SIZE_PX, THRESHOLD, TURN_DEG, WARM_UP};
use super::{Findings, goals, graphs, tables, thesis};
use crate::Outcome;
use crate::out::{self, OutFolder};

/// Writes `pop.md` and its graphs.
pub(super) fn write(found: &Findings, out: &OutFolder) -> Outcome {
    let all = [graphs::trees(found), graphs::nodes(found)];
    let all = all.into_iter().chain(graphs::by_distance(found));
    for (name, plot) in all.chain(graphs::by_threshold(found)) {
        out.write(&format!("{name}.svg"), plot.svg(Look::Document))?;
    }
    out.write("pop.md", text(found, &out::commit()))?;
    Ok(())
}

fn text(found: &Findings, commit: &str) -> String {
    let mut text = head(found, commit);
    section(
        &mut text,
        "Building the tree (table 5.2, graph 5.1)",
        "Medians of builds anew, each in a new session.",
        &tables::trees(found),
        &["5.1-tree"],
    );
    section(
        &mut text,
        "Frames by distance (table 5.3, graphs 5.2 to 5.4)",
        &format!(
            "Threshold {THRESHOLD} px. What is not drawn at all has no place on a logarithmic axis."
        ),
        &tables::by_distance(found),
        &[
            "5.2-frames-by-distance",
            "5.3-triangles-by-distance",
            "5.4-points-by-distance",
        ],
    );
    section(
        &mut text,
        "The classic method (table 5.4)",
        "Frames a second with all triangles, and how many times as many POP draws. To the thesis, all distances of the classic \
         method were the same.",
        &tables::classic(found),
        &[],
    );
    section(
        &mut text,
        "Frames by threshold (table 5.5, graphs 5.5 to 5.7)",
        "From the distance at which the thesis's table 5.3 has the same numbers at 3 px; it does not say which it was.",
        &tables::by_threshold(found),
        &[
            "5.5-frames-by-threshold",
            "5.6-triangles-by-threshold",
            "5.7-points-by-threshold",
        ],
    );
    section(
        &mut text,
        "Nodes of the tree (table 5.6, graph 5.8)",
        "",
        &tables::nodes(found),
        &["5.8-nodes"],
    );
    section(
        &mut text,
        "Squares (behind graphs 5.1 and 5.8)",
        "The unit square in ever more triangles. The thesis measured the first ten and printed them as graphs only.",
        &tables::squares(found),
        &[],
    );
    section(
        &mut text,
        "Parts of a frame",
        &format!("At threshold {THRESHOLD} px; the thesis has no such table."),
        &tables::parts(found),
        &[],
    );
    if let Some(goals) = goals::goals(found) {
        section(&mut text, "Goals", "", &goals, &[]);
    }
    text
}

/// What was measured, and how, so that it can be measured again.
fn head(found: &Findings, commit: &str) -> String {
    let [width, height] = SIZE_PX;
    let device = found.device().unwrap_or("no graphics device");
    let mut text = format!(
        "# POP, measured as in the thesis\n\n\
         Made by `cargo xtask pop` at {commit} on {device}.\n\n\
         The thesis is *Point Based Rendering*, a diploma thesis at the University of West Bohemia, Plzeň, chapter 5. Its values \
         stand beside ours; it measured on an {}. What is compared is how values grow and shrink, not the machines.\n\n\
         - Pictures of {width}×{height} pixels, threshold {THRESHOLD} px unless said otherwise, back-facing nodes left out.\n\
         - **z** is the distance of the eye from the model's centre (that of its box). At z = 1 the sphere around that centre \
         that holds the model just fills the picture's height, at a field of view of 40°. The thesis does not say what its z is, \
         so equal z need not mean equal size on the screen.\n\
         - The eye circles the model by {TURN_DEG}° a frame, 20° above its middle. A frame lasts from the request to the composed \
         picture in memory; the first {WARM_UP} of each measurement do not count, and numbers are medians of the {FRAMES} after \
         them. Frames a second are 1000 over the median in ms.\n\
         - Sphere, torus and squares are made anew with the thesis's counts; its hand is not to be had, and the brain is an addition.\n",
        thesis::MACHINE
    );
    let mut say = |what: &str, lines: &[String]| {
        if !lines.is_empty() {
            text.extend(["- ", what, ": ", &lines.join("; "), ".\n"]);
        }
    };
    let skipped: Vec<String> = found
        .skipped
        .iter()
        .map(|name| (*name).to_owned())
        .collect();
    say(
        "Skipped, since the shared test data folder has no such file",
        &skipped,
    );
    say("Failed", &found.failures);
    text
}

fn section(text: &mut String, title: &str, words: &str, table: &str, graphs: &[&str]) {
    text.extend(["\n## ", title, "\n\n"]);
    if !words.is_empty() {
        text.extend([words, "\n\n"]);
    }
    text.push_str(table);
    for graph in graphs {
        text.extend(["\n![", graph, "](", graph, ".svg)\n"]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pop::tests::findings;

    #[test]
    fn the_page_shows_each_graph_that_is_written() {
        let found = findings();
        let text = text(&found, "abc");
        let all = [graphs::trees(&found), graphs::nodes(&found)];
        let all = all.into_iter().chain(graphs::by_distance(&found));
        let all: Vec<_> = all.chain(graphs::by_threshold(&found)).collect();
        assert_eq!(all.len(), 8);
        for (name, _) in all {
            assert!(text.contains(&format!("({name}.svg)")), "{name}");
        }
        assert_eq!(text.matches("![").count(), 8);
    }

    #[test]
    fn the_page_says_what_was_skipped() {
        let mut found = findings();
        assert!(!text(&found, "abc").contains("Skipped"));
        found.skipped.extend(["dragon", "torus"]);
        let text = text(&found, "abc");
        assert!(text.contains("no such file: dragon; torus.\n"), "{text}");
        assert!(text.contains("at abc on a device."), "{text}");
        assert!(text.contains("Athlon XP 1800+"), "{text}");
    }
}
