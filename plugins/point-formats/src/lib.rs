#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod columns;
mod e57_point;
mod e57_scan;
mod las_columns;
mod las_extra;
mod las_pieces;
mod las_records;
mod las_rows;
mod las_scan;
mod laz;
mod lzf;
mod pcd;
mod pcd_header;
mod xyz;
mod xyz_columns;

pub use e57_scan::E57Loader;
pub use las_scan::LasLoader;
pub use pcd::PcdLoader;
pub use xyz::XyzLoader;

pointstage_plugin_api::export! {
    "plugin.json",
    loaders: [LasLoader, E57Loader, PcdLoader, XyzLoader]
}
