//! Ends of epochs in a stream of messages.

use octant_recorder::message::Topic;
use octant_views::boundary::EpochBoundary;

#[test]
fn another_time_or_a_topic_of_no_higher_rank_begins_an_epoch() {
    let mut boundary = EpochBoundary::default();
    let found = [
        (5, Topic::Aiding),
        (5, Topic::Imu),
        (5, Topic::Output),
        (5, Topic::Event),
        (5, Topic::Truth),
        // Two samples reached the core in this step.
        (5, Topic::Imu),
        (9, Topic::Output),
    ]
    .map(|(time_ns, topic)| boundary.take(time_ns, topic));
    assert_eq!(found, [None, None, None, None, None, Some(5), Some(5)]);
    assert_eq!(boundary.time_ns(), 9);
}
