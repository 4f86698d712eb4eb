//! Loaders, one per fault. Each claims what begins with its own word.
#![forbid(unsafe_code)]

use pointstage_plugin_api::loading::{Claim, Column, FileStart, Loader, Output, SourceFile, bytes_of};
use pointstage_plugin_api::prelude::*;
use std::time::Duration;

pointstage_plugin_api::export! { "plugin.json", loaders: [Good, Panics, Careless, Empty, Slow, Moody] }

fn begins(start: &FileStart<'_>, word: &str) -> Claim {
    if start.bytes.starts_with(word.as_bytes()) {
        Claim::Certain
    } else {
        Claim::No
    }
}

/// A triangle, scaled, with a warning.
struct Good;

impl Loader for Good {
    fn claims(start: &FileStart<'_>) -> Claim {
        begins(start, "good")
    }

    fn load(host: &Host, file: &SourceFile<'_>, settings: Settings<'_>, out: &mut Output<'_>, progress: &Progress<'_>) -> Result<()> {
        if file.bytes.len() < 5 {
            return Err("byte 4: expected a letter, found the end of the file; write one".into());
        }
        host.info("a triangle");
        progress.set(0.5, "making a triangle");
        out.columns(&[Column::POSITION_F32, Column::RGB_U8], 3)?;
        let size = settings.float("scale")?;
        let positions = [[0.0, 0.0, 0.0], [size, 0.0, 0.0], [0.0, size, 0.0_f32]];
        out.rows(3, &[bytes_of(&positions), &[255, 0, 0, 0, 255, 0, 0, 0, 255]])?;
        out.triangles(&[[0, 1, 2]])?;
        out.warn("a letter is ignored", (file.bytes.len() - 4) as u64);
        Ok(())
    }
}

struct Panics;

impl Loader for Panics {
    fn claims(start: &FileStart<'_>) -> Claim {
        begins(start, "panics")
    }

    fn load(_: &Host, _: &SourceFile<'_>, _: Settings<'_>, _: &mut Output<'_>, _: &Progress<'_>) -> Result<()> {
        panic!("what a pity")
    }
}

/// Hands over too few bytes and goes on as if nothing had been refused.
struct Careless;

impl Loader for Careless {
    fn claims(start: &FileStart<'_>) -> Claim {
        begins(start, "careless")
    }

    fn load(_: &Host, _: &SourceFile<'_>, _: Settings<'_>, out: &mut Output<'_>, _: &Progress<'_>) -> Result<()> {
        out.columns(&[Column::POSITION_F32], 3)?;
        let refused = out.rows(3, &[&[0; 35]]);
        assert!(refused.is_err(), "the host takes anything");
        out.rows(1, &[&[0; 12]])
    }
}

/// Ends well without having handed over anything.
struct Empty;

impl Loader for Empty {
    fn claims(start: &FileStart<'_>) -> Claim {
        begins(start, "empty")
    }

    fn load(_: &Host, _: &SourceFile<'_>, _: Settings<'_>, _: &mut Output<'_>, _: &Progress<'_>) -> Result<()> {
        Ok(())
    }
}

/// Takes a minute, unless it is cancelled.
struct Slow;

impl Loader for Slow {
    fn claims(start: &FileStart<'_>) -> Claim {
        begins(start, "slow")
    }

    fn load(_: &Host, _: &SourceFile<'_>, _: Settings<'_>, _: &mut Output<'_>, progress: &Progress<'_>) -> Result<()> {
        for step in 0..6_000 {
            progress.check()?;
            progress.set(step as f32 / 6_000.0, "sleeping");
            std::thread::sleep(Duration::from_millis(10));
        }
        Err("nobody cancelled".into())
    }
}

/// Panics at the look at a file that begins with its name, but not at the first contact.
struct Moody;

impl Loader for Moody {
    fn claims(start: &FileStart<'_>) -> Claim {
        assert!(!start.bytes.starts_with(b"moody"), "not today");
        Claim::No
    }

    fn load(_: &Host, _: &SourceFile<'_>, _: Settings<'_>, _: &mut Output<'_>, _: &Progress<'_>) -> Result<()> {
        Ok(())
    }
}
