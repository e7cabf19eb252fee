//! Whole runs of an instrument without errors, which must end where they began.

use crate::bench::CaseBench;
use crate::error::CaseSetupError;
use crate::judge::{CaseOutcome, Known};

const PERFECT: &str = include_str!("../../../../../fixtures/selftest/perfect.toml");

/// Names, changes of the scenario, and the largest radial error, nmi.
const RUNS: [(&str, &[&str], f64); 2] = [
    // 2^-28 rad of the Earth's radius on two axes: 33 mm.
    ("leaning", &[], 4e-5),
    ("on a ship", &["--set", "motion.kind=dockside", "--set", "site.latitude=35 deg"], 1.5e-4),
];

pub(super) fn known() -> Vec<Known> {
    let known = |(name, _, tolerance): &(&str, &[&str], f64)| Known {
        name: format!("radial error {name}"),
        value: 0.0,
        tolerance: *tolerance,
    };
    RUNS.iter().map(known).collect()
}

pub(super) fn found(bench: &CaseBench<'_>) -> Result<CaseOutcome, CaseSetupError> {
    let mut outcome = CaseOutcome { status: Some(0), ..CaseOutcome::default() };
    for (name, changes, _) in RUNS {
        let mut words = changes.to_vec();
        words.push("--force");
        let ran = bench.run(PERFECT, &words)?;
        let navigation = ran.summary()?.navigation.as_ref().ok_or("find the navigation")?;
        let worst = navigation.radial_error_nmi.ok_or("find the radial error")?.max;
        outcome.numbers.insert(format!("radial error {name}"), worst);
    }
    Ok(outcome)
}
