//! Chunks of the point formats 6 to 10: the first record as it is, then a stream for each field of all points.

use super::colour::{self, Colours};
use super::decoder::Decoder;
use super::integer;
use super::lanes::{Incomplete, Lane};
use super::layout::Layout;
use super::point14::{Channel, Point};

/// Streams of a point.
const POINT_STREAMS: usize = 9;
/// Scanner channels.
const CHANNELS: usize = 4;

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
    colours: Option<Box<LayeredColours<'a>>>,
}

impl<'a> Lane<'a> for LayeredLane<'a> {
    fn begin(layout: Layout, input: &'a [u8], first: &mut [u8]) -> Result<Self, Incomplete> {
        let (record, streams) = input.split_at_checked(first.len()).ok_or(Incomplete)?;
        first.copy_from_slice(record);
        let (point, colour) = record.split_first_chunk().ok_or(Incomplete)?;
        let point = Point::read(point);
        // The number of points, which the table of chunks tells too.
        let (_, sizes) = streams.split_first_chunk::<4>().ok_or(Incomplete)?;
        let stream_count = POINT_STREAMS + usize::from(layout.has_colour);
        let (sizes, mut rest) = sizes.split_at_checked(4 * stream_count).ok_or(Incomplete)?;
        let (sizes, _) = sizes.as_chunks();
        let mut sizes = sizes.iter().map(|size| u32::from_le_bytes(*size) as usize);
        let mut stream = || {
            let size = sizes.next().ok_or(Incomplete)?;
            let (stream, behind) = rest.split_at_checked(size).ok_or(Incomplete)?;
            rest = behind;
            Ok((size > 0).then(|| Decoder::new(stream)))
        };
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
            colours: if layout.has_colour {
                let colour = colour.first_chunk().ok_or(Incomplete)?;
                let colours = LayeredColours::new(stream()?, point.channel(), *colour);
                Some(Box::new(colours))
            } else {
                None
            },
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
            if let Some(colours) = &lane.colours
                && let Some(out) = fields.first_chunk_mut()
            {
                *out = colours.colour();
            }
        }
    }

    fn is_whole(&self) -> bool {
        let colour = self.colours.as_ref();
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
        ];
        streams.into_iter().flatten().all(Decoder::is_whole)
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
            if let Some(colours) = &mut lane.colours {
                colours.enter(entered.unwrap_or_default());
            }
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
    }

    #[inline(always)]
    fn read_colours<const LANES: usize>(lanes: &mut [Self; LANES]) {
        for lane in &mut *lanes {
            if let Some((decoder, last, colours)) = lane.colours.as_mut().and_then(|c| c.parts()) {
                colours.read_change(decoder, *last);
            }
        }
        colour::read_bytes(lanes, |lane| {
            let (decoder, _, colours) = lane.colours.as_mut()?.parts()?;
            Some((decoder, colours))
        });
        for lane in lanes {
            if let Some((_, last, colours)) = lane.colours.as_mut().and_then(|c| c.parts()) {
                *last = colours.colour();
            }
        }
    }
}

/// Colours of the item RGB14.
struct LayeredColours<'a> {
    decoder: Option<Decoder<'a>>,
    models: [Option<Box<Colours>>; CHANNELS],
    last: [[u8; colour::BYTES]; CHANNELS],
    /// Which models are used.
    channel: usize,
    /// Which colour foretells the next.
    last_channel: usize,
}

impl<'a> LayeredColours<'a> {
    fn new(decoder: Option<Decoder<'a>>, channel: usize, first: [u8; colour::BYTES]) -> Self {
        let mut models = [const { None }; CHANNELS];
        models[channel] = Some(Box::new(Colours::new()));
        Self {
            decoder,
            models,
            last: [first; CHANNELS],
            channel,
            last_channel: channel,
        }
    }

    /// Chooses the models of the next point. LASzip's version 3 has two oddities: unless the scanner channel changes it takes
    /// those of channel 0, and where it returns to a channel it goes on from the last point's colour.
    #[inline(always)]
    fn enter(&mut self, channel: usize) {
        self.last_channel = self.channel;
        if self.channel != channel {
            self.channel = channel;
            if self.models[channel].is_none() {
                self.models[channel] = Some(Box::new(Colours::new()));
                self.last[channel] = self.last[self.last_channel];
                self.last_channel = channel;
            }
        }
    }

    /// The stream, the colour that foretells the next, and the models.
    #[inline(always)]
    fn parts(&mut self) -> Option<(&mut Decoder<'a>, &mut [u8; colour::BYTES], &mut Colours)> {
        Some((
            self.decoder.as_mut()?,
            &mut self.last[self.last_channel],
            self.models[self.channel].as_mut()?,
        ))
    }

    fn colour(&self) -> [u8; colour::BYTES] {
        self.last[self.last_channel]
    }
}
