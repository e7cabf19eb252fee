//! Scenarios: runs described in TOML files that an engineer can read.
//!
//! [`Scenario::load`] parses a file and checks it against one table of keys, adds every default and
//! converts every quantity to SI. Random values are drawn from the seed once ([`resolve`]) and put into
//! the configurations of plant and core, so that two methods compared on one seed use the same
//! instrument.

mod arguments;
pub mod campaign;
pub mod channel;
mod choices;
mod complete;
mod condition;
mod derive;
pub mod file_names;
mod files;
mod keys;
mod load;
mod model;
mod other_format;
mod ports;
pub mod read;
pub mod recorded;
pub mod reference;
pub mod resolve;
mod schema;
pub mod suite;
mod tour;
pub mod trajectory;
mod write;

pub use arguments::override_set;
pub use error::{FileProblems, Place, Problem};
pub use files::FilePlaces;
pub use keys::{SCHEMA, fault_dimension};
pub use model::{
    AlignmentSpec, CalibrationSpec, ChannelElement, Code, DescriptionChoice, DocksideSpec, Drive,
    EndpointSpec, EntryPlace, Fault, FileName, FileNameError, Fmu, HeadingCondition,
    HeadingTestKind, HeadingTestSpec, Instrument, InstrumentLog, InterfaceChoice, KnownStamps,
    Live, Made, Mapped, Messages, Method, MotionComponent, MotionSpan, MotionSpec, NumberedStops,
    ParameterDistribution, PowerCycle, Process, Realtime, RecordSpec, RequirementSpec, Scenario,
    Set, Setting, ShipSpectrum, SourceSpec, Speaks, TableDriver, UnitPulses, UnknownFault,
};
pub use octant_instruments::grades::{FLICKER, GRADES, GradeSheet};
pub use octant_quantity as quantity;
pub use octant_toml_tree::error;
pub use ports::setting_argument;
pub use quantity::parse as quantity_of;
pub use quantity::{Quantity, UnitDimension};
pub use read::faults::connection::{ConnectionFault, Given, connection_faults, text_of};
pub use read::system::{SystemRequirement, system_requirements};
pub use schema::schema;
pub use tour::{fault_example, fault_parameters, tour};

// The tests name the crate as its users do. They are a part of its one test program.
#[cfg(test)]
extern crate self as octant_scenario;
#[cfg(test)]
#[path = "../tests/main.rs"]
mod tests;
