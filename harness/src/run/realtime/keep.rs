//! Everything but the frames: recording and watching what the real-time thread tells.

use super::entry::{Answer, Entry};
use crate::run::faulted::occurrence_event;
use crate::run::unit;
use crate::run::watch::Watcher;
use crate::source::Epoch;
use octant_faults::rule::UnitEvent;
use octant_recorder::{Event, Extra, Frame, Recorder, RecorderError};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Wait where nothing is there: a fortieth of what a human sees as a delay.
const PAUSE: Duration = Duration::from_millis(5);

/// Takes entries until the real-time thread has ended and none is left; tells it to stop where the unit
/// did what no unit may.
///
/// # Errors
/// If the recorder fails; what it was given before stays readable.
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
        // Looked at before the ring: what was laid in before the end has been taken.
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
            // The epoch of a step before may have been altered: nobody remembers.
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
        Entry::Pace { frames, latest_ns, overruns, late_answers } => recorder.event(Event {
            kind: "pace".to_owned(),
            detail: serde_json::json!({
                "frames": frames,
                "latest_us": latest_ns as f64 / 1e3,
                "overruns": overruns,
                "late_answers": late_answers,
            }),
        }),
    }
    Ok(())
}

/// Parameters and truth that go with an output.
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

/// The event that ends the recording of a run by the clock.
pub(in crate::run) fn event(kept: &super::Kept) -> Event {
    let pacing = serde_json::to_value(&kept.pacing).unwrap_or_default();
    let granted = serde_json::to_value(&kept.granted).unwrap_or_default();
    Event {
        kind: "pacing".to_owned(),
        detail: serde_json::json!({ "pacing": pacing, "granted": granted }),
    }
}
