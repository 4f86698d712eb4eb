//! Thousands of damaged files: none may panic, or take much more memory than the file is long.
//!
//! One test alone in its program, since it counts every allocation.

mod support;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use pointstage_scene::LoadOptions;
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

/// Files that hold every form of row.
fn seeds() -> Vec<Vec<u8>> {
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
    match random.below(6) {
        0 => file.truncate(random.below(file.len())),
        1 => {
            let position = random.below(file.len());
            file[position] = random.below(256) as u8;
        }
        2 => {
            let position = random.below(file.len());
            file[position] ^= 1 << random.below(8);
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
        4 => {
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
    let (mut loaded, mut refused) = (0, 0);
    for seed in seeds() {
        load_bytes(&seed, &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        for _ in 0..2000 {
            let mut file = seed.clone();
            for _ in 0..=random.below(3) {
                if !file.is_empty() {
                    damage(&mut file, &mut random);
                }
            }
            let before = IN_USE.load(Ordering::Relaxed);
            PEAK.store(before, Ordering::Relaxed);
            match load_bytes(&file, &LoadOptions::default()) {
                Ok(_) => loaded += 1,
                Err(_) => refused += 1,
            }
            let taken = PEAK.load(Ordering::Relaxed).saturating_sub(before);
            // Columns, scratch and the tree of neighbours; a lie of 2³² rows would take gigabytes.
            assert!(
                taken < 1 << 20,
                "{taken} bytes for {} of {}",
                file.len(),
                file.escape_ascii()
            );
        }
    }
    assert!(
        loaded > 500 && refused > 500,
        "{loaded} loaded and {refused} refused: the damage is of one kind"
    );
}
