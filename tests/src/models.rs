//! Scenes made in memory, from random numbers with a fixed seed.

use glam::{DVec3, Vec3, Vec4};
use pointstage_plugin_api::abi::FrameUniform;
use pointstage_plugin_api::columns::{TangentAxes, encode_colour, encode_normal};
use pointstage_plugin_api::twin::camera::Camera as TwinCamera;
use pointstage_scene::{Block, Camera, Geometry, Object, Origins, Projection};

/// Random numbers from a fixed seed (splitmix64).
#[derive(Debug)]
pub struct Random(pub u64);

impl Random {
    /// Uniform in -1..1.
    pub fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Uniform in the cube -1..1.
    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }
}

/// A surfel of a scene made here; scene units.
#[derive(Clone, Copy, Debug)]
pub struct Surfel {
    /// Centre.
    pub centre: Vec3,
    /// Radius of the disk.
    pub radius: f32,
    /// Unit, outward.
    pub normal: Vec3,
    /// Tangent half-axes of an ellipse.
    pub axes: Option<TangentAxes>,
}

/// An object of these surfels, coloured by normal.
pub fn object(name: &str, surfels: &[Surfel]) -> Object {
    coloured(name, surfels, |surfel| surfel.normal.abs())
}

/// An object of these surfels with colours of your own: linear RGB, 0..1.
pub fn coloured(name: &str, surfels: &[Surfel], colour: impl FnMut(&Surfel) -> Vec3) -> Object {
    let place = |surfel: &Surfel| surfel.centre.extend(surfel.radius).to_array();
    let mut linear = colour;
    let colour = |surfel: &Surfel| encode_colour(Vec4::from((linear(surfel), 1.0)));
    let axes: Option<Vec<_>> = surfels
        .iter()
        .map(|surfel| surfel.axes.map(|axes| axes.0))
        .collect();
    let block = Block {
        position_radius: surfels.iter().map(place).collect(),
        normal: Some(surfels.iter().map(|s| encode_normal(s.normal)).collect()),
        colour: Some(surfels.iter().map(colour).collect()),
        axes: axes.map(Into::into),
        named: Vec::new(),
    };
    let geometry = Geometry::new(vec![block], None, Origins::FROM_FILE);
    Object::new(name, DVec3::ZERO, geometry)
}

/// The same as [`object`] with triangles over the surfels.
pub fn meshed(name: &str, vertices: &[Surfel], triangles: &[[u32; 3]]) -> Object {
    let mut object = object(name, vertices);
    let Geometry {
        blocks, origins, ..
    } = (*object.geometry).clone();
    object.geometry = Geometry::new(blocks, Some(triangles.into()), origins).into();
    object
}

/// A closed sphere of about radius 1 with dents, as a mesh: its vertices and `2 * rings * sides` triangles, wound outward; those at
/// the poles have no area.
pub fn dented_mesh(rings: u32, sides: u32) -> (Vec<Surfel>, Vec<[u32; 3]>) {
    let centre = |ring: u32, side: u32| {
        let (sine, cosine) = (core::f64::consts::PI * f64::from(ring) / f64::from(rings)).sin_cos();
        let turn = core::f64::consts::TAU * f64::from(side % sides) / f64::from(sides);
        let normal = DVec3::new(turn.sin() * sine, cosine, turn.cos() * sine);
        normal * (1.0 + 0.1 * (7.0 * normal.x).sin() * (5.0 * normal.y).cos())
    };
    let vertex = |number: u32| {
        let (ring, side) = (number / sides, number % sides);
        let here = centre(ring, side);
        let along = centre((ring + 1).min(rings), side) - centre(ring.saturating_sub(1), side);
        let across = centre(ring, side + 1) - centre(ring, side + sides - 1);
        let normal = along
            .cross(across)
            .try_normalize()
            .unwrap_or(here.normalize());
        Surfel {
            centre: here.as_vec3(),
            radius: 0.01,
            normal: normal.as_vec3(),
            axes: None,
        }
    };
    let vertices = (0..(rings + 1) * sides).map(vertex).collect();
    let cell = |number: u32| {
        let (ring, side) = (number / sides, number % sides);
        let [here, next] = [side, (side + 1) % sides].map(|side| ring * sides + side);
        [
            [here, here + sides, next + sides],
            [here, next + sides, next],
        ]
    };
    (vertices, (0..rings * sides).flat_map(cell).collect())
}

/// Surfels on a unit sphere with dents, each of about `radius`.
pub fn ball(count: usize, radius: f32, seed: u64) -> Vec<Surfel> {
    let mut random = Random(seed);
    let surfel = |_| {
        let normal = random.vector().normalize();
        let dent = 1.0 + 0.1 * (7.0 * normal.x).sin() * (5.0 * normal.y).cos();
        Surfel {
            centre: (normal * dent).as_vec3(),
            radius: radius * (1.0 + 0.5 * random.signed() as f32),
            normal: normal.as_vec3(),
            axes: None,
        }
    };
    (0..count).map(surfel).collect()
}

/// Elliptical disks all over the view; every third lies round the eye, and many of those cross the near plane.
pub fn disks(count: usize, eye: DVec3) -> Vec<Surfel> {
    let mut random = Random(3);
    let disk = |index: usize| {
        let normal = random.vector().normalize();
        let (u, v) = normal.any_orthonormal_pair();
        let aspect = 0.6 + 0.4 * random.signed();
        let (centre, size) = if index.is_multiple_of(3) {
            (eye + 0.3 * random.vector(), 0.3 + 0.2 * random.signed())
        } else {
            let spread = DVec3::new(2.0, 1.5, 2.0);
            (random.vector() * spread, 0.2 + 0.15 * random.signed())
        };
        Surfel {
            centre: centre.as_vec3(),
            radius: size as f32,
            normal: normal.as_vec3(),
            axes: Some(TangentAxes::new(
                (u * size).as_vec3(),
                (v * size * aspect).as_vec3(),
            )),
        }
    };
    (0..count).map(disk).collect()
}

/// The camera of the shader library's twins that sees as `camera` does, in a picture of this size.
pub fn twin_camera(camera: &Camera, size_px: [u32; 2]) -> TwinCamera {
    let [width, height] = size_px.map(f64::from);
    let frame = FrameUniform {
        tile_size_px: size_px.map(|size| size as f32),
        is_orthographic: matches!(camera.projection, Projection::Orthographic { .. }).into(),
        ..FrameUniform::default()
    };
    TwinCamera {
        clip_from_view: camera.clip_from_view(width / height),
        ..TwinCamera::from(&frame)
    }
}
