//! The table of the Calibrator.

use crate::tables::check;
use octant_calibration::positions::SEQUENCES;
use octant_fmu::calibrator::table::{MODE, MODEL, POSITIONS, slot};
use octant_sample::parameters::ParameterGroup;
use octant_sample::{Health, Mode, Status};

#[test]
fn every_variable_is_described_once_and_starts_within_its_range() {
    check(&MODEL);
}

#[test]
fn groups_of_parameters_lie_one_after_another() {
    for group in ParameterGroup::ALL {
        let range = group.range();
        for (prefix, first) in [
            ("parameters", slot::PARAMETERS),
            ("sigma", slot::SIGMA),
            ("initial_parameters", slot::INITIAL_PARAMETERS),
        ] {
            let (slot, variable) = MODEL.find(&format!("{prefix}.{}", group.name())).unwrap();
            assert_eq!(slot, first + range.start);
            assert_eq!(variable.slots(), range.len());
        }
        for (prefix, first) in [("estimated", slot::ESTIMATED), ("prior", slot::PRIOR_PARAMETERS)] {
            let name = format!("procedure.calibration.{prefix}.{}", group.name());
            assert_eq!(MODEL.find(&name).unwrap().0, first + group as usize);
        }
    }
}

#[test]
fn flags_are_described_with_their_values() {
    let find = |name| MODEL.find(name).unwrap().1;
    for bit in Health::all().iter() {
        assert!(find("health").description.contains(&format!(" {}: ", bit.bits())), "{bit:?}");
    }
    for bit in Status::all().iter() {
        let text = find("imu.status").description;
        assert!(text.contains(&format!(" {}: ", bit.bits())), "{bit:?}");
    }
}

#[test]
fn modes_are_those_of_the_core() {
    for mode in Mode::ALL {
        let item = MODE.items.iter().find(|item| item.0 == mode as i32).unwrap();
        assert_eq!(item.1, mode.name());
    }
    assert_eq!(MODE.items.len(), Mode::ALL.len());
}

#[test]
fn every_published_sequence_has_a_name() {
    let names = POSITIONS.items.iter().skip(1).map(|item| item.1.replace('_', "-"));
    assert!(names.eq(SEQUENCES.iter().map(|sequence| sequence.0)));
}
