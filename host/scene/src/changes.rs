//! What differs between two states of a scene.

use std::collections::BTreeSet;

use pointstage_plugin_api::columns;

use crate::geometry::{Block, Geometry};
use crate::scene::{Object, ObjectId, Scene};

/// Differences from an earlier scene to a later one, in the later one's order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes {
    /// Objects that the earlier scene did not have.
    pub added: Vec<ObjectId>,
    /// Objects that the later scene does not have, in the earlier one's order.
    pub removed: Vec<ObjectId>,
    /// Objects in both, with differences.
    pub changed: Vec<ObjectChange>,
}

/// Differences of one object.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectChange {
    /// Which object.
    pub id: ObjectId,
    /// Its origin or transform differs.
    pub moved: bool,
    /// Its material or its radius scale differs.
    pub material: bool,
    /// Its visibility or selection differs.
    pub flags: bool,
    /// Columns that differ, sorted by name.
    pub columns: Vec<ColumnChange>,
}

/// Difference of one column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnChange {
    /// Name of the column: one of `pointstage_plugin_api::columns`, or a named column's.
    pub name: String,
    /// In what way.
    pub kind: ColumnChangeKind,
}

/// In what way a column differs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnChangeKind {
    /// It was not there.
    Added,
    /// It is no longer there.
    Removed,
    /// Its values differ.
    Changed,
}

impl Changes {
    /// What came to pass from `earlier` to `later`.
    pub fn between(earlier: &Scene, later: &Scene) -> Self {
        if earlier.revision() == later.revision() {
            return Self::default();
        }
        let ids_without = |of: &Scene, without: &Scene| -> Vec<ObjectId> {
            of.objects()
                .iter()
                .map(|object| object.id)
                .filter(|&id| without.object(id).is_none())
                .collect()
        };
        Self {
            added: ids_without(later, earlier),
            removed: ids_without(earlier, later),
            changed: later
                .objects()
                .iter()
                .filter_map(|now| ObjectChange::between(earlier.object(now.id)?, now))
                .collect(),
        }
    }

    /// True when nothing differs that a renderer could see.
    pub fn is_empty(&self) -> bool {
        self.added.is_empty() && self.removed.is_empty() && self.changed.is_empty()
    }
}

impl ObjectChange {
    fn between(earlier: &Object, later: &Object) -> Option<Self> {
        if earlier.revision == later.revision {
            return None;
        }
        let change = Self {
            id: later.id,
            moved: earlier.origin != later.origin
                || earlier.world_from_object != later.world_from_object,
            material: earlier.material != later.material
                || earlier.radius_scale != later.radius_scale,
            flags: (earlier.visible, earlier.selected) != (later.visible, later.selected),
            columns: column_changes(&earlier.geometry, &later.geometry),
        };
        let nothing =
            !change.moved && !change.material && !change.flags && change.columns.is_empty();
        (!nothing).then_some(change)
    }
}

fn column_changes(earlier: &Geometry, later: &Geometry) -> Vec<ColumnChange> {
    if earlier.revision == later.revision {
        return Vec::new();
    }
    let names: BTreeSet<String> = column_names(earlier).chain(column_names(later)).collect();
    let difference = |name: String| {
        let kind = match (column_parts(earlier, &name), column_parts(later, &name)) {
            (None, None) => return None,
            (None, Some(_)) => ColumnChangeKind::Added,
            (Some(_), None) => ColumnChangeKind::Removed,
            (Some(before), Some(after)) if before == after => return None,
            (Some(_), Some(_)) => ColumnChangeKind::Changed,
        };
        Some(ColumnChange { name, kind })
    };
    names.into_iter().filter_map(difference).collect()
}

fn column_names(geometry: &Geometry) -> impl Iterator<Item = String> {
    let own = [
        columns::POSITION_RADIUS,
        columns::NORMAL,
        columns::COLOUR,
        columns::AXES,
        columns::TRIANGLES,
    ];
    let textures = [
        columns::TRIANGLE_TEXTURES,
        columns::TRIANGLE_UVS,
        columns::TEXTURE_FILE,
    ];
    let named = geometry
        .blocks
        .first()
        .into_iter()
        .flat_map(|block| &block.named)
        .map(|column| column.name.to_string());
    let own = own.into_iter().chain(textures);
    own.map(String::from).chain(named)
}

/// Address and length of a column in each block: columns are immutable once shared, so equal parts are equal values.
/// `None` if the geometry has no such column.
fn column_parts(geometry: &Geometry, name: &str) -> Option<Vec<(usize, usize)>> {
    fn part<T>(column: &[T]) -> (usize, usize) {
        (column.as_ptr().addr(), column.len())
    }
    if name == columns::TRIANGLES {
        return geometry
            .triangles
            .as_ref()
            .map(|triangles| vec![part(triangles)]);
    }
    let textures = geometry.textures.as_ref();
    match name {
        columns::TRIANGLE_TEXTURES => return Some(vec![part(&textures?.of_triangle)]),
        columns::TRIANGLE_UVS => return Some(vec![part(&textures?.uvs)]),
        columns::TEXTURE_FILE => {
            let files = textures?.pictures.iter();
            return Some(files.map(|file| part(&file.bytes)).collect());
        }
        _ => {}
    }
    let of_block = |block: &Block| match name {
        columns::POSITION_RADIUS => Some(part(&block.position_radius)),
        columns::NORMAL => block.normal.as_deref().map(part),
        columns::COLOUR => block.colour.as_deref().map(part),
        columns::AXES => block.axes.as_deref().map(part),
        _ => block
            .named
            .iter()
            .find(|column| &*column.name == name)
            .map(|column| part(&column.bytes)),
    };
    if geometry.blocks.is_empty() {
        None
    } else {
        geometry.blocks.iter().map(of_block).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::geometry::Origins;
    use glam::{DAffine3, DVec3};

    fn scene_of_one() -> (Scene, ObjectId) {
        let block = Block {
            position_radius: Arc::from([[0.0, 0.0, 0.0, 1.0]]),
            colour: Some(Arc::from([7_u32])),
            ..Block::default()
        };
        let mut scene = Scene::new();
        let id = scene.add(Object::new(
            "one",
            DVec3::ZERO,
            Geometry::new(vec![block], None, Origins::default()),
        ));
        (scene, id)
    }

    #[test]
    fn a_copy_has_no_changes() {
        let (scene, _) = scene_of_one();
        assert!(Changes::between(&scene, &scene.clone()).is_empty());
    }

    #[test]
    fn added_and_removed_objects_are_told_apart() {
        let (scene, id) = scene_of_one();
        assert_eq!(Changes::between(&Scene::new(), &scene).added, [id]);
        assert_eq!(Changes::between(&scene, &Scene::new()).removed, [id]);
    }

    #[test]
    fn a_move_is_a_move_and_nothing_else() {
        let (earlier, id) = scene_of_one();
        let mut later = earlier.clone();
        later.edit(id, |object| {
            object.world_from_object = DAffine3::from_translation(DVec3::X);
        });
        let changes = Changes::between(&earlier, &later);
        let expected = ObjectChange {
            id,
            moved: true,
            material: false,
            flags: false,
            columns: Vec::new(),
        };
        assert_eq!(changes.changed, [expected]);
    }

    #[test]
    fn columns_are_compared_one_by_one() {
        let (earlier, id) = scene_of_one();
        let mut later = earlier.clone();
        later.edit(id, |object| {
            let geometry = Arc::make_mut(&mut object.geometry);
            geometry.blocks[0].normal = Some(Arc::from([0_u32]));
            geometry.blocks[0].colour = None;
            geometry.touch();
        });
        let change = |name: &str, kind| ColumnChange {
            name: name.into(),
            kind,
        };
        let changes = Changes::between(&earlier, &later);
        let expected = [
            change("colour", ColumnChangeKind::Removed),
            change("normal", ColumnChangeKind::Added),
        ];
        assert_eq!(changes.changed[0].columns, expected);
    }

    #[test]
    fn an_edit_that_changes_nothing_visible_is_no_change() {
        let (earlier, id) = scene_of_one();
        let mut later = earlier.clone();
        later.edit(id, |object| object.name = "renamed".into());
        assert!(Changes::between(&earlier, &later).is_empty());
    }
}
