//! `octant-turntable`: a simulated controller, the guard, and a stop by hand.

use octant_turntable::simulate::listen;
use octant_turntable::{Dialect, Error, TABLE_PORT, run_guard, stop_by_hand};
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

const USAGE: &str = "\
usage: octant-turntable simulate [--tcp HOST:PORT | --pty LINK] [--dialect FILE]
       octant-turntable stop PORT [--dialect FILE]
       octant-turntable guard

simulate  simulates the controller of a table: on a TCP port (default 127.0.0.1:8000), or on a
          pseudo-terminal with the link LINK to it
stop      stops a table
guard     is started by the harness

The dialect is a file with a table of patterns; the default is that of Aerotech's Ensemble.
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match words[..] {
        ["guard"] if run_guard() => return ExitCode::SUCCESS,
        ["guard"] => return ExitCode::FAILURE,
        ["simulate", ref options @ ..] => simulate(options),
        ["stop", port, ref options @ ..] => stop(port, options),
        _ => Err(Failure::Usage),
    };
    let mut stderr = std::io::stderr();
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Usage) => {
            let _ = write!(stderr, "{USAGE}\nPORT is {}.\n", TABLE_PORT.expected());
            ExitCode::from(2)
        }
        Err(Failure::Input(message)) => {
            let _ = writeln!(stderr, "error: {message}");
            ExitCode::from(2)
        }
        Err(Failure::Bench(message)) => {
            let _ = writeln!(stderr, "error: {message}");
            ExitCode::from(4)
        }
    }
}

enum Failure {
    Usage,
    Input(String),
    Bench(String),
}

fn bench(error: Error) -> Failure {
    match error {
        Error::Dialect { .. } | Error::Address(_) => Failure::Input(error.to_string()),
        _ => Failure::Bench(error.to_string()),
    }
}

fn dialect(file: Option<&str>) -> Result<Dialect, Failure> {
    Dialect::load(Path::new(file.unwrap_or(Dialect::BUILT_IN))).map_err(bench)
}

fn simulate(options: &[&str]) -> Result<(), Failure> {
    let (mut place, mut file) = (None, None);
    for pair in options.chunks(2) {
        match *pair {
            ["--tcp", address] if place.is_none() => place = Some(format!("tcp:{address}")),
            ["--pty", link] if place.is_none() => place = Some(format!("pty:{link}")),
            ["--dialect", path] => file = Some(path),
            _ => return Err(Failure::Usage),
        }
    }
    let place = place.unwrap_or_else(|| "tcp:127.0.0.1:8000".to_owned());
    let (server, name) = listen(&place, dialect(file)?).map_err(bench)?;
    let _ = writeln!(std::io::stderr(), "a simulated table listens on {name}");
    server.wait();
    Ok(())
}

fn stop(port: &str, options: &[&str]) -> Result<(), Failure> {
    let file = match *options {
        [] => None,
        ["--dialect", path] => Some(path),
        _ => return Err(Failure::Usage),
    };
    for who in stop_by_hand(port, &dialect(file)?).map_err(bench)? {
        let _ = writeln!(std::io::stderr(), "stop sent through {who}");
    }
    Ok(())
}
