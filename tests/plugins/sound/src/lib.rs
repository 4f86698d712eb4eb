//! Well-behaved plugins that prove the border: [`dots::Dots`], a CPU renderer, and [`halves::Halves`], a structure with
//! blocks of its own.
#![forbid(unsafe_code)]

mod dots;
mod halves;

pointstage_plugin_api::export! { "plugin.json", renderers: [dots::Dots], structures: [halves::Halves] }
