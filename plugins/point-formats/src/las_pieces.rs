//! Columns of decompressed records, chunk by chunk, and how they go to the host.
//!
//! Whether colours are bytes or words of 16 bits, or all black, no header says, only the largest component of all. So they are
//! kept as words until they are handed over, and the first chunk tells for all how: should a later one show that it was too dark
//! for that, the file is read again. By a host that cannot begin again chunks wait until it is known.

use pointstage_plugin_api::loading::Output;
use pointstage_plugin_api::{Error, Progress, Result};

use crate::las_columns::{Colours, Plan};
use crate::las_scan::READING;
use crate::laz::Taker;

/// The columns of some records.
#[derive(Debug, Default)]
pub(crate) struct Piece {
    pub(crate) columns: Vec<Vec<u8>>,
    pub(crate) count: usize,
    /// Of all components of colours.
    pub(crate) largest_colour: u16,
}

impl Taker for Plan<'_> {
    type Piece = Piece;

    fn begin(&self, piece: &mut Piece, count: usize) {
        piece.columns.resize_with(self.widths().count(), Vec::new);
        for (column, width) in piece.columns.iter_mut().zip(self.widths()) {
            let length = count * width;
            if column.capacity() < length {
                // Zeros that the system gives, which nobody need write.
                *column = vec![0; length];
            } else {
                column.resize(length, 0);
            }
        }
        piece.count = count;
        piece.largest_colour = 0;
    }

    fn add(&self, piece: &mut Piece, first: usize, records: &[u8]) {
        let count = records.len() / self.stride();
        let columns = piece.columns.iter_mut().zip(self.widths());
        let slots =
            columns.map(|(column, width)| &mut column[first * width..(first + count) * width]);
        self.take_apart(records, slots);
        if let Some(part) = self.colour() {
            const WIDTH: usize = 3 * size_of::<u16>();
            let components = &piece.columns[part][first * WIDTH..(first + count) * WIDTH];
            let components = components.as_chunks().0.iter();
            let largest = components
                .map(|component| u16::from_ne_bytes(*component))
                .max();
            piece.largest_colour = piece.largest_colour.max(largest.unwrap_or_default());
        }
    }
}

/// Why no more pieces are taken.
#[derive(Debug)]
pub(crate) enum Stop {
    /// Colours were taken for darker ones; they are at least this.
    ColoursAre(Colours),
    Failed(Error),
}

impl From<Error> for Stop {
    fn from(error: Error) -> Self {
        Self::Failed(error)
    }
}

/// Pieces on their way to the host.
pub(crate) struct HandedOver<'a, 'o> {
    plan: &'a Plan<'a>,
    out: &'a mut Output<'o>,
    progress: &'a Progress<'a>,
    expected: u64,
    count: u64,
    /// Once that is known.
    colours: Option<Colours>,
    may_begin_again: bool,
    /// Those that came before it was known.
    held: Vec<Piece>,
    /// Colours of the piece at hand, as bytes.
    bytes: Vec<u8>,
}

impl<'a, 'o> HandedOver<'a, 'o> {
    /// Of a file of so many points, the colours of which are known or not.
    ///
    /// # Errors
    /// The host's.
    pub(crate) fn new(
        plan: &'a Plan<'a>,
        colours: Option<Colours>,
        may_begin_again: bool,
        expected: u64,
        out: &'a mut Output<'o>,
        progress: &'a Progress<'a>,
    ) -> Result<Self> {
        let mut new = Self {
            plan,
            out,
            progress,
            expected,
            count: 0,
            colours: None,
            may_begin_again,
            held: Vec::new(),
            bytes: Vec::new(),
        };
        let colours = if plan.colour().is_some() {
            colours
        } else {
            Some(Colours::None)
        };
        if let Some(colours) = colours {
            new.begin(colours)?;
        }
        Ok(new)
    }

    /// Points that came so far.
    pub(crate) fn taken(&self) -> u64 {
        let held: usize = self.held.iter().map(|piece| piece.count).sum();
        self.count + held as u64
    }

    /// Takes the next piece; gives it back when it may be overwritten.
    ///
    /// # Errors
    /// [`Stop`].
    pub(crate) fn take(&mut self, piece: Piece) -> Result<Option<Piece>, Stop> {
        self.progress.check()?;
        let found = Colours::of(piece.largest_colour);
        match self.colours {
            Some(colours) if colours < found => return Err(Stop::ColoursAre(found)),
            Some(_) => {}
            None if found == Colours::Words || self.may_begin_again => self.begin(found)?,
            None => {
                self.held.push(piece);
                self.progress
                    .set(self.taken() as f32 / self.expected as f32, READING);
                return Ok(None);
            }
        }
        self.hand_over(&piece)?;
        Ok(Some(piece))
    }

    /// Hands over what was held back.
    ///
    /// # Errors
    /// The host's.
    pub(crate) fn finish(mut self) -> Result<()> {
        if self.colours.is_none() {
            let largest = self.held.iter().map(|piece| piece.largest_colour).max();
            self.begin(Colours::of(largest.unwrap_or_default()))?;
        }
        if self.plan.colour().is_some() && self.colours == Some(Colours::None) {
            warn_of_black(self.out);
        }
        Ok(())
    }

    /// Declares the columns, now that it is known how colours are kept, and hands over what waited for that.
    fn begin(&mut self, colours: Colours) -> Result<()> {
        self.colours = Some(colours);
        let mut columns = self.plan.columns();
        if colours == Colours::None
            && let Some(part) = self.plan.colour()
        {
            columns.remove(part);
        }
        self.out.columns(&columns, self.expected)?;
        for piece in std::mem::take(&mut self.held) {
            self.progress.check()?;
            self.hand_over(&piece)?;
        }
        Ok(())
    }

    fn hand_over(&mut self, piece: &Piece) -> Result<()> {
        let colours = self.colours.unwrap_or(Colours::None);
        let mut columns: Vec<&[u8]> = piece.columns.iter().map(Vec::as_slice).collect();
        if let Some(part) = self.plan.colour() {
            if colours == Colours::None {
                columns.remove(part);
            } else {
                colours.bytes_of(columns[part], &mut self.bytes);
                columns[part] = &self.bytes;
            }
        }
        self.out.rows(piece.count, &columns)?;
        self.count += piece.count as u64;
        self.progress
            .set(self.count as f32 / self.expected as f32, READING);
        Ok(())
    }
}

/// Tells that colours are left out.
pub(crate) fn warn_of_black(out: &mut Output<'_>) {
    out.warn(
        "the file has colours, but all are black: they are left out",
        1,
    );
}
