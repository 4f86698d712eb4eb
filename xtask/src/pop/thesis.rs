//! What the thesis measured: tables 5.1 to 5.6 of *Point Based Rendering*, a diploma thesis at the University of West Bohemia,
//! Plzeň, that implemented POP.

/// What it measured on, for the reader of its times.
pub(super) const MACHINE: &str =
    "AMD Athlon XP 1800+, 1 GB of memory, NVIDIA GeForce Ti 4200 with 128 MB";

/// One of its models.
pub(super) struct Model {
    pub(super) name: &'static str,
    /// Table 5.1.
    pub(super) triangle_count: u32,
    /// Table 5.2: building the tree.
    pub(super) tree_secs: f64,
    /// Table 5.3: by distances 1 to 7, at threshold 3.
    pub(super) by_distance: [Drawn; 7],
    /// Table 5.4: frames a second of all triangles.
    pub(super) classic_fps: f64,
    /// Table 5.5: by thresholds 1 to 5.
    pub(super) by_threshold: [Drawn; 5],
    /// The distance of table 5.5, which the thesis does not say: the one at which table 5.3 has the same numbers.
    pub(super) threshold_distance: u8,
    /// Table 5.6.
    pub(super) node_count: u32,
}

/// Frames a second, and what was drawn in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drawn {
    pub(super) fps: f64,
    pub(super) triangles: u32,
    pub(super) points: u32,
}

const fn drawn<const COUNT: usize>(
    fps: [f64; COUNT],
    triangles: [u32; COUNT],
    points: [u32; COUNT],
) -> [Drawn; COUNT] {
    let mut all = [Drawn {
        fps: 0.0,
        triangles: 0,
        points: 0,
    }; COUNT];
    let mut index = 0;
    // Constants know no iterators yet.
    while index < COUNT {
        all[index] = Drawn {
            fps: fps[index],
            triangles: triangles[index],
            points: points[index],
        };
        index += 1;
    }
    all
}

/// In its order.
pub(super) const MODELS: [Model; 5] = [
    Model {
        name: "horse",
        triangle_count: 96_966,
        tree_secs: 1.05,
        by_distance: drawn(
            [46.0, 46.0, 63.0, 105.0, 117.0, 135.0, 196.0],
            [29_014, 2229, 146, 76, 55, 47, 37],
            [9507, 36_644, 28_447, 17_670, 16_061, 13_580, 8476],
        ),
        classic_fps: 70.0,
        by_threshold: drawn(
            [41.58, 42.16, 63.0, 111.0, 131.0],
            [41_959, 3564, 146, 64, 44],
            [476, 38_383, 28_447, 16_735, 13_967],
        ),
        threshold_distance: 3,
        node_count: 140_657,
    },
    Model {
        name: "hand",
        triangle_count: 654_666,
        tree_secs: 11.71,
        by_distance: drawn(
            [7.27, 15.84, 36.63, 47.0, 74.0, 108.0, 121.0],
            [43_118, 0, 0, 0, 0, 0, 0],
            [223_709, 129_706, 49_826, 38_095, 22_243, 14_339, 13_108],
        ),
        classic_fps: 10.9,
        by_threshold: drawn(
            [6.09, 8.65, 15.84, 27.18, 43.56],
            [229_706, 32, 0, 0, 0],
            [84_268, 225_187, 129_706, 71_514, 41_560],
        ),
        threshold_distance: 2,
        node_count: 1_003_497,
    },
    Model {
        name: "dragon",
        triangle_count: 871_414,
        tree_secs: 16.37,
        by_distance: drawn(
            [8.33, 15.53, 26.21, 39.0, 52.48, 66.0, 85.0],
            [17_822, 882, 58, 3, 0, 0, 0],
            [215_049, 127_486, 74_497, 48_007, 34_533, 26_762, 20_382],
        ),
        classic_fps: 8.25,
        by_threshold: drawn(
            [5.04, 8.41, 15.53, 25.74, 38.24],
            [150_355, 14_382, 882, 64, 7],
            [238_495, 219_683, 127_486, 75_285, 48_586],
        ),
        threshold_distance: 2,
        node_count: 1_220_939,
    },
    Model {
        name: "sphere",
        triangle_count: 1_000_000,
        tree_secs: 16.58,
        by_distance: drawn(
            [8.82, 14.85, 27.72, 38.24, 68.0, 88.0, 95.0],
            [98_001, 0, 0, 0, 0, 0, 0],
            [169_007, 147_646, 80_378, 56_204, 30_542, 23_865, 21_669],
        ),
        classic_fps: 7.1,
        by_threshold: drawn(
            [7.08, 8.26, 14.85, 29.0, 36.63],
            [332_996, 0, 0, 0, 0],
            [49, 280_443, 147_646, 76_935, 58_697],
        ),
        threshold_distance: 2,
        node_count: 1_349_525,
    },
    Model {
        name: "torus",
        triangle_count: 4_000_000,
        tree_secs: 104.8,
        by_distance: drawn(
            [2.24, 4.17, 7.84, 10.0, 13.0, 18.27, 23.53],
            [0; 7],
            [907_676, 434_868, 207_231, 161_845, 125_540, 87_903, 67_515],
        ),
        classic_fps: 1.8,
        by_threshold: drawn(
            [1.2, 3.54, 7.84, 10.78, 15.84],
            [0; 5],
            [1_879_977, 520_579, 207_231, 150_517, 101_069],
        ),
        threshold_distance: 3,
        node_count: 5_398_101,
    },
];

/// The thesis's model of this name; it has no other.
pub(super) fn model(name: &str) -> Option<&'static Model> {
    MODELS.iter().find(|model| model.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_tables_meet_at_threshold_3() {
        for model in &MODELS {
            let column = usize::from(model.threshold_distance) - 1;
            assert_eq!(
                model.by_threshold[2], model.by_distance[column],
                "{}",
                model.name
            );
        }
    }
}
