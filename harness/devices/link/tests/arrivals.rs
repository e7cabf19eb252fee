//! The kernel's times of arrival.

use octant_link::Uri;
use octant_link::port::{self, Bytes, Port};
use octant_wire::EndRole;
use std::net::UdpSocket;
use std::time::{Duration, SystemTime};

fn opened(uri: &str) -> Box<dyn Bytes> {
    let uri: Uri = uri.parse().unwrap();
    match port::open(&uri, EndRole::Device).unwrap() {
        Port::Bytes(port) => port,
        Port::Frames(_) => unreachable!("UDP carries bytes"),
    }
}

/// A datagram that waited for its reader arrived before the wait, and after it was sent.
#[cfg(target_os = "linux")]
#[test]
fn a_datagram_arrived_between_its_sending_and_its_reading() {
    for host in ["127.0.0.1:0", "[::1]:0"] {
        let Ok(sender) = UdpSocket::bind(host) else { continue };
        let mut port = opened(&format!("udp:{host}"));
        assert!(port.stamp_arrivals());
        assert_eq!(port.arrived(), None);
        sender.connect(port.reached_at().strip_prefix("udp:").unwrap()).unwrap();
        let mut buffer = [0; 64];
        // The kernel switches its stamps on a moment after it was asked: until then a datagram has the time
        // of its reading.
        for _ in 0..100 {
            sender.send(b"first").unwrap();
            std::thread::sleep(Duration::from_millis(30));
            port.receive(&mut buffer, octant_test_processes::HANGS).unwrap();
            let waited = SystemTime::now().duration_since(port.arrived().unwrap()).unwrap();
            if waited >= Duration::from_millis(20) {
                break;
            }
        }
        for text in [&b"one"[..], b"second"] {
            let before = SystemTime::now();
            sender.send(text).unwrap();
            let sent = SystemTime::now();
            std::thread::sleep(Duration::from_millis(30));
            let count = port.receive(&mut buffer, octant_test_processes::HANGS).unwrap();
            assert_eq!(&buffer[..count], text);
            let arrived = port.arrived().unwrap();
            // On the loopback the kernel stamps a datagram while it is being sent, but may do so later.
            assert!(before <= arrived && arrived < SystemTime::now(), "{before:?} {arrived:?}");
            let waited = SystemTime::now().duration_since(arrived).unwrap();
            assert!(waited >= Duration::from_millis(20), "{waited:?} {sent:?}");
        }
        // An answer still finds its way.
        assert!(port.send(b"answer", Duration::ZERO).unwrap());
        assert_eq!(sender.recv(&mut buffer).unwrap(), 6);
        assert_eq!(port.receive(&mut buffer, Duration::ZERO).unwrap(), 0);
        assert_eq!(port.arrived(), None);
    }
}

#[test]
fn a_line_has_no_times_of_the_kernel() {
    let mut line = opened("pty:");
    assert!(!line.stamp_arrivals() && line.arrived().is_none());
}
