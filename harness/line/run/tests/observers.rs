//! Each observer of a run sees its own subject, and no more than it says.

use octant_plant::Truth;
use octant_run::Observers;
use octant_run::observers::done::PlannedWork;
use octant_sample::parameters::{PARAMETER_COUNT, ParameterEstimate};
use octant_sample::{
    Aiding, DeviceTime, Epoch, Health, Mode, Navigation, Output, Parameters, Reference, Sample,
};
use octant_score::work::Work;

/// 10 Hz.
const PERIOD_NS: u64 = 100_000_000;

fn sent(number: u64) -> Epoch {
    let device_time = DeviceTime::from_ns(number * PERIOD_NS);
    Epoch {
        sample: Sample { sequence: number, device_time, ..Sample::default() },
        ..Epoch::default()
    }
}

/// An answer that keeps the rules; its position moves, as that of a unit with noise does.
fn answer(number: u64, mode: Mode) -> Output {
    Output {
        sequence: number,
        device_time: DeviceTime::from_ns(number * PERIOD_NS),
        mode,
        navigation: Navigation {
            latitude_rad: 0.5 + number as f64 * 1e-9,
            q_nb: [1.0, 0.0, 0.0, 0.0],
            ..Navigation::default()
        },
        nis: f64::NAN,
        ..Output::default()
    }
}

fn observers() -> Observers {
    Observers::new(PlannedWork::default())
}

fn planned(work: Work) -> Observers {
    let mut plan = PlannedWork::default();
    plan.work = work;
    Observers::new(plan)
}

fn take(observers: &mut Observers, number: u64, output: &Output, truth: Option<&Truth>) {
    let sent = sent(number);
    observers.source(&sent);
    if observers.answer(&sent, false, output)
        && let Some(truth) = truth
    {
        observers.truth(output, truth);
    }
}

fn truth() -> Truth {
    Truth { latitude_rad: 0.5, q_nb: [1.0, 0.0, 0.0, 0.0], ..Truth::default() }
}

#[test]
fn the_first_broken_rule_is_kept_and_nothing_after_it_counts() {
    let mut observers = observers();
    take(&mut observers, 1, &answer(1, Mode::Calibrating), None);
    take(&mut observers, 2, &answer(7, Mode::Calibrating), None);
    take(&mut observers, 3, &answer(9, Mode::Navigating), None);
    let first = observers.answers.misbehaved.clone().unwrap();
    assert_eq!((first.sample, first.field.as_str()), (2, "sequence"), "{first}");
    assert_eq!(observers.last_mode(), Mode::Calibrating);
    let estimate = ParameterEstimate {
        revision: 1,
        parameters: Parameters::default(),
        sigma: [1.0; PARAMETER_COUNT],
    };
    observers.parameters(&answer(3, Mode::Calibrating), &estimate);
    assert!(observers.convergence.last.is_none());
}

#[test]
fn after_the_bench_broke_its_limits_answers_are_not_judged() {
    let mut observers = observers();
    observers.answers.bench_broke(2_000_000_000, "late".to_owned());
    observers.answers.bench_broke(3_000_000_000, "later".to_owned());
    take(&mut observers, 2, &answer(7, Mode::Calibrating), None);
    assert_eq!(observers.answers.misbehaved, None);
    let broke = observers.answers.bench_broke.unwrap();
    assert_eq!((broke.at_s, broke.reason.as_str()), (2.0, "late"));
}

#[test]
fn references_count_until_the_calibration_ends_and_a_restart_begins_anew() {
    let work = Work {
        calibration_s: Some(10.0),
        references: Some(100),
        navigation_s: Some(5.0),
        ..Work::default()
    };
    let mut observers = planned(work);
    let run = |observers: &mut Observers, from: u64| {
        for number in from..from + 150 {
            let mode = if number < from + 100 { Mode::Calibrating } else { Mode::Navigating };
            let mut epoch = sent(number);
            let (device_time, reference) =
                (epoch.sample.device_time, Reference::Velocity([0.0; 3]));
            epoch.aiding = Some(Aiding { device_time, reference });
            observers.source(&epoch);
            observers.answer(&epoch, false, &answer(number, mode));
        }
    };
    run(&mut observers, 1);
    let (planned, done) = observers.done.planned_and_done();
    assert_eq!(
        (planned, done.references),
        (work, Some(101)),
        "the last one comes before its answer"
    );
    assert!((done.navigation_s.unwrap() - 4.9).abs() < 1e-9, "{done:?}");
    observers.restarted();
    run(&mut observers, 151);
    assert_eq!(observers.done.work().references, Some(101));
}

#[test]
fn the_last_navigation_is_scored_and_time_that_runs_back_is_left_out() {
    let mut observers = observers();
    let truth = truth();
    for number in 1..=100 {
        take(&mut observers, number, &answer(number, Mode::Navigating), Some(&truth));
    }
    let mut back = answer(101, Mode::Navigating);
    back.device_time = DeviceTime::from_ns(5 * PERIOD_NS);
    let mut epoch = sent(101);
    epoch.sample.device_time = back.device_time;
    assert!(observers.answer(&epoch, true, &back), "time has run back by more than a second");
    observers.truth(&back, &truth);
    let drift = observers.drift.scored().unwrap().clone();
    let score = drift.finish(octant_score::summary::HeightChannel::Held).unwrap();
    // Once a second from 0.1 s on; the error grows by 1e-9 rad with each sample.
    assert_eq!(observers.drift.start_h(), Some(0.1 / 3600.0));
    assert!((score.duration_h * 3600.0 - 9.9).abs() < 1e-9, "{}", score.duration_h);
    let last_arcmin = observers.drift.solution.points(0);
    assert!(!last_arcmin.is_empty());
    // A unit that restarts navigates anew.
    observers.restarted();
    take(&mut observers, 201, &answer(201, Mode::Aligning), None);
    for number in 202..=230 {
        take(&mut observers, number, &answer(number, Mode::Navigating), Some(&truth));
    }
    let anew = observers.drift.scored().unwrap().clone();
    let score = anew.finish(octant_score::summary::HeightChannel::Held).unwrap();
    assert!((score.duration_h * 3600.0 - 2.8).abs() < 1e-9, "{}", score.duration_h);
}

#[test]
fn convergence_has_as_many_points_as_a_report_draws_and_the_last_estimate() {
    let work = Work { calibration_s: Some(400.0), ..Work::default() };
    let mut observers = planned(work);
    for number in 1..=4000_u32 {
        let parameters =
            Parameters { gyro_bias: [f64::from(number) * 1e-9; 3], ..Parameters::default() };
        let estimate =
            ParameterEstimate { revision: number, parameters, sigma: [1.0; PARAMETER_COUNT] };
        let output =
            Output { parameters_revision: number, ..answer(number.into(), Mode::Calibrating) };
        observers.parameters(&output, &estimate);
    }
    let points = &observers.convergence.points;
    assert_eq!(points.len(), 400, "one a second");
    assert!(
        points.windows(2).all(|two| (two[1].hours - two[0].hours - 1.0 / 3600.0).abs() < 1e-12)
    );
    assert_eq!(observers.convergence.last.unwrap().revision, 4000);
}

#[test]
fn of_many_measurements_some_are_drawn_and_every_rejected_one() {
    let mut observers = observers();
    for number in 1..=120_000_u64 {
        let rejected = number % 10_000 == 0;
        let health = if rejected { Health::INNOVATION_REJECTED } else { Health::empty() };
        let nis = if rejected { 30.0 } else { 3.0 };
        observers.epoch(&Output { nis, health, ..answer(number, Mode::Calibrating) });
    }
    let drawn = &observers.measurements.nis;
    assert!(drawn.len() <= 50_001, "{}", drawn.len());
    // Dropping every second point drops rejected ones too; those since are whole.
    let late = drawn.iter().filter(|point| point.nis == 30.0 && point.hours > 2.6).count();
    assert!(late >= 2, "{late}");
    assert_eq!(observers.measurements.health.counts().rejected, 12);
    assert_eq!(observers.measurements.events().len(), 12);
}

#[test]
fn gimbals_are_drawn_at_the_ends_of_moves_and_once_a_minute() {
    let mut observers = observers();
    for number in 1..=3000_u64 {
        let moving = (1000..1090).contains(&number);
        let mut output = Output { moving, stop: 1, ..answer(number, Mode::Calibrating) };
        if number >= 1000 {
            output.gimbal_command.target.azimuth = 1 << 27;
        }
        observers.epoch(&output);
    }
    let points = &observers.gimbals.points;
    let at_s: Vec<f64> =
        points.iter().map(|point| (point.hours * 36000.0).round() / 10.0).collect();
    assert_eq!(at_s, [0.1, 60.1, 100.0, 109.0, 169.0, 229.0, 289.0]);
    // While they move they are drawn where they were.
    let degrees: Vec<f64> = points.iter().map(|point| point.azimuth_deg.round()).collect();
    assert_eq!(degrees, [0.0, 0.0, 0.0, 57.0, 57.0, 57.0, 57.0]);
    assert!(points.iter().all(|point| point.stop == Some(1)));
}

#[test]
fn maxima_are_over_every_answer_and_never_against_a_truth_that_moved_on() {
    let mut observers = observers();
    let navigate = |number: u64| answer(number, Mode::Navigating);
    let truth_at = |latitude_rad: f64| Truth { latitude_rad, ..truth() };
    // Asks for the truth as a run does; the truth stands from number 31 on, 1e-5 rad further.
    let mut asked = Vec::new();
    for number in 1..=60u64 {
        let further = 1e-5 * number.clamp(11, 31) as f64;
        let mut output = navigate(number);
        output.navigation.latitude_rad += further;
        if number == 45 {
            output.navigation.latitude_rad += 1e-3;
        }
        let sent = sent(number);
        observers.source(&sent);
        let due = observers.answer(&sent, true, &output);
        let stands = Some(!(12..=31).contains(&number));
        let between = observers.between(&output, || stands);
        assert!(!(due && between), "{number}");
        if due {
            observers.truth(&output, &truth_at(0.5 + further));
        } else if between {
            asked.push(number);
            observers.truth_between(&output, &truth_at(0.5 + further), stands);
        }
    }
    // Where the truth moves by more than the step that is looked at, every answer is compared.
    assert!((12..=31).filter(|n| n % 10 != 0).all(|n| asked.contains(&n)), "{asked:?}");
    assert!(asked.iter().all(|n| (12..=31).contains(n)), "{asked:?}");
    let score = observers.drift.scored().unwrap();
    let score = score.finish(octant_score::summary::HeightChannel::Held).unwrap();
    let arcmin = score.latitude_error_arcmin.unwrap().max * std::f64::consts::PI / 180.0 / 60.0;
    assert!((arcmin - 1e-3).abs() < 1e-7, "{arcmin}");
    let rms = score.latitude_error_arcmin.unwrap().rms * std::f64::consts::PI / 180.0 / 60.0;
    assert!(rms < 1e-7, "the answer between two seconds is in the maximum alone: {rms}");
}
