//! Targets beside the picture: which there are, and what their colours mean.

use std::collections::BTreeMap;

use pointstage_engine::frame::TargetSpec;
use pointstage_engine::stage::Stage;
use pointstage_plugin_api::targets::COLOUR;

use super::arguments::ComparisonArguments;
use crate::cli::measuring::entries::Entry;
use crate::cli::{Failure, Outcome, drawing};

/// Targets that are drawn, and who gives them.
pub(super) struct Targets {
    /// In the host's order; those of the renderers follow.
    pub(super) specs: Vec<TargetSpec>,
    /// The keys that a renderer gives, by its id.
    given: BTreeMap<String, Vec<String>>,
}

impl Targets {
    /// The keys that are drawn of a renderer.
    pub(super) fn of<'a>(&'a self, entry: &Entry) -> impl Iterator<Item = &'a str> {
        let given = self.given.get(&entry.id);
        let keys = self.specs.iter().map(|spec| spec.key.as_ref());
        keys.filter(move |key| {
            given.is_some_and(|given| given.iter().any(|candidate| candidate == key))
        })
    }
}

/// Those that the command line names; each must be given by somebody.
pub(super) fn find(
    stage: &Stage,
    arguments: &ComparisonArguments,
    reference: Option<&Entry>,
    renderers: &[Entry],
) -> Outcome<Targets> {
    let asked = &arguments.targets;
    let is_all = asked.iter().any(|key| key == "all");
    let (mut specs, mut given) = (Vec::<TargetSpec>::new(), BTreeMap::new());
    for entry in reference.into_iter().chain(renderers) {
        let targets = stage
            .given_targets(&entry.id)
            .map_err(Failure::usage_from)?;
        let keys = targets.iter().map(|spec| spec.key.clone().into_owned());
        given.insert(entry.id.clone(), keys.collect());
        for spec in targets {
            // The picture shows the colours already.
            if spec.key != COLOUR && specs.iter().all(|known| known.key != spec.key) {
                specs.push(spec);
            }
        }
    }
    for key in asked.iter().filter(|key| *key != "all") {
        if specs.iter().all(|spec| spec.key != *key) {
            let known: Vec<&str> = specs.iter().map(|spec| spec.key.as_ref()).collect();
            return Err(drawing::no_target_of_any(key, &known));
        }
    }
    specs.retain(|spec| is_all || asked.iter().any(|key| spec.key == *key));
    Ok(Targets { specs, given })
}
