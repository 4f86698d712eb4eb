//! LAS, its compressed form LAZ, and COPC, which is a LAZ file with an index that is not needed to read all of it.

use std::io::Cursor;

use las::Header;
use pointstage_plugin_api::loading::{Claim, FileStart, Loader, Output, SourceFile};
use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};

use crate::columns::RUN;
use crate::large_memory::LargeMemory;
use crate::las_columns::{Colours, Layout, NAMES, Plan, scale_of};
use crate::las_extra::{Extra, described};
use crate::las_records::{Packed, Records};

/// What the progress says.
const READING: &str = "reading points";

/// The loader of LAS and LAZ files.
pub struct LasLoader;

impl Loader for LasLoader {
    fn claims(start: &FileStart<'_>) -> Claim {
        if start.bytes.starts_with(b"LASF") {
            Claim::Certain
        } else {
            Claim::No
        }
    }

    fn load(
        _host: &Host,
        file: &SourceFile<'_>,
        _settings: Settings<'_>,
        out: &mut Output<'_>,
        progress: &Progress<'_>,
    ) -> Result<()> {
        progress.set(0.0, READING);
        check_size(file.bytes)?;
        let mut source = Cursor::new(file.bytes);
        let header = Header::new(&mut source).map_err(|error| {
            Error::failed(format!(
                "the header cannot be read: {error}; the file is damaged, copy it again"
            ))
        })?;
        if header.number_of_points() == 0 {
            return Err(Error::failed(
                "the file has 0 points; there is nothing to show",
            ));
        }
        let layout = Layout::of(&header);
        let mut records = Records::new(file.bytes, source.position(), &header)?;
        let extras = extras_of(&header, out);
        // What must be read before it is known how colours are kept.
        let mut held = Vec::new();
        let largest = match &mut records {
            Records::Plain(bytes) => layout.largest_colour(bytes),
            Records::Packed(packed) => {
                let mut largest = 0;
                while layout.colour.is_some() && largest <= 255 {
                    progress.check()?;
                    let mut run = LargeMemory::default();
                    packed.next(&mut run, 0)?;
                    if run.is_empty() {
                        break;
                    }
                    progress.set(packed.fraction(), READING);
                    largest = largest.max(layout.largest_colour(&run));
                    held.push(run);
                }
                largest
            }
        };
        if layout.colour.is_some() && largest == 0 {
            out.warn(
                "the file has colours, but all are black: they are left out",
                1,
            );
        }
        let (scale, offset) = scale_of(&header);
        let knows_scale = out.scaled_positions(scale, offset)?;
        let plan = Plan::new(&header, knows_scale, Colours::of(largest), &extras);
        let expected = header.number_of_points();
        out.columns(&plan.columns(), expected)?;
        let mut handed = HandedOver {
            plan,
            stride: layout.stride,
            columns: Vec::new(),
            count: 0,
            expected,
            least_progress: 0.0,
        };
        match &mut records {
            Records::Plain(bytes) => handed.add(bytes, out, progress),
            Records::Packed(packed) => handed.add_packed(packed, held, out, progress),
        }?;
        for extra in &extras {
            extra.warn_of_rounded(out);
        }
        Ok(())
    }
}

/// Columns that go to the host.
struct HandedOver<'a> {
    plan: Plan<'a>,
    stride: usize,
    /// Those of the run at hand; kept for their memory.
    columns: Vec<Vec<u8>>,
    count: u64,
    expected: u64,
    /// Part of the file that has been read, though not all of it may be handed over yet.
    least_progress: f32,
}

impl HandedOver<'_> {
    /// Takes records apart and hands them over.
    fn add(&mut self, records: &[u8], out: &mut Output<'_>, progress: &Progress<'_>) -> Result<()> {
        for run in records.chunks(RUN * self.stride) {
            progress.check()?;
            let fraction = self.count as f32 / self.expected as f32;
            progress.set(fraction.max(self.least_progress), READING);
            self.plan.fill(run, &mut self.columns);
            let columns: Vec<&[u8]> = self.columns.iter().map(Vec::as_slice).collect();
            let count = run.len() / self.stride;
            out.rows(count, &columns)?;
            self.count += count as u64;
        }
        Ok(())
    }

    /// Hands over runs that are there, and what is still to be decompressed.
    fn add_packed(
        &mut self,
        packed: &mut Packed<'_>,
        held: Vec<LargeMemory>,
        out: &mut Output<'_>,
        progress: &Progress<'_>,
    ) -> Result<()> {
        let mut held = held.into_iter();
        let (mut run, mut ahead) = (held.next().unwrap_or_default(), LargeMemory::default());
        if run.is_empty() {
            packed.next(&mut run, 0)?;
        }
        while !run.is_empty() {
            self.least_progress = packed.fraction();
            if let Some(next) = held.next() {
                self.add(&run, out, progress)?;
                run = next;
                continue;
            }
            // The next ones are decompressed while the host takes these.
            let mut decompressed = Ok(());
            rayon::in_place_scope(|scope| {
                scope.spawn(|_| decompressed = packed.next(&mut ahead, 1));
                self.add(&run, out, progress)
            })?;
            decompressed?;
            std::mem::swap(&mut run, &mut ahead);
        }
        Ok(())
    }
}

/// The described extra values, each with a name that no other column has.
fn extras_of(header: &Header, out: &mut Output<'_>) -> Vec<Extra> {
    let mut names: Vec<String> = NAMES.map(str::to_owned).to_vec();
    let (mut extras, undescribed) = described(header);
    for extra in &mut extras {
        while names.contains(&extra.name) {
            extra.name.insert_str(0, "extra_");
        }
        names.push(extra.name.clone());
    }
    if undescribed > 0 {
        out.warn(
            &format!(
                "{undescribed} extra bytes a point, which the file does not describe, are left out"
            ),
            1,
        );
    }
    extras
}

/// Bytes before an extended record's data; its length stands in the last 8 of the first 28.
const EXTENDED_RECORD: u64 = 60;

/// Refuses a header whose points no file could hold, or whose extended record goes beyond the file: the library multiplies, and
/// takes memory, without a look.
fn check_size(file: &[u8]) -> Result<()> {
    let Ok(header) = las::raw::Header::read_from(&mut &*file) else {
        // What is wrong with it, the reader says better.
        return Ok(());
    };
    let large = header
        .large_file
        .map_or(0, |large| large.number_of_point_records);
    let points = large.max(u64::from(header.number_of_point_records));
    let bytes = header.point_data_record_length;
    let start = u64::from(header.offset_to_point_data);
    if points
        .checked_mul(u64::from(bytes))
        .and_then(|all| all.checked_add(start))
        .is_none()
    {
        return Err(Error::failed(format!(
            "the header claims {points} points of {bytes} bytes, which no file can hold; the file is damaged, copy it again"
        )));
    }
    let Some(start) = header.evlr.map(|evlr| evlr.start_of_first_evlr) else {
        return Ok(());
    };
    let rest = usize::try_from(start)
        .ok()
        .and_then(|start| file.get(start..))
        .unwrap_or_default();
    // A record that is cut off within its first bytes takes no memory, and the reader says so.
    let length = rest.get(20..).and_then(|bytes| bytes.first_chunk());
    let length = length.map_or(0, |bytes| u64::from_le_bytes(*bytes));
    let most = (rest.len() as u64).saturating_sub(EXTENDED_RECORD);
    if length > most {
        return Err(Error::failed(format!(
            "byte {start}: an extended record claims {length} bytes, found {most}; the file is truncated or damaged, copy it again"
        )));
    }
    Ok(())
}
