//! Rates, and clocks that are wrong.

use super::super::rest::{BEGIN_S, COUNT, RATE_HZ, readings};
use super::super::table::{Counts, Ends};
use super::{INCREMENTS, Text, csv, increments_at, moved, regular, untimed};

#[test]
fn rates() {
    let mut text = Text::new("rates of text");
    for rate in ["60", "75", "120", "150", "300", "819.2"] {
        let rate_hz: f64 = rate.parse().unwrap();
        let count = (10.0 * rate_hz).round() as u64;
        // Times that are whole samples.
        let (aiding, recorded) = if rate == "819.2" { ("5 s", "0.2 Hz") } else { ("1 s", "1 Hz") };
        let set = [
            format!("imu.rate=\"{rate} Hz\""),
            "procedure.calibration.duration=\"10 s\"".to_owned(),
            format!("procedure.calibration.aiding.period=\"{aiding}\""),
            format!("record.rate=\"{recorded}\""),
        ];
        let clean = text.part.clean.take();
        let content = csv(&readings(rate_hz, count));
        text.row(
            &format!("{rate} Hz"),
            content,
            &set.each_ref().map(String::as_str),
            Counts::used(count),
            Ends::Pass,
        );
        text.part.clean = clean;
    }
    for ppm in [100.0, -100.0, 500.0, -500.0] {
        // Rates, and stamps of a clock that is wrong: the core's time is that of the stamps.
        text.input = "rates";
        let rows = moved(|_, t| BEGIN_S + (t - BEGIN_S) * (1.0 + ppm * 1e-6));
        let clock = if ppm > 0.0 { "fast" } else { "slow" };
        let holds = format!("stamps of a clock that is {clock} by {} ppm", f64::abs(ppm));
        text.row(&holds, csv(&rows), &[], Counts::used(COUNT), Ends::Pass);
        // Increments of a unit whose clock is right, and whose rate isn't that of the scenario.
        text.input = "increments";
        let rate_hz = RATE_HZ * (1.0 - ppm * 1e-6);
        let holds = format!(
            "a rate {} by {} ppm",
            if ppm > 0.0 { "lower" } else { "higher" },
            f64::abs(ppm)
        );
        text.row(
            &holds,
            increments_at(rate_hz, COUNT),
            &INCREMENTS,
            Counts::used(COUNT),
            Ends::Pass,
        );
    }
    // 3000 samples are no minute.
    let slow = Ends::Inconclusive("calibration: planned 60 s, done 58.8239 s");
    text.row(
        "51 Hz, and the scenario says 50 Hz",
        increments_at(51.0, 3060),
        &INCREMENTS,
        Counts::used(COUNT),
        slow,
    );
    text.input = "rates";
    text.row(
        "51 Hz, and the scenario says 50 Hz",
        csv(&readings(51.0, 3060)),
        &[],
        Counts::used(COUNT),
        slow,
    );
    text.input = "rates";
    let content = csv(&regular());
    text.refused(
        "50 Hz, and the scenario says 100 Hz",
        &content,
        &["imu.rate=\"100 Hz\""],
        "rows come at 50 Hz by their stamps, expected 100 Hz",
    );
    text.refused(
        "50 Hz, and the scenario says 40 Hz",
        &content,
        &["imu.rate=\"40 Hz\""],
        "rows come at 50 Hz by their stamps, expected 40 Hz",
    );
    let rows = moved(|k, t| if k < 1500 { t } else { t + 0.02 * (k - 1500) as f64 });
    text.refused("50 Hz, from half on 25 Hz", csv(&rows), &[], "from here on rows come at 25 Hz");
    let rows = moved(|k, t| if k < 1500 { t } else { t - 0.01 * (k - 1500) as f64 });
    text.refused("50 Hz, from half on 100 Hz", csv(&rows), &[], "from here on rows come at 100 Hz");
    let rows = moved(|k, t| if k < 1500 { t } else { t + 0.02 * 5e-5 * (k - 1500) as f64 });
    text.row(
        "stamps of a clock that is faster by 50 ppm from half on",
        csv(&rows),
        &[],
        Counts::used(COUNT),
        Ends::Pass,
    );
    text.scenario = untimed();
    text.row("no times", content, &[], Counts::used(COUNT), Ends::Pass);
    text.part.finish(15);
}
