//! The reference clients in Python and C as devices: over a pseudo terminal and UDP, on good lines and
//! bad.
//!
//! Without `python3` or `cc` their part is skipped, unless `OCTANT_REQUIRE_PEERS` is set.
#![allow(clippy::print_stdout, reason = "what is skipped is said")]

use crate::common::{Served, drive, facts, options};
use octant_faults::wire::{Ways, WireAction, WireFault};
use octant_link::fault::around;
use octant_link::harness::{Harness, Patience, SessionOptions};
use octant_link::port::{self, Port, Pty};
use octant_link::{Uri, Wire};
use octant_test_processes::{Started, command, start};
use octant_wire::message::{EndRole, Reason};
use std::io::{BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::Stdio;
use std::sync::OnceLock;
use std::time::Duration;

const CLIENTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/wire/clients");

fn there_is(program: &str) -> bool {
    let mut version = command(program);
    version.arg("--version").stdout(Stdio::null()).stderr(Stdio::null());
    let there = version.status().is_ok_and(|status| status.success());
    let required = std::env::var_os("OCTANT_REQUIRE_PEERS").is_some();
    assert!(there || !required, "there is no {program} here");
    if !there {
        println!("skipped: there is no {program} here");
    }
    there
}

/// Commands of the clients that are available here.
fn clients() -> &'static [(&'static str, Vec<String>)] {
    static ALL: OnceLock<Vec<(&'static str, Vec<String>)>> = OnceLock::new();
    ALL.get_or_init(|| {
        let mut all = Vec::new();
        if there_is("python3") {
            let script = format!("{CLIENTS}/octant_client.py");
            all.push(("python", vec!["python3".to_owned(), script]));
        }
        if there_is("cc") {
            let program = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
                .join(format!("octant_client-{}", std::process::id()));
            let built = command("cc")
                .args(["-std=c99", "-O2", "-o"])
                .arg(&program)
                .arg(format!("{CLIENTS}/octant_client.c"))
                .output()
                .unwrap();
            assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
            all.push(("c", vec![program.display().to_string()]));
        }
        all
    })
}

/// A client that serves as a device, stopped at the end of the test.
struct Device(Started);

impl Device {
    fn new(command: &[String], at: &str) -> Self {
        let mut device = octant_test_processes::command(&command[0]);
        device.args(&command[1..]).args(["device", at]).stderr(Stdio::piped());
        Self(start(&mut device))
    }

    /// First line that the client writes to stderr; the others are discarded.
    fn first_line(&mut self) -> String {
        let mut stderr = BufReader::new(self.0.stderr.take().unwrap());
        let mut line = String::new();
        stderr.read_line(&mut line).unwrap();
        std::thread::spawn(move || stderr.read_to_string(&mut String::new()));
        line
    }
}

/// Runs a session over a port, with frames lost, damaged and duplicated if `bad`.
fn session(port: Port, bad: bool) {
    let patience = Patience { repeat: Duration::from_millis(20), ..options().patience };
    let options = if bad { SessionOptions { patience, ..options() } } else { options() };
    let mut harness =
        Harness::open(Wire::new("client", around(port), EndRole::Harness), options).unwrap();
    if bad {
        let ways = Ways { to_device: true, to_harness: true };
        for (handle, action) in
            [WireAction::Lose, WireAction::Flip, WireAction::Duplicate].into_iter().enumerate()
        {
            let fault = WireFault { ways, chance: 0.05, action, key: [3, handle as u64] };
            harness.wire().wired().unwrap().begin(handle as u32, &fault);
        }
    }
    drive(&mut harness, 100);
    for handle in 0..3 {
        let altered = harness.wire().wired().unwrap().altered(handle).frames;
        assert_eq!(altered > 0, bad);
    }
    harness.bye(Reason::DONE, "");
}

#[test]
fn they_are_devices_on_udp() {
    for (name, command) in clients() {
        for bad in [false, true] {
            let mut device = Device::new(command, "udp-listen:127.0.0.1:0");
            let line = device.first_line();
            let number = line.trim().rsplit(' ').next().unwrap();
            let uri: Uri = format!("udp:127.0.0.1:{number}").parse().expect(name);
            session(port::open(&uri, EndRole::Harness).unwrap(), bad);
        }
    }
}

/// The client in Python has the seal from its description alone, as either end.
#[test]
fn a_client_is_a_sealed_device_on_udp() {
    let Some((_, command)) = clients().iter().find(|(name, _)| *name == "python") else { return };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("key");
    std::fs::write(&file, "a secret of the bench\n").unwrap();
    {
        use std::os::unix::fs::PermissionsExt;
        std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o600)).unwrap();
    }
    let secret = format!("?secret={}", file.display());
    for bad in [false, true] {
        let mut device = Device::new(command, &format!("udp-listen:127.0.0.1:0{secret}"));
        let line = device.first_line();
        let number = line.trim().rsplit(' ').next().unwrap();
        let uri: Uri = format!("udp:127.0.0.1:{number}{secret}").parse().unwrap();
        session(port::open(&uri, EndRole::Harness).unwrap(), bad);
    }
    let samples = folder.path().join("samples.csv");
    let rows: String =
        (1..=50).map(|k| format!("{k},{},1,-2,3,4,-5,6,7,8,0\n", k * 5_000_000)).collect();
    std::fs::write(&samples, rows).unwrap();
    let (_served, uri) = Served::on(&format!("udp:0{secret}"), facts());
    let harness = |line: &str| {
        let mut harness = octant_test_processes::command(&command[0]);
        harness.args(&command[1..]).args(["harness", line]).arg(&samples);
        let ended = harness.output().unwrap();
        (ended.status.code(), String::from_utf8_lossy(&ended.stderr).into_owned())
    };
    let (code, said) = harness(&uri.to_string());
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("50 samples, 0 requests repeated"), "{said}");
}

#[test]
fn they_are_devices_on_a_serial_line() {
    for (_, command) in clients() {
        for bad in [false, true] {
            let pty = Pty::open("").unwrap();
            let at = format!("serial:{}?baud=115200", pty.name());
            let mut device = Device::new(command, &at);
            session(Port::Bytes(Box::new(pty)), bad);
            let mut stderr = device.0.stderr.take().unwrap();
            std::thread::spawn(move || stderr.read_to_string(&mut String::new()));
        }
    }
}
