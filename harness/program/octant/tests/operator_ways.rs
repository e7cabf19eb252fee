//! The terminal and the page of a run as ways to the person at its bench.

use crate::common::attended::{Bench, DOOR, Going, LEVEL, gather, record};
use octant_test_processes::start;
use serde_json::Value;
use std::fs::File;
use std::io::Write;
#[cfg(feature = "dashboard")]
use std::io::{BufRead, BufReader, Read};
use std::process::{Command, Stdio};

/// A run on a terminal of its own: what is typed there, and what it shows.
pub fn on_terminal(command: &mut Command) -> (File, Going) {
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    let ours = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&ours).unwrap();
    unlockpt(&ours).unwrap();
    let name = ptsname(&ours, Vec::new()).unwrap().into_string().unwrap();
    let theirs = || Stdio::from(File::options().read(true).write(true).open(&name).unwrap());
    command.stdin(theirs()).stderr(theirs());
    let child = start(command);
    let ours = File::from(ours);
    (ours.try_clone().unwrap(), Going { said: gather(ours), child })
}

#[test]
fn a_terminal_is_asked_and_answers() {
    let bench = Bench::new(&format!("{DOOR}{LEVEL}"));
    let mut command = bench.with_device(&[]);
    let (mut keys, run) = on_terminal(&mut command);
    run.hears("step door: Is the door shut?", 1);
    keys.write_all(b"perhaps\n").unwrap();
    run.hears("found \"perhaps\", expected yes or no", 1);
    keys.write_all(b"y\n").unwrap();
    run.hears("step level: Read the level.", 1);
    keys.write_all(b"-0.05 mm/m\n").unwrap();
    run.hears("your name?", 1);
    keys.write_all(b"Ada\n").unwrap();
    let (status, words) = run.end();
    assert_eq!(status, Some(0), "{words}");
    assert_eq!(bench.acts("run")[1], record(["answered", "door", "yes", "-", "terminal"]));
    assert_eq!(bench.acts("run")[3], record(["answered", "level", "-0.05", "Ada", "terminal"]));
    let hash = bench.json("run/summary.json")["stream_hash"].clone();
    assert_eq!(hash, Value::String(bench.hash()));
}

#[test]
fn a_terminal_aborts_and_one_whose_input_ends_leaves_the_question_open() {
    let bench = Bench::new(DOOR);
    let mut command = bench.with_device(&[]);
    let (mut keys, run) = on_terminal(command.env("OCTANT_OPERATOR", "Ada"));
    run.hears("step door", 1);
    keys.write_all(b"/abort\n").unwrap();
    assert_eq!(run.end().0, Some(3));
    assert_eq!(bench.acts("run.partial")[1][3..], ["Ada", "terminal"]);

    let bench = Bench::new(DOOR);
    let mut command = bench.with_device(&[]);
    let (mut keys, run) = on_terminal(&mut command);
    run.hears("step door", 1);
    keys.write_all(b"\x04").unwrap();
    run.hears("the terminal's input has ended", 1);
    assert_eq!(bench.answer("door", "yes", "Ada").0, Some(0));
    assert_eq!(run.end().0, Some(0));
}

/// Asks the page; returns the status and the body.
#[cfg(feature = "dashboard")]
fn http(address: &str, request: &str, token: Option<&str>, body: &str) -> (u16, String) {
    let mut stream = std::net::TcpStream::connect(address).unwrap();
    let token = token.map_or(String::new(), |token| format!("X-Octant-Token: {token}\r\n"));
    let length = body.len();
    write!(
        stream,
        "{request} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n{token}Content-Length: {length}\r\n\r\n{body}"
    )
    .unwrap();
    let mut reader = BufReader::new(stream);
    let mut line = String::new();
    reader.read_line(&mut line).unwrap();
    let status = line.split(' ').nth(1).unwrap().parse().unwrap();
    let mut rest = String::new();
    reader.read_to_string(&mut rest).unwrap();
    (status, rest.split_once("\r\n\r\n").unwrap().1.to_owned())
}

#[cfg(feature = "dashboard")]
#[test]
fn a_page_asks_and_takes_answers_with_the_token_of_the_run_alone() {
    let bench = Bench::new(&format!("{DOOR}who = \"required\"\n"));
    let run = Going::start(&mut bench.with_device(&["--page"]));
    let said = run.hears("step door", 1);
    let url = said.lines().find_map(|line| line.split_once("page is at http://")).unwrap().1;
    let (address, token) = url.trim().split_once("/#").unwrap();
    assert_eq!(token.len(), 32);
    let (status, page) = http(address, "GET /", None, "");
    assert!(
        status == 200 && page.contains("<title>Octant: operator</title>") && !page.contains(token)
    );
    let yes = r#"{"do":"answer","id":"door","value":"yes","by":"Ada"}"#;
    let wrong = "0".repeat(32);
    for token in [None, Some(""), Some(&token[1..]), Some(wrong.as_str())] {
        assert_eq!(http(address, "GET /state", token, "").0, 403);
        assert_eq!(http(address, "POST /do", token, yes).0, 403);
    }
    let (status, state) = http(address, "GET /state", Some(token), "");
    let state: Value = serde_json::from_str(&state).unwrap();
    assert_eq!((status, &state["questions"][0]["ask"]), (200, &Value::from("Is the door shut?")));
    assert_eq!(state["questions"][0]["buttons"], serde_json::json!(["yes", "no"]));
    for (body, words) in [
        ("{", "can't be read"),
        (r#"{"do":"answer","id":"door","value":"yes","by":"","more":1}"#, "can't be read"),
        (r#"{"do":"answer","id":"door","value":"yes","by":" "}"#, "expected a name"),
        (r#"{"do":"answer","id":"window","value":"yes","by":"Ada"}"#, "no step"),
    ] {
        let (status, told) = http(address, "POST /do", Some(token), body);
        assert!(status == 409 && told.contains(words), "{told}");
    }
    assert_eq!(http(address, "GET /else", Some(token), "").0, 404);
    // Without the token nobody takes the run's memory or time.
    let raw = |text: &str| {
        let mut stream = std::net::TcpStream::connect(address).unwrap();
        stream.write_all(text.as_bytes()).unwrap();
        stream
    };
    let silent = ["", "GET /", "POST /do HTTP/1.1\r\nContent-Length: 9\r\n\r\n"].map(raw);
    for (text, status) in [
        ("POST /do HTTP/1.1\r\nContent-Length: 9000000000000000000\r\n\r\n", "413"),
        ("POST /do HTTP/1.1\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\n", "400"),
        ("POST /do HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n", "411"),
        ("nonsense\r\n\r\n", "400"),
    ] {
        let mut told = String::new();
        raw(text).read_to_string(&mut told).unwrap();
        assert!(told.starts_with(&format!("HTTP/1.1 {status} ")), "{text}: {told}");
    }
    assert_eq!(http(address, "POST /do", Some(token), yes).0, 200);
    let (status, words) = run.end();
    assert_eq!(status, Some(0), "{words}");
    assert_eq!(bench.acts("run")[1], record(["answered", "door", "yes", "Ada", "page"]));
    assert!(std::net::TcpStream::connect(address).is_err(), "the page outlasts its run");
    drop(silent);
}
