//! What the benchmark found.

use super::plan::Case;
use crate::json::Value;

/// All about one model: the lines of JSON that the benchmark printed.
#[derive(Debug, Default)]
pub(super) struct Measured {
    frames: Vec<Frames>,
    others: Vec<Value>,
}

/// Frames of one case; medians.
#[derive(Debug)]
pub(super) struct Frames(Value);

impl Measured {
    /// Takes what may be a line of the benchmark's; says whether it was one.
    pub(super) fn take(&mut self, line: &str) -> bool {
        let value = line.starts_with('{').then(|| Value::parse(line)).flatten();
        let Some(value) = value else {
            return false;
        };
        match value.text("kind") {
            Some("frames") => self.frames.push(Frames(value)),
            Some(_) => self.others.push(value),
            None => return false,
        }
        true
    }

    fn of_kind(&self, kind: &str) -> impl Iterator<Item = &Value> {
        let lines = self.others.iter();
        lines.filter(move |line| line.text("kind") == Some(kind))
    }

    /// What drew.
    pub(super) fn device(&self) -> Option<&str> {
        self.of_kind("model").find_map(|line| line.text("device"))
    }

    pub(super) fn triangle_count(&self) -> Option<f64> {
        self.of_kind("model")
            .find_map(|line| line.number("triangles"))
    }

    /// Something about the tree, the median over its builds.
    fn of_tree(&self, key: &str) -> Option<f64> {
        let numbers = self.of_kind("tree").filter_map(|line| line.number(key));
        let mut numbers: Vec<f64> = numbers.collect();
        numbers.sort_by(f64::total_cmp);
        numbers.get(numbers.len() / 2).copied()
    }

    pub(super) fn tree_secs(&self) -> Option<f64> {
        self.of_tree("tree_ms").map(|millis| millis / 1e3)
    }

    pub(super) fn node_count(&self) -> Option<f64> {
        self.of_tree("tree_nodes")
    }

    pub(super) fn level_count(&self) -> Option<f64> {
        self.of_tree("tree_levels")
    }

    pub(super) fn frames(&self, case: Case) -> Option<&Frames> {
        let name = case.name();
        let mut frames = self.frames.iter();
        frames.find(|frames| frames.0.text("case") == Some(&name))
    }
}

impl Frames {
    /// From the request to the composed picture in memory.
    pub(super) fn frame_ms(&self) -> Option<f64> {
        self.0.number("frame_ms")
    }

    /// The renderer's part of that: its own time, and the device's.
    pub(super) fn drawing_ms(&self) -> Option<f64> {
        self.0.number("drawing_ms")
    }

    pub(super) fn fps(&self) -> Option<f64> {
        self.frame_ms().map(|millis| 1e3 / millis)
    }

    /// z, whichever way the eye's place was given.
    pub(super) fn distance(&self) -> Option<f64> {
        self.0.number("distance")
    }

    /// What the renderer reported under a key.
    pub(super) fn reported(&self, key: &str) -> Option<f64> {
        self.0.get("reported")?.number(key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_lines_of_the_benchmark_are_taken() {
        let mut measured = Measured::default();
        for line in [
            "   Compiling pointstage",
            "{\"a\": 1}",
            "{broken",
            "[{\"kind\": \"tree\"}]",
        ] {
            assert!(!measured.take(line), "{line}");
        }
        assert!(measured.take(r#"{"kind": "tree", "tree_ms": 5}"#));
        assert_eq!(measured.tree_secs(), Some(0.005));
        assert_eq!(measured.device(), None);
    }

    #[test]
    fn trees_are_medians_and_frames_are_found_by_their_case() {
        let mut measured = Measured::default();
        for millis in [3000, 1000, 2000] {
            let line = format!(r#"{{"kind": "tree", "tree_ms": {millis}, "tree_nodes": 7}}"#);
            assert!(measured.take(&line));
        }
        let case = Case::pop(2, 3);
        let line = format!(
            r#"{{"kind": "frames", "case": "{}", "frame_ms": 4, "reported": {{"splats_drawn": 9}}}}"#,
            case.name()
        );
        assert!(measured.take(&line));
        assert_eq!(measured.tree_secs(), Some(2.0));
        assert_eq!(measured.node_count(), Some(7.0));
        let frames = measured.frames(case).expect("frames");
        assert_eq!(frames.fps(), Some(250.0));
        assert_eq!(frames.reported("splats_drawn"), Some(9.0));
        assert_eq!(frames.reported("triangles_drawn"), None);
        assert!(measured.frames(Case::pop(1, 3)).is_none());
    }
}
