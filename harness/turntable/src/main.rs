//! `octant-turntable`: a simulated controller, the guard, and a stop by hand.

use octant_plant::config::Turntable as Config;
use octant_turntable::simulate::{Controller, Server};
use octant_turntable::{Dialect, open, run_guard, stop_line};
use std::io::Write;
use std::process::ExitCode;

const USAGE: &str = "\
usage: octant-turntable simulate [--tcp HOST:PORT | --pty LINK] [--dialect FILE]
       octant-turntable stop PORT [--dialect FILE]
       octant-turntable guard

simulate  plays the controller of a table: on a TCP port (default 127.0.0.1:8000), or on a
          pseudo-terminal that LINK points to
stop      stops a table: PORT is tcp:HOST:PORT or serial:DEVICE?baud=RATE
guard     is started by the harness

The dialect is a table of patterns; without one it is that of Aerotech's Ensemble.
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match words[..] {
        ["guard"] => return run_guard(),
        ["simulate", ref options @ ..] => simulate(options),
        ["stop", port, ref options @ ..] => stop(port, options),
        _ => Err(Failure::Usage),
    };
    let mut stderr = std::io::stderr();
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Usage) => {
            let _ = stderr.write_all(USAGE.as_bytes());
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

fn bench(error: impl ToString) -> Failure {
    Failure::Bench(error.to_string())
}

fn dialect(file: Option<&str>) -> Result<Dialect, Failure> {
    let Some(file) = file else { return Dialect::aerotech_ensemble().map_err(bench) };
    let text = std::fs::read_to_string(file)
        .map_err(|error| Failure::Input(format!("read {file}: {error}")))?;
    Dialect::parse(file, &text).map_err(|error| Failure::Input(error.to_string()))
}

fn simulate(options: &[&str]) -> Result<(), Failure> {
    let (mut tcp, mut pty, mut file) = (None, None, None);
    for pair in options.chunks(2) {
        match *pair {
            ["--tcp", address] => tcp = Some(address),
            ["--pty", link] => pty = Some(link),
            ["--dialect", path] => file = Some(path),
            _ => return Err(Failure::Usage),
        }
    }
    let degrees = f64::to_radians;
    // The table of the default scenario, and end switches at two turns.
    let config = Config {
        rate_radps: degrees(10.0),
        acceleration_radps2: degrees(10.0),
        encoder_sigma_rad: 0.0,
        non_orthogonality_rad: 0.0,
        backlash_rad: 0.0,
    };
    let controller = Controller::new(dialect(file)?, &config, degrees(720.0));
    let mut stderr = std::io::stderr();
    let server = match (tcp, pty) {
        (Some(_), Some(_)) => return Err(Failure::Usage),
        (_, Some(link)) => on_pty(controller, link)?,
        (address, None) => {
            let server = Server::tcp(controller, address.unwrap_or("127.0.0.1:8000"), 1.0);
            let server = server.map_err(bench)?;
            if let Some(address) = server.address() {
                let _ = writeln!(stderr, "a table listens on tcp:{address}");
            }
            server
        }
    };
    server.wait();
    Ok(())
}

#[cfg(unix)]
fn on_pty(controller: Controller, link: &str) -> Result<Server, Failure> {
    use serialport::SerialPort;
    let (master, slave) = serialport::TTYPort::pair().map_err(bench)?;
    let name = slave.name().ok_or_else(|| bench("the pseudo-terminal has no name"))?;
    let _ = std::fs::remove_file(link);
    std::os::unix::fs::symlink(&name, link)
        .map_err(|error| Failure::Input(format!("link {link} to {name}: {error}")))?;
    let _ = writeln!(std::io::stderr(), "a table listens on serial:{link}");
    Server::line(controller, master, 1.0).map_err(bench)
}

#[cfg(not(unix))]
fn on_pty(_: Controller, _: &str) -> Result<Server, Failure> {
    Err(Failure::Input("there are no pseudo-terminals here: use --tcp".into()))
}

fn stop(port: &str, options: &[&str]) -> Result<(), Failure> {
    let file = match *options {
        [] => None,
        ["--dialect", path] => Some(path),
        _ => return Err(Failure::Usage),
    };
    let line = open(port).map_err(bench)?;
    stop_line(line, port, &dialect(file)?).map_err(bench)
}
