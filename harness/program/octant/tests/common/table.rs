//! A simulated instrument on a simulated table, and a run with both.

use super::program::OCTANT;
use octant_instruments::{AnyEncoder, Protocol, Reading};
use octant_link::port::{Bytes, Pty};
use octant_plant::Plant;
use octant_plant::config::TurntableConfig;
use octant_realtime::host_clocks::HostClocks;
use octant_sample::{GimbalAngles, GimbalCommand, Status};
use octant_scenario::{Method, Scenario};
use octant_source::configure::configurations;
use octant_source::{Replay, Source};
pub use octant_test_processes::wait_for;
use octant_test_processes::{Started, command, start};
use octant_turntable::simulate::{Controller, SimulatedServer};
use octant_turntable::{Dialect, TableAxis};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

const PERIOD_NS: u64 = 5_000_000;

fn moves(rate_deg: f64, acceleration_deg: f64) -> TurntableConfig {
    TurntableConfig {
        rate_radps: rate_deg.to_radians(),
        acceleration_radps2: acceleration_deg.to_radians(),
        encoder_sigma_rad: 0.0,
        non_orthogonality_rad: 0.0,
        backlash_rad: 0.0,
        errors: Default::default(),
    }
}

/// Simulated table, and an instrument on it that sends the plant's measurements at 200 Hz.
pub struct Stage {
    pub server: Arc<SimulatedServer>,
    pub port: String,
    pub instrument: Instrument,
}

impl Stage {
    pub fn new() -> Self {
        Self::with(None)
    }

    /// The same with an instrument that sends each reading 3 ms late, and marks its whole seconds by
    /// pulses in a file of the kernel's form.
    pub fn with_pulses(file: &Path) -> Self {
        std::fs::write(file, "0.000000000#0\n").unwrap();
        Self::with(Some(file.to_owned()))
    }

    fn with(pulses: Option<PathBuf>) -> Self {
        let dialect = Dialect::aerotech_ensemble().unwrap();
        let controller = Controller::new(dialect, &moves(10.0, 10.0), 400f64.to_radians());
        let server = Arc::new(SimulatedServer::tcp(controller, "127.0.0.1:0", 1.0).unwrap());
        let port = format!("tcp:{}", server.address().unwrap());
        let instrument = Instrument::new(Arc::clone(&server), pulses);
        Self { server, port, instrument }
    }

    /// Returns the true angle of the table, degrees.
    pub fn angle(&self, axis: TableAxis) -> f64 {
        self.server.with(|controller, now| controller.motion(axis, now).angle_rad.to_degrees())
    }

    pub fn rests(&self) -> bool {
        let turns = |axis| self.server.with(|c, now| c.motion(axis, now).rate_radps != 0.0);
        !TableAxis::ALL.into_iter().any(turns)
    }

    /// Waits until the table is in the middle of a long move.
    pub fn wait_for_the_way(&self) {
        wait_for("the move", || self.angle(TableAxis::Roll) > 5.0);
    }
}

/// Instrument on a line.
pub struct Instrument {
    pub uri: String,
    silent: Arc<AtomicBool>,
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Instrument {
    pub fn new(table: Arc<SimulatedServer>, pulses: Option<PathBuf>) -> Self {
        let line = Pty::open("").unwrap();
        let uri = format!("serial:{}?baud=921600", line.name());
        let (silent, ends) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
        let flags = (Arc::clone(&silent), Arc::clone(&ends));
        let thread = std::thread::spawn(move || {
            play(line, &table, pulses.as_deref(), &flags.0, &flags.1);
        });
        Self { uri, silent, ends, thread: Some(thread) }
    }

    /// Stops the instrument's messages from now on.
    pub fn fall_silent(&self) {
        self.silent.store(true, Ordering::SeqCst);
    }
}

impl Drop for Instrument {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::SeqCst);
        self.thread.take().unwrap().join().unwrap();
    }
}

/// Runs the plant on the table, by the clock. The plant's own gimbals are fast, so that they follow
/// the table.
fn play(
    mut line: Pty,
    table: &SimulatedServer,
    pulses: Option<&Path>,
    silent: &AtomicBool,
    ends: &AtomicBool,
) {
    let text = "schema = 1\n[procedure.navigation]\nduration = \"1 h\"\nrotation = \"none\"\n";
    let scenario = Scenario::parse(text, "instrument", Path::new(""), &[]).unwrap();
    let (mut config, ..) = configurations(&scenario, Method::Primary, 1).unwrap();
    config.turntable = moves(300.0, 1e4);
    let mut plant = Plant::new(&config).unwrap();
    let mut encoder = AnyEncoder::new(Protocol::Octant);
    let (started, start_ns) = table.with(|_, now_ns| (Instant::now(), now_ns));
    let (mut sample, mut aiding) = Default::default();
    let mut is_read = false;
    for number in 1.. {
        let due = started + Duration::from_nanos(number * PERIOD_NS);
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        if ends.load(Ordering::SeqCst) {
            return;
        }
        if let Some(file) = pulses {
            if (number * PERIOD_NS).is_multiple_of(1_000_000_000) {
                mark(file, due, number * PERIOD_NS / 1_000_000_000);
            }
            let late = due + Duration::from_millis(3);
            std::thread::sleep(late.saturating_duration_since(Instant::now()));
        }
        // Angles of the table at the stamp, however late this thread is.
        let stamp_ns = start_ns + number * PERIOD_NS;
        let [azimuth, roll] = TableAxis::ALL
            .map(|axis| table.with(|controller, _| controller.motion(axis, stamp_ns).angle_rad));
        let target = GimbalAngles::from_rad(azimuth, roll);
        plant.step_into(&GimbalCommand { target }, &mut sample, &mut aiding);
        if silent.load(Ordering::SeqCst) {
            continue;
        }
        let reading = Reading::of_sample(&sample);
        let status = reading.status | Status::GIMBAL_INVALID;
        let reading = Reading { gimbal: None, status, ..reading };
        // While there is no reader the line is full: data without room is lost, as on a real one. A reader that a busy
        // host holds up is waited for; the instrument is late then, and its stamps are right.
        let wait = if is_read { Duration::from_secs(2) } else { Duration::ZERO };
        is_read = line.send(encoder.encode(&reading).unwrap(), wait).unwrap_or(false);
    }
}

/// Writes a pulse as the kernel does, whole at once.
fn mark(file: &Path, due: Instant, sequence: u64) {
    let clocks = HostClocks::read();
    let ns = clocks.other_ns - (clocks.monotonic - due).as_nanos() as i128;
    let next = file.with_extension("next");
    let line = format!("{}.{:09}#{sequence}\n", ns / 1_000_000_000, ns % 1_000_000_000);
    std::fs::write(&next, line).unwrap();
    std::fs::rename(&next, file).unwrap();
}

/// A scenario in a folder.
pub struct Bench {
    folder: tempfile::TempDir,
    scenario: PathBuf,
}

impl Bench {
    /// Makes two stops, the second at a roll of `roll_deg`, with more keys of `[turntable.drive]`.
    pub fn new(stage: &Stage, roll_deg: u32, drive: &str) -> Self {
        Self::under(&stage.instrument, &stage.port, roll_deg, drive)
    }

    /// The same with an instrument and the port of its table.
    pub fn under(instrument: &Instrument, port: &str, roll_deg: u32, drive: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let scenario = folder.path().join("s.toml");
        // 10°/s, a second to get there, and two dwells.
        let duration_s = roll_deg / 10 + 1 + 13;
        // A busy host may stand still for a second or two; a table that is stopped late is so within the move.
        let mut drive = drive.to_owned();
        for (key, value) in [("reply", "5 s"), ("guard", "6 s")] {
            if !drive.contains(key) && !drive.contains("driver = ") {
                drive += &format!("{key} = \"{value}\"\n");
            }
        }
        let text = format!(
            "schema = 1\ntitle = \"table\"\n[procedure.calibration]\nduration = \"{duration_s} s\"\n\
             stops = [{{}}, {{ roll = \"{roll_deg} deg\" }}]\n[record]\nsamples = \"full\"\n\
             [source]\nuri = {:?}\n[source.live]\nsilence = \"5 s\"\n\
             [turntable.drive]\nport = {:?}\nazimuth = [\"-5 deg\", \"5 deg\"]\n\
             roll = [\"-5 deg\", \"{} deg\"]\noldest = \"500 ms\"\n{drive}",
            instrument.uri,
            port,
            roll_deg + 5,
        );
        std::fs::write(&scenario, text).unwrap();
        Self { folder, scenario }
    }

    /// Appends to the scenario.
    pub fn add(&self, text: &str) {
        let before = std::fs::read_to_string(&self.scenario).unwrap();
        std::fs::write(&self.scenario, before + text).unwrap();
    }

    pub fn scenario(&self) -> Scenario {
        Scenario::load(&self.scenario, &[]).unwrap_or_else(|error| panic!("{error}"))
    }

    pub fn run(&self, more: &[&str]) -> Running {
        let child = start(
            command(OCTANT)
                .args(["run", "--out"])
                .arg(self.folder.path().join("out"))
                .args(more)
                .arg(&self.scenario)
                .stdout(Stdio::null())
                .stderr(Stdio::piped()),
        );
        Running(child)
    }

    /// Returns the folder of the run, finished or not.
    pub fn out(&self) -> PathBuf {
        let done = self.folder.path().join("out");
        if done.is_dir() { done } else { self.folder.path().join("out.partial") }
    }

    pub fn json(&self, name: &str) -> Value {
        serde_json::from_str(&std::fs::read_to_string(self.out().join(name)).unwrap()).unwrap()
    }
}

/// Running `octant run`.
pub struct Running(Started);

impl Running {
    pub fn signal(&self, signal: &str) {
        let pid = self.0.id().to_string();
        assert!(command("kill").args([signal, &pid]).status().unwrap().success());
    }

    /// Waits for the end; returns the exit status and stderr.
    pub fn wait(self) -> (Option<i32>, String) {
        let output = self.0.output();
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    }
}

/// Roll in the samples of a run, and roll that its gyros felt.
pub struct Felt {
    pub samples: u32,
    /// Samples without angles.
    pub without: u32,
    /// Turn of the gyros, rad.
    pub felt_rad: f64,
    /// Largest difference of both, deg.
    pub worst_deg: f64,
}

impl Felt {
    /// Reads the recording of a run.
    pub fn of(bench: &Bench) -> Self {
        let mut recording = Replay::open(&bench.out().join("recording.mcap"), None).unwrap();
        let mut felt = Self { samples: 0, without: 0, felt_rad: 0.0, worst_deg: 0.0 };
        let mut epoch = octant_source::Epoch::default();
        while recording.next(&GimbalCommand::default(), &mut epoch).unwrap() {
            felt.samples += 1;
            felt.felt_rad += f64::from(epoch.sample.delta_theta[0]) * 2f64.powi(-36);
            if epoch.sample.status.contains(Status::GIMBAL_INVALID) {
                felt.without += 1;
                continue;
            }
            let off_rad = epoch.sample.gimbal.roll_rad() - felt.felt_rad;
            felt.worst_deg = felt.worst_deg.max(off_rad.abs().to_degrees());
        }
        felt
    }
}
