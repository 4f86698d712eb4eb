//! `cargo xtask pop`: the renderer `pop` measured as the thesis measured its own, both side by side.
//!
//! The thesis ([`thesis`]) timed POP on a few [`models`]. The benchmark `pop` of the tests draws them in-process as a [`plan`]
//! says, and prints what it [`measured`]. From that come [`tables`], [`graphs`] and [`goals`], on one [`page`].

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::out::OutFolder;
use crate::{Outcome, build, paths, process, setup};
use measured::Measured;
use models::{MODELS, SQUARES};
use plan::Plan;
use surface::Surface;

mod goals;
mod graphs;
mod measured;
mod models;
mod page;
mod plan;
mod quantity;
mod surface;
mod tables;
mod thesis;

/// All that was measured so far.
#[derive(Debug, Default)]
struct Findings {
    models: Vec<ModelFound>,
    /// By their triangles.
    squares: Vec<(usize, Measured)>,
    /// Models that are not here.
    skipped: Vec<&'static str>,
    failures: Vec<String>,
}

/// A model, and what was found.
#[derive(Debug)]
struct ModelFound {
    name: &'static str,
    measured: Measured,
}

impl Findings {
    /// What drew.
    fn device(&self) -> Option<&str> {
        let models = self.models.iter().map(|model| &model.measured);
        let squares = self.squares.iter().map(|(_, measured)| measured);
        models.chain(squares).find_map(Measured::device)
    }
}

/// What the command line says.
#[derive(Debug, PartialEq)]
struct Arguments {
    out: PathBuf,
    /// The benchmark, built before.
    program: Option<PathBuf>,
}

impl Arguments {
    fn of(arguments: &[String]) -> Outcome<Self> {
        let (mut out, mut program) = (None, None);
        let mut rest = arguments.iter();
        while let Some(argument) = rest.next() {
            if argument == "--with" {
                let path = rest.next();
                program = Some(path.ok_or("--with needs the benchmark's path")?.into());
            } else if out.is_none() && !argument.starts_with('-') {
                out = Some(PathBuf::from(argument));
            } else {
                return Err(format!(
                    "'{argument}' was not expected here; see `cargo xtask help`"
                ));
            }
        }
        Ok(Self {
            out: out.unwrap_or_else(|| paths::target().join("pop")),
            program,
        })
    }
}

/// Measures, and writes the page into the folder named, `target/pop` unless given.
pub(crate) fn pop(arguments: &[String]) -> Outcome {
    let arguments = Arguments::of(arguments)?;
    if arguments.program.is_none() {
        setup::set_up(setup::Needs::NONE)?;
        build::release()?;
        // Now, so that a benchmark that does not build fails once and not for each model.
        process::say("building the benchmark");
        process::run("building the benchmark", &mut benchmark(&["--no-run"]))?;
    }
    let out = OutFolder::make(&arguments.out)?;
    let place = Place {
        models: out.folder("models")?,
        plans: out.folder("plans")?,
        measured: out.folder("measured")?,
        program: arguments.program,
        out,
    };
    place.run()
}

/// Cargo, to build or run the benchmark.
fn benchmark(arguments: &[&str]) -> Command {
    let mut command = process::cargo(&["bench", "--package", "pointstage-tests", "--bench", "pop"]);
    command.args(arguments);
    command
}

/// Where measurements are made.
struct Place {
    out: OutFolder,
    models: OutFolder,
    plans: OutFolder,
    measured: OutFolder,
    program: Option<PathBuf>,
}

impl Place {
    fn run(&self) -> Outcome {
        let mut found = Findings::default();
        for model in &MODELS {
            let Some(file) = model.file(&self.models)? else {
                found.skipped.push(model.name);
                continue;
            };
            let plan = Plan::of_model(model.name, model.flip);
            let measured = self.measure(model.name, &file, &plan, &mut found)?;
            let name = model.name;
            found.models.push(ModelFound { name, measured });
            // After each, so that what was found is there if the rest is broken off.
            page::write(&found, &self.out)?;
        }
        for triangle_count in SQUARES {
            let name = format!("square_{}k", triangle_count / 1000);
            let file = models::made(&self.models, &name, Surface::square(triangle_count))?;
            let measured = self.measure(&name, &file, &Plan::of_tree(), &mut found)?;
            found.squares.push((triangle_count, measured));
        }
        page::write(&found, &self.out)?;
        let page = self.out.path().join("pop.md");
        process::say(&format!("the page is {}", paths::shown(&page)));
        if found.failures.is_empty() {
            Ok(())
        } else {
            Err(found.failures.join("\n"))
        }
    }

    /// Has the benchmark measure a file. What it found before it failed counts, and the failure is noted.
    fn measure(
        &self,
        name: &str,
        file: &Path,
        plan: &Plan,
        found: &mut Findings,
    ) -> Outcome<Measured> {
        process::say(&format!("measuring {name}"));
        let plan = self.plans.write(&format!("{name}.json"), plan.json())?;
        let mut command = match &self.program {
            Some(program) => Command::new(program),
            None => benchmark(&["--quiet", "--"]),
        };
        command.arg(plan).arg(file);
        setup::prepare_environment(&mut command)?;
        let (mut measured, mut lines) = (Measured::default(), String::new());
        let well = process::follow(&format!("measuring {name}"), &mut command, |line| {
            if measured.take(line) {
                lines.extend([line, "\n"]);
            }
        })?;
        self.measured.write(&format!("{name}.jsonl"), lines)?;
        if !well {
            found.failures.push(format!("measuring {name} failed"));
        }
        Ok(measured)
    }
}

#[cfg(test)]
mod tests {
    use super::plan::{Case, GOAL_EYES, Method};
    use super::*;

    fn measured(lines: &[String]) -> Measured {
        let mut measured = Measured::default();
        for line in lines {
            assert!(measured.take(line), "{line}");
        }
        measured
    }

    fn frames(case: Case, rest: &str) -> String {
        let name = case.name();
        format!("{{\"kind\": \"frames\", \"case\": \"{name}\", {rest}}}")
    }

    /// The horse and the brain, from near only, and two squares.
    pub(super) fn findings() -> Findings {
        let model = |triangles: u32| {
            let model = format!(
                r#"{{"kind": "model", "device": "a device", "surfels": 1, "triangles": {triangles}}}"#
            );
            let tree =
                r#"{"kind": "tree", "tree_ms": 500, "tree_nodes": 150000, "tree_levels": 9}"#;
            vec![model, tree.to_owned()]
        };
        let pop =
            r#""frame_ms": 4, "drawing_ms": 3, "distance": 1, "reported": {"splats_drawn": 12345}"#;
        let near = [
            frames(Case::pop(1, 3), pop),
            frames(Case::classic(1), r#""frame_ms": 40, "reported": {}"#),
        ];
        let goal = |method, rest| frames(Case::goal(method, GOAL_EYES[0]), rest);
        let goals = [
            goal(
                Method::Pop,
                r#""frame_ms": 10, "drawing_ms": 8, "distance": 1.91"#,
            ),
            goal(
                Method::Classic,
                r#""frame_ms": 60, "drawing_ms": 56, "distance": 1.91"#,
            ),
            goal(Method::Coherent, r#""reported": {"nodes_visited": 600}"#),
            goal(Method::Full, r#""reported": {"nodes_visited": 1000}"#),
        ];
        let horse = [model(96_966), near.to_vec()].concat();
        let brain = [model(2_182_508), near.to_vec(), goals.to_vec()].concat();
        Findings {
            models: vec![
                ModelFound {
                    name: "horse",
                    measured: measured(&horse),
                },
                ModelFound {
                    name: "brain",
                    measured: measured(&brain),
                },
            ],
            squares: [100_000, 200_000]
                .map(|count| (count, measured(&model(count as u32))))
                .into(),
            ..Findings::default()
        }
    }

    #[test]
    fn the_command_line_names_a_folder_and_a_program() {
        let of = |words: &[&str]| {
            let words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
            Arguments::of(&words)
        };
        assert!(of(&[]).expect("nothing is fine").out.ends_with("pop"));
        let expected = Arguments {
            out: "here".into(),
            program: Some("bench".into()),
        };
        assert_eq!(of(&["here", "--with", "bench"]).as_ref(), Ok(&expected));
        assert_eq!(of(&["--with", "bench", "here"]).as_ref(), Ok(&expected));
        for wrong in [&["--with"][..], &["a", "b"], &["--page"]] {
            assert!(of(wrong).is_err(), "{wrong:?}");
        }
    }
}
