//! Receipts: the effect of a fault, found by comparison and not reported by the fault.

use crate::wire::Altered;
use alloc::string::String;
use octant_sample::canonical::{AIDING_BYTES, SAMPLE_BYTES, aiding, sample};
use octant_sample::{Epoch, GimbalCommand, LargestChange, Sample};
use octant_state::{State, StateError, StateReader, Writer};

/// The receipt of one fault.
#[derive(Clone, Debug, PartialEq)]
pub struct Receipt {
    /// Id of the fault in the scenario.
    pub id: String,
    /// Name of its kind.
    pub kind: &'static str,
    /// True if the fault was in the pipeline from the start.
    pub armed: bool,
    /// Number of onsets.
    pub firings: u32,
    /// First epoch of the source that the fault altered, from 1.
    pub first_sample: Option<u64>,
    /// Last epoch of the source that the fault altered.
    pub last_sample: Option<u64>,
    /// Epochs that the fault altered. For a fault inside the plant: those that differ from the epoch of the plant
    /// without it by more than the remainder that counters carry. For a fault of the wire: epochs
    /// in whose exchange it altered a frame. For a fault of the host: epochs at which it set in.
    pub samples_altered: u64,
    /// CRC-32 of the input of the fault, over the epochs that it altered.
    pub clean_crc32: u32,
    /// CRC-32 of the output of the fault, over the same epochs.
    pub faulted_crc32: u32,
    /// Largest change of each channel, where the fault alters samples or set points in place: inside the plant, on
    /// samples and aiding, on set points.
    pub largest_change: Option<LargestChange>,
}

impl Receipt {
    /// Returns whether the fault altered anything.
    #[must_use]
    pub fn fired(&self) -> bool {
        self.samples_altered > 0
    }
}

/// Keeps the receipt of one fault.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ledger {
    first: Option<u64>,
    last: Option<u64>,
    altered: u64,
    clean: crc32fast::Hasher,
    faulted: crc32fast::Hasher,
    largest: Option<LargestChange>,
    /// Of a fault inside the plant.
    sums: CountSums,
}

impl State for Ledger {
    /// The state of a checksum is saved, so that it continues after loading.
    fn save(&self, to: &mut Writer) {
        let Self { first, last, altered, clean, faulted, largest, sums } = self;
        to.value("first", first);
        to.value("last", last);
        to.value("altered", altered);
        to.value("clean", &clean.clone().finalize());
        to.value("faulted", &faulted.clone().finalize());
        to.value("largest", largest);
        to.value("sums", sums);
    }

    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.first = from.value("first")?;
        self.last = from.value("last")?;
        self.altered = from.value("altered")?;
        octant_state::check_count("altered", self.altered)?;
        self.clean = crc32fast::Hasher::new_with_initial(from.value("clean")?);
        self.faulted = crc32fast::Hasher::new_with_initial(from.value("faulted")?);
        self.largest = from.value("largest")?;
        self.sums = from.value("sums")?;
        Ok(())
    }
}

impl Ledger {
    /// Counts an epoch that the fault altered.
    pub(crate) fn touched(&mut self, epoch: u64) {
        // Several epochs can leave a delivery fault in one step of the source.
        if self.last != Some(epoch) {
            self.altered += 1;
        }
        self.first.get_or_insert(epoch);
        self.last = Some(epoch);
    }

    /// Counts an epoch that the fault altered in place.
    pub(crate) fn altered_in_place(&mut self, number: u64, clean: &Epoch, faulted: &Epoch) {
        self.touched(number);
        self.clean(clean);
        self.faulted(faulted);
        self.largest.get_or_insert_default().take(clean, faulted);
    }

    /// Compares an epoch of the plant without a fault inside it and with it. `remainder` are the counts that the
    /// remainders of counters make, of a gyro and of an accelerometer.
    pub(crate) fn compare(
        &mut self,
        number: u64,
        (without, with): (&Epoch, &Epoch),
        remainder: [i64; 2],
    ) {
        if self.sums.is_altered((without, with), remainder) {
            self.altered_in_place(number, without, with);
        }
    }

    /// Number of epochs altered.
    pub(crate) fn altered(&self) -> u64 {
        self.altered
    }

    pub(crate) fn clean(&mut self, epoch: &Epoch) {
        digest(&mut self.clean, epoch);
    }

    pub(crate) fn faulted(&mut self, epoch: &Epoch) {
        digest(&mut self.faulted, epoch);
    }

    /// Records altered frames of a wire; the checksums are over all of them so far.
    pub(crate) fn frames(&mut self, epoch: u64, altered: &Altered) {
        if altered.frames > 0 {
            self.touched(epoch);
            self.clean = crc32fast::Hasher::new_with_initial(altered.clean_crc32);
            self.faulted = crc32fast::Hasher::new_with_initial(altered.faulted_crc32);
        }
    }

    /// Adds a number before and after to the checksums.
    pub(crate) fn number(&mut self, clean: f64, faulted: f64) {
        self.clean.update(&clean.to_bits().to_le_bytes());
        self.faulted.update(&faulted.to_bits().to_le_bytes());
    }

    pub(crate) fn commands(&mut self, clean: &GimbalCommand, faulted: &GimbalCommand) {
        for (into, command) in [(&mut self.clean, clean), (&mut self.faulted, faulted)] {
            into.update(&command.target.azimuth.to_le_bytes());
            into.update(&command.target.roll.to_le_bytes());
        }
        self.largest.get_or_insert_default().take_command(clean, faulted);
    }

    pub(crate) fn receipt(&self, id: &str, kind: &'static str, firings: u32) -> Receipt {
        Receipt {
            id: id.into(),
            kind,
            armed: true,
            firings,
            first_sample: self.first,
            last_sample: self.last,
            samples_altered: self.altered,
            clean_crc32: self.clean.clone().finalize(),
            faulted_crc32: self.faulted.clone().finalize(),
            largest_change: self.largest,
        }
    }
}

/// Adds the canonical bytes of an epoch to a checksum.
fn digest(into: &mut crc32fast::Hasher, epoch: &Epoch) {
    let mut bytes = [0; SAMPLE_BYTES];
    sample(&epoch.sample, &mut bytes);
    into.update(&bytes);
    if let Some(message) = &epoch.aiding {
        let mut bytes = [0; AIDING_BYTES];
        aiding(message, &mut bytes);
        into.update(&bytes);
    }
}

/// Differences of the sums of counts of two plants, with the range of each since the last sample that was altered.
///
/// Two counters that have counted the same may carry different remainders: from then on their counts differ by one now
/// and then, their sums by no more than one, for good. That is no effect on the sample in which it shows.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct CountSums {
    difference: [i64; 6],
    smallest: [i64; 6],
    largest: [i64; 6],
}

fn counts(sample: &Sample) -> [i64; 6] {
    let ([a, b, c], [d, e, f]) = (sample.delta_theta, sample.delta_velocity);
    [a, b, c, d, e, f].map(i64::from)
}

impl CountSums {
    /// Takes the next pair of epochs. Returns whether it was altered: anything but counts differs, or the difference of
    /// the sums of a channel has varied by more than remainders make since the last one that was.
    pub(crate) fn is_altered(
        &mut self,
        (without, with): (&Epoch, &Epoch),
        remainder: [i64; 2],
    ) -> bool {
        let (a, b) = (counts(&without.sample), counts(&with.sample));
        let mut altered = false;
        for channel in 0..6 {
            let sum = &mut self.difference[channel];
            // 64 bits hold the counts of 2³² samples; beyond, and in a state that no run makes, they wrap.
            *sum = sum.wrapping_add(b[channel] - a[channel]);
            self.smallest[channel] = self.smallest[channel].min(*sum);
            self.largest[channel] = self.largest[channel].max(*sum);
            let varied = self.largest[channel].wrapping_sub(self.smallest[channel]);
            altered |= varied > remainder[channel / 3];
        }
        let mut same_counts = *with;
        same_counts.sample.delta_theta = without.sample.delta_theta;
        same_counts.sample.delta_velocity = without.sample.delta_velocity;
        altered |= !same_counts.same_bits(without);
        if altered {
            (self.smallest, self.largest) = (self.difference, self.difference);
        }
        altered
    }
}
