//! What faces add up to at each vertex, and how it becomes columns.

use std::sync::Arc;

use glam::Vec3;
use pointstage_plugin_api::columns::{MAX_BLOCK_SURFELS, NO_NORMAL, encode_normal};
use rayon::prelude::*;

use crate::geometry::{Block, Geometry, Provenance};
use crate::load::memory::zeroed_slice;

/// What the triangles add up to at one vertex: sum of unit normals, and the largest squared radius; in scaled units.
pub(super) type Sum = [f32; 4];

/// Puts the sums where the geometry has nothing.
pub(super) fn write(geometry: &mut Geometry, sums: &[Sum], unscale: f32) {
    let Geometry {
        blocks, origins, ..
    } = geometry;
    for (block, sums) in blocks.iter_mut().zip(sums.chunks(MAX_BLOCK_SURFELS)) {
        write_normals(block, sums);
        let slots = Arc::make_mut(&mut block.position_radius);
        slots
            .par_iter_mut()
            .zip(sums)
            .with_min_len(1 << 14)
            .for_each(|(slot, sum)| {
                if slot[3] <= 0.0 {
                    slot[3] = sum[3].sqrt() * unscale;
                }
            });
    }
    for provenance in [&mut origins.normals, &mut origins.radii] {
        if *provenance == Provenance::Missing {
            *provenance = Provenance::FromFaces;
        }
    }
}

fn write_normals(block: &mut Block, sums: &[Sum]) {
    let packed = |&[x, y, z, _]: &Sum| {
        let sum = Vec3::new(x, y, z);
        if sum == Vec3::ZERO {
            NO_NORMAL
        } else {
            encode_normal(sum)
        }
    };
    match &mut block.normal {
        Some(normals) if normals.contains(&NO_NORMAL) => {
            for (normal, sum) in Arc::make_mut(normals).iter_mut().zip(sums) {
                if *normal == NO_NORMAL {
                    *normal = packed(sum);
                }
            }
        }
        Some(_) => {}
        None => {
            let mut normals: Arc<[u32]> = zeroed_slice(sums.len());
            let slots = Arc::get_mut(&mut normals).expect("just made, nobody else has it");
            slots
                .par_iter_mut()
                .zip(sums)
                .with_min_len(1 << 14)
                .for_each(|(slot, sum)| *slot = packed(sum));
            block.normal = Some(normals);
        }
    }
}
