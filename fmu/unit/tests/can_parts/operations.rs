//! Bus operations as bytes, and back.

use super::operation::{
    ArbitrationLost, BusError, Configuration, ErrorCause, Kind, NodeState, Operation, Operations,
    Transmit, Writer, is_format_error, transmit_bytes,
};

fn all(bytes: &[u8]) -> Vec<Result<Operation<'_>, &[u8]>> {
    Operations::of(bytes).collect()
}

/// Bytes according to tables 5 to 22 of the standard.
#[test]
fn operations_are_the_bytes_of_the_standard() {
    let mut bytes = Vec::new();
    let mut to = Writer(&mut bytes);
    to.configuration(Configuration::BitRate(500_000));
    to.configuration(Configuration::DataBitRate(2_000_000));
    to.configuration(Configuration::ArbitrationLost(ArbitrationLost::Notify));
    to.status(NodeState::BusOff);
    to.transmit(0x1A0, false, false, &[1, 2, 3]);
    to.transmit(0x5A0, true, true, &[7; 12]);
    to.format_error(&[9, 9]);
    let expected: Vec<u8> = [
        &[0x40, 0, 0, 0, 13, 0, 0, 0, 1, 0x20, 0xA1, 0x07, 0][..],
        &[0x40, 0, 0, 0, 13, 0, 0, 0, 2, 0x80, 0x84, 0x1E, 0],
        &[0x40, 0, 0, 0, 10, 0, 0, 0, 4, 2],
        &[0x41, 0, 0, 0, 9, 0, 0, 0, 3],
        &[0x10, 0, 0, 0, 19, 0, 0, 0, 0xA0, 1, 0, 0, 0, 0, 3, 0, 1, 2, 3],
        &[0x11, 0, 0, 0, 29, 0, 0, 0, 0xA0, 5, 0, 0, 0, 1, 1, 12, 0],
        &[7; 12],
        &[1, 0, 0, 0, 12, 0, 0, 0, 2, 0, 9, 9],
    ]
    .concat();
    assert_eq!(bytes, expected);
    let read = all(&bytes);
    assert_eq!(read.len(), 7);
    assert!(read.iter().all(Result::is_ok));
    let data = &[1, 2, 3][..];
    let kind = Kind::Classic { remote: false };
    let frame = Transmit { id: 0x1A0, extended: false, kind, data };
    assert_eq!(read[4], Ok(Operation::Transmit(frame)));
    assert_eq!(read[6], Ok(Operation::FormatError { quoted: &[9, 9] }));
    assert_eq!(transmit_bytes(false, 3), 19);
    assert_eq!(transmit_bytes(true, 12), 29);
}

#[test]
fn what_the_bus_says_is_read() {
    let bytes = [
        &[0x20, 0, 0, 0, 12, 0, 0, 0, 0xA0, 1, 0, 0][..],
        &[0x30, 0, 0, 0, 12, 0, 0, 0, 0xA1, 1, 0, 0],
        &[0x31, 0, 0, 0, 15, 0, 0, 0, 0xA2, 1, 0, 0, 5, 2, 1],
        &[0x42, 0, 0, 0, 8, 0, 0, 0],
        &[0x12, 0, 0, 0, 23, 0, 0, 0, 1, 0, 0, 0, 0, 1, 2, 3, 4, 0, 0, 0, 1, 0, 5],
        &[0x10, 0, 0, 0, 16, 0, 0, 0, 1, 0, 0, 0x10, 1, 1, 4, 0],
    ]
    .concat();
    let read = all(&bytes);
    assert_eq!(read[0], Ok(Operation::Confirm { id: 0x1A0 }));
    assert_eq!(read[1], Ok(Operation::ArbitrationLost { id: 0x1A1 }));
    let cause = ErrorCause::Acknowledgement;
    let error = BusError { id: 0x1A2, cause, primary: false, is_sender: true };
    assert_eq!(read[2], Ok(Operation::BusError(error)));
    assert_eq!(read[3], Ok(Operation::Ignored));
    assert!(matches!(read[4], Ok(Operation::Transmit(Transmit { kind: Kind::Xl, .. }))));
    let remote = Kind::Classic { remote: true };
    assert!(
        matches!(read[5], Ok(Operation::Transmit(f)) if f.kind == remote && f.extended && f.id == 0x1000_0001)
    );
}

#[test]
fn what_is_no_operation_is_handed_out_whole() {
    let confirm = [0x20, 0, 0, 0, 12, 0, 0, 0, 0xA0, 1, 0, 0];
    for bad in [
        // An unknown code; too long a confirm; a Boolean of 2; 9 bytes in a classic frame; an
        // identifier beyond 11 bits; a wrong length of the data; an unknown error.
        &[0x99, 0, 0, 0, 8, 0, 0, 0][..],
        &[0x20, 0, 0, 0, 13, 0, 0, 0, 0, 0, 0, 0, 0],
        &[0x10, 0, 0, 0, 16, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0],
        &[0x10, 0, 0, 0, 25, 0, 0, 0, 0, 0, 0, 0, 0, 0, 9, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9],
        &[0x10, 0, 0, 0, 16, 0, 0, 0, 0, 8, 0, 0, 0, 0, 0, 0],
        &[0x10, 0, 0, 0, 17, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1],
        &[0x31, 0, 0, 0, 15, 0, 0, 0, 0, 0, 0, 0, 7, 1, 0],
    ] {
        let bytes = [bad, &confirm].concat();
        assert_eq!(all(&bytes), [Err(bad), Ok(Operation::Confirm { id: 0x1A0 })], "{bad:?}");
    }
    // Without a possible length the rest is lost with the operation.
    for bad in
        [&[0x20, 0, 0][..], &[0x20, 0, 0, 0, 7, 0, 0, 0, 1, 1], &[0x20, 0, 0, 0, 99, 0, 0, 0]]
    {
        let bytes = [&confirm, bad].concat();
        assert_eq!(all(&bytes), [Ok(Operation::Confirm { id: 0x1A0 }), Err(bad)], "{bad:?}");
    }
    assert!(is_format_error(&[1, 0, 0, 0]) && !is_format_error(&confirm));
}
