//! Where samples come from: the plant, a recording, a file of a real instrument, or the instrument itself.

mod counting;
mod fields;
pub(crate) mod fmu;
mod foreign;
mod from_scenario;
mod live;
mod plant;
mod replay;
mod rows;
mod text;

pub use from_scenario::open;
pub use live::LiveSource;
pub use plant::PlantSource;
pub use replay::Replay;
pub use text::TextSource;

use octant_faults::disturbance::Disturbed;
use octant_plant::Truth;
pub use octant_sample::Epoch;
use octant_sample::GimbalCommand;

/// A source of epochs.
pub trait Source {
    /// The next epoch, into `epoch`; `false` when the source has ended, and then `epoch` is left as
    /// it was. Filled in place: copying a sample that has just been written stalls on its stores.
    ///
    /// `command` is the gimbal command of the core's last output, computed from sample k. A source
    /// that turns gimbals lets it act from the end of the interval that this call delivers
    /// (k + 1); one that replays ignores it.
    ///
    /// # Errors
    /// If the source is broken: file truncated, device gone.
    fn next(&mut self, command: &GimbalCommand, epoch: &mut Epoch) -> Result<bool, SourceError>;

    /// Truth at the stamp of the last epoch, where the source knows it. Costs more than a sample:
    /// ask only when it is recorded.
    fn truth(&self) -> Option<Truth>;

    /// Samples that the source will deliver in all, where it knows.
    fn samples_total(&self) -> Option<u64>;

    /// Samples that there were to be, where the source can tell that from samples that it hasn't got: a
    /// recording of a run that was broken off.
    fn samples_planned(&self) -> Option<u64> {
        self.samples_total()
    }

    /// It ends in the middle of something: what, in plain words. Known at its end.
    fn cut_short(&self) -> Option<String> {
        None
    }

    /// The plant, where the source is one that faults can disturb.
    fn disturbed(&mut self) -> Option<&mut dyn Disturbed> {
        None
    }

    /// It delivers as time goes on, and moves what can hurt: whoever wants its end doesn't wait.
    fn is_live(&self) -> bool {
        false
    }

    /// The run is over; `broken` says why where it broke off. What moves is stopped, and there may be
    /// something to tell of it all; and an error if it was stopped, or doesn't stop as it should: it has
    /// been told to in every way then.
    fn conclude(
        &mut self,
        broken: Option<&str>,
    ) -> (Option<serde_json::Value>, Option<SourceError>) {
        let _ = broken;
        (None, None)
    }

    /// The instrument has the errors that the scenario gives it or draws.
    fn has_true_parameters(&self) -> bool {
        false
    }
}

impl<S: Source + ?Sized> Source for Box<S> {
    fn next(&mut self, command: &GimbalCommand, epoch: &mut Epoch) -> Result<bool, SourceError> {
        (**self).next(command, epoch)
    }

    fn truth(&self) -> Option<Truth> {
        (**self).truth()
    }

    fn samples_total(&self) -> Option<u64> {
        (**self).samples_total()
    }

    fn samples_planned(&self) -> Option<u64> {
        (**self).samples_planned()
    }

    fn cut_short(&self) -> Option<String> {
        (**self).cut_short()
    }

    fn disturbed(&mut self) -> Option<&mut dyn Disturbed> {
        (**self).disturbed()
    }

    fn is_live(&self) -> bool {
        (**self).is_live()
    }

    fn conclude(
        &mut self,
        broken: Option<&str>,
    ) -> (Option<serde_json::Value>, Option<SourceError>) {
        (**self).conclude(broken)
    }

    fn has_true_parameters(&self) -> bool {
        (**self).has_true_parameters()
    }
}

/// Why a source could not go on.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// A file could not be read.
    #[error("read {path}: {reason}")]
    Read {
        /// The file.
        path: String,
        /// What is wrong with it: found and expected, with line or offset.
        reason: String,
    },
    /// A file name could not be expanded.
    #[error("{0}")]
    FileName(String),
    /// A table can't be had as the scenario wants it.
    #[error("turn the table: {0}")]
    Table(octant_turntable::Error),
    /// A table was stopped, or doesn't do what it is told: the run is over.
    #[error("turntable {port}: {reason}")]
    TableStopped {
        /// Its port.
        port: String,
        /// Who or what stopped it.
        reason: String,
    },
    /// An FMU could not be used as a source.
    #[error(transparent)]
    Use(#[from] crate::fmu::mapping::stepper::UseError),
    /// The FMU failed, or its process is gone.
    #[error("source {uri} is gone: {reason}")]
    Gone {
        /// URI of the source.
        uri: String,
        /// What happened.
        reason: String,
    },
}

/// The period of a nominal rate, rounded to a nanosecond.
fn nominal_period_ns(rate_hz: f64) -> Result<u64, String> {
    if rate_hz.is_finite() && (1e-3..=1e8).contains(&rate_hz) {
        Ok((1e9 / rate_hz).round() as u64)
    } else {
        Err(format!("nominal rate is {rate_hz} Hz, expected 0.001 to 1e8 Hz"))
    }
}
