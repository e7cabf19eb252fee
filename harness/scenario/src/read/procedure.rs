//! The core's procedure: alignment, the methods of calibration, navigation, screening.

use super::reader::Reader;
use crate::document::{Node, Table, Value};
use crate::error::Problem;
use crate::model::{Alignment, Calibration, Motion, case_attitude};
use crate::quantity::{self, Dimension};
use octant_calibration::config as core;
use octant_calibration::positions;
use octant_calibration::sequence::{Sequence, Stop};
use octant_calibration::table::CalibrationTable;
use octant_earth::units::DEG;
use octant_plant::config as plant;
use octant_sample::Parameters;
use octant_sample::parameters::Group;
use std::path::Path;

/// Properties of the run that the procedure must fit.
pub(super) struct Setting<'a> {
    pub(super) sample_period_ns: u64,
    pub(super) motion: &'a Motion,
    pub(super) turntable: &'a plant::Turntable,
    /// True if the source never ends, unlike a recording.
    pub(super) endless: bool,
    /// Folder from which relative file names start.
    pub(super) folder: &'a Path,
}

pub(super) struct Procedure {
    pub(super) alignment: Alignment,
    pub(super) initial_parameters: Parameters,
    pub(super) calibration: Option<Calibration>,
    pub(super) aiding: plant::AidingSource,
    pub(super) navigation: Option<core::NavigationPlan>,
}

pub(super) fn procedure(table: &Reader<'_>, setting: &Setting<'_>) -> Result<Procedure, Problem> {
    let calibration_table = table.optional_table("calibration");
    let calibration = match &calibration_table {
        Some(table) => Some(calibration(table, setting)?),
        None => None,
    };
    let aiding = match &calibration_table {
        Some(table) => aiding(&table.table("aiding")?, setting)?.source,
        None => plant::AidingSource {
            kind: plant::AidingKind::ZeroVelocity { sigma_mps: 1e-3 },
            period_ns: setting.sample_period_ns,
        },
    };
    let navigation = match table.optional_table("navigation") {
        Some(table) => Some(navigation(&table, setting)?),
        None => None,
    };
    if calibration.is_none() && navigation.is_none() {
        return Err(table.problem(
            "calibration",
            "found neither procedure.calibration nor procedure.navigation, expected one at least",
        ));
    }
    Ok(Procedure {
        alignment: alignment(&table.table("alignment")?, calibration.as_ref())?,
        initial_parameters: initial_parameters(table, setting.folder)?,
        calibration,
        aiding,
        navigation,
    })
}

fn alignment(table: &Reader<'_>, calibration: Option<&Calibration>) -> Result<Alignment, Problem> {
    if table.text("method")? == "given" {
        return Ok(Alignment::Given {
            tilt_rad: table.si("tilt")?,
            azimuth_rad: table.si("azimuth")?,
            velocity_mps: table.si("velocity")?,
            attitude_error_rad: table.optional_si_array("attitude_error"),
            velocity_error_mps: table.optional_si_array("velocity_error"),
        });
    }
    let duration_s = table.si("duration")?;
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
            return Err(table.problem(
                "duration",
                format!(
                    "found {duration_s} s, but the first stop is held for {first_s:.1} s alone"
                ),
            ));
        }
    }
    Ok(Alignment::Coarse { duration_s })
}

fn initial_parameters(procedure: &Reader<'_>, folder: &Path) -> Result<Parameters, Problem> {
    let mut all = [0.0; octant_sample::parameters::PARAMETER_COUNT];
    let Some(table) = procedure.optional_table("initial_parameters") else {
        return Ok(Parameters::from_array(&all));
    };
    if let Some(file) = table.optional_text("table") {
        if let Some(group) = Group::ALL.iter().find(|group| table.node(group.name()).is_some()) {
            let message = "found beside table, expected one of them";
            return Err(table.problem(group.name(), message));
        }
        let path = folder.join(file);
        let bytes = std::fs::read(&path)
            .map_err(|error| table.problem("table", format!("read {}: {error}", path.display())))?;
        let read = CalibrationTable::from_bytes(&bytes)
            .map_err(|error| table.problem("table", format!("read {}: {error}", path.display())))?;
        return Ok(read.parameters);
    }
    for group in Group::ALL {
        if let Some(values) = table.optional_si_vec(group.name()) {
            all[group.range()].copy_from_slice(&values);
        }
    }
    Ok(Parameters::from_array(&all))
}

/// Reads the second method: the keys of the first one, replaced by those of `[baseline]`.
pub(super) fn baseline(
    root: &Reader<'_>,
    setting: &Setting<'_>,
) -> Result<Option<Calibration>, Problem> {
    let Some(baseline) = root.node("baseline") else { return Ok(None) };
    let Value::Table(overrides) = &baseline.value else { return Ok(None) };
    let procedure = root.table("procedure")?;
    let Some(Node { value: Value::Table(primary), .. }) = procedure.node("calibration") else {
        let message = "found without procedure.calibration, which it is compared with";
        return Err(root.problem("baseline", message));
    };
    if overrides.get("positions").is_some() && overrides.get("stops").is_some() {
        return Err(root.problem("baseline", "found positions and stops, expected one of them"));
    }
    let mut merged: Table = primary.clone();
    for entry in &overrides.entries {
        match entry.key.as_str() {
            "positions" => merged.remove("stops"),
            "stops" => merged.remove("positions"),
            _ => {}
        }
        merged.set(&entry.key, entry.node.clone());
    }
    // The shared keys were already read with the first method, so a problem here belongs to the
    // baseline.
    let second = calibration(&Reader::new(&merged, "baseline", &baseline.place), setting)?;
    Ok(Some(second))
}

fn calibration(table: &Reader<'_>, setting: &Setting<'_>) -> Result<Calibration, Problem> {
    let passes: u32 = table.integer("passes")?;
    if table.given("positions") && table.node("stops").is_some() {
        return Err(table.problem("stops", "found stops beside positions, expected one of them"));
    }
    let (name, key, stops) = if table.node("stops").is_some() {
        ("own stops", "stops", stops(table, "stops")?)
    } else {
        let name = table.text("positions")?;
        let stops = positions::named(name)
            .ok_or_else(|| table.problem("positions", format!("found {name:?}")))?;
        (name, "positions", from_degrees(stops))
    };
    let sequence =
        Sequence::new(&stops, passes).map_err(|error| table.problem(key, error.to_string()))?;
    let duration_s = table.si("duration")?;
    if samples_of(duration_s, setting.sample_period_ns).is_none() {
        return Err(not_whole(table, "duration", setting));
    }
    let aiding = aiding(&table.table("aiding")?, setting)?;
    let estimator = match table.text("estimator")? {
        "kalman" => core::Estimator::Kalman(kalman(table, &aiding)?),
        "least-squares" => core::Estimator::LeastSquares(least_squares(table)?),
        _ => core::Estimator::ExternalTurntable(external_turntable(table, setting)?),
    };
    let moves_s = moves_s(&sequence, setting.turntable);
    let weights: f64 =
        sequence.stops().iter().map(|stop| stop.weight).sum::<f64>() * f64::from(passes);
    let dwell_s = (duration_s - moves_s) / weights;
    let shortest_s = aiding.source.period_ns as f64 * 1e-9;
    if dwell_s < shortest_s {
        return Err(table.problem(
            "duration",
            format!(
                "found {duration_s} s, of which the moves of {passes} pass(es) of {} stops take \
                 {moves_s:.1} s: {:.1} s is left for dwells of {weights} weights, {dwell_s:.2} s \
                 each; expected {shortest_s} s each at least, the period of the aiding, that is a \
                 duration of {} s or more",
                sequence.stops().len(),
                duration_s - moves_s,
                (moves_s + weights * shortest_s).ceil(),
            ),
        ));
    }
    Ok(Calibration { name: name.to_owned(), sequence, duration_s, dwell_s, estimator })
}

fn not_whole(table: &Reader<'_>, key: &str, setting: &Setting<'_>) -> Problem {
    let found = table.text(key).unwrap_or_default();
    let period_ns = setting.sample_period_ns;
    table.problem(
        key,
        format!("found {found:?}, expected a multiple of the sample period, {period_ns} ns"),
    )
}

fn from_degrees(stops: &[positions::Degrees]) -> Vec<Stop> {
    let stop = |(azimuth_deg, roll_deg, weight): &positions::Degrees| Stop {
        azimuth_rad: azimuth_deg * DEG,
        roll_rad: roll_deg * DEG,
        weight: *weight,
    };
    stops.iter().map(stop).collect()
}

fn stops(table: &Reader<'_>, key: &str) -> Result<Vec<Stop>, Problem> {
    let stop = |table: Reader<'_>| {
        Ok(Stop {
            azimuth_rad: table.si("azimuth")?,
            roll_rad: table.si("roll")?,
            weight: table.number("weight")?,
        })
    };
    table.tables(key).into_iter().map(stop).collect()
}

/// Number of samples in a time, if it is a multiple of the sample period.
fn samples_of(time_s: f64, sample_period_ns: u64) -> Option<u64> {
    let ns = (time_s * 1e9).round() as u64;
    (ns > 0 && ns.is_multiple_of(sample_period_ns)).then(|| ns / sample_period_ns)
}

/// Total duration of the moves of all passes, s: both gimbals turn together, with a trapezoidal rate
/// profile. Between two passes the gimbals return to the first stop.
fn moves_s(sequence: &Sequence, turntable: &plant::Turntable) -> f64 {
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
}

fn aiding(table: &Reader<'_>, setting: &Setting<'_>) -> Result<Aiding, Problem> {
    let period_ns = (table.si("period")? * 1e9).round() as u64;
    if samples_of(table.si("period")?, setting.sample_period_ns).is_none() {
        return Err(not_whole(table, "period", setting));
    }
    let reference = table.text("reference")?;
    let dimension =
        if reference == "dock-position" { Dimension::LENGTH } else { Dimension::VELOCITY };
    for key in ["sigma", "noise"] {
        let text = table.text(key)?;
        if !quantity::parse(text).is_ok_and(|quantity| quantity.is(dimension)) {
            return Err(table.problem(
                key,
                format!(
                    "found {text:?}, expected {} such as \"{}\" with reference = {reference:?}",
                    dimension.name, dimension.example
                ),
            ));
        }
    }
    let (sigma, noise) = (table.si("sigma")?, table.si("noise")?);
    let (kind, mode) = match reference {
        "dock-position" => (
            plant::AidingKind::DockPosition { sigma_m: noise },
            core::AidingMode::Position { sigma_m: sigma },
        ),
        "velocity" => (
            plant::AidingKind::Velocity { sigma_mps: noise },
            core::AidingMode::Velocity { sigma_mps: sigma },
        ),
        _ => (
            plant::AidingKind::ZeroVelocity { sigma_mps: noise },
            core::AidingMode::Velocity { sigma_mps: sigma },
        ),
    };
    Ok(Aiding { source: plant::AidingSource { kind, period_ns }, mode })
}

fn kalman(table: &Reader<'_>, aiding: &Aiding) -> Result<core::Kalman, Problem> {
    let prior = table.table("prior")?;
    let mut parameters = [0.0; 7];
    let mut estimated = [true; 7];
    let excluded = table.texts("not_estimated");
    let g_states = table.boolean("g_states")?;
    for (index, group) in Group::ALL.into_iter().enumerate() {
        parameters[index] = prior.si(group.name())?;
        estimated[index] =
            !excluded.contains(&group.name()) && (g_states || group != Group::GDependent);
    }
    let attitude_rad: [f64; 3] = prior.si_array("attitude")?;
    if attitude_rad.iter().any(|sigma| *sigma <= 0.0) {
        return Err(prior.problem("attitude", "found a σ of 0 or less, expected values above 0"));
    }
    Ok(core::Kalman {
        error_model: match table.text("error_model")? {
            "psi" => core::ErrorModel::Psi,
            _ => core::ErrorModel::Phi,
        },
        estimated,
        prior: core::Prior {
            attitude_rad,
            velocity_mps: prior.si("velocity")?,
            position_m: prior.si("position")?,
            parameters,
        },
        aiding: aiding.mode,
        aiding_period_ns: aiding.source.period_ns,
        refuse_above_mean_nis: table.number("refuse_above_mean_nis")?,
    })
}

fn least_squares(table: &Reader<'_>) -> Result<core::LeastSquares, Problem> {
    let table = table.table("least_squares")?;
    Ok(core::LeastSquares {
        gravity_mps2: table.optional_si("gravity"),
        gyro: match table.text("gyro")? {
            "earth-rate" => core::GyroReference::EarthRate,
            _ => core::GyroReference::RotatedGravity,
        },
        intervals: match table.text("intervals")? {
            "commanded" => core::StaticIntervals::Commanded,
            _ => core::StaticIntervals::Detected {
                initial_s: table.si("initial")?,
                window_s: table.si("window")?,
                threshold: table.number("threshold")?,
                shortest_s: table.si("shortest")?,
            },
        },
    })
}

fn external_turntable(
    table: &Reader<'_>,
    setting: &Setting<'_>,
) -> Result<core::ExternalTurntable, Problem> {
    let Motion::Static(mean) = setting.motion else {
        return Err(table.problem(
            "estimator",
            "found \"external-turntable\" with motion.kind = \"dockside\", expected \"static\": a \
             turntable's base is surveyed on the ground",
        ));
    };
    Ok(core::ExternalTurntable {
        q_nc: case_attitude(mean),
        encoder_sigma_rad: setting.turntable.encoder_sigma_rad,
    })
}

fn navigation(table: &Reader<'_>, setting: &Setting<'_>) -> Result<core::NavigationPlan, Problem> {
    let duration_s = table.optional_si("duration");
    match duration_s {
        None if setting.endless => {
            let message = "missing, expected a time such as \"24 h\": the source never ends";
            return Err(table.problem("duration", message));
        }
        Some(duration_s) if samples_of(duration_s, setting.sample_period_ns).is_none() => {
            return Err(not_whole(table, "duration", setting));
        }
        _ => {}
    }
    let stops = match table.optional_text("rotation") {
        Some("none") => vec![Stop { azimuth_rad: 0.0, roll_rad: 0.0, weight: 1.0 }],
        Some(_) => from_degrees(positions::SIXTEEN),
        None => stops(table, "rotation")?,
    };
    let rotation =
        Sequence::new(&stops, 1).map_err(|error| table.problem("rotation", error.to_string()))?;
    Ok(core::NavigationPlan { duration_s, rotation, dwell_s: table.si("dwell")? })
}

/// Reads the screening. Its bounds by base and instrument are added with the draws: see
/// [`super::super::resolve`].
pub(super) fn screening(table: &Reader<'_>) -> Result<core::Screening, Problem> {
    let gate = match table.optional_table("gate") {
        None => None,
        Some(gate) => Some(core::Gate {
            nis: gate.number("nis")?,
            rejections: gate.integer("rejections")?,
            recovery: match gate.optional_table("recovery") {
                None => core::Recovery::Widening,
                Some(reset) => core::Recovery::Reset {
                    attitude_rad: reset.si("attitude")?,
                    velocity_mps: reset.si("velocity")?,
                    position_m: reset.si("position")?,
                },
            },
        }),
    };
    let stuck_samples = match table.optional_text("stuck_samples") {
        Some(_) => None,
        None => Some(table.integer("stuck_samples")?),
    };
    let on = |key: &str| table.text(key).map(|text| text == "on");
    Ok(core::Screening {
        gate,
        stuck_samples,
        jumps: on("jumps")?,
        bridging: on("bridging")?,
        gimbals: on("gimbals")?,
        drift_sigmas: match table.optional_text("drift") {
            Some(_) => None,
            None => Some(table.number("drift")?),
        },
        checkpoints: on("checkpoints")?,
        aiding_stamps: on("aiding_stamps")?,
        ..core::Screening::none()
    })
}
