//! Thousands of damaged files: none may panic, or take much more memory than the file is long.
//!
//! One test alone in its program, since it counts every allocation.

#[path = "support/sfl.rs"]
mod sfl;
mod support;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use pointstage_scene::{LoadOptions, LoaderChoice};
use sfl::{Set, be, floats, u32s};
use support::load_bytes;

static IN_USE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

/// The system's allocator, counting bytes.
struct Counting;

#[allow(
    unsafe_code,
    reason = "an allocator has no safe form; only this test counts allocations"
)]
// SAFETY: every call goes unchanged to the system's allocator, which keeps the contract; counting touches no memory of it.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let in_use = IN_USE.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        PEAK.fetch_max(in_use, Ordering::Relaxed);
        // SAFETY: our caller vouches for the layout.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        IN_USE.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: our caller vouches that `pointer` came from `alloc` with this layout.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A sound file.
struct Seed {
    loader: &'static str,
    bytes: Vec<u8>,
}

/// Files of every format that is built in.
fn seeds() -> Vec<Seed> {
    let of = |loader: &'static str, files: Vec<Vec<u8>>| {
        files.into_iter().map(move |bytes| Seed { loader, bytes })
    };
    of("ply", ply_files())
        .chain(of("sfl", sfl_files()))
        .chain(of("qs", qs_files()))
        .chain(of("tri", tri_files()))
        .collect()
}

/// Sets of all forms of normals and colours, with levels, transforms and axes of their own.
fn sfl_files() -> Vec<Vec<u8>> {
    let all_forms = |mask: u32, normal_bytes: u32, colour_bytes: u32| {
        let colour = 16 + normal_bytes;
        let axes = colour + colour_bytes;
        let record_bytes = axes + 24 + 4;
        let layout = vec![
            (0, 0),
            (4, 12),
            (1, 16),
            (10, colour),
            (24, axes),
            (27, axes + 24),
        ];
        let level = |count: u32| {
            let byte = |index: u32| (index.wrapping_mul(0x9E37_79B9) >> 24) as u8 & 0x3f;
            (0..count * record_bytes).map(byte).collect()
        };
        Set {
            mask: vec![0b1_0011 | 1 << 10 | 1 << 24 | 1 << 27 | mask],
            layout,
            record_bytes,
            levels: vec![level(2), level(6), level(4)],
            entries: vec![u32s(0x141, &[1])],
        }
    };
    let mut points = Set {
        mask: vec![1 | 1 << 6],
        layout: vec![(0, 0), (6, 12)],
        record_bytes: 24,
        levels: vec![be(&[
            0.0, 1.0, 2.0, 0.0, 0.0, 4.0, 3.0, 4.0, 5.0, 0.0, 3.0, 0.0,
        ])],
        entries: Vec::new(),
    };
    let plain = sfl::file(&[], std::slice::from_ref(&points));
    #[rustfmt::skip]
    let moved = [0.0, -2.0, 0.0, 5.0,  2.0, 0.0, 0.0, 6.0,  0.0, 0.0, 2.0, 7.0,  0.0, 0.0, 0.0, 1.0];
    points.entries.push(floats(0x161, &moved));
    let title = (0x100, 8, 6, b"title\0".to_vec());
    let root = [
        title,
        floats(0x111, &[0.0, 0.0, 1.0]),
        floats(0x112, &[0.0, -1.0, 0.0]),
    ];
    let sets = [
        all_forms(0b1000 | 0x0007_0000, 2, 3),
        points,
        all_forms(0b1100 | 0x0018_0000, 4, 4),
    ];
    vec![plain, sfl::file(&root, &sets)]
}

/// A comment, and trees of one and of two levels.
fn qs_files() -> Vec<Vec<u8>> {
    let model = |leaves: u32, options: u32, children: u32, groups: &[u8]| {
        let mut bytes = b"QSplat11".to_vec();
        bytes.extend((40 + groups.len() as u32).to_be_bytes());
        bytes.extend([leaves, options].map(u32::to_be_bytes).as_flattened());
        bytes.extend(be(&[1.0, 2.0, 3.0, 13.0]));
        bytes.extend(children.to_be_bytes());
        bytes.extend(groups);
        bytes
    };
    let flat = model(
        3,
        0,
        3,
        &[0x10, 0, 0x20, 0, 0x30, 0, 0x40, 0, 0x50, 0, 0x60, 0],
    );
    let mut groups = 16_u32.to_be_bytes().to_vec();
    // A leaf and a node with three children, with colours.
    groups.extend([
        0x10, 0x00, 0x22, 0x20, 0x11, 0x11, 0x20, 0x02, 0x33, 0x30, 0x22, 0x22,
    ]);
    groups.extend([0x40, 0x00, 0x44, 0x40, 0x33, 0x33].repeat(3));
    let mut deep = b"QSplat11\0\0\0\x1c\0\0\0\0\0\0\0\x02hello\0\0\0".to_vec();
    deep.extend(model(4, 1, 2, &groups));
    vec![flat, deep]
}

fn tri_files() -> Vec<Vec<u8>> {
    let plain = "TRI 1.0\n[Vertices] 4\n0 0 0\n1 0 0\n1 1 0 # corner\n0, 1, .5\n[Triangles]\n2\n0 1 2\n0 2 3\n";
    let counted = "Vertices:\n1 0 0 0\n2 1 0 0\n3 0 1e0 0\nVertices' Normals\n0 0 1\n0 0 1\n0 0 -1\nother\n1 2\n\
        Triangles = 1\n1 2 3\nTriangles' Normals 1\n0 0 1\n";
    vec![plain.into(), counted.into()]
}

/// Files that hold every form of row.
fn ply_files() -> Vec<Vec<u8>> {
    let text = "ply\nformat ascii 1.0\ncomment seed\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
        property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float nx\nproperty float ny\nproperty float nz\n\
        element face 3\nproperty list uchar int vertex_indices\nproperty float quality\nend_header\n\
        0 0 0 1 2 3 0 0 1\n1 0 0 1 2 3 0 0 1\n1 1 0 1 2 3 0 0 1\n0 1 0 1 2 3 0 0 1\n.2 .2 1e-1 1 2 3 0 0 1\n\
        3 0 1 2 .5\n4 0 1 2 3 .5\n5 0 1 4 2 3 .5\n";
    let mut triangles = b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
        property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
        .to_vec();
    triangles.extend(
        [0_f32, 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.]
            .iter()
            .flat_map(|value| value.to_le_bytes()),
    );
    for corners in [[0_i32, 1, 2], [0, 2, 3]] {
        triangles.push(3);
        triangles.extend(corners.iter().flat_map(|corner| corner.to_le_bytes()));
    }
    let mut strips = b"ply\r\nformat binary_big_endian 1.0\r\nelement camera 1\r\nproperty list uchar double view\r\n\
        element vertex 5\r\nproperty double x\r\nproperty list uchar short marks\r\nproperty double y\r\nproperty int radius\r\n\
        element tristrips 1\r\nproperty list int int vertex_indices\r\nend_header\r\n"
        .to_vec();
    strips.push(1);
    strips.extend(2_f64.to_be_bytes());
    for index in 0..5_u8 {
        strips.extend(f64::from(index % 2).to_be_bytes());
        strips.extend([1, 0, 9]);
        strips.extend(f64::from(index).to_be_bytes());
        strips.extend(1_i32.to_be_bytes());
    }
    strips.extend(
        [8_i32, 0, 1, 2, 3, -1, 2, 3, 4]
            .iter()
            .flat_map(|value| value.to_be_bytes()),
    );
    vec![text.as_bytes().to_vec(), triangles, strips]
}

/// A fixed sequence, so that a failure repeats (xorshift64*, Vigna 2016).
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) as usize % limit.max(1)
    }
}

fn damage(file: &mut Vec<u8>, random: &mut Random) {
    match random.below(7) {
        0 => file.truncate(random.below(file.len())),
        1 => {
            let position = random.below(file.len());
            file[position] = random.below(256) as u8;
        }
        2 => {
            let position = random.below(file.len());
            file[position] ^= 1 << random.below(8);
        }
        // In binary files numbers are aligned words, most of them big-endian.
        4 => {
            let lies = [
                0,
                1,
                0x7fff_ffff,
                0xffff_ffff,
                0x7fc0_0000,
                file.len() as u32,
                20,
                12,
            ];
            let lie = lies[random.below(lies.len())];
            let position = random.below(file.len() / 4) * 4;
            if let Some(word) = file.get_mut(position..position + 4) {
                word.copy_from_slice(&if random.below(4) == 0 {
                    lie.to_le_bytes()
                } else {
                    lie.to_be_bytes()
                });
            }
        }
        // Numbers of the header are where lies are told.
        3 => {
            let digits: Vec<usize> = (0..file.len())
                .filter(|index| file[*index].is_ascii_digit())
                .collect();
            if let Some(position) = digits.get(random.below(digits.len())) {
                let lies: [&[u8]; 6] = [
                    b"0",
                    b"-1",
                    b"99",
                    b"4294967295",
                    b"99999999999999999999",
                    b"nan",
                ];
                file.splice(
                    *position..=*position,
                    lies[random.below(lies.len())].iter().copied(),
                );
            }
        }
        5 => {
            let (start, length) = (random.below(file.len()), random.below(40));
            let copy: Vec<u8> = file[start..file.len().min(start + length)].to_vec();
            let place = random.below(file.len());
            file.splice(place..place, copy);
        }
        _ => {
            let start = random.below(file.len());
            file.drain(start..file.len().min(start + random.below(40)));
        }
    }
}

#[test]
fn damaged_files_neither_panic_nor_take_much_memory() {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    for Seed { loader, bytes } in seeds() {
        let options = || LoadOptions {
            loader: Some(LoaderChoice {
                loader: loader.to_owned(),
                ..LoaderChoice::default()
            }),
            ..LoadOptions::default()
        };
        load_bytes(&bytes, &options()).unwrap_or_else(|error| panic!("{loader}: {error}"));
        let (mut loaded, mut refused) = (0, 0);
        for _ in 0..3000 {
            let mut file = bytes.clone();
            for _ in 0..=random.below(3) {
                if !file.is_empty() {
                    damage(&mut file, &mut random);
                }
            }
            let before = IN_USE.load(Ordering::Relaxed);
            PEAK.store(before, Ordering::Relaxed);
            match load_bytes(&file, &options()) {
                Ok(_) => loaded += 1,
                Err(_) => refused += 1,
            }
            let taken = PEAK.load(Ordering::Relaxed).saturating_sub(before);
            // Columns, scratch and the tree of neighbours; a lie of 2³² rows would take gigabytes.
            assert!(
                taken < 1 << 20,
                "{taken} bytes for {} of {loader} {}",
                file.len(),
                file.escape_ascii()
            );
        }
        assert!(
            loaded > 200 && refused > 200,
            "{loader}: {loaded} loaded and {refused} refused: the damage is of one kind"
        );
    }
}
