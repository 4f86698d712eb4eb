//! The frame's camera, as cuts need it.

use crate::part::Part;
use crate::settings::{Culling, Wanted};
use pointstage_plugin_api::FrameUniform;
use pointstage_plugin_api::glam::{Mat4, Vec3};
use pointstage_pop_tree::cut::{Projection, View as CutView};

/// The camera, as a cut needs it.
pub(crate) fn projection_of(
    uniform: &FrameUniform,
    view_from_object: &[[f32; 4]; 4],
    wanted: &Wanted,
) -> Projection {
    Projection {
        view_from_object: Mat4::from_cols_array_2d(view_from_object),
        clip_from_view: Mat4::from_cols_array_2d(&uniform.clip_from_view),
        size_px: uniform.tile_size_px,
        pixels_per_unit: uniform.pixels_per_unit,
        is_orthographic: uniform.is_orthographic != 0,
        threshold_px: wanted.threshold_px,
        cull_backs: false,
        is_inward: false,
    }
}

/// The view of a part's tree, with or without culling.
pub(crate) fn culling_view(
    projection: &Projection,
    part: &Part,
    culling: Culling,
    two_sided: bool,
) -> CutView {
    let view = CutView::new(projection, &part.tree.grid);
    let culls = match culling {
        Culling::On => true,
        Culling::Off => false,
        Culling::Auto => part.surface.is_closed && is_outside(&view, part),
    };
    if !culls || two_sided {
        return view;
    }
    let projection = Projection {
        cull_backs: true,
        is_inward: part.surface.is_inward,
        ..*projection
    };
    CutView::new(&projection, &part.tree.grid)
}

/// Whether the eye, and with it the near plane, is well outside the tree's root.
pub(crate) fn is_outside(view: &CutView, part: &Part) -> bool {
    let Some(root) = part.tree.nodes.first() else {
        return false;
    };
    let projection = view.projection();
    let centre = projection
        .view_from_object
        .transform_point3(part.tree.grid.position(root.place()));
    let clip =
        projection.clip_from_view * (centre + Vec3::Z * root.radius() * view.stretch()).extend(1.0);
    // Reversed depth: before the near plane z exceeds w.
    clip.z < clip.w && (projection.is_orthographic || clip.w > 0.0)
}
