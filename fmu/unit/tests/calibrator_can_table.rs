//! The table of the Calibrator on CAN.

use octant_fmu::calibrator::table as calibrator;
use octant_fmu::calibrator_can::table::{MODEL, slot};
use octant_fmu::table::{DeclaredCausality, DeclaredVariable};

/// Variables of the Calibrator with a causality.
fn of_calibrator(causality: DeclaredCausality) -> impl Iterator<Item = &'static DeclaredVariable> {
    calibrator::MODEL.variables.iter().filter(move |variable| variable.causality == causality)
}

/// Outputs are copied as one range of cells.
#[test]
fn outputs_stand_in_the_order_of_the_calibrator() {
    let first = of_calibrator(DeclaredCausality::Output).next().unwrap();
    assert_eq!(first.name, "gimbal_command.azimuth");
    for variable in of_calibrator(DeclaredCausality::Output) {
        let (here, there) = (MODEL.slot(variable.name), calibrator::MODEL.slot(variable.name));
        assert_eq!(here - slot::OUTPUTS, there - slot::CALIBRATOR_OUTPUTS, "{}", variable.name);
    }
}

/// Every parameter of the core, except stamps, is a parameter of the device.
#[test]
fn the_core_is_configured_by_the_same_parameters() {
    for variable in of_calibrator(DeclaredCausality::Parameter) {
        let found = MODEL.find(variable.name).map(|(_, found)| found);
        match variable.name {
            "imu.external_stamps" => assert!(found.is_none()),
            name => {
                let found = found.unwrap_or_else(|| panic!("{name} is missing"));
                assert_eq!(found.kind, variable.kind, "{name}");
                assert_eq!(found.start, variable.start, "{name}");
                assert_eq!((found.min, found.max), (variable.min, variable.max), "{name}");
            }
        }
    }
}
