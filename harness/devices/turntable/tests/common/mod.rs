//! Shared parts of the tests.

use octant_plant::config::TurntableConfig as Config;
pub(crate) use octant_test_processes::wait_for;
use octant_turntable::simulate::{Controller, SimulatedServer};
use octant_turntable::{
    AxisLimits, Dialect, Driver, DriverSettings, TableAxis, TableLimits, TablePort, open,
};
use std::time::Duration;

/// An invented language: another end of line, degrees a minute, one status line without a rate, one
/// stop for both axes.
pub(crate) const INVENTED: &str = r#"
name = "invented"
end = "\r\n"
decimals = 5
angle = "deg"
rate = "deg/min"
acceleration = "deg/s2"
done = "OK"
refused = ["ERR {any}"]

[axes]
azimuth = "INNER"
roll = "OUTER"

[commands]
enable = ["{axis}:ON"]
goto = ["{axis}:ACC {acceleration}", "{axis}:SPD {rate}", "{axis}:MOVE {angle}"]
rate = ["{axis}:ACC {acceleration}", "{axis}:JOG {rate}"]
stop = ["HALT"]
home = ["{axis}:HOME"]

[watchdog]
feed = ["WD {ms}"]

[[status]]
send = "{axis}:ST?"
reply = "ST {angle} {moving} {homed} {enabled} {fault}"
"#;

pub(crate) fn ensemble() -> Dialect {
    Dialect::aerotech_ensemble().unwrap()
}

pub(crate) fn invented() -> Dialect {
    Dialect::parse("invented.toml", INVENTED).unwrap()
}

pub(crate) fn degrees(angle: f64) -> f64 {
    angle.to_radians()
}

pub(crate) fn controller(dialect: Dialect) -> Controller {
    let config = Config {
        rate_radps: degrees(30.0),
        acceleration_radps2: degrees(30.0),
        encoder_sigma_rad: 0.0,
        non_orthogonality_rad: 0.0,
        backlash_rad: 0.0,
        errors: Default::default(),
    };
    Controller::new(dialect, &config, degrees(400.0))
}

pub(crate) fn settings() -> DriverSettings {
    let axis = AxisLimits {
        least_rad: degrees(-185.0),
        most_rad: degrees(365.0),
        rate_radps: degrees(20.0),
        acceleration_radps2: degrees(30.0),
    };
    DriverSettings {
        limits: TableLimits { axes: [axis; 2] },
        // Longer than a busy host takes; tests of a silent controller wait this long.
        reply_within: Duration::from_secs(5),
        watchdog: None,
    }
}

/// Starts a simulated controller on TCP whose time is ten times as fast as real time.
pub(crate) fn tcp(dialect: Dialect) -> (SimulatedServer, String) {
    tcp_at(dialect, 10.0)
}

/// Starts a simulated controller on TCP whose time is `speed` times as fast as real time.
pub(crate) fn tcp_at(dialect: Dialect, speed: f64) -> (SimulatedServer, String) {
    let server = SimulatedServer::tcp(controller(dialect), "127.0.0.1:0", speed).unwrap();
    let name = format!("tcp:{}", server.address().unwrap());
    (server, name)
}

pub(crate) fn drive(
    name: &str,
    dialect: Dialect,
    settings: DriverSettings,
) -> Driver<Box<dyn TablePort>> {
    Driver::new(open(name).unwrap(), name, dialect, settings).unwrap()
}

/// True if the simulated axis really turns.
pub(crate) fn turns(server: &SimulatedServer, axis: TableAxis) -> bool {
    server.with(|controller, now_ns| controller.motion(axis, now_ns).rate_radps != 0.0)
}

/// True if both simulated axes really rest.
pub(crate) fn rests(server: &SimulatedServer) -> bool {
    TableAxis::ALL.iter().all(|axis| !turns(server, *axis))
}

/// True angle of the simulated axis, degrees.
pub(crate) fn angle(server: &SimulatedServer, axis: TableAxis) -> f64 {
    server.with(|controller, now_ns| controller.motion(axis, now_ns).angle_rad.to_degrees())
}
