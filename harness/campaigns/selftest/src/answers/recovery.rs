//! Recovery of the filter: amount and duration of the opened covariance, and the checkpoint that it
//! returns to.

use super::numbers::Found;
use octant_calibration::config::{
    AidingMode, ErrorModel, Gate, Kalman, Noise, Prior, Recovery, Screening, Site, SwayNoise,
};
use octant_calibration::continuity::Edge;
use octant_calibration::covariance::{DR, DV, PHI, STATE_COUNT};
use octant_calibration::filter::CalibrationFilter;
use octant_calibration::strapdown::{Strapdown, Vertical};
use octant_earth::{UnitQuaternion, Vector3};
use octant_sample::{Parameters, Reference};
use std::hint::black_box;

/// 1/16 s, exact in binary, so that times add up.
const SAMPLE_NS: u64 = 62_500_000;
const SAMPLE_S: f64 = 0.0625;
const SAMPLES_PER_S: u32 = 16;
const REJECTIONS: u32 = 5;

pub(super) fn found() -> Result<Found, String> {
    let mut all = Found::new();
    edges(&mut all);
    for (error_mps, sigma_mps) in black_box([(20.0, 1.0), (9000.0, 100.0)]) {
        let mut bench = Bench::new(AidingMode::Velocity { sigma_mps });
        for _ in 0..REJECTIONS {
            bench.measure_velocity(error_mps)?;
        }
        bench.sigmas(&mut all, &format!("velocity {error_mps}"));
    }
    for (error_m, sigma_m) in black_box([(50.0, 1.0), (9e5, 1e4)]) {
        let mut bench = Bench::new(AidingMode::Position { sigma_m });
        for _ in 0..REJECTIONS {
            bench.measure_height(error_m)?;
        }
        bench.sigmas(&mut all, &format!("position {error_m}"));
    }
    all.insert("farthest velocity".to_owned(), farthest(1e4, velocity_is_followed)?);
    all.insert("farthest position".to_owned(), farthest(1e6, position_is_followed)?);
    stages(&mut all)?;
    all.insert("age of the checkpoint".to_owned(), checkpoint_age()?);
    let text = format!("{:?}", Bench::new(AidingMode::Velocity { sigma_mps: 1.0 }).filter);
    for (name, field) in [("spacing", "spacing_s"), ("time of the first", "next_s")] {
        let time_s = super::core::of_field(&text, field)?[0];
        all.insert(format!("{name} of the marks of the drift test"), time_s);
    }
    Ok(all)
}

/// Computes the σ of all states of a filter that is told every second that it is at rest.
pub(super) fn rest() -> Result<Found, String> {
    let mut bench = Bench::new(AidingMode::Velocity { sigma_mps: 1e-3 });
    let mut all = Found::new();
    for second in 1..=120 {
        for _ in 0..SAMPLES_PER_S {
            bench.stand();
        }
        bench.measure_velocity(0.0)?;
        if matches!(second, 10 | 120) {
            for state in 0..STATE_COUNT {
                all.insert(format!("sigma of state {state}, {second} s"), bench.sigma(state));
            }
        }
    }
    Ok(all)
}

/// Instrument at rest, with its filter.
struct Bench {
    filter: CalibrationFilter,
    strapdown: Strapdown,
    parameters: Parameters,
}

impl Bench {
    fn new(aiding: AidingMode) -> Self {
        let site = Site { latitude_rad: 0.5, longitude_rad: 0.2, height_m: 0.0 };
        let kalman = Kalman {
            error_model: ErrorModel::Phi,
            estimated: [true; 7],
            prior: Prior {
                attitude_rad: [1e-4, 1e-4, 1e-4],
                velocity_mps: 1e-3,
                position_m: 1.0,
                parameters: [1e-8, 30e-6, 2e-4, 1e-9, 1e-3, 3e-5, 2e-4],
            },
            aiding,
            aiding_period_ns: 1_000_000_000,
            sway: SwayNoise::White,
            refuse_above_mean_nis: 9.0,
            further: Default::default(),
            sigma_limits: Default::default(),
        };
        let gate = Gate { nis: 36.0, rejections: REJECTIONS, recovery: Recovery::Widening };
        let screening = Screening {
            gate: Some(gate),
            checkpoints: true,
            drift_sigmas: Some(6.0),
            ..Screening::none()
        };
        let noise = Noise { angle_random_walk: 2e-7, velocity_random_walk: 5e-4 };
        let parameters = Parameters::default();
        let filter =
            CalibrationFilter::new(&kalman, &site, &noise, &screening, &parameters, SAMPLE_NS);
        let strapdown = Strapdown::new(
            &UnitQuaternion::identity(),
            Vector3::zeros(),
            site.latitude_rad,
            site.longitude_rad,
            site.height_m,
            Vertical::Held,
        );
        Self { filter, strapdown, parameters }
    }

    fn measure(&mut self, reference: &Reference) -> Result<(), String> {
        let measured = self.filter.measure(reference, &mut self.strapdown, &mut self.parameters);
        measured.map(|_| ()).ok_or_else(|| "measure".to_owned())
    }

    fn measure_velocity(&mut self, error_mps: f64) -> Result<(), String> {
        let velocity = *self.strapdown.velocity_mps() - Vector3::new(error_mps, 0.0, 0.0);
        self.measure(&Reference::Velocity(velocity.into()))
    }

    fn measure_height(&mut self, error_m: f64) -> Result<(), String> {
        let at = self.strapdown.navigation();
        self.measure(&Reference::Position {
            latitude_rad: at.latitude_rad,
            longitude_rad: at.longitude_rad,
            height_m: at.height_m + error_m,
        })
    }

    fn suspect(&mut self, edge: Edge) {
        self.filter.suspect(edge, &mut self.strapdown, &mut self.parameters);
    }

    /// Makes a sample that measures nothing but the Earth.
    fn stand(&mut self) {
        let turn = self.strapdown.earth().earth_rate() * SAMPLE_S;
        let dv = Vector3::new(0.0, 0.0, -self.strapdown.earth().gravity_mps2 * SAMPLE_S);
        self.strapdown.step(&turn, &dv, SAMPLE_S);
        self.filter.accumulate(&self.strapdown, &turn, &dv, SAMPLE_S);
        self.filter.propagate(&self.strapdown);
    }

    fn sigma(&self, state: usize) -> f64 {
        self.filter.covariance().sigma(state)
    }

    fn sigmas(&self, all: &mut Found, name: &str) {
        for (what, state) in
            [("tilt", PHI), ("azimuth", PHI + 2), ("velocity", DV), ("position", DR)]
        {
            all.insert(format!("{what}, {name}"), self.sigma(state));
        }
    }
}

/// Collects the σ that is opened at an interruption without an innovation.
fn edges(all: &mut Found) {
    for (name, edge) in [("turn", Edge::Turn), ("velocity", Edge::Velocity)] {
        let mut bench = Bench::new(AidingMode::Velocity { sigma_mps: 1.0 });
        bench.suspect(black_box(edge));
        bench.sigmas(all, &format!("{name} broke off"));
    }
}

fn velocity_is_followed(error_mps: f64) -> Result<bool, String> {
    let mut bench = Bench::new(AidingMode::Velocity { sigma_mps: 1.0 });
    for _ in 0..REJECTIONS {
        bench.measure_velocity(error_mps)?;
    }
    Ok(bench.filter.tally().recoveries > 0)
}

fn position_is_followed(error_m: f64) -> Result<bool, String> {
    let mut bench = Bench::new(AidingMode::Position { sigma_m: 1.0 });
    for _ in 0..REJECTIONS {
        bench.measure_height(error_m)?;
    }
    Ok(bench.filter.tally().recoveries > 0)
}

/// Returns the largest error, within a factor of two of a guess, from which the filter recovers.
fn farthest(guess: f64, followed: fn(f64) -> Result<bool, String>) -> Result<f64, String> {
    let (mut near, mut far) = (0.5 * guess, 2.0 * guess);
    for _ in 0..48 {
        let middle = 0.5 * (near + far);
        if followed(middle)? {
            near = middle;
        } else {
            far = middle;
        }
    }
    Ok(near)
}

/// Collects the ends of a recovery's stages, and the start values of the second one.
fn stages(all: &mut Found) -> Result<(), String> {
    let mut bench = Bench::new(AidingMode::Velocity { sigma_mps: 1e-3 });
    bench.suspect(Edge::Turn);
    let mut settles = false;
    for sample in 1..=400 * SAMPLES_PER_S {
        let before = bench.sigma(DV);
        bench.stand();
        let time_s = f64::from(sample) * SAMPLE_S;
        // Good measurements have reduced the velocity σ to millimetres per second; the second stage
        // opens it again.
        if !settles && bench.sigma(DV) > 10.0 * before {
            settles = true;
            all.insert("end of the first stage".to_owned(), time_s);
            // The azimuth is left out: its σ depends on what Earth rate has contributed by then,
            // which isn't a number of the table.
            for (what, state) in [("tilt", PHI), ("velocity", DV), ("position", DR)] {
                all.insert(format!("{what}, second stage"), bench.sigma(state));
            }
        }
        if !bench.filter.is_recovering() {
            all.insert("end of the second stage".to_owned(), time_s);
            return Ok(());
        }
        if sample.is_multiple_of(SAMPLES_PER_S) {
            bench.measure_velocity(0.0)?;
        }
    }
    Err("end the recovery within 400 s".to_owned())
}

/// Returns the time to which the parameters are reset, 200 s after the start.
fn checkpoint_age() -> Result<f64, String> {
    let mut bench = Bench::new(AidingMode::Velocity { sigma_mps: 1e-3 });
    let mut seen = Vec::new();
    for second in 1..=200_u32 {
        for _ in 0..SAMPLES_PER_S {
            bench.stand();
        }
        bench.measure_velocity(1e-4 * f64::from(1 + second % 3))?;
        seen.push(bench.parameters);
    }
    bench.suspect(Edge::Turn);
    let at = seen.iter().position(|parameters| *parameters == bench.parameters);
    let seconds = at.ok_or("find the parameters gone back to")? + 1;
    Ok(seconds as f64)
}
