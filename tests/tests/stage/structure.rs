//! The border's structure kind, and a scene of two transformed objects, through well-behaved plugins that are built here.

use anyhow::{Context as _, Result};
use glam::{DAffine3, DVec3, Vec4};
use pointstage_engine::stage::{
    FrameRequest, FrameResult, IdSource, Identified, Plane, SettingValue, Stage,
};
use pointstage_plugin_api::columns;
use pointstage_scene::{Block, Camera, Geometry, Object, Origins, Scene};
use pointstage_tests::{plugins, stages};
use std::sync::Arc;

const SIZE_PX: [u32; 2] = [80, 60];

fn stage(use_device: bool) -> Result<Stage> {
    stages::of_libraries(vec![plugins::sound()?], use_device)
}

/// A row of 8 red surfels along x, 0.1 apart, of radius 0.05.
fn row(name: &str) -> Object {
    let position_radius: Arc<[[f32; 4]]> = (0..8u8)
        .map(|index| [f32::from(index) * 0.1 - 0.35, 0.0, 0.0, 0.05])
        .collect();
    let red = columns::encode_colour(Vec4::new(1.0, 0.0, 0.0, 1.0));
    let block = Block {
        colour: Some(position_radius.iter().map(|_| red).collect()),
        position_radius,
        ..Block::default()
    };
    Object::new(
        name,
        DVec3::ZERO,
        Geometry::new(vec![block], None, Origins::default()),
    )
}

/// Two rows far from the world's origin: one lifted by 0.5, one turned upright, moved to the right and enlarged twice.
fn request(renderer: &str) -> FrameRequest {
    let far = DVec3::new(500_000.0, 4_000_000.0, 1000.0);
    let mut scene = Scene::new();
    let mut lifted = row("lifted");
    lifted.origin = far;
    lifted.world_from_object = DAffine3::from_translation(DVec3::Y * 0.5);
    scene.add(lifted);
    let mut upright = row("upright");
    upright.world_from_object = DAffine3::from_translation(far + DVec3::X * 0.8)
        * DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_2)
        * DAffine3::from_scale(DVec3::splat(2.0));
    scene.add(upright);
    let camera = Camera {
        eye: far + DVec3::Z * 4.0,
        pivot: far,
        ..Camera::default()
    };
    FrameRequest {
        read_back: vec!["id".into()],
        ..FrameRequest::still(Arc::new(scene), camera, SIZE_PX, renderer)
    }
}

/// Pixels with an id, as column, row and id.
fn identified(result: &FrameResult) -> Vec<(u32, u32, u32)> {
    let Some(Plane::Uint(ids)) = result.planes.get("id") else {
        return Vec::new();
    };
    let pixels = (0..).zip(ids.iter()).filter(|(_, id)| **id != 0);
    pixels
        .map(|(pixel, id)| (pixel % SIZE_PX[0], pixel / SIZE_PX[0], *id))
        .collect()
}

/// Column and row where a world position falls; px.
fn expected_pixel(request: &FrameRequest, world: DVec3) -> (u32, u32) {
    let [width, height] = SIZE_PX.map(f64::from);
    let clip = request.camera.clip_from_view(width / height) * request.camera.view_from_world();
    let ndc = clip.project_point3(world);
    (
        ((ndc.x * 0.5 + 0.5) * width) as u32,
        ((0.5 - ndc.y * 0.5) * height) as u32,
    )
}

#[test]
fn surfels_of_two_transformed_objects_fall_where_f64_puts_them() -> Result<()> {
    let request = request("dots");
    let result = stage(false)?.frame(&request)?;
    let found = identified(&result);
    assert_eq!(found.len(), 16, "{found:?}");
    for (column, row, id) in found {
        let what = result.ids.resolve(id).context("an id of the frame")?;
        let object = request
            .scene
            .object(what.object)
            .context("an object of the scene")?;
        let centre = object
            .geometry
            .centre(what.surfel as usize)
            .context("a surfel of the object")?;
        let expected = expected_pixel(&request, object.world_from_local().transform_point3(centre));
        // One pixel for rounding at a pixel's edge; in f32 world coordinates the error would be 0.25 units, 5 px.
        assert!(
            expected.0.abs_diff(column) <= 1 && expected.1.abs_diff(row) <= 1,
            "{expected:?} ({column}, {row})"
        );
    }
    Ok(())
}

#[test]
fn a_structure_draws_its_own_blocks_and_parts_of_the_scenes() -> Result<()> {
    let request = FrameRequest {
        structure: Some("halves".into()),
        ..request("dots")
    };
    let result = stage(false)?.frame(&request)?;
    let found: Vec<_> = identified(&result)
        .into_iter()
        .filter_map(|(.., id)| result.ids.resolve(id))
        .collect();
    let (nodes, leaves): (Vec<&Identified>, Vec<&Identified>) = found
        .iter()
        .partition(|what| what.source == IdSource::Structure);
    assert_eq!((nodes.len(), leaves.len()), (4, 4), "{found:?}");
    assert!(nodes.iter().all(|what| what.surfel_in_object.is_none()));
    assert!(
        leaves.iter().all(|what| what.surfel % 2 == 0),
        "every other surfel: {leaves:?}"
    );
    assert_eq!(result.stats.surfels_selected, 8);
    assert_eq!(result.stats.reported.get("nodes_visited"), Some(&1.0));
    Ok(())
}

#[test]
fn a_structure_serves_a_renderer_on_the_device() -> Result<()> {
    let mut stage = stage(true)?;
    if stage.device().is_none() {
        println!("skipped: no graphics adapter: {:?}", stage.no_device());
        return Ok(());
    }
    let covered = |result: &FrameResult| {
        result
            .picture
            .rgba
            .chunks_exact(4)
            .filter(|pixel| pixel[3] > 0)
            .count()
    };
    let whole = stage.frame(&request("lit-points"))?;
    let halved = stage.frame(&FrameRequest {
        structure: Some("halves".into()),
        ..request("lit-points")
    })?;
    assert_eq!((covered(&whole), covered(&halved)), (16, 8));
    Ok(())
}

#[test]
fn a_costly_setting_prepares_again_and_a_cheap_one_does_not() -> Result<()> {
    let mut stage = stage(false)?;
    let mut changed = request("dots");
    let plain = stage.frame(&changed)?;
    changed
        .settings
        .insert("brightness".into(), SettingValue::Float(0.5));
    let darker = stage.frame(&changed)?;
    changed
        .settings
        .insert("invert".into(), SettingValue::Bool(true));
    let inverted = stage.frame(&changed)?;
    assert!(plain.picture != darker.picture && darker.picture != inverted.picture);
    let log = stage.registry().log();
    let prepared = log
        .lines()
        .into_iter()
        .map(|line| line.text)
        .filter(|text| text.starts_with("prepared"));
    assert_eq!(prepared.collect::<Vec<_>>(), ["prepared", "prepared again"]);
    Ok(())
}
