//! The goals that were set for our own implementation, on the brain.

use super::Findings;
use super::measured::{Frames, Measured};
use super::models::BRAIN;
use super::plan::{Case, GOAL_EYES, GOAL_THRESHOLD, Method};
use super::tables::{number, ratio};
use crate::markdown;

/// POP's frame is so many times shorter than that of all triangles: near, and far.
const FASTER: [f64; 2] = [5.0, 20.0];

/// Nodes visited along the front, of those visited from the root.
const VISITED: f64 = 0.5;

/// The table of goals; `None` without the brain.
pub(super) fn goals(found: &Findings) -> Option<String> {
    let brain = found.models.iter().find(|model| model.name == BRAIN.name)?;
    let measured = &brain.measured;
    let head = [
        "goal",
        "asked",
        "measured",
        "reached",
        "POP or coherent",
        "classic or full",
        "without composition",
    ]
    .map(String::from);
    let mut cells = vec![head.to_vec()];
    for (eye, asked) in GOAL_EYES.into_iter().zip(FASTER) {
        let [pop, classic] =
            [Method::Pop, Method::Classic].map(|method| measured.frames(Case::goal(method, eye)));
        let time = |of: fn(&Frames) -> Option<f64>| {
            let [pop, classic] = [pop, classic].map(|frames| frames.and_then(of));
            (pop, classic, ratio(classic, pop))
        };
        let (frame, drawing) = (time(Frames::frame_ms), time(Frames::drawing_ms));
        let distance = number(pop.and_then(Frames::distance));
        cells.push(vec![
            format!("POP faster at z = {distance}"),
            format!("≥ {asked}"),
            number(frame.2),
            reached(frame.2.map(|faster| faster >= asked)),
            format!("{} ms", number(frame.0)),
            format!("{} ms", number(frame.1)),
            number(drawing.2),
        ]);
    }
    cells.push(nodes(measured));
    Some(format!(
        "The brain, threshold {GOAL_THRESHOLD} px; first where it covers half the picture's height, then far away. Nodes are those \
         that the CPU visits from frame to frame at the first of these, along the front of the frame before, and from the \
         root.\n\n{}",
        markdown::table(1, &cells)
    ))
}

fn nodes(measured: &Measured) -> Vec<String> {
    let visited = [Method::Coherent, Method::Full].map(|method| {
        let frames = measured.frames(Case::goal(method, GOAL_EYES[0]));
        frames.and_then(|frames| frames.reported("nodes_visited"))
    });
    let [coherent, full] = visited;
    let part = ratio(coherent, full);
    vec![
        "nodes visited, coherent : full".to_owned(),
        format!("≤ {VISITED}"),
        number(part),
        reached(part.map(|part| part <= VISITED)),
        super::tables::count(coherent),
        super::tables::count(full),
        String::new(),
    ]
}

fn reached(reached: Option<bool>) -> String {
    let word = match reached {
        Some(true) => "yes",
        Some(false) => "no",
        None => "not measured",
    };
    word.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pop::tests::findings;

    #[test]
    fn goals_say_whether_they_are_reached() {
        let text = goals(&findings()).expect("the brain is there");
        let rows: Vec<String> = text
            .lines()
            .filter(|line| line.starts_with("| POP") || line.starts_with("| nodes"))
            .map(|line| line.replace(' ', ""))
            .collect();
        assert_eq!(
            rows,
            [
                "|POPfasteratz=1.91|≥5|6.00|yes|10.0ms|60.0ms|7.00|",
                "|POPfasteratz=–|≥20|–|notmeasured|–ms|–ms|–|",
                "|nodesvisited,coherent:full|≤0.5|0.600|no|600|1,000||",
            ]
        );
    }

    #[test]
    fn without_the_brain_there_are_none() {
        let mut found = findings();
        found.models.retain(|model| model.name != "brain");
        assert!(goals(&found).is_none());
    }
}
