//! Frames as lines of an adapter that speaks slcan.

use octant_link::Uri;
use octant_link::port::{BusEvent, BusTrouble, Bytes, Frames, HeardFrame, PortError, SlcanPort};
use octant_wire::can::{BusFrame, CanVersion};
use proptest::prelude::*;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Numbers of data bytes that a length code of CAN FD can have.
const LENGTHS: [usize; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64];

/// Bytes to an adapter and from it.
#[derive(Debug, Default)]
struct Exchanged {
    sent: Vec<u8>,
    coming: VecDeque<u8>,
}

/// The line of an adapter that answers its commands.
#[derive(Debug)]
struct Adapter(Arc<Mutex<Exchanged>>);

impl Bytes for Adapter {
    fn send(&mut self, bytes: &[u8], _: Duration) -> Result<bool, PortError> {
        let mut exchanged = self.0.lock().unwrap();
        exchanged.sent.extend(bytes);
        if matches!(bytes[0], b'C' | b'S' | b'Y' | b'O') {
            exchanged.coming.push_back(b'\r');
        }
        Ok(true)
    }

    fn receive(&mut self, buffer: &mut [u8], _: Duration) -> Result<usize, PortError> {
        let coming = &mut self.0.lock().unwrap().coming;
        let count = buffer.len().min(coming.len());
        for (place, byte) in buffer.iter_mut().zip(coming.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }

    fn datagrams(&self) -> bool {
        false
    }

    fn reached_at(&self) -> String {
        "adapter".to_owned()
    }

    fn hold_peer(&mut self, _: bool) {}

    fn close(&mut self) {}

    fn reopen(&mut self) -> Result<(), PortError> {
        Ok(())
    }
}

/// Opens the channel of an adapter that then sends some text.
fn opened(text: &[u8]) -> (SlcanPort, Arc<Mutex<Exchanged>>) {
    let Uri::Slcan(slcan) = "slcan:a?bitrate=1000000&fd=1&data_bitrate=2000000".parse().unwrap()
    else {
        panic!()
    };
    let exchanged = Arc::new(Mutex::new(Exchanged::default()));
    let port = SlcanPort::over(Box::new(Adapter(exchanged.clone())), &slcan).unwrap();
    {
        let mut exchanged = exchanged.lock().unwrap();
        assert_eq!(std::mem::take(&mut exchanged.sent), b"C\rS8\rY2\rO\r");
        exchanged.coming.extend(text);
    }
    (port, exchanged)
}

/// Events of a text; all of it is taken.
fn read(text: &[u8]) -> Vec<BusEvent> {
    let (mut port, exchanged) = opened(text);
    let events = std::iter::from_fn(|| port.receive(Duration::ZERO).unwrap()).collect();
    assert!(exchanged.lock().unwrap().coming.is_empty());
    events
}

/// Frames that a listener hears in a text; all of it is taken.
fn heard(text: &[u8]) -> Vec<HeardFrame> {
    let (mut port, exchanged) = opened(text);
    let frames = std::iter::from_fn(|| port.hear(Duration::ZERO).unwrap()).collect();
    assert!(exchanged.lock().unwrap().coming.is_empty());
    frames
}

fn line(frame: &BusFrame) -> Vec<u8> {
    let (mut port, exchanged) = opened(b"");
    assert!(port.send(frame, Duration::ZERO).unwrap());
    exchanged.lock().unwrap().sent.clone()
}

#[test]
fn frames_are_the_lines_that_the_protocol_has() {
    let classic = BusFrame::new(0x123, CanVersion::Classic, &[0x11, 0x22, 0xAF]).unwrap();
    assert_eq!(line(&classic), b"t12331122AF\r");
    let fd = BusFrame::new(0x5A0, CanVersion::Fd, &[0xFF; 12]).unwrap();
    assert_eq!(line(&fd), b"b5A09FFFFFFFFFFFFFFFFFFFFFFFF\r");
    assert_eq!(read(b"t12331122af\r"), [BusEvent::Frame(classic)]);
}

#[test]
fn what_is_no_frame_of_ours_is_told_or_passed_over() {
    let foreign = BusEvent::Trouble(BusTrouble::Foreign);
    for text in [
        &b"T0000012381122334455667788\r"[..],
        b"r1230\r",
        b"t12\r",
        b"t1239\r",
        b"t123411\r",
        b"t12G0\r",
        b"tFFF0\r",
    ] {
        assert_eq!(read(text), [foreign], "{}", String::from_utf8_lossy(text));
    }
    assert_eq!(read(&[b"t".as_slice(), &[b'0'; 500], b"\rt0000\r"].concat()).len(), 2);
    assert!(read(b"\r\rz\rV1013\rN1234\rF00\r").is_empty());
    assert_eq!(read(b"\x07"), [BusEvent::Trouble(BusTrouble::Overrun)]);
    assert_eq!(read(b"F20\rF04\r").len(), 2);
}

#[test]
fn who_listens_hears_frames_of_any_identifier() {
    let text = b"t12331122AF\rT18FF00A12BEEF\rtFFF0\rT200000000\rr1230\r\x07D0000012390102030405060708090A0B0C\rt12390102030405060708090A0B0C\r";
    let heard = heard(text);
    assert_eq!(
        heard,
        [
            HeardFrame::new(0x123, false, &[0x11, 0x22, 0xAF]),
            HeardFrame::new(0x18FF_00A1, true, &[0xBE, 0xEF]),
            HeardFrame::new(0x123, true, &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]),
        ]
    );
}

proptest! {
    #[test]
    fn every_frame_comes_back(id in 0..0x800u16, fd: bool, code in 0..16usize, fill: u8) {
        let format = if fd { CanVersion::Fd } else { CanVersion::Classic };
        let data = vec![fill; LENGTHS[code].min(format.room())];
        let frame = BusFrame::new(id, format, &data).unwrap();
        prop_assert_eq!(read(&line(&frame)), [BusEvent::Frame(frame)]);
    }

    #[test]
    fn any_bytes_are_taken(bytes: Vec<u8>) {
        read(&bytes);
    }
}
