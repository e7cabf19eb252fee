//! A plant that faults can disturb, and beside it the plants without their disturbances.
//!
//! A fault inside the plant changes the motion itself, so its effect isn't seen in one plant alone. From the first
//! onset of a disturbance on, a copy of the plant goes on without it: same set points, same random numbers, which
//! follow from the number of a sample. With several disturbances there is a copy without the last one, one without
//! the last two, and so on: what differs between two neighbours is the effect of one of them. Without disturbances
//! there is no copy.

mod state;

use crate::config::PlantConfig;
use crate::course::Course;
use crate::plant::{Plant, PlantStep};
use crate::validate::PlantConfigError;
use octant_sample::disturbance::{Disturbance, Disturbed, Motor};
use octant_sample::{Aiding, Epoch, GimbalCommand, Sample};

pub use state::FORMAT as STATE_FORMAT;

/// Samples after the end of a disturbance until its copy is compared with the disturbed plant: readings and angles
/// that are kept from sample to sample are then those after the end.
const SETTLING_SAMPLES: u8 = 3;

/// A plant that faults can disturb.
///
/// A clone continues exactly as the original.
#[derive(Clone, Debug)]
pub struct ComparedPlant {
    plant: Plant,
    /// By handle, ascending.
    copies: Vec<Copied>,
}

/// A plant without the disturbances of a handle and of larger ones.
#[derive(Clone, Debug)]
struct Copied {
    handle: u32,
    plant: Plant,
    /// Its last epoch.
    epoch: Epoch,
    /// Samples since the disturbance last moved something.
    calm: u64,
    /// Samples since its effect is over, up to those after which it has been looked whether the copy is still needed.
    settled: u8,
}

impl ComparedPlant {
    /// Makes a plant at time 0, gimbals at rest at (0, 0).
    ///
    /// # Errors
    /// If a field of the configuration is out of its range.
    pub fn new(config: &PlantConfig) -> Result<Self, PlantConfigError> {
        Ok(Self { plant: Plant::new(config)?, copies: Vec::new() })
    }

    /// The plant with all disturbances.
    #[must_use]
    #[inline]
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// Number of plants that run beside it.
    #[must_use]
    pub fn copies(&self) -> usize {
        self.copies.len()
    }

    /// [`Plant::follow`].
    ///
    /// # Errors
    /// As that.
    pub fn follow(&mut self, course: &Course) -> Result<(), PlantConfigError> {
        self.all().try_for_each(|plant| plant.follow(course))
    }

    /// [`Plant::tune`].
    ///
    /// # Errors
    /// As that.
    pub fn tune(&mut self, config: &PlantConfig) -> Result<(), PlantConfigError> {
        self.all().try_for_each(|plant| plant.tune(config))
    }

    fn all(&mut self) -> impl Iterator<Item = &mut Plant> {
        let copies = self.copies.iter_mut().map(|copy| &mut copy.plant);
        std::iter::once(&mut self.plant).chain(copies)
    }

    /// [`Plant::step`].
    #[inline]
    pub fn step(&mut self, command: &GimbalCommand) -> PlantStep {
        let mut step = PlantStep { sample: Sample::default(), aiding: None };
        self.step_into(command, &mut step.sample, &mut step.aiding);
        step
    }

    /// [`Plant::step_into`].
    #[inline]
    pub fn step_into(
        &mut self,
        command: &GimbalCommand,
        sample: &mut Sample,
        aiding: &mut Option<Aiding>,
    ) {
        self.sample_into(sample, aiding);
        self.command(command);
    }

    /// [`Plant::command`].
    #[inline]
    pub fn command(&mut self, command: &GimbalCommand) {
        self.plant.command(command);
        for copy in &mut self.copies {
            copy.plant.command(command);
        }
    }

    /// [`Plant::sample_into`].
    #[inline]
    pub fn sample_into(&mut self, sample: &mut Sample, aiding: &mut Option<Aiding>) {
        if !self.copies.is_empty() {
            self.sample_copies();
        }
        self.plant.sample_into(sample, aiding);
    }

    /// Makes the samples of the copies, without those that are no longer needed.
    #[inline(never)]
    fn sample_copies(&mut self) {
        let mut index = 0;
        while index < self.copies.len() {
            if self.is_needed(index) {
                index += 1;
            } else {
                self.copies.remove(index);
            }
        }
        for copy in &mut self.copies {
            copy.plant.sample_into(&mut copy.epoch.sample, &mut copy.epoch.aiding);
            copy.calm = copy.calm.saturating_add(1);
        }
    }

    /// Returns whether a copy can still differ from the plant with its disturbance. Where the counters carry other
    /// remainders it can, for good.
    fn is_needed(&mut self, index: usize) -> bool {
        if self.moves(index) {
            self.copies[index].calm = 0;
        }
        let goes_on = self.copies[index].is_under_way();
        let copy = &mut self.copies[index];
        if goes_on {
            copy.settled = 0;
        } else if copy.settled <= SETTLING_SAMPLES {
            copy.settled += 1;
            if copy.settled == SETTLING_SAMPLES {
                return !self.copies[index].plant.is_same(self.with(index));
            }
        }
        true
    }

    /// The plant of a copy with its disturbance.
    fn with(&self, index: usize) -> &Plant {
        self.copies.get(index + 1).map_or(&self.plant, |next| &next.plant)
    }

    /// Returns whether a disturbance moves something in the next interval, or a drive is on its way back from it.
    fn moves(&self, index: usize) -> bool {
        let (without, with) = (&self.copies[index], self.with(index));
        with.goes_on(without.handle) || !with.drives_as(&without.plant)
    }

    fn found(&self, handle: u32) -> Result<usize, usize> {
        self.copies.binary_search_by_key(&handle, |copy| copy.handle)
    }

    /// The plants in which the disturbance of a handle acts.
    fn with_handle(&mut self, handle: u32) -> impl Iterator<Item = &mut Plant> {
        let copies = self.copies.iter_mut().filter(move |copy| copy.handle > handle);
        copies.map(|copy| &mut copy.plant).chain(std::iter::once(&mut self.plant))
    }
}

impl Copied {
    fn new(handle: u32, plant: Plant) -> Self {
        Self { handle, plant, epoch: Epoch::default(), calm: 0, settled: 0 }
    }

    /// Returns whether the last motion by the disturbance is still in samples to come: those of an instrument that
    /// lags its stamps show it later.
    fn is_under_way(&self) -> bool {
        let config = self.plant.config();
        let late_ns = self.calm.saturating_sub(1).saturating_mul(config.sample_period_ns);
        self.calm == 0 || (late_ns as f64) < config.imu.extensions.time_skew_s * 1e9
    }
}

impl Disturbed for ComparedPlant {
    fn motor(&self) -> Motor {
        self.plant.motor()
    }

    fn begin(&mut self, handle: u32, disturbance: &Disturbance) {
        match self.found(handle) {
            Ok(index) => (self.copies[index].calm, self.copies[index].settled) = (0, 0),
            Err(index) => {
                let without = self.copies.get(index).map_or(&self.plant, |next| &next.plant);
                let copied = Copied::new(handle, without.clone());
                self.copies.insert(index, copied);
            }
        }
        self.with_handle(handle).for_each(|plant| plant.begin(handle, disturbance));
    }

    fn end(&mut self, handle: u32) {
        self.with_handle(handle).for_each(|plant| plant.end(handle));
    }

    fn goes_on(&self, handle: u32) -> bool {
        self.found(handle).is_ok_and(|index| {
            self.moves(index) || (self.copies[index].calm > 0 && self.copies[index].is_under_way())
        })
    }

    fn without(&self, handle: u32) -> Option<&Epoch> {
        self.found(handle).ok().map(|index| &self.copies[index].epoch)
    }

    fn remainder_counts(&self) -> [i64; 2] {
        self.plant.remainder_counts()
    }
}
