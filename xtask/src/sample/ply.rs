//! The surfels as binary PLY.

use super::surfels::Surfel;
use super::vector::Vector;
use crate::ply;

/// Four vectors of f32 (centre, normal, u, v) and three bytes of colour.
pub(super) const BYTES_PER_SURFEL: usize = 4 * 3 * 4 + 3;

/// The whole file.
pub(super) fn encode(surfels: &[Surfel]) -> Vec<u8> {
    let mut bytes = header(surfels.len()).into_bytes();
    bytes.reserve(surfels.len() * BYTES_PER_SURFEL);
    for surfel in surfels {
        push(&mut bytes, surfel.centre);
        push(&mut bytes, surfel.normal);
        bytes.extend(surfel.colour);
        push(&mut bytes, surfel.u);
        push(&mut bytes, surfel.v);
    }
    bytes
}

fn header(count: usize) -> String {
    let comments = [
        "Pointstage sample: a snake tied into a trefoil knot",
        "made by `cargo xtask sample`; MIT OR Apache-2.0",
        "ux..vz: tangent half-axes of elliptical surfels",
    ];
    let columns = [
        ("float", "x y z nx ny nz"),
        ("uchar", "red green blue"),
        ("float", "ux uy uz vx vy vz"),
    ];
    ply::header(&comments, count, &columns)
}

fn push(bytes: &mut Vec<u8>, vector: Vector) {
    for value in [vector.0, vector.1, vector.2] {
        bytes.extend((value as f32).to_le_bytes());
    }
}

/// The centre in one surfel's bytes.
#[cfg(test)]
pub(super) fn decode_centre(bytes: &[u8]) -> Vector {
    let value = |at: usize| {
        f64::from(f32::from_le_bytes([
            bytes[at],
            bytes[at + 1],
            bytes[at + 2],
            bytes[at + 3],
        ]))
    };
    Vector(value(0), value(4), value(8))
}
