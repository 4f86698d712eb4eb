//! Splats drawn on the CPU: several times as fast as a software device, which does the same on the same cores. The twin of
//! `shaders/pop/splat.wesl` and of the splats of `shaders/pop/primitives_compute.wesl`.

use pointstage_plugin_api::FrameUniform;
use pointstage_plugin_api::glam::{Mat4, Vec2, Vec3, Vec4};
use pointstage_pop_tree::{Node, Tree};
use std::sync::{Mutex, PoisonError};
use std::thread;

/// Splats that a thread takes at a time.
const SHARE: usize = 8_192;

/// Primitive (lower half) and bits of the depth (upper half) of each pixel, rows from the top; 0 where nothing is. What is
/// greater is nearer, as in the buffer of the compute path.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pixels {
    width: usize,
    nearest: Vec<u64>,
    /// Those of other threads, until they are joined.
    others: Vec<Vec<u64>>,
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
    is_disk: bool,
    base: u32,
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
        view_from_object: &[[f32; 4]; 4],
        (stretch, base, is_disk): (f32, u32, bool),
    ) -> Self {
        let clip_from_view = Mat4::from_cols_array_2d(&frame.clip_from_view);
        let view_from_object = Mat4::from_cols_array_2d(view_from_object);
        let object_from_grid = Mat4::from_translation(Vec3::from_array(tree.grid.origin))
            * Mat4::from_scale(Vec3::splat(tree.grid.step));
        let [x, y] = [clip_from_view.x_axis.x, clip_from_view.y_axis.y];
        Self {
            tree,
            clip_from_grid: clip_from_view * (view_from_object * object_from_grid),
            away: Vec2::new(clip_from_view.z_axis.z, clip_from_view.z_axis.w),
            slope_offset: Vec2::new(clip_from_view.z_axis.x, clip_from_view.z_axis.y),
            slope_factor: Vec2::new(1.0 / x, 1.0 / y),
            size_px: Vec2::from_array(frame.tile_size_px),
            pixels_per_unit: frame.pixels_per_unit,
            is_orthographic: frame.is_orthographic != 0,
            stretch,
            is_disk,
            base,
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

    /// Offers the splats of up to four nodes to the pixels that they cover.
    #[inline]
    fn draw(&self, numbers: &[u32], width: usize, pixels: &mut [u64]) {
        let mut nodes = [Node::default(); 4];
        for (node, &number) in nodes.iter_mut().zip(numbers) {
            *node = self
                .tree
                .nodes
                .get(number as usize)
                .copied()
                .unwrap_or_default();
        }
        let images = self.images(&nodes);
        for (lane, &number) in numbers.iter().enumerate().take(4) {
            let depth = images.depth[lane];
            if depth > 0.0 {
                let centre = [images.x[lane], images.y[lane]];
                let half = [images.half_x[lane], images.half_y[lane]];
                let fall = images.fall[lane];
                let seen = (depth, fall, self.base + 1 + number);
                self.fill(centre, half, seen, width, pixels);
            }
        }
    }

    /// Offers a splat's depth and primitive to its pixels.
    #[inline]
    fn fill(
        &self,
        [x, y]: [f32; 2],
        [half_x, half_y]: [f32; 2],
        (depth, fall, primitive): (f32, f32, u32),
        width: usize,
        pixels: &mut [u64],
    ) {
        // Pixels whose centres lie within; casts of what is not finite end at the bounds.
        let [left, top] = [ceil(x - half_x - 0.5), ceil(y - half_y - 0.5)];
        let right = ceil_past((x + half_x).min(self.size_px.x) - 0.5);
        let bottom = ceil_past((y + half_y).min(self.size_px.y) - 0.5);
        let [scale_x, scale_y] = [1.0 / half_x, 1.0 / half_y];
        for row in top..bottom {
            let down = (row as f32 + 0.5 - y) * scale_y;
            let start = row * width;
            let Some(row) = pixels.get_mut(start + left..start + right.max(left)) else {
                return;
            };
            for (column, pixel) in row.iter_mut().enumerate() {
                let across = ((left + column) as f32 + 0.5 - x) * scale_x;
                let share = across * across + down * down;
                if share <= 1.0 || !self.is_disk {
                    let depth = if self.is_disk {
                        depth - fall * share
                    } else {
                        depth
                    };
                    // What falls behind the far plane is not seen.
                    let bits = u64::from(depth.max(0.0).to_bits());
                    *pixel = (*pixel).max(bits << 32 | u64::from(primitive));
                }
            }
        }
    }
}

/// The least whole number that is not below `edge`; 0 for anything below 0.
#[inline]
fn ceil(edge: f32) -> usize {
    let whole = edge as usize;
    whole + usize::from(edge > whole as f32)
}

/// The first whole number above the greatest that is not above `edge`; 0 for anything below 0.
#[inline]
fn ceil_past(edge: f32) -> usize {
    if edge >= 0.0 { edge as usize + 1 } else { 0 }
}

impl Pixels {
    /// Empties all pixels.
    pub(crate) fn clear(&mut self, size_px: [u32; 2]) {
        let [width, height] = size_px.map(|size| size as usize);
        self.width = width;
        self.nearest.clear();
        self.nearest.resize(width * height, 0);
    }

    /// All pixels.
    pub(crate) fn nearest(&self) -> &[u64] {
        &self.nearest
    }

    /// Draws nodes of a tree, on up to `thread_count` threads.
    pub(crate) fn draw(&mut self, stage: &Stage<'_>, nodes: &[u32], thread_count: usize) {
        let shares = Mutex::new(nodes.chunks(SHARE));
        let (width, count) = (self.width, self.nearest.len());
        let work = |pixels: &mut Vec<u64>| {
            loop {
                let share = shares.lock().unwrap_or_else(PoisonError::into_inner).next();
                let Some(share) = share else { return };
                if pixels.is_empty() {
                    pixels.resize(count, 0);
                }
                for numbers in share.chunks(4) {
                    stage.draw(numbers, width, pixels);
                }
            }
        };
        let more_threads = thread_count
            .min(nodes.len().div_ceil(SHARE))
            .saturating_sub(1);
        self.others.resize(more_threads, Vec::new());
        thread::scope(|scope| {
            for pixels in &mut self.others {
                pixels.clear();
                // Without a thread the others do its work.
                let _ = thread::Builder::new()
                    .name("pop".into())
                    .spawn_scoped(scope, || work(pixels));
            }
            work(&mut self.nearest);
        });
        for other in self.others.iter().filter(|other| !other.is_empty()) {
            for (nearest, other) in self.nearest.iter_mut().zip(other) {
                *nearest = (*nearest).max(*other);
            }
        }
    }
}
