//! What the thesis measured, and the models that stand for its own.
//!
//! A project report of students at the Université de Bordeaux on sequential point trees and HQSS as plugins of PointShop3D,
//! figures 9.4, 9.6 and 10.2: frames a second in a window of 800×580 pixels.

/// One of its five models.
pub(super) struct Model {
    /// As it calls the file.
    pub(super) name: &'static str,
    pub(super) surfels: u32,
    /// Frames a second of Surfel, OpenGL, EWA and HQSS, as written in its table 9.6.
    pub(super) frames: [&'static str; 4],
    /// Frames a second of HQSS with frame buffer objects, table 10.2.
    pub(super) with_fbo: u32,
    /// Stands for it: a model of about its size, in the shared test data folder.
    pub(super) stand_in: &'static str,
}

pub(super) const MODELS: [Model; 5] = [
    Model {
        name: "face.sfl",
        surfels: 40_880,
        frames: ["3", "5", "90", "80"],
        with_fbo: 100,
        stand_in: "mesh/bunny_zipper_ascii.ply",
    },
    Model {
        name: "dinosaur.sfl",
        surfels: 56_194,
        frames: ["3", "4", "76", "80"],
        with_fbo: 115,
        stand_in: "mesh/lucy_50k_le.ply",
    },
    Model {
        name: "santa.sfl",
        surfels: 75_781,
        frames: ["2", "3", "56", "65"],
        with_fbo: 90,
        stand_in: "points/pond_70k_normals_rgb_le.ply",
    },
    Model {
        name: "male.sfl",
        surfels: 148_138,
        frames: ["2", "2", "26", "56"],
        with_fbo: 64,
        stand_in: "mesh/igea_tristrips_le.ply",
    },
    Model {
        name: "dragon.sfl",
        surfels: 1_236_969,
        frames: ["<1", "<1", "3.5", "7"],
        with_fbo: 10,
        stand_in: "mesh/brain_ch2better_1092k_le.ply",
    },
];
