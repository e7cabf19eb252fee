//! Segments of parameters, gathered.

use octant_sample::Parameters;
use octant_wire::StepNumber;
use octant_wire::message::{Gathering, PARAMETERS_SEGMENTS, ParametersSegment};

fn segments(step: u16, revision: u32) -> [ParametersSegment; PARAMETERS_SEGMENTS] {
    let values = core::array::from_fn(|i| i as f64 + f64::from(revision));
    let sigma = core::array::from_fn(|i| -(i as f64));
    let parameters = Parameters::from_array(&values);
    ParametersSegment::all(StepNumber::new(step), revision, &parameters, &sigma)
}

#[test]
fn segments_in_any_order_are_the_parameters_again() {
    let mut gathering = Gathering::new();
    let all = segments(7, 3);
    for index in [4, 0, 5, 1, 1, 3] {
        assert_eq!(gathering.add(&all[index]), None);
    }
    let gathered = gathering.add(&all[2]).unwrap();
    assert_eq!((gathered.step, gathered.revision), (StepNumber::new(7), 3));
    assert_eq!(gathered.parameters.to_array()[29], 32.0);
    assert_eq!(gathered.sigma[29], -29.0);
}

#[test]
fn segments_of_two_revisions_are_not_mixed() {
    let mut gathering = Gathering::new();
    let (old, new) = (segments(7, 3), segments(8, 4));
    for segment in &old[..5] {
        assert_eq!(gathering.add(segment), None);
    }
    for segment in &new[..5] {
        assert_eq!(gathering.add(segment), None);
    }
    assert_eq!(gathering.abandoned(), 1);
    assert_eq!(gathering.add(&new[5]).map(|all| all.revision), Some(4));
    assert_eq!(gathering.add(&old[5]), None, "the former five are gone");
}
