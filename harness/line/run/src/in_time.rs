//! Runs in simulated time: they wait for nothing, and keep every result at once.

use super::attended::Attended;
use super::drive::{Books, Clean, InStep, Keeps, Line, NoFaults, drive};
use super::ended::{Ended, RunError, over};
use super::measured::Measured;
use super::watch::Watcher;
use octant_base::control::Control;
use octant_endpoint::Endpoint;
use octant_faults::rule::UnitEvent;
use octant_faults::station::Occurrence;
use octant_recorder::Recorder;
use octant_sample::Output;
use octant_source::{Epoch, Source};

/// Epochs between two checks of the control: about a millisecond of wall time.
pub(super) const CONTROL_EPOCHS: u64 = 8192;
const _: () = assert!(CONTROL_EPOCHS.is_power_of_two());

/// Keeps the results of a run in simulated time, which waits for nothing.
#[derive(Debug)]
pub(super) struct InTime<'a> {
    /// Recorder and watcher.
    pub(super) books: Books<'a>,
    /// Control of the run.
    pub(super) control: &'a Control,
    /// Number of epochs between two checks of the control, a power of two.
    pub(super) look_every: u64,
    /// Revision of the last parameters.
    pub(super) revision: u32,
    /// Person who attends to the run; then `look_every` is 1.
    pub(super) attended: Option<Attended<'a>>,
}

impl<S: Source + ?Sized, E: Endpoint + ?Sized> Keeps<S, E> for InTime<'_> {
    #[inline(always)]
    fn begin(&mut self, done: u64, output: &Output, endpoint: &mut E) -> Result<bool, RunError> {
        // Every so many epochs, without a division.
        if done & self.look_every.wrapping_sub(1) != 0 {
            return Ok(false);
        }
        if done != 0 && self.control.look(done) {
            return Ok(true);
        }
        match &mut self.attended {
            None => Ok(false),
            Some(attended) => attended.stand(done, output, endpoint),
        }
    }

    #[inline(always)]
    fn answered(
        &mut self,
        source: &S,
        endpoint: &E,
        (step, sent): (InStep<'_>, &Epoch),
        output: &Output,
    ) -> Result<Option<Ended>, RunError> {
        let is_new = output.parameters_revision != self.revision;
        self.revision = output.parameters_revision;
        let estimate = is_new.then(|| endpoint.parameters());
        let measured = Measured::of(endpoint, output);
        let untouched = matches!(step, InStep::First(clean) if std::ptr::eq(clean.source, sent));
        let answered = (step, sent, !untouched);
        let additions = (&measured, estimate.as_ref());
        self.books.answered(answered, output, additions, || source.truth())?;
        let misbehaved = self.books.watcher.misbehaved.is_some();
        Ok(if misbehaved { Some(Ended::Misbehaved) } else { over(output) })
    }

    fn lost(&mut self, source: &S, clean: Clean<'_>) -> Result<(), RunError> {
        Ok(self.books.lost(clean, || source.truth())?)
    }

    fn unit(&mut self, event: &UnitEvent, number: u64) {
        self.books.unit(event, number);
    }

    fn occurrence(&mut self, occurrence: &Occurrence) {
        self.books.occurrence(occurrence);
    }
}

/// Drives in simulated time. Receipts of faults are recorded at the end, also after a failure.
///
/// # Errors
/// If source, endpoint or recorder fail; epochs recorded before stay readable.
pub fn drive_in_time<S, E>(
    line: Line<'_, S, E>,
    recorder: &mut Recorder,
    watcher: &mut Watcher,
    control: &Control,
) -> Result<Ended, RunError>
where
    S: Source + ?Sized,
    E: Endpoint + ?Sized,
{
    drive_attended(line, recorder, watcher, control, None)
}

/// Drives as [`drive_in_time`], with a person who attends to the run.
pub(super) fn drive_attended<S, E>(
    line: Line<'_, S, E>,
    recorder: &mut Recorder,
    watcher: &mut Watcher,
    control: &Control,
    attended: Option<Attended<'_>>,
) -> Result<Ended, RunError>
where
    S: Source + ?Sized,
    E: Endpoint + ?Sized,
{
    let Line { source, faulted, endpoint } = line;
    let books = Books::new(recorder, watcher, faulted.as_deref());
    let looks = source.is_live() || attended.is_some();
    let look_every = if looks { 1 } else { CONTROL_EPOCHS };
    let mut keeper = InTime { books, control, look_every, revision: 0, attended };
    let Some(faulted) = faulted else { return drive(source, &mut NoFaults, endpoint, &mut keeper) };
    let ended = drive(source, faulted, endpoint, &mut keeper);
    faulted.last_words().into_iter().for_each(|event| keeper.books.recorder.event(event));
    ended
}
