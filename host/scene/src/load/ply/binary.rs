//! Binary bodies, of either byte order.
//!
//! An element without lists is taken as it lies in the file. Faces are first tried as rows of exactly three corners (see
//! `triangles`); if a row disagrees, and for everything else with lists, a cursor walks row by row.

use std::borrow::Cow;

use super::body::{Body, Stop};
use super::error::{Place, PlyError};
use super::face_data::RowExtras;
use super::header::{Element, PlyHeader, PropertyKind};
use super::plan::{ElementUse, FaceLists};
use super::triangles::all_triangles;
use crate::job::Job;
use crate::load::assemble::{
    ByteOrder, CornerLists, Corners, FaceData, FaceKind, Table, TableColumn, corner_from,
    read_integer, read_number,
};
use crate::warnings::{WarningKind, Warnings};

/// Rows read between two looks at the cancel flag.
const ROWS_A_PIECE: usize = 1 << 16;

pub(super) fn read_binary<'a>(
    file: &'a [u8],
    header: &'a PlyHeader,
    uses: &[ElementUse],
    order: ByteOrder,
    job: &Job,
    warnings: &mut Warnings,
) -> Result<Body<'a>, Stop> {
    let mut cursor = Cursor {
        file,
        position: header.body_start,
        order,
    };
    let mut body = Body::default();
    for (element, element_use) in header.elements.iter().zip(uses) {
        job.check()?;
        cursor.check_room(element)?;
        match element_use {
            ElementUse::Vertices => {
                let table = if element.has_lists() {
                    cursor.repack(element, job, warnings)?
                } else {
                    cursor.borrow(element)?
                };
                body.tables.push((&element.name, table));
            }
            ElementUse::Faces(lists) => body.faces.push(cursor.faces(element, *lists, job)?),
            ElementUse::Skipped => {
                warnings.add(
                    WarningKind::ElementSkipped(element.name.clone()),
                    element.count,
                );
                cursor.skip(element, job)?;
            }
        }
    }
    warnings.add(
        WarningKind::TrailingBytesIgnored,
        (file.len() - cursor.position) as u64,
    );
    Ok(body)
}

/// A place in the file that moves on.
struct Cursor<'a> {
    file: &'a [u8],
    position: usize,
    order: ByteOrder,
}

/// Bytes asked for beyond the end of the file: how many are missing.
struct Missing(u64);

impl<'a> Cursor<'a> {
    fn rest(&self) -> &'a [u8] {
        self.file.get(self.position..).unwrap_or_default()
    }

    /// The next `length` bytes.
    #[inline]
    fn take(&mut self, length: u64) -> Result<&'a [u8], Missing> {
        let rest = self.rest();
        let wanted = usize::try_from(length)
            .ok()
            .filter(|wanted| *wanted <= rest.len());
        let wanted = wanted.ok_or_else(|| Missing(length - rest.len() as u64))?;
        self.position += wanted;
        Ok(&rest[..wanted])
    }

    /// Refuses rows that cannot fit before anything is allocated for them.
    fn check_room(&self, element: &Element) -> Result<(), PlyError> {
        let left = self.rest().len() as u64;
        let expected = u128::from(element.count) * element.min_row_size() as u128;
        if expected <= u128::from(left) {
            return Ok(());
        }
        let row_size = element.min_row_size() as u64;
        // A file that ends a little early was cut; one that is far off has a header that lies.
        if element.has_lists() || left / row_size < element.count / 2 {
            return Err(PlyError::TooShort {
                place: Place::Byte(self.position as u64),
                element: element.name.clone(),
                rows: element.count,
                expected: u64::try_from(expected).unwrap_or(u64::MAX),
                found: left,
            });
        }
        let mut inside = left % row_size;
        let ends_in = |property: &&super::header::Property| {
            let size = property.kind.min_size() as u64;
            let here = inside < size;
            inside = inside.saturating_sub(size);
            here
        };
        let property = element
            .properties
            .iter()
            .find(ends_in)
            .map_or(String::new(), |property| property.name.clone());
        Err(PlyError::Truncated {
            place: Place::Byte(self.file.len() as u64),
            element: element.name.clone(),
            row: left / row_size + 1,
            rows: element.count,
            property,
            missing: u64::try_from(expected).unwrap_or(u64::MAX) - left,
        })
    }

    /// An element without lists, as it lies in the file.
    fn borrow(&mut self, element: &Element) -> Result<Table<'a>, PlyError> {
        let (columns, stride) = columns_of(element);
        let rows = element.count as usize;
        let bytes = self
            .take(element.count * stride as u64)
            .map_err(|missing| self.truncated(element, 0, 0, &missing))?;
        Ok(Table {
            bytes: Cow::Borrowed(bytes),
            stride: stride.max(1),
            rows,
            order: self.order,
            columns,
        })
    }

    /// The scalars of an element with lists, copied together; the lists are dropped.
    fn repack(
        &mut self,
        element: &Element,
        job: &Job,
        warnings: &mut Warnings,
    ) -> Result<Table<'a>, Stop> {
        for property in &element.properties {
            if let PropertyKind::List { .. } = property.kind {
                warnings.add(
                    WarningKind::ListPropertySkipped(property.name.clone()),
                    element.count,
                );
            }
        }
        let (columns, stride) = columns_of(element);
        let rows = element.count as usize;
        let mut bytes = Vec::with_capacity(rows * stride);
        for row in 0..element.count {
            if row % ROWS_A_PIECE as u64 == 0 {
                job.check()?;
            }
            for (index, property) in element.properties.iter().enumerate() {
                match property.kind {
                    PropertyKind::Scalar(scalar) => {
                        let value = self.take(scalar.size() as u64);
                        bytes
                            .extend_from_slice(value.map_err(|missing| {
                                self.truncated(element, row, index, &missing)
                            })?);
                    }
                    PropertyKind::List { .. } => {
                        self.list(element, row, index)?;
                    }
                }
            }
        }
        Ok(Table {
            bytes: Cow::Owned(bytes),
            stride: stride.max(1),
            rows,
            order: self.order,
            columns,
        })
    }

    /// Passes over an element.
    fn skip(&mut self, element: &Element, job: &Job) -> Result<(), Stop> {
        if !element.has_lists() {
            let size = element.count * element.min_row_size() as u64;
            self.take(size)
                .map_err(|missing| self.truncated(element, 0, 0, &missing))?;
            return Ok(());
        }
        for row in 0..element.count {
            if row % ROWS_A_PIECE as u64 == 0 {
                job.check()?;
            }
            for index in 0..element.properties.len() {
                self.value(element, row, index)?;
            }
        }
        Ok(())
    }

    /// The corners of an element of faces.
    fn faces(&mut self, element: &Element, lists: FaceLists, job: &Job) -> Result<Corners, Stop> {
        if lists.kind == FaceKind::Polygons
            && lists.holes.is_none()
            && lists.extras.is_empty()
            && let Some((triangles, length)) =
                all_triangles(self.rest(), element, lists.corners, self.order, job)?
        {
            self.position += length;
            return Ok(Corners::Triangles(triangles));
        }
        let mut found = CornerLists {
            kind: lists.kind,
            lengths: Vec::new(),
            corners: Vec::new(),
            with_holes: 0,
            data: FaceData::default(),
        };
        let mut values = Vec::new();
        for row in 0..element.count {
            if row % ROWS_A_PIECE as u64 == 0 {
                job.check()?;
            }
            let mut extras = RowExtras::new(lists.extras);
            for (index, property) in element.properties.iter().enumerate() {
                let (length, bytes) = self.value(element, row, index)?;
                if extras.wants(index) {
                    let scalar = property.kind.scalar();
                    values.clear();
                    values.extend(
                        bytes
                            .chunks_exact(scalar.size())
                            .map(|value| read_number(scalar, value, self.order)),
                    );
                    extras.take(index, scalar, &values, &mut found.data);
                }
                if index == lists.corners {
                    let PropertyKind::List { item, .. } = property.kind else {
                        continue;
                    };
                    found.lengths.push(length);
                    let corner = |bytes| corner_from(read_integer(item, bytes, self.order));
                    found
                        .corners
                        .extend(bytes.chunks_exact(item.size()).map(corner));
                } else if Some(index) == lists.holes && length > 0 {
                    found.with_holes += 1;
                }
            }
            extras.end(found.corners.len(), &mut found.data);
        }
        Ok(Corners::Lists(found))
    }

    /// One property of one row: a list's length and items, or (1, a scalar's bytes).
    #[inline]
    fn value(
        &mut self,
        element: &Element,
        row: u64,
        index: usize,
    ) -> Result<(u32, &'a [u8]), PlyError> {
        match element.properties[index].kind {
            PropertyKind::Scalar(scalar) => {
                let bytes = self.take(scalar.size() as u64);
                Ok((
                    1,
                    bytes.map_err(|missing| self.truncated(element, row, index, &missing))?,
                ))
            }
            PropertyKind::List { .. } => self.list(element, row, index),
        }
    }

    /// One list of one row: its length and its items.
    #[inline]
    fn list(
        &mut self,
        element: &Element,
        row: u64,
        index: usize,
    ) -> Result<(u32, &'a [u8]), PlyError> {
        let PropertyKind::List { length, item } = element.properties[index].kind else {
            return Ok((0, &[]));
        };
        let start = self.position;
        let bytes = self
            .take(length.size() as u64)
            .map_err(|missing| self.truncated(element, row, index, &missing))?;
        let found = read_integer(length, bytes, self.order);
        let bad_length = || PlyError::ListLength {
            place: Place::Byte(start as u64),
            element: element.name.clone(),
            row: row + 1,
            property: element.properties[index].name.clone(),
            found,
        };
        let count = u32::try_from(found).map_err(|_| bad_length())?;
        let items = self.take(u64::from(count) * item.size() as u64);
        // Far more than the file holds is a wrong length; a little more is a cut file.
        let items = items.map_err(|missing| {
            if missing.0 > self.file.len() as u64 {
                bad_length()
            } else {
                self.truncated(element, row, index, &missing)
            }
        })?;
        Ok((count, items))
    }

    fn truncated(&self, element: &Element, row: u64, index: usize, missing: &Missing) -> PlyError {
        PlyError::Truncated {
            place: Place::Byte(self.file.len() as u64),
            element: element.name.clone(),
            row: row + 1,
            rows: element.count,
            property: element
                .properties
                .get(index)
                .map_or(String::new(), |property| property.name.clone()),
            missing: missing.0,
        }
    }
}

/// Columns of the scalars of an element, packed in order, and their size together.
pub(super) fn columns_of(element: &Element) -> (Vec<TableColumn>, usize) {
    let mut stride = 0;
    let column = |property: &super::header::Property| {
        let PropertyKind::Scalar(scalar) = property.kind else {
            return None;
        };
        let offset = stride;
        stride += scalar.size();
        Some(TableColumn {
            name: property.name.clone(),
            scalar,
            offset,
        })
    };
    let columns = element.properties.iter().filter_map(column).collect();
    (columns, stride)
}
