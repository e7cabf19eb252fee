//! Limits of the host's clock.

use octant_run::findings::too_late;
use octant_scenario::Scenario;
use octant_score::summary::LatenessQuantiles;
use octant_score::summary::PacingRecord;
use std::path::Path;

#[test]
fn a_limit_of_the_clock_holds_up_to_its_value() {
    let limits = |lateness_p99: &str| {
        let text = format!(
            "schema = 1\n[procedure.navigation]\nduration = \"4 s\"\n[realtime]\nlateness_p99 = \"{lateness_p99}\"\n"
        );
        Scenario::parse(&text, "s", Path::new(""), &[]).unwrap().realtime
    };
    let lateness_us = LatenessQuantiles { p99: 500.0, ..LatenessQuantiles::default() };
    let pacing = PacingRecord {
        frames: 800,
        period_us: 5000.0,
        lateness_us,
        lateness_histogram_ns: Vec::new(),
        lateness_over_run: None,
        overrun_us: 5000.0,
        overruns: 0,
        overruns_in_a_row: 0,
        first_overrun: None,
        slack_p1_us: 100.0,
        answer_us: lateness_us,
        late_answers: 0,
        missed_answers: 0,
        not_sent: 0,
        device_clock: None,
        dropped_records: 0,
    };
    assert_eq!(too_late(&limits("500 us"), &pacing), Vec::<String>::new());
    let reasons = too_late(&limits("499 us"), &pacing);
    assert_eq!(
        reasons,
        ["the bench was late: the lateness of 99 % of the samples is 500 us, 499 us are allowed"]
    );
}
