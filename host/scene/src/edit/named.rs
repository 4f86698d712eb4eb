//! Named columns of several objects, united.

use std::sync::Arc;

use crate::geometry::{Block, NamedColumn, ScalarType};
use crate::scene::Object;

/// A column of the union, and where each object has it.
#[derive(Clone, Debug)]
pub(super) struct Union {
    pub(super) name: Arc<str>,
    pub(super) scalar: ScalarType,
    pub(super) components: u32,
    /// Its place among the named columns of each object; `None` for objects that lack it.
    places: Vec<Option<usize>>,
}

/// All named columns of the objects, each once, in the order in which they first appear. Where types differ, the union is
/// f64, which holds all of them; a column of the same name with another number of components is another column.
pub(super) fn unions(objects: &[&Object]) -> Vec<Union> {
    let mut unions: Vec<Union> = Vec::new();
    for (number, object) in objects.iter().enumerate() {
        let named = object.geometry.blocks.first();
        let named = named.map_or(&[][..], |block| block.named.as_slice());
        for (place, column) in named.iter().enumerate() {
            let own = unions.iter_mut().find(|union| {
                union.components == column.components
                    && union.is_named(&column.name)
                    && union.places[number].is_none()
            });
            if let Some(union) = own {
                if union.scalar != column.scalar {
                    union.scalar = ScalarType::F64;
                }
                union.places[number] = Some(place);
                continue;
            }
            let mut name = Arc::clone(&column.name);
            while unions.iter().any(|union| union.name == name) {
                name = format!("{name}_{}", column.components).into();
            }
            let mut places = vec![None; objects.len()];
            places[number] = Some(place);
            unions.push(Union {
                name,
                scalar: column.scalar,
                components: column.components,
                places,
            });
        }
    }
    unions
}

impl Union {
    fn is_named(&self, name: &str) -> bool {
        *self.name == *name
            || self
                .name
                .strip_suffix(&format!("_{}", self.components))
                .is_some_and(|stem| stem == name)
    }

    /// Appends a surfel of object `number`; zeros where the object has no such column.
    pub(super) fn push(&self, bytes: &mut Vec<u8>, number: usize, block: &Block, surfel: usize) {
        let width = self.scalar.size() * self.components as usize;
        let start = bytes.len();
        if let Some(column) = self.places[number].and_then(|place| block.named.get(place)) {
            self.push_values(bytes, column, surfel);
        }
        // Also for a column that is shorter than its block.
        bytes.resize(start + width, 0);
    }

    fn push_values(&self, bytes: &mut Vec<u8>, column: &NamedColumn, surfel: usize) {
        if column.scalar == self.scalar {
            let width = self.scalar.size() * self.components as usize;
            let values = column.bytes.get(surfel * width..(surfel + 1) * width);
            bytes.extend_from_slice(values.unwrap_or_default());
            return;
        }
        let values = (0..self.components).map_while(|component| column.value(surfel, component));
        bytes.extend(values.flat_map(f64::to_ne_bytes));
    }
}
