//! What the numbers in the `id` target mean.

use pointstage_scene::{Marks, Object, ObjectId, Scene};

/// One block's run of ids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Run {
    first_id: u32,
    count: u32,
    object: ObjectId,
    source: IdSource,
    block: u32,
    first_surfel: u64,
}

impl Run {
    /// Whether `next` has the ids and the surfels of the same object that follow.
    fn goes_on_with(&self, next: &Self) -> bool {
        self.object == next.object
            && self.source == next.source
            && self.first_id + self.count == next.first_id
            && self.first_surfel + u64::from(self.count) == next.first_surfel
    }
}

/// Whether a block is the scene's or a structure's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum IdSource {
    /// A block of the object itself.
    Scene,
    /// A block of the level-of-detail structure: its surfels are inner nodes.
    Structure,
}

/// What an id of the `id` target stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identified {
    /// The object.
    pub object: ObjectId,
    /// Whose block.
    pub source: IdSource,
    /// The block's number.
    pub block: u32,
    /// The surfel's number in the block.
    pub surfel: u32,
    /// The surfel's number in the object, for blocks of the scene.
    pub surfel_in_object: Option<u64>,
}

/// The frame's table from ids to surfels. Id 0 is 'nothing'.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct IdTable {
    runs: Vec<Run>,
}

impl IdTable {
    /// The id of the block's first surfel. A block that is drawn several times keeps its ids.
    ///
    /// When 2³² ids are used up, further blocks get 0, 'nothing'.
    pub(super) fn base(
        &mut self,
        object: ObjectId,
        source: IdSource,
        block: u32,
        first_surfel: u64,
        count: u32,
    ) -> u32 {
        let known = |run: &&Run| run.object == object && run.source == source && run.block == block;
        if let Some(run) = self.runs.iter().find(known) {
            return run.first_id;
        }
        let next = self
            .runs
            .last()
            .map_or(Some(1), |run| run.first_id.checked_add(run.count));
        let Some(first_id) = next.filter(|next| next.checked_add(count).is_some()) else {
            return 0;
        };
        self.runs.push(Run {
            first_id,
            count,
            object,
            source,
            block,
            first_surfel,
        });
        first_id
    }

    /// The ids of the surfels that are marked in a scene. Nodes of a structure stand for many surfels and are none.
    pub(super) fn marked<'s>(&self, scene: &'s Scene) -> MarkedIds<'s> {
        let mut found: Vec<(Run, &Marks)> = Vec::new();
        let own = self.runs.iter().filter(|run| run.source == IdSource::Scene);
        for run in own {
            let marks = scene.object(run.object).and_then(Object::marked);
            let Some(marks) = marks else { continue };
            // The blocks of an object mostly follow each other: one run then, so that there is little to search at each pixel.
            match found.last_mut() {
                Some((last, _)) if last.goes_on_with(run) => last.count += run.count,
                _ => found.push((*run, marks)),
            }
        }
        MarkedIds(found)
    }

    /// What an id stands for; `None` for 0 and for ids that no draw of the frame has.
    pub fn resolve(&self, id: u32) -> Option<Identified> {
        let after = self.runs.partition_point(|run| run.first_id <= id);
        let run = self.runs.get(after.checked_sub(1)?)?;
        let surfel = id - run.first_id;
        let Run {
            object,
            source,
            block,
            first_surfel,
            count,
            ..
        } = *run;
        (surfel < count).then(|| Identified {
            object,
            source,
            block,
            surfel,
            surfel_in_object: (source == IdSource::Scene)
                .then_some(first_surfel + u64::from(surfel)),
        })
    }
}

/// Ids of marked surfels.
pub(super) struct MarkedIds<'s>(Vec<(Run, &'s Marks)>);

impl MarkedIds<'_> {
    /// Whether the surfel of this id is marked.
    pub(super) fn contains(&self, id: u32) -> bool {
        let after = self.0.partition_point(|(run, _)| run.first_id <= id);
        let Some((run, marks)) = after.checked_sub(1).and_then(|index| self.0.get(index)) else {
            return false;
        };
        let surfel = id - run.first_id;
        let in_object = usize::try_from(run.first_surfel + u64::from(surfel));
        surfel < run.count && in_object.is_ok_and(|surfel| marks.contains(surfel))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_scene::{Block, Geometry, Origins};
    use std::sync::Arc;

    #[test]
    fn ids_are_marked_as_their_surfels_are() {
        let object = |count: usize| {
            let block = Block {
                position_radius: vec![[0.0; 4]; count].into(),
                ..Block::default()
            };
            let geometry = Geometry::new(vec![block], None, Origins::default());
            Object::new("", glam::DVec3::ZERO, geometry)
        };
        let mut scene = Scene::new();
        let (plain, marked) = (scene.add(object(3)), scene.add(object(9)));
        let marks = Marks::from_fn(9, |surfel| surfel == 1 || surfel == 6);
        scene.set_marks(marked, Some(Arc::new(marks)));
        let mut table = IdTable::default();
        table.base(plain, IdSource::Scene, 0, 0, 3);
        table.base(marked, IdSource::Scene, 0, 0, 5);
        table.base(marked, IdSource::Structure, 0, 0, 5);
        table.base(marked, IdSource::Scene, 1, 5, 4);
        let ids = table.marked(&scene);
        assert_eq!(ids.0.len(), 2);
        let found: Vec<u32> = (0..40).filter(|&id| ids.contains(id)).collect();
        assert_eq!(
            found,
            [5, 15],
            "surfel 1 of the first block, 6 of the second"
        );
        assert!(!ids.contains(u32::MAX));
        // Blocks that follow each other are searched as one.
        let mut table = IdTable::default();
        table.base(plain, IdSource::Scene, 0, 0, 3);
        table.base(marked, IdSource::Scene, 0, 0, 5);
        table.base(marked, IdSource::Scene, 1, 5, 4);
        let ids = table.marked(&scene);
        assert_eq!(ids.0.len(), 1);
        let found: Vec<u32> = (0..40).filter(|&id| ids.contains(id)).collect();
        assert_eq!(found, [5, 10]);
    }

    #[test]
    fn ids_resolve_to_their_block_and_surfel() {
        let mut table = IdTable::default();
        let (a, b) = (ObjectId(7), ObjectId(8));
        assert_eq!(table.base(a, IdSource::Scene, 0, 0, 10), 1);
        assert_eq!(table.base(a, IdSource::Scene, 1, 10, 5), 11);
        assert_eq!(table.base(b, IdSource::Structure, 0, 0, 3), 16);
        assert_eq!(
            table.base(a, IdSource::Scene, 1, 10, 5),
            11,
            "a block keeps its ids"
        );
        let found = table.resolve(12).unwrap();
        assert_eq!(
            (
                found.object,
                found.block,
                found.surfel,
                found.surfel_in_object
            ),
            (a, 1, 1, Some(11))
        );
        let node = table.resolve(18).unwrap();
        assert_eq!(
            (node.object, node.source, node.surfel, node.surfel_in_object),
            (b, IdSource::Structure, 2, None)
        );
        assert_eq!(
            (table.resolve(0), table.resolve(19), table.resolve(u32::MAX)),
            (None, None, None)
        );
    }

    #[test]
    fn ids_that_do_not_fit_are_nothing() {
        let mut table = IdTable::default();
        table.base(ObjectId(1), IdSource::Scene, 0, 0, u32::MAX - 10);
        assert_eq!(table.base(ObjectId(1), IdSource::Scene, 1, 0, 100), 0);
    }
}
