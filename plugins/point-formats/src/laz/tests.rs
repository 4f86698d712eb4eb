//! What the crate `laz` has compressed comes out as it was, for all layouts, and damage is found or at least survived.

use std::io::Cursor;
use std::sync::atomic::{AtomicUsize, Ordering};

use ::laz::{LasZipCompressor, LazItem, LazItemRecordBuilder, LazItemType, LazVlr, LazVlrBuilder};

use super::lanes::{Chunk, Incomplete, Taker};
use super::layout::Layout;
use super::sharing::{Ended, Limits, decompress};
use super::table::Chunks;

mod by_hand;

/// Random numbers (xorshift, Marsaglia 2003).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, end: u64) -> u64 {
        (self.next() >> 16) % end
    }
}

/// How records follow each other.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// All are the same.
    Constant,
    /// Each number differs a little, or not at all, from that of the record before.
    Walk,
    /// As a scanner's: some fields change now and then.
    Scan,
    /// Any bytes.
    Noise,
}

const KINDS: [Kind; 4] = [Kind::Constant, Kind::Walk, Kind::Scan, Kind::Noise];

/// The items of all layouts.
fn layouts() -> Vec<Vec<LazItem>> {
    use LazItemType::{
        Byte, Byte14, GpsTime, Point10, Point14, RGB12, RGB14, RGBNIR14, WavePacket13, WavePacket14,
    };
    let usual = [
        &[Point10][..],
        &[Point10, GpsTime],
        &[Point10, RGB12],
        &[Point10, GpsTime, RGB12],
        &[Point14],
        &[Point10, Byte(1)],
        &[Point10, GpsTime, RGB12, Byte(5)],
        &[Point14, RGB14],
        &[Point14, RGBNIR14],
        &[Point14, Byte14(3)],
        &[Point14, RGBNIR14, Byte14(64)],
        &[Point10, GpsTime, WavePacket13],
        &[Point10, GpsTime, RGB12, WavePacket13, Byte(2)],
        &[Point14, WavePacket14],
        &[Point14, RGBNIR14, WavePacket14, Byte14(2)],
    ]
    .map(items);
    // The first version's colours and extra bytes: `points_in_one_piece_come_out`.
    let old = [
        &[Point10][..],
        &[Point10, GpsTime],
        &[Point10, GpsTime, WavePacket13],
    ]
    .map(|types| of_version(types, 1));
    let new = [
        &[Point14][..],
        &[Point14, RGB14, Byte14(3)],
        &[Point14, RGBNIR14, WavePacket14],
    ]
    .map(|types| of_version(types, 4));
    // So LASzip calls them.
    let with_old_wave = [
        items(&[Point10, GpsTime]),
        of_version(&[WavePacket13], 1),
        items(&[Byte(2)]),
    ]
    .concat();
    [&usual[..], &old, &new, &[with_old_wave]].concat()
}

fn stride(items: &[LazItem]) -> usize {
    items.iter().map(|item| usize::from(item.size())).sum()
}

/// Items of the version that is usual for each.
fn items(types: &[LazItemType]) -> Vec<LazItem> {
    let mut builder = LazItemRecordBuilder::new();
    for item in types {
        builder.add_item(*item);
    }
    builder.build()
}

fn of_version(types: &[LazItemType], version: u16) -> Vec<LazItem> {
    const ITEM_BYTES: usize = 6;
    let mut description = Vec::new();
    let usual = LazVlr::from_laz_items(items(types));
    usual.write_to(&mut description).unwrap();
    let first = description.len() - types.len() * ITEM_BYTES;
    for item in description[first..].chunks_mut(ITEM_BYTES) {
        item[4..].copy_from_slice(&version.to_le_bytes());
    }
    LazVlr::from_buffer(description).unwrap().items().clone()
}

/// The upper bytes of numbers that the crate's compressor subtracts, which must not overflow: positions in the first version,
/// times, places of waves.
fn upper_bytes(items: &[LazItem]) -> Vec<usize> {
    let mut bytes = Vec::new();
    let mut at = 0;
    for item in items {
        bytes.extend(match (item.item_type(), item.version()) {
            (LazItemType::Point10, 1) => vec![3, 7, 11],
            (LazItemType::Point14, _) => vec![29],
            (LazItemType::GpsTime, _) => vec![at + 7],
            (LazItemType::WavePacket13 | LazItemType::WavePacket14, _) => vec![at + 8],
            _ => Vec::new(),
        });
        at += usize::from(item.size());
    }
    bytes
}

/// So many records, one after another.
fn records(kind: Kind, items: &[LazItem], count: usize, random: &mut Random) -> Vec<u8> {
    let stride = stride(items);
    let upper_bytes = upper_bytes(items);
    let mut record: Vec<u8> = (0..stride).map(|_| random.next() as u8).collect();
    let mut all = Vec::new();
    for _ in 0..count {
        for at in &upper_bytes {
            record[*at] &= 0x3F;
        }
        all.extend_from_slice(&record);
        match kind {
            Kind::Constant => {}
            Kind::Walk => {
                for number in record.chunks_mut(2) {
                    let step = random.below(5) as u8;
                    number[0] = number[0].wrapping_add(step.saturating_sub(2));
                }
            }
            Kind::Scan => {
                for field in record.chunks_mut(4) {
                    let bits = random.below(20);
                    if bits < 16 {
                        let step = random.below(1 << bits) as u32;
                        let mut bytes = [0; 4];
                        bytes[..field.len()].copy_from_slice(field);
                        let number = u32::from_le_bytes(bytes).wrapping_add(step);
                        field.copy_from_slice(&number.to_le_bytes()[..field.len()]);
                    }
                }
            }
            Kind::Noise => record.fill_with(|| random.next() as u8),
        }
    }
    all
}

/// Compressed records, in chunks of so many points, in turn; a single size is the same for all.
fn compressed(items: &[LazItem], records: &[u8], sizes: &[u32]) -> (Vec<u8>, LazVlr) {
    let builder = LazVlrBuilder::new(items.to_vec());
    let description = match sizes {
        [size] => builder.with_fixed_chunk_size(*size),
        _ => builder.with_variable_chunk_size(),
    }
    .build();
    let mut out = Cursor::new(Vec::new());
    let mut compressor = LasZipCompressor::new(&mut out, description.clone()).unwrap();
    let stride = description.items_size() as usize;
    if let [_] = sizes {
        compressor.compress_many(records).unwrap();
    } else {
        let mut rest = records;
        for size in sizes.iter().cycle() {
            let (chunk, behind) = rest.split_at(rest.len().min(*size as usize * stride));
            compressor.compress_many(chunk).unwrap();
            rest = behind;
            if rest.is_empty() {
                break;
            }
            compressor.finish_current_chunk().unwrap();
        }
    }
    compressor.done().unwrap();
    drop(compressor);
    (out.into_inner(), description)
}

/// Takes records as they are.
struct Plain {
    stride: usize,
}

impl Taker for Plain {
    type Piece = Vec<u8>;

    fn begin(&self, piece: &mut Vec<u8>, count: usize) {
        piece.clear();
        piece.reserve(count * self.stride);
    }

    fn add(&self, piece: &mut Vec<u8>, first: usize, records: &[u8]) {
        assert_eq!(piece.len(), first * self.stride);
        piece.extend_from_slice(records);
    }
}

/// All records of a file.
fn read(
    file: &[u8],
    description: &LazVlr,
    count: u64,
    limits: Limits,
) -> Result<Vec<u8>, Incomplete> {
    all_of(
        Chunks::new(file, 0, count, description).unwrap(),
        description,
        limits,
    )
}

fn all_of(chunks: Chunks<'_>, description: &LazVlr, limits: Limits) -> Result<Vec<u8>, Incomplete> {
    let stride = description.items_size() as usize;
    let mut all = Vec::new();
    let fetch = |piece: Vec<u8>| {
        all.extend_from_slice(&piece);
        Ok::<_, Never>(Some(piece))
    };
    let ended = chunks.decompress(limits, &Plain { stride }, fetch);
    ended.map(|()| all).map_err(incomplete)
}

/// What no test stops with.
#[derive(Debug)]
enum Never {}

fn incomplete(ended: Ended<Never>) -> Incomplete {
    match ended {
        Ended::Damaged(incomplete) => incomplete,
        Ended::NoThread(error) => panic!("{error}"),
        Ended::By(never) => match never {},
    }
}

/// So many threads, and so many points ahead.
fn limits(threads: usize, points: usize) -> Limits {
    Limits {
        threads,
        points,
        of_chunk: 1 << 20,
    }
}

#[test]
fn what_was_compressed_comes_out() {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    for items in layouts() {
        for kind in KINDS {
            for (count, sizes) in [
                (1, &[50][..]),
                (700, &[50_000]),
                (900, &[250]),
                (60, &[1]),
                (900, &[1, 200, 2, 40, 300]),
            ] {
                let wanted = records(kind, &items, count, &mut random);
                let (file, description) = compressed(&items, &wanted, sizes);
                // One after the other, in pairs, by many threads of which some find nothing, and in parts.
                let in_parts = Limits {
                    of_chunk: 7,
                    ..limits(1, 1)
                };
                for limits in [limits(1, 1), limits(1, 1 << 20), limits(5, 600), in_parts] {
                    let found = read(&file, &description, count as u64, limits);
                    let same = found.as_ref() == Ok(&wanted);
                    assert!(same, "{items:?} {kind:?} {count} {sizes:?} {limits:?}");
                }
            }
        }
    }
}

/// Long chunks: the models' counts are halved, and their cycles are at their longest.
#[test]
fn long_chunks_come_out() {
    let mut random = Random(7);
    for items in layouts().into_iter().filter(|items| stride(items) < 40) {
        let wanted = records(Kind::Walk, &items, 30_000, &mut random);
        let (file, description) = compressed(&items, &wanted, &[15_000]);
        let found = read(&file, &description, 30_000, limits(1, 1 << 20));
        assert!(found == Ok(wanted), "{items:?}");
    }
}

#[test]
fn damage_is_found_or_survived() {
    let mut random = Random(3);
    for items in layouts() {
        let stride = stride(&items);
        let layout = Layout::of(&items).unwrap();
        let wanted = records(Kind::Scan, &items, 400, &mut random);
        let (file, description) = compressed(&items, &wanted, &[400]);
        let table = ::laz::laszip::ChunkTable::read_from(Cursor::new(&file), &description).unwrap();
        let bytes = table.as_ref()[0].byte_count as usize;
        let whole = &file[8..8 + bytes];
        let decompressed = |input: &[u8], count: usize| {
            let mut output = Vec::new();
            let fetch = |piece| {
                output = piece;
                Ok::<_, Never>(None)
            };
            let chunks = vec![Chunk { input, count }];
            let ended = decompress(layout, chunks, limits(1, 1), &Plain { stride }, fetch);
            ended.map(|()| output).map_err(incomplete)
        };
        assert!(decompressed(whole, 400) == Ok(wanted), "{items:?}");
        for end in (0..bytes - 16).step_by(7) {
            assert_eq!(
                decompressed(&whole[..end], 400),
                Err(Incomplete),
                "{items:?} {end}"
            );
        }
        assert_eq!(decompressed(whole, 2000), Err(Incomplete), "{items:?}");
        for _ in 0..200 {
            let mut damaged = whole.to_vec();
            for _ in 0..=random.below(8) {
                let at = random.below(bytes as u64) as usize;
                damaged[at] = random.next() as u8;
            }
            // Whatever comes out: no panic.
            let _ = decompressed(&damaged, 400);
        }
    }
}

/// Counts records.
#[derive(Default)]
struct Counted(AtomicUsize);

impl Taker for Counted {
    type Piece = ();

    fn begin(&self, (): &mut (), _: usize) {}

    fn add(&self, (): &mut (), _: usize, records: &[u8]) {
        self.0.fetch_add(records.len() / 20, Ordering::Relaxed);
    }
}

/// However many points it claims: they would all come out of nothing.
#[test]
fn a_chunk_that_is_cut_off_ends_at_once() {
    let items = items(&[LazItemType::Point10]);
    let wanted = records(Kind::Noise, &items, 400, &mut Random(17));
    let (file, _) = compressed(&items, &wanted, &[400]);
    let layout = Layout::of(&items).unwrap();
    let chunks = || {
        vec![Chunk {
            input: &file[8..],
            count: 1_000_000_000,
        }]
    };
    let whole = Limits {
        of_chunk: usize::MAX,
        ..limits(1, usize::MAX)
    };
    for limits in [whole, limits(1, 1)] {
        let taker = Counted::default();
        let ended = decompress(layout, chunks(), limits, &taker, |()| Ok::<_, Never>(None));
        assert_eq!(ended.map_err(incomplete), Err(Incomplete), "{limits:?}");
        let taken = taker.0.load(Ordering::Relaxed);
        assert!((400..4000).contains(&taken), "{taken} {limits:?}");
    }
}

#[test]
fn a_file_without_all_of_its_chunks_is_incomplete() {
    let items = items(&[LazItemType::Point10]);
    let wanted = records(Kind::Scan, &items, 900, &mut Random(5));
    let (file, description) = compressed(&items, &wanted, &[400]);
    assert_eq!(
        read(&file, &description, 1300, limits(2, 1000)),
        Err(Incomplete)
    );
}

/// Whoever fetches may stop, or panic, and so may what takes records: no thread waits for ever.
#[test]
fn it_ends_early_when_it_must() {
    let items = items(&[LazItemType::Point10]);
    let wanted = records(Kind::Walk, &items, 9000, &mut Random(5));
    let (file, description) = compressed(&items, &wanted, &[100]);
    let chunks = || Chunks::new(&file, 0, 9000, &description).unwrap();
    for threads in [1, 4] {
        let limits = limits(threads, 1000);
        let mut fetched = 0;
        let ended = chunks().decompress(limits, &Plain { stride: 20 }, |piece| {
            fetched += 1;
            if fetched == 7 {
                Err("enough")
            } else {
                Ok(Some(piece))
            }
        });
        assert!(matches!(ended, Err(Ended::By("enough"))), "{ended:?}");
        let panicking = || {
            let fetch = |piece: Vec<u8>| {
                assert!(piece.is_empty(), "a test of panics");
                Ok::<_, Never>(None)
            };
            chunks().decompress(limits, &Plain { stride: 20 }, fetch)
        };
        assert!(std::panic::catch_unwind(panicking).is_err());
        // It takes records of another length than they have.
        let panicking = || {
            let fetch = |piece| Ok::<_, Never>(Some(piece));
            chunks().decompress(limits, &Plain { stride: 21 }, fetch)
        };
        assert!(std::panic::catch_unwind(panicking).is_err());
    }
}

#[test]
fn other_items_are_refused() {
    use LazItemType::{Byte, Byte14, GpsTime, Point10, Point14, RGB12, WavePacket14};
    let problem = |items: &[LazItem]| Layout::of(items).unwrap_err();
    let too_many = problem(&items(&[Point10, Byte(5000)]));
    assert!(too_many.contains("5000 extra bytes"), "{too_many}");
    let mixed = [of_version(&[Point10], 1), items(&[GpsTime])].concat();
    assert_eq!(
        problem(&mixed),
        "no records of Point10 version 1, GpsTime version 2 are known"
    );
    for types in [
        &[Point10, RGB12, GpsTime][..],
        &[GpsTime],
        &[Point14, RGB12],
        &[Point10, WavePacket14],
        &[Point10, Byte(1), Byte(1)],
        &[Point10, Byte14(1)],
        &[],
    ] {
        assert!(Layout::of(&items(types)).is_err(), "{types:?}");
    }
    for (types, version) in [(&[Point10][..], 3), (&[Point14], 2), (&[Point14], 5)] {
        let items = of_version(types, version);
        assert!(Layout::of(&items).is_err(), "{types:?} {version}");
    }
}

#[test]
fn the_most_extra_bytes_come_out() {
    for types in [
        [LazItemType::Point10, LazItemType::Byte(1024)],
        [LazItemType::Point14, LazItemType::Byte14(1024)],
    ] {
        let items = items(&types);
        let wanted = records(Kind::Scan, &items, 100, &mut Random(11));
        let (file, description) = compressed(&items, &wanted, &[40]);
        let found = read(&file, &description, 100, limits(2, 1000));
        assert!(found == Ok(wanted), "{types:?}");
    }
}

/// The crate would take memory for all chunks that are claimed.
#[test]
fn a_table_of_more_chunks_than_the_file_can_hold_is_refused() {
    let items = items(&[LazItemType::Point10]);
    let wanted = records(Kind::Scan, &items, 900, &mut Random(5));
    for sizes in [&[300_u32][..], &[300, 200]] {
        let (file, description) = compressed(&items, &wanted, sizes);
        let table = u64::from_le_bytes(*file.first_chunk().unwrap()) as usize;
        let chunks = |file: &[u8]| {
            let chunks = Chunks::new(file, 0, 900, &description);
            chunks.map(|_| ())
        };
        assert_eq!(chunks(&file), Ok(()));
        let mut claims = file.clone();
        claims[table + 4..table + 8].fill(0xFF);
        let problem = chunks(&claims).unwrap_err();
        assert!(problem.contains("4294967295 chunks"), "{problem}");
        let problem = chunks(&file[..table + 5]).unwrap_err();
        assert!(problem.contains("no table"), "{problem}");
        // A place at the end, as of a writer that could not go back.
        let mut at_end = file.clone();
        at_end[..8].fill(0xFF);
        at_end.extend((table as u64).to_le_bytes());
        assert_eq!(
            read(&at_end, &description, 900, limits(1, 1000)),
            Ok(wanted.clone())
        );
        at_end.truncate(file.len());
        assert!(chunks(&at_end).is_err() || at_end[at_end.len() - 8..] != [0; 8]);
    }
}
