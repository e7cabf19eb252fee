//! The end of a run: source and endpoint are ended, and the core is asked for its conclusion.

use super::Bench;
use super::ended::{BenchEnd, Ended, RunError, TimeKeeping};
use super::records::Records;
use crate::observers::Observers;
use octant_base::control::Control;
use octant_base::interrupt;
use octant_endpoint::{Conclusion, Endpoint, EndpointError};
use octant_faults::Receipt;
use octant_recorder::{Event, Recorder};
use octant_sample::Output;
use octant_sample::parameters::ParameterEstimate;
use octant_scenario::resolve::DrawnValues;
use octant_source::Source;
use std::sync::atomic::Ordering;

/// A run after its end; its recording is still open.
#[derive(Debug)]
pub struct Closed {
    /// How it ended.
    pub ended: Ended,
    /// Reports of the bench's parts.
    pub bench: BenchEnd,
    /// Answer to the end of the source.
    pub last: Option<Output>,
    /// The core's conclusion.
    pub conclusion: Conclusion,
    /// Parameters at the end.
    pub estimate: ParameterEstimate,
    /// The recorder.
    pub recorder: Recorder,
    /// The observers.
    pub observers: Observers,
    /// True values of the instrument, where the source knows them.
    pub truth: Option<DrawnValues>,
    /// Receipts of the faults, in the order of the scenario.
    pub receipts: Vec<Receipt>,
}

impl<S: Source, E: Endpoint> Bench<S, E, Records<'_>> {
    /// Ends source and endpoint, and asks the core for its conclusion. A run that isn't over counts as interrupted.
    ///
    /// # Errors
    /// If source, endpoint or recorder failed in a way that leaves no result.
    pub fn close(self) -> Result<Closed, RunError> {
        let Self { mut source, mut endpoint, faulted, keeper, ended, kept, .. } = self;
        let Records { mut recorder, mut observers, truth, control, .. } = keeper;
        let driven = ended.unwrap_or(Ok(Ended::Cancelled));
        if let Some(faulted) = &faulted {
            faulted.last_words().into_iter().for_each(|event| recorder.event(event));
        }
        if let Some(TimeKeeping { pacing, granted }) = &kept {
            let pacing = Box::new(pacing.clone());
            recorder.event(Event::Pacing { granted: granted.clone(), pacing });
        }
        // Moving equipment is stopped first.
        let broken = driven.as_ref().err().map(ToString::to_string);
        let (instrument, stopped) = source.conclude(broken.as_deref());
        let driven = match stopped {
            None => driven,
            Some(error) => driven.and(Err(error.into())),
        };
        let (cut_short, inputs) = (source.cut_short(), source.accounts());
        let compared = source.compared().cloned().map(Box::new);
        if let Some(detail) = &instrument {
            recorder.event(Event::Bench(detail.clone()));
        }
        let told = control.attendance.get().map_or_else(Vec::new, |attendance| attendance.told());
        for record in
            told.iter().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
        {
            recorder.event(Event::Operator(record));
        }
        let driven = driven.and_then(|ended| match ended {
            Ended::SourceEnded => Ok((ended, endpoint.end_of_stream()?)),
            _ => Ok((ended, None)),
        });
        if let Err(RunError::Endpoint(EndpointError::Misbehaved(misbehaviour))) = &driven {
            observers.answers.misbehaved.get_or_insert_with(|| misbehaviour.clone());
        }
        let (ended, last, broken) = match driven {
            // Errors that came while the run was being stopped after a misbehaviour aren't its cause.
            _ if observers.answers.misbehaved.is_some() => (Ended::Misbehaved, None, None),
            Ok((Ended::Cancelled, _)) if is_lost(control, &observers) => (Ended::Lost, None, None),
            Ok((ended, last)) => (ended, last, None),
            // An interrupt stopped the moving equipment without waiting for the run.
            Err(error)
                if error.is_gone()
                    && (control.cancel.load(Ordering::Relaxed) || interrupt::seen()) =>
            {
                (Ended::Cancelled, None, None)
            }
            Err(error) if error.is_gone() => {
                recorder.event(Event::Error { reason: error.to_string() });
                (Ended::Broken, None, Some(error))
            }
            Err(error) => return Err(error),
        };
        let mut conclusion = endpoint.conclusion();
        let link = conclusion.events.iter().find_map(|event| match event {
            Event::Link(link) => Some(link.clone()),
            _ => None,
        });
        let power = conclusion.events.iter().find_map(|event| match event {
            Event::Power(power) => Some(power.clone()),
            _ => None,
        });
        conclusion.events.drain(..).for_each(|event| recorder.event(event));
        let estimate = endpoint.parameters();
        // The core is ended last, so that a failure there loses nothing that it has told.
        let (ended, broken) = match endpoint.close() {
            Err(error)
                if broken.is_none() && !matches!(ended, Ended::Misbehaved | Ended::Cancelled) =>
            {
                recorder.event(Event::Error { reason: error.to_string() });
                (Ended::Broken, Some(error.into()))
            }
            _ => (ended, broken),
        };
        let bench = BenchEnd { broken, cut_short, inputs, compared, kept, link, instrument, power };
        let receipts = faulted.map_or_else(Vec::new, |faulted| faulted.station.receipts());
        Ok(Closed {
            ended,
            bench,
            last,
            conclusion,
            estimate,
            recorder,
            observers,
            truth,
            receipts,
        })
    }
}

/// Returns whether a run that was stopped was stopped because its bench is lost, or was in an earlier run.
fn is_lost(control: &Control, observers: &Observers) -> bool {
    let broke = observers.answers.bench_broke.is_some();
    let here = control.stop_when_lost.load(Ordering::Relaxed) && broke;
    (here || control.lost.load(Ordering::Relaxed)) && !control.cancel.load(Ordering::Relaxed)
}
