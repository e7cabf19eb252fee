//! Sources of samples: the plant, a recording, a file of a real instrument, or the instrument
//! itself.

mod any;
pub mod configure;
mod counting;
mod definition;
mod described;
mod dither;
mod fields;
mod fmu;
mod foreign;
mod from_scenario;
mod idl;
mod joined;
mod known;
mod live;
mod log;
mod measured;
mod messages;
mod plant;
mod rate_check;
mod reference_mcap;
mod reference_text;
mod replay;
mod rows;
mod sampled;
pub mod session_dither;
mod solution;
mod temperature;
mod text;
mod traffic;
mod triads;
mod walk;

pub use any::AnySource;
pub use from_scenario::{check_live, open, open_with};
pub use live::{BenchTable, LiveSource};
pub use log::LogSource;
pub use plant::PlantSource;
pub use replay::Replay;
pub use solution::SolutionSource;
pub use text::TextSource;

use octant_account::Account;
use octant_base::failing::{Failing, FailureKind};
use octant_plant::Truth;
use octant_recorder::event::BenchRecord;
pub use octant_sample::Epoch;
use octant_sample::disturbance::Disturbed;
use octant_sample::{GimbalCommand, NoiseIntegral};
use octant_trajectory::Comparison;

/// End of the name of a measured reference's account.
pub const OF_REFERENCE: &str = ", reference";

/// A source of epochs.
pub trait Source {
    /// Writes the next epoch into `epoch`. Returns `false` when the source has ended; `epoch` is
    /// then unchanged. The epoch is filled in place because copying a sample that has just been
    /// written stalls on its stores.
    ///
    /// `command` is the gimbal command of the core's last output, computed from sample k. A source
    /// that turns gimbals lets it act from the end of the interval that this call delivers
    /// (k + 1); one that replays ignores it.
    ///
    /// # Errors
    /// If the source is broken: file truncated, device gone.
    fn next(&mut self, command: &GimbalCommand, epoch: &mut Epoch) -> Result<bool, SourceError>;

    /// Returns the truth at the stamp of the last epoch, where the source knows it. This costs more
    /// than a sample: ask for it only when it is recorded.
    fn truth(&self) -> Option<Truth>;

    /// Returns whether the truth at the last epoch is, but for its time, that at the epoch before;
    /// `Some(false)`: it may differ, and costs more than a sample. `None`: this isn't known without it.
    fn truth_stands(&self) -> Option<bool> {
        None
    }

    /// Returns the running integral of the noise in the samples so far, as far as the source knows it.
    fn known_noise(&self) -> Option<NoiseIntegral> {
        None
    }

    /// Returns the temperature of the instrument at the last epoch, °C, where the source has one.
    ///
    /// # Errors
    /// If it isn't a plausible one: each is compared with the one that was asked for before.
    fn temperature_c(&mut self) -> Result<Option<f64>, SourceError> {
        Ok(None)
    }

    /// Total number of samples that the source will deliver, where it is known.
    fn samples_total(&self) -> Option<u64>;

    /// Number of samples that were planned, where the source knows it apart from the samples that
    /// it has: a recording of an aborted run has fewer.
    fn samples_planned(&self) -> Option<u64> {
        self.samples_total()
    }

    /// Describes, in plain words, how the data stops in the middle of something; `None` for a
    /// complete source. Known only at the end.
    fn cut_short(&self) -> Option<String> {
        None
    }

    /// Returns the plant, where the source is one that faults can disturb.
    fn disturbed(&mut self) -> Option<&mut dyn Disturbed> {
        None
    }

    /// True for a source that delivers in real time and moves equipment that can cause harm: a
    /// request to stop takes effect at once, without waiting for the end of the run.
    fn is_live(&self) -> bool {
        false
    }

    /// Ends the run; `broken` is the reason where the run was aborted. Stops everything that moves.
    /// Returns figures for the report, if there are any, and an error if the equipment was stopped
    /// by another cause or doesn't stop as it should: by then every stop command was sent.
    fn conclude(
        &mut self,
        broken: Option<&str>,
    ) -> (Option<Box<BenchRecord>>, Option<SourceError>) {
        let _ = broken;
        (None, None)
    }

    /// Returns the accounts of what the source read from outside; those of its references follow those of its
    /// samples. Known only at the end.
    fn accounts(&self) -> Vec<Account> {
        Vec::new()
    }

    /// Returns what the comparison of a solution with its reference shows besides the errors; `None` for every other
    /// source. Known only at the end.
    fn compared(&self) -> Option<&Comparison> {
        None
    }

    /// Returns a copy that goes on from here by itself, where the source is a simulation of its own.
    fn ahead(&self) -> Option<Box<dyn Source + Send>> {
        None
    }

    /// True if the instrument has the errors that the scenario gives or draws.
    fn has_true_parameters(&self) -> bool {
        false
    }
}

/// Reasons why a source could not go on.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// A file could not be read.
    #[error("read {path}: {reason}")]
    Read {
        /// The file.
        path: String,
        /// Found and expected content, with line or offset.
        reason: String,
    },
    /// A file name could not be expanded.
    #[error(transparent)]
    FileName(octant_scenario::FileNameError),
    /// The files of a solution can't be compared.
    #[error(transparent)]
    Solution(Box<octant_trajectory::PairsError>),
    /// The table can't be driven as the scenario asks.
    #[error("turn the table: {0}")]
    Table(octant_turntable::Error),
    /// The table was stopped, or doesn't obey its commands: the run is over.
    #[error("turntable {port}: {reason}")]
    TableStopped {
        /// Port of the table.
        port: String,
        /// Person or cause that stopped the table.
        reason: String,
    },
    /// An FMU could not be used as a source.
    #[error(transparent)]
    Use(#[from] octant_fmu_bind::stepper::UseError),
    /// The FMU failed, or its process is gone.
    #[error("source {uri} is gone: {reason}")]
    Gone {
        /// URI of the source.
        uri: String,
        /// Description of the failure.
        reason: String,
    },
    /// This program was built without instruments on a CAN bus.
    #[error(
        "use source.live.protocol = \"dbc\": this program was built without instruments on a CAN bus, \
         expected one built with its default features, or with --features octant/can"
    )]
    WithoutCan,
}

impl Failing for SourceError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Table(error) => error.kind(),
            Self::Use(error) => error.kind(),
            Self::Read { .. } | Self::FileName(_) | Self::Solution(_) | Self::WithoutCan => {
                FailureKind::Input
            }
            Self::TableStopped { .. } | Self::Gone { .. } => FailureKind::Bench,
        }
    }
}

// The tests name the crate as its users do. They are a part of its one test program.
#[cfg(test)]
extern crate self as octant_source;
#[cfg(test)]
#[path = "../tests/main.rs"]
mod tests;
