//! The table of keys, which defines everything that can be written in a scenario, with dimension,
//! default and meaning.
//!
//! Check, defaults, error messages, the JSON Schema and the test of the tour all use it. A table of a
//! scenario is declared with `keys!`, which also gives the struct that it is read into.

mod calibration;
mod campaign;
mod connection;
mod definition;
mod drive;
mod faults;
mod fmu;
mod instrument;
mod link;
mod run;
mod screening;
mod source;
mod suite;
pub(crate) mod table;

pub(crate) use calibration::{
    AidingKeys, AlignmentKeys, AlignmentMethod, CalibrationKeys, EstimatorName, InitialKeys,
    Intervals, LeastSquaresKeys, NavigationKeys, ProcedureKeys, Reference, Rotation, StopKeys,
};
pub use campaign::CAMPAIGN;
pub use connection::{CONNECTIONS, connection_section};
pub use definition::{Default, KeyBounds, KeyDefinition, KeyKind, SCHEMA, Section, Tag, Variants};
pub(crate) use drive::DriveKeys;
pub(crate) use faults::{dimension, kind_section};
pub(crate) use fmu::{ENDPOINT_MAP, EndpointFmuKeys, FmuKeys, SOURCE_MAP, SourceFmuKeys};
pub(crate) use instrument::{ExtensionsKeys, ImuKeys, TurntableKeys};
pub(crate) use link::LinkKeys;
pub(crate) use run::{
    DecisionKeys, EndpointKeys, EquipmentKeys, MotionKeys, MotionKind, RealtimeKeys, RecordKeys,
    RequirementKeys, ScenarioKeys,
};
pub(crate) use screening::{GateKeys, ScreeningKeys};
pub(crate) use source::{McapKeys, SignalKeys, SourceKeys, SourceLiveKeys, TextKeys};
pub(crate) use suite::{CaseKeys, SuiteKeys};
pub(crate) use table::{At, Keys, Raw};

/// Keys of a scenario.
pub(crate) const SCENARIO: &Section = ScenarioKeys::SECTION;
