//! Interface of the kinds: one small trait for each place where a fault can act.
//!
//! A rule is called only while its fault is active. It doesn't report what it did: the station
//! compares, counts and keeps the receipt. The memory of a rule from one call to the next is its
//! [`State`]: a rule that was built from the same values and loads that state continues as the
//! original would.

use crate::setup::Stream;
use crate::wire::WireFault;
use alloc::boxed::Box;
use alloc::vec::Vec;
use core::fmt::Debug;
use octant_random::normal::{Ziggurat, uniform};
use octant_random::philox::block;
use octant_random::stream::Phase;
use octant_sample::disturbance::{Disturbance, Motor};
use octant_sample::{Epoch, GimbalCommand, Output, Parameters};
use octant_state::{State, StateError, StateReader, Writer};

/// The rule of one fault, by the place where it acts.
#[derive(Clone, Debug)]
pub enum FaultRule {
    /// Inside the plant.
    Plant(Box<dyn PlantRule>),
    /// On set points.
    Command(Box<dyn CommandRule>),
    /// On samples and aiding.
    Samples(Box<dyn SampleRule>),
    /// On delivery.
    Delivery(Box<dyn DeliveryRule>),
    /// On the unit under test.
    Unit(Box<dyn UnitRule>),
    /// On the wire to the unit under test.
    Wire(Box<dyn WireRule>),
    /// On the host of the harness. Such a fault has no memory.
    Host(HostAction),
}

/// Makes boxed rules of these traits `Clone`, by the `Clone` of the rule within.
macro_rules! clone_boxed {
    ($($rule:ident by $copy:ident)*) => {$(
        #[doc = concat!("Copies a [`", stringify!($rule), "`] into a box. Each one that is `Clone` does it.")]
        pub trait $copy {
            /// Returns a copy in a box.
            fn boxed(&self) -> Box<dyn $rule>;
        }

        impl<R: $rule + Clone + 'static> $copy for R {
            fn boxed(&self) -> Box<dyn $rule> {
                Box::new(self.clone())
            }
        }

        impl Clone for Box<dyn $rule> {
            fn clone(&self) -> Self {
                (**self).boxed()
            }
        }
    )*};
}
clone_boxed! {
    PlantRule by CopyPlantRule
    CommandRule by CopyCommandRule
    SampleRule by CopySampleRule
    DeliveryRule by CopyDeliveryRule
    UnitRule by CopyUnitRule
    WireRule by CopyWireRule
}

impl State for FaultRule {
    fn save(&self, to: &mut Writer) {
        match self {
            Self::Plant(rule) => rule.save(to),
            Self::Command(rule) => rule.save(to),
            Self::Samples(rule) => rule.save(to),
            Self::Delivery(rule) => rule.save(to),
            Self::Unit(rule) => rule.save(to),
            Self::Wire(rule) => rule.save(to),
            Self::Host(_) => {}
        }
    }

    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        match self {
            Self::Plant(rule) => rule.load(from),
            Self::Command(rule) => rule.load(from),
            Self::Samples(rule) => rule.load(from),
            Self::Delivery(rule) => rule.load(from),
            Self::Unit(rule) => rule.load(from),
            Self::Wire(rule) => rule.load(from),
            Self::Host(_) => Ok(()),
        }
    }
}

/// Circumstances of a call of a rule.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    /// Number of the source's epoch, from 1.
    pub epoch: u64,
    /// Phase of the run.
    pub phase: Phase,
    /// Number of the sample in its phase, from 0: the counter of random streams.
    pub counter: u64,
    /// Sample period, s.
    pub dt_s: f64,
    /// Samples since the fault set in: 0 at the first epoch of this onset that the rule sees, and
    /// at no other, no matter which epochs faults of delivery before it hold back or release
    /// together.
    pub since_onset: u64,
    /// Number of earlier onsets of the fault.
    pub firing: u32,
    /// 1 while the fault lasts; falls to 0 over its recovery.
    pub strength: f64,
    /// The epoch before this one as it left the source: for rules that
    /// [look back](SampleRule::looks_back), else undefined.
    pub last: &'a Epoch,
    /// The core's last output.
    pub output: &'a Output,
    /// Set points that the turntable has had.
    pub set_points: SetPoints,
}

/// Set points that the turntable has received, after all faults. At the start they are zero, the
/// initial angles of the gimbals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct SetPoints {
    /// Set point of the epoch before this one.
    pub last: GimbalCommand,
    /// Last set point before it that was different.
    pub before: GimbalCommand,
}

impl Context<'_> {
    /// Three standard normal numbers of this sample.
    #[must_use]
    pub fn normals(&self, stream: &Stream) -> [f64; 3] {
        Ziggurat::shared().three(stream.key(self.phase), self.counter)
    }

    /// Four random numbers in (0, 1) of this sample.
    #[must_use]
    pub fn uniforms(&self, stream: &Stream) -> [f64; 4] {
        self.uniforms_of(stream, 0)
    }

    /// Four random numbers in (0, 1) of the `nth` epoch that comes in in this step, from 0.
    #[must_use]
    pub fn uniforms_of(&self, stream: &Stream, nth: usize) -> [f64; 4] {
        block(stream.key(self.phase), [self.counter, nth as u64, 0, 0]).map(uniform)
    }
}

/// Acts on samples and aiding in place.
pub trait SampleRule: Debug + Send + Sync + CopySampleRule + State {
    /// Acts on one epoch.
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>);

    /// Returns whether the rule needs the epoch before its first one ([`Context::last`]).
    fn looks_back(&self) -> bool {
        false
    }

    /// Returns whether an effect of the fault stays after its end: a clock that was set wrong is
    /// still wrong.
    fn lingers(&self) -> bool {
        false
    }

    /// Acts on one epoch after the fault's end, as long as an effect [stays](Self::lingers).
    fn afterwards(&mut self, _epoch: &mut Epoch, _now: &Context<'_>) {}
}

/// Acts on the delivery of epochs.
pub trait DeliveryRule: Debug + Send + Sync + CopyDeliveryRule + State {
    /// Handles one step of the source: takes the epochs that come in (one, or none or several if
    /// faults before this one have delayed some), and puts those to be delivered now into `out`, in
    /// order. `active` is false in steps after the fault's end, in which a rule is called as long
    /// as it [holds](Self::holds) epochs.
    fn on_step(
        &mut self,
        incoming: &[Epoch],
        active: bool,
        now: &Context<'_>,
        out: &mut Vec<Epoch>,
    );

    /// Number of epochs held back, at most [`crate::station::FLIGHT_MAX`].
    fn holds(&self) -> usize;

    /// Largest number of epochs that can leave in one step of the source with `incoming` epochs.
    fn most_out(&self, incoming: usize) -> usize;
}

/// Acts on the set point that the turntable gets.
pub trait CommandRule: Debug + Send + Sync + CopyCommandRule + State {
    /// Acts on the set point of one epoch.
    fn on_command(&mut self, command: &mut GimbalCommand, now: &Context<'_>);
}

/// Acts inside the plant.
pub trait PlantRule: Debug + Send + Sync + CopyPlantRule + State {
    /// Returns the disturbance of the plant from now on; `motor` is the present state of the
    /// turntable.
    fn begin(&mut self, now: &Context<'_>, motor: &Motor) -> Disturbance;
}

/// Acts on the wire to the unit under test.
pub trait WireRule: Debug + Send + Sync + CopyWireRule + State {
    /// Returns the fault of the wire from now on, until the fault ends.
    fn begin(&mut self, now: &Context<'_>) -> WireFault;
}

/// Acts on the unit under test.
pub trait UnitRule: Debug + Send + Sync + CopyUnitRule + State {
    /// Returns the event of the unit at this epoch, to happen before the unit gets the epoch;
    /// `None`: no event. Power is reported by [`Self::cuts_power`] instead.
    fn on_epoch(&mut self, now: &Context<'_>) -> Option<UnitEvent>;

    /// Returns whether the unit is without power while the fault is active. The station tells the
    /// endpoint when power is lost and returns: of several such faults the first onset and the last
    /// end count.
    fn cuts_power(&self) -> bool {
        false
    }
}

/// Event of the unit under test.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "rare, and passed by value once")]
#[derive(serde::Serialize, serde::Deserialize)]
pub enum UnitEvent {
    /// The unit restarts, as at power on, and loses all state.
    Restart,
    /// The unit loses power: from this epoch on it receives nothing and answers nothing.
    PowerOff,
    /// Power returns: the unit restarts, and this epoch is its first.
    PowerOn,
    /// The unit restarts with a stored calibration that differs by `offset` from its regular
    /// initial calibration, SI.
    RestartWith {
        /// Difference added to the initial parameters.
        offset: Parameters,
    },
    /// The voltage of the unit's supply is lowered for a time of the host, and comes back. The unit itself shows whether it
    /// restarts.
    VoltageDip {
        /// Voltage while it lasts, V.
        voltage_v: f64,
        /// Duration, s.
        length_s: f64,
    },
}

/// Fault of the harness's own host: its processors, its disk, its recorder. The program that runs on the host realises
/// it. Its duration is fixed, in host time: a starved thread could not end the fault that starves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HostAction {
    /// All processors are busy.
    Starve {
        /// Duration, s.
        lasts_s: f64,
        /// Threads that load each processor.
        threads: u32,
    },
    /// The disk of the recording is full from now on.
    FillDisk,
    /// The thread that writes the recording stops for a time.
    StallRecorder {
        /// Duration, s.
        pause_s: f64,
    },
}

/// A host that can be disturbed.
pub trait Hosted {
    /// Begins a fault. Called on the thread of the samples: the disturbance itself runs on other
    /// threads. Returns false if the host has nothing on which the fault could act.
    fn begin(&mut self, action: &HostAction) -> bool;
}

/// Detects a new onset. The detector compares the number of the firing and doesn't wait for the
/// first epoch, which may have been lost on the way to the rule.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Onset {
    firing: Option<u32>,
}

impl Onset {
    /// Returns true at the first epoch of a firing that the rule sees.
    pub(crate) fn is_new(&mut self, now: &Context<'_>) -> bool {
        self.firing.replace(now.firing) != Some(now.firing)
    }
}
