//! Epochs for the tests of recordings.

use octant_recorder::{EpochFrame, Extra, Recorder, RecorderOptions, RecorderSummary};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::time::SimulatedTime;
use octant_sample::{Epoch, Output, Truth};
use std::io::{self, Write};
use std::sync::{Arc, Mutex};

/// Data of one epoch in the run loop.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    pub clean: Epoch,
    pub faulted: Epoch,
    pub output: Output,
    pub parameters: Option<ParameterEstimate>,
}

/// Period of the test streams: 200 Hz.
pub(crate) const PERIOD_NS: u64 = 5_000_000;

/// Returns the truth at the stamp of a step.
pub(crate) fn truth_of(step: &Step) -> Truth {
    Truth {
        time: SimulatedTime::from_ns(step.clean.sample.device_time.ns),
        latitude_rad: 0.53,
        q_nb: [1.0, -0.0, 0.0, 1e-9],
        ..Truth::default()
    }
}

/// Pushes one step as the run loop does.
pub(crate) fn push(
    recorder: &mut Recorder,
    step: &Step,
) -> Result<(), octant_recorder::RecorderError> {
    recorder.push(EpochFrame {
        clean: &step.clean,
        faulted: &step.faulted,
        output: &step.output,
    })?;
    if recorder.truth_due() {
        recorder.extra(&Extra::Truth(truth_of(step)));
    }
    if recorder.parameters_due() {
        recorder.extra(&Extra::Parameters(step.parameters.unwrap()));
    }
    Ok(())
}

/// Bytes in memory that outlive their writer.
#[derive(Clone, Default)]
pub(crate) struct Memory(pub Arc<Mutex<Vec<u8>>>);

impl Write for Memory {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Records steps into memory.
pub(crate) fn record(steps: &[Step], options: &RecorderOptions) -> (Vec<u8>, RecorderSummary) {
    let memory = Memory::default();
    let mut recorder = Recorder::to_writer(memory.clone(), options).unwrap();
    for step in steps {
        push(&mut recorder, step).unwrap();
    }
    let summary = recorder.finish().unwrap();
    let bytes = std::mem::take(&mut *memory.0.lock().unwrap());
    (bytes, summary)
}
