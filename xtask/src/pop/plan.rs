//! What the benchmark is asked to measure.
//!
//! A [`Plan`] goes to it as JSON. It builds the tree anew a few times, then times each [`Case`] on a slow orbit.

use super::models::BRAIN;
use super::thesis;

/// Size of every picture, as in the thesis.
pub(super) const SIZE_PX: [u32; 2] = [500, 500];
/// Turn of the eye around the model from frame to frame.
pub(super) const TURN_DEG: f64 = 1.0;
/// Frames drawn first in each case: uploads, and the front's way from where the case before left it.
pub(super) const WARM_UP: usize = 2;
/// Frames of each case that count.
pub(super) const FRAMES: usize = 9;
/// Times that a tree is built.
pub(super) const BUILDS: usize = 3;

/// Distances of table 5.3.
pub(super) const DISTANCES: [u8; 7] = [1, 2, 3, 4, 5, 6, 7];
/// Distances of the classic method. To the thesis they were all the same.
pub(super) const CLASSIC_DISTANCES: [u8; 3] = [1, 2, 7];
/// Thresholds of table 5.5, px.
pub(super) const THRESHOLDS: [u8; 5] = [1, 2, 3, 4, 5];
/// Threshold where none is named, px.
pub(super) const THRESHOLD: u8 = 3;

/// From where the goals are measured: as near as work is done, and far away.
pub(super) const GOAL_EYES: [Eye; 2] = [Eye::Height(0.5), Eye::Distance(16)];
/// Threshold of the goals, px.
pub(super) const GOAL_THRESHOLD: u8 = 2;

/// Where the eye is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Eye {
    /// So far from the model's centre, in distances at which the sphere around the model fills the picture's height.
    Distance(u8),
    /// Where the model covers this part of the picture's height.
    Height(f64),
}

/// What draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// All triangles.
    Classic,
    /// Points and triangles from the tree.
    Pop,
    /// The same, selected by the CPU, whose nodes are counted, along the front of the frame before.
    Coherent,
    /// The same from the root in each frame.
    Full,
}

/// One measurement of frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Case {
    pub(super) method: Method,
    pub(super) threshold: u8,
    pub(super) eye: Eye,
}

impl Case {
    /// POP from a distance.
    pub(super) const fn pop(distance: u8, threshold: u8) -> Self {
        Self {
            method: Method::Pop,
            threshold,
            eye: Eye::Distance(distance),
        }
    }

    /// All triangles from a distance.
    pub(super) const fn classic(distance: u8) -> Self {
        Self {
            method: Method::Classic,
            threshold: THRESHOLD,
            eye: Eye::Distance(distance),
        }
    }

    /// A goal's.
    pub(super) const fn goal(method: Method, eye: Eye) -> Self {
        Self {
            method,
            threshold: GOAL_THRESHOLD,
            eye,
        }
    }

    /// What tells it from the others.
    pub(super) fn name(self) -> String {
        let method = match self.method {
            Method::Classic => "classic",
            Method::Pop => "pop",
            Method::Coherent => "coherent",
            Method::Full => "full",
        };
        let eye = match self.eye {
            Eye::Distance(distance) => format!("distance {distance}"),
            Eye::Height(part) => format!("{part} of the height"),
        };
        format!("{method}, threshold {}, {eye}", self.threshold)
    }

    fn json(self) -> String {
        let settings = match self.method {
            Method::Classic => r#""method": "classic""#,
            Method::Pop => r#""method": "pop""#,
            Method::Coherent => r#""method": "pop", "selection": "cpu", "coherence": "on""#,
            Method::Full => r#""method": "pop", "selection": "cpu", "coherence": "off""#,
        };
        let eye = match self.eye {
            Eye::Distance(distance) => format!("\"distance\": {distance}"),
            Eye::Height(part) => format!("\"height\": {part}"),
        };
        format!(
            "{{\"name\": \"{}\", {eye}, \"settings\": {{{settings}, \"threshold\": {}}}}}",
            self.name(),
            self.threshold
        )
    }
}

/// At which distance thresholds are compared, on a model: that of the thesis, which took 2 on most.
pub(super) fn threshold_distance(model: &str) -> u8 {
    thesis::model(model).map_or(2, |model| model.threshold_distance)
}

/// All that is measured on a model.
pub(super) struct Plan {
    pub(super) flip: bool,
    pub(super) cases: Vec<Case>,
}

impl Plan {
    /// For a model of this name.
    pub(super) fn of_model(name: &str, flip: bool) -> Self {
        let distance = threshold_distance(name);
        let mut cases: Vec<Case> = DISTANCES.map(|z| Case::pop(z, THRESHOLD)).into();
        let thresholds = THRESHOLDS.iter().filter(|other| **other != THRESHOLD);
        cases.extend(thresholds.map(|threshold| Case::pop(distance, *threshold)));
        cases.extend(CLASSIC_DISTANCES.map(Case::classic));
        if name == BRAIN.name {
            for eye in GOAL_EYES {
                cases.extend([Method::Pop, Method::Classic].map(|by| Case::goal(by, eye)));
            }
            let near = GOAL_EYES[0];
            cases.extend([Method::Coherent, Method::Full].map(|by| Case::goal(by, near)));
        }
        Self { flip, cases }
    }

    /// For what only has its tree built.
    pub(super) const fn of_tree() -> Self {
        Self {
            flip: false,
            cases: Vec::new(),
        }
    }

    /// As the benchmark reads it. Trees are not kept on disk: their building is measured.
    pub(super) fn json(&self) -> String {
        let cases: Vec<String> = self.cases.iter().map(|case| case.json()).collect();
        let [width, height] = SIZE_PX;
        format!(
            "{{\"flip\": {}, \"size\": [{width}, {height}], \"turn_deg\": {TURN_DEG:?},\n \
             \"builds\": {BUILDS}, \"warm_up\": {WARM_UP}, \"frames\": {FRAMES},\n \
             \"settings\": {{\"cull_backs\": \"on\", \"cache\": false}},\n \"cases\": [\n  {}]}}\n",
            self.flip,
            cases.join(",\n  ")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::json::Value;

    #[test]
    fn each_case_has_a_name_of_its_own() {
        let plan = Plan::of_model("brain", true);
        let mut names: Vec<String> = plan.cases.iter().map(|case| case.name()).collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
        // Distances, other thresholds, classic, goals.
        assert_eq!(count, 7 + 4 + 3 + 6);
    }

    #[test]
    fn a_plan_is_json_that_says_each_case() {
        let plan = Plan::of_model("brain", true);
        let json = Value::parse(&plan.json()).expect("JSON");
        assert!(json.is_true("flip"));
        let cases = json.get("cases").map_or(&[][..], Value::items);
        assert_eq!(cases.len(), plan.cases.len());
        for (said, case) in cases.iter().zip(&plan.cases) {
            assert_eq!(said.text("name"), Some(case.name().as_str()));
            let settings = said.get("settings").expect("settings");
            assert_eq!(settings.number("threshold"), Some(case.threshold.into()));
            let eye = match case.eye {
                Eye::Distance(distance) => (said.number("distance"), f64::from(distance)),
                Eye::Height(part) => (said.number("height"), part),
            };
            assert_eq!(eye.0, Some(eye.1));
        }
    }

    #[test]
    fn a_tree_is_built_without_frames() {
        let json = Value::parse(&Plan::of_tree().json()).expect("JSON");
        assert_eq!(json.get("cases").map(Value::items), Some(&[][..]));
        assert_eq!(json.number("builds"), Some(3.0));
    }
}
