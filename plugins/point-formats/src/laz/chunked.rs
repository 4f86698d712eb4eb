//! Chunks of the point formats 0 to 5: the first record as it is, then one stream of all fields of all points.

use super::colour::{self, Colours};
use super::decoder::Decoder;
use super::gps_time::GpsTimes;
use super::integer;
use super::lanes::{Incomplete, Lane};
use super::layout::Layout;
use super::model::Symbols;
use super::point10::Points;
use super::wave::{self, Waves};

/// Bytes of a time.
const TIME_BYTES: usize = size_of::<f64>();

/// A chunk that is being decompressed.
pub(super) struct ChunkedLane<'a> {
    decoder: Decoder<'a>,
    points: Points,
    times: Option<GpsTimes>,
    colours: Option<Colours>,
    colour: [u8; colour::BYTES],
    /// Bytes of a record before its colour.
    colour_at: usize,
    waves: Option<Waves>,
    wave: [u8; wave::BYTES],
    extra_bytes: Vec<u8>,
    /// Of each extra byte.
    extra_models: Vec<Symbols>,
}

impl<'a> Lane<'a> for ChunkedLane<'a> {
    fn begin(layout: Layout, input: &'a [u8], first: &mut [u8]) -> Result<Self, Incomplete> {
        let (record, stream) = input.split_at_checked(first.len()).ok_or(Incomplete)?;
        first.copy_from_slice(record);
        let (point, mut fields) = record.split_first_chunk().ok_or(Incomplete)?;
        let mut times = None;
        if layout.has_time {
            let (time, rest) = fields.split_first_chunk().ok_or(Incomplete)?;
            times = Some(GpsTimes::gps_time11(i64::from_le_bytes(*time)));
            fields = rest;
        }
        let extra_count = usize::from(layout.extra_bytes);
        let (others, extra_bytes) = fields
            .split_at_checked(fields.len().saturating_sub(extra_count))
            .ok_or(Incomplete)?;
        let wave = others.last_chunk().copied();
        Ok(Self {
            decoder: Decoder::new(stream),
            points: Points::new(point),
            times,
            colours: layout.has_colour.then(Colours::new),
            colour: others.first_chunk().copied().unwrap_or_default(),
            colour_at: record.len() - fields.len(),
            waves: layout.has_wave.then(Waves::new),
            wave: wave.unwrap_or([0; wave::BYTES]),
            extra_bytes: extra_bytes.to_vec(),
            extra_models: vec![Symbols::new(256); extra_count],
        })
    }

    #[inline(always)]
    fn next<const LANES: usize>(lanes: &mut [Self; LANES], mut records: [&mut [u8]; LANES]) {
        Self::read_positions(lanes);
        for (lane, record) in lanes.iter_mut().zip(&mut records) {
            lane.write_point(record);
        }
        if lanes.iter().any(|lane| lane.colours.is_some()) {
            Self::read_colours(lanes);
            for (lane, record) in lanes.iter().zip(&mut records) {
                let fields = record.get_mut(lane.colour_at..).unwrap_or_default();
                if let Some(out) = fields.first_chunk_mut() {
                    *out = lane.colour;
                }
            }
        }
        for (lane, record) in lanes.iter_mut().zip(records) {
            if lane.waves.is_some() {
                lane.read_wave(record);
            }
            if !lane.extra_bytes.is_empty() {
                lane.read_extra_bytes(record);
            }
        }
    }

    fn is_whole(&self) -> bool {
        self.decoder.is_whole()
    }
}

impl ChunkedLane<'_> {
    #[inline(always)]
    fn read_positions<const LANES: usize>(lanes: &mut [Self; LANES]) {
        for lane in &mut *lanes {
            lane.points.read_attributes(&mut lane.decoder);
        }
        for lane in &mut *lanes {
            lane.points.read_x_size(&mut lane.decoder);
        }
        integer::read_numbers(lanes, |lane| Some((&mut lane.decoder, &mut lane.points.x)));
        for lane in &mut *lanes {
            lane.points.read_y_size(&mut lane.decoder);
        }
        integer::read_numbers(lanes, |lane| Some((&mut lane.decoder, &mut lane.points.y)));
        for lane in &mut *lanes {
            lane.points.read_z_size(&mut lane.decoder);
        }
        integer::read_numbers(lanes, |lane| Some((&mut lane.decoder, &mut lane.points.z)));
    }

    /// Writes the point and reads and writes its time.
    #[inline(always)]
    fn write_point(&mut self, record: &mut [u8]) {
        let Some((point, fields)) = record.split_first_chunk_mut() else {
            return;
        };
        self.points.write(point);
        if let Some(times) = &mut self.times
            && let Some(out) = fields.first_chunk_mut::<TIME_BYTES>()
        {
            *out = times.next(&mut self.decoder).to_le_bytes();
        }
    }

    fn read_wave(&mut self, record: &mut [u8]) {
        if let Some(waves) = &mut self.waves {
            waves.read(&mut self.decoder, &mut self.wave);
        }
        let end = record.len() - self.extra_bytes.len();
        if let Some(out) = record[..end].last_chunk_mut() {
            *out = self.wave;
        }
    }

    /// Reads the item BYTE, version 2, and writes it.
    fn read_extra_bytes(&mut self, record: &mut [u8]) {
        for (byte, model) in self.extra_bytes.iter_mut().zip(&mut self.extra_models) {
            *byte = byte.wrapping_add(self.decoder.symbol(model));
        }
        let at = record.len() - self.extra_bytes.len();
        record[at..].copy_from_slice(&self.extra_bytes);
    }

    #[inline(always)]
    fn read_colours<const LANES: usize>(lanes: &mut [Self; LANES]) {
        for lane in &mut *lanes {
            if let Some(colours) = &mut lane.colours {
                colours.read_change(&mut lane.decoder, lane.colour);
            }
        }
        colour::read_bytes(lanes, |lane| {
            Some((&mut lane.decoder, lane.colours.as_mut()?))
        });
        for lane in lanes {
            if let Some(colours) = &lane.colours {
                lane.colour = colours.colour();
            }
        }
    }
}
