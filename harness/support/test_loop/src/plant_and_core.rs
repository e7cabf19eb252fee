//! Plant and core in closed loop, with access to the data that passes between them.

use crate::instrument::InstrumentCase;
use octant_calibration::Core;
use octant_calibration::config as core;
use octant_plant::Plant;
use octant_plant::config as plant;
use octant_sample::{Aiding, GimbalCommand, Health, Mode, Output, Sample};

/// Plant and core, with the core's last output.
#[derive(Clone)]
pub struct ClosedLoop {
    /// Model of the instrument.
    pub plant: Plant,
    /// Unit under test.
    pub core: Core,
    /// Command for the next epoch.
    pub command: GimbalCommand,
    /// Last output.
    pub output: Output,
    /// Number of epochs with each health bit.
    pub health: [u64; 32],
}

impl ClosedLoop {
    /// Puts a plant and a core together.
    pub fn new(plant: &plant::PlantConfig, core: &core::CoreConfig) -> Self {
        Self {
            plant: Plant::new(plant).unwrap(),
            core: Core::new(core).unwrap(),
            command: GimbalCommand::default(),
            output: Output::default(),
            health: [0; 32],
        }
    }

    /// Plant and core of a case.
    pub fn of(case: &InstrumentCase) -> Self {
        Self::new(&case.plant(), &case.core())
    }

    /// Makes one epoch; `alter` changes the data between the plant and the core. If it returns
    /// `None`, the sample is lost.
    pub fn step_altered(
        &mut self,
        alter: impl FnOnce(Sample, Option<Aiding>) -> Option<(Sample, Option<Aiding>)>,
    ) -> Option<Output> {
        let step = self.plant.step(&self.command);
        let (sample, aiding) = alter(step.sample, step.aiding)?;
        self.core.feel(self.plant.temperature_c());
        let output = self.core.step(&sample, aiding.as_ref());
        self.command = output.gimbal_command;
        for bit in output.health.iter() {
            self.health[bit.bits().trailing_zeros() as usize] += 1;
        }
        self.output = output;
        Some(output)
    }

    /// Makes one epoch.
    pub fn step(&mut self) -> Output {
        self.step_altered(|sample, aiding| Some((sample, aiding))).unwrap()
    }

    /// Runs until a number of samples have been made.
    pub fn run_to(&mut self, sequence: u64) {
        while self.output.sequence < sequence {
            self.step();
        }
    }

    /// Runs until the calibration has ended.
    pub fn calibrate(&mut self) -> Mode {
        while matches!(self.step().mode, Mode::Aligning | Mode::Calibrating) {}
        self.output.mode
    }

    /// Returns the number of epochs with this bit.
    pub fn epochs(&self, bit: Health) -> u64 {
        self.health[bit.bits().trailing_zeros() as usize]
    }
}

/// Maps over seeds or cases on two threads, with results in order.
pub fn on_two_threads<T: Sync, R: Send>(items: &[T], run: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = std::sync::atomic::AtomicUsize::new(0);
    let mut all: Vec<(usize, R)> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..2)
            .map(|_| {
                scope.spawn(|| {
                    let mut done = Vec::new();
                    loop {
                        let i = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                        let Some(item) = items.get(i) else { return done };
                        done.push((i, run(item)));
                    }
                })
            })
            .collect();
        threads.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
    });
    all.sort_by_key(|(i, _)| *i);
    all.into_iter().map(|(_, result)| result).collect()
}
