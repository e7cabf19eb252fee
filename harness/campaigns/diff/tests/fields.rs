//! The field of a message that differs.

use octant_diff::fields::{encode, first_difference};
use octant_recorder::message::Topic;
use octant_recorder::reader::Item;
use octant_sample::{Output, Sample};

#[test]
fn the_first_field_that_differs_is_named() {
    let mut sample = Sample { sequence: 7, ..Sample::default() };
    let (mut first, mut second) = (Vec::new(), Vec::new());
    assert!(encode(&Item::Sample(sample), &mut first));
    assert!(encode(&Item::Sample(sample), &mut second));
    assert_eq!(first_difference(Topic::Imu, &first, &second), None);
    sample.delta_velocity[1] = -3;
    sample.gimbal.roll = 4;
    assert!(encode(&Item::Sample(sample), &mut second));
    let found = first_difference(Topic::Imu, &first, &second).unwrap();
    assert_eq!(found, ("delta_velocity[1]".to_owned(), "0".to_owned(), "-3".to_owned()));
}

#[test]
fn fields_of_an_output_are_found_behind_one_another() {
    let one = Output::default();
    let (mut first, mut second) = (Vec::new(), Vec::new());
    encode(&Item::Output(one), &mut first);
    for (change, name) in [
        ((|o| o.navigation.longitude_rad = 0.5) as fn(&mut Output), "longitude_rad"),
        (|o| o.navigation.q_nb[3] = 0.5, "q_nb[3]"),
        (|o| o.nis = 2.5, "nis"),
        (|o| o.stop = 9, "stop"),
        (|o| o.moving = true, "moving"),
    ] {
        let mut other = one;
        change(&mut other);
        encode(&Item::Output(other), &mut second);
        assert_eq!(first_difference(Topic::Output, &first, &second).unwrap().0, name);
    }
}
