//! The dialogue: commands, queries, the error queue, and instruments that answer nonsense.

use octant_power::simulate::{Peculiarities, SimulatedInstrument};
use octant_power::{PowerError, ScpiDialogue, check_power_port};
use proptest::prelude::*;
use std::io::{BufRead, BufReader, Write};
use std::net::TcpListener;
use std::time::Duration;

const REPLY: Duration = octant_test_processes::HANGS;
const SHORT: Duration = Duration::from_secs(3);

/// An instrument that answers each query with the next of these lines, and hangs up after them.
fn that_says(replies: &'static [&'static str]) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = format!("tcp:{}", listener.local_addr().unwrap());
    std::thread::spawn(move || {
        let (stream, _) = listener.accept().unwrap();
        let mut replies = replies.iter();
        for line in BufReader::new(&stream).lines() {
            let Ok(line) = line else { return };
            if line.contains('?') {
                let Some(reply) = replies.next() else { return };
                let _ = (&stream).write_all(reply.as_bytes());
            }
        }
    });
    port
}

#[test]
fn the_error_queue_is_read_after_each_line_and_names_the_command() {
    let instrument = SimulatedInstrument::start(Peculiarities::default()).unwrap();
    let mut dialogue = ScpiDialogue::open(&instrument.port(), REPLY, false).unwrap();
    assert_eq!(dialogue.identity(), "Octant,simulated supply,0,1.0");
    let error = dialogue.command("VOLT 61").unwrap_err().to_string();
    assert!(error.contains("refuses `VOLT 61` with -222,\"Data out of range\""), "{error}");
    // The queue is empty again.
    dialogue.command("VOLT 12").unwrap();
    assert_eq!(dialogue.number("VOLT?").unwrap(), 12.0);
    let heard = instrument.heard();
    let errors = heard.iter().filter(|line| *line == "SYST:ERR?").count();
    assert_eq!(heard[..2], ["*CLS", "*IDN?"]);
    // One for each of four lines, and one more behind the error.
    assert_eq!(errors, 5, "{heard:?}");
}

#[test]
fn errors_of_earlier_programs_are_cleared_and_remote_control_is_taken_first() {
    let instrument = SimulatedInstrument::start(Peculiarities::default()).unwrap();
    let mut first = ScpiDialogue::open(&instrument.port(), SHORT, false).unwrap();
    // Leaves an error behind: the queue is read after the first line alone.
    first.query("FOO?").unwrap_err();
    let mut second = ScpiDialogue::open(&instrument.port(), REPLY, true).unwrap();
    second.command("VOLT 5").unwrap();
    assert!(instrument.heard().contains(&"SYST:REM".to_owned()));
}

#[test]
fn a_query_that_is_not_understood_is_told_by_the_queue() {
    let instrument = SimulatedInstrument::start(Peculiarities::default()).unwrap();
    let mut dialogue = ScpiDialogue::open(&instrument.port(), SHORT, false).unwrap();
    let error = dialogue.query("MEAS:FREQ?").unwrap_err().to_string();
    assert!(error.contains("refuses `MEAS:FREQ?` with -113,\"Undefined header\""), "{error}");
}

#[test]
fn an_instrument_that_is_silent_or_gone_is_an_error_of_its_own() {
    let how = Peculiarities { silent: true, ..Peculiarities::default() };
    let instrument = SimulatedInstrument::start(how).unwrap();
    let error = ScpiDialogue::open(&instrument.port(), SHORT, false).unwrap_err();
    assert!(matches!(&error, PowerError::Silent { sent, .. } if sent.contains("*IDN?")), "{error}");
    let error = ScpiDialogue::open(&that_says(&[]), REPLY, false).unwrap_err();
    assert!(matches!(error, PowerError::Gone { .. }), "{error}");
    let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let error = ScpiDialogue::open(&format!("tcp:{free}"), REPLY, false).unwrap_err();
    assert!(matches!(error, PowerError::Open { .. }), "{error}");
}

#[test]
fn replies_that_are_no_numbers_states_or_errors_are_nonsense() {
    let no_error = "0,\"No error\"\n";
    for (reply, expected) in
        [("9.91E37\n", true), ("NaN\n", true), ("inf\n", true), ("\n", true), ("+2.4E1\n", false)]
    {
        let replies = Vec::leak(vec!["x\n", no_error, reply, no_error]);
        let mut dialogue = ScpiDialogue::open(&that_says(replies), REPLY, false).unwrap();
        match dialogue.number("MEAS:VOLT?") {
            Ok(number) => assert!(!expected && number == 24.0, "{reply:?}: {number}"),
            Err(error) => assert!(
                expected && matches!(error, PowerError::Nonsense { .. }),
                "{reply:?}: {error}"
            ),
        }
    }
    let mut dialogue =
        ScpiDialogue::open(&that_says(&["x\n", "0\n", "2\n", "0\n"]), REPLY, false).unwrap();
    let error = dialogue.state("OUTP?").unwrap_err().to_string();
    assert!(error.contains("found the reply `2` to `OUTP?`, expected 1, 0, ON or OFF"), "{error}");
    let error = ScpiDialogue::open(&that_says(&["x\n", "OK\n"]), REPLY, false).unwrap_err();
    assert!(error.to_string().contains("`OK` to `SYST:ERR?`"), "{error}");
}

#[test]
fn an_error_queue_without_an_end_ends() {
    let how = Peculiarities { endless: true, ..Peculiarities::default() };
    let instrument = SimulatedInstrument::start(how).unwrap();
    let error = ScpiDialogue::open(&instrument.port(), REPLY, false).unwrap_err();
    assert!(error.to_string().contains("-350,\"Queue overflow\""), "{error}");
    assert_eq!(instrument.heard().iter().filter(|line| *line == "SYST:ERR?").count(), 32);
}

#[test]
fn a_reply_that_is_too_long_or_cut_short_ends_the_wait() {
    let long: &'static str = Box::leak("1".repeat(10_000).into_boxed_str());
    let replies = Vec::leak(vec![long]);
    let error = ScpiDialogue::open(&that_says(replies), REPLY, false).unwrap_err();
    assert!(error.to_string().contains("without a line feed"), "{error}");
    // Half a reply, and the end of the connection.
    let error = ScpiDialogue::open(&that_says(&["Oct"]), SHORT, false).unwrap_err();
    assert!(matches!(error, PowerError::Silent { .. } | PowerError::Gone { .. }), "{error}");
}

#[test]
fn ports_are_read_and_wrong_ones_are_told() {
    for port in ["tcp:psu", "tcp:10.0.0.7:5025", "tcp:[fe80::1]", "tcp:[fe80::1]:1", "serial:COM3"]
    {
        check_power_port(port).unwrap();
    }
    check_power_port("serial:/dev/ttyUSB0?baud=115200").unwrap();
    for port in [
        "",
        "psu",
        "tcp:",
        "tcp::5025",
        "tcp:psu:",
        "tcp:psu:0",
        "tcp:psu:70000",
        "tcp:[fe80::1",
        "tcp:[]:1",
        "tcp:[fe80::1]x",
        "serial:",
        "udp:psu:5025",
    ] {
        let error = check_power_port(port).unwrap_err().to_string();
        assert!(error.contains("expected tcp:HOST"), "{port}: {error}");
    }
    for (port, expected) in [
        ("tcp:fe80::1", "expected tcp:[fe80::1]:PORT"),
        ("serial:COM3?baud=0", "found baud=0"),
        ("serial:COM3?rate=9600", "found option \"rate\" of serial:"),
    ] {
        let error = check_power_port(port).unwrap_err().to_string();
        assert!(error.contains(expected), "{port}: {error}");
    }
}

proptest! {
    #[test]
    fn any_text_is_read_as_a_port_without_a_panic(text in "(tcp:|serial:|)\\PC*") {
        let _ = check_power_port(&text);
    }
}
