//! Standard messages of ROS 2 about an epoch.

use octant_recorder::further::FurtherMessages;
use octant_recorder::reader::Item;
use octant_sample::Mode;
use octant_sample::{NavigationCovariance, Output, Sample, Status, Truth};
use octant_views::standard::{StandardEpochs, StandardTopic};

/// Messages of an epoch on all topics, by the numbers of their channels.
fn messages(items: &[Item], is_due: bool) -> Vec<(usize, Vec<u8>)> {
    let mut epochs = StandardEpochs::new(&StandardTopic::ALL, 0, Some(5_000_000));
    let mut messages = FurtherMessages::default();
    // An epoch before it leaves nothing behind.
    let before = Truth { latitude_rad: 1.0, ..Truth::default() };
    epochs.take(1, &Item::Truth(before));
    epochs.end(true, &mut messages);
    items.iter().for_each(|item| epochs.take(7_000_000_009, item));
    epochs.end(is_due, &mut messages);
    messages.iter().map(|(channel, message)| (channel, message.to_vec())).collect()
}

fn topics(found: &[(usize, Vec<u8>)]) -> Vec<StandardTopic> {
    found.iter().map(|(channel, _)| StandardTopic::ALL[*channel]).collect()
}

fn output(mode: Mode, q_nb: [f64; 4]) -> Item {
    let mut output = Output { mode, ..Output::default() };
    output.navigation.q_nb = q_nb;
    Item::Output(output)
}

const LEVEL: [f64; 4] = [1.0, 0.0, 0.0, 0.0];

#[test]
fn an_epoch_has_what_its_parts_allow() {
    let sample = Item::Sample(Sample::default());
    let truth = Item::Truth(Truth { q_nb: LEVEL, ..Truth::default() });
    let navigating = output(Mode::Navigating, LEVEL);
    let all = messages(&[sample.clone(), navigating.clone(), truth.clone()], true);
    assert_eq!(topics(&all), StandardTopic::ALL);
    assert!(messages(&[sample.clone(), navigating.clone(), truth.clone()], false).is_empty());
    let without_truth = topics(&messages(&[sample.clone(), navigating], true));
    assert_eq!(without_truth, [StandardTopic::Imu, StandardTopic::Fix, StandardTopic::Velocity]);
    // A core that still aligns has a position that is no solution, and no error.
    let aligning = topics(&messages(&[sample, output(Mode::Aligning, [0.0; 4]), truth], true));
    let wanted = [
        StandardTopic::Imu,
        StandardTopic::Fix,
        StandardTopic::TrueFix,
        StandardTopic::TrueVelocity,
    ];
    assert_eq!(aligning, wanted);
}

#[test]
fn an_invalid_sample_has_no_rates() {
    let sample = Sample { status: Status::INERTIAL_INVALID, ..Sample::default() };
    assert!(messages(&[Item::Sample(sample)], true).is_empty());
}

#[test]
fn what_is_unknown_is_marked_as_the_definitions_say() {
    let sample = Item::Sample(Sample::default());
    let covariance = NavigationCovariance {
        position_m2: [1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
        attitude_rad2: [7.0, 8.0, 9.0, 10.0, 11.0, 12.0],
        ..NavigationCovariance::default()
    };
    let number = |message: &[u8], at: usize| {
        f64::from_le_bytes(*message[4 + at..].first_chunk::<8>().unwrap_or(&[0xFF; 8]))
    };
    // Offsets after the encapsulation: header 24 bytes, then the orientation's four numbers; the
    // status of a fix, then three numbers and nine.
    let of = |mode, q_nb, covariance: Option<NavigationCovariance>| {
        let known = covariance.map(|covariance| Item::Covariance(1, covariance));
        let items: Vec<Item> =
            [sample.clone(), output(mode, q_nb)].into_iter().chain(known).collect();
        let found = messages(&items, true);
        let (imu, fix) = (&found[0].1, &found[1].1);
        (number(imu, 24 + 32), fix[4 + 16] as i8, number(fix, 24 + 24), fix[4 + 24 + 12 * 8])
    };
    assert_eq!(of(Mode::Calibrating, LEVEL, Some(covariance)), (10.0, 0, 4.0, 3));
    assert_eq!(of(Mode::Navigating, LEVEL, None), (0.0, 0, 0.0, 0));
    assert_eq!(of(Mode::Aligning, [0.0; 4], None), (-1.0, -1, 0.0, 0));
    assert_eq!(of(Mode::Aligning, [0.0; 4], Some(covariance)), (-1.0, -1, 0.0, 0));
}
