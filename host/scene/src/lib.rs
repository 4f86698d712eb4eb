//! What Pointstage shows: objects made of surfel columns, the camera that looks at them and the lights that light them.
//!
//! Data passes through once. [`load()`] reads a file into an [`Object`] whose [`Geometry`] is blocks of columns behind
//! [`Arc`](std::sync::Arc); [`estimate`] fills in normals and radii where the file had none; [`edit`] finds surfels and takes them
//! out; a [`Scene`] holds the objects.
//! A scene is cheap to clone: render threads get a copy that shares every column, and [`Changes`] tells what differs
//! between two copies. Nothing here knows of a GPU, a window or a plugin.
//!
//! Lengths are scene units, angles radians. The world is right-handed with y up; positions of columns are f32 relative to
//! their object's f64 origin.

mod bounds;
mod camera;
mod changes;
pub mod edit;
pub mod estimate;
mod framing;
mod geometry;
mod job;
mod light;
mod light_by_hand;
mod load;
mod marks;
mod moved;
mod save;
mod scene;
mod textures;
mod warnings;

pub use bounds::Bounds;
pub use camera::{
    Camera, CameraKey, CameraPath, CameraPathError, Easing, NearClipping, Projection,
    VIEW_RECORD_FORMAT, ViewRecord, ViewRecordError, ViewSource, ViewSourceError, orbit_cameras,
};
pub use changes::{Changes, ColumnChange, ColumnChangeKind, ObjectChange};
pub use edit::{MergeError, Placement, duplicate, merge};
pub use geometry::{Block, Geometry, NamedColumn, Origins, Provenance, ScalarType};
pub use job::{Cancelled, Job};
pub use light::{Headlight, Light, LightKind, LightSpace, Lights, MAX_LIGHTS};
pub use load::{
    BuildError, Claim, ColumnRole, ColumnSpec, Contents, Estimation, FaceRadius, FileStart,
    FormatError, LoadError, LoadOptions, LoadStop, Loaded, Loader, LoaderChoice, LoaderInfo,
    Loaders, ObjectBuilder, Place, PlyError, PositionScale, QsError, START_BYTES, SflError,
    SourceFile, TriError, UnknownLoader, Winding, load, load_with,
};
pub use marks::{MarkMode, Marks};
pub use pointstage_texels::PictureFile;
pub use save::{PlyEncoding, SaveError, SaveFormat, Saved, save, write_ply, write_sfl};
pub use scene::{Material, Object, ObjectId, Revision, Scene};
pub use textures::{NO_PICTURE, Textures};
pub use warnings::{Warning, WarningKind, Warnings};
