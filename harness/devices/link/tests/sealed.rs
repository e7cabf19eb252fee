//! Sessions over UDP with a shared secret, and what strangers get from them.

use crate::common::{LONG, Served, drive, facts, harness, options, sample};
use octant_link::harness::{Harness, Patience, SessionError, SessionOptions};
use octant_link::{Uri, Wire};
use octant_sample::Output;
use octant_wire::EndRole;
use octant_wire::message::Reason;
use std::net::{SocketAddr, UdpSocket};
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

fn secret(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600)).unwrap();
    }
    path.display().to_string()
}

fn at(address: SocketAddr, secret: Option<&str>) -> Uri {
    let secret = secret.map(|file| format!("?secret={file}")).unwrap_or_default();
    format!("udp:{address}{secret}").parse().unwrap()
}

fn address(uri: &Uri) -> SocketAddr {
    let Uri::Udp(udp) = uri else { panic!("{uri}") };
    udp.address.to_string().parse().unwrap()
}

/// Checks that a harness at an address gets no session, and why.
#[track_caller]
fn refused(uri: &Uri, why: &str) {
    let patience = Patience { hello: Duration::from_millis(800), ..options().patience };
    let begun = Instant::now();
    loop {
        let wire = Wire::open(uri, EndRole::Harness).unwrap();
        let opened = Harness::open(wire, SessionOptions { patience, ..options() });
        let said = opened.unwrap_err().to_string();
        if said.contains(why) {
            return;
        }
        // On a busy host nothing at all may come in this time.
        assert!(said.contains("nothing at all was received") && begun.elapsed() < LONG, "{said}");
    }
}

/// A socket between harness and device, which keeps what it passes on, twice and in a changed copy.
struct Between {
    at: SocketAddr,
    device: Arc<Mutex<SocketAddr>>,
    heard: Arc<Mutex<Vec<Vec<u8>>>>,
}

impl Between {
    fn new(device: SocketAddr) -> Self {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        let at = socket.local_addr().unwrap();
        let heard = Arc::new(Mutex::new(Vec::new()));
        let kept = Arc::clone(&heard);
        let device = Arc::new(Mutex::new(device));
        let behind = Arc::clone(&device);
        // It ends with the test program.
        std::thread::spawn(move || {
            let (mut harness, mut bytes) = (None, [0; 4096]);
            while let Ok((count, from)) = socket.recv_from(&mut bytes) {
                let device = *behind.lock().unwrap();
                if from != device {
                    harness = Some(from);
                    kept.lock().unwrap().push(bytes[..count].to_vec());
                }
                let Some(to) = (if from == device { harness } else { Some(device) }) else {
                    continue;
                };
                let mut changed = bytes[..count].to_vec();
                changed[count / 2] ^= 4;
                for datagram in [&bytes[..count], &bytes[..count], &changed] {
                    let _ = socket.send_to(datagram, to);
                }
            }
        });
        Self { at, device, heard }
    }
}

#[test]
fn both_ends_with_the_secret_have_a_session() {
    let folder = tempfile::tempdir().unwrap();
    let file = secret(folder.path(), "key", "a secret of the bench\n");
    let (served, uri) = Served::on(&format!("udp:0?secret={file}"), facts());
    assert!(uri.to_string().ends_with(&format!("?secret={file}")), "{uri}");
    for _ in 0..2 {
        // Each harness has an address and nonces of its own.
        let mut harness = harness(&uri);
        drive(&mut harness, 100);
        harness.bye(Reason::DONE, "");
    }
    assert!(!served.said().iter().any(|said| said.contains("secret came")));
}

#[test]
fn a_changed_and_a_repeated_datagram_do_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let file = secret(folder.path(), "key", "a secret of the bench");
    let (served, uri) = Served::on(&format!("udp:0?secret={file}"), facts());
    let device = address(&uri);
    let between = Between::new(device);
    let mut session = harness(&at(between.at, Some(&file)));
    drive(&mut session, 100);
    let counts = session.wire().counts();
    assert_eq!((counts.damaged, counts.lost, counts.out_of_order), (0, 0, 0));
    session.bye(Reason::DONE, "");
    // What was heard opens nothing, from the same address or another one. The next harness meets a device without a session.
    let stranger = UdpSocket::bind("127.0.0.1:0").unwrap();
    stranger.set_read_timeout(Some(Duration::from_millis(5))).unwrap();
    let mut answer = [0; 4096];
    for datagram in between.heard.lock().unwrap().iter() {
        stranger.send_to(datagram, device).unwrap();
        if let Ok((count, _)) = stranger.recv_from(&mut answer) {
            assert!(count == 32 && count <= datagram.len(), "{count}");
        }
    }
    let mut session = harness(&at(device, Some(&file)));
    drive(&mut session, 20);
    session.bye(Reason::DONE, "");
    drop(session);
    let began = |said: &&String| said.contains("a session in lock-step began");
    assert_eq!(served.said().iter().filter(began).count(), 2);
}

#[test]
fn who_has_no_secret_or_another_one_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let file = secret(folder.path(), "key", "a secret of the bench");
    let other = secret(folder.path(), "other", "the secret of a harness");
    let (served, uri) = Served::on(&format!("udp:0?secret={file}"), facts());
    let device = address(&uri);
    refused(&at(device, Some(&other)), "without the seal of the secret were dropped");
    refused(&at(device, None), "no message was received, but");
    let begun = Instant::now();
    let mut told = String::new();
    while !told.contains("do both ends have the same one?") && begun.elapsed() < LONG {
        told += &served.said().join("\n");
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(told.contains("without the seal of the secret came"), "{told}");
    assert!(!told.contains("began"), "{told}");
    // It serves who has it.
    let mut session = harness(&uri);
    drive(&mut session, 20);
    session.bye(Reason::DONE, "");
    // A device without a secret, and a harness that wants one.
    let (_open, uri) = Served::on("udp:0", facts());
    refused(&at(address(&uri), Some(&file)), "without the seal of the secret were dropped");
}

#[test]
fn a_device_that_starts_anew_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let file = secret(folder.path(), "key", "a secret of the bench");
    let on = format!("udp:0?secret={file}");
    let ((_gone, first), (_new, second)) = (Served::on(&on, facts()), Served::on(&on, facts()));
    let between = Between::new(address(&first));
    let mut session = harness(&at(between.at, Some(&file)));
    let mut output = Output::default();
    let (first, aiding) = sample(1);
    session.step(&first, aiding.as_ref(), &mut output).unwrap();
    // Another device at the same address is one that knows nothing any more.
    *between.device.lock().unwrap() = address(&second);
    let (next, aiding) = sample(2);
    let error = session.step(&next, aiding.as_ref(), &mut output).unwrap_err();
    assert!(matches!(error, SessionError::StartedAnew { .. }), "{error}");
}

#[test]
fn a_secret_that_is_none_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let short = secret(folder.path(), "short", "fifteen bytes..\n");
    let nowhere = folder.path().join("nowhere").display().to_string();
    let mut cases =
        vec![(short, "has 15 bytes, expected 16 or more"), (nowhere, "read the secret in")];
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let open = secret(folder.path(), "open", "a secret that all can read");
        std::fs::set_permissions(&open, std::fs::Permissions::from_mode(0o644)).unwrap();
        cases.push((open, "found mode 644, expected 600"));
    }
    for (file, expected) in &cases {
        for role in [EndRole::Harness, EndRole::Device] {
            let uri: Uri = format!("udp:127.0.0.1:9?secret={file}").parse().unwrap();
            let said = Wire::open(&uri, role).unwrap_err().to_string();
            assert!(said.contains(expected), "{said}");
        }
    }
}
