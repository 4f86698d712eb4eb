//! The surfels of a selection as the CPU reads them: the twin of `lib::surfel`, four at once.

use super::ellipse::{Axes4, Camera4};
use super::lanes::{LANES, Vec3x4};
use crate::clips::Clips;
use pointstage_plugin_api::clip::ClipLines;
use pointstage_plugin_api::columns::NO_NORMAL;
use pointstage_plugin_api::glam::{BVec4A, Mat4, Vec3, Vec4};
use pointstage_plugin_api::twin::clip::scaled_clip_lines;
use pointstage_plugin_api::{Draw, DrawFlags, DrawUniform, Frame};
use std::sync::Arc;

/// The draws of a frame, with their columns at hand, and its camera.
#[derive(Clone, Debug)]
pub struct Stage<'a> {
    /// The frame's camera.
    pub camera: Camera4,
    /// In the order of their ids.
    pub draws: Vec<Surfels<'a>>,
    /// Least and greatest distance from the eye's plane in which most surfels are, scene units.
    pub(super) distances: [f32; 2],
}

/// One draw.
#[derive(Clone, Debug)]
pub struct Surfels<'a> {
    position_radius: &'a [[f32; 4]],
    normals: Option<&'a [u32]>,
    colours: Option<&'a [u32]>,
    axes: Option<&'a [[f32; 8]]>,
    clips: Option<Arc<[ClipLines]>>,
    pub(super) numbers: Numbers,
    uniform: &'a DrawUniform,
    is_two_sided: bool,
    /// The frame's.
    radius_scale: f32,
    /// The frame's times the object's.
    axes_scale: f32,
    /// View space from object space: rows of x, y, z and 1.
    view_from_object: [[Vec4; 4]; 3],
    /// The same for normals.
    normal_from_object: [[Vec4; 3]; 3],
    /// In object space: the eye, or for parallel rays the direction towards it.
    eye: Vec3x4,
    is_orthographic: bool,
}

/// Which surfels of a block a draw draws.
#[derive(Clone, Debug)]
pub(super) enum Numbers {
    Range { first: u32, count: u32 },
    List(Vec<u32>),
}

/// Four surfels.
#[derive(Clone, Copy, Debug)]
pub struct Surfels4 {
    /// Places in the block.
    pub numbers: [u32; LANES],
    /// Object space.
    pub centre: Vec3x4,
    /// Object space, without the frame's scale.
    pub radius: Vec4,
    /// View space.
    pub centre_view: Vec3x4,
    /// Unit, object space; anything where it is not known.
    pub normal: Vec3x4,
    /// Whether the normal is known.
    pub has_normal: BVec4A,
}

impl<'a> Stage<'a> {
    /// What a frame draws; none if a draw's surfels are known to the device alone, or a column is not at hand.
    ///
    /// * `clips`: of the scene.
    pub fn of(frame: &Frame<'a>, clips: &Clips) -> Option<Self> {
        let draws = frame.selection().filter(|draw| draw.count() > 0);
        let draws = draws.map(|draw| Surfels::of(&draw, frame, clips));
        let mut draws = draws.collect::<Option<Vec<_>>>()?;
        draws.sort_by_key(|draw| draw.uniform.id_base);
        let distances = frame.selection().filter_map(|draw| {
            let bounds = draw.object()?.bounds();
            let view_from_object = Mat4::from_cols_array_2d(&draw.uniform().view_from_object);
            let corners = (0..8).map(|corner| {
                let pick = |axis: usize| bounds[corner >> axis & 1][axis];
                let corner = Vec3::new(pick(0), pick(1), pick(2));
                -view_from_object.transform_point3(corner).z
            });
            Some(
                corners.fold([f32::MAX, 0.0], |[nearest, farthest], distance| {
                    [distance.min(nearest), distance.max(farthest)]
                }),
            )
        });
        let distances = distances.fold([f32::MAX, 0.0], |all, one| {
            [one[0].min(all[0]), one[1].max(all[1])]
        });
        let nearest = distances[0].max(frame.uniform().near);
        Some(Self {
            camera: Camera4::from(frame.uniform()),
            draws,
            distances: [nearest, distances[1].max(nearest)],
        })
    }

    /// Surfels of all draws.
    pub fn surfel_count(&self) -> u64 {
        self.draws.iter().map(|draw| draw.len() as u64).sum()
    }
}

impl<'a> Surfels<'a> {
    /// A draw; none if it is not at hand.
    fn of(draw: &Draw<'a>, frame: &Frame<'a>, clips: &Clips) -> Option<Self> {
        let flags = draw.flags();
        if flags.contains(DrawFlags::INDIRECT) {
            return None;
        }
        let block = draw.block();
        let block_count = block.surfel_count();
        let count = block_count as usize;
        let at_hand = |flag, length: Option<usize>| {
            !flags.contains(flag) || length.is_some_and(|length| length >= count)
        };
        let position_radius = block.position_radius();
        let (normals, colours, axes) = (block.normals(), block.colours(), block.axes());
        let is_at_hand = position_radius.len() >= count
            && at_hand(DrawFlags::HAS_NORMAL, normals.map(<[_]>::len))
            && at_hand(DrawFlags::HAS_COLOUR, colours.map(<[_]>::len))
            && at_hand(DrawFlags::HAS_AXES, axes.map(<[_]>::len));
        if !is_at_hand {
            return None;
        }
        let uniform = draw.uniform();
        let numbers = if flags.contains(DrawFlags::INDEXED) {
            let list: Vec<_> = draw.surfels().collect();
            if list.is_empty() {
                return None;
            }
            Numbers::List(list)
        } else {
            let first = uniform.first.min(block_count);
            let count = uniform.count.min(block_count - first);
            Numbers::Range { first, count }
        };
        let matrix = &uniform.view_from_object;
        let normal_matrix = &uniform.view_from_object_normal;
        let is_orthographic = frame.uniform().is_orthographic != 0;
        let eye = uniform.object_from_view[if is_orthographic { 2 } else { 3 }];
        Some(Self {
            position_radius,
            normals: normals.filter(|_| flags.contains(DrawFlags::HAS_NORMAL)),
            colours: colours.filter(|_| flags.contains(DrawFlags::HAS_COLOUR)),
            axes: axes.filter(|_| flags.contains(DrawFlags::HAS_AXES)),
            clips: clips.lines_of(block),
            numbers,
            uniform,
            is_two_sided: flags.contains(DrawFlags::TWO_SIDED),
            radius_scale: frame.uniform().radius_scale,
            axes_scale: frame.uniform().radius_scale * uniform.object_radius_scale(),
            view_from_object: [0, 1, 2]
                .map(|row| [0, 1, 2, 3].map(|column| Vec4::splat(matrix[column][row]))),
            normal_from_object: [0, 1, 2]
                .map(|row| [0, 1, 2].map(|column| Vec4::splat(normal_matrix[column][row]))),
            eye: Vec3x4::splat(Vec3::new(eye[0], eye[1], eye[2])),
            is_orthographic,
        })
    }

    /// Surfels of the draw.
    pub fn len(&self) -> usize {
        match &self.numbers {
            Numbers::Range { count, .. } => *count as usize,
            Numbers::List(list) => list.len(),
        }
    }

    /// Whether the draw has none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// What the `id` target holds for the surfel `number` of the draw's block.
    #[inline]
    pub fn surfel_id(&self, number: u32) -> u32 {
        self.uniform.id_base.wrapping_add(number)
    }

    /// Object matrices, material and flags.
    pub fn uniform(&self) -> &'a DrawUniform {
        self.uniform
    }

    /// Whether normals have no outside.
    pub fn is_two_sided(&self) -> bool {
        self.is_two_sided
    }

    /// Clip lines of a surfel, for u and v in so many half-axes with the radius scales; none if nothing of the draw has any.
    #[inline]
    pub fn clip_lines(&self, number: u32, unit: f32) -> Option<ClipLines> {
        let lines = self.clips.as_ref()?.get(number as usize)?;
        Some(scaled_clip_lines(*lines, unit * self.axes_scale))
    }

    /// Packed colour of a surfel; none if the draw's is meant.
    #[inline]
    pub fn packed_colour(&self, number: u32) -> Option<u32> {
        self.colours?.get(number as usize).copied()
    }

    /// Centres (object and view space) and radii of surfels, and a bound on the half-axes in view space with the frame's scale.
    #[inline]
    pub(super) fn spheres(&self, numbers: &[u32]) -> (Vec3x4, Vec4) {
        let (centre, radius, _) = self.load_positions(numbers);
        let bound = match self.axes {
            Some(axes) => {
                let square = |number: u32| {
                    let axes = axes.get(number as usize).copied().unwrap_or_default();
                    axes.iter().map(|length| length * length).sum::<f32>()
                };
                let mut squares = [0.0; LANES];
                for (square_of, number) in squares.iter_mut().zip(numbers) {
                    *square_of = square(*number);
                }
                Vec4::from_array(squares.map(f32::sqrt))
            }
            None => radius.abs(),
        };
        // Without a normal the radius takes this factor, too; a thousandth more for rounding.
        let factor = self.uniform.radius_factor.max(1e-30) * self.radius_scale * 1.001;
        (self.view_from_object(centre), bound * factor)
    }

    /// Four surfels, or as many as there are numbers; the rest repeats the first.
    #[inline]
    pub fn load(&self, numbers: &[u32]) -> Surfels4 {
        let (centre, radius, numbers) = self.load_positions(numbers);
        let packed = numbers.map(|number| self.packed_normal(number));
        let has_normal =
            Vec4::from_array(packed.map(|packed| if packed == NO_NORMAL { 0.0 } else { 1.0 }));
        let direction = octahedral_direction(packed);
        Surfels4 {
            numbers,
            centre,
            radius,
            centre_view: self.view_from_object(centre),
            normal: direction.normalize(),
            has_normal: has_normal.cmpgt(Vec4::ZERO),
        }
    }

    #[inline]
    fn load_positions(&self, numbers: &[u32]) -> (Vec3x4, Vec4, [u32; LANES]) {
        let mut all = [numbers.first().copied().unwrap_or_default(); LANES];
        for (place, number) in all.iter_mut().zip(numbers) {
            *place = *number;
        }
        let load = |number: u32| {
            let surfel = self.position_radius.get(number as usize);
            Vec4::from_array(surfel.copied().unwrap_or_default())
        };
        let [first, second, third, fourth] = all.map(load);
        let columns = Mat4::from_cols(first, second, third, fourth).transpose();
        let centre = Vec3x4::new(columns.x_axis, columns.y_axis, columns.z_axis);
        (centre, columns.w_axis, all)
    }

    #[inline]
    fn packed_normal(&self, number: u32) -> u32 {
        let packed = self
            .normals
            .and_then(|normals| normals.get(number as usize));
        packed.copied().unwrap_or(NO_NORMAL)
    }

    #[inline]
    fn view_from_object(&self, position: Vec3x4) -> Vec3x4 {
        let [x, y, z] = &self.view_from_object;
        let row = |row: &[Vec4; 4]| {
            position.x * row[0] + position.y * row[1] + position.z * row[2] + row[3]
        };
        Vec3x4::new(row(x), row(y), row(z))
    }

    #[inline]
    fn view_from_object_direction(&self, direction: Vec3x4) -> Vec3x4 {
        let [x, y, z] = &self.view_from_object;
        let row =
            |row: &[Vec4; 4]| direction.x * row[0] + direction.y * row[1] + direction.z * row[2];
        Vec3x4::new(row(x), row(y), row(z))
    }

    /// Unit normals in view space, as the scene has them; towards the eye where they are not known.
    #[inline]
    pub fn load_normal_view(&self, surfels: &Surfels4, camera: &Camera4) -> Vec3x4 {
        let [x, y, z] = &self.normal_from_object;
        let normal = surfels.normal;
        let row = |row: &[Vec4; 3]| normal.x * row[0] + normal.y * row[1] + normal.z * row[2];
        let normal_view = Vec3x4::new(row(x), row(y), row(z)).normalize();
        if surfels.has_normal.all() {
            return normal_view;
        }
        let to_eye = camera.towards_eye(surfels.centre_view);
        Vec3x4::select(surfels.has_normal, normal_view, to_eye)
    }

    /// Whether surfels show their backs and the object has an inside.
    #[inline]
    pub fn are_back_facing(&self, surfels: &Surfels4) -> BVec4A {
        if self.is_two_sided {
            return BVec4A::FALSE;
        }
        let to_eye = if self.is_orthographic {
            self.eye
        } else {
            self.eye - surfels.centre
        };
        surfels.normal.dot(to_eye).cmplt(Vec4::ZERO) & surfels.has_normal
    }

    /// Half-axes of the surfels' ellipses in view space, with the radius scales: from the scene's axes, else the disk of
    /// normal and radius, else a disk that faces the eye.
    #[inline]
    pub fn load_axes_view(&self, surfels: &Surfels4, camera: &Camera4) -> Axes4 {
        if let Some(axes) = self.axes {
            let axes = surfels.numbers.map(|number| {
                let axes = axes.get(number as usize).copied().unwrap_or_default();
                let [ux, uy, uz, _, vx, vy, vz, _] = axes;
                [Vec3::new(ux, uy, uz), Vec3::new(vx, vy, vz)]
            });
            let scale = Vec4::splat(self.axes_scale);
            let [u, v] = [0, 1].map(|which| Vec3x4::from_vectors(axes.map(|axes| axes[which])));
            return Axes4 {
                u: self.view_from_object_direction(u * scale),
                v: self.view_from_object_direction(v * scale),
            };
        }
        let tangents = tangents_of(surfels.normal);
        let scale = surfels.radius * self.axes_scale;
        let axes = Axes4 {
            u: self.view_from_object_direction(tangents.u * scale),
            v: self.view_from_object_direction(tangents.v * scale),
        };
        if surfels.has_normal.all() {
            return axes;
        }
        let facing = tangents_of(camera.towards_eye(surfels.centre_view));
        let scale = surfels.radius * self.radius_scale * self.uniform.radius_factor;
        let select =
            |known, facing: Vec3x4| Vec3x4::select(surfels.has_normal, known, facing * scale);
        Axes4 {
            u: select(axes.u, facing.u),
            v: select(axes.v, facing.v),
        }
    }
}

/// The directions that packed normals stand for; their lengths are between 0.57 and 1.
#[inline]
fn octahedral_direction(packed: [u32; LANES]) -> Vec3x4 {
    let unpack = |half: [i16; LANES]| {
        let value = Vec4::from_array(half.map(f32::from)) * (1.0 / 32767.0);
        value.max(Vec4::NEG_ONE)
    };
    let x = unpack(packed.map(|packed| packed as u16 as i16));
    let y = unpack(packed.map(|packed| (packed >> 16) as u16 as i16));
    let z = Vec4::ONE - x.abs() - y.abs();
    let sign = |value: Vec4| Vec4::select(value.cmpge(Vec4::ZERO), Vec4::ONE, Vec4::NEG_ONE);
    let is_upper = z.cmpge(Vec4::ZERO);
    Vec3x4::new(
        Vec4::select(is_upper, x, (Vec4::ONE - y.abs()) * sign(x)),
        Vec4::select(is_upper, y, (Vec4::ONE - x.abs()) * sign(y)),
        z,
    )
}

/// Two unit vectors each that make a right-handed basis with unit vectors.
#[inline]
fn tangents_of(normal: Vec3x4) -> Axes4 {
    let Vec3x4 { x, y, z } = normal;
    let s = Vec4::select(z.cmpge(Vec4::ZERO), Vec4::ONE, Vec4::NEG_ONE);
    let a = Vec4::NEG_ONE / (s + z);
    let b = x * y * a;
    Axes4 {
        u: Vec3x4::new(Vec4::ONE + s * x * x * a, s * b, -(s * x)),
        v: Vec3x4::new(b, s + y * y * a, -y),
    }
}
