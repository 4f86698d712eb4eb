//! Which targets a frame has, and what is made of them.

use crate::frame::targets::{self, TargetSpec, host_target_spec};
use crate::frame::{Composition, Show};
use crate::plugins::PluginInfo;
use crate::stage::options::FrameError;
use crate::stage::request::FrameRequest;
use crate::stage::session::{FALLBACK_ID, Stage};
use pointstage_plugin_api::abi::FrameUniform;
use std::sync::Arc;

impl Stage {
    /// The targets that are asked for and that the renderer gives, in the host's order.
    pub(super) fn target_specs(
        &self,
        request: &FrameRequest,
        info: Option<&Arc<PluginInfo>>,
    ) -> Result<Vec<TargetSpec>, FrameError> {
        let given = given_targets(info);
        let id = info.map_or(FALLBACK_ID, |info| &info.id);
        let mut wanted = vec![targets::COLOUR, targets::DEPTH];
        if let Show::Target(key) = &request.show {
            if !given.iter().any(|spec| spec.key == *key) && self.is_asked_for(request, info) {
                let given = given
                    .iter()
                    .map(|spec| spec.key.as_ref())
                    .collect::<Vec<_>>()
                    .join(", ");
                return Err(FrameError::NoTarget {
                    renderer: id.into(),
                    key: key.clone(),
                    given,
                });
            }
            wanted.push(key);
        }
        wanted.extend(request.read_back.iter().map(String::as_str));
        Ok(given
            .into_iter()
            .filter(|spec| wanted.contains(&spec.key.as_ref()))
            .collect())
    }

    /// Whether this is the renderer of the request, not a stand-in.
    fn is_asked_for(&self, request: &FrameRequest, info: Option<&Arc<PluginInfo>>) -> bool {
        match info {
            Some(info) => self
                .registry
                .find_renderer(&request.renderer)
                .is_ok_and(|asked| asked.id == info.id),
            None => request.renderer == FALLBACK_ID,
        }
    }
}

/// Keys to read back, of the targets that there are.
pub(super) fn read_back_keys<'a>(
    request: &'a FrameRequest,
    specs: &'a [TargetSpec],
) -> impl Iterator<Item = &'a str> {
    let asked = |key: &&str| request.read_back.iter().any(|asked| asked == key);
    specs.iter().map(|spec| spec.key.as_ref()).filter(asked)
}

/// How the targets become the picture.
pub(super) fn composition(
    request: &FrameRequest,
    specs: &[TargetSpec],
    uniform: &FrameUniform,
) -> Composition {
    let shown = match &request.show {
        Show::Target(key) => specs.iter().find(|spec| spec.key == *key),
        Show::Colours => None,
    };
    let colours = host_target_spec(targets::COLOUR).expect("the host's own target");
    Composition {
        ramp_range: request.shown_range,
        ..Composition::of_frame(
            shown.unwrap_or(colours),
            request.background,
            request.exposure,
            uniform,
        )
    }
}

/// Targets that a renderer gives, in the host's order, then its own.
pub(in crate::stage) fn given_targets(info: Option<&Arc<PluginInfo>>) -> Vec<TargetSpec> {
    let Some(info) = info else {
        return crate::frame::fallback::TARGETS
            .iter()
            .filter_map(|key| host_target_spec(key).cloned())
            .collect();
    };
    let given = &info.entry.gives.targets;
    let host = targets::HOST_TARGETS
        .iter()
        .filter(|spec| given.iter().any(|target| target.key == spec.key))
        .cloned();
    let own = given
        .iter()
        .filter(|target| host_target_spec(&target.key).is_none());
    // What discovery let pass is usable; anything else is left out.
    host.chain(own.filter_map(|target| TargetSpec::from_manifest(target).ok()))
        .collect()
}
