//! What workers do for the selection, and what they bring back.

use glam::Mat4;
use pointstage_engine::frame::eye_distance;
use pointstage_engine::stage::{FrameResult, Plane};
use pointstage_scene::edit::{
    Occluder, ScreenRegion, ScreenView, extract, marks_in_box, marks_on_screen, piece_of,
    without_marked,
};
use pointstage_scene::{
    Bounds, Camera, Cancelled, Geometry, Job, MarkMode, Marks, Object, ObjectId, Revision, Scene,
};

/// Surfels that a worker found.
#[derive(Debug)]
pub(crate) struct Found {
    /// Of each object that was looked at.
    pub(crate) marks: Vec<(ObjectId, Marks)>,
    /// What becomes of them.
    pub(crate) mode: MarkMode,
}

/// Why surfels were taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// To be pasted.
    Copy,
    /// To be pasted, and they leave their objects.
    Cut,
    /// They leave their objects.
    Delete,
    /// What is outside the crop box leaves.
    Crop,
}

/// What a worker made of objects.
#[derive(Debug)]
pub(crate) struct Pieces {
    /// Why.
    pub(crate) purpose: Purpose,
    /// Copies of marked surfels.
    pub(crate) copies: Vec<Object>,
    /// What is left of objects.
    pub(crate) rests: Vec<Rest>,
}

/// What is left of an object.
#[derive(Debug)]
pub(crate) struct Rest {
    /// Which one.
    pub(crate) id: ObjectId,
    /// The geometry that it was made from.
    pub(crate) of: Revision,
    /// None if nothing is.
    pub(crate) geometry: Option<Geometry>,
    /// How many surfels are gone.
    pub(crate) gone: usize,
}

/// The depths of a picture, which tell what is hidden.
#[derive(Clone, Debug)]
pub(crate) struct Depths {
    size_px: [u32; 2],
    depth: Plane,
    clip_from_view: Mat4,
}

impl Depths {
    /// Of a picture by this camera; `None` if it is by another one, or came without depths.
    pub(crate) fn of(shown: &FrameResult, camera: &Camera) -> Option<Self> {
        let is_same = shown.world_from_view == camera.view_from_world().inverse();
        let depth = shown.planes.get("depth").filter(|_| is_same)?;
        Some(Self {
            size_px: shown.picture.size_px,
            depth: depth.clone(),
            clip_from_view: Mat4::from_cols_array_2d(&shown.uniform.clip_from_view),
        })
    }

    /// Size of the picture, px.
    pub(crate) fn size_px(&self) -> [u32; 2] {
        self.size_px
    }
}

impl Occluder for Depths {
    fn eye_distance(&self, [x, y]: [u32; 2]) -> f64 {
        let index = y as usize * self.size_px[0] as usize + x as usize;
        let depth = match &self.depth {
            Plane::Float { values, .. } => values.get(index).copied(),
            Plane::Uint(_) => None,
        };
        match depth {
            Some(depth) if depth > 0.0 => f64::from(eye_distance(depth, &self.clip_from_view)),
            _ => f64::INFINITY,
        }
    }
}

/// Surfels of all visible objects in a region of the screen.
pub(crate) fn find_in_region(
    scene: &Scene,
    view: ScreenView<'_>,
    region: &ScreenRegion,
    mode: MarkMode,
    job: &Job,
) -> Result<Found, Cancelled> {
    find(scene, mode, |object| {
        marks_on_screen(object, view, region, job)
    })
}

/// Surfels of all visible objects in a box of the world.
pub(crate) fn find_in_box(
    scene: &Scene,
    bounds: &Bounds,
    mode: MarkMode,
    job: &Job,
) -> Result<Found, Cancelled> {
    find(scene, mode, |object| marks_in_box(object, bounds, job))
}

fn find(
    scene: &Scene,
    mode: MarkMode,
    marks: impl Fn(&Object) -> Result<Marks, Cancelled>,
) -> Result<Found, Cancelled> {
    let visible = scene.objects().iter().filter(|object| object.visible);
    let found: Result<Vec<(ObjectId, Marks)>, Cancelled> = visible
        .map(|object| Ok((object.id, marks(object)?)))
        .collect();
    Ok(Found {
        marks: found?,
        mode,
    })
}

/// Copies the marked surfels, or leaves them out, or both.
pub(crate) fn take_pieces(scene: &Scene, purpose: Purpose, job: &Job) -> Result<Pieces, Cancelled> {
    let mut pieces = Pieces {
        purpose,
        copies: Vec::new(),
        rests: Vec::new(),
    };
    for object in scene.objects() {
        let Some(marks) = object.marked() else {
            continue;
        };
        if purpose != Purpose::Delete {
            pieces.copies.extend(piece_of(object, job)?);
        }
        if purpose != Purpose::Copy {
            pieces.rests.push(Rest {
                id: object.id,
                of: object.geometry.revision,
                geometry: without_marked(&object.geometry, marks, job)?,
                gone: marks.count(),
            });
        }
    }
    Ok(pieces)
}

/// Leaves out what is outside a box of the world, of all visible objects that reach beyond it.
pub(crate) fn keep_in_box(scene: &Scene, bounds: &Bounds, job: &Job) -> Result<Pieces, Cancelled> {
    let mut rests = Vec::new();
    for object in scene.objects().iter().filter(|object| object.visible) {
        let inside = marks_in_box(object, bounds, job)?;
        let gone = inside.len() - inside.count();
        if gone == 0 {
            continue;
        }
        let rest = extract(&object.geometry, &inside, job)?;
        rests.push(Rest {
            id: object.id,
            of: object.geometry.revision,
            geometry: (rest.surfel_count > 0).then_some(rest),
            gone,
        });
    }
    Ok(Pieces {
        purpose: Purpose::Crop,
        copies: Vec::new(),
        rests,
    })
}
