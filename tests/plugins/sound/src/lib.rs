//! Well-behaved plugins that prove the border: [`dots::Dots`], a CPU renderer; [`lit_points::LitPoints`], the guide's GPU
//! renderer; and two structures: [`halves::Halves`] with blocks of its own, [`thirds::Thirds`] that selects on the device.
#![forbid(unsafe_code)]

mod dots;
mod halves;
mod lit_points;
mod thirds;

pointstage_plugin_api::export! { "plugin.json", renderers: [dots::Dots, lit_points::LitPoints], structures: [halves::Halves, thirds::Thirds] }
