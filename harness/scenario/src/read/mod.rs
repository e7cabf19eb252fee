//! Conversion of a checked and completed document to a [`Scenario`]: quantities become SI, values that
//! depend on several keys are decided, and contradictions are reported.

mod drive;
pub mod faults;
mod fmu;
mod instrument;
mod instrument_port;
mod live;
mod procedure;
mod reader;
pub mod requirement;
mod source;

pub use reader::Reader;

use super::document::Table;
use super::error::Problem;
use super::model::{Motion, Realtime, Record, Scenario, Source};
use octant_plant::config as plant;
use std::path::Path;

/// Reads a completed document.
pub fn scenario(document: Table, folder: &Path) -> Result<Scenario, Problem> {
    let root = Reader::root(&document);

    let imu = root.table("imu")?;
    let sample_period_ns = instrument::sample_period_ns(&imu)?;
    let source = source::read(&root.table("source")?, sample_period_ns)?;
    let site = root.table("site")?;
    let site = plant::Site {
        latitude_rad: site.si("latitude")?,
        longitude_rad: site.si("longitude")?,
        height_m: site.si("height")?,
    };
    let motion = instrument::motion(&root.table("motion")?)?;
    let turntable_table = root.table("turntable")?;
    let turntable = instrument::turntable(&turntable_table)?;
    let drive = drive::drive(&turntable_table, &turntable)?;
    let screening = procedure::screening(&root.table("screening")?)?;
    let setting = procedure::Setting {
        sample_period_ns,
        motion: &motion,
        turntable: &turntable,
        endless: !source.is_recorded(),
        folder,
    };
    let procedure_table = root.table("procedure")?;
    let procedure = procedure::procedure(&procedure_table, &setting)?;
    let baseline = procedure::baseline(&root, &setting)?;
    let endpoint = fmu::endpoint(&root.table("endpoint")?, sample_period_ns)?;
    check_motion(&source, &motion)?;
    let scenario = Scenario {
        title: root.text("title")?.to_owned(),
        seed: root.integer("seed")?,
        sample_period_ns,
        site,
        parameters: instrument::parameters(&imu)?,
        imu: instrument::imu(&imu)?,
        turntable,
        drive,
        alignment: procedure.alignment,
        initial_parameters: procedure.initial_parameters,
        calibration: procedure.calibration,
        baseline,
        aiding: procedure.aiding,
        navigation: procedure.navigation,
        screening,
        faults: Vec::new(),
        requirements: requirement::read(&root)?,
        decision: requirement::decision(&root.table("decision")?)?,
        equipment: requirement::equipment(&root)?,
        record: record(&root.table("record")?, sample_period_ns)?,
        source,
        endpoint,
        realtime: realtime(&root.table("realtime")?)?,
        motion,
        file: String::new(),
        folder: folder.to_owned(),
        document: Table::default(),
    };
    check_once(&root, &scenario)?;
    drive::check_reach(&root, &scenario)?;
    let faults = faults::read(&root, &scenario)?;
    Ok(Scenario { document, faults, ..scenario })
}

/// Refuses a repetition of samples that exist only once, and pacing of instruments and ports that have
/// their own timing.
fn check_once(root: &Reader<'_>, scenario: &Scenario) -> Result<(), Problem> {
    let by_clock = scenario.realtime.by_clock;
    if scenario.source.instrument().is_some() {
        if scenario.baseline.is_some() {
            return Err(root.problem(
                "baseline",
                "a second method needs the same samples again, which a real instrument doesn't \
                 give: expected it on the recording of the first, with source.uri = \"replay:FILE\"",
            ));
        }
        if by_clock {
            return Err(root.table("realtime")?.problem(
                "pace",
                "a real instrument sends by a clock of its own: expected \"free\"",
            ));
        }
    }
    if let Some(live) = scenario.endpoint.device()
        && by_clock
        && live.reconnect_s > 0.0
    {
        return Err(root.table("endpoint")?.table("link")?.problem(
            "reconnect",
            "by the clock a port that goes away ends the run: expected \"0 s\" with realtime.pace \
             = \"clock\"",
        ));
    }
    Ok(())
}

/// Checks that the motion is a moving one if an FMU moves the case.
fn check_motion(source: &Source, motion: &Motion) -> Result<(), Problem> {
    match (source.motion(), motion) {
        (Some(fmu), Motion::Static(_)) => Err(fmu.at.problem(
            "the FMU moves the case, and motion.kind is \"static\": expected \"dockside\", whose \
             sway tells the core what to expect",
        )),
        _ => Ok(()),
    }
}

fn record(record: &Reader<'_>, sample_period_ns: u64) -> Result<Record, Problem> {
    let samples = 1e9 / record.si("rate")? / sample_period_ns as f64;
    let every_samples = samples.round();
    if every_samples < 1.0 || (samples - every_samples).abs() > 1e-6 * samples {
        return Err(record.problem(
            "rate",
            format!(
                "found {:?}, which is {samples} samples of {} ns apart, expected a whole number",
                record.text("rate")?,
                sample_period_ns
            ),
        ));
    }
    Ok(Record {
        every_samples: every_samples as u64,
        full_samples: record.text("samples")? == "full",
        parameters_period_ns: (record.si("parameters")? * 1e9).round() as u64,
    })
}

fn realtime(realtime: &Reader<'_>) -> Result<Realtime, Problem> {
    let ns = |key: &str| realtime.si(key).map(|s| (s * 1e9).round() as u64);
    let priority: u8 = realtime.integer("priority")?;
    Ok(Realtime {
        by_clock: realtime.text("pace")? == "clock",
        overrun_ns: ns("overrun")?,
        overruns: realtime.integer("overruns")?,
        lateness_p99_ns: realtime.optional_si("lateness_p99").map(|s| (s * 1e9).round() as u64),
        late_answers: realtime.integer("late_answers")?,
        silence_ns: ns("silence")?,
        priority: (priority > 0).then_some(priority),
        cpu: if realtime.node("cpu").is_some() { Some(realtime.integer("cpu")?) } else { None },
        lock_memory: realtime.boolean("lock_memory")?,
        spin_ns: ns("spin")?,
    })
}
