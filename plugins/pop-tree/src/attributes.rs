//! Normal, cone of normals and colour: of a triangle, and of a node from its children.
//!
//! * A triangle's own normal is the geometric one, to the side of its vertices' normals where those are known: a mesh may be
//!   wound inward. A triangle without area takes the mean of its vertices' normals, or has none.
//! * A leaf's normal is the mean of its vertices' normals where known, as that is what a splat is lit with; else the triangle's.
//! * An inner node's normal is the mean of its triangles' own normals, weighted by area.
//! * The cone, round the normal as stored, holds the own normal and the leaf's normal of every triangle below.
//! * Colours are means of linear light, weighted by area: a splat sends what the triangles below it send together.

use crate::mesh::Mesh;
use crate::node::{
    NO_CONE, Node, decode_half_angle, decode_normal20, encode_half_angle, encode_normal20,
};
use bytemuck::{Pod, Zeroable};
use pointstage_plugin_api::columns::{linear_from_srgb, srgb_from_linear};
use pointstage_plugin_api::glam::Vec3;
use std::sync::LazyLock;

/// Weight of a triangle without area, in squares of the grid; what has area outweighs it.
const LEAST_WEIGHT: f32 = 1e-6;

/// Sine of the angle between two sides below which their cross product is rounding alone.
const LEAST_SINE: f64 = 1e-12;

/// Rounding of an angle computed in f32, and more: what is added before a half-angle is rounded up; radians.
const ANGLE_ROUNDING: f32 = 1e-5;

/// Linear light of sRGB bytes.
static LIGHT: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| linear_from_srgb(byte as f32 / 255.0)));

/// Colour of a mesh that has none, sRGB.
const GREY: Vec3 = Vec3::splat(0.5);

/// Sums over the triangles below a node, to take means from.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Sums {
    /// Of the triangles' own normals times their weights.
    normal: [f32; 3],
    /// Of the weights: areas, in squares of the grid.
    weight: f32,
    /// Of linear light times weights.
    light: [f32; 3],
    /// 1 if any triangle has a normal; else the node's normal is arbitrary, and no cone need hold it.
    directed: u32,
}

/// What a node stores beside its sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attributes {
    pub(crate) normal_code: u32,
    pub(crate) cone_code: u8,
    pub(crate) colour: [f32; 3],
}

/// Those of a leaf. `step`: scene units a step of the grid.
pub(crate) fn of_triangle(
    mesh: &Mesh<'_>,
    corners: [u32; 3],
    positions: [Vec3; 3],
    step: f32,
) -> (Attributes, Sums) {
    let vertex_normal = corners
        .iter()
        .filter_map(|&corner| mesh.normal(corner))
        .sum::<Vec3>()
        .try_normalize();
    let (face_normal, area) = face(positions, f64::from(step));
    let own = match (face_normal, vertex_normal) {
        (Some(face), Some(vertex)) if face.dot(vertex) < 0.0 => Some(-face),
        (face, vertex) => face.or(vertex),
    };
    let normal_code = encode_normal20(vertex_normal.or(own).unwrap_or(Vec3::Z));
    let half_angle = own.map_or(0.0, |own| angle(own, decode_normal20(normal_code)));
    let weight = area.max(LEAST_WEIGHT);
    let light = light_of(mesh, corners);
    let attributes = Attributes {
        normal_code,
        cone_code: encode_half_angle(half_angle + ANGLE_ROUNDING),
        colour: as_srgb(light),
    };
    let sums = Sums {
        normal: (own.unwrap_or(Vec3::ZERO) * weight).to_array(),
        weight,
        light: (light * weight).to_array(),
        directed: u32::from(own.is_some()),
    };
    (attributes, sums)
}

/// Those of an inner node.
pub(crate) fn of_children(children: &[Node], sums: &[Sums]) -> (Attributes, Sums) {
    let (mut normal, mut light) = (Vec3::ZERO, Vec3::ZERO);
    let (mut weight, mut directed) = (0.0, 0);
    for sums in sums {
        normal += Vec3::from_array(sums.normal);
        light += Vec3::from_array(sums.light);
        weight += sums.weight;
        directed |= sums.directed;
    }
    let with_normal = || {
        children
            .iter()
            .zip(sums)
            .filter(|(_, sums)| sums.directed != 0)
            .map(|(child, _)| child)
    };
    // Opposite normals may leave nothing: then one of them is as good as another.
    let mean = normal
        .try_normalize()
        .or_else(|| with_normal().next().map(|child| child.normal()));
    let normal_code = encode_normal20(mean.unwrap_or(Vec3::Z));
    let axis = decode_normal20(normal_code);
    let cone_code =
        with_normal().fold(0, |widest: u8, child| widest.max(cone_around(axis, *child)));
    let attributes = Attributes {
        normal_code,
        cone_code,
        colour: as_srgb(light / weight),
    };
    let sums = Sums {
        normal: normal.to_array(),
        weight,
        light: light.to_array(),
        directed,
    };
    (attributes, sums)
}

/// Code of the least cone round `axis` that holds a child's cone.
fn cone_around(axis: Vec3, child: Node) -> u8 {
    if child.cone_code() == NO_CONE {
        return NO_CONE;
    }
    encode_half_angle(
        angle(axis, child.normal()) + decode_half_angle(child.cone_code()) + ANGLE_ROUNDING,
    )
}

/// Angle between unit vectors; radians. From the chord, as a cosine says little of small angles.
fn angle(a: Vec3, b: Vec3) -> f32 {
    2.0 * (a.distance(b) * 0.5).min(1.0).asin()
}

/// Unit normal and area of a triangle, in squares of the grid; no normal if it has no area.
fn face(positions: [Vec3; 3], step: f64) -> (Option<Vec3>, f32) {
    let [a, b, c] = positions.map(Vec3::as_dvec3);
    let steps = step.recip();
    let (u, v) = ((b - a) * steps, (c - a) * steps);
    let cross = u.cross(v);
    let length = cross.length();
    // Written so that NaN counts as no area.
    if length > LEAST_SINE * (u.length_squared() * v.length_squared()).sqrt() {
        (Some((cross / length).as_vec3()), (0.5 * length) as f32)
    } else {
        (None, 0.0)
    }
}

/// Mean of the vertices' light, linear.
fn light_of(mesh: &Mesh<'_>, corners: [u32; 3]) -> Vec3 {
    let (mut sum, mut count) = (Vec3::ZERO, 0.0);
    for packed in corners
        .iter()
        .filter_map(|&corner| mesh.packed_colour(corner))
    {
        let [red, green, blue, _] = packed.to_le_bytes().map(usize::from);
        sum += Vec3::new(LIGHT[red], LIGHT[green], LIGHT[blue]);
        count += 1.0;
    }
    if count > 0.0 {
        sum / count
    } else {
        GREY.map(linear_from_srgb)
    }
}

/// The colour of linear light, sRGB, 0 to 1.
fn as_srgb(light: Vec3) -> [f32; 3] {
    light.map(srgb_from_linear).to_array()
}
