use super::*;
use crate::load::{Contents, Estimation, LoadOptions, ObjectBuilder};
use bytemuck::cast_slice;
use glam::DVec3;
use pointstage_plugin_api::columns::MAX_BLOCK_SURFELS;

/// Whether the scale is given before the first rows, so that they can go to the blocks at once, or only after them.
#[derive(Clone, Copy, Debug)]
enum Way {
    InPlace,
    Gathered,
}

/// Surfels of a file, and how they are handed over.
struct File {
    numbers: Vec<[i32; 3]>,
    scale: PositionScale,
    colour_components: u32,
    announced: u64,
    run: usize,
}

impl File {
    fn load(&self, way: Way) -> Result<Contents, String> {
        let components = self.colour_components;
        let mut specs = vec![
            ColumnSpec::named("intensity", ScalarType::U16, 1),
            ColumnSpec::new(ColumnRole::Position, ScalarType::I32, 3),
        ];
        if components > 0 {
            let colour = ColumnSpec::new(ColumnRole::Colour, ScalarType::U8, components);
            specs.push(colour);
        }
        let mut builder = ObjectBuilder::new(specs).map_err(|error| error.to_string())?;
        let scale = |builder: &mut ObjectBuilder| builder.scale_positions(self.scale);
        if matches!(way, Way::InPlace) {
            scale(&mut builder).expect("whole numbers");
        }
        builder.reserve(self.announced, 1 << 20);
        for (run, numbers) in self.numbers.chunks(self.run).enumerate() {
            let first = run * self.run;
            let rows = first..first + numbers.len();
            let intensity: Vec<u16> = rows.clone().map(|row| row as u16).collect();
            let bytes = rows.start * components as usize..rows.end * components as usize;
            let colour: Vec<u8> = bytes.map(|byte| (byte * 37 % 251) as u8).collect();
            let columns: [&[u8]; 3] = [cast_slice(&intensity), cast_slice(numbers), &colour];
            let columns = &columns[..if components > 0 { 3 } else { 2 }];
            builder
                .add_rows(numbers.len(), columns)
                .map_err(|error| error.to_string())?;
        }
        if matches!(way, Way::Gathered) {
            scale(&mut builder).expect("whole numbers");
        }
        let options = LoadOptions {
            estimation: Estimation::FileOnly,
            ..LoadOptions::default()
        };
        builder
            .finish(&options, &Job::new())
            .map_err(|error| format!("{error:?}"))
    }

    /// Loads in both ways and compares; says how many surfels came of it.
    fn compare(&self) -> Option<usize> {
        let case = format!(
            "{} rows in runs of {}, {} announced, {:?}, colours of {}",
            self.numbers.len(),
            self.run,
            self.announced,
            self.scale,
            self.colour_components
        );
        let (in_place, gathered) = match (self.load(Way::InPlace), self.load(Way::Gathered)) {
            (Ok(in_place), Ok(gathered)) => (in_place, gathered),
            (in_place, gathered) => {
                assert_eq!(in_place.err(), gathered.err(), "{case}");
                return None;
            }
        };
        let bits = |vector: DVec3| vector.to_array().map(f64::to_bits);
        assert_eq!(bits(in_place.origin), bits(gathered.origin), "{case}");
        let warnings = |contents: &Contents| format!("{:?}", contents.warnings);
        assert_eq!(warnings(&in_place), warnings(&gathered), "{case}");
        let (in_place, gathered) = (in_place.geometry, gathered.geometry);
        assert_eq!(in_place.bounds, gathered.bounds, "{case}");
        assert_eq!(in_place.origins, gathered.origins, "{case}");
        assert_eq!(in_place.surfel_count, gathered.surfel_count, "{case}");
        assert_eq!(in_place.blocks.len(), gathered.blocks.len(), "{case}");
        for (one, other) in in_place.blocks.iter().zip(&gathered.blocks) {
            let bits = |block: &Block| -> Vec<[u32; 4]> {
                let positions = block.position_radius.iter();
                positions.map(|slot| slot.map(f32::to_bits)).collect()
            };
            assert!(bits(one) == bits(other), "{case}");
            assert!(one.colour == other.colour, "{case}");
            assert!(one.named == other.named, "{case}");
            assert_eq!(one.colour.is_some(), self.colour_components > 0, "{case}");
        }
        Some(in_place.surfel_count)
    }
}

/// Numbers that look drawn by chance, the same at each call: every bit of them, or only the last ones.
fn numbers(rows: usize, bits: u32) -> Vec<[i32; 3]> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64 ^ rows as u64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state as i32) >> (32 - bits)
    };
    (0..rows).map(|_| std::array::from_fn(|_| next())).collect()
}

fn scaled(scale: [f64; 3], offset: [f64; 3]) -> PositionScale {
    PositionScale {
        scale: scale.into(),
        offset: offset.into(),
    }
}

const OF_A_MAP: [[f64; 3]; 2] = [[0.001, -0.01, 0.25], [4_900_000.0, 12.5, -3.0]];

#[test]
fn both_ways_give_the_same_object_however_it_is_handed_over() {
    let [scale, offset] = OF_A_MAP;
    for (rows, run) in [
        (1, 1),
        (700, 511),
        (1500, 1),
        (40_003, 33_333),
        (99_999, 99_999),
    ] {
        let exact = rows as u64;
        for announced in [0, 1, exact - 1, exact, exact + 1, 9 * exact, u64::MAX] {
            let file = File {
                numbers: numbers(rows, 20),
                scale: scaled(scale, offset),
                colour_components: [0, 3, 4][announced as usize % 3],
                announced,
                run,
            };
            assert_eq!(file.compare(), Some(rows));
        }
    }
}

#[test]
fn both_ways_give_the_same_object_whatever_the_numbers_are() {
    const ROWS: usize = 2000;
    let mut extreme = numbers(ROWS, 32);
    extreme[7] = [i32::MIN, i32::MAX, 0];
    extreme[1998] = [i32::MAX, i32::MIN, -1];
    let same = vec![[5, -6, i32::MIN]; ROWS];
    let [scale, offset] = OF_A_MAP;
    let scales = [
        (scaled(scale, offset), true),
        (scaled([1.0; 3], [0.0; 3]), true),
        (scaled([-1e-7, 1e-300, 0.0], [1e17, -0.0, 3.0]), true),
        (scaled([1e-3, 1e-3, -1e-3], [-1e9, 1e12, 0.1]), true),
        (scaled([1e8, 1.0, 1.0], [-9e17, 0.0, 0.0]), false),
        (scaled([1.0, 1e300, 1.0], [0.0; 3]), false),
        (scaled([1.0, 1.0, f64::INFINITY], [0.0; 3]), false),
        (scaled([1.0, f64::NAN, 1.0], [0.0; 3]), false),
    ];
    let mut dropped_some = 0;
    for numbers in [numbers(ROWS, 12), extreme, same] {
        for (scale, can_all_be_placed) in scales {
            for colour_components in [0, 3, 4] {
                let file = File {
                    numbers: numbers.clone(),
                    scale,
                    colour_components,
                    announced: ROWS as u64,
                    run: 999,
                };
                let surfels = file.compare();
                if can_all_be_placed {
                    assert_eq!(surfels, Some(ROWS));
                }
                dropped_some += usize::from(surfels.is_some_and(|surfels| surfels < ROWS));
            }
        }
    }
    assert!(dropped_some > 0, "none had to be gathered again");
}

#[test]
fn both_ways_give_the_same_blocks() {
    let [scale, offset] = OF_A_MAP;
    let rows = MAX_BLOCK_SURFELS + 77_777;
    let file = File {
        numbers: numbers(rows, 24),
        scale: scaled(scale, offset),
        colour_components: 3,
        announced: rows as u64,
        run: 1_234_567,
    };
    assert_eq!(file.compare(), Some(rows));
}

#[test]
fn a_cancelled_job_makes_no_object_of_numbers() {
    let specs = vec![ColumnSpec::new(ColumnRole::Position, ScalarType::I32, 3)];
    let mut columns = RowColumns::new(specs).expect("sound");
    let [scale, offset] = OF_A_MAP;
    columns
        .scale_positions(scaled(scale, offset))
        .expect("whole numbers");
    columns.add(1, &[&[1; 12]]).expect("one row");
    let job = Job::new();
    job.cancel();
    let stopped = columns.build(Winding::default(), &job, &mut Warnings::new());
    let stopped = format!("{:?}", stopped.map(|_| ()));
    assert!(stopped.contains("Cancelled"), "{stopped}");
}
