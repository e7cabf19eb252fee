//! Shared parts: an echoing core as in the `README.md` of the wire, samples, and a device on a thread.
#![cfg_attr(not(unix), allow(dead_code, reason = "most sessions are tested on Unix alone"))]

use octant_link::device::{Device, Facts, Notice, Steps};
use octant_link::harness::{Harness, Patience, SessionOptions};
use octant_link::{Uri, Wire, port};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{
    Aiding, DeviceTime, GimbalAngles, GimbalCommand, Health, Mode, Navigation, Output, Parameters,
    Reference, Sample,
};
use octant_wire::EndRole;
use octant_wire::Text;
use octant_wire::message::{Capabilities, EndLimits};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::thread::JoinHandle;
use std::time::Duration;

pub(crate) const PERIOD_NS: u64 = 5_000_000;

/// A core that answers with its input.
#[derive(Clone, Debug, Default)]
pub(crate) struct Echo {
    revision: u32,
    offset: [f64; PARAMETER_COUNT],
    last: Output,
    pub(crate) steps: u64,
}

impl Steps for Echo {
    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), String> {
        let offset = offset.map_or([0.0; PARAMETER_COUNT], Parameters::to_array);
        *self = Self { offset, ..Self::default() };
        Ok(())
    }

    fn step(&mut self, sample: &Sample, aiding: Option<&Aiding>, output: &mut Output) {
        self.steps += 1;
        self.revision += u32::from(aiding.is_some());
        let [x, y, z] = match aiding.map(|aiding| aiding.reference) {
            None => [0.0; 3],
            Some(Reference::Velocity(velocity)) => velocity,
            Some(Reference::Position { latitude_rad, longitude_rad, height_m }) => {
                [latitude_rad, longitude_rad, height_m]
            }
        };
        let theta = sample.delta_theta.map(|count| f64::from(count) * DELTA_THETA_LSB_RAD);
        *output = Output {
            sequence: sample.sequence,
            device_time: sample.device_time,
            mode: Mode::Aligning,
            stop: 0,
            moving: false,
            gimbal_command: GimbalCommand { target: sample.gimbal },
            navigation: Navigation {
                latitude_rad: theta[0],
                longitude_rad: theta[1],
                height_m: theta[2],
                velocity_mps: sample
                    .delta_velocity
                    .map(|count| f64::from(count) * DELTA_VELOCITY_LSB_MPS),
                q_nb: [f64::from(u8::from(aiding.is_some())), x, y, z],
            },
            health: Health::from_bits_retain(sample.status.bits().into()),
            nis: f64::NAN,
            parameters_revision: self.revision,
        };
        self.last = *output;
    }

    fn end(&mut self) -> Output {
        Output { mode: Mode::Done, ..self.last }
    }

    fn parameters(&self) -> (Parameters, [f64; PARAMETER_COUNT]) {
        let value = |i: usize| f64::from(self.revision) + i as f64 + self.offset[i];
        (Parameters::from_array(&std::array::from_fn(value)), std::array::from_fn(|i| -(i as f64)))
    }
}

pub(crate) fn facts() -> Facts {
    Facts {
        name: Text::fitting("echo"),
        firmware: Text::fitting("echo 1"),
        capabilities: Capabilities::all(),
        sample_period_ns: PERIOD_NS,
        configuration: [0; 32],
        // On a busy host, the line may be silent for long.
        limits: EndLimits { window: 16, silence_ms: 60_000, shortest_period_ns: 0 },
    }
}

/// Longer than any host needs: ends a test that hangs.
pub(crate) const LONG: Duration = octant_test_processes::HANGS;

pub(crate) fn options() -> SessionOptions {
    SessionOptions {
        patience: Patience { hello: LONG, answer: LONG, repeat: Duration::from_millis(50) },
        ..SessionOptions::lock_step(PERIOD_NS)
    }
}

/// Sample with a number, and aiding for every tenth.
pub(crate) fn sample(k: u64) -> (Sample, Option<Aiding>) {
    let n = k as i32;
    let device_time = DeviceTime { ns: k * PERIOD_NS };
    let sample = Sample {
        sequence: k,
        device_time,
        delta_theta: [n.wrapping_mul(715_827_883), -n, i32::MIN + n],
        delta_velocity: [0, n.wrapping_mul(1 << 20), i32::MAX - n],
        gimbal: GimbalAngles { azimuth: -n * 7, roll: n.wrapping_mul(1_000_003) },
        status: octant_sample::Status::from_bits_retain((k % 16) as u16),
    };
    let x = f64::from(n) * 0.1;
    let reference = match k % 20 {
        0 => Some(Reference::Velocity([x, -0.0, f64::NAN])),
        10 => Some(Reference::Position { latitude_rad: x, longitude_rad: 1e-300, height_m: 12.25 }),
        _ => None,
    };
    (sample, reference.map(|reference| Aiding { device_time, reference }))
}

/// Canonical bytes of an output.
pub(crate) fn bits(output: &Output) -> Vec<u8> {
    let mut bytes = [0; octant_sample::canonical::OUTPUT_BYTES];
    octant_sample::canonical::output(output, &mut bytes);
    bytes.to_vec()
}

/// Drives a harness through samples, a restart and the end, and compares each answer with the echo.
pub(crate) fn drive(harness: &mut Harness, samples: u64) {
    let mut echo = Echo::default();
    let compare = |harness: &Harness, echo: &Echo, output: &Output, expected: &Output| {
        assert_eq!(bits(output), bits(expected));
        let found = harness.parameters().expect("the first output brings parameters");
        let (parameters, sigma) = echo.parameters();
        assert_eq!(found.revision, expected.parameters_revision);
        assert_eq!((found.parameters.to_array(), found.sigma), (parameters.to_array(), sigma));
    };
    let (mut output, mut expected) = (Output::default(), Output::default());
    for k in 1..=samples {
        let (sample, aiding) = sample(k);
        harness.step(&sample, aiding.as_ref(), &mut output).unwrap();
        echo.step(&sample, aiding.as_ref(), &mut expected);
        compare(harness, &echo, &output, &expected);
        if k == samples / 2 {
            let offset = Parameters::from_array(&[0.5; PARAMETER_COUNT]);
            harness.restart(Some(&offset)).unwrap();
            echo.restart(Some(&offset)).unwrap();
        }
    }
    let last = harness.end().unwrap().expect("an echo concludes");
    assert_eq!(bits(&last), bits(&echo.end()));
}

/// A device on a thread.
pub(crate) struct Served {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    pub(crate) notices: Receiver<String>,
}

impl Served {
    /// Serves an echoing core over a wire.
    pub(crate) fn over(wire: Wire, facts: Facts) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let (sender, notices) = channel();
        let until = Arc::clone(&stop);
        let thread = std::thread::spawn(move || {
            let mut echo = Echo::default();
            let mut notice = |notice: &Notice| {
                let _ = sender.send(notice.to_string());
            };
            let mut device = Device::new(wire, facts, &mut echo, &mut notice).unwrap();
            // A port that goes away ends the device here.
            let _ = device.serve(&until);
        });
        Self { stop, thread: Some(thread), notices }
    }

    /// Serves an echoing core on the port of a URI; also returns the URI for the harness.
    pub(crate) fn on(uri: &str, facts: Facts) -> (Self, Uri) {
        let uri: Uri = uri.parse().unwrap();
        let port = port::open(&uri, EndRole::Device).unwrap();
        let reached = port::announcement(&uri, &port).parse().unwrap();
        (Self::over(Wire::new(uri.to_string(), port, EndRole::Device), facts), reached)
    }

    pub(crate) fn stop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
    }

    /// Notices of the device so far.
    pub(crate) fn said(&self) -> Vec<String> {
        self.notices.try_iter().collect()
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Opens a session at a port.
pub(crate) fn harness(uri: &Uri) -> Harness {
    Harness::open(Wire::open(uri, EndRole::Harness).unwrap(), options()).unwrap()
}
