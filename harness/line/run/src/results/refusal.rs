//! A refused calibration for its reader: what was seen, the likely causes with their evidence, and what to try.
//!
//! The reason of the core says which of its tests failed. What may have made it fail is in the run: faults that fired, the
//! twin without them, the core's reports, the sea, the instrument and what the filter was told of it.

use octant_calibration::config as core;
use octant_earth::units::{DEG, DEG_PER_HOUR, MICRO_G};
use octant_plant::config::AidingKind;
use octant_recorder::event::FaultResult;
use octant_sample::parameters::ParameterGroup;
use octant_scenario::{CalibrationSpec, MotionSpec, ParameterDistribution, Scenario, SourceSpec};
use octant_score::counterfactual::Counterfactual;
use octant_score::summary::HealthCounts;

/// Lowest rate at which the filter's sub-steps are those of faster samples, Hz.
const FULL_RATE_HZ: f64 = 20.0;
/// Ratio of an instrument's errors to the prior above which the prior is said to be too narrow.
const NARROW: f64 = 1.5;
/// A sway is larger than the noise that the filter takes it for from this ratio on.
const LARGE_SWAY: f64 = 1.2;

/// Test of the core that refused the calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seen {
    /// Innovations larger than their σ: NIS, rejections, recoveries, held parameters.
    Innovations,
    /// A correction larger than the parameter's uncertainty allows.
    Drift,
    /// A published σ above its limit.
    Uncertain,
    /// No reference.
    Reference,
    /// Samples missing or not believed.
    Samples,
    /// A disturbance that could not be undone, or angles of gimbals that contradict the gyros.
    Disturbance,
    /// Another reason, or that of a unit of someone else.
    Other,
}

/// Parts of the core's reasons, and the tests that they are of.
const REASONS: [(&str, Seen); 12] = [
    ("recoveries held the parameters", Seen::Innovations),
    ("had to recover", Seen::Innovations),
    ("measurements were rejected", Seen::Innovations),
    ("the innovations contradict the tuning", Seen::Innovations),
    ("drifted: between", Seen::Drift),
    ("(1 sigma) at the end, and at most", Seen::Uncertain),
    ("measurements of the reference came", Seen::Reference),
    ("missing, stuck or not to be believed", Seen::Samples),
    ("could not be undone", Seen::Disturbance),
    ("contradict the gyros", Seen::Disturbance),
    ("mean NIS of the gimbal angles", Seen::Disturbance),
    ("the mean NIS of", Seen::Innovations),
];

impl Seen {
    /// The test of a reason.
    #[must_use]
    pub fn of(reason: &str) -> Self {
        REASONS
            .iter()
            .find(|(part, _)| reason.contains(part))
            .map_or(Self::Other, |(_, seen)| *seen)
    }

    /// Meaning in a sentence.
    fn meaning(self) -> Option<&'static str> {
        Some(match self {
            Self::Innovations => {
                "navigation and reference differed by more than the filter can explain with the noise and the errors that it is told of"
            }
            Self::Drift => {
                "a parameter that should be constant changed, or something other than noise was taken for it"
            }
            Self::Uncertain => {
                "too little was learned, or it was forgotten again after a disturbance"
            }
            Self::Reference => "the filter had nothing to measure against",
            Self::Samples => "too much of the motion was filled in instead of measured",
            Self::Disturbance => {
                "the body was disturbed in a way after which it isn't known what the parameters have learned from it"
            }
            Self::Other => return None,
        })
    }
}

/// A likely cause with its evidence, and what to try.
struct Cause {
    evidence: String,
    advice: &'static str,
}

/// Run whose calibration was refused, with the data that may show why.
#[derive(Clone, Copy, Debug)]
pub struct RefusedRun<'a> {
    /// Reason that the core gave.
    pub reason: &'a str,
    /// Counts of the core's reports.
    pub health: &'a HealthCounts,
    /// Receipts of the faults.
    pub faults: &'a [FaultResult],
    /// Comparison with the twin, if there is one.
    pub twin: Option<&'a Counterfactual>,
    /// Scenario.
    pub scenario: &'a Scenario,
    /// Plan of the calibration.
    pub plan: &'a CalibrationSpec,
}

/// Explains a refusal, a line for each of: what was seen, the likely causes in their order, what to try.
#[must_use]
pub fn explained(run: &RefusedRun<'_>) -> Vec<String> {
    let seen = Seen::of(run.reason);
    let mut lines: Vec<String> =
        seen.meaning().map(|meaning| format!("this means: {meaning}")).into_iter().collect();
    let causes = causes(run, seen);
    if causes.is_empty() && seen == Seen::Uncertain {
        lines.push(
            "likely cause: the calibration is too short for this instrument to be known as well as the limit asks".to_owned(),
        );
        lines.push(
            "  try: a longer calibration, or another limit in [procedure.calibration.refuse_above_sigma]".to_owned(),
        );
    } else if causes.is_empty() && seen != Seen::Other {
        lines.push(
            "likely cause: none shows in the scenario or in the core's reports; compare the data with the site, the axes and \
             the noise that the scenario states"
                .to_owned(),
        );
    }
    for (number, cause) in causes.iter().enumerate() {
        lines.push(format!("likely cause {}: {}", number + 1, cause.evidence));
        lines.push(format!("  try: {}", cause.advice));
    }
    lines
}

/// Likely causes, the likeliest first.
fn causes(run: &RefusedRun<'_>, seen: Seen) -> Vec<Cause> {
    let of_motion = [sea(run), aiding(run), instrument(run), prior(run), rate(run)];
    let of_data = [samples(run), gimbals(run), recorded(run)];
    let (first, second): (Vec<_>, Vec<_>) = match seen {
        Seen::Samples => (of_data.into(), Vec::new()),
        Seen::Disturbance => (of_data.into(), of_motion.into()),
        Seen::Reference => ([aiding(run)].into(), Vec::new()),
        Seen::Drift => ([instrument(run), prior(run), sea(run), rate(run)].into(), of_data.into()),
        Seen::Innovations | Seen::Uncertain => (of_motion.into(), of_data.into()),
        Seen::Other => (Vec::new(), Vec::new()),
    };
    let fault = faults(run);
    if fault.is_some() && run.twin.is_some() {
        // The rest is what the fault did.
        return fault.into_iter().collect();
    }
    let recovered = recoveries(run).filter(|_| seen == Seen::Uncertain);
    fault.into_iter().chain(recovered).chain(first.into_iter().chain(second).flatten()).collect()
}

/// Faults that fired, unless the twin without them was refused too.
fn faults(run: &RefusedRun<'_>) -> Option<Cause> {
    let fired: Vec<String> = run
        .faults
        .iter()
        .filter(|fault| fault.fired)
        .map(|fault| format!("{} ({})", fault.id, fault.kind))
        .collect();
    if fired.is_empty() || run.twin.is_some_and(|twin| !twin.refused) {
        return None;
    }
    let twin = match run.twin {
        Some(_) => ": the twin without it was published, so this is the cause",
        None => ", and no twin tells what happens without it",
    };
    Some(Cause {
        evidence: format!("a fault of the scenario fired, {}{twin}", fired.join(", ")),
        advice: "octant faults minimise, where there are several; nothing, where the refusal is what the fault is to show",
    })
}

/// Recoveries, which open the attitude.
fn recoveries(run: &RefusedRun<'_>) -> Option<Cause> {
    let HealthCounts { recoveries, jumps, .. } = *run.health;
    (recoveries > 0 || jumps > 0).then(|| Cause {
        evidence: format!(
            "the filter recovered {recoveries} times and met {jumps} epochs with jumps: each opens the attitude, which takes time to be \
             learned again"
        ),
        advice: "a calibration without the disturbance, or a longer one that rests after it",
    })
}

fn kalman<'a>(run: &RefusedRun<'a>) -> Option<&'a core::Kalman> {
    match &run.plan.estimator {
        core::Estimator::Kalman(kalman) => Some(kalman),
        _ => None,
    }
}

/// A ship whose sway the filter isn't told of, or whose sway is larger than it is told.
fn sea(run: &RefusedRun<'_>) -> Option<Cause> {
    let MotionSpec::Dockside(ship) = &run.scenario.motion else { return None };
    let kalman = kalman(run)?;
    // Variance of the largest of surge, sway and heave.
    let variance = |axis: usize| -> f64 {
        let parts: f64 =
            ship.components[axis].iter().map(|part| 0.5 * part.amplitude.powi(2)).sum();
        parts + ship.spectrum.map_or(0.0, |spectrum| spectrum.sigma[axis].powi(2))
    };
    let rms_m = (3..6).map(variance).fold(0.0, f64::max).sqrt();
    match (run.scenario.aiding.kind, kalman.aiding) {
        (AidingKind::ZeroVelocity { .. }, _) => Some(Cause {
            evidence: format!(
                "the ship moves, by {rms_m:.2} m rms on its largest axis, and aiding.reference = \"zero-velocity\" tells the filter \
                 that it stands still"
            ),
            advice: "procedure.calibration.aiding.reference = \"dock-position\"",
        }),
        (_, core::AidingMode::Position { sigma_m })
            if kalman.sway == core::SwayNoise::White && rms_m > LARGE_SWAY * sigma_m =>
        {
            Some(Cause {
                evidence: format!(
                    "the ship moves by {rms_m:.2} m rms on its largest axis, and aiding.sigma takes that for white noise of \
                     {sigma_m:.2} m"
                ),
                advice: "procedure.calibration.aiding.sway = \"coloured\"",
            })
        }
        _ => None,
    }
}

/// A reference that didn't come, or came late.
fn aiding(run: &RefusedRun<'_>) -> Option<Cause> {
    let HealthCounts { aiding_lost, aiding_stale, .. } = *run.health;
    if aiding_lost == 0 && aiding_stale == 0 {
        return None;
    }
    Some(Cause {
        evidence: format!(
            "the reference was missing in {aiding_lost} epochs, and had the stamp of another sample in {aiding_stale}"
        ),
        advice: "the source of the reference, and procedure.calibration.aiding.period",
    })
}

/// Errors of the instrument for which the filter has no states.
fn instrument(run: &RefusedRun<'_>) -> Option<Cause> {
    let more = &run.scenario.imu.extensions;
    let mut found = Vec::new();
    if more.gyro_bias_instability > 0.0 {
        found.push(format!(
            "gyro bias instability {:.3} deg/h",
            more.gyro_bias_instability / DEG_PER_HOUR
        ));
    }
    if more.accel_bias_instability > 0.0 {
        found.push(format!(
            "accelerometer bias instability {:.1} ug",
            more.accel_bias_instability / MICRO_G
        ));
    }
    let further = kalman(run).map(|kalman| kalman.further).unwrap_or_default();
    let known = |group| further.of(group) != core::FurtherUse::Off;
    use octant_sample::further::FurtherGroup as Of;
    if more.gyro_gauss_markov.is_some() && !known(Of::GyroGaussMarkov) {
        found.push("a Gauss-Markov bias of the gyros".to_owned());
    }
    if more.accel_gauss_markov.is_some() && !known(Of::AccelGaussMarkov) {
        found.push("a Gauss-Markov bias of the accelerometers".to_owned());
    }
    if more.gyro_rate_random_walk > 0.0 && further.gyro_rate_random_walk == 0.0 {
        found.push("a rate random walk of the gyros".to_owned());
    }
    if more.temperature.is_some() && !further.follows_temperature() {
        found.push("errors that follow the temperature".to_owned());
    }
    (!found.is_empty()).then(|| Cause {
        evidence: format!("the instrument has {}, and the filter has no state for it", found.join(", ")),
        advice: "[procedure.calibration.further] where it has such a group, a shorter calibration, or the instrument without it",
    })
}

/// Errors that are drawn far larger than the filter's prior.
fn prior(run: &RefusedRun<'_>) -> Option<Cause> {
    let kalman = kalman(run)?;
    if !matches!(run.scenario.source, SourceSpec::Plant) {
        return None;
    }
    let narrow: Vec<String> = ParameterGroup::ALL
        .into_iter()
        .zip(&run.scenario.parameters)
        .filter_map(|(group, distribution)| {
            let size = match distribution {
                ParameterDistribution::Normal(sigma) => *sigma,
                ParameterDistribution::Uniform(half) => half / 3.0_f64.sqrt(),
                ParameterDistribution::Constant(values) => {
                    values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs())) / 3.0
                }
            };
            let prior = kalman.prior.of(group);
            let show =
                |value: f64| octant_base::number::significant(value / group.si_per_unit(), 3);
            (size > NARROW * prior).then(|| {
                format!(
                    "{} of {} {} against {}",
                    group.name(),
                    show(size),
                    group.unit(),
                    show(prior)
                )
            })
        })
        .collect();
    (!narrow.is_empty()).then(|| Cause {
        evidence: format!(
            "the instrument's errors are larger than the filter's prior says, 1 sigma: {}",
            narrow.join(", ")
        ),
        advice: "[procedure.calibration.prior] with the sizes of the instrument, or imu.model, which sets both",
    })
}

/// A rate at which a move turns the body far in one sample.
fn rate(run: &RefusedRun<'_>) -> Option<Cause> {
    let rate_hz = 1e9 / run.scenario.sample_period_ns as f64;
    (rate_hz < FULL_RATE_HZ).then(|| Cause {
        evidence: format!(
            "imu.rate is {rate_hz} Hz: a move turns the body by up to {:.2} deg in one sample",
            run.scenario.turntable.rate_radps / rate_hz / DEG
        ),
        advice: "imu.rate = \"20 Hz\" or more",
    })
}

/// Samples that didn't come or weren't believed.
fn samples(run: &RefusedRun<'_>) -> Option<Cause> {
    let health = run.health;
    let found: Vec<String> = [
        (health.gaps, "gaps"),
        (health.out_of_order, "samples out of order"),
        (health.gyro_stuck, "epochs with a stuck gyro"),
        (health.accelerometer_stuck, "epochs with a stuck accelerometer"),
        (health.jumps, "epochs with jumps"),
    ]
    .into_iter()
    .filter(|(count, _)| *count > 0)
    .map(|(count, what)| format!("{count} {what}"))
    .collect();
    (!found.is_empty()).then(|| Cause {
        evidence: format!("the core reported {}", found.join(", ")),
        advice: "the connection and the instrument at those times: octant watch, or the reports on the page of the run",
    })
}

/// Gimbals that weren't where they were sent, or slipped.
fn gimbals(run: &RefusedRun<'_>) -> Option<Cause> {
    let HealthCounts { gimbal_slips, gimbal_disagrees, .. } = *run.health;
    (gimbal_slips > 0 || gimbal_disagrees > 0).then(|| Cause {
        evidence: format!(
            "gyros and encoders showed different turns in {gimbal_slips} epochs, and the encoders weren't at the set point in \
             {gimbal_disagrees}"
        ),
        advice: "clamps, belts and couplings of the gimbals, and their commands; then calibrate again",
    })
}

/// Data that don't come from a simulation.
fn recorded(run: &RefusedRun<'_>) -> Option<Cause> {
    (!matches!(run.scenario.source, SourceSpec::Plant)).then(|| Cause {
        evidence: "the samples are no simulation of this scenario: axes, units, site or noise may be others than it states"
            .to_owned(),
        advice: "octant characterise for the noise, and source, site and imu of the scenario",
    })
}
