//! Well-behaved plugins that prove the border: [`dots::Dots`], a CPU renderer; [`lit_points::LitPoints`], the guide's GPU
//! renderer; and [`halves::Halves`], a structure with blocks of its own.
#![forbid(unsafe_code)]

mod dots;
mod halves;
mod lit_points;

pointstage_plugin_api::export! { "plugin.json", renderers: [dots::Dots, lit_points::LitPoints], structures: [halves::Halves] }
