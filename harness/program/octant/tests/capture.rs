//! `octant capture`: what comes is in the file, whatever ends it.

use crate::common::program::program;
use octant_test_processes::{Started, start};
use std::io::{BufRead, BufReader, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Longer than any host needs: ends a test that hangs.
const LONG: Duration = octant_test_processes::HANGS;

/// A capture, and the address at which it listens.
fn capture(folder: &Path, more: &[&str]) -> (Started, SocketAddr) {
    let arguments = [&["capture", "udp:127.0.0.1:0", "--out", "unit.bin"][..], more].concat();
    let mut child = start(
        program(&arguments).current_dir(folder).stdout(Stdio::piped()).stderr(Stdio::piped()),
    );
    let mut said = String::new();
    let stderr = child.stderr.as_mut().unwrap();
    BufReader::with_capacity(1, stderr).read_line(&mut said).unwrap();
    let address = said.trim().rsplit("udp:").next().unwrap().parse().expect(&said);
    (child, address)
}

/// A server that sends numbers to who connects, and closes the connection then.
fn serve(server: TcpListener, count: u64) -> std::thread::JoinHandle<()> {
    std::thread::spawn(move || send_numbers(server.accept().unwrap().0, count))
}

fn send_numbers(mut connection: TcpStream, count: u64) {
    for k in 0..count {
        connection.write_all(&k.to_le_bytes()).unwrap();
    }
}

#[test]
fn an_instrument_on_tcp_is_connected_to_or_listened_for() {
    let folder = tempfile::tempdir().unwrap();
    let server = TcpListener::bind("127.0.0.1:0").unwrap();
    let uri = format!("tcp:{}", server.local_addr().unwrap());
    let served = serve(server, 500);
    let arguments = ["capture", &uri, "--out", "served.bin"];
    let ended = program(&arguments).current_dir(folder.path()).output().unwrap();
    served.join().unwrap();
    let said = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(4), "{said}");
    assert!(said.contains(&format!("octant: connected to {uri}")), "{said}");
    assert!(said.contains("the other end closed the connection; 4000 bytes are kept in"), "{said}");
    assert_eq!(counts(&folder.path().join("served.bin")), 500);
    // Nobody is there any more.
    let arguments = ["capture", &uri, "--out", "nobody.bin"];
    let ended = program(&arguments).current_dir(folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&ended.stderr);
    assert!(said.contains(&format!("failed to open {uri}: ")), "{said}");
    // An instrument that connects itself.
    let arguments =
        ["capture", "tcp:127.0.0.1:0?listen=1", "--out", "listened.bin", "--silence", "1 s"];
    let mut child = start(
        program(&arguments)
            .current_dir(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped()),
    );
    let mut said = String::new();
    let stderr = child.stderr.as_mut().unwrap();
    BufReader::with_capacity(1, stderr).read_line(&mut said).unwrap();
    let address: SocketAddr = said.trim().rsplit("tcp:").next().unwrap().parse().expect(&said);
    assert!(said.contains("listening on"), "{said}");
    send_numbers(TcpStream::connect(address).unwrap(), 300);
    assert_eq!(child.output().status.code(), Some(4));
    assert_eq!(counts(&folder.path().join("listened.bin")), 300);
}

/// A time of arrival stands before each sentence that begins a line, in whatever pieces it comes, and not before one that
/// has a block of its own.
#[test]
fn arrivals_stand_before_sentences() {
    let folder = tempfile::tempdir().unwrap();
    let server = TcpListener::bind("127.0.0.1:0").unwrap();
    let uri = format!("tcp:{}", server.local_addr().unwrap());
    let pieces = ["$HEHDT,12", "3.4,T*2B\r\n$HEROT,0.0,A*2B\r\n\\s:HE0001*46\\$HEHDT", ",1,T*1\n"];
    let served = std::thread::spawn(move || {
        let mut connection = server.accept().unwrap().0;
        for piece in pieces {
            connection.write_all(piece.as_bytes()).unwrap();
            std::thread::sleep(Duration::from_millis(50));
        }
    });
    let now_ms = || {
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap();
        u64::try_from(now.as_millis()).unwrap()
    };
    let begun_ms = now_ms();
    let arguments = ["capture", &uri, "--stamp", "--out", "ship.nmea"];
    let ended = program(&arguments).current_dir(folder.path()).output().unwrap();
    let ended_ms = now_ms();
    served.join().unwrap();
    assert_eq!(ended.status.code(), Some(4), "the other end closed the connection");
    let kept = std::fs::read_to_string(folder.path().join("ship.nmea")).unwrap();
    let lines: Vec<&str> = kept.lines().collect();
    for (line, sentence) in lines.iter().zip(["$HEHDT,123.4,T*2B", "$HEROT,0.0,A*2B"]) {
        let (block, found) = line.strip_prefix('\\').unwrap().split_once('\\').unwrap();
        assert_eq!(found, sentence);
        let (parameter, sum) = block.split_once('*').unwrap();
        let expected = parameter.bytes().fold(0, |sum, byte| sum ^ byte);
        assert_eq!(sum, format!("{expected:02X}"), "the checksum of the block");
        let stamp_ms: u64 = parameter.strip_prefix("c:").unwrap().parse().unwrap();
        assert!((begun_ms..=ended_ms).contains(&stamp_ms), "{stamp_ms}");
    }
    assert_eq!(lines[2..], ["\\s:HE0001*46\\$HEHDT,1,T*1"]);
}

/// Sends datagrams until the file has grown to a size.
fn send(to: SocketAddr, file: &Path, size: u64) {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let begun = Instant::now();
    let mut k = 0_u64;
    while std::fs::metadata(file).map_or(0, |file| file.len()) < size {
        // The receiver may be gone, where a duration ends it.
        let _ = socket.send_to(&k.to_le_bytes(), to);
        k += 1;
        std::thread::sleep(Duration::from_millis(5));
        assert!(begun.elapsed() < LONG);
    }
}

/// Checks that a file has the numbers in their order, without a gap.
fn counts(file: &Path) -> u64 {
    let bytes = std::fs::read(file).unwrap();
    for (k, number) in bytes.as_chunks::<8>().0.iter().enumerate() {
        assert_eq!(u64::from_le_bytes(*number), k as u64);
    }
    assert_eq!(bytes.len() % 8, 0);
    bytes.len() as u64 / 8
}

#[test]
fn what_comes_is_kept_until_it_is_interrupted() {
    for (more, status) in [(&[][..], 0), (&["--duration", "1 h"], 3)] {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("unit.bin");
        let (child, address) = capture(folder.path(), more);
        send(address, &file, 800);
        let pid = rustix::process::Pid::from_raw(child.id() as i32).unwrap();
        rustix::process::kill_process(pid, rustix::process::Signal::INT).unwrap();
        let ended = child.output();
        assert_eq!(ended.status.code(), Some(status), "{ended:?}");
        let numbers = counts(&file);
        let said = String::from_utf8_lossy(&ended.stdout);
        assert!(said.contains(&format!("unit.bin: {} bytes in", numbers * 8)), "{said}");
    }
}

#[test]
fn a_kill_costs_what_came_last() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("unit.bin");
    let (mut child, address) = capture(folder.path(), &[]);
    send(address, &file, 800);
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(counts(&file) >= 100);
}

#[test]
fn a_duration_and_a_silence_end_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("unit.bin");
    // On a busy host nothing may come in a short time.
    for duration in ["0.2 s", "1 s", "5 s", "30 s"] {
        let (mut child, address) = capture(folder.path(), &["--duration", duration]);
        let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
        for k in 0_u64.. {
            // The receiver may be gone.
            let _ = sender.send_to(&k.to_le_bytes(), address);
            if child.try_wait().unwrap().is_some() {
                break;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        if child.wait().unwrap().code() == Some(0) {
            break;
        }
    }
    assert!(counts(&file) > 0);
    // What is there stays.
    let arguments = ["capture", "udp:127.0.0.1:0", "--out", "unit.bin"];
    let again = program(&arguments).current_dir(folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&again.stderr);
    assert!(again.status.code() == Some(2) && said.contains("expected a new name"), "{said}");
    counts(&file);
    std::fs::remove_file(&file).unwrap();
    let (child, _) = capture(folder.path(), &["--silence", "0.3 s"]);
    let ended = child.output();
    assert_eq!(ended.status.code(), Some(4), "{ended:?}");
    assert!(String::from_utf8_lossy(&ended.stdout).contains("unit.bin: nothing came"));
}

#[test]
fn nonsense_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |arguments: &[&str], expected: &str| {
        let arguments = [&["capture"], arguments, &["--out", "unit.bin"]].concat();
        let ended = program(&arguments).current_dir(folder.path()).output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        assert!(said.contains(expected), "{said}");
        assert!(!folder.path().join("unit.bin").exists());
        ended.status.code()
    };
    assert_eq!(refused(&["udq:5005"], "expected udp?"), Some(2));
    assert_eq!(refused(&["udp:0", "--duration", "0 s"], "expected more"), Some(2));
    assert_eq!(refused(&["udp:0", "--silence", "-1"], "expected 0 to"), Some(2));
    assert_eq!(refused(&["udp:0", "--duration", "NaN"], "expected a time such as"), Some(2));
    assert_eq!(refused(&["udp:0?secret=key"], "expected no secret"), Some(2));
    assert_eq!(refused(&["serial:/dev/nowhere"], "/dev/nowhere"), Some(4));
}
