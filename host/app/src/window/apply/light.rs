//! Carries out intents about lights and material.

use pointstage_scene::{Camera, Light, Material};

use crate::window::app::App;
use crate::window::intent::LightIntent;

impl App {
    pub(super) fn apply_light(&mut self, intent: LightIntent) {
        match intent {
            LightIntent::Set(lights) => self.session.panes.active.lights = lights,
            LightIntent::Drag { right, up } => {
                self.move_first_light(|light, camera| light.drag(camera, right, up));
            }
            LightIntent::Push(part) => {
                self.move_first_light(|light, camera| light.push_away(camera, part));
            }
            LightIntent::Material(material) => self.set_material(material),
        }
    }

    /// Without a light there is nothing to move; the gizmo shows that there is none.
    fn move_first_light(&mut self, change: impl FnOnce(&mut Light, &Camera)) {
        if let Some(light) = self.session.panes.active.lights.lights.first_mut() {
            change(light, &self.session.panes.active.camera);
        }
    }

    /// Gives the selected objects this material, or all of them and those to come if none is selected.
    fn set_material(&mut self, material: Material) {
        let objects = self.session.scene.objects();
        let is_any_selected = objects.iter().any(|object| object.selected);
        let ids: Vec<_> = objects
            .iter()
            .filter(|object| object.selected || !is_any_selected)
            .map(|object| object.id)
            .collect();
        if !is_any_selected {
            self.session.material = material;
        }
        self.session.edit_scene(|scene| {
            for id in ids {
                scene.edit(id, |object| object.material = material);
            }
        });
    }
}
