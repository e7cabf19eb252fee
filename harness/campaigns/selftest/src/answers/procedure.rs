//! Stops of every named sequence, and the dwells that a calibration time leaves for them.

use super::numbers::Found;
use octant_calibration::sequence::Sequence;
use octant_scenario::Scenario;
use std::path::Path;

/// Sequences whose angles follow from a rule; the others have angles of our own.
const NAMED: [&str; 4] = ["six", "eight", "eight-level", "eight-same-plane"];

pub(super) fn found() -> Result<Found, String> {
    let mut all = Found::new();
    for name in NAMED {
        for (passes, what) in [(1, "dwell"), (2, "dwell of two passes")] {
            let calibration = read(&format!(
                "[procedure.calibration]\npositions = \"{name}\"\nduration = \"4 h\"\npasses = {passes}\n"
            ))?
            .calibration
            .ok_or("read a calibration")?;
            all.insert(format!("{name}, {what}"), calibration.dwell_s);
            stops(&mut all, name, &calibration.sequence);
        }
    }
    for name in ["sixteen", "tetrahedral"] {
        let navigation =
            format!("[procedure.navigation]\nduration = \"24 h\"\nrotation = \"{name}\"\n");
        let navigation = read(&navigation)?.navigation.ok_or("read a navigation")?;
        stops(&mut all, name, &navigation.rotation);
    }
    Ok(all)
}

fn read(text: &str) -> Result<Scenario, String> {
    let text = format!("schema = 1\n{text}");
    Scenario::parse(&text, "answers.toml", Path::new("."), &[]).map_err(|why| why.to_string())
}

fn stops(all: &mut Found, name: &str, sequence: &Sequence) {
    for (i, stop) in sequence.stops().iter().enumerate() {
        all.insert(format!("{name}, azimuth of stop {i}"), stop.azimuth_rad);
        all.insert(format!("{name}, roll of stop {i}"), stop.roll_rad);
        all.insert(format!("{name}, weight of stop {i}"), stop.weight);
    }
}
