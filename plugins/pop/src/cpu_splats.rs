//! Splats on the CPU: where a tree's nodes are seen, four at a time, and what they look like. The twin of
//! `shaders/pop/splat.wesl` and `shaders/pop/blending.wesl`.

use pointstage_plugin_api::abi::DrawUniform;
use pointstage_plugin_api::columns::linear_from_srgb;
use pointstage_plugin_api::glam::{Mat3, Mat4, Vec2, Vec3, Vec4};
use pointstage_plugin_api::{DrawFlags, FrameUniform};
use pointstage_pop_tree::{Node, Tree};

/// Radius of the kernel of blended splats, in radii of the splat; `REACH` of the shader.
pub(crate) const REACH: f32 = 1.5;
/// How far behind the visible surface others blend with it, in radii; `DEEP` of the shader.
pub(crate) const DEEP: f32 = 1.0;
/// Weight of what shows its back; `BACK` of the shader.
pub(crate) const BACK: f32 = 1.0 / 32.0;

/// Linear: red of the host's picture of kinds; `SPLAT_COLOUR` of the shader.
pub(crate) const SPLAT_COLOUR: Vec3 = Vec3::new(0.672, 0.020, 0.021);

/// Where a splat is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Footprint {
    /// px.
    pub(crate) centre: Vec2,
    /// Half-widths; px.
    pub(crate) half: Vec2,
    pub(crate) depth: f32,
    /// How much less the depth of a disk's rim is.
    pub(crate) fall: f32,
    /// Of the node.
    pub(crate) number: u32,
}

/// What a splat gives the pixels round it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gift {
    /// Linear, and 1.
    pub(crate) colour: Vec4,
    /// (normal + 1)/2, view space, and 0.
    pub(crate) normal: Vec4,
    /// Weight at the centre.
    pub(crate) peak: f32,
}

/// How a tree's nodes look, for splats that blend.
#[derive(Clone, Debug)]
pub(crate) struct Look {
    view_from_object_normal: Mat3,
    /// Linear; of all nodes.
    colour: Option<Vec3>,
    is_two_sided: bool,
    /// Linear, by the codes of red and blue, and of green.
    red_blue: [f32; 64],
    green: [f32; 128],
}

/// How splats of a tree come to the screen.
#[derive(Clone, Debug)]
pub(crate) struct Stage<'a> {
    tree: &'a Tree,
    /// Clip space from steps of the grid.
    clip_from_grid: Mat4,
    /// Of z and w, what a unit along the view direction takes off.
    away: Vec2,
    /// Of x and y: the slope of a ray is its place on the screen (-1 to 1), plus this, times that.
    slope_offset: Vec2,
    slope_factor: Vec2,
    size_px: Vec2,
    pixels_per_unit: f32,
    is_orthographic: bool,
    stretch: f32,
    base: u32,
    view_from_grid: Mat4,
    look: Look,
}

/// The images of four nodes' spheres.
struct Images {
    /// Centres and half-widths; px.
    x: [f32; 4],
    y: [f32; 4],
    half_x: [f32; 4],
    half_y: [f32; 4],
    /// 0 for what is not seen.
    depth: [f32; 4],
    /// How much less the depth of a disk's rim is.
    fall: [f32; 4],
}

impl<'a> Stage<'a> {
    /// * `stretch`: greatest factor of a length from object space to view space.
    /// * `base`: the primitive before the tree's first.
    pub(crate) fn new(
        tree: &'a Tree,
        frame: &FrameUniform,
        draw: &DrawUniform,
        (stretch, base): (f32, u32),
        look: Look,
    ) -> Self {
        let clip_from_view = Mat4::from_cols_array_2d(&frame.clip_from_view);
        let view_from_object = Mat4::from_cols_array_2d(&draw.view_from_object);
        let object_from_grid = Mat4::from_translation(Vec3::from_array(tree.grid.origin))
            * Mat4::from_scale(Vec3::splat(tree.grid.step));
        let view_from_grid = view_from_object * object_from_grid;
        let [x, y] = [clip_from_view.x_axis.x, clip_from_view.y_axis.y];
        Self {
            tree,
            clip_from_grid: clip_from_view * view_from_grid,
            away: Vec2::new(clip_from_view.z_axis.z, clip_from_view.z_axis.w),
            slope_offset: Vec2::new(clip_from_view.z_axis.x, clip_from_view.z_axis.y),
            slope_factor: Vec2::new(1.0 / x, 1.0 / y),
            size_px: Vec2::from_array(frame.tile_size_px),
            pixels_per_unit: frame.pixels_per_unit,
            is_orthographic: frame.is_orthographic != 0,
            stretch,
            base,
            view_from_grid,
            look,
        }
    }

    /// Where four nodes are seen.
    #[inline]
    fn images(&self, nodes: &[Node; 4]) -> Images {
        let places = nodes.map(|node| node.place().as_ivec3().as_vec3());
        let lane = |axis: usize| Vec4::from_array(places.map(|place| place[axis]));
        let [place_x, place_y, place_z] = [lane(0), lane(1), lane(2)];
        let matrix = &self.clip_from_grid;
        let row = |axis: usize| {
            place_x * matrix.x_axis[axis]
                + place_y * matrix.y_axis[axis]
                + place_z * matrix.z_axis[axis]
                + Vec4::splat(matrix.w_axis[axis])
        };
        let [clip_x, clip_y, clip_z, clip_w] = [row(0), row(1), row(2), row(3)];
        let scale = Vec4::ONE / clip_w;
        let depth = clip_z * scale;
        let seen = clip_w.cmpgt(Vec4::ZERO) & depth.cmpgt(Vec4::ZERO) & depth.cmple(Vec4::ONE);
        let [ndc_x, ndc_y] = [clip_x * scale, clip_y * scale];
        let radius = Vec4::from_array(nodes.map(Node::radius)) * self.stretch;
        // A radius farther along the view direction.
        let rim = (clip_z - radius * self.away.x) / (clip_w - radius * self.away.y);
        let mut half_x = radius * self.pixels_per_unit;
        let mut half_y = half_x;
        if !self.is_orthographic {
            // Of a perspective view w is the distance.
            let width = half_x / (clip_w - radius).max(Vec4::splat(1e-30));
            let secant = |ndc: Vec4, axis: usize| {
                let slope = (ndc + Vec4::splat(self.slope_offset[axis])) * self.slope_factor[axis];
                Vec4::from_array((Vec4::ONE + slope * slope).to_array().map(f32::sqrt))
            };
            half_x = width * secant(ndc_x, 0);
            half_y = width * secant(ndc_y, 1);
        }
        let half = Vec4::splat(0.5);
        Images {
            x: ((ndc_x * half + half) * self.size_px.x).to_array(),
            y: ((half - ndc_y * half) * self.size_px.y).to_array(),
            half_x: half_x.to_array(),
            half_y: half_y.to_array(),
            depth: Vec4::select(seen, depth, Vec4::ZERO).to_array(),
            fall: (depth - rim).to_array(),
        }
    }

    /// The primitive of a node.
    #[inline]
    pub(crate) fn primitive(&self, node: u32) -> u32 {
        self.base + 1 + node
    }

    fn node(&self, number: u32) -> Node {
        let node = self.tree.nodes.get(number as usize);
        node.copied().unwrap_or_default()
    }

    /// Where up to four nodes are seen, those that are.
    #[inline]
    pub(crate) fn footprints(&self, numbers: &[u32]) -> impl Iterator<Item = Footprint> {
        let mut nodes = [Node::default(); 4];
        for (node, &number) in nodes.iter_mut().zip(numbers) {
            *node = self.node(number);
        }
        let images = self.images(&nodes);
        let lanes = numbers.iter().enumerate().take(4);
        lanes.filter_map(move |(lane, &number)| {
            let depth = images.depth[lane];
            (depth > 0.0).then(|| Footprint {
                centre: Vec2::new(images.x[lane], images.y[lane]),
                half: Vec2::new(images.half_x[lane], images.half_y[lane]),
                depth,
                fall: images.fall[lane],
                number,
            })
        })
    }

    /// The nearest depth that may be visible where a splat has a part.
    #[inline]
    pub(crate) fn blends_until(footprint: &Footprint) -> f32 {
        footprint.depth + DEEP * footprint.fall
    }

    /// What a splat gives the pixels round it.
    #[inline]
    pub(crate) fn gift(&self, footprint: &Footprint) -> Gift {
        let look = &self.look;
        let node = self.node(footprint.number);
        let centre = node.place().as_ivec3().as_vec3();
        let to_eye = if self.is_orthographic {
            Vec3::Z
        } else {
            -self.view_from_grid.transform_point3(centre)
        };
        let mut normal = (look.view_from_object_normal * node.normal()).normalize_or_zero();
        let mut faces_away = normal.dot(to_eye) < 0.0;
        if faces_away && look.is_two_sided {
            normal = -normal;
            faces_away = false;
        }
        Gift {
            colour: look.colour_of(node).extend(1.0),
            normal: (0.5 * normal + 0.5).extend(0.0),
            peak: if faces_away { BACK } else { 1.0 },
        }
    }
}

impl Look {
    /// * `colour`: linear; of all nodes.
    pub(crate) fn new(draw: &DrawUniform, colour: Option<Vec3>) -> Self {
        let flags = DrawFlags(draw.flags);
        let [red, green, blue, _] = draw.default_colour;
        let default = Vec3::new(red, green, blue);
        let has_colour = flags.contains(DrawFlags::HAS_COLOUR);
        Self {
            view_from_object_normal: Mat3::from_mat4(Mat4::from_cols_array_2d(
                &draw.view_from_object_normal,
            )),
            colour: colour.or((!has_colour).then_some(default)),
            is_two_sided: flags.contains(DrawFlags::TWO_SIDED),
            red_blue: core::array::from_fn(|code| linear_from_srgb(code as f32 / 63.0)),
            green: core::array::from_fn(|code| linear_from_srgb(code as f32 / 127.0)),
        }
    }

    #[inline]
    fn colour_of(&self, node: Node) -> Vec3 {
        self.colour.unwrap_or_else(|| {
            let [red, green, blue] = node.colour_codes();
            let [red, blue] = [red, blue].map(|code| self.red_blue[code & 63]);
            Vec3::new(red, self.green[green & 127], blue)
        })
    }
}
