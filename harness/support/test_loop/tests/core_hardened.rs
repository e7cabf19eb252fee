//! Effects of single faults on the core with all its screens: each is survived, or the calibration
//! is refused.
//!
//! Eight positions, 4 h, Table 1, static. The figure is the largest shift of a parameter against the
//! run without the fault, in posterior σ.

use octant_calibration::config::{Recovery, Screening};
use octant_calibration::positions::{EIGHT, SIX};
use octant_earth::units::*;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS, GIMBAL_LSB_RAD};
use octant_sample::{Aiding, Health, Mode, Sample};
use octant_test_loop::draws;
use octant_test_loop::instrument::InstrumentCase;
use octant_test_loop::plant_and_core::{ClosedLoop, on_two_threads};

const SECOND: u64 = 200;
/// Sample in the dwell at (0, 90), which lasts from 4797 to 5475 s. The vertical gyro is y.
const DWELL: u64 = 5050 * SECOND;
/// Sample in the azimuth move from 5475 to 5485 s, about the horizontal z axis.
const MOVE: u64 = 5480 * SECOND;
/// Sample at the end of its ramp.
const RAMP: u64 = 5476 * SECOND;
const END: u64 = 4 * 3600 * SECOND;

#[derive(Clone, Copy, Debug)]
enum What {
    Nothing,
    /// Added to the rate of a gyro, rad/s.
    Gyro(usize, f64),
    /// Added to an accelerometer, m/s².
    Accel(usize, f64),
    /// All six channels read zero.
    Zero,
    /// All six channels keep their last value.
    Held,
    /// One gyro keeps its last value.
    GyroHeld(usize),
    /// One accelerometer keeps its last value.
    AccelHeld(usize),
    /// The sample is lost.
    Lost,
    /// The sample has the stamp and number of the previous one.
    Duplicate,
    /// The stamp is 0.5 s too old.
    Backwards,
    /// The reference of a second ago, with its own stamp.
    LateAiding,
    /// The reference of a second ago, with the stamp of the sample.
    LyingAiding,
    /// The encoder of azimuth is off by an angle, rad.
    Encoder(f64),
    /// The azimuth gimbal has slipped by an angle, rad, and the encoder doesn't see it.
    Slip(f64),
    /// The azimuth gimbal has slipped by an angle, rad, and the encoder sees it.
    SeenSlip(f64),
    /// All counts at their limit.
    Limit,
}

/// Expected outcome of a fault.
#[derive(Clone, Copy, Debug)]
enum Expect {
    /// Shift below this number of σ, and accepted.
    Below(f64),
    /// Refused, or shift below this number of σ.
    RefusedOrBelow(f64),
}

struct Fault {
    name: &'static str,
    what: What,
    from: u64,
    samples: u64,
    expect: Expect,
    /// Flag that reports it, and the time limit for that, s.
    flag: Option<(Health, f64)>,
}

const TO_END: u64 = u64::MAX / 2;

fn faults() -> Vec<Fault> {
    use Expect::*;
    use What::*;
    let dph = DEG_PER_HOUR;
    let fault =
        |name, what, from, samples, expect, flag| Fault { name, what, from, samples, expect, flag };
    let jump = Some((Health::JUMP, 0.01));
    let stuck = Some((Health::GYRO_STUCK, 1.0));
    let gap = Some((Health::GAP, 10.1));
    let slip = Some((Health::GIMBAL_SLIPPED, 2.0));
    vec![
        fault("gyro 10 deg/h, 1 sample", Gyro(0, 10.0 * dph), DWELL, 1, Below(1.0), None),
        fault("gyro 10 deg/h, 100 samples", Gyro(0, 10.0 * dph), DWELL, 100, Below(3.0), None),
        fault("gyro 1000 deg/h, 100 samples", Gyro(0, 1000.0 * dph), DWELL, 100, Below(3.0), jump),
        fault("gyro 10 deg/s, 1 sample", Gyro(0, 10.0 * DEG), DWELL, 1, Below(3.0), jump),
        fault("gyro 100 deg/s, 1 sample", Gyro(0, 100.0 * DEG), DWELL, 1, Below(3.0), jump),
        fault(
            "vertical gyro 100 deg/s, 1 sample",
            Gyro(1, 100.0 * DEG),
            DWELL,
            1,
            Below(5.0),
            jump,
        ),
        fault("vertical gyro 10 deg/s, 1 s", Gyro(1, 10.0 * DEG), DWELL, 200, Below(5.0), jump),
        fault(
            "vertical gyro 1000 deg/h, 10 s",
            Gyro(1, 1000.0 * dph),
            DWELL,
            2000,
            RefusedOrBelow(5.0),
            jump,
        ),
        fault("z gyro 100 deg/s, 1 sample, move", Gyro(2, 100.0 * DEG), MOVE, 1, Below(3.0), jump),
        fault("accelerometer 1 g, 1 sample", Accel(0, 9.80665), DWELL, 1, Below(3.0), jump),
        fault("all zero 0.1 s, dwell", Zero, DWELL, 20, Below(1.0), jump),
        fault("all zero 1 s, dwell", Zero, DWELL, 200, Below(1.0), jump),
        fault("all zero 10 s, dwell", Zero, DWELL, 2000, Below(1.0), jump),
        fault("all zero 60 s, dwell", Zero, DWELL, 12_000, Below(1.0), jump),
        fault("all zero 0.1 s, move", Zero, MOVE, 20, Below(1.0), jump),
        fault("all zero 1 s, move", Zero, MOVE, 200, Below(3.0), jump),
        fault("all held 1 s, dwell", Held, DWELL, 200, Below(1.0), stuck),
        fault("all held 10 s, dwell", Held, DWELL, 2000, Below(1.0), stuck),
        fault("all held 0.1 s, move", Held, MOVE, 20, Below(3.0), stuck),
        fault("all held 1 s, move", Held, MOVE, 200, RefusedOrBelow(3.0), stuck),
        fault("x gyro stuck 60 s, dwell", GyroHeld(0), DWELL, 12_000, Below(1.0), stuck),
        fault(
            "x accelerometer stuck 60 s, dwell",
            AccelHeld(0),
            DWELL,
            12_000,
            Below(1.0),
            Some((Health::ACCELEROMETER_STUCK, 1.0)),
        ),
        fault("z gyro stuck 2 s into the move", GyroHeld(2), RAMP, 400, RefusedOrBelow(3.0), stuck),
        fault(
            "z gyro stuck 20 s over the move",
            GyroHeld(2),
            RAMP,
            4000,
            RefusedOrBelow(3.0),
            stuck,
        ),
        fault("x gyro stuck to the end", GyroHeld(0), DWELL, TO_END, RefusedOrBelow(3.0), stuck),
        fault("counts at their limit 0.1 s", Limit, DWELL, 20, Below(3.0), jump),
        fault(
            "gyro bias step 0.005 deg/h",
            Gyro(0, 0.005 * dph),
            DWELL,
            TO_END,
            RefusedOrBelow(6.0),
            None,
        ),
        fault(
            "gyro bias step 0.05 deg/h",
            Gyro(0, 0.05 * dph),
            DWELL,
            TO_END,
            RefusedOrBelow(5.0),
            None,
        ),
        fault(
            "accelerometer step 50 ug",
            Accel(0, 50.0 * MICRO_G),
            DWELL,
            TO_END,
            RefusedOrBelow(5.0),
            None,
        ),
        fault(
            "accelerometer step 50 ug, late",
            Accel(0, 50.0 * MICRO_G),
            11_000 * SECOND,
            TO_END,
            RefusedOrBelow(5.0),
            None,
        ),
        fault("encoder slip 0.5 deg, dwell", Encoder(0.5 * DEG), DWELL, TO_END, Below(0.2), slip),
        fault(
            "encoder slip 0.5 deg, move",
            Encoder(0.5 * DEG),
            MOVE,
            TO_END,
            Below(0.2),
            Some((Health::GIMBAL_SLIPPED, 8.0)),
        ),
        fault(
            "gimbal slip 0.5 deg, unseen",
            Slip(0.5 * DEG),
            MOVE,
            TO_END,
            Below(0.2),
            Some((Health::GIMBAL_SLIPPED, 8.0)),
        ),
        fault(
            "gimbal slip 0.5 deg, seen",
            SeenSlip(0.5 * DEG),
            MOVE,
            TO_END,
            Below(0.2),
            Some((Health::GIMBAL_DISAGREES, 8.0)),
        ),
        fault("gap 0.1 s, dwell", Lost, DWELL, 20, Below(3.0), gap),
        fault("gap 1 s, dwell", Lost, DWELL, 200, Below(3.0), gap),
        fault("gap 10 s, dwell", Lost, DWELL, 2000, Below(3.0), gap),
        fault("gap 0.1 s, move", Lost, MOVE, 20, Below(3.0), gap),
        fault("gap 1 s, move", Lost, MOVE, 200, Below(3.0), gap),
        fault("gap 10 s, move", Lost, MOVE, 2000, Below(3.0), gap),
        fault(
            "duplicates 0.1 s",
            Duplicate,
            MOVE,
            20,
            Below(3.0),
            Some((Health::OUT_OF_ORDER, 0.01)),
        ),
        fault(
            "stamps backwards 0.1 s",
            Backwards,
            MOVE,
            20,
            Below(3.0),
            Some((Health::OUT_OF_ORDER, 0.01)),
        ),
        fault(
            "late aiding, 100 s",
            LateAiding,
            DWELL,
            20_000,
            Below(3.0),
            Some((Health::AIDING_STALE, 2.1)),
        ),
        fault("late aiding under a new stamp, 100 s", LyingAiding, DWELL, 20_000, Below(3.0), None),
    ]
}

/// State of a fault.
#[derive(Default)]
struct Memory {
    last: Sample,
    carried: f64,
    late: Option<Aiding>,
}

/// Applies the fault to one sample; `false`: it is lost.
fn apply(
    what: What,
    sample: &mut Sample,
    aiding: &mut Option<Aiding>,
    memory: &mut Memory,
) -> bool {
    let carried = &mut memory.carried;
    let mut add = |count: &mut i32, exact: f64| {
        *carried += exact;
        let whole = carried.round();
        *carried -= whole;
        *count = (f64::from(*count) + whole) as i32;
    };
    let last = &memory.last;
    match what {
        // The turntable applies slips.
        What::Nothing | What::Slip(_) | What::SeenSlip(_) => {}
        What::Gyro(axis, rate) => {
            add(&mut sample.delta_theta[axis], rate * 0.005 / DELTA_THETA_LSB_RAD);
        }
        What::Accel(axis, f) => {
            add(&mut sample.delta_velocity[axis], f * 0.005 / DELTA_VELOCITY_LSB_MPS);
        }
        What::Zero => (sample.delta_theta, sample.delta_velocity) = ([0; 3], [0; 3]),
        What::Held => {
            (sample.delta_theta, sample.delta_velocity) = (last.delta_theta, last.delta_velocity);
        }
        What::GyroHeld(axis) => sample.delta_theta[axis] = last.delta_theta[axis],
        What::AccelHeld(axis) => sample.delta_velocity[axis] = last.delta_velocity[axis],
        What::Lost => return false,
        What::Duplicate => {
            (sample.sequence, sample.device_time) = (last.sequence, last.device_time);
        }
        What::Backwards => sample.device_time.ns -= 500_000_000,
        What::LateAiding | What::LyingAiding => {
            if aiding.is_some() {
                core::mem::swap(aiding, &mut memory.late);
                if let (What::LyingAiding, Some(aiding)) = (what, aiding) {
                    aiding.device_time = sample.device_time;
                }
            }
        }
        What::Encoder(angle) => sample.gimbal.azimuth += (angle / GIMBAL_LSB_RAD) as i32,
        What::Limit => {
            (sample.delta_theta, sample.delta_velocity) = ([i32::MIN; 3], [i32::MAX; 3]);
        }
    }
    true
}

struct Outcome {
    parameters: [f64; 30],
    sigma: [f64; 30],
    run: ClosedLoop,
    /// Time of the first epoch with each flag, s after the fault began.
    first: [f64; 32],
}

fn finish(mut run: ClosedLoop, what: What, from: u64, samples: u64) -> Outcome {
    let mut memory = Memory::default();
    let mut first = [f64::INFINITY; 32];
    let mut made = run.output.sequence;
    let mut sigma = [f64::NAN; 30];
    // A slip is an uncommanded turn of the table; it then drives to its set point by its own
    // encoders.
    let slipped = match what {
        What::Slip(angle) | What::SeenSlip(angle) => (angle / GIMBAL_LSB_RAD) as i32,
        _ => 0,
    };
    while made < END {
        let active = (1..=samples).contains(&(made + 1).saturating_sub(from));
        let turned = slipped != 0 && made > from;
        if turned {
            run.command.target.azimuth += slipped;
        }
        let seen = matches!(what, What::SeenSlip(_));
        run.step_altered(|mut sample, mut aiding| {
            made = sample.sequence;
            if turned && !seen {
                sample.gimbal.azimuth -= slipped;
            }
            let kept = !active || apply(what, &mut sample, &mut aiding, &mut memory);
            if !active {
                memory.last = sample;
            }
            kept.then_some((sample, aiding))
        });
        if made > from {
            for bit in run.output.health.iter() {
                let first = &mut first[bit.bits().trailing_zeros() as usize];
                *first = first.min((made - from) as f64 / SECOND as f64);
            }
        }
        if let Some(filter) = run.core.filter()
            && made.is_multiple_of(SECOND)
        {
            sigma = filter.parameter_sigmas();
        }
    }
    Outcome { parameters: run.core.parameters().to_array(), sigma, run, first }
}

fn shift(faulted: &Outcome, clean: &Outcome) -> (f64, usize) {
    (0..30)
        .map(|i| ((faulted.parameters[i] - clean.parameters[i]).abs() / clean.sigma[i], i))
        .fold((0.0, 0), |a, b| if b.0 > a.0 { b } else { a })
}

fn before(seed: u64, moored: bool) -> ClosedLoop {
    let case = InstrumentCase::table_1(seed, EIGHT);
    let (plant, core) = if moored {
        octant_test_loop::instrument::dockside(&case)
    } else {
        (case.plant(), case.core())
    };
    let mut run = ClosedLoop::new(&plant, &core);
    run.run_to(DWELL - 1);
    run
}

/// Runs a clean calibration: static or dockside, six positions by the conventional method, or
/// eight.
fn clean(seed: u64, moored: bool, six: bool, hours: f64, hz: u64) -> ClosedLoop {
    let positions = if six { SIX } else { EIGHT };
    let mut case =
        InstrumentCase { calibration_h: hours, ..InstrumentCase::table_1(seed, positions) };
    case.g_states = !six;
    let (mut plant, mut core) = if moored {
        octant_test_loop::instrument::dockside(&case)
    } else {
        (case.plant(), case.core())
    };
    plant.sample_period_ns = 1_000_000_000 / hz;
    plant.calibration_samples = (hours * 3600.0 * hz as f64) as u64;
    core.sample_period_ns = plant.sample_period_ns;
    let mut run = ClosedLoop::new(&plant, &core);
    run.calibrate();
    run
}

fn assert_no_alarm(seeds: std::ops::RangeInclusive<u64>, hours: f64, hz: u64) {
    let cases: Vec<(u64, bool, bool)> = seeds
        .flat_map(|seed| {
            [(false, false), (true, false), (false, true), (true, true)].map(|(m, s)| (seed, m, s))
        })
        .collect();
    let runs = on_two_threads(&cases, |(seed, moored, six)| {
        let run = clean(*seed, *moored, *six, hours, hz);
        (run.health, run.output.mode, run.core.refusal().copied(), run.core.diagnostics().quality)
    });
    let mut largest = [0.0f64; 4];
    let mut failures = Vec::new();
    for ((seed, moored, six), (health, mode, refusal, quality)) in cases.iter().zip(runs) {
        let kind = usize::from(*moored) + 2 * usize::from(*six);
        largest[kind] = largest[kind].max(quality.drift_sigmas);
        if health.iter().sum::<u64>() != 0 || mode != Mode::Done || quality.bridged != 0 {
            failures.push(format!(
                "seed {seed}, moored {moored}, six {six}: {mode:?} {refusal:?} {health:?} {quality:?}"
            ));
        }
    }
    println!("largest correction: static {:.1}, dockside {:.1} of its σ", largest[0], largest[1]);
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// If no screen fires, the screens have no effect.
#[test]
fn a_clean_stream_is_answered_bit_for_bit_as_without_the_screens() {
    let case = InstrumentCase { calibration_h: 0.5, ..InstrumentCase::table_1(3, EIGHT) };
    let mut gated = case.core();
    gated.screening = Screening::gated(Recovery::Widening);
    let mut runs = [case.core(), gated].map(|config| ClosedLoop::new(&case.plant(), &config));
    for _ in 0..1800 * SECOND {
        let [a, b] = &mut runs;
        let (a, b) = (a.step(), b.step());
        assert_eq!((a.navigation, a.health), (b.navigation, b.health), "{}", a.sequence);
        assert_eq!(a.nis.to_bits(), b.nis.to_bits());
        assert_eq!((a.parameters_revision, a.mode), (b.parameters_revision, b.mode));
    }
    assert_eq!(runs[0].core.parameters(), runs[1].core.parameters());
    assert_eq!(runs[0].core.sigma(), runs[1].core.sigma());
}

#[test]
fn a_short_clean_run_raises_no_alarm() {
    assert_no_alarm(1..=1, 1.0, 200);
}

#[test]
#[ignore = "minutes: run by tests/run"]
fn twenty_clean_seeds_raise_no_alarm() {
    assert_no_alarm(1..=draws(5, 2), 4.0, 200);
    assert_no_alarm(6..=draws(20, 15), 4.0, 50);
}

#[test]
#[ignore = "minutes: run by tests/run"]
fn every_fault_is_ridden_out_or_refused() {
    try_all(1, false);
}

/// A ship's motion isn't known: a gap that can't be bridged is refused, and a slip of half a degree
/// is within its sway.
#[test]
#[ignore = "minutes: run by tests/run"]
fn on_a_moored_ship_too() {
    try_all(1, true);
}

fn try_all(seed: u64, moored: bool) {
    let faults = faults();
    let start = before(seed, moored);
    let clean = finish(start.clone(), What::Nothing, 0, 0);
    assert_eq!(clean.run.output.mode, Mode::Done);
    assert_eq!(clean.run.health, [0; 32]);
    let outcomes = on_two_threads(&faults, |fault| {
        finish(start.clone(), fault.what, fault.from, fault.samples)
    });
    let mut failures = Vec::new();
    for (fault, outcome) in faults.iter().zip(&outcomes) {
        let (sigmas, parameter) = shift(outcome, &clean);
        let quality = outcome.run.core.diagnostics().quality;
        let flags: Vec<String> = Health::all()
            .iter()
            .filter(|bit| outcome.first[bit.bits().trailing_zeros() as usize].is_finite())
            .map(|bit| {
                format!("{bit:?} {:.3} s", outcome.first[bit.bits().trailing_zeros() as usize])
            })
            .collect();
        let refused = outcome.run.core.refusal();
        println!(
            "{:36} {sigmas:8.3} {:20} {} recoveries {} bridged {} drift {:.1} | {}",
            fault.name,
            octant_sample::parameters::NAMES[parameter],
            refused.map_or("accepted".to_owned(), |refusal| format!("REFUSED: {refusal}")),
            quality.recoveries,
            quality.bridged,
            quality.drift_sigmas,
            flags.join(", "),
        );
        let good = match fault.expect {
            Expect::Below(limit) if !moored => sigmas < limit && refused.is_none(),
            Expect::Below(limit) => sigmas < limit.max(3.0) || refused.is_some(),
            Expect::RefusedOrBelow(limit) => sigmas < limit || refused.is_some(),
        };
        if !good {
            failures.push(format!("{}: {sigmas} σ, {refused:?}", fault.name));
        }
        let seen = |flag| !moored || flag != Health::GIMBAL_SLIPPED;
        if let Some((flag, within_s)) = fault.flag
            && seen(flag)
            && !(outcome.first[flag.bits().trailing_zeros() as usize] <= within_s)
        {
            failures.push(format!("{}: no {flag:?} within {within_s} s", fault.name));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
