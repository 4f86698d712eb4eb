//! `cargo xtask side-by-side`: the reports to show, and the tables of a thesis measured again.
//!
//! The program does all of it: `compare` makes a report of each of [`REPORTS`], `bench` times the renderers on the models of
//! [`thesis`]. Its numbers stand beside the thesis's in one [`page`].

use std::path::{Path, PathBuf};

use crate::json::Value;
use crate::out::OutFolder;
use crate::{Outcome, build, paths, process, setup};

mod page;
mod thesis;

/// Size of every picture, as in the thesis.
const SIZE: &str = "800x580";

/// A model, and what its report's folder is called.
struct Model {
    name: &'static str,
    /// In the shared test data folder.
    file: &'static str,
    /// Its faces are wound inward.
    flip: bool,
}

/// A small scan that everybody knows, and the largest one.
const REPORTS: [Model; 2] = [
    Model {
        name: "bunny",
        file: "mesh/bunny_zipper_ascii.ply",
        flip: false,
    },
    Model {
        name: "brain",
        file: "mesh/brain_ch2better_1092k_le.ply",
        flip: true,
    },
];

/// Who stands for the thesis's renderers, in the order of its table 9.6: Surfel, OpenGL, EWA and HQSS. The last two are HQSS as
/// table 10.2 has it: several passes over the surfels, and one.
const RENDERERS: &str = "surfel,points,ewa-reference,hqss,hqss:path=raster,hqss:path=compute";

/// Makes reports and tables in the folder named, `target/side-by-side` unless given.
pub(crate) fn side_by_side(arguments: &[String]) -> Outcome {
    let out = OutFolder::path_of(arguments, "side-by-side")?;
    setup::set_up(setup::Needs::NONE)?;
    let place = Place {
        program: build::release()?,
        out: OutFolder::make(&out)?,
    };
    let reports = REPORTS.iter().map(|model| place.report(model));
    let failures: Vec<String> = reports.filter_map(Result::err).collect();
    place.tables()?;
    if failures.is_empty() {
        Ok(())
    } else {
        Err(failures.join("\n"))
    }
}

/// Where it is done.
struct Place {
    program: PathBuf,
    out: OutFolder,
}

impl Place {
    /// All renderers on one model, against the exact one.
    fn report(&self, model: &Model) -> Outcome {
        let Some(file) = paths::shared_data_or_say(model.file) else {
            return Ok(());
        };
        let mut command = self.out.command(&self.program, "compare")?;
        command.arg(file).args(["--renderers", "all"]);
        command.args(["--reference", "ewa-reference", "--size", SIZE]);
        command.args(["--views", "orbit:12", "--out", model.name]);
        if model.flip {
            command.arg("--flip");
        }
        process::run(&format!("the report of the {}", model.name), &mut command)?;
        let report = self.out.path().join(model.name).join("report.html");
        process::say(&format!("the report is {}", paths::shown(&report)));
        Ok(())
    }

    /// The thesis's tables on our models.
    fn tables(&self) -> Outcome {
        let models = thesis::MODELS.iter();
        let models =
            models.filter_map(|model| Some((model, paths::shared_data_or_say(model.stand_in)?)));
        let models: Vec<(&thesis::Model, PathBuf)> = models.collect();
        if models.is_empty() {
            return Ok(());
        }
        let mut command = self.out.command(&self.program, "bench")?;
        command.args(models.iter().map(|(_, file)| file));
        command.args(["--renderers", RENDERERS, "--size", SIZE]);
        command.args(["--frames", "40", "--budget", "10", "--out", "speed"]);
        process::run("the tables", &mut command)?;
        let file = self.out.path().join("speed/bench.json");
        let measured = read(&file)?;
        let models: Vec<&thesis::Model> = models.into_iter().map(|(model, _)| model).collect();
        let page = page::markdown(&models, &measured);
        let file = self.out.write("tables.md", &page)?;
        process::say(&format!("the tables are {}", paths::shown(&file)));
        println!("{page}");
        Ok(())
    }
}

fn read(file: &Path) -> Outcome<Value> {
    let text = std::fs::read_to_string(file)
        .map_err(|error| format!("{}: {error}", paths::shown(file)))?;
    Value::parse(&text).ok_or_else(|| format!("{}: this is no JSON", paths::shown(file)))
}
