//! The table of keys, which defines everything that can be written in a scenario, a suite, a campaign
//! or a list of faults on connections, with dimension, default and meaning.
//!
//! Check, defaults, error messages, the JSON Schema and the test of the tour all use it. A table is
//! declared with `keys!`, which also gives the struct that it is read into, and a table with several
//! forms with `forms!`, which gives an enum.

pub(crate) mod by_case;
mod calibration;
mod campaign;
mod columns;
mod definition;
mod drive;
mod faults;
mod fmu;
mod further;
mod instrument;
pub(crate) mod key_path;
mod power;
mod run;
mod screening;
mod source;
mod suite;
mod system;
pub(crate) mod table;
mod trajectory;

pub(crate) use calibration::{
    AidingKeys, AlignmentKeys, AlignmentMethod, CalibrationKeys, EstimatorName, HeadingTestKeys,
    InitialKeys, Intervals, LeastSquaresKeys, NavigationKeys, ProcedureKeys, Reference, Rotation,
    SigmaLimitKeys, StopKeys,
};
pub(crate) use campaign::{
    CampaignKeys, CorrelationKeys, EarlyStopKeys, FactorKeys, LimitsKeys, MemberKeys,
};
pub use campaign::{Design, LookSpec};
pub use definition::SCHEMA;
pub(crate) use definition::{Bounds, Default, Key, Kind, Section, Tag, Variants, cases_in_words};
pub(crate) use drive::DriveKeys;
pub use faults::dimension as fault_dimension;
pub(crate) use faults::{
    Counted, FaultKeys, LastingKeys, OperatorKeys, RepeatKeys, TriggerKeys, kind_section,
};
pub(crate) use fmu::{ENDPOINT_MAP, EndpointFmuKeys, FmuKeys, SOURCE_MAP, SourceFmuKeys};
pub(crate) use further::{
    AccelPerKelvinUse, AccelUse, AngleUse, CaseRestKeys, DrawnAccelerations, DrawnAccelsPerKelvin,
    DrawnAngles, DrawnGyrosPerKelvin, DrawnLengths, DrawnQuadratics, DrawnRatios,
    DrawnScalesPerKelvin, FurtherKeys, GimbalAnglesKeys, GyroPerKelvinUse, GyroUse, LeverUse,
    QuadraticUse, RatioUse, ScalePerKelvinUse,
};
pub(crate) use instrument::{ExtensionsKeys, ImuKeys, TurntableKeys};
pub(crate) use key_path::{key, keys_of};
pub(crate) use power::PowerKeys;
pub(crate) use run::{
    DecisionKeys, EndpointKeys, EquipmentKeys, LinkKeys, MotionKeys, MotionKind, RealtimeKeys,
    RecordKeys, RequirementKeys, SCENARIO, ScenarioKeys,
};
pub(crate) use screening::{GateKeys, ScreeningKeys};
pub(crate) use source::{
    McapKeys, ReferenceKind, SignalKeys, SourceKeys, SourceLiveKeys, SourceReferenceKeys, TextKeys,
};
pub(crate) use suite::{CaseKeys, SuiteKeys};
pub(crate) use system::{
    ConnectionFaultKeys, ConnectionsKeys, SystemRequirementsKeys, connection_section,
};
pub(crate) use table::{At, FromTable, Keys, Raw};
pub(crate) use trajectory::{ReferenceTrajectoryKeys, SolutionKeys, TrajectoryForm};
