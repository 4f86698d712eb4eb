//! One pixel a surfel, nearest wins, on the CPU.

use pointstage_plugin_api::glam::{Mat4, Vec3, Vec4};
use pointstage_plugin_api::{columns, prelude::*};

/// The renderer: it keeps one costly setting.
pub struct Dots {
    invert: bool,
}

/// Its view: nothing.
pub struct DotsView;

impl Renderer for Dots {
    type View = DotsView;

    fn prepare(
        host: &Host,
        _: Scene<'_>,
        previous: Option<(&Self, Changes<'_>)>,
        settings: Settings<'_>,
        progress: &Progress<'_>,
    ) -> Result<Self> {
        progress.set(0.5, "thinking");
        progress.check()?;
        host.info(if previous.is_some() { "prepared again" } else { "prepared" });
        Ok(Self { invert: settings.bool("invert")? })
    }

    fn view(&self, _: &Host) -> Result<DotsView> {
        Ok(DotsView)
    }
}

impl View<Dots> for DotsView {
    fn render(&mut self, prepared: &Dots, frame: &mut Frame<'_>) -> Result<Outcome> {
        let (Some(mut colour), Some(mut depth)) = (frame.take_plane("colour"), frame.take_plane("depth")) else {
            return Err("the host lends no colour or depth plane".into());
        };
        let mut id = frame.take_plane("id");
        let brightness = frame.settings().float("brightness")?;
        let mut colour: Vec<_> = colour.rows::<[f32; 4]>().collect();
        let mut depth: Vec<_> = depth.rows::<f32>().collect();
        let mut id: Vec<_> = id.as_mut().map(|plane| plane.rows::<u32>().collect()).unwrap_or_default();
        let [width, height] = frame.size_px().map(|size| size as f32);
        let clip_from_view = Mat4::from_cols_array_2d(&frame.uniform().clip_from_view);
        let mut drawn = 0;
        for draw in frame.selection() {
            let clip_from_object = clip_from_view * Mat4::from_cols_array_2d(&draw.uniform().view_from_object);
            let (positions, colours) = (draw.block().position_radius(), draw.block().colours());
            for surfel in draw.surfels() {
                let [x, y, z, _] = positions[surfel as usize];
                let clip: Vec4 = clip_from_object * Vec3::new(x, y, z).extend(1.0);
                let ndc = clip.truncate() / clip.w;
                let (column, row) = ((ndc.x * 0.5 + 0.5) * width, (0.5 - ndc.y * 0.5) * height);
                if !(clip.w > 0.0 && column >= 0.0 && column < width && row >= 0.0 && row < height) {
                    continue; // behind the eye, outside, or NaN
                }
                let (column, row) = (column as usize, row as usize);
                if ndc.z > depth[row][column] {
                    let albedo = colours.map_or(Vec4::splat(0.5), |c| columns::decode_colour_linear(c[surfel as usize]));
                    let albedo = albedo.truncate() * brightness;
                    let albedo = if prepared.invert { Vec3::ONE - albedo } else { albedo };
                    depth[row][column] = ndc.z;
                    colour[row][column] = albedo.extend(1.0).to_array();
                    if let Some(row) = id.get_mut(row) {
                        row[column] = draw.uniform().id_base + surfel;
                    }
                    drawn += 1;
                }
            }
        }
        frame.report("splats_drawn", f64::from(drawn));
        Ok(Outcome::Done)
    }
}
