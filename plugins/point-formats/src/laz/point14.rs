//! Points of the formats 6 to 10: item POINT14, version 3.

use super::decoder::Decoder;
use super::gps_time::GpsTimes;
use super::integer::Integers;
use super::median::Median;
use super::model::{Models, Symbols};

/// Bytes of a record.
pub(super) const BYTES: usize = 30;

/// Contexts of x and y by number of returns and return number.
const CONTEXTS: [[u8; 16]; 16] = [
    [0, 1, 2, 3, 4, 5, 3, 4, 4, 5, 5, 5, 5, 5, 5, 5],
    [1, 0, 1, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3],
    [2, 1, 2, 4, 4, 4, 4, 4, 4, 4, 4, 3, 3, 3, 3, 3],
    [3, 3, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4],
    [4, 3, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4],
    [5, 3, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4],
    [3, 3, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4],
    [4, 3, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4],
    [4, 3, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4],
    [5, 3, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4],
    [5, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4],
    [5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 4, 4, 4],
    [5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4, 4],
    [5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4],
    [5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5],
    [5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5],
];

/// A point's fields.
#[derive(Clone, Copy)]
pub(super) struct Point {
    position: [i32; 3],
    intensity: u16,
    /// Return number, then number of returns, of 4 bits each.
    returns: u8,
    /// Of the classification (4 bits), scanner channel (2), scan direction, edge of the flight line.
    flags: u8,
    class: u8,
    user: u8,
    angle: i16,
    source: u16,
    time: i64,
    /// Whether the time differs from that of the point before.
    is_later: bool,
}

impl Point {
    pub(super) fn read(record: &[u8; BYTES]) -> Self {
        let [a, b, c, d, e, f, g, h, i, j, k, l, rest @ ..] = *record;
        let [m, n, returns, flags, class, user, o, p, q, r, time @ ..] = rest;
        Self {
            position: [[a, b, c, d], [e, f, g, h], [i, j, k, l]].map(i32::from_le_bytes),
            intensity: u16::from_le_bytes([m, n]),
            returns,
            flags,
            class,
            user,
            angle: i16::from_le_bytes([o, p]),
            source: u16::from_le_bytes([q, r]),
            time: i64::from_le_bytes(time),
            is_later: false,
        }
    }

    #[inline(always)]
    pub(super) fn write(&self, record: &mut [u8; BYTES]) {
        let [x, y, z] = self.position;
        record[0..4].copy_from_slice(&x.to_le_bytes());
        record[4..8].copy_from_slice(&y.to_le_bytes());
        record[8..12].copy_from_slice(&z.to_le_bytes());
        record[12..14].copy_from_slice(&self.intensity.to_le_bytes());
        record[14] = self.returns;
        record[15] = self.flags;
        record[16] = self.class;
        record[17] = self.user;
        record[18..20].copy_from_slice(&self.angle.to_le_bytes());
        record[20..22].copy_from_slice(&self.source.to_le_bytes());
        record[22..30].copy_from_slice(&self.time.to_le_bytes());
    }

    pub(super) fn channel(&self) -> usize {
        usize::from(self.flags >> 4 & 3)
    }

    fn return_number(&self) -> u8 {
        self.returns & 15
    }

    fn return_count(&self) -> u8 {
        self.returns >> 4
    }

    fn is_first_return(&self) -> bool {
        self.return_number() == 1
    }

    fn is_last_return(&self) -> bool {
        self.return_number() >= self.return_count()
    }
}

/// What the points of one scanner channel so far foretell.
pub(super) struct Channel {
    pub(super) point: Point,
    changes: [Symbols; 8],
    channels: Symbols,
    return_counts: Models,
    return_numbers: Models,
    return_steps: Symbols,
    classes: Models,
    flags: Models,
    users: Models,
    pub(super) x: Integers,
    pub(super) y: Integers,
    pub(super) z: Integers,
    pub(super) intensity: Integers,
    /// These few files have: made when first used.
    angles: Option<Integers>,
    sources: Option<Integers>,
    times: Option<Box<GpsTimes>>,
    medians: [[Median; 2]; 12],
    height_by_level: [i32; 8],
    intensity_by_context: [u16; 8],
    first_time: i64,
    /// Of the point that is being read.
    context: usize,
    level: usize,
    is_single: usize,
    /// First return (2) and last return (1).
    end: usize,
    pub(super) change: u8,
}

/// Bits of a change.
const CHANNEL: u8 = 1 << 6;
const SOURCE: u8 = 1 << 5;
const TIME: u8 = 1 << 4;
const ANGLE: u8 = 1 << 3;
const RETURN_COUNT: u8 = 1 << 2;
const RETURN_NUMBER: u8 = 3;

impl Channel {
    /// A channel of which nothing has come yet, after a point of another or the chunk's first.
    pub(super) fn after(point: &Point) -> Self {
        let change = Symbols::new(128);
        let integers = Integers::new(32, 0);
        let of_contexts = |contexts| integers.with_contexts(contexts);
        Self {
            point: Point {
                is_later: false,
                ..*point
            },
            changes: std::array::from_fn(|_| change.clone()),
            channels: Symbols::new(3),
            return_counts: Models::new(16, 16),
            return_numbers: Models::new(16, 16),
            return_steps: Symbols::new(13),
            classes: Models::new(64, 256),
            flags: Models::new(64, 64),
            users: Models::new(64, 256),
            x: of_contexts(2),
            y: of_contexts(22),
            z: of_contexts(20),
            intensity: Integers::new(16, 4),
            angles: None,
            sources: None,
            times: None,
            medians: [[Median::NEW; 2]; 12],
            height_by_level: [point.position[2]; 8],
            intensity_by_context: [point.intensity; 8],
            first_time: point.time,
            context: 0,
            level: 0,
            is_single: 0,
            end: 0,
            change: 0,
        }
    }

    /// Reads what differs from the last point; returns the channel of the point if it is another.
    #[inline(always)]
    pub(super) fn read_change(&mut self, decoder: &mut Decoder<'_>) -> Option<usize> {
        let point = &self.point;
        let context = usize::from(point.is_first_return())
            | usize::from(point.is_last_return()) << 1
            | usize::from(point.is_later) << 2;
        self.change = decoder.foretold_symbol(&mut self.changes[context]);
        if self.change & CHANNEL == 0 {
            return None;
        }
        let step = decoder.symbol(&mut self.channels);
        Some((point.channel() + usize::from(step) + 1) & 3)
    }

    /// Makes this the point's channel.
    pub(super) fn enter(&mut self, channel: usize, change: u8) {
        self.point.flags = self.point.flags & !(3 << 4) | (channel as u8 & 3) << 4;
        self.change = change;
    }

    /// Reads the returns, and how many bits x takes.
    #[inline(always)]
    pub(super) fn read_x_size(&mut self, decoder: &mut Decoder<'_>) {
        if self.change & (RETURN_COUNT | RETURN_NUMBER) != 0 {
            self.read_returns(decoder);
        }
        self.point.is_later = self.change & TIME != 0;
        let (number, count) = (self.point.return_number(), self.point.return_count());
        let context = CONTEXTS[usize::from(count)][usize::from(number)];
        self.context = usize::from(context) << 1 | usize::from(self.point.is_later);
        self.level = usize::from(count.abs_diff(number).min(7));
        self.is_single = usize::from(count == 1);
        self.end = usize::from(self.point.is_first_return()) << 1
            | usize::from(self.point.is_last_return());
        self.x.read_size(decoder, self.is_single);
    }

    fn read_returns(&mut self, decoder: &mut Decoder<'_>) {
        let (last, mut count) = (self.point.return_number(), self.point.return_count());
        if self.change & RETURN_COUNT != 0 {
            count = decoder.symbol(self.return_counts.get(count.into())) & 15;
        }
        let number = match self.change & RETURN_NUMBER {
            0 => last,
            1 => last + 1,
            2 => last + 15,
            _ if self.change & TIME != 0 => decoder.symbol(self.return_numbers.get(last.into())),
            _ => last + decoder.symbol(&mut self.return_steps) + 2,
        };
        self.point.returns = number & 15 | count << 4;
    }

    /// Once x has been read.
    #[inline(always)]
    pub(super) fn read_y_size(&mut self, decoder: &mut Decoder<'_>) {
        let median = &mut self.medians[self.context][0];
        let difference = self.x.number(median.get());
        median.add(difference);
        self.point.position[0] = self.point.position[0].wrapping_add(difference);
        let size = self.x.size.min(20) & !1;
        self.y.read_size(decoder, self.is_single + size as usize);
    }

    /// Once y has been read.
    #[inline(always)]
    pub(super) fn take_y(&mut self) {
        let median = &mut self.medians[self.context][1];
        let difference = self.y.number(median.get());
        median.add(difference);
        self.point.position[1] = self.point.position[1].wrapping_add(difference);
    }

    #[inline(always)]
    pub(super) fn read_z_size(&mut self, decoder: &mut Decoder<'_>) {
        let size = self.x.size.midpoint(self.y.size).min(18) & !1;
        self.z.read_size(decoder, self.is_single + size as usize);
    }

    /// Once z has been read.
    #[inline(always)]
    pub(super) fn take_z(&mut self) {
        let height = &mut self.height_by_level[self.level];
        *height = self.z.number(*height);
        self.point.position[2] = *height;
    }

    #[inline(always)]
    pub(super) fn read_intensity_size(&mut self, decoder: &mut Decoder<'_>) {
        self.intensity.read_size(decoder, self.end);
    }

    /// Once the intensity has been read.
    #[inline(always)]
    pub(super) fn take_intensity(&mut self) {
        let context = self.end << 1 | usize::from(self.point.is_later);
        let last = &mut self.intensity_by_context[context & 7];
        *last = self.intensity.number((*last).into()) as u16;
        self.point.intensity = *last;
    }

    pub(super) fn read_class(&mut self, decoder: &mut Decoder<'_>) {
        let context = usize::from(self.point.class & 31) << 1 | usize::from(self.end == 3);
        self.point.class = decoder.symbol(self.classes.get(context));
    }

    pub(super) fn read_flags(&mut self, decoder: &mut Decoder<'_>) {
        let last = self.point.flags;
        let context = last & 15 | last >> 2 & 0b11_0000;
        let flags = decoder.symbol(self.flags.get(context.into()));
        self.point.flags = last & 0b11_0000 | flags & 15 | (flags & 0b11_0000) << 2;
    }

    pub(super) fn read_angle(&mut self, decoder: &mut Decoder<'_>) {
        if self.change & ANGLE != 0 {
            let angles = self.angles.get_or_insert_with(|| Integers::new(16, 2));
            let context = usize::from(self.point.is_later);
            self.point.angle = angles.read(decoder, self.point.angle.into(), context) as i16;
        }
    }

    pub(super) fn read_user(&mut self, decoder: &mut Decoder<'_>) {
        let context = usize::from(self.point.user / 4);
        self.point.user = decoder.symbol(self.users.get(context));
    }

    pub(super) fn read_source(&mut self, decoder: &mut Decoder<'_>) {
        if self.change & SOURCE != 0 {
            let sources = self.sources.get_or_insert_with(|| Integers::new(16, 1));
            self.point.source = sources.read(decoder, self.point.source.into(), 0) as u16;
        }
    }

    pub(super) fn read_time(&mut self, decoder: &mut Decoder<'_>) {
        if self.point.is_later {
            let first = self.first_time;
            let times = self
                .times
                .get_or_insert_with(|| Box::new(GpsTimes::point14(first)));
            self.point.time = times.next(decoder);
        }
    }
}
