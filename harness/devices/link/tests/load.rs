//! Whether a line or bus carries a sample rate.

use octant_link::load::{PortLoad, real_time};
use octant_wire::can::Bus;

fn load(uri: &str, rate_hz: f64) -> Result<PortLoad, String> {
    real_time(&uri.parse().unwrap(), rate_hz, None).map_err(|error| error.to_string())
}

#[test]
fn a_line_that_is_too_slow_is_refused_with_one_that_isn_t() {
    // 200 outputs of 150 bytes, ten bits each: 300 kbit/s and the traffic beside them.
    let refused = load("serial:/dev/ttyUSB0?baud=115200", 200.0).unwrap_err();
    assert!(refused.contains("expected 460800 baud or more"), "{refused}");
    assert!(load("serial:/dev/ttyUSB0?baud=460800", 200.0).is_ok());
    assert!(load("serial:/dev/ttyUSB0?baud=921600", 1000.0).is_err());
    assert!(load("serial:/dev/ttyUSB0?baud=2000000", 1000.0).is_ok());
}

#[test]
fn a_bus_that_is_too_slow_is_refused() {
    let refused = load("can:can0?bitrate=500000", 200.0).unwrap_err();
    assert!(refused.contains("classic CAN at 500 kbit/s can't carry 200"), "{refused}");
    assert!(load("can:can0?bitrate=1000000", 200.0).is_ok());
    assert!(load("slcan:/dev/ttyACM0?bitrate=500000", 200.0).is_err());
    let fd = load("can:can0?fd=1&bitrate=500000&data_bitrate=2000000", 200.0).unwrap();
    assert!(matches!(fd, PortLoad::Bus(_, load) if load.share() < 0.3));
    // FD without a second rate is sent at the first one.
    assert!(load("can:can0?fd=1&bitrate=250000", 1000.0).is_err());
}

#[test]
fn what_has_no_rate_has_no_limit() {
    for uri in ["pty:", "udp:127.0.0.1:5005", "can:vcan0"] {
        assert_eq!(load(uri, 1000.0).unwrap(), PortLoad::Unlimited);
    }
    // The URI names no rate, so that of the interface counts.
    let uri = "can:can0".parse().unwrap();
    assert!(real_time(&uri, 200.0, Some(Bus::classic(500_000))).is_err());
}
