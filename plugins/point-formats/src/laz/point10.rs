//! Points of the formats 0 to 5: item POINT10, version 2.

use super::decoder::Decoder;
use super::integer::Integers;
use super::median::Median;
use super::model::{Models, Symbols};

/// Contexts by number of returns and return number.
const CONTEXTS: [[u8; 8]; 8] = [
    [15, 14, 13, 12, 11, 10, 9, 8],
    [14, 0, 1, 3, 6, 10, 10, 9],
    [13, 1, 2, 4, 7, 11, 11, 10],
    [12, 3, 4, 5, 8, 12, 12, 11],
    [11, 6, 7, 8, 9, 13, 13, 12],
    [10, 10, 11, 12, 13, 14, 14, 13],
    [9, 10, 11, 12, 13, 14, 15, 14],
    [8, 9, 10, 11, 12, 13, 14, 15],
];

/// Bytes of a record.
pub(super) const BYTES: usize = 20;

/// What the points so far foretell. One is read in steps, so that another chunk's can go between.
pub(super) struct Points {
    position: [i32; 3],
    intensity: u16,
    /// Return number, number of returns, scan direction, edge of the flight line.
    returns: u8,
    class: u8,
    angle: u8,
    user: u8,
    source: u16,
    changes: Symbols,
    all_returns: Models,
    classes: Models,
    angles: Models,
    users: Models,
    intensities: Integers,
    sources: Integers,
    pub(super) x: Integers,
    pub(super) y: Integers,
    pub(super) z: Integers,
    intensity_by_context: [u16; 16],
    medians: [[Median; 2]; 16],
    height_by_level: [i32; 8],
    /// Of the point that is being read.
    context: usize,
    level: usize,
    is_single: usize,
}

impl Points {
    pub(super) fn new(first: &[u8; BYTES]) -> Self {
        let number = |at: usize| [0, 1, 2, 3].map(|byte| first[at + byte]);
        Self {
            position: [0, 4, 8].map(|at| i32::from_le_bytes(number(at))),
            // Not that of the first point: so LASzip writes them.
            intensity: 0,
            returns: first[14],
            class: first[15],
            angle: first[16],
            user: first[17],
            source: u16::from_le_bytes([first[18], first[19]]),
            changes: Symbols::new(64),
            all_returns: Models::new(256, 256),
            classes: Models::new(256, 256),
            angles: Models::new(2, 256),
            users: Models::new(256, 256),
            intensities: Integers::new(16, 4),
            sources: Integers::new(16, 1),
            x: Integers::new(32, 2),
            y: Integers::new(32, 22),
            z: Integers::new(32, 20),
            intensity_by_context: [0; 16],
            medians: [[Median::NEW; 2]; 16],
            height_by_level: [0; 8],
            context: 0,
            level: 0,
            is_single: 0,
        }
    }

    /// Reads everything but the position.
    #[inline(always)]
    pub(super) fn read_attributes(&mut self, decoder: &mut Decoder<'_>) {
        let change = decoder.foretold_symbol(&mut self.changes);
        if change & 32 != 0 {
            let model = self.all_returns.get(self.returns.into());
            self.returns = decoder.symbol(model);
        }
        let (number, count) = (self.returns & 7, self.returns >> 3 & 7);
        self.context = CONTEXTS[usize::from(count)][usize::from(number)].into();
        self.level = count.abs_diff(number).into();
        self.is_single = usize::from(count == 1);
        if change != 0 {
            self.read_changed(decoder, change);
        }
    }

    fn read_changed(&mut self, decoder: &mut Decoder<'_>, change: u8) {
        let last = &mut self.intensity_by_context[self.context & 15];
        if change & 16 != 0 {
            let context = self.context.min(3);
            *last = self.intensities.read(decoder, (*last).into(), context) as u16;
        }
        self.intensity = *last;
        if change & 8 != 0 {
            self.class = decoder.symbol(self.classes.get(self.class.into()));
        }
        if change & 4 != 0 {
            let direction = self.returns >> 6 & 1;
            let difference = decoder.symbol(self.angles.get(direction.into()));
            self.angle = self.angle.wrapping_add(difference);
        }
        if change & 2 != 0 {
            self.user = decoder.symbol(self.users.get(self.user.into()));
        }
        if change & 1 != 0 {
            self.source = self.sources.read(decoder, self.source.into(), 0) as u16;
        }
    }

    #[inline(always)]
    pub(super) fn read_x_size(&mut self, decoder: &mut Decoder<'_>) {
        self.x.read_size(decoder, self.is_single);
    }

    /// Once x has been read.
    #[inline(always)]
    pub(super) fn read_y_size(&mut self, decoder: &mut Decoder<'_>) {
        let median = &mut self.medians[self.context & 15][0];
        let difference = self.x.number(median.get());
        median.add(difference);
        self.position[0] = self.position[0].wrapping_add(difference);
        let size = self.x.size.min(20) & !1;
        self.y.read_size(decoder, self.is_single + size as usize);
    }

    /// Once y has been read.
    #[inline(always)]
    pub(super) fn read_z_size(&mut self, decoder: &mut Decoder<'_>) {
        let median = &mut self.medians[self.context & 15][1];
        let difference = self.y.number(median.get());
        median.add(difference);
        self.position[1] = self.position[1].wrapping_add(difference);
        let size = (self.x.size.midpoint(self.y.size)).min(18) & !1;
        self.z.read_size(decoder, self.is_single + size as usize);
    }

    /// Once z has been read: the record.
    #[inline(always)]
    pub(super) fn write(&mut self, out: &mut [u8; BYTES]) {
        let height = &mut self.height_by_level[self.level & 7];
        *height = self.z.number(*height);
        self.position[2] = *height;
        let [x, y, z] = self.position;
        out[0..4].copy_from_slice(&x.to_le_bytes());
        out[4..8].copy_from_slice(&y.to_le_bytes());
        out[8..12].copy_from_slice(&z.to_le_bytes());
        out[12..14].copy_from_slice(&self.intensity.to_le_bytes());
        out[14] = self.returns;
        out[15] = self.class;
        out[16] = self.angle;
        out[17] = self.user;
        out[18..20].copy_from_slice(&self.source.to_le_bytes());
    }
}
