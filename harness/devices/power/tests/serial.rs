//! A supply on a serial line, behind a pair of pseudo terminals.
#![cfg(unix)]

use octant_base::serial::SerialPort;
use octant_power::ScpiDialogue;
use std::io::{Read, Write};

#[test]
fn the_dialogue_is_the_same_on_a_serial_line() {
    let (mut near, far, name) = SerialPort::pair().unwrap();
    near.set_wait(octant_test_processes::HANGS);
    let instrument = std::thread::spawn(move || {
        let (mut line, mut heard, mut byte) = (String::new(), Vec::new(), [0]);
        while near.read_exact(&mut byte).is_ok() {
            if byte[0] != b'\n' {
                line.push(char::from(byte[0]));
                continue;
            }
            let reply: &[u8] = match line.as_str() {
                "*IDN?" => b"M,S,0,1\r\n",
                "SYST:ERR?" => b"0,\"No error\"\r\n",
                "MEAS:VOLT?" => b"5.00\r\n",
                _ => b"",
            };
            near.write_all(reply).unwrap();
            heard.push(std::mem::take(&mut line));
        }
        heard
    });
    let port = format!("serial:{name}?baud=9600");
    let mut dialogue = ScpiDialogue::open(&port, octant_test_processes::HANGS, true).unwrap();
    drop(far);
    assert_eq!(dialogue.identity(), "M,S,0,1");
    assert_eq!(dialogue.number("MEAS:VOLT?").unwrap(), 5.0);
    dialogue.command("OUTP OFF").unwrap();
    drop(dialogue);
    let heard = instrument.join().unwrap();
    assert!(heard.contains(&"SYST:REM".to_owned()) && heard.contains(&"OUTP OFF".to_owned()));
}
