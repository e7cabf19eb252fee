//! Conversion of a checked and completed document to a [`Scenario`]: quantities become SI, values that
//! depend on several keys are decided, and contradictions are reported.

mod count_range;
mod drive;
pub mod faults;
mod fmu;
mod further;
mod heading;
mod instrument;
mod instrument_port;
mod power;
mod procedure;
pub(crate) mod reader;
mod reference;
pub mod requirement;
mod sequence;
mod source;
pub mod system;
mod trajectory;

pub(crate) use reader::Reader;

use super::error::Problem;
use super::keys::{FromTable, RealtimeKeys, RecordKeys, ScenarioKeys};
use super::model::{MotionSpec, Realtime, RecordSpec, Scenario, SourceSpec};
use octant_base::display::DisplayUnits;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::ARCMIN;
use octant_plant::config as plant;
use octant_toml_tree::Table;
use std::path::Path;

/// Reads a completed document.
pub fn scenario(document: Table, folder: &Path) -> Result<Scenario, Problem> {
    let keys = ScenarioKeys::of(&Reader::root(&document))?;
    let sample_period_ns = instrument::sample_period_ns(*keys.imu.rate);
    let source = source::read(&keys.source, sample_period_ns)?;
    let site = plant::PlantSite {
        latitude_rad: keys.site.latitude,
        longitude_rad: keys.site.longitude,
        height_m: keys.site.height,
        gravity: plant::GravityDisturbance {
            deflection_north_rad: keys.site.deflection_north,
            deflection_east_rad: keys.site.deflection_east,
            anomaly_mps2: keys.site.gravity_anomaly,
        },
    };
    let motion = instrument::motion(&keys.motion);
    let turntable = instrument::turntable(&keys.turntable);
    let drive = keys.turntable.drive.as_ref();
    let drive = drive.map(|keys| drive::drive(keys, &turntable)).transpose()?;
    let setting = procedure::Setting {
        sample_period_ns,
        sample_rate_hz: *keys.imu.rate,
        motion: &motion,
        turntable: &turntable,
        endless: !source.is_recorded(),
        folder,
    };
    let procedure = procedure::procedure(&keys.procedure, &setting)?;
    let baseline =
        procedure::baseline(&keys.baseline, &document, &keys.procedure.calibration, &setting)?;
    let endpoint = fmu::endpoint(&keys.endpoint, sample_period_ns)?;
    check_motion(&source, &motion)?;
    let scenario = Scenario {
        title: keys.title.clone(),
        seed: keys.seed,
        sample_period_ns,
        sample_rate_hz: *keys.imu.rate,
        site,
        parameters: instrument::parameters(&keys.imu),
        further: further::drawn(&keys)?,
        imu: instrument::imu(&keys.imu)?,
        turntable,
        drive,
        alignment: procedure.alignment,
        initial_parameters: procedure.initial_parameters,
        calibration: procedure.calibration,
        baseline,
        aiding: procedure.aiding,
        navigation: procedure.navigation,
        heading_test: heading::spec(&keys.procedure.heading_test),
        screening: procedure::screening(&keys.screening),
        faults: Vec::new(),
        operator: Vec::new(),
        requirements: requirement::read(keys.requirements.as_deref().unwrap_or_default())?,
        decision: requirement::decision(&keys.decision)?,
        equipment: requirement::equipment(keys.equipment.as_deref().unwrap_or_default())?,
        record: record(&keys.record, sample_period_ns)?,
        dither: source::dither(&keys.source, &source)?,
        source,
        reference: None,
        endpoint,
        power: None,
        realtime: realtime(&keys.realtime),
        display: display(&keys),
        motion,
        file: String::new(),
        folder: folder.to_owned(),
        document: Table::default(),
    };
    let reference = reference::read(&keys, &scenario)?;
    let power = power::read(&keys, &scenario)?;
    let scenario = Scenario { reference, power, ..scenario };
    check_once(&keys, &scenario)?;
    heading::check(&keys, &scenario)?;
    count_range::check(&keys.imu.rate, &scenario)?;
    further::check_endpoint(&keys.endpoint.uri, &scenario)?;
    further::check_limits(&keys.endpoint.uri, &scenario)?;
    further::check_reference(&keys.procedure.calibration, &scenario)?;
    let scenario = trajectory::check(&keys, scenario)?;
    if let Some(keys) = &keys.turntable.drive {
        drive::check_reach(keys, &scenario)?;
    }
    let faults = faults::read(&keys.faults, &scenario)?;
    let operator = faults::steps(&keys.operator, &scenario)?;
    let scenario = Scenario { document, faults, operator, ..scenario };
    trajectory::check_steps(&keys, &scenario)?;
    Ok(trajectory::without_bench(scenario))
}

/// Refuses a repetition of samples that exist only once, and pacing of instruments and ports that have
/// their own timing.
fn check_once(keys: &ScenarioKeys, scenario: &Scenario) -> Result<(), Problem> {
    let by_clock = scenario.realtime.by_clock;
    if scenario.source.instrument().is_some() {
        if scenario.baseline.is_some() {
            return Err(keys.baseline.problem(
                "a second method needs the same samples again, which a real instrument doesn't \
                 give: expected it on the recording of the first, with source.uri = \"replay:FILE\"",
            ));
        }
        if by_clock {
            return Err(keys
                .realtime
                .pace
                .problem("a real instrument sends by a clock of its own: expected \"free\""));
        }
    }
    if let (Some(live), Some(link)) = (scenario.endpoint.device(), &keys.endpoint.link)
        && by_clock
        && live.reconnect_s > 0.0
    {
        return Err(link.reconnect.problem(
            "by the clock a port that goes away ends the run: expected \"0 s\" with realtime.pace \
             = \"clock\"",
        ));
    }
    Ok(())
}

/// Checks that the motion is a moving one if an FMU moves the case.
fn check_motion(source: &SourceSpec, motion: &MotionSpec) -> Result<(), Problem> {
    match (source.motion(), motion) {
        (Some(fmu), MotionSpec::Static(_)) => Err(fmu.at.problem(
            "the FMU moves the case, and motion.kind is \"static\": expected \"dockside\", whose \
             sway tells the core what to expect",
        )),
        _ => Ok(()),
    }
}

fn record(keys: &RecordKeys, sample_period_ns: u64) -> Result<RecordSpec, Problem> {
    let samples = 1e9 / *keys.rate / sample_period_ns as f64;
    let every_samples = samples.round();
    if every_samples < 1.0 || (samples - every_samples).abs() > 1e-6 * samples {
        return Err(keys.rate.problem(format!(
            "found {:?}, which is {samples} samples of {sample_period_ns} ns apart, expected a whole \
             number",
            keys.rate.text
        )));
    }
    Ok(RecordSpec {
        every_samples: every_samples as u64,
        full_samples: keys.samples,
        parameters_period_ns: ns(keys.parameters),
        topics_period_ns: keys.topics.then(|| ns(keys.topics_period)),
    })
}

fn display(keys: &ScenarioKeys) -> DisplayUnits {
    let earth = Ellipsoid::at(keys.site.latitude, keys.site.height);
    let across = earth.transverse_radius_m * earth.cos_latitude;
    DisplayUnits {
        position: keys.display.position,
        attitude: keys.display.attitude,
        velocity: keys.display.velocity,
        arcmin_m: [earth.meridian_radius_m, across].map(|radius_m| radius_m * ARCMIN),
    }
}

fn ns(time_s: f64) -> u64 {
    (time_s * 1e9).round() as u64
}

fn realtime(keys: &RealtimeKeys) -> Realtime {
    Realtime {
        by_clock: *keys.pace,
        overrun_ns: ns(keys.overrun),
        overruns: keys.overruns,
        lateness_p99_ns: keys.lateness_p99.map(ns),
        late_answers: keys.late_answers,
        silence_ns: ns(keys.silence),
        priority: Some(keys.priority).filter(|priority| *priority > 0),
        cpu: keys.cpu,
        lock_memory: keys.lock_memory,
        spin_ns: ns(keys.spin),
    }
}
