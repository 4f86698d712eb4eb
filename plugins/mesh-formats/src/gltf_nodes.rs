//! The nodes of a glTF scene: which primitives they show, and where.

use std::collections::HashSet;

use gltf::{Document, Node, Primitive};
use pointstage_plugin_api::glam::{DMat4, Mat3, Vec3};

/// A primitive of the scene, and where it stands.
pub(crate) struct Part<'d> {
    pub(crate) primitive: Primitive<'d>,
    pub(crate) world_from_node: DMat4,
}

/// The primitives of the default scene, node by node.
pub(crate) struct Parts<'d> {
    open: Vec<(Node<'d>, DMat4)>,
    /// A node has one parent; a file that says otherwise is not walked in circles.
    seen: HashSet<usize>,
    node_count: usize,
    /// What is left of the node walked to last.
    primitives: Option<(gltf::mesh::iter::Primitives<'d>, DMat4)>,
}

impl<'d> Parts<'d> {
    pub(crate) fn of(document: &'d Document) -> Self {
        let scene = document
            .default_scene()
            .or_else(|| document.scenes().next());
        let roots: Vec<Node<'_>> = match scene {
            Some(scene) => scene.nodes().collect(),
            None => document.nodes().collect(),
        };
        let open = roots.into_iter().map(|node| (node, DMat4::IDENTITY));
        Self {
            open: open.collect(),
            seen: HashSet::new(),
            node_count: document.nodes().count().max(1),
            primitives: None,
        }
    }

    /// Part of the nodes that were walked to.
    pub(crate) fn fraction(&self) -> f32 {
        self.seen.len() as f32 / self.node_count as f32
    }
}

impl<'d> Iterator for Parts<'d> {
    type Item = Part<'d>;

    fn next(&mut self) -> Option<Part<'d>> {
        loop {
            if let Some((primitives, world_from_node)) = &mut self.primitives
                && let Some(primitive) = primitives.next()
            {
                return Some(Part {
                    primitive,
                    world_from_node: *world_from_node,
                });
            }
            let (node, world_from_parent) = self.open.pop()?;
            if !self.seen.insert(node.index()) {
                continue;
            }
            let columns = node.transform().matrix();
            let local = DMat4::from_cols_array_2d(&columns.map(|column| column.map(f64::from)));
            let world_from_node = world_from_parent * local;
            let mesh = node.mesh();
            self.primitives = mesh.map(|mesh| (mesh.primitives(), world_from_node));
            let children = node.children();
            self.open
                .extend(children.map(|child| (child, world_from_node)));
        }
    }
}

/// Normals in the world; zeros, which the host replaces, for those that have no direction.
pub(crate) fn world_normals(
    in_node: impl Iterator<Item = [f32; 3]>,
    world_from_node: DMat4,
) -> impl Iterator<Item = [f32; 3]> {
    let linear = Mat3::from_mat4(world_from_node.as_mat4());
    // A matrix that flattens has no inverse: those normals are for the host to find.
    let to_world = linear.inverse().transpose();
    in_node.map(move |normal| {
        let normal = to_world * Vec3::from_array(normal);
        normal.try_normalize().unwrap_or(Vec3::ZERO).to_array()
    })
}
