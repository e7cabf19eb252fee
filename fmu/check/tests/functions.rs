//! Functions and the interfaces that they belong to.

use octant_fmu_check::functions::{OneInterface, interface_of};

#[test]
fn every_function_of_one_interface_is_a_function() {
    let names = octant_fmi::fmi2::NAMES.iter().chain(octant_fmi::fmi3::NAMES);
    let of = |interface| names.clone().filter(|name| interface_of(name) == Some(interface)).count();
    assert_eq!(of(OneInterface::ModelExchange), 10 + 11);
    assert_eq!(of(OneInterface::CoSimulation), 9 + 4);
    assert_eq!(of(OneInterface::ScheduledExecution), 2);
}
