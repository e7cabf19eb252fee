//! The calibration core and the plant as Functional Mock-up Units, FMI 2.0 and FMI 3.0.
//!
//! | module | idea |
//! |---|---|
//! | [`table`] | definition of variables; source of descriptions, references, documentation |
//! | [`quantities`] | units, and the display units of the field |
//! | [`values`] | the values of all variables of an instance, flat |
//! | [`component`] | interface of a model: it is made from its parameters, and steps |
//! | [`calibrator`] | the calibration core as a component |
//! | [`calibrator_can`] | the same core as a device on a CAN bus |
//! | [`plant`] | motion, turntable, sensors and faults as a component |
//! | [`c`] | the C interface of both standards, the same for every component |
//!
//! One shared library holds all models and both standards: the token given at instantiation
//! chooses the model.

pub mod c;
pub mod calibrator;
pub mod calibrator_can;
pub mod component;
mod groups;
pub mod plant;
pub mod quantities;
pub mod table;
pub mod values;
