#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod columns;
mod data_url;
mod gltf_buffers;
mod gltf_nodes;
mod gltf_pictures;
mod gltf_plain;
mod gltf_scene;
mod mtl;
mod obj;
mod obj_lines;
mod off;
mod stl;
mod textured;
mod weld;

pub use gltf_scene::GltfLoader;
pub use obj::ObjLoader;
pub use off::OffLoader;
pub use stl::StlLoader;

pointstage_plugin_api::export! {
    "plugin.json",
    loaders: [ObjLoader, StlLoader, OffLoader, GltfLoader]
}
