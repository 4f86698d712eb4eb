//! Meshes that tests build trees over.
#![allow(dead_code, reason = "each test program uses some of them")]

use pointstage_plugin_api::columns;
use pointstage_plugin_api::glam::Vec3;
use pointstage_pop_tree::{Mesh, Tree, VertexBlock, build};
use proptest::prelude::*;

/// A mesh with its columns.
#[derive(Clone, Debug, Default)]
pub(crate) struct Columns {
    pub(crate) positions: Vec<[f32; 4]>,
    pub(crate) normals: Option<Vec<u32>>,
    pub(crate) colours: Option<Vec<u32>>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Vertices of a block; 0: all.
    pub(crate) block_size: usize,
}

impl Columns {
    /// Positions and triangles alone.
    pub(crate) fn bare(positions: &[Vec3], triangles: Vec<[u32; 3]>) -> Self {
        let positions = positions
            .iter()
            .map(|position| position.extend(7.0).to_array())
            .collect();
        Self {
            positions,
            triangles,
            ..Self::default()
        }
    }

    /// Calls `act` with the mesh.
    pub(crate) fn with<R>(&self, act: impl FnOnce(&Mesh<'_>) -> R) -> R {
        let size = if self.block_size == 0 {
            self.positions.len().max(1)
        } else {
            self.block_size
        };
        let slice = |column: &'_ Option<Vec<u32>>, place: usize| {
            column
                .as_deref()
                .map(|column| column.chunks(size).nth(place).unwrap_or_default().to_vec())
        };
        let columns: Vec<_> = (0..self.positions.chunks(size).len())
            .map(|place| (slice(&self.normals, place), slice(&self.colours, place)))
            .collect();
        let blocks: Vec<VertexBlock<'_>> = self
            .positions
            .chunks(size)
            .zip(&columns)
            .map(|(position_radius, (normals, colours))| VertexBlock {
                position_radius,
                normals: normals.as_deref(),
                colours: colours.as_deref(),
            })
            .collect();
        act(&Mesh {
            block_size: size as u32,
            blocks: &blocks,
            triangles: &self.triangles,
        })
    }

    /// The tree, built on so many threads.
    pub(crate) fn tree_on(&self, thread_count: usize) -> Tree {
        self.with(|mesh| build(mesh, thread_count, &mut |_, _| true))
            .expect("a sound mesh")
    }

    /// The tree, built on two threads.
    pub(crate) fn tree(&self) -> Tree {
        self.tree_on(2)
    }

    pub(crate) fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|vertex| {
            let [x, y, z, _] = self.positions[vertex as usize];
            Vec3::new(x, y, z)
        })
    }
}

/// A sheet of squares in the plane z = 0, two triangles each, with normals and colours.
pub(crate) fn sheet(columns: u32, rows: u32) -> Columns {
    let mut mesh = Columns {
        normals: Some(vec![]),
        colours: Some(vec![]),
        ..Columns::default()
    };
    for row in 0..=rows {
        for column in 0..=columns {
            mesh.positions.push([column as f32, row as f32, 0.0, 0.5]);
        }
    }
    let count = mesh.positions.len() as u32;
    mesh.normals = Some(vec![columns::encode_normal(Vec3::Z); count as usize]);
    mesh.colours = Some(
        (0..count)
            .map(|vertex| vertex.wrapping_mul(2_654_435_761))
            .collect(),
    );
    let corner = |column: u32, row: u32| row * (columns + 1) + column;
    for row in 0..rows {
        for column in 0..columns {
            let [a, b] = [corner(column, row), corner(column + 1, row)];
            let [c, d] = [corner(column, row + 1), corner(column + 1, row + 1)];
            mesh.triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    mesh
}

/// A unit sphere of `2 · around · (around / 2)` triangles, wound inward though its normals point outward; thin triangles
/// at the poles, with no area at all in the first and last row.
pub(crate) fn inward_sphere(around: u32) -> Columns {
    let rows = around / 2;
    let mut mesh = sheet(around, rows);
    let turn = std::f32::consts::TAU / around as f32;
    let mut normals = Vec::new();
    for position in &mut mesh.positions {
        let [longitude, latitude] = [position[0] * turn, position[1] * turn];
        let (sin, cos) = if position[1] as u32 == rows {
            (0.0, -1.0)
        } else {
            latitude.sin_cos()
        };
        let outward = Vec3::new(sin * longitude.cos(), sin * longitude.sin(), cos);
        *position = outward.extend(1.0).to_array();
        normals.push(columns::encode_normal(outward));
    }
    mesh.normals = Some(normals);
    for corners in &mut mesh.triangles {
        let [a, b, c] = *corners;
        let [u, v, w] = [a, b, c].map(|vertex| {
            let [x, y, z, _] = mesh.positions[vertex as usize];
            Vec3::new(x, y, z)
        });
        if (v - u).cross(w - u).dot(u) > 0.0 {
            *corners = [a, c, b];
        }
    }
    mesh
}

/// So many disjoint slivers, a thousand times as long as wide, scattered in a cube.
pub(crate) fn slivers(count: u32) -> Columns {
    let mut state = 1_u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    let mut vector = move || Vec3::new(random(), random(), random());
    let mut positions = Vec::new();
    for _ in 0..count {
        let (at, along, across) = (vector(), vector() - 0.5, vector() - 0.5);
        positions.extend([at, at + along * 0.01, at + across * 1e-5]);
    }
    Columns::bare(
        &positions,
        (0..count)
            .map(|triangle| [0, 1, 2].map(|corner| 3 * triangle + corner))
            .collect(),
    )
}

/// Any small mesh: random or few positions, so that vertices coincide and triangles have no area; edges shared by many.
pub(crate) fn any_mesh() -> impl Strategy<Value = Columns> {
    let coordinate = prop_oneof![2 => (-2_i8..=2).prop_map(f32::from), 2 => -1.0_f32..1.0, 1 => 1e3_f32..1.001e3];
    let position = prop::array::uniform3(coordinate).prop_map(Vec3::from_array);
    let normal = prop_oneof![1 => Just(columns::NO_NORMAL), 5 => any::<u32>()];
    let vertex = (position, normal, any::<u32>());
    let mesh = (
        prop::collection::vec(vertex, 1..60),
        any::<bool>(),
        any::<bool>(),
        0_usize..20,
    );
    mesh.prop_flat_map(|(vertices, normals, colours, block_size)| {
        let count = vertices.len() as u32;
        let triangles = prop::collection::vec(prop::array::uniform3(0..count), 0..150);
        triangles.prop_map(move |triangles| Columns {
            positions: vertices
                .iter()
                .map(|(position, ..)| position.extend(0.0).to_array())
                .collect(),
            normals: normals.then(|| vertices.iter().map(|(_, normal, _)| *normal).collect()),
            colours: colours.then(|| vertices.iter().map(|(.., colour)| *colour).collect()),
            triangles,
            block_size,
        })
    })
}

/// The colour of a vertex, as the mesh has it.
pub(crate) fn colour(bits: u32) -> Vec3 {
    columns::decode_colour(bits).truncate()
}
