//! What a view makes of nodes, four siblings at a time.

use super::view::View;
use crate::node::{NO_CONE, NORMAL_MAX, Node};
use pointstage_plugin_api::glam::{Vec3, Vec4};

/// What is asked of a node is less if an ancestor settled it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Open {
    /// Planes that the node may still cross.
    pub(crate) planes: u8,
    /// Whether it may still be turned away, in part or wholly.
    pub(crate) is_cone_open: bool,
}

/// What becomes of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Nothing of it can be seen.
    Culled,
    /// It is at most as wide as the threshold.
    Small,
    /// It is wider.
    Large,
}

/// How far the camera may move until a verdict may change.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Slack {
    /// Motion of points in view space; scene units.
    pub(crate) view: f32,
    /// Motion of the eye in object space; units of that space.
    pub(crate) eye: f32,
}

impl Slack {
    pub(crate) const ENDLESS: Self = Self {
        view: f32::INFINITY,
        eye: f32::INFINITY,
    };

    pub(crate) fn min(self, other: Self) -> Self {
        Self {
            view: self.view.min(other.view),
            eye: self.eye.min(other.eye),
        }
    }
}

/// The answers about up to four siblings: a bit or a lane for each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answers {
    culled: u32,
    large: u32,
    /// Planes that each may still cross.
    planes: [u8; 4],
    /// Whose cones are settled.
    faces: u32,
    is_cone_open: bool,
    /// Endless unless asked for.
    slack_view: Vec4,
    slack_eye: Vec4,
}

impl Answers {
    /// What becomes of a sibling, and what is left open for its children.
    #[inline]
    pub(crate) fn of(&self, sibling: usize) -> (Verdict, Open) {
        let bit = 1 << sibling;
        let verdict = if self.culled & bit != 0 {
            Verdict::Culled
        } else if self.large & bit != 0 {
            Verdict::Large
        } else {
            Verdict::Small
        };
        let open = Open {
            planes: self.planes[sibling],
            is_cone_open: self.is_cone_open && self.faces & bit == 0,
        };
        (verdict, open)
    }

    /// The slack of the answer about a sibling.
    #[inline]
    pub(crate) fn slack(&self, sibling: usize) -> Slack {
        Slack {
            view: self.slack_view[sibling],
            eye: self.slack_eye[sibling],
        }
    }
}

impl View {
    /// What becomes of up to four siblings, given what their ancestors left open; with the slack of the answers if `SLACK`.
    ///
    /// A node's width on the screen is taken as 2·r·d / (z − r), r its radius, z its depth, d the pixels a unit covers at depth
    /// 1: for small spheres that is 2·r·d / z, the size of a splat in Chen and Nguyen's system. No child's is greater than its parent's, since a
    /// child's sphere lies inside.
    #[inline]
    pub(crate) fn judge<const SLACK: bool>(&self, siblings: &[Node], open: Open) -> Answers {
        let mut nodes = [Node::default(); 4];
        let count = siblings.len().min(4);
        nodes[..count].copy_from_slice(&siblings[..count]);
        let place = Lanes::of(nodes.map(|node| node.place().as_ivec3().as_vec3()));
        let radius_object = Vec4::from_array(nodes.map(Node::radius));
        let radius = radius_object * self.stretch;
        let [x, y, z] = [
            self.view_from_grid.x_axis,
            self.view_from_grid.y_axis,
            self.view_from_grid.z_axis,
        ];
        let along = |axis: usize| {
            place.x * x[axis]
                + place.y * y[axis]
                + place.z * z[axis]
                + Vec4::splat(self.origin_view[axis])
        };
        let centre = Lanes {
            x: along(0),
            y: along(1),
            z: along(2),
        };
        let mut answers = Answers {
            culled: 0,
            large: 0,
            planes: [open.planes; 4],
            faces: 0,
            is_cone_open: open.is_cone_open,
            slack_view: Vec4::INFINITY,
            slack_eye: Vec4::INFINITY,
        };
        let mut left = open.planes;
        while left != 0 {
            let number = left.trailing_zeros();
            left &= left - 1;
            let plane = self.planes[number as usize];
            let distance = centre.dot(plane.truncate()) + Vec4::splat(plane.w);
            let is_outside = distance.cmplt(-radius);
            let is_inside = distance.cmpge(radius);
            if SLACK {
                // Of what is already outside another plane, that plane's slack stays.
                let to_outside = (distance + radius).abs();
                let to_inside = (distance - radius).abs();
                let nearest =
                    Vec4::select(is_outside, to_outside, Vec4::min(to_inside, to_outside));
                answers.slack_view = answers.slack_view.min(nearest);
            }
            answers.culled |= is_outside.bitmask();
            let inside = is_inside.bitmask();
            for (sibling, planes) in answers.planes.iter_mut().enumerate() {
                *planes &= !(((inside >> sibling & 1) as u8) << number);
            }
        }
        if open.is_cone_open {
            self.judge_cones::<SLACK>(&nodes, &place, radius_object, &mut answers);
        }
        let excess = if self.projection.is_orthographic {
            radius * self.reach - Vec4::ONE
        } else {
            radius * self.reach + centre.z
        };
        answers.large = excess.cmpgt(Vec4::ZERO).bitmask();
        if SLACK && !self.projection.is_orthographic {
            answers.slack_view = answers.slack_view.min(excess.abs());
        }
        answers
    }

    /// Leaves out what is turned away, and settles what faces the eye.
    ///
    /// n·(x − eye) is bounded over the normals n of the cone and the points x of the sphere: all face away if its least is
    /// above 0, all face the eye if its greatest is below. Object space, where any affine transform leaves the signs as they are.
    #[inline]
    fn judge_cones<const SLACK: bool>(
        &self,
        nodes: &[Node; 4],
        place: &Lanes,
        radius: Vec4,
        answers: &mut Answers,
    ) {
        let codes = nodes.map(|node| usize::from(node.cone_code()));
        let cosine = Vec4::from_array(codes.map(|code| self.cones[code][0]));
        let sine = Vec4::from_array(codes.map(|code| self.cones[code][1]));
        let axis = Lanes::of_normals(nodes);
        let (from_eye, square, radius) = if self.projection.is_orthographic {
            // As seen from far away: only the direction counts.
            let from_eye = -self.eye_object;
            let lanes = Lanes {
                x: Vec4::splat(from_eye.x),
                y: Vec4::splat(from_eye.y),
                z: Vec4::splat(from_eye.z),
            };
            (lanes, Vec4::ONE, Vec4::ZERO)
        } else {
            let from_eye = Vec3::from_array(self.grid.origin) - self.eye_object;
            let lanes = Lanes {
                x: place.x * self.grid.step + Vec4::splat(from_eye.x),
                y: place.y * self.grid.step + Vec4::splat(from_eye.y),
                z: place.z * self.grid.step + Vec4::splat(from_eye.z),
            };
            let square = lanes.x * lanes.x + lanes.y * lanes.y + lanes.z * lanes.z;
            (lanes, square, radius)
        };
        let along =
            (axis.x * from_eye.x + axis.y * from_eye.y + axis.z * from_eye.z) * self.normal_sign();
        let across = (square - along * along).max(Vec4::ZERO);
        let across = Vec4::from_array(across.to_array().map(f32::sqrt));
        let least = along * cosine - across * sine - radius;
        let greatest = along * cosine + across * sine + radius;
        let known = codes.iter().enumerate().fold(0, |bits, (sibling, &code)| {
            bits | u32::from(code != usize::from(NO_CONE)) << sibling
        });
        let away = least.cmpgt(Vec4::ZERO).bitmask() & known;
        answers.faces = greatest.cmplt(Vec4::ZERO).bitmask() & known;
        if SLACK {
            let slack = least.abs().min(greatest.abs()).to_array();
            for (sibling, slack) in slack.into_iter().enumerate() {
                if known >> sibling & 1 != 0 {
                    answers.slack_eye[sibling] = slack;
                }
            }
        }
        answers.culled |= away;
    }
}

/// Three numbers of each of four siblings.
#[derive(Clone, Copy, Debug)]
struct Lanes {
    x: Vec4,
    y: Vec4,
    z: Vec4,
}

impl Lanes {
    #[inline]
    fn of([a, b, c, d]: [Vec3; 4]) -> Self {
        Self {
            x: Vec4::new(a.x, b.x, c.x, d.x),
            y: Vec4::new(a.y, b.y, c.y, d.y),
            z: Vec4::new(a.z, b.z, c.z, d.z),
        }
    }

    /// Unit normals: `decode_normal20`, four at once.
    #[inline]
    fn of_normals(nodes: &[Node; 4]) -> Self {
        let code = |shift: u32| {
            let codes = nodes.map(|node| (node.0[3] >> shift & 1023) as i32 as f32);
            Vec4::from_array(codes) * (1.0 / NORMAL_MAX) - Vec4::ONE
        };
        let [square_x, square_y] = [code(0), code(10)];
        let z = Vec4::ONE - square_x.abs() - square_y.abs();
        let sign = |value: Vec4| Vec4::select(value.cmpge(Vec4::ZERO), Vec4::ONE, Vec4::NEG_ONE);
        let is_upper = z.cmpge(Vec4::ZERO);
        let x = Vec4::select(
            is_upper,
            square_x,
            (Vec4::ONE - square_y.abs()) * sign(square_x),
        );
        let y = Vec4::select(
            is_upper,
            square_y,
            (Vec4::ONE - square_x.abs()) * sign(square_y),
        );
        let square = x * x + y * y + z * z;
        let scale = Vec4::ONE / Vec4::from_array(square.to_array().map(f32::sqrt));
        Self {
            x: x * scale,
            y: y * scale,
            z: z * scale,
        }
    }

    #[inline]
    fn dot(&self, other: Vec3) -> Vec4 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }
}
