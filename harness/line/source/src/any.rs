//! A source whose kind is known only from the scenario.

use super::dither::Dither;
use super::fmu::instrument::FmuSource;
use super::fmu::motion::MovedPlant;
use super::known::KnownReference;
use super::measured::MeasuredReference;
use super::session_dither::SessionDither;
use super::{
    Epoch, LiveSource, LogSource, PlantSource, Replay, SolutionSource, Source, SourceError,
    TextSource,
};
use octant_account::Account;
use octant_plant::Truth;
use octant_recorder::event::BenchRecord;
use octant_sample::disturbance::Disturbed;
use octant_sample::{GimbalCommand, NoiseIntegral};
use octant_trajectory::Comparison;

/// A source of any kind.
pub struct AnySource {
    kind: Kind,
    reference: Option<AddedReference>,
    dither: Option<Box<Dither>>,
    session: Option<SessionDither>,
}

/// A reference that the source doesn't bring.
pub(super) enum AddedReference {
    Known(KnownReference),
    Measured(Box<MeasuredReference>),
}

enum Kind {
    Plant(Box<PlantSource>),
    Moved(Box<MovedPlant>),
    Fmu(Box<FmuSource>),
    Replay(Box<Replay>),
    Text(Box<TextSource>),
    Log(Box<LogSource>),
    Live(Box<LiveSource>),
    Solution(Box<SolutionSource>),
    Foreign(Box<dyn Source + Send>),
}

macro_rules! of {
    ($($from:ty => $kind:ident),*) => {
        $(impl From<$from> for AnySource {
            fn from(source: $from) -> Self {
                Self { kind: Kind::$kind(Box::new(source)), reference: None, dither: None, session: None }
            }
        })*
    };
}

of!(PlantSource => Plant, MovedPlant => Moved, FmuSource => Fmu, Replay => Replay,
    TextSource => Text, LogSource => Log, LiveSource => Live, SolutionSource => Solution);

macro_rules! each {
    ($any:expr, $source:ident => $call:expr) => {
        match $any {
            Kind::Plant($source) => $call,
            Kind::Moved($source) => $call,
            Kind::Fmu($source) => $call,
            Kind::Replay($source) => $call,
            Kind::Text($source) => $call,
            Kind::Log($source) => $call,
            Kind::Live($source) => $call,
            Kind::Solution($source) => $call,
            Kind::Foreign($source) => $call,
        }
    };
}

/// A source that a host program made.
impl From<Box<dyn Source + Send>> for AnySource {
    fn from(source: Box<dyn Source + Send>) -> Self {
        Self { kind: Kind::Foreign(source), reference: None, dither: None, session: None }
    }
}

impl AnySource {
    /// Adds the dither of a session to its samples.
    #[must_use]
    pub fn of_session(self, session: Option<SessionDither>) -> Self {
        Self { session, ..self }
    }

    /// Adds noise to the samples.
    #[must_use]
    pub(super) fn with_dither(self, dither: Option<Dither>) -> Self {
        Self { dither: dither.map(Box::new), ..self }
    }

    /// Adds a reference that the source doesn't bring.
    #[must_use]
    pub(super) fn with_reference(self, reference: Option<AddedReference>) -> Self {
        Self { reference, ..self }
    }
}

impl Source for AnySource {
    fn next(&mut self, command: &GimbalCommand, epoch: &mut Epoch) -> Result<bool, SourceError> {
        let more = each!(&mut self.kind, source => source.next(command, epoch))?;
        let stamp = epoch.sample.device_time;
        match &mut self.reference {
            None => {}
            Some(AddedReference::Known(known)) if more => epoch.aiding = known.at(stamp),
            Some(AddedReference::Measured(measured)) if more => {
                epoch.aiding = measured.at(stamp)?
            }
            Some(AddedReference::Measured(measured)) => measured.came()?,
            Some(AddedReference::Known(_)) => {}
        }
        if let Some(session) = self.session.filter(|_| more) {
            session.add(&mut epoch.sample);
        }
        if let Some(dither) = self.dither.as_mut().filter(|_| more) {
            dither.add(&mut epoch.sample);
        }
        Ok(more)
    }

    fn truth(&self) -> Option<Truth> {
        each!(&self.kind, source => source.truth())
    }

    #[inline]
    fn truth_stands(&self) -> Option<bool> {
        each!(&self.kind, source => source.truth_stands())
    }

    fn known_noise(&self) -> Option<NoiseIntegral> {
        let own = each!(&self.kind, source => source.known_noise());
        match &self.dither {
            None => own,
            Some(dither) => Some(own.unwrap_or_default() + dither.sum()),
        }
    }

    fn temperature_c(&mut self) -> Result<Option<f64>, SourceError> {
        each!(&mut self.kind, source => source.temperature_c())
    }

    fn samples_total(&self) -> Option<u64> {
        each!(&self.kind, source => source.samples_total())
    }

    fn samples_planned(&self) -> Option<u64> {
        each!(&self.kind, source => source.samples_planned())
    }

    fn cut_short(&self) -> Option<String> {
        each!(&self.kind, source => source.cut_short())
    }

    fn disturbed(&mut self) -> Option<&mut dyn Disturbed> {
        each!(&mut self.kind, source => source.disturbed())
    }

    fn is_live(&self) -> bool {
        each!(&self.kind, source => source.is_live())
    }

    fn conclude(
        &mut self,
        broken: Option<&str>,
    ) -> (Option<Box<BenchRecord>>, Option<SourceError>) {
        each!(&mut self.kind, source => source.conclude(broken))
    }

    fn accounts(&self) -> Vec<Account> {
        let mut accounts = each!(&self.kind, source => source.accounts());
        if let Some(AddedReference::Measured(measured)) = &self.reference {
            accounts.push(measured.account());
        }
        accounts
    }

    fn compared(&self) -> Option<&Comparison> {
        each!(&self.kind, source => source.compared())
    }

    fn ahead(&self) -> Option<Box<dyn Source + Send>> {
        each!(&self.kind, source => source.ahead())
    }

    fn has_true_parameters(&self) -> bool {
        each!(&self.kind, source => source.has_true_parameters())
    }
}
