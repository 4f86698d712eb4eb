//! Text bodies, one line a row.
//!
//! The text is cut at line ends into pieces, whose lines are counted in parallel (`text`); then it is known which element
//! each line belongs to, and the pieces are read in parallel, each row (`row`) word by word (`words`). Blank lines do not
//! count. What threads make goes straight to its place, and a piece that was read is given back to the system, so that
//! memory holds the result and little more.

use std::borrow::Cow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::binary::columns_of;
use super::body::{Body, Stop};
use super::error::PlyError;
use super::face_data::RowExtras;
use super::header::{Element, PlyHeader, PropertyKind};
use super::plan::{ElementUse, FaceLists};
use super::row::{Fault, Row};
use super::text::{Piece, Text};
use crate::geometry::ScalarType;
use crate::job::Job;
use crate::load::assemble::{
    ByteOrder, CornerLists, Corners, FaceData, FaceKind, Table, Triangles, corner_from,
    write_native,
};
use crate::load::memory::zeroed_slice;
use crate::load::source::Source;
use crate::warnings::{WarningKind, Warnings};

pub(super) fn read_ascii<'a>(
    file: &'a Source,
    header: &'a PlyHeader,
    uses: &[ElementUse],
    job: &Job,
    warnings: &mut Warnings,
) -> Result<Body<'a>, Stop> {
    let text = Text::index(file, header, job)?;
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
            let mut slots = out.chunks_exact_mut(stride.max(1));
            let read = self.each_row(part, |row| {
                let slot = slots.next().unwrap_or_default();
                let mut offset = 0;
                for (index, property) in widened.properties.iter().enumerate() {
                    match property.kind {
                        PropertyKind::Scalar(scalar) => {
                            write_native(scalar, row.number(index)?, &mut slot[offset..]);
                            offset += scalar.size();
                        }
                        PropertyKind::List { .. } => {
                            row.skip(index, property.kind)?;
                        }
                    }
                }
                Ok(())
            });
            read.map_err(Stop::from)
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
            && lists.extras.is_empty()
            && let Some(triangles) = self.all_triangles(&parts, lists, job)?
        {
            return Ok(Corners::Triangles(triangles));
        }
        let empty = || CornerLists {
            kind: lists.kind,
            lengths: Vec::new(),
            corners: Vec::new(),
            with_holes: 0,
            data: FaceData::default(),
        };
        let read = parts.par_iter().map(|part| {
            job.check()?;
            let mut found = empty();
            self.each_row(part, |row| self.read_corners(row, lists, &mut found))?;
            Ok(found)
        });
        let read: Vec<Result<CornerLists, Stop>> = read.collect();
        read.into_iter()
            .try_fold(empty(), |mut joined, part| {
                let part = part?;
                joined.lengths.extend(part.lengths);
                joined.corners.extend(part.corners);
                joined.with_holes += part.with_holes;
                joined.data.append(part.data);
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
                self.each_row(part, |row| {
                    if other_length.load(Ordering::Relaxed) {
                        return Ok(());
                    }
                    let Some([a, b, c]) = self.read_triangle(row, lists)? else {
                        other_length.store(true, Ordering::Relaxed);
                        return Ok(());
                    };
                    max_corner = max_corner.max(a).max(b).max(c);
                    degenerate_count += u64::from(a == b || b == c || a == c);
                    if let Some(slot) = slots.next() {
                        *slot = [a, b, c];
                    }
                    Ok(())
                })?;
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

    /// `None` if the row has another number of corners.
    #[inline]
    fn read_triangle(
        &self,
        row: &mut Row<'_>,
        lists: FaceLists,
    ) -> Result<Option<[u32; 3]>, Fault> {
        let mut triangle = [0; 3];
        for (index, property) in self.element.properties.iter().enumerate() {
            if index != lists.corners {
                row.skip(index, property.kind)?;
                continue;
            }
            if row.list_length(index)? != 3 {
                return Ok(None);
            }
            for corner in &mut triangle {
                *corner = corner_from(row.integer(index)?);
            }
        }
        Ok(Some(triangle))
    }

    fn read_corners(
        &self,
        row: &mut Row<'_>,
        lists: FaceLists,
        found: &mut CornerLists,
    ) -> Result<(), Fault> {
        let mut extras = RowExtras::new(lists.extras);
        for (index, property) in self.element.properties.iter().enumerate() {
            if extras.wants(index) {
                let values = row.values(index, property.kind)?;
                extras.take(index, property.kind.scalar(), &values, &mut found.data);
                continue;
            }
            if index != lists.corners {
                let length = row.skip(index, property.kind)?;
                found.with_holes += u64::from(Some(index) == lists.holes && length > 0);
                continue;
            }
            let length = row.list_length(index)?;
            for _ in 0..length {
                found.corners.push(corner_from(row.integer(index)?));
            }
            found.lengths.push(length);
        }
        extras.end(found.corners.len(), &mut found.data);
        Ok(())
    }

    /// Calls `read` with each row of a part until one fails.
    fn each_row(
        &self,
        part: &Part<'_>,
        mut read: impl FnMut(&mut Row<'_>) -> Result<(), Fault>,
    ) -> Result<(), PlyError> {
        let Part {
            piece,
            skip,
            first_row,
            rows,
        } = part;
        let mut row = Row::new(self.text.words(piece));
        for _ in 0..*skip {
            row.start();
            row.end();
        }
        for number in (*first_row + 1..).take(*rows) {
            row.start();
            let rest = row.rest();
            read(&mut row).map_err(|fault| {
                let line = self.text.line_of(piece, rest);
                fault.into_error(self.element, number, line)
            })?;
            row.end();
        }
        self.text.release(piece);
        Ok(())
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
