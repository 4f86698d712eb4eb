//! `pointstage plugins`: which plugins there are, and what came of each file.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use pointstage_engine::plugins::{PluginFile, Registry};
use pointstage_scene::Loaders;
use serde_json::{Value, json};

use super::{Failure, Globals, Outcome, write_out};

/// Commands about plugins.
#[derive(Debug, Subcommand)]
#[command(after_help = "\
Examples:
  pointstage plugins list
  pointstage plugins list --json
  pointstage plugins probe --plugin ./libmy_renderer.so

Plugins stand beside the program or in 'plugins' there, in the user's plugin folder, or in the folders of
POINTSTAGE_PLUGIN_PATH.")]
pub(crate) enum PluginsCommand {
    /// List renderers, structures and loaders, and what came of each file
    List(ListArguments),
    /// Examine files anew, whatever was found before
    Probe(ProbeArguments),
}

/// Arguments of `plugins list`.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  pointstage plugins list --json")]
pub(crate) struct ListArguments {
    /// Write JSON
    #[arg(long)]
    json: bool,
}

/// Arguments of `plugins probe`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pointstage plugins probe                       every plugin that is found
  pointstage plugins probe ./libmy_renderer.so   one file

Ends with 1 if a file cannot be used.")]
pub(crate) struct ProbeArguments {
    /// Only these files [default: all that are found]
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Write JSON
    #[arg(long)]
    json: bool,
}

/// Runs a command about plugins.
pub(crate) fn run(globals: &Globals, command: &PluginsCommand) -> Outcome {
    match command {
        PluginsCommand::List(arguments) => {
            let registry = Registry::discover(&globals.discover_options());
            show(registry.files().iter().collect(), arguments.json)?;
            if arguments.json {
                return Ok(());
            }
            write_out(&built_in().join("\n"))
        }
        PluginsCommand::Probe(arguments) => probe(globals, arguments),
    }
}

fn probe(globals: &Globals, arguments: &ProbeArguments) -> Outcome {
    let mut options = globals.discover_options();
    options.files.extend(arguments.files.iter().cloned());
    let known = Registry::discover(&options);
    for file in known.files() {
        known.retry(&file.path);
    }
    // The verdicts are written when the registry goes; the next one reads them.
    drop(known);
    let registry = Registry::discover(&options);
    let wanted: Vec<PathBuf> = arguments
        .files
        .iter()
        .map(|path| std::fs::canonicalize(path).unwrap_or_else(|_| path.clone()))
        .collect();
    let files: Vec<&PluginFile> = registry
        .files()
        .iter()
        .filter(|file| wanted.is_empty() || wanted.contains(&file.path))
        .collect();
    let count = files.len();
    let usable = files.iter().filter(|file| file.verdict.is_usable()).count();
    show(files, arguments.json)?;
    if usable < count {
        return Err(Failure::Failed(anyhow::anyhow!(
            "{usable} of {count} plugin files can be used"
        )));
    }
    Ok(())
}

fn show(files: Vec<&PluginFile>, as_json: bool) -> Outcome {
    if as_json {
        let facts: Vec<Value> = files.into_iter().map(facts).collect();
        return write_out(&serde_json::to_string_pretty(&facts)?);
    }
    if files.is_empty() {
        return write_out(
            "No plugins found. They stand beside the program or in 'plugins' there, in the user's plugin folder, or in the folders of POINTSTAGE_PLUGIN_PATH.",
        );
    }
    let lines: Vec<String> = files.into_iter().flat_map(lines).collect();
    write_out(&lines.join("\n"))
}

/// The loaders that come with the program.
fn built_in() -> Vec<String> {
    let loaders = Loaders::built_in().all();
    let lines = loaders.iter().map(|loader| {
        let info = loader.info();
        let extensions = extensions(&info.extensions);
        format!(
            "  loader {} ({}): {}{extensions}",
            info.alias, info.id, info.title
        )
    });
    std::iter::once("Built in:".to_owned())
        .chain(lines)
        .collect()
}

fn lines(file: &PluginFile) -> Vec<String> {
    let mut lines = vec![format!(
        "{}: {}",
        file.path.display(),
        file.verdict.in_words()
    )];
    let plugins = file.manifest.iter().flat_map(|manifest| &manifest.plugins);
    lines.extend(plugins.map(|plugin| {
        format!(
            "  {} {} ({} {}): {}{}",
            plugin.kind,
            plugin.alias,
            plugin.id,
            plugin.version,
            plugin.title,
            extensions(&plugin.extensions)
        )
    }));
    if !file.verdict.message.is_empty() {
        lines.push(format!("  {}", file.verdict.message));
    }
    lines
}

/// The extensions of a loader's files, for a line; nothing for others.
fn extensions(extensions: &[String]) -> String {
    if extensions.is_empty() {
        return String::new();
    }
    format!(" [.{}]", extensions.join(" ."))
}

/// One object a file; its plugins are entries of the manifest with the file's verdict, so that a script need not look up.
fn facts(file: &PluginFile) -> Value {
    let manifest = file.manifest.as_ref();
    let verdict = file.verdict.in_words();
    let plugins: Vec<Value> = manifest
        .into_iter()
        .flat_map(|manifest| &manifest.plugins)
        .map(|plugin| {
            let mut entry = json!(plugin);
            entry["verdict"] = json!(verdict);
            entry
        })
        .collect();
    json!({
        "file": file.path,
        "verdict": verdict,
        "usable": file.verdict.is_usable(),
        "message": file.verdict.message,
        "detail": file.verdict.detail,
        "hash": file.hash,
        "size": file.size,
        "api": file.api,
        "from_cache": file.from_cache,
        "examination_ms": file.examination_time.as_secs_f64() * 1e3,
        "vendor": manifest.map(|manifest| &manifest.vendor),
        "licence": manifest.map(|manifest| &manifest.licence),
        "citation": manifest.map(|manifest| &manifest.citation),
        "plugins": plugins,
    })
}
