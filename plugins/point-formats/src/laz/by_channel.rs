//! Which models and which last value are used, by scanner channel, of the items that follow POINT14.

use super::layout::Version;

/// Scanner channels.
pub(super) const CHANNELS: usize = 4;

/// Models and last values of an item.
///
/// LASzip's version 3 has two oddities: unless the scanner channel changes at this very point, the models are those of channel 0
/// (so whoever calls [`Self::enter`] says), and where the channel had points before, its models go on from the value of the point
/// before, not from its own. Version 4 has neither.
pub(super) struct ByChannel<M, V> {
    models: [Option<Box<M>>; CHANNELS],
    last: [V; CHANNELS],
    /// Of the models.
    channel: usize,
    /// Of the value.
    last_channel: usize,
}

impl<M, V: Clone> ByChannel<M, V> {
    /// After the first value of a chunk.
    pub(super) fn new(channel: usize, first: &V, models: M) -> Self {
        let mut all = [const { None }; CHANNELS];
        all[channel] = Some(Box::new(models));
        Self {
            models: all,
            last: std::array::from_fn(|_| first.clone()),
            channel,
            last_channel: channel,
        }
    }

    /// Goes on to the next point.
    #[inline(always)]
    pub(super) fn enter(&mut self, version: Version, channel: usize, new: impl FnOnce() -> M) {
        self.last_channel = self.channel;
        if self.channel != channel {
            self.channel = channel;
            if self.models[channel].is_none() {
                self.models[channel] = Some(Box::new(new()));
                self.last[channel] = self.last[self.last_channel].clone();
                self.last_channel = channel;
            }
            if version == Version::Fourth {
                self.last_channel = channel;
            }
        }
    }

    /// The models of the point and the value that foretells its own, in place of which its own goes.
    #[inline(always)]
    pub(super) fn parts(&mut self) -> Option<(&mut M, &mut V)> {
        let models = self.models[self.channel].as_mut()?;
        Some((models, &mut self.last[self.last_channel]))
    }

    /// The value of the point.
    #[inline(always)]
    pub(super) fn value(&self) -> &V {
        &self.last[self.last_channel]
    }
}
