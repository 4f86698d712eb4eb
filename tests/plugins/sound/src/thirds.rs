//! A structure that selects every third surfel: of the first object by numbers that the host uploads, of the others by
//! numbers in buffers of its own, with the count in a buffer, too.

use pointstage_plugin_api::Source;
use pointstage_plugin_api::abi::BufferUsage;
use pointstage_plugin_api::gpu::Buffer;
use pointstage_plugin_api::prelude::*;

/// Selected surfels of one object.
struct OnDevice {
    object: u32,
    /// Every third number, then numbers that are not selected.
    numbers: Buffer,
    /// Numbers in the buffer, at most.
    count: u32,
}

/// The structure.
pub struct Thirds {
    /// Numbers of the first object.
    first: Vec<u32>,
    others: Vec<OnDevice>,
    /// For each of the others, two words: one that means nothing, and the count.
    counts: Buffer,
}

/// Its selector: nothing.
pub struct ThirdsSelector;

fn is_selected(number: &u32) -> bool {
    number.is_multiple_of(3)
}

impl Structure for Thirds {
    type Selector = ThirdsSelector;

    fn prepare(
        host: &Host,
        scene: Scene<'_>,
        _: Option<(&Self, Changes<'_>)>,
        _: Settings<'_>,
        _: &Progress<'_>,
    ) -> Result<Self> {
        let gpu = host.gpu()?;
        let (mut first, mut others, mut counts) = (Vec::new(), Vec::new(), Vec::new());
        for (object, surfels) in (0..).zip(scene.objects()) {
            let count = surfels.blocks().next().map_or(0, |block| block.surfel_count());
            let (mut numbers, rest): (Vec<u32>, Vec<u32>) = (0..count).partition(is_selected);
            if object == 0 {
                first = numbers;
                continue;
            }
            counts.extend([u32::MAX, numbers.len() as u32]);
            numbers.extend(rest);
            let numbers = gpu.buffer_with("thirds", BufferUsage::STORAGE, &numbers)?;
            others.push(OnDevice { object, numbers, count });
        }
        counts.resize(counts.len().max(2), 0);
        let counts = gpu.buffer_with("counts of thirds", BufferUsage::STORAGE, &counts)?;
        Ok(Self { first, others, counts })
    }

    fn selector(&self, _: &Host) -> Result<ThirdsSelector> {
        Ok(ThirdsSelector)
    }
}

impl Selector<Thirds> for ThirdsSelector {
    fn select(&mut self, structure: &Thirds, _: &Query<'_>) -> Result<Selection> {
        let mut selection = Selection::new();
        selection.surfels(0, Source::Scene(0), structure.first.clone(), 0.0, 0.0);
        for (place, other) in (0..).zip(&structure.others) {
            let count_bytes = place * 8 + 4;
            let counter = Some((&structure.counts, count_bytes));
            selection.surfels_on_device(other.object, Source::Scene(0), &other.numbers, other.count, counter);
        }
        selection.report("nodes_visited", structure.others.len() as f64 + 1.0);
        Ok(selection)
    }
}
