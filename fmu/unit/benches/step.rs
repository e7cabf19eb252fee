//! Cost of the C interface: the Calibrator's step against that of the core alone, and setting and
//! getting all inputs and outputs, in both standards. A second of 200 Hz samples with noise, over and
//! over, in eight positions with 39 states and one measurement a second.
//!
//! - `step/core`: [`Core::step_into`] alone.
//! - `step/fmi2`, `step/fmi3`: `doStep`; what is set before is not in it.
//! - `exchange/fmi2`, `exchange/fmi3`: all inputs set and all outputs got, without a step.
//! - `sample/fmi2`, `sample/fmi3`: inputs set, step, outputs got.
#![allow(missing_docs, clippy::unwrap_used)]
#![allow(unsafe_code, reason = "C functions are called")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use octant_calibration::Core;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::DEG;
use octant_fmi::fmi2::{CO_SIMULATION, OK};
use octant_fmu::c::fmi2::*;
use octant_fmu::c::fmi3::*;
use octant_fmu::c::{ServedStandard, token};
use octant_fmu::calibrator::config;
use octant_fmu::calibrator::table::MODEL;
use octant_fmu::table::{DeclaredCausality, DeclaredVariable, ElementType};
use octant_fmu::values::CellValues;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{Aiding, DeviceTime, Output, Reference, Sample, Status};
use std::ffi::{CString, c_void};
use std::hint::black_box;
use std::ptr::{null, null_mut};
use std::time::{Duration, Instant};

const PERIOD_NS: u64 = 5_000_000;
const PERIOD_S: f64 = 0.005;
const SECOND: usize = 200;

static ZEROS: [u64; 4] = [0; 4];
static ONES2: [i32; 4] = [1; 4];
static ONES3: [u8; 4] = [1; 4];

/// A second of a level static base with scattered noise.
fn second() -> Vec<Sample> {
    let earth = Ellipsoid::at(30.5 * DEG, 0.0);
    let (rate, g) = (earth.earth_rate(), earth.gravity_mps2);
    let mut state = 1u64;
    let mut noise = |amplitude: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        ((state >> 33) as f64 / (1u64 << 30) as f64 - 1.0) * amplitude
    };
    (1..=SECOND)
        .map(|_| Sample {
            delta_theta: [rate.x, rate.y, rate.z]
                .map(|w| (w * PERIOD_S / DELTA_THETA_LSB_RAD + noise(1000.0)) as i32),
            delta_velocity: [0.0, 0.0, -g]
                .map(|f| (f * PERIOD_S / DELTA_VELOCITY_LSB_MPS + noise(40_000.0)) as i32),
            status: Status::GIMBAL_INVALID,
            ..Sample::default()
        })
        .collect()
}

/// Variables of one type, as both standards want them.
struct Ports {
    elements: Vec<u32>,
    variables: Vec<u32>,
}

impl Ports {
    fn of(causality: DeclaredCausality, wanted: impl Fn(&DeclaredVariable) -> bool) -> Self {
        let (mut elements, mut variables) = (Vec::new(), Vec::new());
        for (slot, variable) in MODEL.with_slots() {
            if variable.causality == causality && wanted(variable) {
                variables.push(slot as u32);
                elements.extend((slot..slot + variable.slots()).map(|slot| slot as u32));
            }
        }
        Self { elements, variables }
    }
}

fn is(kind: ElementType) -> impl Fn(&DeclaredVariable) -> bool {
    move |variable| core::mem::discriminant(&variable.kind) == core::mem::discriminant(&kind)
}

fn is_enumeration(variable: &DeclaredVariable) -> bool {
    matches!(variable.kind, ElementType::Enumeration(_))
}

/// All inputs with their values, and room for all outputs.
struct Exchange {
    standard: ServedStandard,
    handle: *mut c_void,
    reals_in: Ports,
    counts_in: Ports,
    integers_in: Ports,
    enumerations_in: Ports,
    booleans_in: Ports,
    reals_out: Ports,
    counts_out: Ports,
    integers_out: Ports,
    enumerations_out: Ports,
    booleans_out: Ports,
    /// FMI 2.0: Reals and counts together, as Reals; so Integers and enumerations.
    both_in: Vec<u32>,
    both_out: Vec<u32>,
    whole_in: Vec<u32>,
    whole_out: Vec<u32>,
    reals: Vec<f64>,
    got: Vec<f64>,
    counts: Vec<u64>,
    integers: Vec<i32>,
    wide: Vec<i64>,
    booleans: Vec<u8>,
    booleans2: Vec<i32>,
}

impl Exchange {
    fn new(standard: ServedStandard) -> Self {
        use DeclaredCausality::{Input, Output};
        let join = |a: &Ports, b: &Ports| [&a.elements[..], &b.elements[..]].concat();
        let (reals_in, counts_in) =
            (Ports::of(Input, is(ElementType::Real)), Ports::of(Input, is(ElementType::Count)));
        let (reals_out, counts_out) =
            (Ports::of(Output, is(ElementType::Real)), Ports::of(Output, is(ElementType::Count)));
        let (integers_in, enumerations_in) =
            (Ports::of(Input, is(ElementType::Integer)), Ports::of(Input, is_enumeration));
        let (integers_out, enumerations_out) =
            (Ports::of(Output, is(ElementType::Integer)), Ports::of(Output, is_enumeration));
        let this = Self {
            standard,
            handle: instance(standard),
            both_in: join(&reals_in, &counts_in),
            both_out: join(&reals_out, &counts_out),
            whole_in: join(&integers_in, &enumerations_in),
            whole_out: join(&integers_out, &enumerations_out),
            reals: vec![0.0; reals_in.elements.len() + counts_in.elements.len()],
            got: vec![0.0; reals_out.elements.len() + counts_out.elements.len()],
            counts: vec![0; counts_out.elements.len().max(counts_in.elements.len())],
            integers: vec![0; 4],
            wide: vec![0; 4],
            booleans: vec![1; 4],
            booleans2: vec![1; 4],
            booleans_in: Ports::of(Input, is(ElementType::Boolean)),
            booleans_out: Ports::of(Output, is(ElementType::Boolean)),
            reals_in,
            counts_in,
            integers_in,
            enumerations_in,
            reals_out,
            counts_out,
            integers_out,
            enumerations_out,
        };
        assert_eq!(this.both_in.len() + this.whole_in.len() + 1, 20, "all inputs");
        assert_eq!(this.both_out.len() + this.whole_out.len() + 2, 81, "all outputs");
        this
    }

    fn sample(&mut self, sample: &Sample, aided: bool) {
        let theta = sample.delta_theta.map(|count| f64::from(count) * DELTA_THETA_LSB_RAD);
        let velocity = sample.delta_velocity.map(|count| f64::from(count) * DELTA_VELOCITY_LSB_MPS);
        self.reals[..3].copy_from_slice(&theta);
        self.reals[3..6].copy_from_slice(&velocity);
        self.integers[0] = i32::from(sample.status.bits());
        self.integers[1] = i32::from(aided);
        self.wide[0] = i64::from(aided);
    }

    #[inline]
    fn set(&mut self) {
        let c = self.handle;
        // SAFETY: a handle, and arrays as long as is said.
        unsafe {
            if self.standard == ServedStandard::Fmi2 {
                let (to, n) = (self.both_in.as_ptr(), self.both_in.len());
                assert_eq!(fmi2SetReal(c, to, n, self.reals.as_ptr()), OK);
                let (to, n) = (self.whole_in.as_ptr(), self.whole_in.len());
                assert_eq!(fmi2SetInteger(c, to, n, self.integers.as_ptr()), OK);
                let to = &self.booleans_in.elements;
                let from = ONES2.as_ptr();
                assert_eq!(fmi2SetBoolean(c, to.as_ptr(), to.len(), from), OK);
                return;
            }
            let (to, n) = (&self.reals_in.variables, self.reals_in.elements.len());
            assert_eq!(fmi3SetFloat64(c, to.as_ptr(), to.len(), self.reals.as_ptr(), n), OK);
            let to = &self.counts_in.variables;
            let (n, from) = (to.len(), ZEROS.as_ptr());
            assert_eq!(fmi3SetUInt64(c, to.as_ptr(), n, from, n), OK);
            let to = &self.integers_in.variables;
            let n = to.len();
            assert_eq!(fmi3SetInt32(c, to.as_ptr(), n, self.integers.as_ptr(), n), OK);
            let to = &self.enumerations_in.variables;
            let n = to.len();
            assert_eq!(fmi3SetInt64(c, to.as_ptr(), n, self.wide.as_ptr(), n), OK);
            let to = &self.booleans_in.variables;
            let (n, from) = (to.len(), ONES3.as_ptr());
            assert_eq!(fmi3SetBoolean(c, to.as_ptr(), n, from, n), OK);
        }
    }

    #[inline]
    fn get(&mut self) {
        let c = self.handle;
        // SAFETY: a handle, and arrays as long as is said.
        unsafe {
            if self.standard == ServedStandard::Fmi2 {
                let (of, n) = (self.both_out.as_ptr(), self.both_out.len());
                assert_eq!(fmi2GetReal(c, of, n, self.got.as_mut_ptr()), OK);
                let (of, n) = (self.whole_out.as_ptr(), self.whole_out.len());
                let mut wholes = [0; 4];
                assert_eq!(fmi2GetInteger(c, of, n, wholes.as_mut_ptr()), OK);
                let of = &self.booleans_out.elements;
                let to = self.booleans2.as_mut_ptr();
                assert_eq!(fmi2GetBoolean(c, of.as_ptr(), of.len(), to), OK);
                black_box(wholes);
                return;
            }
            let (of, n) = (&self.reals_out.variables, self.reals_out.elements.len());
            assert_eq!(fmi3GetFloat64(c, of.as_ptr(), of.len(), self.got.as_mut_ptr(), n), OK);
            let of = &self.counts_out.variables;
            let n = of.len();
            assert_eq!(fmi3GetUInt64(c, of.as_ptr(), n, self.counts.as_mut_ptr(), n), OK);
            let of = &self.integers_out.variables;
            let (n, mut wholes) = (of.len(), [0; 4]);
            assert_eq!(fmi3GetInt32(c, of.as_ptr(), n, wholes.as_mut_ptr(), n), OK);
            let of = &self.enumerations_out.variables;
            let (n, mut wide) = (of.len(), [0; 4]);
            assert_eq!(fmi3GetInt64(c, of.as_ptr(), n, wide.as_mut_ptr(), n), OK);
            let of = &self.booleans_out.variables;
            let n = of.len();
            assert_eq!(fmi3GetBoolean(c, of.as_ptr(), n, self.booleans.as_mut_ptr(), n), OK);
            black_box((wholes, wide));
        }
    }

    #[inline]
    fn step(&self, k: u64) {
        // SAFETY: a handle, and places.
        unsafe {
            if self.standard == ServedStandard::Fmi2 {
                assert_eq!(fmi2DoStep(self.handle, k as f64 * PERIOD_S, PERIOD_S, 1), OK);
                return;
            }
            let (mut event, mut end, mut early, mut last_s) = (0, 0, 0, 0.0);
            let (h, t) = (self.handle, k as f64 * PERIOD_S);
            let do_step = fmi3DoStep;
            let status = do_step(h, t, PERIOD_S, 1, &mut event, &mut end, &mut early, &mut last_s);
            assert_eq!(status, OK);
            black_box(last_s);
        }
    }
}

impl Drop for Exchange {
    fn drop(&mut self) {
        // SAFETY: a handle.
        unsafe {
            match self.standard {
                ServedStandard::Fmi2 => fmi2FreeInstance(self.handle),
                ServedStandard::Fmi3 => fmi3FreeInstance(self.handle),
            }
        }
    }
}

/// An instance before its first step, with a given alignment, so that it calibrates at once.
fn instance(standard: ServedStandard) -> *mut c_void {
    let token = CString::new(token(&MODEL, standard)).unwrap();
    let (name, token, none) = (c"bench".as_ptr(), token.as_ptr(), null());
    let method = MODEL.slot("procedure.alignment.method") as u32;
    // SAFETY: strings, a handle, one reference with one value.
    unsafe {
        if standard == ServedStandard::Fmi2 {
            let c = fmi2Instantiate(name, CO_SIMULATION, token, none, null(), 0, 0);
            assert_eq!(fmi2SetInteger(c, &method, 1, &0), OK);
            assert_eq!(fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0), OK);
            assert_eq!(fmi2EnterInitializationMode(c), OK);
            assert_eq!(fmi2ExitInitializationMode(c), OK);
            return c;
        }
        let make = fmi3InstantiateCoSimulation;
        let i = make(name, token, none, 0, 0, 0, 0, null(), 0, null_mut(), None, None);
        assert_eq!(fmi3SetInt64(i, &method, 1, &0, 1), OK);
        assert_eq!(fmi3EnterInitializationMode(i, 0, 0.0, 0.0, 0, 0.0), OK);
        assert_eq!(fmi3ExitInitializationMode(i), OK);
        i
    }
}

fn core() -> Core {
    let mut values = CellValues::new(&MODEL);
    values.set_integer(MODEL.slot("procedure.alignment.method"), 0);
    Core::new(&config(&values).unwrap()).unwrap()
}

/// The time of `part` alone over so many minutes of samples.
fn minutes(count: u64, mut part: impl FnMut(u64, &Sample, Option<&Aiding>)) -> Duration {
    let second = second();
    let start = Instant::now();
    let mut k = 0;
    for _ in 0..60 * count {
        for (i, sample) in second.iter().enumerate() {
            let device_time = DeviceTime::from_ns((k + 1) * PERIOD_NS);
            let sample = Sample { sequence: k + 1, device_time, ..*sample };
            let aiding = (i + 1 == SECOND)
                .then_some(Aiding { device_time, reference: Reference::Velocity([0.0; 3]) });
            part(k, &sample, aiding.as_ref());
            k += 1;
        }
    }
    start.elapsed()
}

fn bench(criterion: &mut Criterion) {
    let samples = 60 * SECOND as u64;
    let mut group = criterion.benchmark_group("step");
    group.throughput(Throughput::Elements(samples));
    group.bench_function("core", |bencher| {
        bencher.iter_custom(|runs| {
            let (mut core, mut output) = (core(), Output::default());
            minutes(runs, |_, sample, aiding| {
                core.step_into(sample, aiding, &mut output);
                black_box(&output);
            })
        });
    });
    for (name, standard) in [("fmi2", ServedStandard::Fmi2), ("fmi3", ServedStandard::Fmi3)] {
        // The cost of setting is subtracted: the same without the step.
        group.bench_function(name, |bencher| {
            bencher.iter_custom(|runs| {
                let mut exchange = Exchange::new(standard);
                let all = minutes(runs, |k, sample, aiding| {
                    exchange.sample(sample, aiding.is_some());
                    exchange.set();
                    exchange.step(k);
                });
                let set = minutes(runs, |_, sample, aiding| {
                    exchange.sample(sample, aiding.is_some());
                    exchange.set();
                });
                all.saturating_sub(set)
            });
        });
    }
    group.finish();

    let mut group = criterion.benchmark_group("exchange");
    for (name, standard) in [("fmi2", ServedStandard::Fmi2), ("fmi3", ServedStandard::Fmi3)] {
        let mut exchange = Exchange::new(standard);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                exchange.set();
                exchange.get();
            });
        });
    }
    group.finish();

    let mut group = criterion.benchmark_group("sample");
    group.throughput(Throughput::Elements(samples));
    for (name, standard) in [("fmi2", ServedStandard::Fmi2), ("fmi3", ServedStandard::Fmi3)] {
        group.bench_function(name, |bencher| {
            bencher.iter_custom(|runs| {
                let mut exchange = Exchange::new(standard);
                minutes(runs, |k, sample, aiding| {
                    exchange.sample(sample, aiding.is_some());
                    exchange.set();
                    exchange.step(k);
                    exchange.get();
                })
            });
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
