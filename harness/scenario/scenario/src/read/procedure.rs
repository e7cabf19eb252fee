//! The core's procedure: alignment, the methods of calibration, navigation, screening.

use super::further::further;
use super::reader::Reader;
use super::sequence::{self, from_degrees, stops};
use crate::error::Problem;
use crate::keys::{
    AidingKeys, AlignmentKeys, AlignmentMethod, At, CalibrationKeys, EstimatorName, FromTable,
    GateKeys, InitialKeys, Intervals, LeastSquaresKeys, NavigationKeys, ProcedureKeys, Raw,
    Reference, Rotation, ScreeningKeys, SigmaLimitKeys, key,
};
use crate::model::{AlignmentSpec, CalibrationSpec, MotionSpec, case_attitude};
use crate::quantity::{self, UnitDimension};
use octant_calibration::config as core;
use octant_calibration::inertial_alignment::SHORTEST_S;
use octant_calibration::positions;
use octant_calibration::sequence::{Sequence, Stop};
use octant_calibration::table::CalibrationTable;
use octant_plant::config as plant;
use octant_sample::Parameters;
use octant_sample::parameters::{PARAMETER_COUNT, ParameterGroup};
use octant_toml_tree::{Node, Table, Value};
use std::path::Path;

/// Properties of the run that the procedure must fit.
pub(super) struct Setting<'a> {
    pub(super) sample_period_ns: u64,
    pub(super) sample_rate_hz: f64,
    pub(super) motion: &'a MotionSpec,
    pub(super) turntable: &'a plant::TurntableConfig,
    /// True if the source never ends, unlike a recording.
    pub(super) endless: bool,
    /// Folder from which relative file names start.
    pub(super) folder: &'a Path,
}

pub(super) struct Procedure {
    pub(super) alignment: AlignmentSpec,
    pub(super) initial_parameters: Parameters,
    pub(super) calibration: Option<CalibrationSpec>,
    pub(super) aiding: plant::AidingSource,
    pub(super) navigation: Option<core::NavigationPlan>,
}

pub(super) fn procedure(keys: &ProcedureKeys, setting: &Setting<'_>) -> Result<Procedure, Problem> {
    let of_calibration = keys.calibration.as_ref();
    let calibration = of_calibration.map(|keys| calibration(keys, setting)).transpose()?;
    let aiding = match of_calibration {
        Some(keys) => aiding(&keys.aiding, setting)?.source,
        None => plant::AidingSource {
            kind: plant::AidingKind::ZeroVelocity { sigma_mps: 1e-3 },
            period_ns: setting.sample_period_ns,
        },
    };
    let navigation = keys.navigation.as_ref();
    let navigation = navigation.map(|keys| self::navigation(keys, setting)).transpose()?;
    if calibration.is_none() && navigation.is_none() {
        return Err(keys.calibration.problem(
            "found neither procedure.calibration nor procedure.navigation, expected one at least",
        ));
    }
    let initial = keys.initial_parameters.as_ref();
    Ok(Procedure {
        alignment: alignment(&keys.alignment, calibration.as_ref())?,
        initial_parameters: initial.map_or_else(
            || Ok(Parameters::default()),
            |keys| initial_parameters(keys, setting.folder),
        )?,
        calibration,
        aiding,
        navigation,
    })
}

fn alignment(
    keys: &AlignmentKeys,
    calibration: Option<&CalibrationSpec>,
) -> Result<AlignmentSpec, Problem> {
    if *keys.method == AlignmentMethod::Given {
        return Ok(AlignmentSpec::Given {
            tilt_rad: keys.tilt,
            azimuth_rad: keys.azimuth,
            velocity_mps: keys.velocity,
            attitude_error_rad: keys.attitude_error,
            velocity_error_mps: keys.velocity_error,
        });
    }
    let duration_s = *keys.duration;
    // With intervals detected in recorded data no first stop is commanded: the first interval tells where
    // the instrument stands.
    let commanded = calibration.filter(|calibration| {
        !matches!(
            calibration.estimator,
            core::Estimator::LeastSquares(core::LeastSquares {
                intervals: core::StaticIntervals::Detected { .. },
                ..
            })
        )
    });
    if let Some(calibration) = commanded {
        let first_s = calibration.dwell_s * calibration.sequence.stops()[0].weight;
        if duration_s > first_s {
            return Err(keys.duration.problem(format!(
                "found {duration_s} s, but the first stop is held for {first_s:.1} s alone"
            )));
        }
    }
    if *keys.method == AlignmentMethod::Coarse {
        return Ok(AlignmentSpec::Coarse { duration_s });
    }
    if duration_s < SHORTEST_S {
        return Err(keys.duration.problem(format!(
            "found {:?}, expected {SHORTEST_S} s at least with method = \"inertial\"",
            keys.duration.text
        )));
    }
    Ok(AlignmentSpec::Inertial { duration_s })
}

fn initial_parameters(keys: &InitialKeys, folder: &Path) -> Result<Parameters, Problem> {
    let groups = [
        &keys.gyro_bias,
        &keys.gyro_scale,
        &keys.gyro_misalignment,
        &keys.g_dependent,
        &keys.accel_bias,
        &keys.accel_scale,
        &keys.accel_misalignment,
    ];
    if let Some(file) = &*keys.table {
        if let Some(group) = groups.into_iter().find(|group| group.is_some()) {
            return Err(group.problem("found beside table, expected one of them"));
        }
        let path = folder.join(file);
        let bytes = std::fs::read(&path)
            .map_err(|error| keys.table.problem(format!("read {}: {error}", path.display())))?;
        let read = CalibrationTable::from_bytes(&bytes)
            .map_err(|error| keys.table.problem(format!("read {}: {error}", path.display())))?;
        return Ok(read.parameters);
    }
    let mut all = [0.0; PARAMETER_COUNT];
    for (group, values) in ParameterGroup::ALL.into_iter().zip(groups) {
        if let Some(values) = &**values {
            all[group.range()].copy_from_slice(values);
        }
    }
    Ok(Parameters::from_array(&all))
}

/// Reads the second method: the keys of the first one, replaced by those of `[baseline]`.
pub(super) fn baseline(
    baseline: &At<Option<Raw>>,
    document: &Table,
    first: &At<Option<CalibrationKeys>>,
    setting: &Setting<'_>,
) -> Result<Option<CalibrationSpec>, Problem> {
    let Some(Raw { table: overrides, .. }) = &**baseline else { return Ok(None) };
    let Some(Node { value: Value::Table(primary), .. }) = document.at(key!(procedure.calibration))
    else {
        let message = "found without procedure.calibration, which it is compared with";
        return Err(baseline.problem(message));
    };
    if overrides.get("positions").is_some() && overrides.get("stops").is_some() {
        return Err(baseline.problem("found positions and stops, expected one of them"));
    }
    let mut merged: Table = primary.clone();
    // A name belongs to its stops: another sequence doesn't inherit it.
    for (given, replaced) in [("positions", ["stops", "name"]), ("stops", ["positions", "name"])] {
        if overrides.get(given).is_some() {
            replaced.into_iter().for_each(|key| merged.remove(key));
        }
    }
    for entry in &overrides.entries {
        merged.set(&entry.key, entry.node.clone());
    }
    // The shared keys were already read with the first method, so a problem here belongs to the
    // baseline.
    let second = CalibrationKeys::of(&Reader::new(&merged, &baseline.path, &baseline.place))?;
    if let Some(first) = &**first {
        sequence::check_names(first, &second)?;
    }
    calibration(&second, setting).map(Some)
}

fn calibration(keys: &CalibrationKeys, setting: &Setting<'_>) -> Result<CalibrationSpec, Problem> {
    let passes = keys.passes;
    let (name, sequence) = sequence::of(keys)?;
    let duration_s = *keys.duration;
    if samples_of(duration_s, setting).is_none() {
        return Err(not_whole(&keys.duration, setting));
    }
    let aiding = aiding(&keys.aiding, setting)?;
    let further = further(keys, setting.motion)?;
    let estimator = match *keys.estimator {
        EstimatorName::Kalman => core::Estimator::Kalman(kalman(keys, &aiding, further)?),
        EstimatorName::LeastSquares => {
            core::Estimator::LeastSquares(least_squares(&keys.least_squares))
        }
        EstimatorName::ExternalTurntable => {
            core::Estimator::ExternalTurntable(external_turntable(keys, setting)?)
        }
    };
    let moves_s = moves_s(&sequence, setting.turntable);
    let weights: f64 =
        sequence.stops().iter().map(|stop| stop.weight).sum::<f64>() * f64::from(passes);
    let dwell_s = (duration_s - moves_s) / weights;
    let shortest_s = aiding.source.period_ns as f64 * 1e-9;
    if dwell_s < shortest_s {
        return Err(keys.duration.problem(format!(
            "found {duration_s} s, of which the moves of {passes} pass(es) of {} stops take \
             {moves_s:.1} s: {:.1} s is left for dwells of {weights} weights, {dwell_s:.2} s \
             each; expected {shortest_s} s each at least, the period of the aiding, that is a \
             duration of {} s or more",
            sequence.stops().len(),
            duration_s - moves_s,
            (moves_s + weights * shortest_s).ceil(),
        )));
    }
    Ok(CalibrationSpec { name, sequence, duration_s, dwell_s, estimator })
}

fn not_whole<T>(time: &At<T>, setting: &Setting<'_>) -> Problem {
    let (found, period_ns) = (&time.text, setting.sample_period_ns);
    time.problem(format!(
        "found {found:?}, expected a multiple of the sample period, {period_ns} ns"
    ))
}

/// Number of samples in a time, if it is a multiple of the sample period.
fn samples_of(time_s: f64, setting: &Setting<'_>) -> Option<u64> {
    let samples = time_s * setting.sample_rate_hz;
    let is_whole = samples >= 0.5 && (samples - samples.round()).abs() <= 1e-3;
    // Counted by the period, as the core counts them.
    let period_ns = setting.sample_period_ns;
    is_whole.then(|| ((time_s * 1e9).round() as u64).saturating_add(period_ns / 2) / period_ns)
}

/// Total duration of the moves of all passes, s: both gimbals turn together, with a trapezoidal rate
/// profile. Between two passes the gimbals return to the first stop.
fn moves_s(sequence: &Sequence, turntable: &plant::TurntableConfig) -> f64 {
    let turn_s = |angle_rad: f64| {
        let (rate, acceleration) = (turntable.rate_radps, turntable.acceleration_radps2);
        if angle_rad * acceleration >= rate * rate {
            angle_rad / rate + rate / acceleration
        } else {
            2.0 * libm::sqrt(angle_rad / acceleration)
        }
    };
    let move_s = |from: &Stop, to: &Stop| {
        let azimuth_s = turn_s((to.azimuth_rad - from.azimuth_rad).abs());
        azimuth_s.max(turn_s((to.roll_rad - from.roll_rad).abs()))
    };
    let stops = sequence.stops();
    let passes = f64::from(sequence.passes());
    let pass_s: f64 = stops.windows(2).map(|pair| move_s(&pair[0], &pair[1])).sum();
    let start_s = move_s(&Stop::default(), &stops[0]);
    start_s + passes * pass_s + (passes - 1.0) * move_s(&stops[stops.len() - 1], &stops[0])
}

struct Aiding {
    source: plant::AidingSource,
    mode: core::AidingMode,
    sway: core::SwayNoise,
}

/// Longest period of the reference for a filter that estimates the sway, s.
const SWAY_PERIOD_MAX_S: f64 = 2.0;

fn aiding(keys: &AidingKeys, setting: &Setting<'_>) -> Result<Aiding, Problem> {
    let samples = samples_of(*keys.period, setting);
    let samples = samples.ok_or_else(|| not_whole(&keys.period, setting))?;
    let period_ns = samples * setting.sample_period_ns;
    let dimension = match *keys.reference {
        Reference::DockPosition => UnitDimension::LENGTH,
        Reference::ZeroVelocity | Reference::Velocity => UnitDimension::VELOCITY,
    };
    for key in [&keys.sigma, &keys.noise] {
        if !quantity::parse(&key.text).is_ok_and(|quantity| quantity.is(dimension)) {
            return Err(key.problem(format!(
                "found {:?}, expected {} such as \"{}\" with reference = {:?}",
                key.text, dimension.name, dimension.example, keys.reference.text
            )));
        }
    }
    let (sigma, noise) = (*keys.sigma, *keys.noise);
    let (kind, mode) = match *keys.reference {
        Reference::DockPosition => (
            plant::AidingKind::DockPosition { sigma_m: noise },
            core::AidingMode::Position { sigma_m: sigma },
        ),
        Reference::Velocity => (
            plant::AidingKind::Velocity { sigma_mps: noise },
            core::AidingMode::Velocity { sigma_mps: sigma },
        ),
        Reference::ZeroVelocity => (
            plant::AidingKind::ZeroVelocity { sigma_mps: noise },
            core::AidingMode::Velocity { sigma_mps: sigma },
        ),
    };
    if *keys.sway == core::SwayNoise::Coloured {
        if *keys.reference != Reference::DockPosition {
            return Err(keys.sway.problem(format!(
                "found \"coloured\" with reference = {:?}, expected \"white\", or reference = \"dock-position\"",
                keys.reference.text
            )));
        }
        if *keys.period > SWAY_PERIOD_MAX_S {
            return Err(keys.period.problem(format!(
                "found {:?} with sway = \"coloured\", expected {SWAY_PERIOD_MAX_S} s at most: a sway has to be seen \
                 more than twice a period",
                keys.period.text
            )));
        }
    }
    Ok(Aiding { source: plant::AidingSource { kind, period_ns }, mode, sway: *keys.sway })
}

fn kalman(
    keys: &CalibrationKeys,
    aiding: &Aiding,
    further: core::Further,
) -> Result<core::Kalman, Problem> {
    let prior = &keys.prior;
    let estimated = ParameterGroup::ALL.map(|group| {
        !keys.not_estimated.iter().any(|name| name == group.name())
            && (keys.g_states || group != ParameterGroup::GDependent)
    });
    if prior.attitude.iter().any(|sigma| *sigma <= 0.0) {
        return Err(prior.attitude.problem("found a σ of 0 or less, expected values above 0"));
    }
    Ok(core::Kalman {
        error_model: keys.error_model,
        estimated,
        prior: core::Prior {
            attitude_rad: *prior.attitude,
            velocity_mps: prior.velocity,
            position_m: prior.position,
            parameters: [
                prior.gyro_bias,
                prior.gyro_scale,
                prior.gyro_misalignment,
                prior.g_dependent,
                prior.accel_bias,
                prior.accel_scale,
                prior.accel_misalignment,
            ],
        },
        aiding: aiding.mode,
        aiding_period_ns: aiding.source.period_ns,
        sway: aiding.sway,
        refuse_above_mean_nis: keys.refuse_above_mean_nis,
        further,
        sigma_limits: sigma_limits(&keys.refuse_above_sigma),
    })
}

fn sigma_limits(keys: &SigmaLimitKeys) -> core::SigmaLimits {
    core::SigmaLimits {
        heading_rad: keys.heading,
        tilt_rad: keys.tilt,
        parameters: [
            keys.gyro_bias,
            keys.gyro_scale,
            keys.gyro_misalignment,
            keys.g_dependent,
            keys.accel_bias,
            keys.accel_scale,
            keys.accel_misalignment,
        ],
    }
}

fn least_squares(keys: &LeastSquaresKeys) -> core::LeastSquares {
    core::LeastSquares {
        gravity_mps2: keys.gravity,
        gyro: keys.gyro,
        intervals: match keys.intervals {
            Intervals::Commanded => core::StaticIntervals::Commanded,
            Intervals::Detected => core::StaticIntervals::Detected {
                initial_s: keys.initial,
                window_s: keys.window,
                threshold: keys.threshold,
                shortest_s: keys.shortest,
            },
        },
    }
}

fn external_turntable(
    keys: &CalibrationKeys,
    setting: &Setting<'_>,
) -> Result<core::ExternalTurntable, Problem> {
    let MotionSpec::Static(mean) = setting.motion else {
        return Err(keys.estimator.problem(
            "found \"external-turntable\" with motion.kind = \"dockside\", expected \"static\": a \
             turntable's base is surveyed on the ground",
        ));
    };
    Ok(core::ExternalTurntable {
        q_nc: case_attitude(mean),
        encoder_sigma_rad: setting.turntable.encoder_sigma_rad,
    })
}

fn navigation(
    keys: &NavigationKeys,
    setting: &Setting<'_>,
) -> Result<core::NavigationPlan, Problem> {
    let duration_s = *keys.duration;
    match duration_s {
        None if setting.endless => {
            let message = "missing, expected a time such as \"24 h\": the source never ends";
            return Err(keys.duration.problem(message));
        }
        Some(duration_s) if samples_of(duration_s, setting).is_none() => {
            return Err(not_whole(&keys.duration, setting));
        }
        _ => {}
    }
    let stops = match &*keys.rotation {
        Rotation::None => from_degrees(positions::NONE),
        Rotation::Sixteen => from_degrees(positions::SIXTEEN),
        Rotation::Tetrahedral => from_degrees(positions::TETRAHEDRAL),
        Rotation::Stops(own) => stops(own),
    };
    let rotation =
        Sequence::new(&stops, 1).map_err(|error| keys.rotation.problem(error.to_string()))?;
    Ok(core::NavigationPlan { duration_s, rotation, dwell_s: keys.dwell })
}

/// Reads the screening. Its bounds by base and instrument are added with the draws: see
/// [`super::super::resolve`].
pub(super) fn screening(keys: &ScreeningKeys) -> core::Screening {
    let gate = |gate: &GateKeys| core::Gate {
        nis: gate.nis,
        rejections: gate.rejections,
        recovery: match &gate.recovery {
            None => core::Recovery::Widening,
            Some(reset) => core::Recovery::Reset {
                attitude_rad: reset.attitude,
                velocity_mps: reset.velocity,
                position_m: reset.position,
            },
        },
    };
    core::Screening {
        gate: keys.gate.as_ref().map(gate),
        stuck_samples: keys.stuck_samples,
        jumps: keys.jumps,
        bridging: keys.bridging,
        gimbals: keys.gimbals,
        drift_sigmas: keys.drift,
        checkpoints: keys.checkpoints,
        aiding_stamps: keys.aiding_stamps,
        ..core::Screening::none()
    }
}
