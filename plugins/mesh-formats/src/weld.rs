//! One vertex for all corners at one place.
//!
//! A mesh whose facets name no vertices is welded in pieces, each in tables that fit into a core's cache, by several threads; then the
//! vertices of the pieces are welded. Vertices stand in the order in which the file has them first, however it is cut.

use std::hash::{BuildHasher as _, Hasher as _, RandomState};

/// No vertex is in the slot.
const EMPTY: u32 = u32::MAX;

/// Vertices that are looked up at once; a core waits for no more of them.
const LOOKED_UP: usize = 32;

/// Vertices at different places, and which corner is which of them.
pub(crate) struct Welder {
    positions: Vec<[f32; 3]>,
    /// Indices of vertices: each stands in the first slot free from that of its hash on. A power of two, a quarter of them free.
    slots: Vec<u32>,
    /// Of its own each time, so that nobody can write a file of which all vertices fall into one slot.
    seed: u64,
}

impl Welder {
    /// One with room for some vertices.
    pub(crate) fn new(expected: usize) -> Self {
        Self {
            positions: Vec::with_capacity(expected),
            slots: vec![EMPTY; (expected / 3 * 4).next_power_of_two().max(16)],
            seed: RandomState::new().build_hasher().finish(),
        }
    }

    /// The vertex at a place; a new one if there is none. 0 and −0 are one place.
    #[inline]
    pub(crate) fn add(&mut self, place: [f32; 3]) -> u32 {
        // −0 + 0 is 0.
        let place = place.map(|value| value + 0.0);
        let bits = place.map(f32::to_bits);
        let mut slot = self.slot(bits);
        loop {
            let vertex = self.slots[slot];
            let Some(known) = self.positions.get(vertex as usize) else {
                return self.insert(slot, place);
            };
            if known.map(f32::to_bits) == bits {
                return vertex;
            }
            slot = (slot + 1) & (self.slots.len() - 1);
        }
    }

    fn insert(&mut self, slot: usize, place: [f32; 3]) -> u32 {
        let vertex = self.positions.len() as u32;
        self.slots[slot] = vertex;
        self.positions.push(place);
        if 4 * self.positions.len() > 3 * self.slots.len() {
            self.grow();
        }
        vertex
    }

    #[cold]
    fn grow(&mut self) {
        self.slots = vec![EMPTY; 2 * self.slots.len()];
        for (vertex, place) in (0..).zip(&self.positions) {
            let mut slot = self.slot(place.map(f32::to_bits));
            while self.slots[slot] != EMPTY {
                slot = (slot + 1) & (self.slots.len() - 1);
            }
            self.slots[slot] = vertex;
        }
    }

    /// Where a place's vertex stands, or behind it: both halves of a product of 128 bits, as in wyhash.
    #[inline]
    fn slot(&self, [x, y, z]: [u32; 3]) -> usize {
        let first = (u64::from(x) | u64::from(y) << 32) ^ self.seed;
        let second = u64::from(z) ^ 0x9e37_79b9_7f4a_7c15;
        let product = u128::from(first) * u128::from(second);
        let hash = product as u64 ^ (product >> 64) as u64;
        hash as usize & (self.slots.len() - 1)
    }

    /// How many vertices there are.
    pub(crate) fn len(&self) -> usize {
        self.positions.len()
    }

    /// The vertices.
    pub(crate) fn into_positions(self) -> Vec<[f32; 3]> {
        self.positions
    }

    /// Adds another's vertices; which of these each of them is.
    pub(crate) fn add_all(&mut self, other: &Self) -> Vec<u32> {
        let mut vertices = Vec::with_capacity(other.positions.len());
        for some in other.positions.chunks(LOOKED_UP) {
            // A large table is in no cache. What does not wait for one another comes from memory together.
            let known = some.iter().map(|place| {
                let slot = self.slots[self.slot(place.map(f32::to_bits))];
                let place = self.positions.get(slot as usize);
                place.map_or(0, |place| place[0].to_bits())
            });
            std::hint::black_box(known.fold(0, |all, bits| all ^ bits));
            vertices.extend(some.iter().map(|place| self.add(*place)));
        }
        vertices
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_stand_in_the_order_of_their_first_corner() {
        let place = |index: u32| {
            let number = index.wrapping_mul(7919) % 10_007;
            [number as f32, 0.0, -1.5]
        };
        let mut whole = Welder::new(4);
        let mut first_in_order: Vec<[f32; 3]> = Vec::new();
        for index in 0..30_000 {
            let vertex = whole.add(place(index)) as usize;
            if vertex == first_in_order.len() {
                first_in_order.push(place(index));
            }
            assert_eq!(first_in_order[vertex], place(index));
        }
        assert_eq!((whole.len(), first_in_order.len()), (10_007, 10_007));
        // The same in pieces.
        let mut welded = Welder::new(0);
        for start in (0..30_000).step_by(700) {
            let mut piece = Welder::new(0);
            let corners: Vec<u32> = (start..30_000.min(start + 700))
                .map(|index| piece.add(place(index)))
                .collect();
            let vertices = welded.add_all(&piece);
            for (index, corner) in (start..).zip(corners) {
                let vertex = vertices[corner as usize] as usize;
                assert_eq!(first_in_order[vertex], place(index));
            }
        }
        assert_eq!(welded.into_positions(), first_in_order);
    }

    #[test]
    fn zeros_are_one_place_and_so_is_nan() {
        let mut welder = Welder::new(0);
        for place in [[0.0; 3], [-0.0, 0.0, -0.0]] {
            assert_eq!(welder.add(place), 0);
        }
        for _ in 0..2 {
            assert_eq!(welder.add([f32::NAN, 0.0, 0.0]), 1);
        }
    }
}
