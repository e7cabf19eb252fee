//! Records and watches the messages of the real-time thread.

use super::entry::Entry;
use super::kept::TimeKeeping;
use crate::drive::{Books, Clean, InStep};
use octant_recorder::event::Pace;
use octant_recorder::{Event, RecorderError};
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
    books: &mut Books<'_>,
    stop: &AtomicBool,
) -> Result<(), RecorderError> {
    loop {
        let abandoned = ring.is_abandoned();
        let mut any = false;
        while let Ok(entry) = ring.pop() {
            any = true;
            take(entry, books)?;
            if books.watcher.misbehaved.is_some() {
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

fn take(entry: Entry, books: &mut Books<'_>) -> Result<(), RecorderError> {
    match entry {
        Entry::Frame { source, undisturbed, faulted, answer } => {
            let clean = Clean { source: &source, undisturbed: &undisturbed };
            let sent = (InStep::First(clean), &faulted, source != faulted);
            books.answered(sent, &answer.output, answer.additions(), || answer.truth)?;
        }
        Entry::Added { step_ns, faulted, answer } => {
            // The epoch of an earlier step may have been altered: this isn't known any more.
            let sent = (InStep::Further { step_ns }, &faulted, true);
            books.answered(sent, &answer.output, answer.additions(), || answer.truth)?;
        }
        Entry::Lost { source, undisturbed, truth } => {
            books.lost(Clean { source: &source, undisturbed: &undisturbed }, || truth)?;
        }
        Entry::Unit { event, epoch } => books.unit(&event, epoch),
        Entry::Occurrence(occurrence) => books.occurrence(&occurrence),
        Entry::Broke { step_ns, broke } => books.watcher.bench_broke(step_ns, broke.to_string()),
        Entry::Pace { frames, latest_ns, overruns, late_answers } => {
            let latest_us = latest_ns as f64 / 1e3;
            books.recorder.event(Event::Pace(Pace { frames, late_answers, latest_us, overruns }));
        }
    }
    Ok(())
}

/// Builds the event that ends the recording of a run by the clock.
pub(crate) fn event(kept: &TimeKeeping) -> Event {
    let pacing = Box::new(kept.pacing.clone());
    Event::Pacing { granted: kept.granted.clone(), pacing }
}
