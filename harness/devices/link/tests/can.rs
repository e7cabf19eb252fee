//! Sessions over a CAN interface of the kernel. `OCTANT_CAN` names an interface that is up, such as
//! `vcan0`; without it these tests are skipped, because setting up an interface needs privileges.
#![allow(clippy::print_stdout, reason = "what is skipped is said")]

use crate::common::{self, Served, drive, facts, options};
use octant_faults::wire::{Ways, WireAction, WireFault};
use octant_link::fault::around;
use octant_link::harness::{Harness, Patience, SessionOptions};
use octant_link::{Uri, Wire, port};
use octant_wire::message::EndRole;
use std::sync::Mutex;
use std::time::Duration;

/// Lock that admits one session at a time to the bus.
static BUS: Mutex<()> = Mutex::new(());

/// URIs of the interface with options, for the harness and the device. The device uses
/// `OCTANT_CAN_FAR`, another interface on the same bus, if that is set.
fn bus(options: &str) -> Option<[String; 2]> {
    match std::env::var("OCTANT_CAN") {
        Ok(near) => {
            let far = std::env::var("OCTANT_CAN_FAR").unwrap_or_else(|_| near.clone());
            Some([near, far].map(|interface| format!("can:{interface}{options}")))
        }
        Err(_) => {
            println!("skipped: OCTANT_CAN names no interface");
            None
        }
    }
}

fn session([uri, far]: [String; 2]) {
    let _alone = BUS.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let (mut served, _) = Served::on(&far, facts());
    let uri: Uri = uri.parse().unwrap();
    let mut harness = common::harness(&uri);
    drive(&mut harness, 400);
    let counts = harness.counts();
    assert_eq!((counts.lost, counts.damaged, counts.missing), (0, 0, 0), "{uri}: {counts:?}");
    drop(harness);
    served.stop();
}

#[test]
fn classic_can_carries_a_session() {
    if let Some(uri) = bus("") {
        session(uri);
    }
}

#[test]
fn can_fd_carries_a_session() {
    // `OCTANT_CAN_CLASSIC` marks controllers that can't do CAN FD.
    if std::env::var_os("OCTANT_CAN_CLASSIC").is_some() {
        return;
    }
    if let Some(uri) = bus("?fd=1") {
        session(uri);
    }
}

#[test]
fn a_bus_with_faults_carries_a_session() {
    let Some([name, far]) = bus("") else { return };
    let _alone = BUS.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let (mut served, _) = Served::on(&far, facts());
    let uri: Uri = name.parse().unwrap();
    let port = around(port::open(&uri, EndRole::Harness).unwrap());
    let patience = Patience { repeat: Duration::from_millis(10), ..options().patience };
    let options = SessionOptions { patience, ..options() };
    let mut harness = Harness::open(Wire::new(name, port, EndRole::Harness), options).unwrap();
    let ways = Ways { to_device: true, to_harness: true };
    let actions = [
        (WireAction::Lose, 0.005),
        (WireAction::Collision, 0.005),
        (WireAction::ArbitrationLost, 0.2),
        (WireAction::BusOff { off_s: 0.05 }, 1.0),
    ];
    for (handle, (action, chance)) in (0..).zip(actions) {
        let fault = WireFault { ways, chance, action, key: [5, u64::from(handle)] };
        harness.wire().wired().unwrap().begin(handle, &fault);
    }
    drive(&mut harness, 100);
    for handle in 0..4 {
        assert!(harness.wire().wired().unwrap().altered(handle).frames > 0, "{handle}");
    }
    let counts = harness.counts();
    assert_eq!((counts.bus_off, counts.restarted), (1, 1));
    drop(harness);
    served.stop();
}
