//! One object of a session's scene: its file, how to load it, and what is not in it.

use std::path::PathBuf;
use std::sync::Arc;

use glam::DAffine3;
use pointstage_engine::stage::SettingValues;
use pointstage_scene::{
    Estimation, LoadOptions, LoaderChoice, Material, Object, Provenance, WarningKind, Warnings,
    Winding,
};
use serde::{Deserialize, Serialize};

use super::own_objects::is_own;
use crate::toml_form::{self, MarkRuns};

/// An object as a session keeps it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SceneFile {
    /// What it is read from: absolute in memory, relative to the session file on disk where possible.
    pub(crate) file: PathBuf,
    /// Name for people; empty for the file's own.
    #[serde(default)]
    pub(crate) name: String,
    /// Whether it is drawn.
    #[serde(default = "yes")]
    pub(crate) visible: bool,
    /// Whether its mesh is turned inside out while loading.
    #[serde(default)]
    pub(crate) flipped: bool,
    /// Whether missing normals and radii are estimated however long it takes; otherwise only for small files.
    #[serde(default)]
    pub(crate) estimated: bool,
    /// Id or alias of the loader that the user chose; empty if the file's content decides.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(crate) loader: String,
    /// Values of that loader's options.
    #[serde(default, skip_serializing_if = "SettingValues::is_empty")]
    pub(crate) loader_settings: SettingValues,
    /// Where it stands: the map from the file's coordinates to the world, 3 × 4, column by column.
    #[serde(default, deserialize_with = "toml_form::transform")]
    pub(crate) transform: DAffine3,
    /// How it takes light.
    #[serde(default, deserialize_with = "toml_form::material")]
    pub(crate) material: Material,
    /// Factor on the radii of its surfels.
    #[serde(default = "one", deserialize_with = "toml_form::positive")]
    pub(crate) radius_scale: f32,
    /// Whether panels and commands are about it.
    #[serde(default, skip_serializing_if = "is_no")]
    pub(crate) active: bool,
    /// Whether the file was written with the session: it is read as it is, and nothing is estimated.
    #[serde(default, skip_serializing_if = "is_no")]
    pub(crate) own: bool,
    /// Of such a file, whether its normals have no outside, since they were estimated.
    #[serde(default, skip_serializing_if = "is_no")]
    pub(crate) two_sided: bool,
    /// Which of its surfels are selected.
    #[serde(default, skip_serializing_if = "MarkRuns::is_empty")]
    pub(crate) selected_surfels: MarkRuns,
}

fn one() -> f32 {
    1.0
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde passes a reference"
)]
fn is_no(flag: &bool) -> bool {
    !*flag
}

fn yes() -> bool {
    true
}

impl SceneFile {
    /// A file as it is, with everything by default.
    pub(crate) fn new(file: PathBuf) -> Self {
        Self {
            file,
            name: String::new(),
            visible: true,
            flipped: false,
            estimated: false,
            loader: String::new(),
            loader_settings: SettingValues::new(),
            transform: DAffine3::IDENTITY,
            material: Material::default(),
            radius_scale: 1.0,
            active: false,
            own: false,
            two_sided: false,
            selected_surfels: MarkRuns::default(),
        }
    }

    /// The entry of an object; `None` for one that came from no file. `warnings` are what loading it gave.
    pub(crate) fn of(object: &Object, warnings: Option<&Warnings>) -> Option<Self> {
        let source = object.source.as_ref()?;
        let file = std::path::absolute(source).unwrap_or_else(|_| source.clone());
        if is_own(&file) {
            return Some(Self::of_own(object, file));
        }
        let origins = &object.geometry.origins;
        let LoaderChoice { loader, settings } = object.loader.clone().unwrap_or_default();
        let is_flipped = |warnings: &Warnings| warnings.count(&WarningKind::Flipped) > 0;
        Some(Self {
            file,
            flipped: warnings.is_some_and(is_flipped),
            estimated: [origins.normals, origins.radii].contains(&Provenance::Estimated),
            loader,
            loader_settings: settings,
            ..Self::look_of(object)
        })
    }

    /// The entry of an object whose surfels stand in a file that is written with the session.
    pub(crate) fn of_own(object: &Object, file: PathBuf) -> Self {
        Self {
            file,
            own: true,
            two_sided: object.geometry.origins.normals == Provenance::Estimated,
            ..Self::look_of(object)
        }
    }

    /// What no file holds.
    fn look_of(object: &Object) -> Self {
        Self {
            name: object.name.clone(),
            visible: object.visible,
            transform: object.world_from_object,
            material: object.material,
            radius_scale: object.radius_scale,
            selected_surfels: MarkRuns::of(object.marked(), &object.name),
            ..Self::new(PathBuf::new())
        }
    }

    /// How its file is loaded.
    pub(crate) fn load_options(&self) -> LoadOptions {
        LoadOptions {
            loader: (!self.loader.is_empty()).then(|| LoaderChoice {
                loader: self.loader.clone(),
                settings: self.loader_settings.clone(),
            }),
            estimation: if self.own {
                Estimation::FileOnly
            } else if self.estimated {
                Estimation::Always
            } else {
                Estimation::Automatic
            },
            winding: if self.flipped {
                Winding::Flipped
            } else {
                Winding::AsInFile
            },
            ..LoadOptions::default()
        }
    }

    /// Gives a loaded object what its file does not hold.
    pub(crate) fn dress(&self, object: &mut Object) {
        if !self.name.is_empty() {
            object.name.clone_from(&self.name);
        }
        object.visible = self.visible;
        object.world_from_object = self.transform;
        object.material = self.material;
        object.radius_scale = self.radius_scale;
        if self.two_sided && object.geometry.origins.normals != Provenance::Missing {
            // The same surfels under the same revision: nobody has seen them yet.
            Arc::make_mut(&mut object.geometry).origins.normals = Provenance::Estimated;
        }
        object.marks = self
            .selected_surfels
            .marks(object.geometry.surfel_count, &object.name);
    }
}
