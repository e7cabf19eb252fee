//! Sessions with a device that loses its power, or doesn't.

use crate::common::{Served, drive, facts, harness, options};
use octant_link::device::Facts;
use octant_link::harness::{Harness, Patience, SessionError};
use octant_link::{Uri, Wire};
use octant_wire::Text;
use octant_wire::message::EndRole;
use std::net::TcpListener;
use std::time::Duration;

/// A free TCP port, on which a device can come back.
fn free() -> String {
    let address = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    format!("tcp:{address}")
}

#[test]
fn a_device_that_was_off_begins_anew_with_every_answer_of_a_new_one() {
    for uri in [free(), "udp:0".to_owned()] {
        let (mut served, reached) = Served::on(&uri, facts());
        let mut harness = harness(&reached);
        drive(&mut harness, 40);
        assert!(harness.is_in_session().unwrap(), "{uri}");
        served.stop();
        let (_served, _) = Served::on(&reached.to_string(), facts());
        harness.begin_again().unwrap();
        assert!(harness.is_in_session().unwrap(), "{uri}");
        drive(&mut harness, 40);
    }
}

#[test]
fn a_device_that_lost_its_session_is_not_in_it() {
    let (mut served, reached) = Served::on(&free(), facts());
    let mut harness = harness(&reached);
    drive(&mut harness, 10);
    served.stop();
    // Its connection is gone: no patience is needed.
    assert!(!harness.is_in_session().unwrap());
    // Over UDP nothing tells that nobody is there.
    let (mut served, reached) = Served::on("udp:0", facts());
    let wire = Wire::open(&reached, EndRole::Harness).unwrap();
    let answer = Duration::from_secs(1);
    let patience = Patience { answer, ..options().patience };
    let mut harness =
        Harness::open(wire, octant_link::harness::SessionOptions { patience, ..options() })
            .unwrap();
    served.stop();
    assert!(!harness.is_in_session().unwrap());
}

#[test]
fn another_firmware_after_a_loss_of_power_is_refused() {
    let uri = free();
    let (mut served, reached) = Served::on(&uri, facts());
    let mut harness = harness(&reached);
    drive(&mut harness, 10);
    served.stop();
    let rescue = Facts { firmware: Text::fitting("rescue 0"), ..facts() };
    let (_served, _) = Served::on(&uri, rescue);
    let error = harness.begin_again().unwrap_err();
    assert!(matches!(error, SessionError::OtherDevice { .. }), "{error}");
    let told = error.to_string();
    assert!(told.contains("\"echo rescue 0\"") && told.contains("\"echo echo 1\""), "{told}");
}

#[test]
fn a_device_that_stays_off_is_waited_for_as_long_as_a_hello() {
    let uri = free();
    let (mut served, reached) = Served::on(&uri, facts());
    let wire = Wire::open(&reached.to_string().parse::<Uri>().unwrap(), EndRole::Harness).unwrap();
    let patience = Patience { hello: Duration::from_secs(5), ..options().patience };
    let options = octant_link::harness::SessionOptions { patience, ..options() };
    let mut harness = Harness::open(wire, options).unwrap();
    served.stop();
    let error = harness.begin_again().unwrap_err();
    assert!(matches!(error, SessionError::Port(_)), "{error}");
    assert!(error.to_string().contains(&uri), "{error}");
}
