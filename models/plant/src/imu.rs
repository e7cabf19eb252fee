//! The sensors: from true increments to integer counts.
//!
//! ```text
//! Δθ̃ = (I + M_g) Δθ + b_g dt + G Δv + noise        Δṽ = (I + M_a) Δv + b_a dt + noise
//! ```
//! and, where the sensors are [nonlinear](Nonlinear), `a |Δθ|` and `a |Δv| + k Δv²/dt`.
//!
//! Everything is computed in counts of the format; their sizes are powers of two, so that the
//! conversion changes no digit.

use crate::config::{Extensions, Imu, Temperature};
use crate::increments::Increments;
use crate::processes::Wander;
use nalgebra::{Matrix3, Vector3};
use octant_random::stream::{Ahead, Triad};
use octant_sample::counts::{
    Accumulator, DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS, count_triad,
};
use octant_sample::{NoiseIntegral, Status};

fn rows(m: [[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| m[row][column])
}

/// Reading of both triads without noise, in counts.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Reading {
    gyro: Vector3<f64>,
    accelerometer: Vector3<f64>,
}

/// Noise and digitisation of one triad.
#[derive(Clone, Debug)]
struct Triple {
    lsb: f64,
    sigma_counts: f64,
    noise: Ahead,
    /// Sum of the white noise so far, in counts. No state: only its differences are used, of one run.
    white_counts: [f64; 3],
    wanders: Vec<Wander>,
    /// Range in counts per interval; infinite: only the range of the format.
    limit_counts: f64,
    /// Coarser quantum in counts; 0: none.
    quantum_counts: f64,
    quantizers: [Accumulator; 3],
    accumulators: [Accumulator; 3],
}

// Noise follows from the sample's number, so that numbers made ahead needn't be saved.
octant_state::state! {
    Triple {
        values: quantizers, accumulators;
        parts: wanders;
        kept: lsb, sigma_counts, noise, white_counts, limit_counts, quantum_counts
    }
}

impl Triple {
    #[inline(always)]
    fn count(&mut self, mut reading: Vector3<f64>, sample: u64, counts: &mut [i32; 3]) -> bool {
        for wander in &mut self.wanders {
            reading += Vector3::from(wander.increment(sample)) / self.lsb;
        }
        if self.sigma_counts > 0.0 {
            let noise = self.noise.at(sample);
            for axis in 0..3 {
                let white = self.sigma_counts * noise[axis];
                reading[axis] += white;
                self.white_counts[axis] += white;
            }
        }
        let mut saturated = false;
        // None is larger than the sum of all.
        let sum = reading.x.abs() + reading.y.abs() + reading.z.abs();
        if self.quantum_counts > 0.0 || !(sum <= self.limit_counts) {
            (reading, saturated) = self.limit_and_quantize(reading);
        }
        saturated | count_triad(&mut self.accumulators, reading.into(), counts)
    }

    #[inline(never)]
    fn limit_and_quantize(&mut self, mut reading: Vector3<f64>) -> (Vector3<f64>, bool) {
        let mut saturated = false;
        for axis in 0..3 {
            if reading[axis].abs() > self.limit_counts {
                reading[axis] = self.limit_counts.copysign(reading[axis]);
                saturated = true;
            }
            if self.quantum_counts > 0.0 {
                let count = self.quantizers[axis].count(reading[axis] / self.quantum_counts);
                reading[axis] = f64::from(count.value) * self.quantum_counts;
                saturated |= count.saturated;
            }
        }
        (reading, saturated)
    }

    fn navigate(&mut self) {
        self.noise.navigate();
        for wander in &mut self.wanders {
            wander.stream.navigate();
        }
    }

    /// A remainder is within half a count on either side; that of a coarser quantum comes on top.
    fn remainder_counts(&self) -> i64 {
        if self.quantum_counts > 0.0 {
            (libm::ceil(self.quantum_counts) as i64).saturating_add(1)
        } else {
            1
        }
    }

    /// Takes over the noise and the range of another triad. What carries over from sample to sample stays.
    fn tune(&mut self, other: &Self) {
        self.sigma_counts = other.sigma_counts;
        self.limit_counts = other.limit_counts;
    }
}

/// Processes of the bias instability of a triad, each with its own stream; none without it.
fn flicker(triad: &str, coefficient: f64, dt: f64, seed: u64) -> Vec<Wander> {
    if coefficient == 0.0 {
        return Vec::new();
    }
    let processes = crate::flicker::processes(coefficient);
    let wander = |(index, process): (usize, &_)| {
        let stream = Triad::new(seed, &format!("{triad}.flicker.{index}"));
        Wander::gauss_markov(process, dt, stream)
    };
    processes.iter().enumerate().map(wander).collect()
}

/// Asymmetry and second order, in counts per increment (rad, m/s) and per its square.
#[derive(Clone, Copy, Debug)]
struct Nonlinear {
    gyro_asymmetry: Vector3<f64>,
    accel_asymmetry: Vector3<f64>,
    accel_square: Vector3<f64>,
}

impl Nonlinear {
    fn new(e: &Extensions, dt: f64) -> Option<Self> {
        let coefficients = [e.gyro_asymmetry, e.accel_asymmetry, e.accel_quadratic];
        (coefficients != [[0.0; 3]; 3]).then(|| Self {
            gyro_asymmetry: Vector3::from(e.gyro_asymmetry) / DELTA_THETA_LSB_RAD,
            accel_asymmetry: Vector3::from(e.accel_asymmetry) / DELTA_VELOCITY_LSB_MPS,
            accel_square: Vector3::from(e.accel_quadratic) / (dt * DELTA_VELOCITY_LSB_MPS),
        })
    }

    fn add(&self, increments: &Increments, reading: &mut Reading) {
        let (theta, velocity) = (&increments.delta_theta, &increments.delta_velocity);
        reading.gyro += self.gyro_asymmetry.component_mul(&theta.abs());
        reading.accelerometer += self.accel_asymmetry.component_mul(&velocity.abs())
            + self.accel_square.component_mul(&velocity.component_mul(velocity));
    }
}

/// Both triads.
#[derive(Clone, Debug)]
pub(crate) struct Sensors {
    dt: f64,
    gyro_matrix: Matrix3<f64>,
    g_matrix: Matrix3<f64>,
    gyro_bias: Vector3<f64>,
    accel_matrix: Matrix3<f64>,
    accel_bias: Vector3<f64>,
    nonlinear: Option<Nonlinear>,
    temperatures: Vec<Warmth>,
    gyro: Triple,
    accelerometer: Triple,
}

octant_state::state! {
    Sensors {
        values: temperatures;
        parts: gyro, accelerometer;
        kept: dt, gyro_matrix, g_matrix, gyro_bias, accel_matrix, accel_bias, nonlinear
    }
}

impl Sensors {
    pub(crate) fn new(imu: &Imu, dt: f64, seed: u64) -> Self {
        let (p, e) = (&imu.parameters, &imu.extensions);
        let (rad, mps) = (DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS);
        let root_dt = libm::sqrt(dt);
        let mut gyro_wanders = Vec::new();
        if let Some(process) = &e.gyro_gauss_markov {
            let stream = Triad::new(seed, "gyro.gauss_markov");
            gyro_wanders.push(Wander::gauss_markov(process, dt, stream));
        }
        if e.gyro_rate_random_walk > 0.0 {
            let stream = Triad::new(seed, "gyro.rate_random_walk");
            gyro_wanders.push(Wander::random_walk(e.gyro_rate_random_walk, dt, stream));
        }
        let mut accel_wanders = Vec::new();
        if let Some(process) = &e.accel_gauss_markov {
            let stream = Triad::new(seed, "accelerometer.gauss_markov");
            accel_wanders.push(Wander::gauss_markov(process, dt, stream));
        }
        gyro_wanders.extend(flicker("gyro", e.gyro_bias_instability, dt, seed));
        accel_wanders.extend(flicker("accelerometer", e.accel_bias_instability, dt, seed));
        let triple = |lsb: f64, density: f64, name, wanders, range: f64, quantum: f64| Triple {
            lsb,
            sigma_counts: density * root_dt / lsb,
            noise: Ahead::new(Triad::new(seed, name)),
            white_counts: [0.0; 3],
            wanders,
            limit_counts: if range > 0.0 { range * dt / lsb } else { f64::INFINITY },
            quantum_counts: quantum / lsb,
            quantizers: Default::default(),
            accumulators: Default::default(),
        };
        Self {
            dt,
            gyro_matrix: (Matrix3::identity() + rows(p.gyro_matrix())) / rad,
            g_matrix: rows(p.g_matrix()) / rad,
            gyro_bias: Vector3::from(p.gyro_bias) * dt / rad,
            accel_matrix: (Matrix3::identity() + rows(p.accel_matrix())) / mps,
            accel_bias: Vector3::from(p.accel_bias) * dt / mps,
            nonlinear: Nonlinear::new(e, dt),
            temperatures: e.temperature.into_iter().map(|t| Warmth::from(None, 0, t)).collect(),
            gyro: triple(
                rad,
                imu.angle_random_walk,
                "gyro.noise",
                gyro_wanders,
                e.gyro_range_radps,
                e.gyro_quantization_rad,
            ),
            accelerometer: triple(
                mps,
                imu.velocity_random_walk,
                "accelerometer.noise",
                accel_wanders,
                e.accel_range_mps2,
                e.accel_quantization_mps,
            ),
        }
    }

    /// Takes over parameters, noise and ranges of other sensors of the same kind.
    pub(crate) fn tune(&mut self, other: &Self) {
        let Self {
            dt: _,
            gyro_matrix,
            g_matrix,
            gyro_bias,
            accel_matrix,
            accel_bias,
            nonlinear: _,
            temperatures: _,
            gyro,
            accelerometer,
        } = other;
        self.gyro_matrix = *gyro_matrix;
        self.g_matrix = *g_matrix;
        self.gyro_bias = *gyro_bias;
        self.accel_matrix = *accel_matrix;
        self.accel_bias = *accel_bias;
        self.gyro.tune(gyro);
        self.accelerometer.tune(accelerometer);
    }

    /// Checks that every change of temperature, and every return, began no later than now.
    pub(crate) fn check(&self, now_ns: u64) -> Result<(), octant_state::StateError> {
        for warmth in &self.temperatures {
            octant_state::check_below("from_ns", warmth.from_ns, now_ns)?;
            if let Some((ended_ns, _)) = warmth.returns {
                octant_state::check_below("ended_ns", ended_ns, now_ns)?;
            }
        }
        Ok(())
    }

    /// Switches to the random numbers of the navigation phase.
    pub(crate) fn navigate(&mut self) {
        self.gyro.navigate();
        self.accelerometer.navigate();
    }

    /// Sums of the white noise in all samples so far.
    pub(crate) fn white_noise(&self) -> NoiseIntegral {
        let sum = |triad: &Triple| triad.white_counts.map(|counts| counts * triad.lsb);
        NoiseIntegral {
            delta_theta_rad: sum(&self.gyro),
            delta_velocity_mps: sum(&self.accelerometer),
        }
    }

    /// Applies the error model without noise and temperature.
    pub(crate) fn read(&self, increments: &Increments) -> Reading {
        let (theta, velocity) = (&increments.delta_theta, &increments.delta_velocity);
        let mut reading = Reading {
            gyro: self.gyro_matrix * theta + self.g_matrix * velocity + self.gyro_bias,
            accelerometer: self.accel_matrix * velocity + self.accel_bias,
        };
        if let Some(nonlinear) = &self.nonlinear {
            nonlinear.add(increments, &mut reading);
        }
        reading
    }

    /// Adds temperature and noise, and digitises. `sample` is the number in the phase from 0,
    /// `start_ns` the start of the interval. The counts are written in place, which avoids a copy.
    #[inline]
    pub(crate) fn count(
        &mut self,
        reading: &Reading,
        increments: &Increments,
        sample: u64,
        start_ns: u64,
        delta_theta: &mut [i32; 3],
        delta_velocity: &mut [i32; 3],
    ) -> Status {
        let (mut gyro, mut accelerometer) = (reading.gyro, reading.accelerometer);
        if !self.temperatures.is_empty() {
            let warm = self.warm(increments, start_ns);
            (gyro, accelerometer) = (gyro + warm.gyro, accelerometer + warm.accelerometer);
        }
        let mut status = Status::empty();
        if self.gyro.count(gyro, sample, delta_theta) {
            status |= Status::GYRO_SATURATED;
        }
        if self.accelerometer.count(accelerometer, sample, delta_velocity) {
            status |= Status::ACCELEROMETER_SATURATED;
        }
        status
    }

    /// Change of a reading by temperature. Changes that have returned to zero are removed.
    #[inline(never)]
    fn warm(&mut self, increments: &Increments, start_ns: u64) -> Reading {
        let mut sum = Reading::default();
        for warmth in &self.temperatures {
            let change = warmth.mean_change_k(start_ns, self.dt);
            let warm = warm(&warmth.temperature, change, increments, self.dt);
            sum.gyro += warm.gyro;
            sum.accelerometer += warm.accelerometer;
        }
        self.temperatures.retain(|warmth| !warmth.is_over(start_ns));
        sum
    }

    /// Change of the temperature since the start, mean over the sample that began then, K: all changes together.
    pub(crate) fn warmth_k(&self, start_ns: u64) -> f64 {
        self.temperatures.iter().map(|warmth| warmth.mean_change_k(start_ns, self.dt)).sum()
    }

    /// Returns whether the temperature change of a fault has not returned.
    pub(crate) fn goes_on(&self, handle: u32, now_ns: u64) -> bool {
        let mut of_fault = self.temperatures.iter().filter(|it| it.handle == Some(handle));
        of_fault.any(|warmth| !warmth.is_over(now_ns))
    }

    /// Returns whether the counters carry the same remainders as those of other sensors.
    pub(crate) fn counts_as(&self, other: &Self) -> bool {
        let same = |a: &Triple, b: &Triple| {
            a.accumulators == b.accumulators && a.quantizers == b.quantizers
        };
        same(&self.gyro, &other.gyro) && same(&self.accelerometer, &other.accelerometer)
    }

    /// Counts by which the remainders of two counters make sums of counts differ, of a gyro and of an accelerometer.
    pub(crate) fn remainder_counts(&self) -> [i64; 2] {
        [&self.gyro, &self.accelerometer].map(Triple::remainder_counts)
    }

    /// Begins a temperature change by a fault.
    pub(crate) fn heat(&mut self, handle: u32, temperature: Temperature, now_ns: u64) {
        if temperature.ramp_kps * temperature.plateau_k > 0.0 {
            self.temperatures.push(Warmth::from(Some(handle), now_ns, temperature));
        }
    }

    /// Ends the temperature change of a fault: the temperature returns.
    pub(crate) fn cool(&mut self, handle: u32, now_ns: u64) {
        for warmth in &mut self.temperatures {
            if warmth.handle == Some(handle) && warmth.returns.is_none() {
                let since_s = (now_ns - warmth.from_ns) as f64 * 1e-9;
                let risen = change_k(&warmth.temperature, since_s);
                warmth.returns = Some((now_ns, risen));
            }
        }
    }
}

/// A change of temperature: the configured one, or that of a fault.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
struct Warmth {
    handle: Option<u32>,
    from_ns: u64,
    /// Time at which the fault ended, and the change at that time, K.
    returns: Option<(u64, f64)>,
    temperature: Temperature,
}

impl Warmth {
    fn from(handle: Option<u32>, from_ns: u64, temperature: Temperature) -> Self {
        Self { handle, from_ns, returns: None, temperature }
    }

    /// Mean change over an interval, K.
    fn mean_change_k(&self, start_ns: u64, dt: f64) -> f64 {
        let Some((ended_ns, risen_k)) = self.returns else {
            let start_s = (start_ns - self.from_ns) as f64 * 1e-9;
            return mean_change_k(&self.temperature, start_s, dt);
        };
        let way_back = Temperature { plateau_k: risen_k, ..self.temperature };
        risen_k - mean_change_k(&way_back, (start_ns - ended_ns) as f64 * 1e-9, dt)
    }

    fn is_over(&self, now_ns: u64) -> bool {
        self.returns.is_some_and(|(ended_ns, risen_k)| {
            (now_ns - ended_ns) as f64 * 1e-9 >= risen_k / self.temperature.ramp_kps
        })
    }
}

/// Temperature change at a time after the onset, K.
fn change_k(temperature: &Temperature, time_s: f64) -> f64 {
    let plateau = temperature.plateau_k;
    let risen = temperature.ramp_kps * time_s;
    if risen.abs() < plateau.abs() { risen } else { plateau }
}

/// Mean temperature change over an interval, K: a ramp from 0 that ends at a plateau.
fn mean_change_k(temperature: &Temperature, start_s: f64, dt: f64) -> f64 {
    if temperature.ramp_kps == 0.0 {
        return 0.0;
    }
    let knee_s = temperature.plateau_k / temperature.ramp_kps;
    let rising = (knee_s - start_s).clamp(0.0, dt);
    let on_ramp = temperature.ramp_kps * (start_s + 0.5 * rising) * rising;
    (on_ramp + temperature.plateau_k * (dt - rising)) / dt
}

/// Change of a reading by a change of temperature.
fn warm(temperature: &Temperature, change: f64, increments: &Increments, dt: f64) -> Reading {
    let mut reading = Reading::default();
    for axis in 0..3 {
        reading.gyro[axis] = change
            * (temperature.gyro_bias_per_k[axis] * dt
                + temperature.gyro_scale_per_k[axis] * increments.delta_theta[axis])
            / DELTA_THETA_LSB_RAD;
        reading.accelerometer[axis] = change
            * (temperature.accel_bias_per_k[axis] * dt
                + temperature.accel_scale_per_k[axis] * increments.delta_velocity[axis])
            / DELTA_VELOCITY_LSB_MPS;
    }
    reading
}
