//! Limits of the host's clock, and noise that isn't what the filter takes it for.

use octant_base::control::Control;
use octant_run::findings::{findings, too_late};
use octant_run::{StreamKeeping, run_method};
use octant_scenario::{Method, Scenario};
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

/// Findings of an hour at a dockside, with a swell of this period on both horizontal axes.
fn at_a_dockside(amplitude: &str, period: &str, sway: &str, reference: &str) -> (Vec<String>, f64) {
    let text = format!(
        "schema = 1\n[motion]\nkind = \"dockside\"\n[motion.ship]\nroll = []\npitch = []\nyaw = []\n\
         surge = [{{ amplitude = \"{amplitude}\", period = \"{period}\" }}]\n\
         sway = [{{ amplitude = \"{amplitude}\", period = \"{period}\" }}]\nheave = []\n\
         [imu]\nrate = \"20 Hz\"\n[procedure.calibration]\nduration = \"1 h\"\n\
         [procedure.calibration.aiding]\nreference = \"dock-position\"\nsway = \"{sway}\"\n\
         period = \"{reference}\"\n"
    );
    let scenario = Scenario::parse(&text, "s.toml", Path::new(""), &[]).unwrap();
    let run = run_method(&scenario, Method::Primary, 1, StreamKeeping::None, &Control::default())
        .unwrap();
    let calibration = run.calibration.as_ref().unwrap();
    assert_eq!(calibration.refused, None);
    let nis = calibration.nis_mean.unwrap();
    (findings(&scenario, &run, None).into_iter().map(|finding| finding.reason).collect(), nis)
}

#[test]
fn a_swell_that_the_filter_takes_for_white_noise_is_said() {
    // With a reference each 2 s a swell of 8 s has no correlation with the measurement before.
    for (amplitude, period, reference) in [
        ("0.3 m", "10 s", "1 s"),
        ("0.4 m", "10 s", "1 s"),
        ("0.3 m", "12 s", "1 s"),
        ("0.3 m", "8 s", "2 s"),
    ] {
        let (said, nis) = at_a_dockside(amplitude, period, "white", reference);
        assert!(nis > 3.5, "{amplitude}, {period}: {nis}");
        assert_eq!(said.len(), 1, "{amplitude}, {period}: {said:?}");
        assert!(said[0].contains("isn't the white noise"), "{}", said[0]);
        assert!(said[0].contains("sway = \"coloured\""), "{}", said[0]);
    }
    // The size that the filter is told of, and a filter that estimates the sway.
    for (amplitude, sway) in [("0.1 m", "white"), ("0.4 m", "coloured")] {
        let (said, _) = at_a_dockside(amplitude, "10 s", sway, "1 s");
        assert!(said.is_empty(), "{amplitude}, {sway}: {said:?}");
    }
}
