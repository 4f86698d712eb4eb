//! Whether a scene and a device have what a plugin needs, and what the user can do if not.

use crate::device::GpuDevice;
use crate::gpu::{feature_by_name, limit_by_name};
use pointstage_plugin_api::manifest::{DeviceKind, Needs};
use pointstage_scene::{Geometry, Provenance, Scene};

/// Whether a plugin can draw here.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Suitability {
    /// It can.
    Suitable,
    /// It cannot.
    Unsuitable {
        /// Everything that is missing, in one sentence.
        reason: String,
        /// What the program can do about all of it at once, if anything.
        remedy: Option<Remedy>,
    },
}

/// What the program offers when a scene lacks something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// Estimate normals from neighbours.
    EstimateNormals,
    /// Estimate radii from neighbours.
    EstimateRadii,
    /// Both.
    EstimateNormalsAndRadii,
}

impl Suitability {
    /// Why not; none if it is suitable.
    pub fn reason(&self) -> Option<String> {
        match self {
            Self::Suitable => None,
            Self::Unsuitable { reason, .. } => Some(reason.clone()),
        }
    }

    /// What the program can do about it.
    pub fn remedy(&self) -> Option<Remedy> {
        match self {
            Self::Unsuitable { remedy, .. } => *remedy,
            Self::Suitable => None,
        }
    }
}

/// Whether a plugin with these needs can draw `scene` on `device`. An empty scene lacks nothing.
pub fn suitability(needs: &Needs, scene: &Scene, device: Option<&GpuDevice>) -> Suitability {
    let mut lacks = device_lacks(needs, device);
    let device_is_fit = lacks.is_empty();
    let (missing, remedies) = scene_lacks(needs, scene);
    lacks.extend(missing);
    if lacks.is_empty() {
        return Suitability::Suitable;
    }
    let remedy = match remedies {
        _ if !device_is_fit => None,
        Remedies { other: true, .. } => None,
        Remedies {
            normals: true,
            radii: true,
            ..
        } => Some(Remedy::EstimateNormalsAndRadii),
        Remedies { normals: true, .. } => Some(Remedy::EstimateNormals),
        Remedies { radii: true, .. } => Some(Remedy::EstimateRadii),
        Remedies { .. } => None,
    };
    Suitability::Unsuitable {
        reason: lacks.join("; "),
        remedy,
    }
}

fn device_lacks(needs: &Needs, device: Option<&GpuDevice>) -> Vec<String> {
    if needs.device == DeviceKind::Cpu {
        return Vec::new();
    }
    let Some(device) = device else {
        return vec!["it needs a graphics device, and this session has none".to_owned()];
    };
    let features = needs
        .features
        .iter()
        .filter_map(|name| match feature_by_name(name) {
            Some(feature) if device.features.contains(feature) => None,
            Some(_) => Some(format!(
                "the device '{}' lacks the feature '{name}'",
                device.info.name
            )),
            None => Some(format!(
                "it needs the device feature '{name}', which this program does not know"
            )),
        });
    let limits =
        needs
            .limits
            .iter()
            .filter_map(|(name, least)| match limit_by_name(&device.limits, name) {
                Some(limit) if limit >= *least => None,
                Some(limit) => Some(format!(
                    "it needs {name} of {least}, the device has {limit}"
                )),
                None => Some(format!(
                    "it needs the device limit '{name}', which this program does not know"
                )),
            });
    features.chain(limits).collect()
}

/// Which of the missing things could be estimated.
#[derive(Default)]
struct Remedies {
    normals: bool,
    radii: bool,
    /// Something is missing that nothing can make up.
    other: bool,
}

fn scene_lacks(needs: &Needs, scene: &Scene) -> (Vec<String>, Remedies) {
    let mut lacks = Vec::new();
    let mut remedies = Remedies::default();
    // The first object that lacks it is named: with several, the user has to know which.
    let mut require = |what: &str, has: &dyn Fn(&Geometry) -> bool| {
        let mut filled = scene
            .objects()
            .iter()
            .filter(|object| object.geometry.surfel_count > 0);
        let lacking = filled.find(|object| !has(&object.geometry));
        if let Some(object) = lacking {
            lacks.push(format!("it needs {what}, and '{}' has none", object.name));
        }
        lacking.is_some()
    };
    let given = |provenance: Provenance| provenance != Provenance::Missing;
    if needs.normals {
        remedies.normals = require("normals", &|g| given(g.origins.normals));
    }
    if needs.radii {
        remedies.radii = require("radii", &|g| given(g.origins.radii));
    }
    if needs.axes {
        remedies.other |= require("tangent axes", &|g| given(g.origins.axes));
    }
    if needs.colours {
        remedies.other |= require("colours", &|g| given(g.origins.colours));
    }
    if needs.mesh {
        remedies.other |= require("triangles", &|g| g.triangle_count() > 0);
    }
    for column in &needs.columns {
        let has = |block: &pointstage_scene::Block| {
            block.named.iter().any(|named| *named.name == **column)
        };
        remedies.other |= require(&format!("the column '{column}'"), &|g| {
            g.blocks.iter().all(has)
        });
    }
    (lacks, remedies)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use pointstage_scene::{Block, Object, Origins};

    fn scene(origins: Origins) -> Scene {
        let block = Block {
            position_radius: vec![[0.0; 4]].into(),
            ..Block::default()
        };
        let mut scene = Scene::new();
        scene.add(Object::new(
            "scan",
            DVec3::ZERO,
            Geometry::new(vec![block], None, origins),
        ));
        scene
    }

    fn cpu() -> Needs {
        Needs {
            device: DeviceKind::Cpu,
            ..Needs::default()
        }
    }

    #[test]
    fn no_device_is_a_reason_for_gpu_plugins_only() {
        let scene = scene(Origins::default());
        assert_eq!(suitability(&cpu(), &scene, None), Suitability::Suitable);
        let reason = suitability(&Needs::default(), &scene, None)
            .reason()
            .expect("no device");
        assert!(reason.contains("graphics device"), "{reason}");
    }

    #[test]
    fn missing_normals_can_be_estimated_and_missing_triangles_cannot() {
        let scene = scene(Origins::default());
        let normals = Needs {
            normals: true,
            ..cpu()
        };
        let found = suitability(&normals, &scene, None);
        assert_eq!(found.remedy(), Some(Remedy::EstimateNormals));
        assert_eq!(
            found.reason().as_deref(),
            Some("it needs normals, and 'scan' has none")
        );
        let both = Needs {
            normals: true,
            radii: true,
            ..cpu()
        };
        assert_eq!(
            suitability(&both, &scene, None).remedy(),
            Some(Remedy::EstimateNormalsAndRadii)
        );
        let mesh = Needs {
            normals: true,
            mesh: true,
            ..cpu()
        };
        assert_eq!(
            suitability(&mesh, &scene, None).remedy(),
            None,
            "estimating would not suffice"
        );
    }

    #[test]
    fn what_the_scene_has_is_enough_and_an_empty_scene_lacks_nothing() {
        let origins = Origins {
            normals: Provenance::Estimated,
            ..Origins::default()
        };
        let normals = Needs {
            normals: true,
            ..cpu()
        };
        assert_eq!(
            suitability(&normals, &scene(origins), None),
            Suitability::Suitable
        );
        assert_eq!(
            suitability(&normals, &Scene::new(), None),
            Suitability::Suitable
        );
    }

    #[test]
    fn a_missing_column_is_named() {
        let needs = Needs {
            columns: vec!["intensity".into()],
            ..cpu()
        };
        let reason = suitability(&needs, &scene(Origins::default()), None)
            .reason()
            .expect("missing");
        assert!(reason.contains("'intensity'"), "{reason}");
    }
}
