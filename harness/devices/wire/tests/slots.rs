//! CAN identifiers and the messages that they stand for.

use octant_wire::can::{CanVersion, Slot};
use octant_wire::{EndRole, MessageKind};

#[test]
fn every_sender_has_a_slot_for_what_it_sends_and_for_nothing_else() {
    for kind in MessageKind::ALL {
        for role in EndRole::ALL {
            let slot = Slot::of(role, kind, 0);
            assert_eq!(slot.is_some(), kind.senders().contains(&role), "{role:?} {kind:?}");
        }
    }
    assert_eq!(Slot::of(EndRole::Device, MessageKind::Parameters, 6), None);
}

#[test]
fn an_identifier_and_its_slot_are_the_same_thing() {
    let mut found = 0;
    for id in 0..=0xFFFF {
        if let Some((slot, segment, format)) = Slot::of_id(id) {
            assert_eq!(slot.id(segment, format), id);
            found += 1;
        }
    }
    let frames = |format| Slot::ALL.iter().map(|slot| slot.segments(format)).sum::<usize>();
    assert_eq!(found, frames(CanVersion::Classic) + frames(CanVersion::Fd));
}

#[test]
fn a_sample_is_seven_classic_frames_or_one() {
    let sample = Slot::of(EndRole::Harness, MessageKind::Sample, 0).unwrap();
    assert_eq!(sample.segments(CanVersion::Classic), 7);
    assert_eq!(sample.segments(CanVersion::Fd), 1);
    assert_eq!(sample.frame_bytes(0, CanVersion::Fd), 64);
    let output = Slot::of(EndRole::Device, MessageKind::Output, 0).unwrap();
    assert_eq!(output.segments(CanVersion::Classic), 17);
    assert_eq!([0, 1, 2].map(|i| output.frame_bytes(i, CanVersion::Fd)), [64, 64, 8]);
}
