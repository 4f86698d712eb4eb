//! The tree of bounding spheres behind the renderer `pop`; no plugin itself.
//!
//! 1. **build** ([`build()`]): leaves are a mesh's triangles, each in its least sphere; each level above groups up to four nodes
//!    of the one below by median splits, until one is left.
//! 2. **keep** ([`mod@file`]): a tree is written to a `.pop` file and read again, so that the next start need not build it.
//! 3. **cut** ([`cut`]): for a view, the nodes that are small enough to be splats and the triangles that are not.
//!
//! source  Chen, Nguyen, POP: A Hybrid Point and Polygon Rendering System for Large Data, IEEE Visualization 2001

#![forbid(unsafe_code)]

mod attributes;
mod ball;
mod build;
mod crew;
pub mod cut;
pub mod file;
mod fingerprint;
mod layout;
mod measure;
mod mesh;
mod node;
mod sizes;
mod split;
mod structure;
mod surface;
mod tree;

pub use build::{BuildError, build};
pub use fingerprint::fingerprint;
pub use mesh::{Mesh, VertexBlock};
pub use node::{
    Grid, NO_CONE, Node, NodeParts, decode_half_angle, decode_normal20, decode_radius,
    encode_half_angle, encode_normal20, encode_radius,
};
pub use sizes::node_count;
pub use surface::Surface;
pub use tree::Tree;
