//! Text bodies, one line a row.
//!
//! The text is cut at line ends into pieces, whose lines are counted in parallel; then it is known which element each
//! line belongs to, and the pieces are read in parallel. Blank lines do not count.

use std::borrow::Cow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::binary::columns_of;
use super::body::{Body, CornerLists, Corners, Stop, Triangles, corner_from};
use super::error::{Place, PlyError, excerpt};
use super::header::{Element, PlyHeader, PropertyKind};
use super::number::{parse_f64, parse_i64, scan_f64, scan_i64};
use super::plan::{ElementUse, FaceKind, FaceLists};
use super::table::{ByteOrder, Table, write_native};
use super::text::{Piece, Text, Words, has_words, lines_of};
use crate::geometry::ScalarType;
use crate::job::Job;
use crate::load::fill::zeroed_slice;
use crate::warnings::{WarningKind, Warnings};

pub(super) fn read_ascii<'a>(
    file: &'a [u8],
    header: &'a PlyHeader,
    uses: &[ElementUse],
    job: &Job,
    warnings: &mut Warnings,
) -> Result<Body<'a>, Stop> {
    let text = Text::index(&file[header.body_start..], header, job)?;
    let mut body = Body::default();
    let mut first_line = 0;
    for (element, element_use) in header.elements.iter().zip(uses) {
        job.check()?;
        // A row without properties has no words, and blank lines do not count.
        let rows = if element.properties.is_empty() {
            0
        } else {
            element.count
        };
        text.check_room(element, first_line, rows)?;
        let reader = RowReader {
            element,
            text: &text,
            first_line,
            rows,
        };
        match element_use {
            ElementUse::Vertices => body
                .tables
                .push((&element.name, reader.table(job, warnings)?)),
            ElementUse::Faces(lists) => body.faces.push(reader.faces(*lists, job)?),
            ElementUse::Skipped => warnings.add(
                WarningKind::ElementSkipped(element.name.clone()),
                element.count,
            ),
        }
        first_line += rows;
    }
    let left = text.lines - first_line;
    if left > 0 {
        warnings.add(
            WarningKind::Other("lines after the last element ignored".into()),
            left,
        );
    }
    Ok(body)
}

/// Reads the rows of one element.
struct RowReader<'t, 'a> {
    element: &'t Element,
    text: &'t Text<'a>,
    first_line: u64,
    rows: u64,
}

/// Rows of the element in one piece.
struct Part<'t> {
    piece: &'t Piece,
    /// Lines with words to pass over in the piece.
    skip: usize,
    /// Row of the element that comes first.
    first_row: u64,
    rows: usize,
}

impl RowReader<'_, '_> {
    fn parts(&self) -> Vec<Part<'_>> {
        let end_line = self.first_line + self.rows;
        let part = |piece: &'_ Piece| {
            let start = piece.lines_before.max(self.first_line);
            let end = (piece.lines_before + piece.lines).min(end_line);
            (start < end).then_some((start, end))
        };
        let found = self.text.pieces.iter().filter_map(|piece| {
            let (start, end) = part(piece)?;
            Some(Part {
                piece,
                skip: (start - piece.lines_before) as usize,
                first_row: start - self.first_line,
                rows: (end - start) as usize,
            })
        });
        found.collect()
    }

    /// The scalars of all rows, in native byte order.
    fn table(&self, job: &Job, warnings: &mut Warnings) -> Result<Table<'static>, Stop> {
        for property in &self.element.properties {
            if let PropertyKind::List { .. } = property.kind {
                warnings.add(
                    WarningKind::ListPropertySkipped(property.name.clone()),
                    self.rows,
                );
            }
        }
        let widened = widened_positions(self.element);
        let (columns, stride) = columns_of(&widened);
        let rows = self.rows as usize;
        let mut bytes = vec![0; rows * stride];
        let parts = self.parts();
        let shares = share_out(&parts, &mut bytes, stride);
        first_error(shares.into_par_iter().map(|(part, out)| {
            job.check()?;
            let mut rows = out.chunks_exact_mut(stride.max(1));
            self.each_line(part, |line, row, place| {
                let mut words = Words { rest: line };
                let out = rows.next().unwrap_or_default();
                let mut offset = 0;
                for index in 0..widened.properties.len() {
                    match widened.properties[index].kind {
                        PropertyKind::Scalar(scalar) => {
                            let value = self.number(&mut words, index, row, place)?;
                            write_native(scalar, value, &mut out[offset..]);
                            offset += scalar.size();
                        }
                        PropertyKind::List { .. } => {
                            self.skip_property(&mut words, index, row, place)?;
                        }
                    }
                }
                Ok(())
            })
        }))?;
        Ok(Table {
            bytes: Cow::Owned(bytes),
            stride: stride.max(1),
            rows,
            order: ByteOrder::NATIVE,
            columns,
        })
    }

    /// The corners of all rows.
    fn faces(&self, lists: FaceLists, job: &Job) -> Result<Corners, Stop> {
        let parts = self.parts();
        if lists.kind == FaceKind::Polygons
            && lists.holes.is_none()
            && let Some(triangles) = self.all_triangles(&parts, lists, job)?
        {
            return Ok(Corners::Triangles(triangles));
        }
        let empty = || CornerLists {
            kind: lists.kind,
            lengths: Vec::new(),
            corners: Vec::new(),
            with_holes: 0,
        };
        let read = parts.par_iter().map(|part| {
            job.check()?;
            let mut found = empty();
            self.each_line(part, |line, row, place| {
                self.read_corners(line, lists, row, place, &mut found)
            })?;
            Ok(found)
        });
        let read: Vec<Result<CornerLists, Stop>> = read.collect();
        read.into_iter()
            .try_fold(empty(), |mut joined, part| {
                let part = part?;
                joined.lengths.extend(part.lengths);
                joined.corners.extend(part.corners);
                joined.with_holes += part.with_holes;
                Ok(joined)
            })
            .map(Corners::Lists)
    }

    /// The rows as triangles, written in place; `None` if a row has another number of corners.
    fn all_triangles(
        &self,
        parts: &[Part<'_>],
        lists: FaceLists,
        job: &Job,
    ) -> Result<Option<Triangles>, Stop> {
        let mut corners: Arc<[[u32; 3]]> = zeroed_slice(self.rows as usize);
        let slots = Arc::get_mut(&mut corners).expect("just made, nobody else has it");
        let other_length = AtomicBool::new(false);
        let read = share_out(parts, slots, 1)
            .into_par_iter()
            .map(|(part, slots)| {
                job.check()?;
                let (mut max_corner, mut degenerate_count) = (0, 0);
                let mut slots = slots.iter_mut();
                let read = self.each_line(part, |line, row, place| {
                    if other_length.load(Ordering::Relaxed) {
                        return Err(NotTriangles::OtherLength);
                    }
                    let [a, b, c] = self.read_triangle(line, lists, row, place)?;
                    max_corner = max_corner.max(a).max(b).max(c);
                    degenerate_count += u64::from(a == b || b == c || a == c);
                    if let Some(slot) = slots.next() {
                        *slot = [a, b, c];
                    }
                    Ok(())
                });
                match read {
                    Ok(()) => {}
                    Err(NotTriangles::OtherLength) => other_length.store(true, Ordering::Relaxed),
                    Err(NotTriangles::Ply(error)) => return Err(Stop::from(error)),
                }
                Ok((max_corner, degenerate_count))
            });
        let read: Vec<Result<(u32, u64), Stop>> = read.collect();
        if other_length.load(Ordering::Relaxed) {
            // Reading as lists tells the errors too.
            return Ok(None);
        }
        let (mut max_corner, mut degenerate_count) = (0, 0);
        for part in read {
            let (part_max, part_count) = part?;
            max_corner = max_corner.max(part_max);
            degenerate_count += part_count;
        }
        Ok(Some(Triangles {
            corners,
            max_corner,
            degenerate_count,
        }))
    }

    #[inline]
    fn read_triangle(
        &self,
        line: &[u8],
        lists: FaceLists,
        row: u64,
        place: Place,
    ) -> Result<[u32; 3], NotTriangles> {
        let mut words = Words { rest: line };
        let mut triangle = [0; 3];
        for index in 0..self.element.properties.len() {
            if index != lists.corners {
                self.skip_property(&mut words, index, row, place)?;
                continue;
            }
            if self.list_length(&mut words, index, row, place)? != 3 {
                return Err(NotTriangles::OtherLength);
            }
            for corner in &mut triangle {
                *corner = corner_from(self.integer(&mut words, index, row, place)?);
            }
        }
        Ok(triangle)
    }

    fn read_corners(
        &self,
        line: &[u8],
        lists: FaceLists,
        row: u64,
        place: Place,
        found: &mut CornerLists,
    ) -> Result<(), PlyError> {
        let mut words = Words { rest: line };
        for index in 0..self.element.properties.len() {
            if index != lists.corners {
                let length = self.skip_property(&mut words, index, row, place)?;
                found.with_holes += u64::from(Some(index) == lists.holes && length > 0);
                continue;
            }
            let length = self.list_length(&mut words, index, row, place)?;
            for _ in 0..length {
                found
                    .corners
                    .push(corner_from(self.integer(&mut words, index, row, place)?));
            }
            found.lengths.push(length);
        }
        Ok(())
    }

    /// Passes over a property; the words that it had, without a list's length.
    fn skip_property(
        &self,
        words: &mut Words<'_>,
        index: usize,
        row: u64,
        place: Place,
    ) -> Result<u32, PlyError> {
        let length = match self.element.properties[index].kind {
            PropertyKind::Scalar(_) => 1,
            PropertyKind::List { .. } => self.list_length(words, index, row, place)?,
        };
        for _ in 0..length {
            self.word(words, index, row, place)?;
        }
        Ok(length)
    }

    /// Calls `read` with each line of a part, its row and its place, until one fails.
    fn each_line<E>(
        &self,
        part: &Part<'_>,
        mut read: impl FnMut(&[u8], u64, Place) -> Result<(), E>,
    ) -> Result<(), E> {
        let Part {
            piece,
            skip,
            first_row,
            rows,
        } = part;
        let text = &self.text.bytes[piece.start..piece.end];
        let numbered = lines_of(text, self.text.line_end).zip(piece.file_lines_before + 1..);
        let with_words = numbered
            .filter(|(line, _)| has_words(line))
            .skip(*skip)
            .take(*rows);
        for ((line, number), row) in with_words.zip(*first_row + 1..) {
            read(line, row, Place::Line(number))?;
        }
        Ok(())
    }

    #[inline]
    fn word<'w>(
        &self,
        words: &mut Words<'w>,
        index: usize,
        row: u64,
        place: Place,
    ) -> Result<&'w [u8], PlyError> {
        words.next().ok_or_else(|| PlyError::ShortLine {
            place,
            element: self.element.name.clone(),
            row,
            property: self.element.properties[index].name.clone(),
        })
    }

    #[inline]
    fn number(
        &self,
        words: &mut Words<'_>,
        index: usize,
        row: u64,
        place: Place,
    ) -> Result<f64, PlyError> {
        if let Some(value) = words.next_number(scan_f64) {
            return Ok(value);
        }
        let word = self.word(words, index, row, place)?;
        parse_f64(word).ok_or_else(|| self.not_a_number(word, index, row, place))
    }

    #[inline]
    fn integer(
        &self,
        words: &mut Words<'_>,
        index: usize,
        row: u64,
        place: Place,
    ) -> Result<i64, PlyError> {
        if let Some(value) = words.next_number(scan_i64) {
            return Ok(value);
        }
        let word = self.word(words, index, row, place)?;
        parse_i64(word).ok_or_else(|| self.not_a_number(word, index, row, place))
    }

    #[inline]
    fn list_length(
        &self,
        words: &mut Words<'_>,
        index: usize,
        row: u64,
        place: Place,
    ) -> Result<u32, PlyError> {
        let found = self.integer(words, index, row, place)?;
        // Each item takes a word, and a word a byte and a blank.
        let most = words.rest.len() as i64 / 2 + 1;
        u32::try_from(found)
            .ok()
            .filter(|length| i64::from(*length) <= most)
            .ok_or_else(|| PlyError::ListLength {
                place,
                element: self.element.name.clone(),
                row,
                property: self.element.properties[index].name.clone(),
                found,
            })
    }

    #[cold]
    fn not_a_number(&self, word: &[u8], index: usize, row: u64, place: Place) -> PlyError {
        PlyError::Number {
            place,
            element: self.element.name.clone(),
            row,
            property: self.element.properties[index].name.clone(),
            found: excerpt(word),
        }
    }
}

/// The element with x, y and z as doubles: text may hold more digits than the type it declares.
fn widened_positions(element: &Element) -> Element {
    let mut widened = element.clone();
    for property in &mut widened.properties {
        let is_position = ["x", "y", "z"]
            .iter()
            .any(|name| property.name.eq_ignore_ascii_case(name));
        if is_position && property.kind == PropertyKind::Scalar(ScalarType::F32) {
            property.kind = PropertyKind::Scalar(ScalarType::F64);
        }
    }
    widened
}

/// The error of the earliest part that has one, whichever thread came first.
fn first_error(results: impl IndexedParallelIterator<Item = Result<(), Stop>>) -> Result<(), Stop> {
    let all: Vec<Result<(), Stop>> = results.collect();
    all.into_iter().collect()
}

/// Slots for the rows of each part, `width` a row.
fn share_out<'p, 't, 's, T>(
    parts: &'p [Part<'t>],
    slots: &'s mut [T],
    width: usize,
) -> Vec<(&'p Part<'t>, &'s mut [T])> {
    let mut rest = slots;
    let mut shares = Vec::with_capacity(parts.len());
    for part in parts {
        let (mine, others) = rest.split_at_mut(part.rows * width);
        rest = others;
        shares.push((part, mine));
    }
    shares
}

/// Why rows are not all triangles.
enum NotTriangles {
    OtherLength,
    Ply(PlyError),
}

impl From<PlyError> for NotTriangles {
    fn from(error: PlyError) -> Self {
        Self::Ply(error)
    }
}
