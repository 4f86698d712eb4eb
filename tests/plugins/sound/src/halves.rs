//! A two-level structure: objects with an even number are drawn by nodes of the structure's own, each between two
//! surfels; objects with an odd number by every other of their surfels.

use pointstage_plugin_api::prelude::*;
use pointstage_plugin_api::{OwnBlock, Source};

/// Own surfels of one object.
struct Nodes {
    object: u32,
    position_radius: Vec<[f32; 4]>,
}

/// The structure.
pub struct Halves {
    nodes: Vec<Nodes>,
}

/// Its selector: nothing.
pub struct HalvesSelector;

impl Structure for Halves {
    type Selector = HalvesSelector;

    fn prepare(
        _: &Host,
        scene: Scene<'_>,
        _: Option<(&Self, Changes<'_>)>,
        _: Settings<'_>,
        progress: &Progress<'_>,
    ) -> Result<Self> {
        let mut nodes = Vec::new();
        for (number, object) in scene.objects().enumerate().filter(|(number, _)| number % 2 == 0) {
            progress.check()?;
            let pairs = object.blocks().flat_map(|block| block.position_radius().chunks(2));
            let position_radius = pairs.map(middle).collect();
            nodes.push(Nodes { object: number as u32, position_radius });
        }
        Ok(Self { nodes })
    }

    fn blocks(&self) -> Vec<OwnBlock<'_>> {
        let blocks = self.nodes.iter().map(|nodes| OwnBlock {
            object: nodes.object,
            position_radius: &nodes.position_radius,
            ..OwnBlock::default()
        });
        blocks.collect()
    }

    fn selector(&self, _: &Host) -> Result<HalvesSelector> {
        Ok(HalvesSelector)
    }
}

impl Selector<Halves> for HalvesSelector {
    fn select(&mut self, structure: &Halves, query: &Query<'_>) -> Result<Selection> {
        let mut selection = Selection::new();
        for (own, nodes) in structure.nodes.iter().enumerate() {
            let count = nodes.position_radius.len() as u32;
            selection.range(nodes.object, Source::Own(own as u32), 0..count, 0.0, 1.0);
        }
        for (number, object) in query.scene().objects().enumerate().filter(|(number, _)| number % 2 == 1) {
            for (block, surfels) in object.blocks().enumerate() {
                let every_other = (0..surfels.surfel_count()).step_by(2).collect();
                selection.surfels(number as u32, Source::Scene(block as u32), every_other, 1.0, 0.0);
            }
        }
        selection.report("nodes_visited", structure.nodes.len() as f64);
        Ok(selection)
    }
}

/// The surfel between two neighbours (or at the last one), with twice the greater radius.
fn middle(pair: &[[f32; 4]]) -> [f32; 4] {
    let [first, last] = [pair[0], pair[pair.len() - 1]];
    let between = |axis: usize| 0.5 * (first[axis] + last[axis]);
    [between(0), between(1), between(2), 2.0 * first[3].max(last[3])]
}
