//! A change as a function of the count itself.

use crate::kinds::added::Adder;
use crate::kinds::channel::read;
use crate::rule::{Context, FaultRule, Onset, SampleRule};
use crate::values::Channels;
use alloc::boxed::Box;
use core::fmt;
use octant_sample::Epoch;
use octant_state::{State, StateError, StateReader, Writer};

/// Adds `strength · change(channel, count)` to every channel, in counts, remainder carried.
#[derive(Clone)]
pub(crate) struct Mapped<F> {
    channels: Channels,
    change: F,
    adder: Adder,
    onset: Onset,
}

impl<F> State for Mapped<F> {
    fn save(&self, to: &mut Writer) {
        let Self { channels: _, change: _, adder, onset } = self;
        to.value("adder", adder);
        to.value("onset", onset);
    }

    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.adder = from.value("adder")?;
        self.onset = from.value("onset")?;
        Ok(())
    }
}

impl<F: Fn(usize, f64) -> f64 + Clone + Send + Sync + 'static> Mapped<F> {
    pub(crate) fn rule(channels: Channels, change: F) -> FaultRule {
        let (adder, onset) = (Adder::default(), Onset::default());
        FaultRule::Samples(Box::new(Self { channels, change, adder, onset }))
    }
}

impl<F> fmt::Debug for Mapped<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Mapped").field("channels", &self.channels).finish_non_exhaustive()
    }
}

impl<F: Fn(usize, f64) -> f64 + Clone + Send + Sync + 'static> SampleRule for Mapped<F> {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        if self.onset.is_new(now) {
            self.adder.clear();
        }
        for channel in self.channels.iter() {
            let count = f64::from(read(&epoch.sample, channel));
            let change = now.strength * (self.change)(channel, count);
            self.adder.add(&mut epoch.sample, channel, change);
        }
    }
}
