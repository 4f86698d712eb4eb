//! All that is known of a surfel and of a pixel, as text.

use glam::{DVec3, Vec3};
use pointstage_engine::frame::legend::without_trailing_zeros;
use pointstage_engine::stage::{FrameResult, IdSource, Identified, Plane};
use pointstage_plugin_api::columns::decode_colour;
use pointstage_scene::{Block, Object, Scene};

/// What is at a pixel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Facts {
    /// The pixel that was hit, which may lie beside the one asked for.
    pub(crate) pixel: [u32; 2],
    /// Value of the `id` target.
    pub(crate) id: u32,
    /// Name of the object.
    pub(crate) object: String,
    /// Number of the surfel in its object; none for a node of a level-of-detail structure.
    pub(crate) surfel: Option<u64>,
    /// Where the surface is there, world space.
    pub(crate) position_world: DVec3,
    /// Along the line of sight, scene units.
    pub(crate) eye_distance: f32,
    /// Everything, by name.
    pub(crate) columns: Vec<(String, String)>,
}

impl Facts {
    /// Which surfel of which object.
    pub(crate) fn title(&self) -> String {
        match self.surfel {
            Some(surfel) => format!("{}, surfel {surfel}", self.object),
            None => format!("{}, inner node", self.object),
        }
    }

    /// The most important in one line.
    pub(crate) fn line(&self) -> String {
        let mut parts = vec![
            self.title(),
            format!("position {}", vector(self.position_world)),
        ];
        for name in ["normal", "colour"] {
            let found = self.columns.iter().find(|(column, _)| column == name);
            parts.extend(found.map(|(_, value)| format!("{name} {value}")));
        }
        parts.push(format!("depth {}", number(f64::from(self.eye_distance))));
        parts.join("   ")
    }
}

/// What is at a pixel of a picture, or within `reach_px` of it. `None` if nothing is drawn there, the picture came
/// without ids and depths, or its object is gone.
pub(crate) fn facts_at(
    shown: &FrameResult,
    scene: &Scene,
    pixel: [u32; 2],
    reach_px: u32,
) -> Option<Facts> {
    let pick = shown.pick(pixel.map(i64::from), reach_px)?;
    let identified = shown.ids.resolve(pick.id)?;
    let object = scene.object(identified.object)?;
    let mut columns = vec![
        ("surface at".to_owned(), vector(pick.position_world)),
        ("depth".to_owned(), number(f64::from(pick.eye_distance))),
        ("id".to_owned(), pick.id.to_string()),
    ];
    columns.extend(columns_of(object, &identified));
    Some(Facts {
        pixel: pick.pixel,
        id: pick.id,
        object: object.name.clone(),
        surfel: identified.surfel_in_object,
        position_world: pick.position_world,
        eye_distance: pick.eye_distance,
        columns,
    })
}

/// Every column of a surfel; nothing for a structure's own nodes, whose columns the scene does not hold.
fn columns_of(object: &Object, identified: &Identified) -> Vec<(String, String)> {
    let blocks = &object.geometry.blocks;
    let block = blocks.get(identified.block as usize);
    let index = identified.surfel as usize;
    let block = block.filter(|block| index < block.len() && identified.source == IdSource::Scene);
    block.map_or_else(Vec::new, |block| columns_of_surfel(object, block, index))
}

fn columns_of_surfel(object: &Object, block: &Block, index: usize) -> Vec<(String, String)> {
    let centre = block.centre(index).as_dvec3();
    let centre_world = object.world_from_local().transform_point3(centre);
    let [.., radius] = block.position_radius[index];
    let mut rows = vec![
        ("centre".to_owned(), vector(centre_world)),
        ("radius".to_owned(), number(f64::from(radius))),
    ];
    let mut add = |name: &str, value: String| rows.push((name.to_owned(), value));
    if let Some(normal) = block.normal_at(index) {
        add("normal", vector(normal.as_dvec3()));
    }
    if let Some(bits) = block.colour.as_ref().and_then(|colours| colours.get(index)) {
        let [red, green, blue, alpha] = (decode_colour(*bits) * 255.0)
            .to_array()
            .map(|channel| channel.round() as u8);
        add(
            "colour",
            format!("#{red:02x}{green:02x}{blue:02x}, alpha {alpha}"),
        );
    }
    if let Some(axes) = block.axes.as_ref().and_then(|axes| axes.get(index)) {
        let half_axis = |first: usize| Vec3::new(axes[first], axes[first + 1], axes[first + 2]);
        add("axis u", vector(half_axis(0).as_dvec3()));
        add("axis v", vector(half_axis(4).as_dvec3()));
    }
    for column in &block.named {
        let values = (0..column.components).filter_map(|component| column.value(index, component));
        let texts: Vec<String> = values.map(number).collect();
        add(
            &format!("{} ({})", column.name, column.scalar.name()),
            texts.join(", "),
        );
    }
    rows
}

/// Values of every target that came with a picture, at a pixel.
pub(crate) fn target_values(shown: &FrameResult, [x, y]: [u32; 2]) -> Vec<(String, String)> {
    let index = y as usize * shown.picture.size_px[0] as usize + x as usize;
    let value = |plane: &Plane| match plane {
        Plane::Uint(values) => values.get(index).map(u32::to_string),
        Plane::Float { channels, values } => {
            let channels = *channels as usize;
            let of_pixel = values.get(index * channels..(index + 1) * channels)?;
            let texts: Vec<String> = of_pixel
                .iter()
                .map(|value| number(f64::from(*value)))
                .collect();
            Some(texts.join(", "))
        }
    };
    let planes = shown.planes.iter();
    planes
        .filter_map(|(key, plane)| Some((key.clone(), value(plane)?)))
        .collect()
}

fn vector(vector: DVec3) -> String {
    let [x, y, z] = vector.to_array().map(number);
    format!("{x}, {y}, {z}")
}

/// A number with seven significant digits, as many as a 32-bit float has, without trailing zeros.
fn number(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude != 0.0 && !(1e-4..1e15).contains(&magnitude) {
        return format!("{value:.4e}");
    }
    let before_point = if magnitude >= 1.0 {
        magnitude.log10() as usize + 1
    } else {
        1
    };
    let text = format!("{value:.*}", 7_usize.saturating_sub(before_point));
    without_trailing_zeros(&text).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::test_frames::frame_of_square;

    #[test]
    fn numbers_keep_what_a_float_holds() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (-0.25, "-0.25"),
            (1.234_567_89, "1.234568"),
            (512_345.678, "512345.7"),
            (5_123_456.78, "5123457"),
            (0.000_001_5, "1.5000e-6"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn the_line_names_surfel_position_normal_and_depth() {
        let (scene, shown) = frame_of_square(&["id", "depth"]);
        let [width, height] = shown.picture.size_px;
        let facts = facts_at(&shown, &scene, [width / 2, height / 2], 0).expect("the square");
        let line = facts.line();
        assert!(line.starts_with("square, surfel "), "{line}");
        assert!(line.contains("normal 0, 0, 1"), "{line}");
        assert!(line.contains("depth "), "{line}");
        // The square lies in the plane z = 0.
        assert!(facts.position_world.z.abs() < 1e-3, "{line}");
        let names: Vec<&str> = facts
            .columns
            .iter()
            .map(|(name, _)| name.as_str())
            .collect();
        assert!(
            names.contains(&"radius") && names.contains(&"centre"),
            "{names:?}"
        );
    }
}
