//! `cargo xtask quality`: how near the renderers come to exact pictures, as a table.
//!
//! The program's own `compare` draws and measures. Here is what it is asked: which models (of the repository, of
//! the shared test data folder where there is one, and a [`board`] that is made on the spot), from which distances ([`view`]),
//! and who is measured by whom ([`COMPARISONS`]). What it answers becomes one [`table`].

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::json::Value;
use crate::out::{self, OutFolder};
use crate::{Outcome, build, paths, process, setup};
use table::Row;
use view::{Distance, View};

mod board;
mod table;
mod view;

/// Size of every picture.
const SIZE_PX: [u32; 2] = [800, 580];

const NEAR: Distance = ("near", 0.4);
const MIDDLE: Distance = ("middle", 1.0);
const FAR: Distance = ("far", 4.0);

/// What is drawn.
struct Model {
    name: &'static str,
    source: Source,
    /// Its faces are wound inward.
    flip: bool,
}

/// Where a model comes from.
#[derive(Clone, Copy)]
enum Source {
    /// A file of the repository's `sample-data/`.
    Sample(&'static str),
    /// A file of the shared test data folder.
    Shared(&'static str),
    /// The [`board`].
    Board,
}

const fn model(name: &'static str, source: Source) -> Model {
    Model {
        name,
        source,
        flip: false,
    }
}

const BUNNY: Model = model("bunny", Source::Shared("mesh/bunny_zipper_ascii.ply"));
const DRAGON: Model = model("dragon", Source::Shared("mesh/dragon_vrip_437k_le.ply"));
const BRAIN: Model = Model {
    flip: true,
    ..model("brain", Source::Shared("mesh/brain_ch2better_1092k_le.ply"))
};
const LAURANA: Model = model("laurana", Source::Shared("mesh/laurana_rgba_le.ply"));
const BUST: Model = model("bust", Source::Sample("bust_200k.ply"));
const BOARD: Model = model("checkerboard", Source::Board);

/// Who is measured by whom, on what, from where.
struct Comparison {
    /// What its folders' names end in.
    name: &'static str,
    /// What it says, for the head of its table.
    title: &'static str,
    reference: &'static str,
    renderers: &'static str,
    models: &'static [Model],
    distances: &'static [Distance],
}

const COMPARISONS: &[Comparison] = &[
    Comparison {
        name: "splats",
        title: "Against exact splats",
        reference: "ewa-reference",
        renderers: "hqss,surfel,points:size_mode=attenuated",
        models: &[BUNNY, DRAGON, BRAIN, LAURANA, BUST],
        distances: &[NEAR, MIDDLE, FAR],
    },
    Comparison {
        name: "truth",
        title: "Against the mesh itself, 16 samples a pixel",
        reference: "ewa-reference:surface=triangles:samples=4:filter=false",
        renderers: "hqss,hqss:cull_backs=true,hqss:shading=splats,hqss:shading=splats:cull_backs=true,surfel,points:size_mode=attenuated,ewa-reference",
        models: &[DRAGON, BRAIN],
        distances: &[MIDDLE],
    },
    Comparison {
        name: "filter",
        title: "A checkerboard of surfels at a grazing angle, against splats without filter, 16 samples a pixel",
        reference: "ewa-reference:samples=4:filter=false",
        renderers: "hqss,hqss:filter=false,ewa-reference",
        models: &[BOARD],
        distances: &[NEAR, MIDDLE, FAR],
    },
];

/// Compares, and writes the table and all that the comparisons write into the folder named, `target/quality` unless given.
pub(crate) fn quality(arguments: &[String]) -> Outcome {
    let out = OutFolder::path_of(arguments, "quality")?;
    setup::set_up(setup::Needs::NONE)?;
    let place = Place {
        program: build::release()?,
        out: OutFolder::make(&out)?,
    };
    place.out.folder("views")?;
    place.run()
}

/// Where comparisons are made.
struct Place {
    program: PathBuf,
    out: OutFolder,
}

impl Place {
    fn run(&self) -> Outcome {
        let (mut page, mut failures, mut device) = (String::new(), Vec::new(), None);
        for comparison in COMPARISONS {
            let (mut rows, mut skipped) = (Vec::new(), Vec::new());
            for model in comparison.models {
                let Some(file) = self.file_of(model)? else {
                    skipped.push(model.name);
                    continue;
                };
                match self.compare(comparison, model, &file) {
                    Ok(metrics) => {
                        let distances = comparison.distances.iter().map(|(name, _)| *name);
                        let distances: Vec<&str> = distances.collect();
                        rows.extend(table::rows(model.name, &distances, &metrics));
                        device = metrics.text("device").map(String::from).or(device);
                    }
                    Err(message) => {
                        process::say(&message);
                        failures.push(message);
                    }
                }
            }
            page.push_str(&section(comparison, &rows, &skipped));
            // After each, so that what was found is there if the rest is broken off.
            let text = format!("{}{page}", head(device.as_deref()));
            self.out.write("quality.md", text)?;
        }
        let file = self.out.path().join("quality.md");
        process::say(&format!("the table is {}", paths::shown(&file)));
        println!("{}{page}", head(device.as_deref()));
        if failures.is_empty() {
            Ok(())
        } else {
            Err(failures.join("\n"))
        }
    }

    /// The model's file; `None`, with a word, where it is not here.
    fn file_of(&self, model: &Model) -> Outcome<Option<PathBuf>> {
        match model.source {
            Source::Sample(name) => Ok(Some(paths::root().join("sample-data").join(name))),
            Source::Shared(path) => Ok(paths::shared_data_or_say(path)),
            Source::Board => {
                let file = self.out.write("checkerboard.ply", board::ply())?;
                Ok(Some(file))
            }
        }
    }

    /// Has the program compare; what its `metrics.json` says.
    fn compare(&self, comparison: &Comparison, model: &Model, file: &Path) -> Outcome<Value> {
        let folder = format!("{}-{}", model.name, comparison.name);
        process::say(&format!("comparing: {folder}"));
        let base = match model.source {
            Source::Board => board::view(),
            Source::Sample(_) | Source::Shared(_) => self.view_of(file)?,
        };
        let mut views = Vec::new();
        for (distance, factor) in comparison.distances {
            // Relative to where the program is run: a comma in the folder's name would split the list.
            let view = format!("views/{}-{distance}.json", model.name);
            self.out.write(&view, base.moved(*factor).json())?;
            views.push(view);
        }
        let [width, height] = SIZE_PX;
        let mut command = self.command("compare", file)?;
        command
            .args(["--reference", comparison.reference])
            .args(["--renderers", comparison.renderers])
            .args(["--views", &views.join(",")])
            .args(["--size", &format!("{width}x{height}")])
            // The table has no times.
            .args(["--frames", "0"])
            .args(["--background", "#ffffff", "--out", &folder]);
        if model.flip {
            command.arg("--flip");
        }
        process::run(&format!("comparing {folder}"), &mut command)?;
        let metrics = self.out.path().join(folder).join("metrics.json");
        let text = std::fs::read_to_string(&metrics)
            .map_err(|error| format!("{}: {error}", paths::shown(&metrics)))?;
        Value::parse(&text).ok_or_else(|| format!("{}: this is no JSON", paths::shown(&metrics)))
    }

    /// The view in which the model fills the picture, as the program says when it draws one.
    fn view_of(&self, file: &Path) -> Outcome<View> {
        let [width, height] = SIZE_PX;
        let mut command = self.command("render", file)?;
        command
            .args(["--renderer", "fallback", "--no-device"])
            .args(["--estimate", "never", "--view", "orbit:1"])
            .args(["--size", &format!("{width}x{height}")])
            .args(["--json", "--out", "views/middle.png"]);
        let said = process::output(&mut command)
            .ok_or_else(|| format!("{} failed", process::line(&command)))?;
        let said = Value::parse(&said);
        let drawn = said.as_ref().and_then(|said| said.items().first());
        let record = drawn.and_then(|drawn| drawn.get("view"));
        record
            .and_then(View::of)
            .ok_or_else(|| format!("{} named no view", process::line(&command)))
    }

    /// A command of the program on a file, to be run in the folder of what is written.
    fn command(&self, name: &str, file: &Path) -> Outcome<Command> {
        let mut command = self.out.command(&self.program, name)?;
        command.arg(file);
        Ok(command)
    }
}

/// What stands above the tables: what made them, so that they can be made again.
fn head(device: Option<&str>) -> String {
    let commit = out::commit();
    let [width, height] = SIZE_PX;
    format!(
        "# Quality of the renderers\n\n\
         Made by `cargo xtask quality` at {commit} on {}; {width}×{height} pixels on white. SSIM and FLIP are over the whole \
         picture; `metrics.json` of each folder has all numbers.\n",
        device.unwrap_or("no graphics device")
    )
}

/// One comparison's part of the page.
fn section(comparison: &Comparison, rows: &[Row], skipped: &[&str]) -> String {
    let Comparison {
        name,
        title,
        reference,
        ..
    } = comparison;
    let mut text = format!(
        "\n## {title}\n\nReference: `{reference}`. Folders: `*-{name}`.\n\n{}",
        table::markdown(rows)
    );
    if !skipped.is_empty() {
        let skipped = skipped.join(", ");
        let why = "Skipped, since the shared test data folder has no such file: ";
        text.extend(["\n", why, &skipped, ".\n"]);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_says_what_was_skipped() {
        let text = section(&COMPARISONS[1], &[], &["dragon", "brain"]);
        assert!(
            text.ends_with("has no such file: dragon, brain.\n"),
            "{text}"
        );
        assert!(text.contains("`ewa-reference:surface=triangles:samples=4:filter=false`"));
        assert!(!section(&COMPARISONS[0], &[], &[]).contains("Skipped"));
    }

    #[test]
    fn each_folder_belongs_to_one_comparison() {
        let mut names: Vec<String> = COMPARISONS
            .iter()
            .flat_map(|comparison| {
                let models = comparison.models.iter();
                models.map(move |model| format!("{}-{}", model.name, comparison.name))
            })
            .collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
