//! Records of a run: its recording and its observers. In simulated time each answer is recorded at once.

use super::attended::Attended;
use super::ended::{Ended, RunError, over};
use super::faulted::{Faulted, occurrence_event};
use super::steps::{Clean, InStep, Keeps};
use super::unit;
use crate::observers::Observers;
use octant_base::control::Control;
use octant_endpoint::Endpoint;
use octant_faults::rule::UnitEvent;
use octant_faults::station::Occurrence;
use octant_recorder::{EpochFrame, Extra, Recorder, RecorderError};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Innovation, NavigationCovariance, NoiseIntegral, Output, Truth};
use octant_scenario::resolve::DrawnValues;
use octant_source::{Epoch, Source};
use std::sync::LazyLock;

/// Epochs between two looks at the control: about a millisecond of wall time.
pub(crate) const CONTROL_EPOCHS: u64 = 8192;
const _: () = assert!(CONTROL_EPOCHS.is_power_of_two());

/// Control of runs that nobody watches or ends.
static NOBODY: LazyLock<Control> = LazyLock::new(Control::default);

/// Recorder and observers of a run, with what they need to know of it.
#[derive(Debug)]
pub struct Records<'a> {
    /// The recorder.
    pub recorder: Recorder,
    /// The observers, whose results are scored.
    pub observers: Observers,
    /// Ids and kinds of the faults, in order.
    names: Vec<(String, String)>,
    /// True values of the instrument, where the source knows them.
    pub(super) truth: Option<DrawnValues>,
    /// Progress of the run, and the request to end it.
    pub(crate) control: &'a Control,
    /// Number of epochs between two looks at the control, a power of two.
    pub(super) look_every: u64,
    /// Revision of the last parameters.
    pub(super) revision: u32,
    /// Person who attends to the run; then `look_every` is 1.
    pub(crate) attended: Option<Attended<'a>>,
}

/// Innovation of a measurement, and the covariance of the solution after it; `None` without a
/// measurement, and from a core that answers with outputs alone.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Measured {
    pub(crate) innovation: Option<Innovation>,
    pub(crate) covariance: Option<NavigationCovariance>,
}

impl Measured {
    /// Asks the endpoint, whose last output this is.
    #[inline(always)]
    pub(crate) fn of<E: Endpoint + ?Sized>(endpoint: &E, output: &Output) -> Self {
        if !output.nis.is_finite() {
            return Self::default();
        }
        Self { innovation: endpoint.innovation(), covariance: endpoint.navigation_covariance() }
    }
}

/// An answer of the unit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answered<'a> {
    /// Place in its step.
    pub(crate) step: InStep<'a>,
    /// Epoch that it answers, as it reached the unit.
    pub(crate) sent: &'a Epoch,
    /// True if faults changed that epoch, or may have.
    pub(crate) altered: bool,
    /// The answer.
    pub(crate) output: &'a Output,
    /// Innovation and covariance, if there was a measurement.
    pub(crate) measured: &'a Measured,
    /// Parameters, if they are new.
    pub(crate) estimate: Option<&'a ParameterEstimate>,
}

impl<'a> Records<'a> {
    /// Creates the records of a run.
    #[must_use]
    pub fn new(recorder: Recorder, observers: Observers, control: &'a Control) -> Self {
        Self {
            recorder,
            observers,
            names: Vec::new(),
            truth: None,
            control,
            look_every: CONTROL_EPOCHS,
            revision: 0,
            attended: None,
        }
    }

    /// Takes the names of the run's faults.
    pub(super) fn name(&mut self, faulted: Option<&Faulted>) {
        let names = faulted.into_iter().flat_map(|faulted| faulted.station.names());
        self.names = names.map(|(id, kind)| (id.to_owned(), kind.to_owned())).collect();
    }

    /// Hands the run over to another control; nobody attends to it.
    pub(super) fn under(self, control: &Control) -> Records<'_> {
        Records { control, attended: None, ..self }
    }

    /// Hands the run over to a host program, which ends it by not going on.
    pub(super) fn under_nobody(self) -> Records<'static> {
        self.under(nobody())
    }

    /// Copies them as they are, with a recorder that goes on from here.
    pub(super) fn copy<'b>(&self, recorder: Recorder, control: &'b Control) -> Records<'b> {
        Records {
            recorder,
            observers: self.observers.clone(),
            names: self.names.clone(),
            truth: self.truth.clone(),
            control,
            look_every: self.look_every,
            revision: self.revision,
            attended: None,
        }
    }

    /// Takes an answer; asks for the truth where it is needed, for the known noise with it, and whether the truth stands
    /// since the answer before.
    #[inline(always)]
    pub(crate) fn take(
        &mut self,
        answered: &Answered<'_>,
        stands: impl FnOnce() -> Option<bool>,
        truth: impl FnOnce() -> Option<Truth>,
        noise: impl FnOnce() -> Option<NoiseIntegral>,
    ) -> Result<(), RecorderError> {
        let Answered { step, sent, altered, output, measured, estimate } = *answered;
        let (recorder, observers) = (&mut self.recorder, &mut self.observers);
        match step {
            InStep::First(clean) => {
                observers.source(clean.source);
                recorder.push(EpochFrame { clean: clean.undisturbed, faulted: sent, output })?;
            }
            InStep::Further { step_ns } => {
                observers.source_time(step_ns);
                recorder.added(step_ns, sent, output)?;
            }
        }
        let observed = observers.answer(sent, altered, output);
        let mut stood = None;
        let between = observers.between(output, || {
            stood = stands();
            stood
        });
        if let Some(innovation) = &measured.innovation {
            recorder.extra(&Extra::Innovation(*innovation));
            observers.innovation(output, innovation);
        }
        if let Some(covariance) = &measured.covariance {
            recorder.extra(&Extra::Covariance(*covariance));
            observers.covariance(sent, output, covariance);
        }
        if let Some(estimate) = estimate {
            recorder.extra(&Extra::Parameters(*estimate));
            observers.parameters(output, estimate);
        }
        if (observed || between || recorder.truth_due())
            && let Some(truth) = truth()
        {
            if recorder.truth_due() {
                recorder.extra(&Extra::Truth(truth));
            }
            if observed {
                observers.noise(noise());
                observers.truth(output, &truth);
            } else if between {
                observers.truth_between(output, &truth, stood);
            }
        }
        Ok(())
    }

    /// Takes an epoch of the source that reached no core in its step, or isn't answered yet.
    pub(crate) fn lose(
        &mut self,
        clean: Clean<'_>,
        truth: impl FnOnce() -> Option<Truth>,
    ) -> Result<(), RecorderError> {
        self.observers.source(clean.source);
        self.observers.lost();
        self.recorder.lost(clean.undisturbed)?;
        if self.recorder.truth_due()
            && let Some(truth) = truth()
        {
            self.recorder.extra(&Extra::Truth(truth));
        }
        Ok(())
    }

    /// Takes an event of the unit before the epoch of this number.
    #[cold]
    pub(crate) fn unit_event(&mut self, event: &UnitEvent, number: u64) {
        if *event != UnitEvent::PowerOff {
            self.observers.restarted();
        }
        self.recorder.event(unit::event(event, number));
    }

    /// Takes the onset or the end of a fault.
    #[cold]
    pub(crate) fn fault_event(&mut self, occurrence: &Occurrence) {
        if let Some((id, kind)) = self.names.get(occurrence.fault) {
            let Occurrence { begins, epoch, .. } = *occurrence;
            self.recorder.event(occurrence_event(id, kind, begins, epoch));
        }
    }
}

/// Returns the control of a run that nobody watches or ends.
pub(crate) fn nobody() -> &'static Control {
    &NOBODY
}

impl<S: Source + ?Sized, E: Endpoint + ?Sized> Keeps<S, E> for Records<'_> {
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
        step: InStep<'_>,
        sent: &Epoch,
        output: &Output,
    ) -> Result<Option<Ended>, RunError> {
        let is_new = output.parameters_revision != self.revision;
        self.revision = output.parameters_revision;
        let estimate = is_new.then(|| endpoint.parameters());
        let measured = Measured::of(endpoint, output);
        let untouched = matches!(step, InStep::First(clean) if std::ptr::eq(clean.source, sent));
        let (measured, estimate) = (&measured, estimate.as_ref());
        let answered = Answered { step, sent, altered: !untouched, output, measured, estimate };
        let (stands, truth) = (|| source.truth_stands(), || source.truth());
        self.take(&answered, stands, truth, || source.known_noise())?;
        let misbehaved = self.observers.answers.misbehaved.is_some();
        Ok(if misbehaved { Some(Ended::Misbehaved) } else { over(output) })
    }

    fn lost(&mut self, source: &S, clean: Clean<'_>) -> Result<(), RunError> {
        Ok(self.lose(clean, || source.truth())?)
    }

    fn unit(&mut self, event: &UnitEvent, number: u64) {
        self.unit_event(event, number);
    }

    fn occurrence(&mut self, occurrence: &Occurrence) {
        self.fault_event(occurrence);
    }
}
