//! Types of a scenario, in SI. They know no reader.

mod drive;
mod endpoint;
mod file_name;
mod fmu;
mod heading;
mod heading_condition;
mod instrument;
mod motion;
mod port;
mod procedure;
mod scenario;
mod source;

pub use drive::{Drive, TableDriver};
pub use endpoint::{EndpointSpec, Live};
pub use file_name::{FileName, FileNameError};
pub use fmu::{Fmu, InterfaceChoice, Mapped, Process};
pub use heading::{HeadingTestKind, HeadingTestSpec, PowerCycle};
pub use heading_condition::HeadingCondition;
pub use instrument::{
    DescriptionChoice, Instrument, InstrumentLog, KnownStamps, Messages, Speaks, UnitPulses,
};
pub use motion::{DocksideSpec, MotionComponent, MotionSpan, MotionSpec, ShipSpectrum};
pub(crate) use motion::{MOTIONS, case_attitude};
pub use port::{ChannelElement, Code, EntryPlace, Made, Set, Setting};
pub use procedure::{AlignmentSpec, CalibrationSpec, Method, NumberedStops};
pub use scenario::{
    Fault, ParameterDistribution, Realtime, RecordSpec, RequirementSpec, Scenario, UnknownFault,
};
pub use source::SourceSpec;
