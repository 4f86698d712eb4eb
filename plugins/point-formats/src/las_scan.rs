//! LAS, its compressed form LAZ, and COPC, which is a LAZ file with an index that is not needed to read all of it.

use std::io::Cursor;

use las::Header;
use pointstage_plugin_api::loading::{Claim, FileStart, Loader, Output, SourceFile};
use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};

use crate::columns::RUN;
use crate::las_columns::{Colours, Layout, NAMES, Plan, scale_of};
use crate::las_extra::{Extra, described};
use crate::las_pieces::{HandedOver, Stop, warn_of_black};
use crate::las_records::Records;

/// What the progress says.
pub(crate) const READING: &str = "reading points";

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
        let points = Points {
            file: file.bytes,
            start: source.position(),
            header,
        };
        match points.read(None, true, out, progress) {
            Err(Stop::ColoursAre(colours)) => {
                // Of words nothing larger can come; otherwise it is not told before it is known.
                let colours = (colours == Colours::Words).then_some(colours);
                points.read(colours, false, out, progress)
            }
            ended => ended,
        }
        .map_err(|stop| match stop {
            Stop::Failed(error) => error,
            Stop::ColoursAre(_) => Error::failed(
                "its colours changed while it was read; open it again when nobody writes it",
            ),
        })
    }
}

/// The points of a file, of which the records begin at byte `start`.
struct Points<'a> {
    file: &'a [u8],
    start: u64,
    header: Header,
}

impl Points<'_> {
    /// Reads all. How colours are kept is told, or guessed from the first, or found out from all.
    fn read(
        &self,
        colours: Option<Colours>,
        may_guess: bool,
        out: &mut Output<'_>,
        progress: &Progress<'_>,
    ) -> Result<(), Stop> {
        let header = &self.header;
        let records = Records::new(self.file, self.start, header)?;
        // Nothing has been handed over, or what was is forgotten; the host tells whether it could forget again.
        let may_guess = out.begin_again()? && may_guess;
        let extras = extras_of(header, out);
        let (scale, offset) = scale_of(header);
        let knows_scale = out.scaled_positions(scale, offset)?;
        match records {
            Records::Plain(bytes) => {
                let layout = Layout::of(header);
                let colours = Colours::of(layout.largest_colour(bytes));
                if layout.colour.is_some() && colours == Colours::None {
                    warn_of_black(out);
                }
                let plan = Plan::new(header, knows_scale, Some(colours), &extras);
                hand_over(bytes, &plan, out, progress)?;
            }
            Records::Packed(packed) => {
                let plan = Plan::new(header, knows_scale, None, &extras);
                let expected = header.number_of_points();
                let mut handed =
                    HandedOver::new(&plan, colours, may_guess, expected, out, progress)?;
                packed.hand_over(&plan, &mut handed)?;
                handed.finish()?;
            }
        }
        for extra in &extras {
            extra.warn_of_rounded(out);
        }
        Ok(())
    }
}

/// Takes records apart that lie in the file, and hands them over.
fn hand_over(
    records: &[u8],
    plan: &Plan<'_>,
    out: &mut Output<'_>,
    progress: &Progress<'_>,
) -> Result<()> {
    let expected = records.len() / plan.stride();
    out.columns(&plan.columns(), expected as u64)?;
    // Kept for their memory.
    let mut columns = Vec::new();
    for (number, run) in records.chunks(RUN * plan.stride()).enumerate() {
        progress.check()?;
        progress.set((number * RUN) as f32 / expected as f32, READING);
        plan.fill(run, &mut columns);
        let columns: Vec<&[u8]> = columns.iter().map(Vec::as_slice).collect();
        out.rows(run.len() / plan.stride(), &columns)?;
    }
    Ok(())
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
