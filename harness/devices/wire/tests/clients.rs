//! The reference clients in Python and C as peers: of the conformance vectors, of this crate, and of
//! each other, over pipes, UDP and a pair of pseudo terminals.
//!
//! Without `python3` or `cc` their part is skipped, unless `OCTANT_REQUIRE_PEERS` is set.
#![allow(clippy::print_stdout, reason = "what is skipped is said")]

use crate::common::peer::{Echo, Peer, hello, serve};
use octant_sample::{Aiding, DeviceTime, GimbalAngles, Reference, Sample};
use octant_test_processes::{Started, command, start};
use octant_wire::message::*;
use std::io::{BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::OnceLock;
use std::time::Duration;

const FIXTURES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/wire");
const SAMPLES: u64 = 60;

/// A client and its command.
#[derive(Clone)]
struct Client {
    name: &'static str,
    command: Vec<String>,
}

impl Client {
    fn run(&self, arguments: &[&str]) -> Command {
        let mut command = command(&self.command[0]);
        command.args(&self.command[1..]).args(arguments);
        command
    }
}

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

/// Both clients, as far as they are available here.
fn clients() -> &'static [Client] {
    static CLIENTS: OnceLock<Vec<Client>> = OnceLock::new();
    CLIENTS.get_or_init(|| {
        let mut clients = Vec::new();
        if there_is("python3") {
            let script = format!("{FIXTURES}/clients/octant_client.py");
            clients.push(Client { name: "python", command: vec!["python3".into(), script] });
        }
        if there_is("cc") {
            let program = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
                .join(format!("octant_client-{}", std::process::id()));
            let built = command("cc")
                .args(["-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-o"])
                .arg(&program)
                .arg(format!("{FIXTURES}/clients/octant_client.c"))
                .output()
                .unwrap();
            assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
            clients.push(Client { name: "c", command: vec![program.display().to_string()] });
        }
        clients
    })
}

fn samples() -> impl Iterator<Item = (Sample, Option<Aiding>)> {
    (1..=SAMPLES).map(|k| {
        let n = k as i32;
        let device_time = DeviceTime { ns: k * 5_000_000 };
        let sample = Sample {
            sequence: k,
            device_time,
            delta_theta: [n.wrapping_mul(715_827_883), -n, i32::MIN + n],
            delta_velocity: [0, n << 20, i32::MAX - n],
            gimbal: GimbalAngles { azimuth: -n * 7, roll: n * 1_000_003 },
            status: octant_sample::Status::from_bits_retain((k % 16) as u16),
        };
        let x = f64::from(n) * 0.1;
        let reference = match k % 20 {
            0 => Some(Reference::Velocity([x, -0.0, -x])),
            10 => Some(Reference::Position {
                latitude_rad: x,
                longitude_rad: 1e-300,
                height_m: 12.25,
            }),
            _ => None,
        };
        (sample, reference.map(|reference| Aiding { device_time, reference }))
    })
}

/// Writes the samples to a file for the clients.
fn file_of_samples() -> PathBuf {
    let mut text = String::from("# samples of a test\n");
    for (sample, aiding) in samples() {
        let [a, b, c] = sample.delta_theta;
        let [d, e, f] = sample.delta_velocity;
        text += &format!(
            "{},{},{a},{b},{c},{d},{e},{f},{},{},{}",
            sample.sequence,
            sample.device_time.ns,
            sample.gimbal.azimuth,
            sample.gimbal.roll,
            sample.status.bits()
        );
        match aiding.map(|aiding| aiding.reference) {
            None => {}
            Some(Reference::Velocity([x, y, z])) => text += &format!(",0,{x:?},{y:?},{z:?}"),
            Some(Reference::Position { latitude_rad, longitude_rad, height_m }) => {
                text += &format!(",1,{latitude_rad:?},{longitude_rad:?},{height_m:?}");
            }
        }
        text.push('\n');
    }
    static FILE: OnceLock<PathBuf> = OnceLock::new();
    FILE.get_or_init(|| {
        let name = format!("samples-{}.csv", std::process::id());
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::write(&path, &text).unwrap();
        path
    })
    .clone()
}

#[test]
fn the_clients_pass_the_vectors() {
    for client in clients() {
        let output = client.run(&["check", FIXTURES]).output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(
            output.status.success(),
            "{}: {}",
            client.name,
            String::from_utf8_lossy(&output.stderr)
        );
        let checks: u32 = said.split(' ').next().unwrap().parse().unwrap();
        assert!(checks > 1000 && said.trim_end().ends_with(" 0 failed"), "{}: {said}", client.name);
    }
}

#[test]
fn the_clients_notice_vectors_that_are_wrong() {
    // The check must be able to fail.
    for (file, from, to) in [
        ("messages.json", "\"delta_theta_x\": 17000", "\"delta_theta_x\": 17001"),
        ("serial.json", "\"bytes_lost\": 503", "\"bytes_lost\": 504"),
        ("can.json", "\"orphaned\": 2", "\"orphaned\": 3"),
        ("can.json", "\"unfinished\": 1", "\"unfinished\": 0"),
    ] {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
            .join(format!("vectors-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let mut altered = false;
        for name in ["messages.json", "serial.json", "can.json"] {
            let mut text = std::fs::read_to_string(format!("{FIXTURES}/{name}")).unwrap();
            if name == file && text.contains(from) {
                text = text.replacen(from, to, 1);
                altered = true;
            }
            std::fs::write(folder.join(name), text).unwrap();
        }
        assert!(altered, "{from} is in {file}");
        for client in clients() {
            let status = client.run(&["check"]).arg(&folder).output().unwrap().status;
            assert_eq!(status.code(), Some(1), "{} on {file}", client.name);
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}

/// Drives a client as a device, with this crate as the harness.
fn drive(mut peer: Peer, garbage: bool) -> (i32, String) {
    let session = 0xABCD_0001;
    let ours = hello(EndRole::Harness, session);
    let theirs = peer.ask(&[Message::Hello(ours)], |message| match message {
        Message::Hello(hello) if hello.session == session => Some(*hello),
        _ => None,
    });
    agree(&ours, &theirs).unwrap();
    let (mut step, mut echo, mut gathering) =
        (StepNumber::default(), Echo::new(None), Gathering::new());
    let mut request = |peer: &mut Peer, messages: &[Message], expected: &[Message]| {
        let mut found: Vec<Message> = Vec::new();
        peer.ask(messages, |message| {
            // A repeated request is answered twice.
            if !expected.iter().any(|one| one.same_bits(message)) {
                let beside = matches!(
                    message,
                    Message::Hello(_)
                        | Message::Heartbeat(_)
                        | Message::TimeReply(_)
                        | Message::Ready(_)
                        | Message::Status(_)
                        | Message::Output(_)
                        | Message::Parameters(_)
                );
                assert!(beside, "{message:?}, expected {expected:?}");
            } else if !found.iter().any(|one| one.same_bits(message)) {
                found.push(*message);
            }
            (found.len() == expected.len()).then_some(())
        });
        for message in expected {
            if let Message::Parameters(segment) = message
                && let Some(all) = gathering.add(segment)
            {
                assert_eq!(all.sigma[29], -29.0);
            }
        }
    };
    for (sample, aiding) in samples() {
        step = step.next();
        if garbage && step.number() % 3 == 0 {
            peer.write(&[0xA5; 700]);
            peer.write(b"\x01\x02\x00\x05hello\x00");
        }
        let message = SampleMessage { step, aided: aiding.is_some(), sample };
        let aiding = aiding.map(|aiding| AidingMessage { step, aiding });
        let expected = echo.sample(&message, aiding.as_ref());
        let messages: Vec<Message> =
            aiding.map(Message::Aiding).into_iter().chain([Message::Sample(message)]).collect();
        request(&mut peer, &messages, &expected);
        if sample.sequence == SAMPLES / 2 {
            // The request is repeated, but stepped only once: the next step has to follow.
            request(&mut peer, &messages, &expected);
            step = step.next();
            let offset = octant_sample::Parameters::from_array(&[0.5; 30]);
            echo = Echo::new(Some(offset));
            let restart = Restart { step, offset: Some(offset) };
            request(&mut peer, &[Message::Restart(restart)], &[Message::Ready(Ready { step })]);
        }
    }
    let time = TimeRequest { id: 77, harness_sent: ClockTime::from_ns(123) };
    let reply = peer.ask(&[Message::TimeRequest(time)], |message| match message {
        Message::TimeReply(reply) => Some(*reply),
        _ => None,
    });
    assert_eq!((reply.id, reply.harness_sent.ns), (77, 123));
    assert!(reply.received <= reply.sent);
    step = step.next();
    request(&mut peer, &[Message::End(End { step })], &echo.end(step));
    peer.send(&Message::Bye(Bye::default()));
    let counters = *peer.decoder.counters();
    let (status, said) = peer.finish();
    assert!(counters.is_clean(), "{counters:?}");
    (status, said)
}

#[test]
fn the_clients_are_devices_to_this_crate() {
    for client in clients() {
        let (status, said) = drive(Peer::spawn(&mut client.run(&["device", "stdio"])), false);
        assert_eq!(status, 0, "{}: {said}", client.name);
        // No byte was lost on a pipe; one of the clients omits counts of zero.
        assert!(said.contains("bytes_lost 0") || !said.contains("bytes_lost"), "{said}");
        assert!(said.contains("says bye"), "{said}");
        let (status, said) = drive(Peer::spawn(&mut client.run(&["device", "stdio"])), true);
        assert_eq!(status, 0, "{}: {said}", client.name);
    }
}

#[test]
fn the_clients_are_harnesses_to_this_crate() {
    let file = file_of_samples();
    for client in clients() {
        for lost in [None, Some(11)] {
            let outputs = std::env::temp_dir().join(format!(
                "octant-outputs-{}-{}.csv",
                client.name,
                std::process::id()
            ));
            let mut command = client.run(&["harness", "stdio"]);
            command.arg(&file).args(["--verify", "--restart", "30", "--outputs"]).arg(&outputs);
            let mut peer = Peer::spawn(&mut command);
            serve(&mut peer, lost);
            let (status, said) = peer.finish();
            assert_eq!(status, 0, "{}: {said}", client.name);
            // On a busy machine some requests may be repeated although nothing is lost.
            let repeated = !said.contains(" 0 requests repeated");
            assert!(repeated || lost.is_none(), "{}: {said}", client.name);
            let lines = std::fs::read_to_string(&outputs).unwrap().lines().count() as u64;
            // One line of names, and one output of the end.
            assert_eq!(lines, SAMPLES + 2, "{}", client.name);
            std::fs::remove_file(&outputs).unwrap();
        }
    }
}

#[test]
fn the_clients_notice_an_answer_that_is_not_the_echo() {
    // The verification must be able to fail.
    let file = file_of_samples();
    for client in clients() {
        let mut command = client.run(&["harness", "stdio"]);
        command.arg(&file).args(["--verify", "--outputs", "/dev/null"]);
        let mut peer = Peer::spawn(&mut command);
        // This device wasn't restarted, but has an offset that the harness doesn't expect.
        let mut echo = Echo::new(Some(octant_sample::Parameters::from_array(&[1e-9; 30])));
        let (mut done, mut answer, mut aiding) = (StepNumber::default(), Vec::new(), None);
        while let Some(message) = peer.receive(octant_test_processes::HANGS) {
            let request = match message {
                Message::Bye(_) => break,
                Message::Hello(theirs) => {
                    peer.send(&Message::Hello(hello(EndRole::Device, theirs.session)));
                    continue;
                }
                Message::Aiding(message) => {
                    aiding = Some(message);
                    continue;
                }
                Message::Sample(sample) => sample.step,
                Message::End(end) => end.step,
                _ => continue,
            };
            if request.since(done) == 1 {
                done = request;
                answer = match &message {
                    Message::Sample(sample) => {
                        echo.sample(sample, aiding.as_ref().filter(|_| sample.aided))
                    }
                    _ => echo.end(request),
                };
            }
            for message in &answer {
                peer.send(message);
            }
        }
        let (status, said) = peer.finish();
        assert_eq!(status, 1, "{}: {said}", client.name);
    }
}

#[test]
fn the_clients_refuse_a_newer_device_in_plain_words() {
    let file = file_of_samples();
    for client in clients() {
        let mut command = client.run(&["harness", "stdio"]);
        command.arg(&file).args(["--outputs", "/dev/null"]);
        let mut peer = Peer::spawn(&mut command);
        let session = peer.ask(&[], |message| match message {
            Message::Hello(theirs) => Some(theirs.session),
            _ => None,
        });
        let newer = Hello { version: 2, ..hello(EndRole::Device, session) };
        let reason = peer.ask(&[Message::Hello(newer)], |message| match message {
            Message::Bye(bye) => Some(bye.reason),
            _ => None,
        });
        assert_eq!(reason, Reason::VERSION);
        let (status, said) = peer.finish();
        assert_eq!(status, 4, "{}: {said}", client.name);
        assert!(said.contains("update this program"), "{}: {said}", client.name);
    }
}

#[test]
fn the_clients_refuse_a_newer_harness() {
    for client in clients() {
        let mut peer = Peer::spawn(&mut client.run(&["device", "stdio"]));
        let newer = Hello { version: 2, ..hello(EndRole::Harness, 7) };
        let bye = peer.ask(&[Message::Hello(newer)], |message| match message {
            Message::Bye(bye) => Some(*bye),
            _ => None,
        });
        assert_eq!(bye.reason, Reason::VERSION);
        assert_eq!(bye.text.as_str(), "version 1 is spoken here");
        // A harness of this version is still served.
        let session =
            peer.ask(&[Message::Hello(hello(EndRole::Harness, 8))], |message| match message {
                Message::Hello(theirs) => Some(theirs.session),
                _ => None,
            });
        assert_eq!(session, 8);
    }
}

/// Starts a device that listens on UDP; also returns its port.
fn listen(client: &Client, options: &[&str]) -> (Started, String) {
    let mut child = start(
        client.run(&["device", "udp-listen:127.0.0.1:0"]).args(options).stderr(Stdio::piped()),
    );
    let mut line = String::new();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    stderr.read_line(&mut line).unwrap();
    // Later output doesn't matter, but must be read so that the pipe never fills.
    std::thread::spawn(move || stderr.read_to_string(&mut String::new()));
    let port = line.trim().rsplit(' ').next().unwrap().to_owned();
    (child, port)
}

#[test]
fn the_clients_talk_to_each_other_over_udp() {
    let file = file_of_samples();
    for device in clients() {
        // One device behaves, and one loses, doubles and disturbs its answers.
        let bad = ["--drop", "9", "--twice", "3", "--garbage", "4"];
        let options: &[&[&str]] = if device.name == "python" { &[&[], &bad] } else { &[&[]] };
        for options in options {
            for harness in clients() {
                let (_device, port) = listen(device, options);
                let output = harness
                    .run(&["harness", &format!("udp:127.0.0.1:{port}")])
                    .arg(&file)
                    .args(["--verify", "--restart", "30"])
                    .output()
                    .unwrap();
                let said = String::from_utf8_lossy(&output.stderr);
                let who = format!("{} to {} {options:?}", harness.name, device.name);
                assert!(output.status.success(), "{who}: {said}");
                let lines = output.stdout.iter().filter(|byte| **byte == b'\n').count() as u64;
                assert_eq!(lines, SAMPLES + 2, "{who}");
                let repeated = !said.contains(" 0 requests repeated");
                assert!(repeated || options.is_empty(), "{who}: {said}");
            }
        }
    }
}

#[test]
fn a_device_obeys_the_harness_alone_that_said_hello() {
    for client in clients() {
        let (_device, port) = listen(client, &[]);
        let socket = || {
            let socket = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
            socket.connect(format!("127.0.0.1:{port}")).unwrap();
            socket
        };
        let say = |socket: &std::net::UdpSocket, message: &Message| {
            let mut encoder = octant_wire::serial::SerialEncoder::new();
            socket.send(encoder.encode(message, ClockTime::default())).unwrap();
        };
        let heard = |socket: &std::net::UdpSocket, within_ms| {
            socket.set_read_timeout(Some(Duration::from_millis(within_ms))).unwrap();
            let mut bytes = [0; 2000];
            socket.recv(&mut bytes).is_ok()
        };
        let (first, second) = (socket(), socket());
        say(&first, &Message::Hello(hello(EndRole::Harness, 1)));
        assert!(heard(&first, 300_000), "{}", client.name);
        say(&second, &Message::Hello(hello(EndRole::Harness, 2)));
        say(&second, &Message::TimeRequest(TimeRequest::default()));
        assert!(!heard(&second, 300), "{}: a second harness was heard", client.name);
        say(&first, &Message::TimeRequest(TimeRequest::default()));
        assert!(heard(&first, 300_000), "{}: the first one is heard no more", client.name);
    }
}

/// Script of two pseudo terminals, connected to each other.
const TERMINALS: &str = "
import os, pty, select, sys, tty
pairs = [pty.openpty() for _ in range(2)]
for _, end in pairs:
    tty.setraw(end)
print(*(os.ttyname(end) for _, end in pairs), flush=True)
masters = [master for master, _ in pairs]
while True:
    for ready in select.select(masters, [], [])[0]:
        data = os.read(ready, 4096)
        other = masters[1 - masters.index(ready)]
        while data:
            data = data[os.write(other, data):]
";

#[test]
fn the_clients_talk_to_each_other_over_a_serial_line() {
    if !there_is("python3") {
        return;
    }
    let file = file_of_samples();
    for device in clients() {
        for harness in clients() {
            let mut terminals =
                start(command("python3").args(["-c", TERMINALS]).stdout(Stdio::piped()));
            let mut line = String::new();
            BufReader::new(terminals.stdout.take().unwrap()).read_line(&mut line).unwrap();
            let [a, b] =
                <[&str; 2]>::try_from(line.split_whitespace().collect::<Vec<_>>()).unwrap();
            let _device = start(
                device.run(&["device", &format!("serial:{a}?baud=115200")]).stderr(Stdio::null()),
            );
            let output = harness
                .run(&["harness", &format!("serial:{b}?baud=115200")])
                .arg(&file)
                .args(["--verify", "--restart", "30"])
                .output()
                .unwrap();
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{} to {}: {said}", harness.name, device.name);
        }
    }
}
