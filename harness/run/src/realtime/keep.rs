//! Records and watches the messages of the real-time thread.

use super::entry::{Answer, Entry};
use super::kept::Kept;
use crate::faulted::occurrence_event;
use crate::unit;
use crate::watch::Watcher;
use octant_faults::rule::UnitEvent;
use octant_recorder::event::Pace;
use octant_recorder::{Event, Extra, Frame, Recorder, RecorderError};
use octant_source::Epoch;
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
    names: &[(String, String)],
    recorder: &mut Recorder,
    watcher: &mut Watcher,
    stop: &AtomicBool,
) -> Result<(), RecorderError> {
    loop {
        let abandoned = ring.is_abandoned();
        let mut any = false;
        while let Ok(entry) = ring.pop() {
            any = true;
            take(entry, names, recorder, watcher)?;
            if watcher.misbehaved.is_some() {
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

fn take(
    entry: Entry,
    names: &[(String, String)],
    recorder: &mut Recorder,
    watcher: &mut Watcher,
) -> Result<(), RecorderError> {
    match entry {
        Entry::Frame { clean, faulted, answer } => {
            watcher.source(&clean);
            recorder.push(Frame { clean: &clean, faulted: &faulted, output: &answer.output })?;
            answered((&faulted, clean != faulted), &answer, recorder, watcher);
        }
        Entry::Added { step_ns, faulted, answer } => {
            watcher.source_time = Some(octant_sample::DeviceTime { ns: step_ns });
            recorder.added(step_ns, &faulted, &answer.output)?;
            // The epoch of an earlier step may have been altered: this isn't known any more.
            answered((&faulted, true), &answer, recorder, watcher);
        }
        Entry::Lost { clean, truth } => {
            watcher.source(&clean);
            recorder.lost(&clean)?;
            if recorder.truth_due()
                && let Some(truth) = truth
            {
                recorder.extra(&Extra::Truth(truth));
            }
        }
        Entry::Unit { event, epoch } => {
            if event != UnitEvent::PowerOff {
                watcher.restarted();
            }
            recorder.event(unit::event(&event, epoch));
        }
        Entry::Occurrence { fault, begins, epoch } => {
            if let Some((id, kind)) = names.get(fault) {
                recorder.event(occurrence_event(id, kind, begins, epoch));
            }
        }
        Entry::Broke { step_ns, broke } => watcher.bench_broke(step_ns, broke.to_string()),
        Entry::Pace { frames, latest_ns, overruns, late_answers } => {
            let latest_us = latest_ns as f64 / 1e3;
            recorder.event(Event::Pace(Pace { frames, late_answers, latest_us, overruns }));
        }
    }
    Ok(())
}

/// Handles the parameters and truth that belong to an output.
fn answered(
    (sent, altered): (&Epoch, bool),
    answer: &Answer,
    recorder: &mut Recorder,
    watcher: &mut Watcher,
) {
    let watched = watcher.answer(sent, altered, &answer.output);
    if let Some(estimate) = &answer.estimate {
        recorder.extra(&Extra::Parameters(*estimate));
        watcher.parameters(&answer.output, estimate);
    }
    let Some(truth) = &answer.truth else { return };
    if recorder.truth_due() {
        recorder.extra(&Extra::Truth(*truth));
    }
    if watched {
        watcher.truth(&answer.output, truth);
    }
}

/// Builds the event that ends the recording of a run by the clock.
pub(crate) fn event(kept: &Kept) -> Event {
    let pacing = Box::new(kept.pacing.clone());
    Event::Pacing { granted: kept.granted.clone(), pacing }
}
