//! Builds a tree: leaves, then level over level until one node is left, then all in their final order.
//!
//! 1. The mesh is measured (`measure.rs`): its vertices are checked, and its bounds give the grid of centres.
//! 2. Every triangle becomes a leaf: its least sphere and its attributes.
//! 3. The nodes of the level are halved at the median of the longest side of the box round their centres, again and again,
//!    until no part has more than four; each part gets a parent, and the parents are the next level. Repeated until there is
//!    one node.
//! 4. The nodes are laid out from the root, children side by side (`layout.rs`).
//!
//! A sphere is found in f64 from what is stored of the spheres (corners) in it, its centre moved to the grid, and its radius
//! taken from there and rounded up; so what is stored does hold what is stored below it. Besides, a parent's radius is greater
//! than its children's by a step of the code at least: with it, what a view draws always ends at the leaves.
//!
//! The result depends on the mesh alone, not on the number of threads.
//!
//! source  Chen, Nguyen, POP: A Hybrid Point and Polygon Rendering System for Large Data, IEEE Visualization 2001

use crate::attributes::{self, Attributes, Sums};
use crate::ball::{Ball, around_balls, centre_of_triangle};
use crate::crew::{Cancelled, Crew, Hand};
use crate::layout::{self, LAYOUT_UNITS};
use crate::measure::{self, MEASURE_UNITS};
use crate::mesh::Mesh;
use crate::node::{Grid, Node, NodeParts, encode_radius};
use crate::sizes::{GROUP, group_count, halvings, level_sizes};
use crate::split::{Record, halve};
use crate::tree::Tree;
use bytemuck::zeroed_vec;
use pointstage_plugin_api::glam::{DVec3, Vec3};

/// Nodes of a tree are fewer than this: a link has 30 bits for a node's number.
const NODES_END: usize = 1 << 30;

/// Triangles or nodes that a task takes; with more, the set is halved into two tasks.
const STRETCH: usize = 1 << 13;

/// Units of work of a leaf, of a node in one halving, and of an inner node; about nanoseconds on one core.
const LEAF_UNITS: u64 = 350;
const HALVING_UNITS: u64 = 9;
const PARENT_UNITS: u64 = 450;

/// Why a tree was not built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A report said not to go on.
    #[error("building was cancelled")]
    Cancelled,
    /// A triangle names a vertex that there is not.
    #[error(
        "triangle {triangle}: has the vertex {vertex}, but the mesh has {vertex_count} vertices, numbered from 0; repair the mesh"
    )]
    VertexOutOfRange {
        /// Number of the triangle.
        triangle: usize,
        /// Number of the vertex.
        vertex: u32,
        /// Vertices of the mesh.
        vertex_count: usize,
    },
    /// A vertex of a triangle lies nowhere, or too far away to be reckoned with.
    #[error(
        "triangle {triangle}: its vertex {vertex} lies at {position:?}, not at finite coordinates of at most 1e37; repair the mesh"
    )]
    VertexNotFinite {
        /// Number of the triangle.
        triangle: usize,
        /// Number of the vertex.
        vertex: u32,
        /// Where it is said to be; object space.
        position: [f32; 3],
    },
    /// The tree would have more nodes than links can tell apart.
    #[error(
        "the mesh has {triangles} triangles, whose tree would have {nodes} nodes, of at most 2^30 - 1; divide the mesh"
    )]
    TooManyTriangles {
        /// Triangles of the mesh.
        triangles: usize,
        /// Nodes of their tree.
        nodes: usize,
    },
}

impl From<Cancelled> for BuildError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// Builds the tree of a mesh on `thread_count` threads (0 is taken as 1), which the calling one waits for.
///
/// `report` gets the fraction done, 0 to 1 and never falling, and what is being done, about every 20 ms, on the calling
/// thread; it returns whether to go on. A mesh without triangles gives a tree without nodes.
pub fn build(
    mesh: &Mesh<'_>,
    thread_count: usize,
    report: &mut dyn FnMut(f32, &str) -> bool,
) -> Result<Tree, BuildError> {
    let sizes = level_sizes(mesh.triangles.len());
    let nodes = sizes.iter().sum();
    if nodes >= NODES_END {
        return Err(BuildError::TooManyTriangles {
            triangles: mesh.triangles.len(),
            nodes,
        });
    }
    let mut crew = Crew::new(thread_count, all_units(&sizes), report);
    crew.tell("measuring")?;
    let (least, greatest) = measure::bounds(mesh, &mut crew)?;
    let grid = Grid::over(least, greatest);
    let (mut level, mut sums) = leaves(mesh, &grid, &mut crew)?;
    let mut levels = Vec::with_capacity(sizes.len());
    while level.nodes.len() > 1 {
        let parents;
        (parents, sums) = group(&mut level, &sums, &grid, &mut crew)?;
        levels.push(std::mem::replace(&mut level, parents));
    }
    drop(sums);
    if !level.nodes.is_empty() {
        levels.push(level);
    }
    Ok(layout::lay_out(grid, levels, &mut crew)?)
}

/// A level in the making.
pub(crate) struct Level {
    /// Nodes in the order in which they were made: leaves by triangle, others by group. An inner node's children are a range
    /// of `records` of the level below.
    pub(crate) nodes: Vec<Node>,
    /// The level's nodes; those of a group side by side once it is grouped.
    pub(crate) records: Vec<Record>,
}

/// Units of work of a tree with levels of these sizes, from the leaves.
fn all_units(sizes: &[usize]) -> u64 {
    let per_level = |&size: &usize| size as u64 * (LAYOUT_UNITS + HALVING_UNITS * halvings(size));
    let leaf_count = sizes.first().map_or(0, |&count| count as u64);
    let inner_count = sizes.iter().skip(1).map(|&count| count as u64).sum::<u64>();
    sizes.iter().map(per_level).sum::<u64>()
        + leaf_count * (MEASURE_UNITS + LEAF_UNITS)
        + inner_count * PARENT_UNITS
}

/// The leaves' level, in the order of the triangles. The mesh was measured before.
fn leaves(
    mesh: &Mesh<'_>,
    grid: &Grid,
    crew: &mut Crew<'_>,
) -> Result<(Level, Vec<Sums>), Cancelled> {
    let count = mesh.triangles.len();
    let (mut nodes, mut sums, mut records) =
        (zeroed_vec(count), zeroed_vec(count), zeroed_vec(count));
    let outputs = nodes
        .chunks_mut(STRETCH)
        .zip(sums.chunks_mut(STRETCH))
        .zip(records.chunks_mut(STRETCH));
    let tasks = mesh
        .triangles
        .chunks(STRETCH)
        .zip(outputs)
        .enumerate()
        .collect();
    crew.run(
        "bounding triangles",
        count,
        tasks,
        |(stretch, (triangles, ((nodes, sums), records))), hand: &Hand<'_, _>| {
            let outputs = nodes.iter_mut().zip(sums).zip(records);
            for ((number, &corners), ((node, sums), record)) in
                (stretch * STRETCH..).zip(triangles).zip(outputs)
            {
                // Fewer than 2³⁰, so the number fits.
                (*node, *sums) = leaf(mesh, grid, number as u32, corners);
                *record = Record::new(node.place(), number as u32);
            }
            hand.advance(LEAF_UNITS * triangles.len() as u64);
        },
    )?;
    Ok((Level { nodes, records }, sums))
}

/// The leaf of a triangle.
fn leaf(mesh: &Mesh<'_>, grid: &Grid, triangle: u32, corners: [u32; 3]) -> (Node, Sums) {
    // Measuring has found all vertices.
    let positions = corners.map(|corner| mesh.position(corner).unwrap_or(Vec3::ZERO));
    let balls = positions.map(|corner| Ball {
        centre: corner.as_dvec3(),
        radius: 0.0,
    });
    let centre = centre_of_triangle(balls.map(|ball| ball.centre));
    let (attributes, sums) = attributes::of_triangle(mesh, corners, positions, grid.step);
    (node(grid, centre, &balls, 0, &attributes, triangle), sums)
}

/// A node round `centre`, or where the grid is nearest to it, that holds the balls.
fn node(
    grid: &Grid,
    centre: DVec3,
    balls: &[Ball],
    least_code: u16,
    attributes: &Attributes,
    link: u32,
) -> Node {
    let place = grid.quantise(centre.as_vec3());
    let reach = Ball::reach(grid.position(place).as_dvec3(), balls);
    Node::new(&NodeParts {
        place,
        radius_code: encode_radius(rounded_up(reach)).max(least_code),
        cone_code: attributes.cone_code,
        normal_code: attributes.normal_code,
        colour: attributes.colour,
        link,
    })
}

/// The next float that is not less.
fn rounded_up(value: f64) -> f32 {
    let nearest = value as f32;
    if f64::from(nearest) < value {
        nearest.next_up()
    } else {
        nearest
    }
}

/// Groups a level's nodes, and makes the level of the groups.
fn group(
    level: &mut Level,
    sums: &[Sums],
    grid: &Grid,
    crew: &mut Crew<'_>,
) -> Result<(Level, Vec<Sums>), Cancelled> {
    let size = level.nodes.len();
    let count = group_count(size);
    let (mut nodes, mut parent_sums, mut records) =
        (zeroed_vec(count), zeroed_vec(count), zeroed_vec(count));
    let whole = Part {
        records: &mut level.records,
        first: 0,
        parents: Parents {
            first: 0,
            nodes: &mut nodes,
            sums: &mut parent_sums,
            records: &mut records,
        },
    };
    let children = Children {
        grid,
        nodes: &level.nodes,
        sums,
    };
    crew.run("grouping", size, vec![whole], |part: Part<'_>, hand| {
        let size = part.records.len();
        if size <= STRETCH {
            let parent_count = part.parents.nodes.len() as u64;
            children.divide(part);
            hand.advance(
                HALVING_UNITS * size as u64 * halvings(size) + PARENT_UNITS * parent_count,
            );
        } else {
            let (lower, upper) = part.halved(&|| hand.is_cancelled());
            hand.push(upper);
            hand.push(lower);
            hand.advance(HALVING_UNITS * size as u64);
        }
    })?;
    Ok((Level { nodes, records }, parent_sums))
}

/// Nodes to group, and where their parents go.
struct Part<'t> {
    /// Of the nodes.
    records: &'t mut [Record],
    /// Place of the first of them among the level's records.
    first: u32,
    parents: Parents<'t>,
}

/// Room for as many parents as a part has groups.
struct Parents<'t> {
    /// Number of the first of them.
    first: u32,
    nodes: &'t mut [Node],
    sums: &'t mut [Sums],
    records: &'t mut [Record],
}

impl Part<'_> {
    /// Both halves; for more nodes than a group holds.
    fn halved(self, cancelled: &dyn Fn() -> bool) -> (Self, Self) {
        let middle = halve(self.records, cancelled);
        let (lower, upper) = self.records.split_at_mut(middle);
        let lower_count = group_count(middle);
        let (lower_nodes, upper_nodes) = self.parents.nodes.split_at_mut(lower_count);
        let (lower_sums, upper_sums) = self.parents.sums.split_at_mut(lower_count);
        let (lower_records, upper_records) = self.parents.records.split_at_mut(lower_count);
        let parents = self.parents.first;
        let lower_parents = Parents {
            first: parents,
            nodes: lower_nodes,
            sums: lower_sums,
            records: lower_records,
        };
        let upper_parents = Parents {
            first: parents + lower_count as u32,
            nodes: upper_nodes,
            sums: upper_sums,
            records: upper_records,
        };
        (
            Self {
                records: lower,
                first: self.first,
                parents: lower_parents,
            },
            Self {
                records: upper,
                first: self.first + middle as u32,
                parents: upper_parents,
            },
        )
    }
}

/// A level whose nodes are being grouped.
#[derive(Clone, Copy)]
struct Children<'t> {
    grid: &'t Grid,
    nodes: &'t [Node],
    sums: &'t [Sums],
}

impl Children<'_> {
    /// Divides a part into groups and makes their parents.
    fn divide(self, part: Part<'_>) {
        if part.records.len() > GROUP {
            let (lower, upper) = part.halved(&|| false);
            self.divide(lower);
            self.divide(upper);
            return;
        }
        // The order in a group says nothing, but is to be the same however the halves were found.
        part.records.sort_unstable_by_key(|record| record.node);
        let Parents {
            first,
            nodes: [node],
            sums: [sums],
            records: [record],
        } = part.parents
        else {
            unreachable!("a part of up to four nodes has room for one parent");
        };
        (*node, *sums) = self.parent(part.records, part.first);
        *record = Record::new(node.place(), first);
    }

    /// The parent of the nodes of the records, of which the first is at `first` among the level's.
    fn parent(self, records: &[Record], first: u32) -> (Node, Sums) {
        let (mut nodes, mut sums) = ([Node::default(); GROUP], [Sums::default(); GROUP]);
        let mut balls = [Ball::default(); GROUP];
        let count = records.len();
        let mut least_code = 0;
        for (place, record) in records.iter().enumerate() {
            let child = self.nodes[record.node as usize];
            nodes[place] = child;
            sums[place] = self.sums[record.node as usize];
            balls[place] = Ball {
                centre: self.grid.position(child.place()).as_dvec3(),
                radius: f64::from(child.radius()),
            };
            least_code = least_code.max(child.radius_code() + 1);
        }
        let balls = &balls[..count];
        let (attributes, sums) = attributes::of_children(&nodes[..count], &sums[..count]);
        let link = Node::link_to(first, count as u32);
        (
            node(
                self.grid,
                around_balls(balls).centre,
                balls,
                least_code,
                &attributes,
                link,
            ),
            sums,
        )
    }
}
