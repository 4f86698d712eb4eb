//! What a frame draws, readable on the CPU: the selection's draws, and with triangles the meshes behind them. A *primitive* is
//! a surfel or a triangle; its *ordinal* counts through all parts in order.

use pointstage_plugin_api::clip::ClipColumns;
use pointstage_plugin_api::columns::{NO_NORMAL, decode_colour_linear, decode_normal};
use pointstage_plugin_api::glam::{DMat3, DMat4, DVec3, Mat4};
use pointstage_plugin_api::twin::camera::Camera;
use pointstage_plugin_api::twin::clip::scaled_clip_lines;
use pointstage_plugin_api::twin::ellipse::Axes;
use pointstage_plugin_api::{Block, Draw, DrawFlags, DrawUniform, Error, Frame, Result};

use crate::footprint::{Footprint, Kernel};
use crate::settings::Wanted;
use crate::triangle::{Corner, Triangle};

/// One draw's columns and its object's place.
pub(crate) struct Surfels<'a> {
    view_from_object: DMat4,
    normal_matrix: DMat3,
    radius_factor: f64,
    /// The object's.
    radius_scale: f64,
    pub(crate) material: [f32; 4],
    two_sided: bool,
    pub(crate) level: u32,
    id_base: u32,
    default_colour: DVec3,
    centres: &'a [[f32; 4]],
    normals: Option<&'a [u32]>,
    colours: Option<&'a [u32]>,
    axes: Option<&'a [[f32; 8]]>,
    clips: Option<ClipColumns<'a>>,
}

/// Which primitives a part has.
enum Members<'a> {
    /// Surfels `first .. first + count` of the block.
    Range { first: u32, count: u32 },
    /// Surfels by number.
    Numbers(Vec<u32>),
    /// Triangles; `blocks` holds the object's columns, and the number of the first vertex of each.
    Triangles {
        list: &'a [[u32; 3]],
        blocks: Vec<(u64, Surfels<'a>)>,
    },
}

/// One draw's surfels, or one object's triangles.
pub(crate) struct Part<'a> {
    /// Ordinal of its first primitive.
    first: u32,
    pub(crate) surfels: Surfels<'a>,
    members: Members<'a>,
}

/// All that is drawn.
pub(crate) struct Parts<'a> {
    /// By their first ordinals.
    ordered: Vec<Part<'a>>,
    count: u32,
    /// The samples' camera: lengths on its screen are in samples.
    pub(crate) camera: Camera,
    pub(crate) kernel: Kernel,
    radius_scale: f64,
    cull_backs: bool,
    two_sided: bool,
}

/// A primitive on the screen.
#[expect(
    clippy::large_enum_variant,
    reason = "nearly all are splats, and a box would be an allocation for each"
)]
pub(crate) enum Shape {
    Splat(Footprint),
    Triangle(Box<Triangle>),
}

/// What a splat blends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attributes {
    /// Linear.
    pub(crate) colour: DVec3,
    /// View space, unit.
    pub(crate) normal: DVec3,
    /// View space.
    pub(crate) centre: DVec3,
}

impl<'a> Surfels<'a> {
    fn new(uniform: &DrawUniform, block: Block<'a>) -> Self {
        let flags = DrawFlags(uniform.flags);
        let matrix = |columns| Mat4::from_cols_array_2d(columns).as_dmat4();
        let [red, green, blue, _] = uniform.default_colour.map(f64::from);
        let centres = block.position_radius();
        // A column that is shorter than the centres is treated as absent.
        fn whole<T>(column: Option<&[T]>, count: usize) -> Option<&[T]> {
            column.filter(|column| column.len() >= count)
        }
        let has = |flag| flags.contains(flag);
        Self {
            view_from_object: matrix(&uniform.view_from_object),
            normal_matrix: DMat3::from_mat4(matrix(&uniform.view_from_object_normal)),
            radius_factor: f64::from(uniform.radius_factor),
            radius_scale: f64::from(uniform.object_radius_scale()),
            material: uniform.material,
            two_sided: has(DrawFlags::TWO_SIDED),
            level: uniform.level.round() as u32,
            id_base: uniform.id_base,
            default_colour: DVec3::new(red, green, blue),
            centres,
            normals: whole(block.normals(), centres.len()).filter(|_| has(DrawFlags::HAS_NORMAL)),
            colours: whole(block.colours(), centres.len()).filter(|_| has(DrawFlags::HAS_COLOUR)),
            axes: whole(block.axes(), centres.len()).filter(|_| has(DrawFlags::HAS_AXES)),
            clips: ClipColumns::of(block).filter(|_| has(DrawFlags::HAS_AXES)),
        }
    }

    fn centre_view(&self, number: u32) -> DVec3 {
        let [x, y, z, _] = self.centres[number as usize].map(f64::from);
        self.view_from_object.transform_point3(DVec3::new(x, y, z))
    }

    fn packed_normal(&self, number: u32) -> u32 {
        self.normals
            .map_or(NO_NORMAL, |normals| normals[number as usize])
    }

    /// View space, unit; none if it is not known.
    fn normal_view(&self, number: u32) -> Option<DVec3> {
        let packed = self.packed_normal(number);
        let normal = self.normal_matrix * decode_normal(packed).as_dvec3();
        (packed != NO_NORMAL).then(|| normal.normalize_or_zero())
    }

    fn colour(&self, number: u32) -> DVec3 {
        self.colours.map_or(self.default_colour, |colours| {
            decode_colour_linear(colours[number as usize])
                .truncate()
                .as_dvec3()
        })
    }

    /// Half-axes in view space, with the frame's factor `scale` and the object's.
    fn axes_view(&self, number: u32, centre_view: DVec3, camera: &Camera, scale: f64) -> Axes {
        let direction = |axis: DVec3| self.view_from_object.transform_vector3(axis);
        let own_scale = scale * self.radius_scale;
        if let Some(axes) = self.axes {
            let [ux, uy, uz, _, vx, vy, vz, _] = axes[number as usize].map(f64::from);
            return Axes {
                u: direction(DVec3::new(ux, uy, uz) * own_scale),
                v: direction(DVec3::new(vx, vy, vz) * own_scale),
            };
        }
        let radius = f64::from(self.centres[number as usize][3]);
        let packed = self.packed_normal(number);
        if packed == NO_NORMAL {
            let (u, v) = camera.towards_eye(centre_view).any_orthonormal_pair();
            let radius = radius * scale * self.radius_factor;
            return Axes {
                u: u * radius,
                v: v * radius,
            };
        }
        let radius = radius * own_scale;
        let normal = decode_normal(packed).as_dvec3();
        let (u, v) = normal.any_orthonormal_pair();
        Axes {
            u: direction(u * radius),
            v: direction(v * radius),
        }
    }
}

impl<'a> Parts<'a> {
    /// What the frame draws.
    ///
    /// # Errors
    /// If the selection is known to the device alone, or there are more primitives than fit a `u32`.
    pub(crate) fn new(frame: &Frame<'a>, wanted: &Wanted, samples: u32) -> Result<Self> {
        let uniform = frame.uniform();
        let mut camera = Camera::from(uniform);
        camera.tile_size_px *= f64::from(samples);
        camera.pixels_per_unit *= f64::from(samples);
        let draws: Vec<Draw<'a>> = frame.selection().collect();
        let mut ordered: Vec<Part<'a>> = Vec::with_capacity(draws.len());
        let mut count = 0_u64;
        let mut meshes = Vec::new();
        for draw in &draws {
            let (surfels, members) = match triangles_of(draw, &draws, wanted) {
                Some(_) if meshes.contains(&draw.object().map(|object| object.id())) => continue,
                Some(mesh) => {
                    meshes.push(draw.object().map(|object| object.id()));
                    (Surfels::new(draw.uniform(), draw.block()), mesh)
                }
                None => (
                    Surfels::new(draw.uniform(), draw.block()),
                    members_of(draw)?,
                ),
            };
            let part = Part {
                first: count as u32,
                surfels,
                members,
            };
            count += part.len();
            ordered.push(part);
        }
        // One more than the greatest ordinal has to fit, too.
        if count >= u64::from(u32::MAX) {
            return Err(Error::failed(format!(
                "{count} surfels are more than this renderer can count; choose a structure that selects fewer"
            )));
        }
        Ok(Self {
            ordered,
            count: count as u32,
            camera,
            kernel: wanted.kernel,
            radius_scale: f64::from(uniform.radius_scale),
            cull_backs: wanted.cull_backs,
            two_sided: wanted.two_sided,
        })
    }

    /// How many primitives.
    pub(crate) fn count(&self) -> u32 {
        self.count
    }

    /// The part of this ordinal, and the primitive's place in it.
    pub(crate) fn find(&self, ordinal: u32) -> (&Part<'a>, usize) {
        let after = self.ordered.partition_point(|part| part.first <= ordinal);
        let part = &self.ordered[after - 1];
        (part, (ordinal - part.first) as usize)
    }

    /// The primitive on the screen; none if it cannot be seen.
    pub(crate) fn shape(&self, ordinal: u32) -> Option<Shape> {
        let (part, place) = self.find(ordinal);
        match &part.members {
            Members::Triangles { list, blocks } => {
                let corners = corners_of(list[place], blocks)?;
                Triangle::new(&self.camera, corners).map(|found| Shape::Triangle(Box::new(found)))
            }
            _ => self.footprint(part, place).map(Shape::Splat),
        }
    }

    fn footprint(&self, part: &Part<'_>, place: usize) -> Option<Footprint> {
        let number = part.number(place);
        let surfels = &part.surfels;
        let centre = surfels.centre_view(number);
        let faces_away = !surfels.two_sided
            && surfels
                .normal_view(number)
                .is_some_and(|normal| normal.dot(self.camera.towards_eye(centre)) < 0.0);
        if (self.cull_backs && faces_away) || !centre.is_finite() {
            return None;
        }
        let scale = self.radius_scale * self.kernel.scale;
        let axes = surfels.axes_view(number, centre, &self.camera, scale);
        let footprint = Footprint::new(&self.camera, &self.kernel, centre, axes, faces_away)?;
        let unit = (scale * surfels.radius_scale * self.kernel.cutoff) as f32;
        Some(match &surfels.clips {
            Some(clips) => footprint.cut_off(scaled_clip_lines(clips.lines(number), unit)),
            None => footprint,
        })
    }

    /// Whether the ordinal is a triangle's.
    pub(crate) fn is_triangle(&self, ordinal: u32) -> bool {
        matches!(self.find(ordinal).0.members, Members::Triangles { .. })
    }

    /// What the splat of this ordinal blends.
    pub(crate) fn attributes(&self, ordinal: u32) -> Attributes {
        let (part, place) = self.find(ordinal);
        let number = part.number(place);
        let centre = part.surfels.centre_view(number);
        let to_eye = self.camera.towards_eye(centre);
        let normal = part.surfels.normal_view(number).unwrap_or(to_eye);
        Attributes {
            colour: part.surfels.colour(number),
            normal: self.lit_side(&part.surfels, normal, to_eye),
            centre,
        }
    }

    /// The normal to light with: on the eye's side, if both sides are lit.
    pub(crate) fn lit_side(&self, surfels: &Surfels<'_>, normal: DVec3, to_eye: DVec3) -> DVec3 {
        let both = self.two_sided || surfels.two_sided;
        if both && normal.dot(to_eye) < 0.0 {
            -normal
        } else {
            normal
        }
    }

    /// What the `id` target holds for the primitive; of a triangle the id of its nearest corner, `corner`.
    pub(crate) fn id(&self, ordinal: u32, corner: usize) -> u32 {
        let (part, place) = self.find(ordinal);
        match &part.members {
            Members::Triangles { list, blocks } => {
                let vertex = list[place][corner];
                block_of(vertex, blocks).map_or(0, |(surfels, number)| surfels.id_base + number)
            }
            _ => part.surfels.id_base + part.number(place),
        }
    }
}

impl Part<'_> {
    fn len(&self) -> u64 {
        match &self.members {
            Members::Range { count, .. } => u64::from(*count),
            Members::Numbers(numbers) => numbers.len() as u64,
            Members::Triangles { list, .. } => list.len() as u64,
        }
    }

    /// Number in the block of the surfel at `place`.
    fn number(&self, place: usize) -> u32 {
        match &self.members {
            Members::Range { first, .. } => first + place as u32,
            Members::Numbers(numbers) => numbers[place],
            Members::Triangles { .. } => 0,
        }
    }
}

/// The draw's surfels.
fn members_of<'a>(draw: &Draw<'a>) -> Result<Members<'a>> {
    let flags = draw.flags();
    if flags.contains(DrawFlags::INDIRECT) {
        return Err(on_device_only());
    }
    let length = draw.block().position_radius().len() as u32;
    if !flags.contains(DrawFlags::INDEXED) {
        let first = draw.uniform().first.min(length);
        let count = draw.count().min(length - first);
        return Ok(Members::Range { first, count });
    }
    let numbers: Vec<u32> = draw.surfels().filter(|number| *number < length).collect();
    if numbers.is_empty() && draw.count() > 0 {
        return Err(on_device_only());
    }
    Ok(Members::Numbers(numbers))
}

fn on_device_only() -> Error {
    Error::failed(
        "the structure keeps its selection on the graphics device, where this renderer cannot read it; choose another structure or none",
    )
}

/// The mesh behind the draw, if triangles are wanted and the object has some.
fn triangles_of<'a>(draw: &Draw<'a>, draws: &[Draw<'a>], wanted: &Wanted) -> Option<Members<'a>> {
    let object = draw.object().filter(|_| wanted.triangles)?;
    let list = object.triangles()?;
    let blocks = object.blocks().map(|block| {
        let is_same = |other: &&Draw<'a>| {
            other.block().position_radius().as_ptr() == block.position_radius().as_ptr()
        };
        // A block that no draw selects gets its place from the first one, and no ids of its own.
        let own = draws.iter().find(is_same).unwrap_or(draw);
        (block.first_surfel(), Surfels::new(own.uniform(), block))
    });
    Some(Members::Triangles {
        list,
        blocks: blocks.collect(),
    })
}

/// The block that holds the object's vertex, and the vertex's number in it.
fn block_of<'s, 'a>(
    vertex: u32,
    blocks: &'s [(u64, Surfels<'a>)],
) -> Option<(&'s Surfels<'a>, u32)> {
    let vertex = u64::from(vertex);
    let after = blocks.partition_point(|(first, _)| *first <= vertex);
    let (first, surfels) = blocks.get(after.checked_sub(1)?)?;
    let number = vertex - first;
    (number < surfels.centres.len() as u64).then_some((surfels, number as u32))
}

fn corners_of(triangle: [u32; 3], blocks: &[(u64, Surfels<'_>)]) -> Option<[Corner; 3]> {
    let corner = |vertex| {
        let (surfels, number) = block_of(vertex, blocks)?;
        Some(Corner {
            position: surfels.centre_view(number),
            normal: surfels.normal_view(number).unwrap_or(DVec3::ZERO),
            colour: surfels.colour(number),
        })
    };
    let [a, b, c] = triangle.map(corner);
    Some([a?, b?, c?])
}
