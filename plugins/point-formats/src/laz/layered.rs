//! Chunks of the point formats 6 to 10: the first record as it is, then a stream for each field of all points.

use super::by_channel::{ByChannel, CHANNELS};
use super::colour::{self, Colours};
use super::decoder::Decoder;
use super::infrared::{self, Infrared};
use super::integer;
use super::lanes::{Incomplete, Lane};
use super::layout::{Layout, Version};
use super::model::Symbols;
use super::point14::{Channel, Point};
use super::wave::{self, Waves};

/// Streams of a point.
const POINT_STREAMS: usize = 9;

/// A chunk that is being decompressed. Fields that are all the same have no stream.
pub(super) struct LayeredLane<'a> {
    /// Channel, returns, x and y.
    decoder: Decoder<'a>,
    z: Option<Decoder<'a>>,
    class: Option<Decoder<'a>>,
    flags: Option<Decoder<'a>>,
    intensity: Option<Decoder<'a>>,
    angle: Option<Decoder<'a>>,
    user: Option<Decoder<'a>>,
    source: Option<Decoder<'a>>,
    time: Option<Decoder<'a>>,
    /// The channel of the last point.
    channel: Box<Channel>,
    /// Those that had points before.
    others: [Option<Box<Channel>>; CHANNELS],
    version: Version,
    colours: Option<Layer<'a, Colours, { colour::BYTES }>>,
    infrared: Option<Layer<'a, Infrared, { infrared::BYTES }>>,
    waves: Option<Layer<'a, Waves, { wave::BYTES }>>,
    extra_bytes: Option<LayeredBytes<'a>>,
}

impl<'a> Lane<'a> for LayeredLane<'a> {
    fn begin(layout: Layout, input: &'a [u8], first: &mut [u8]) -> Result<Self, Incomplete> {
        let (record, streams) = input.split_at_checked(first.len()).ok_or(Incomplete)?;
        first.copy_from_slice(record);
        let (point, fields) = record.split_first_chunk().ok_or(Incomplete)?;
        let point = Point::read(point);
        let channel = point.channel();
        let extra_count = usize::from(layout.extra_bytes);
        // The number of points, which the table of chunks tells too.
        let (_, sizes) = streams.split_first_chunk::<4>().ok_or(Incomplete)?;
        let stream_count = POINT_STREAMS
            + usize::from(layout.has_colour)
            + usize::from(layout.has_infrared)
            + usize::from(layout.has_wave)
            + extra_count;
        let (sizes, mut rest) = sizes.split_at_checked(4 * stream_count).ok_or(Incomplete)?;
        let (sizes, _) = sizes.as_chunks();
        let mut sizes = sizes.iter().map(|size| u32::from_le_bytes(*size) as usize);
        let mut stream = || {
            let size = sizes.next().ok_or(Incomplete)?;
            let (stream, behind) = rest.split_at_checked(size).ok_or(Incomplete)?;
            rest = behind;
            Ok((size > 0).then(|| Decoder::new(stream)))
        };
        let mut behind = Behind { channel, fields };
        // The streams lie in this order.
        Ok(Self {
            decoder: stream()?.ok_or(Incomplete)?,
            z: stream()?,
            class: stream()?,
            flags: stream()?,
            intensity: stream()?,
            angle: stream()?,
            user: stream()?,
            source: stream()?,
            time: stream()?,
            channel: Box::new(Channel::after(&point)),
            others: [const { None }; CHANNELS],
            version: layout.version,
            colours: behind.layer(layout.has_colour, &mut stream, Colours::new)?,
            infrared: behind.layer(layout.has_infrared, &mut stream, Infrared::new)?,
            waves: behind.layer(layout.has_wave, &mut stream, Waves::new)?,
            extra_bytes: LayeredBytes::new(&behind, extra_count, &mut stream)?,
        })
    }

    #[inline(always)]
    fn next<const LANES: usize>(lanes: &mut [Self; LANES], records: [&mut [u8]; LANES]) {
        Self::read_positions(lanes);
        Self::read_intensities(lanes);
        if lanes.iter().any(|lane| lane.colours.is_some()) {
            Self::read_colours(lanes);
        }
        for (lane, record) in lanes.iter_mut().zip(records) {
            lane.read_rest();
            let Some((point, fields)) = record.split_first_chunk_mut() else {
                return;
            };
            lane.channel.point.write(point);
            lane.write_fields(fields);
        }
    }

    fn is_whole(&self) -> bool {
        let colour = self.colours.as_ref();
        let infrared = self.infrared.as_ref();
        let waves = self.waves.as_ref();
        let extra_bytes = self.extra_bytes.iter().flat_map(|bytes| &bytes.decoders);
        let streams = [
            Some(&self.decoder),
            self.z.as_ref(),
            self.class.as_ref(),
            self.flags.as_ref(),
            self.intensity.as_ref(),
            self.angle.as_ref(),
            self.user.as_ref(),
            self.source.as_ref(),
            self.time.as_ref(),
            colour.and_then(|colours| colours.decoder.as_ref()),
            infrared.and_then(|infrared| infrared.decoder.as_ref()),
            waves.and_then(|waves| waves.decoder.as_ref()),
        ];
        let mut streams = streams.into_iter().flatten();
        streams.all(Decoder::is_whole) && extra_bytes.flatten().all(Decoder::is_whole)
    }
}

impl LayeredLane<'_> {
    #[inline(always)]
    fn read_positions<const LANES: usize>(lanes: &mut [Self; LANES]) {
        for lane in &mut *lanes {
            let entered = lane.channel.read_change(&mut lane.decoder);
            if let Some(channel) = entered {
                lane.enter(channel);
            }
            lane.enter_fields(entered);
            lane.channel.read_x_size(&mut lane.decoder);
        }
        integer::read_numbers(lanes, |lane| Some((&mut lane.decoder, &mut lane.channel.x)));
        for lane in &mut *lanes {
            lane.channel.read_y_size(&mut lane.decoder);
        }
        integer::read_numbers(lanes, |lane| Some((&mut lane.decoder, &mut lane.channel.y)));
        for lane in &mut *lanes {
            lane.channel.take_y();
            if let Some(decoder) = &mut lane.z {
                lane.channel.read_z_size(decoder);
            }
        }
        integer::read_numbers(lanes, |lane| Some((lane.z.as_mut()?, &mut lane.channel.z)));
        for lane in lanes {
            if lane.z.is_some() {
                lane.channel.take_z();
            }
        }
    }

    /// Goes to another scanner channel.
    #[cold]
    fn enter(&mut self, channel: usize) {
        let change = self.channel.change;
        let next = self.others[channel]
            .take()
            .unwrap_or_else(|| Box::new(Channel::after(&self.channel.point)));
        let last = std::mem::replace(&mut self.channel, next);
        let left = last.point.channel();
        self.others[left] = Some(last);
        self.channel.enter(channel, change);
    }

    /// Lets the items behind the point go on to the next.
    #[inline(always)]
    fn enter_fields(&mut self, entered: Option<usize>) {
        let channel = match self.version {
            Version::Fourth => self.channel.point.channel(),
            _ => entered.unwrap_or_default(),
        };
        if let Some(colours) = &mut self.colours {
            colours.channels.enter(self.version, channel, Colours::new);
        }
        if let Some(infrared) = &mut self.infrared {
            infrared
                .channels
                .enter(self.version, channel, Infrared::new);
        }
        if let Some(waves) = &mut self.waves {
            waves.channels.enter(self.version, channel, Waves::new);
        }
        if let Some(bytes) = &mut self.extra_bytes {
            let count = bytes.decoders.len();
            let models = || LayeredBytes::models(count);
            bytes.channels.enter(self.version, channel, models);
        }
    }

    #[inline(always)]
    fn read_intensities<const LANES: usize>(lanes: &mut [Self; LANES]) {
        for lane in &mut *lanes {
            if let Some(decoder) = &mut lane.intensity {
                lane.channel.read_intensity_size(decoder);
            }
        }
        integer::read_numbers(lanes, |lane| {
            Some((lane.intensity.as_mut()?, &mut lane.channel.intensity))
        });
        for lane in lanes {
            if lane.intensity.is_some() {
                lane.channel.take_intensity();
            }
        }
    }

    /// Reads the fields that follow the intensity.
    #[inline(always)]
    fn read_rest(&mut self) {
        let channel = &mut self.channel;
        if let Some(decoder) = &mut self.class {
            channel.read_class(decoder);
        }
        if let Some(decoder) = &mut self.flags {
            channel.read_flags(decoder);
        }
        if let Some(decoder) = &mut self.angle {
            channel.read_angle(decoder);
        }
        if let Some(decoder) = &mut self.user {
            channel.read_user(decoder);
        }
        if let Some(decoder) = &mut self.source {
            channel.read_source(decoder);
        }
        if let Some(decoder) = &mut self.time {
            channel.read_time(decoder);
        }
        if let Some((decoder, models, value)) = self.infrared.as_mut().and_then(Layer::parts) {
            models.read(decoder, value);
        }
        if let Some((decoder, models, value)) = self.waves.as_mut().and_then(Layer::parts) {
            models.read(decoder, value);
        }
        if let Some(bytes) = &mut self.extra_bytes {
            bytes.read();
        }
    }

    /// Writes the items behind the point.
    #[inline(always)]
    fn write_fields(&self, fields: &mut [u8]) {
        let mut at = 0;
        let mut put = |value: &[u8]| {
            if let Some(out) = fields.get_mut(at..at + value.len()) {
                out.copy_from_slice(value);
            }
            at += value.len();
        };
        if let Some(colours) = &self.colours {
            put(colours.channels.value());
        }
        if let Some(infrared) = &self.infrared {
            put(infrared.channels.value());
        }
        if let Some(waves) = &self.waves {
            put(waves.channels.value());
        }
        if let Some(bytes) = &self.extra_bytes {
            put(bytes.channels.value());
        }
    }

    #[inline(always)]
    fn read_colours<const LANES: usize>(lanes: &mut [Self; LANES]) {
        for lane in &mut *lanes {
            if let Some((decoder, colours, last)) = lane.colours.as_mut().and_then(Layer::parts) {
                colours.read_change(decoder, *last);
            }
        }
        colour::read_bytes(lanes, |lane| {
            let (decoder, colours, _) = lane.colours.as_mut()?.parts()?;
            Some((decoder, colours))
        });
        for lane in lanes {
            if let Some((_, colours, last)) = lane.colours.as_mut().and_then(Layer::parts) {
                *last = colours.colour();
            }
        }
    }
}

/// What is left of the first record behind the point.
struct Behind<'f> {
    /// The point's.
    channel: usize,
    fields: &'f [u8],
}

impl Behind<'_> {
    /// The next item, if it is there: its first value and its stream.
    fn layer<'a, M, const BYTES: usize>(
        &mut self,
        is_there: bool,
        stream: &mut impl FnMut() -> Result<Option<Decoder<'a>>, Incomplete>,
        models: fn() -> M,
    ) -> Result<Option<Layer<'a, M, BYTES>>, Incomplete> {
        if !is_there {
            return Ok(None);
        }
        let (first, rest) = self.fields.split_first_chunk().ok_or(Incomplete)?;
        self.fields = rest;
        Ok(Some(Layer {
            decoder: stream()?,
            channels: ByChannel::new(self.channel, first, models()),
        }))
    }
}

/// An item behind the point.
struct Layer<'a, M, const BYTES: usize> {
    decoder: Option<Decoder<'a>>,
    channels: ByChannel<M, [u8; BYTES]>,
}

impl<'a, M, const BYTES: usize> Layer<'a, M, BYTES> {
    /// The stream, the models, and the value before.
    #[inline(always)]
    fn parts(&mut self) -> Option<(&mut Decoder<'a>, &mut M, &mut [u8; BYTES])> {
        let (models, last) = self.channels.parts()?;
        Some((self.decoder.as_mut()?, models, last))
    }
}

/// Extra bytes: the item BYTE14, of which each byte has a stream.
struct LayeredBytes<'a> {
    decoders: Vec<Option<Decoder<'a>>>,
    channels: ByChannel<Vec<Symbols>, Vec<u8>>,
}

impl<'a> LayeredBytes<'a> {
    /// The last item: all bytes that are left, if there are any.
    fn new(
        behind: &Behind<'_>,
        count: usize,
        stream: &mut impl FnMut() -> Result<Option<Decoder<'a>>, Incomplete>,
    ) -> Result<Option<Self>, Incomplete> {
        if count == 0 {
            return Ok(None);
        }
        let decoders = (0..count).map(|_| stream());
        let (first, models) = (behind.fields.to_vec(), Self::models(count));
        Ok(Some(Self {
            decoders: decoders.collect::<Result<_, _>>()?,
            channels: ByChannel::new(behind.channel, &first, models),
        }))
    }

    fn models(count: usize) -> Vec<Symbols> {
        vec![Symbols::new(256); count]
    }

    fn read(&mut self) {
        if let Some((models, bytes)) = self.channels.parts() {
            let fields = self.decoders.iter_mut().zip(models).zip(bytes);
            for ((decoder, model), byte) in fields {
                if let Some(decoder) = decoder {
                    *byte = byte.wrapping_add(decoder.symbol(model));
                }
            }
        }
    }
}
