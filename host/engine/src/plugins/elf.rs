//! Whether an object file is whole, looked at without loading it.
//!
//! The system's loader maps what the file's header promises. If the file is shorter, reading the missing part ends the
//! process with SIGBUS inside `dlopen`, and nobody can catch that.

use object::elf::{self, FileHeader32, FileHeader64};
use object::read::elf::{FileHeader, ProgramHeader as _};
use object::{Architecture, Endianness, FileKind, Object as _, ObjectSection as _};

/// What is wrong with a library's file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BrokenObject {
    /// Zero bytes.
    #[error("the file is empty")]
    Empty,
    /// No known header.
    #[error("the file is no shared library")]
    NotALibrary,
    /// A program, a core dump, an object file.
    #[error("the file is an executable or object file, no shared library")]
    NotShared,
    /// For another system or processor.
    #[error("the library is made for another system ({found}); this program needs {expected}")]
    Foreign {
        /// What the file is for.
        found: String,
        /// What this program is.
        expected: String,
    },
    /// The header promises more than there is.
    #[error("the file is truncated: {length} bytes of at least {needed}; copy or build it again")]
    Truncated {
        /// Bytes in the file.
        length: u64,
        /// Bytes that the header promises.
        needed: u64,
    },
    /// The header contradicts itself.
    #[error("the library's header is damaged ({0}); copy or build it again")]
    Damaged(String),
}

/// Checks that `data` is a whole shared library for this system.
pub fn check_whole(data: &[u8]) -> Result<(), BrokenObject> {
    if data.is_empty() {
        return Err(BrokenObject::Empty);
    }
    match FileKind::parse(data) {
        Ok(FileKind::Elf64) => check_elf::<FileHeader64<Endianness>>(data),
        Ok(FileKind::Elf32) => check_elf::<FileHeader32<Endianness>>(data),
        Ok(FileKind::MachO64 | FileKind::Pe64 | FileKind::MachO32 | FileKind::Pe32) => {
            check_sections(data)
        }
        // A header that is cut off within its first bytes has no kind either.
        _ if data.starts_with(&elf::ELFMAG) || elf::ELFMAG.starts_with(data) => {
            Err(BrokenObject::Damaged("the header is cut off".to_owned()))
        }
        _ => Err(BrokenObject::NotALibrary),
    }
}

/// Every `PT_LOAD` segment has to end inside the file.
fn check_elf<H: FileHeader<Endian = Endianness>>(data: &[u8]) -> Result<(), BrokenObject> {
    let damaged = |error: object::Error| BrokenObject::Damaged(error.to_string());
    let header = H::parse(data).map_err(damaged)?;
    let endian = header.endian().map_err(damaged)?;
    let length = data.len() as u64;
    let segments_end = u64::from(header.e_phentsize(endian))
        .saturating_mul(u64::from(header.e_phnum(endian)))
        .saturating_add(header.e_phoff(endian).into());
    if segments_end > length {
        return Err(BrokenObject::Truncated {
            length,
            needed: segments_end,
        });
    }
    let needed = header
        .program_headers(endian, data)
        .map_err(damaged)?
        .iter()
        .filter(|segment| segment.p_type(endian) == elf::PT_LOAD)
        .map(|segment| {
            segment
                .p_offset(endian)
                .into()
                .saturating_add(segment.p_filesz(endian).into())
        })
        .max()
        .unwrap_or(0);
    if needed > length {
        return Err(BrokenObject::Truncated { length, needed });
    }
    let file = object::File::parse(data);
    if header.e_type(endian) != elf::ET_DYN {
        return Err(BrokenObject::NotShared);
    }
    // Damaged section tables do not hinder the loader; without them there is no manifest, which is told elsewhere.
    match file {
        Ok(file) => check_target(&file),
        Err(error) => Err(damaged(error)),
    }
}

/// Every section's content has to lie inside the file.
fn check_sections(data: &[u8]) -> Result<(), BrokenObject> {
    let damaged = |error: object::Error| BrokenObject::Damaged(error.to_string());
    let file = object::File::parse(data).map_err(damaged)?;
    if file.kind() != object::ObjectKind::Dynamic {
        return Err(BrokenObject::NotShared);
    }
    for section in file.sections() {
        section.data().map_err(damaged)?;
    }
    check_target(&file)
}

fn check_target(file: &object::File<'_>) -> Result<(), BrokenObject> {
    let expected_format = if cfg!(target_os = "windows") {
        object::BinaryFormat::Pe
    } else if cfg!(target_vendor = "apple") {
        object::BinaryFormat::MachO
    } else {
        object::BinaryFormat::Elf
    };
    let expected = match std::env::consts::ARCH {
        "x86_64" => Some(Architecture::X86_64),
        "aarch64" => Some(Architecture::Aarch64),
        "x86" => Some(Architecture::I386),
        "riscv64" => Some(Architecture::Riscv64),
        // Elsewhere the system's loader has to tell.
        _ => None,
    };
    let fits = file.format() == expected_format
        && expected.is_none_or(|expected| expected == file.architecture());
    if fits {
        return Ok(());
    }
    Err(BrokenObject::Foreign {
        found: format!("{:?} {:?}", file.format(), file.architecture()),
        expected: format!("{expected_format:?} {}", std::env::consts::ARCH),
    })
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    /// A whole position-independent object: this test program.
    fn whole() -> Vec<u8> {
        let path = std::env::current_exe().expect("a running program has a path");
        std::fs::read(path).expect("a running program is readable")
    }

    #[test]
    fn a_whole_file_passes() {
        assert_eq!(check_whole(&whole()), Ok(()));
    }

    #[test]
    fn every_truncation_is_an_error() {
        let whole = whole();
        assert_eq!(check_whole(&[]), Err(BrokenObject::Empty));
        for length in [1, 4, 16, 63, 64, 65, 200, 1_000, 4_096, 65_536, 300_000] {
            let cut = &whole[..length];
            let error = check_whole(cut).expect_err("a truncated file");
            assert_ne!(error, BrokenObject::NotALibrary, "{length} bytes");
        }
        let half = check_whole(&whole[..whole.len() / 2]).expect_err("half a file");
        assert!(
            matches!(
                half,
                BrokenObject::Truncated { .. } | BrokenObject::Damaged(_)
            ),
            "{half}"
        );
    }

    #[test]
    fn what_is_no_library_is_told_apart() {
        let script = check_whole(b"#!/bin/sh\nexit 0\n");
        assert_eq!(script, Err(BrokenObject::NotALibrary));
        let mut executable = whole();
        executable[16] = 2; // e_type: ET_EXEC
        assert_eq!(check_whole(&executable), Err(BrokenObject::NotShared));
        let mut foreign = whole();
        foreign[18..20].copy_from_slice(&elf::EM_S390.0.to_le_bytes());
        let error = check_whole(&foreign).expect_err("another processor");
        assert!(matches!(error, BrokenObject::Foreign { .. }), "{error}");
    }

    proptest::proptest! {
        #[test]
        fn damaged_headers_never_panic(place in 0_usize..512, byte: u8, length in 0_usize..5_000) {
            static WHOLE: std::sync::OnceLock<Vec<u8>> = std::sync::OnceLock::new();
            let mut damaged = WHOLE.get_or_init(whole)[..length].to_vec();
            if let Some(target) = damaged.get_mut(place) {
                *target = byte;
            }
            let _ = check_whole(&damaged);
        }
    }
}
