//! The CAN controller: order, confirmation, error counters.

use super::controller::{Controller, Setup};
use super::operation::{BusError, ErrorCause, NodeState, Operation, Operations};
use octant_wire::can::{BusFrame, CanVersion};

fn controller(notifications: bool) -> Controller {
    let setup = Setup { format: CanVersion::Classic, notifications, bit_rate: 500_000 };
    let mut controller = Controller::new(setup, &[]);
    assert_eq!(status(&controller.send(0, 1000)), [1]);
    controller
}

fn frame(id: u16) -> BusFrame {
    BusFrame::new(id, CanVersion::Classic, &[1, 2]).unwrap()
}

/// Node states sent, as numbers.
fn status(bytes: &[u8]) -> Vec<u8> {
    bytes.windows(9).filter(|w| w[..8] == [0x41, 0, 0, 0, 9, 0, 0, 0]).map(|w| w[8]).collect()
}

fn sent(bytes: &[u8]) -> Vec<u32> {
    Operations::of(bytes)
        .filter_map(|operation| match operation {
            Ok(Operation::Transmit(frame)) => Some(frame.id),
            _ => None,
        })
        .collect()
}

fn error(cause: ErrorCause, primary: bool, is_sender: bool) -> BusError {
    BusError { id: 7, cause, primary, is_sender }
}

#[test]
fn without_notifications_it_sends_and_forgets() {
    let mut controller = controller(false);
    (1..=3).for_each(|id| controller.push(frame(id)));
    // Two frames of 18 bytes fit.
    assert_eq!(sent(&controller.send(0, 40)), [1, 2]);
    assert_eq!(controller.due_ns(5), Some(5));
    assert_eq!(sent(&controller.send(5, 40)), [3]);
    assert_eq!(controller.due_ns(5), None);
    // Notifications that the controller doesn't use change nothing.
    controller.bus_error(&error(ErrorCause::Other, true, true), 5);
    controller.confirmed(3);
    controller.arbitration_lost(3, 5);
    assert_eq!((controller.errors(), controller.due_ns(9)), ((0, 0), None));
}

#[test]
fn with_notifications_each_frame_waits_for_its_end() {
    let mut controller = controller(true);
    controller.push(frame(7));
    controller.push(frame(8));
    assert_eq!(sent(&controller.send(0, 1000)), [7]);
    assert_eq!(controller.due_ns(10), None);
    controller.confirmed(8);
    assert_eq!(controller.due_ns(10), None, "another frame was confirmed");
    controller.arbitration_lost(7, 10);
    // 47 bits of 2 us.
    assert_eq!(controller.due_ns(10), Some(94_010));
    assert!(sent(&controller.send(94_009, 1000)).is_empty());
    assert_eq!(sent(&controller.send(94_010, 1000)), [7]);
    controller.bus_error(&error(ErrorCause::Other, false, true), 100_000);
    assert_eq!(controller.errors(), (8, 0));
    assert_eq!(sent(&controller.send(194_000, 1000)), [7]);
    controller.confirmed(7);
    assert_eq!(controller.errors(), (7, 0));
    assert_eq!(sent(&controller.send(194_000, 1000)), [8]);
}

/// The rules of the implementers' guide, one after another.
#[test]
fn errors_are_counted_by_the_rules() {
    let mut controller = controller(true);
    controller.bus_error(&error(ErrorCause::Other, false, false), 0);
    assert_eq!(controller.errors(), (0, 1));
    controller.bus_error(&error(ErrorCause::Other, true, false), 0);
    assert_eq!(controller.errors(), (0, 9));
    controller.bus_error(&error(ErrorCause::BrokenErrorFrame, false, false), 0);
    assert_eq!(controller.errors(), (8, 17));
    controller.heard_frame();
    assert_eq!(controller.errors(), (8, 16));
    for _ in 0..15 {
        controller.bus_error(&error(ErrorCause::Other, true, true), 0);
    }
    assert_eq!((controller.errors().0, controller.state()), (128, NodeState::ErrorPassive));
    controller.bus_error(&error(ErrorCause::Acknowledgement, true, true), 0);
    assert_eq!(controller.errors().0, 128, "passive, and nobody acknowledges");
    assert_eq!(status(&controller.send(0, 1000)), [2]);
    controller.push(frame(7));
    for _ in 0..16 {
        controller.bus_error(&error(ErrorCause::Other, true, true), 0);
    }
    assert_eq!((controller.state(), controller.lost()), (NodeState::BusOff, 1));
    controller.push(frame(8));
    let bytes = controller.send(0, 1000);
    assert_eq!((status(&bytes), sent(&bytes)), (vec![3], vec![]));
    for _ in 0..127 {
        controller.heard_frame();
    }
    assert_eq!(controller.state(), NodeState::BusOff);
    controller.heard_frame();
    assert_eq!((controller.state(), controller.errors()), (NodeState::ErrorActive, (0, 0)));
    controller.push(frame(9));
    let bytes = controller.send(0, 1000);
    assert_eq!((status(&bytes), sent(&bytes)), (vec![1], vec![9]));
}

#[test]
fn nonsense_is_quoted_back_but_for_quotations() {
    let mut controller = controller(false);
    controller.refuse(&[0x99, 0, 0, 0]);
    controller.refuse(&[1, 0, 0, 0, 9]);
    let bytes = controller.send(0, 1000);
    let read: Vec<_> = Operations::of(&bytes).collect();
    assert_eq!(read, [Ok(Operation::FormatError { quoted: &[0x99, 0, 0, 0] })]);
}
