//! The session of one picture, so that the picture can be made again.

use std::collections::BTreeMap;

use pointstage_engine::stage::FrameRequest;
use pointstage_scene::{ObjectId, ViewRecord, Warnings};

use super::{SceneFile, SessionFile};
use crate::toml_form::{Look, MarkRuns};

impl SessionFile {
    /// The session that draws what `request` asks for. `warnings` are what loading each object gave; objects that came
    /// from no file, or have other surfels by now, are left out.
    pub(crate) fn of_request(
        request: &FrameRequest,
        warnings: &BTreeMap<ObjectId, Warnings>,
    ) -> Self {
        let [width, height] = request.size_px;
        let mut session = Self::new(ViewRecord::new(request.camera, width, height));
        let objects = request.scene.objects().iter();
        session.scene = objects
            .filter(|object| object.loaded.is_none() || object.is_as_in_file())
            .filter_map(|object| SceneFile::of(object, warnings.get(&object.id)))
            .collect();
        if !request.shows_marks {
            // A picture that does not show them is not made of them.
            for entry in &mut session.scene {
                entry.selected_surfels = MarkRuns::default();
            }
        }
        session.look = Look {
            show: request.show.clone(),
            background: request.background,
            exposure: request.exposure,
            radius_scale: request.radius_scale,
        };
        session.lights = request.lights.clone();
        let mut keep = |id: &String, values: &pointstage_engine::stage::SettingValues| {
            if !values.is_empty() {
                session.settings.insert(id.clone(), values.clone());
            }
        };
        keep(&request.renderer, &request.settings);
        if let Some(structure) = &request.structure {
            keep(structure, &request.structure_settings);
        }
        session.renderers.main = Some(request.renderer.clone());
        session.renderers.structure.clone_from(&request.structure);
        session
    }
}
