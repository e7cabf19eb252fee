//! Names of ports.

use octant_link::Uri;
use octant_link::uri::{DEFAULT_BAUD, SCHEMES};
use proptest::prelude::*;

fn refused(text: &str) -> String {
    text.parse::<Uri>().unwrap_err().to_string()
}

#[test]
fn a_name_is_what_it_was_read_from() {
    for text in [
        "serial:/dev/ttyUSB0?baud=921600",
        "serial:COM3?baud=115200",
        "pty:",
        "pty:/tmp/device",
        "can:can0?fd=0",
        "can:vcan1?fd=1&bitrate=500000&data_bitrate=2000000",
        "slcan:/dev/ttyACM0?baud=115200&bitrate=500000",
        "slcan:/dev/ttyACM0?baud=115200&bitrate=1000000&fd=1&data_bitrate=5000000",
        "udp:192.168.1.7:5005",
        "udp:[::1]:5005",
        "udp::5005",
        "tcp:192.168.1.7:5005",
        "tcp:[::1]:5005",
        "tcp:0.0.0.0:5005?listen=1",
        "exec:./core",
        "stdio:",
        "exec:python3 core.py --rate 200",
    ] {
        let uri: Uri = text.parse().unwrap();
        assert_eq!(uri.to_string(), text);
        assert!(Uri::is_one(text) && text.starts_with(uri.scheme()));
    }
    let Uri::Serial(serial) = "serial:/dev/ttyS0".parse().unwrap() else { panic!() };
    assert_eq!(serial.baud, DEFAULT_BAUD);
    let Uri::Udp(udp) = "udp:5005".parse().unwrap() else { panic!() };
    assert_eq!((udp.address.host.as_str(), udp.address.port), ("", 5005));
}

#[test]
fn what_is_not_known_is_refused_with_the_nearest() {
    assert!(refused("/dev/ttyUSB0").contains("expected SCHEME:NAME"));
    assert!(refused("seral:/dev/ttyUSB0").contains("expected serial?"));
    let known = format!("known are {}", SCHEMES.map(|scheme| scheme.name).join(", "));
    assert!(refused("carrier-pigeon:1").contains(&known));
    assert!(refused("serial:/dev/ttyUSB0?bauds=1").contains("expected baud?"));
    assert!(refused("can:can0?bit_rate=500000").contains("expected bitrate?"));
    assert!(refused("udp:localhost:5005?baud=1").contains("known are secret"));
    assert!(refused("serial:/dev/ttyUSB0?baud=9600&baud=9600").contains("each once"));
    assert!(refused("serial:/dev/ttyUSB0?baud").contains("expected OPTION=VALUE"));
}

#[test]
fn values_are_checked() {
    assert!(refused("serial:").contains("expected serial:PORT?baud=RATE (921600 by default)"));
    assert!(refused("serial:/dev/ttyUSB0?baud=fast").contains("found baud=fast"));
    assert!(refused("serial:/dev/ttyUSB0?baud=0").contains("found baud=0"));
    assert!(refused("can:can0?fd=yes").contains("0 (classic CAN) or 1 (CAN FD)"));
    assert!(refused("can:can0?data_bitrate=2000000").contains("fd=1 with it"));
    assert!(refused("slcan:/dev/ttyACM0").contains("found bitrate=nothing"));
    assert!(refused("slcan:/dev/ttyACM0?bitrate=123456").contains("one of 10000, 20000"));
    let fd = "slcan:/dev/ttyACM0?bitrate=500000&fd=1";
    assert!(refused(fd).contains("found data_bitrate=nothing"));
    for text in ["udp:", "udp:localhost", "udp:localhost:65536", "udp:[::1:5005"] {
        assert!(refused(text).contains("udp:HOST:PORT"), "{text}");
    }
    assert!(refused("tcp:localhost").contains("tcp:HOST:PORT"));
    assert!(
        refused("tcp:::1:5005").contains("expected tcp:[::1]:5005: an IPv6 address is in brackets")
    );
    assert!(refused("tcp:unit:5005?listen=0").contains("found listen=0, expected 1"));
    assert!(refused("udp:::1:5005").contains("expected udp:[::1]:5005"));
    assert!(refused("exec:").contains("exec:PROGRAM"));
    assert!(refused("exec:./core?fast=1").contains("it has no options"));
}

proptest! {
    #[test]
    fn every_text_is_read_without_a_panic_and_comes_back(text in any_text()) {
        if let Ok(uri) = text.parse::<Uri>() {
            prop_assert_eq!(uri.to_string().parse::<Uri>(), Ok(uri));
        }
    }
}

/// Texts of all kinds, most of them near to a name of a port.
fn any_text() -> impl Strategy<Value = String> {
    let schemes = prop::sample::select(SCHEMES.map(|scheme| scheme.name.to_owned()).to_vec());
    let options =
        ["baud", "bitrate", "fd", "data_bitrate", "secret", "listen"].map(str::to_owned).to_vec();
    let part = prop_oneof![
        prop::sample::select(options),
        prop::sample::select([":", "?", "=", "&", "[", "]", "::1", "%", "500000"].to_vec())
            .prop_map(str::to_owned),
        "[0-9]{0,6}",
        "[a-z/]{0,6}",
        any::<String>(),
    ];
    (prop_oneof![9 => schemes, 1 => any::<String>()], prop::collection::vec(part, 0..9))
        .prop_map(|(scheme, parts)| format!("{scheme}:{}", parts.concat()))
}
