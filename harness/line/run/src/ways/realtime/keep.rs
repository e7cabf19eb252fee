//! Records and observes the messages of the real-time thread.

use super::entry::{Answer, Entry, Known};
use crate::bench::records::{Answered, Records};
use crate::bench::steps::{Clean, InStep};
use octant_recorder::event::Pace;
use octant_recorder::{Event, RecorderError};
use octant_sample::Epoch;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Wait if no entry is there: a fortieth of a delay that users notice.
const PAUSE: Duration = Duration::from_millis(5);

/// Takes entries until the real-time thread has ended and none is left; stops that thread if the
/// unit's answers break the rules.
///
/// # Errors
/// If the recorder fails; earlier entries stay readable.
pub(super) fn keep(
    mut ring: rtrb::Consumer<Entry>,
    records: &mut Records<'_>,
    stop: &AtomicBool,
) -> Result<(), RecorderError> {
    loop {
        let abandoned = ring.is_abandoned();
        let mut any = false;
        while let Ok(entry) = ring.pop() {
            any = true;
            take(entry, records)?;
            if records.observers.answers.misbehaved.is_some() {
                stop.store(true, Ordering::Relaxed);
            }
        }
        // Read before the ring, so that entries from before the end have been taken.
        if abandoned {
            return Ok(());
        }
        if !any {
            std::thread::sleep(PAUSE);
        }
    }
}

fn take(entry: Entry, records: &mut Records<'_>) -> Result<(), RecorderError> {
    match entry {
        Entry::Frame { source, undisturbed, faulted, answer } => {
            let clean = Clean { source: &source, undisturbed: &undisturbed };
            let altered = source != faulted;
            answered(InStep::First(clean), &faulted, altered, &answer, records)?;
        }
        Entry::Added { step_ns, faulted, answer } => {
            // The epoch of an earlier step may have been altered: this isn't known any more.
            answered(InStep::Further { step_ns }, &faulted, true, &answer, records)?;
        }
        Entry::Lost { source, undisturbed, truth } => {
            records.lose(Clean { source: &source, undisturbed: &undisturbed }, || truth)?;
        }
        Entry::Unit { event, epoch } => records.unit_event(&event, epoch),
        Entry::Occurrence(occurrence) => records.fault_event(&occurrence),
        Entry::Broke { step_ns, broke } => {
            records.observers.answers.bench_broke(step_ns, broke.to_string());
        }
        Entry::Pace { frames, latest_ns, overruns, late_answers } => {
            let latest_us = latest_ns as f64 / 1e3;
            let pace = Pace { frames, late_answers, latest_us, overruns };
            records.recorder.event(Event::Pace(pace));
        }
    }
    Ok(())
}

fn answered(
    step: InStep<'_>,
    sent: &Epoch,
    altered: bool,
    answer: &Answer,
    records: &mut Records<'_>,
) -> Result<(), RecorderError> {
    let Answer { output, measured, estimate, known } = answer;
    let Known { truth, stands, noise } = *known;
    let estimate = estimate.as_ref();
    let answered = Answered { step, sent, altered, output, measured, estimate };
    records.take(&answered, || stands, || truth, || noise)
}
