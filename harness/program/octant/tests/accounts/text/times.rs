//! Stamps: jitter, bursts, rows out of order, clocks that are set, resolutions and units.

use super::super::rest::{BEGIN_S, COUNT};
use super::super::table::{Counts, Ends};
use super::{Text, UNSETTLED, csv, moved, regular, stamped};

#[test]
fn times() {
    let mut text = Text::new("times of text");
    let used = Counts::used;
    // Jitter.
    let rows = moved(|k, t| t + if k % 2 == 0 { 2e-4 } else { -2e-4 });
    text.row("stamps that jitter by ±0.2 ms", csv(&rows), &[], used(COUNT), Ends::Pass);
    let late = |k: u64| k % 10 == 5 && k > 10;
    let count = (0..COUNT).filter(|k| late(*k)).count() as u64;
    let rows = moved(|k, t| t + if late(k) { 4e-3 } else { 0.0 });
    text.row(
        "one stamp in ten 4 ms late",
        csv(&rows),
        &[],
        used(COUNT - count).repaired(count),
        Ends::Pass,
    );
    let rows = moved(|k, t| t + if k % 2 == 0 { 4e-3 } else { -4e-3 });
    text.row(
        "stamps that jitter by ±4 ms",
        csv(&rows),
        &[],
        used(UNSETTLED).repaired(COUNT - UNSETTLED),
        Ends::Pass,
    );
    let rows = moved(|k, t| t - 0.02 * (k % 4) as f64);
    text.row(
        "bursts: four rows have the stamp of their first",
        csv(&rows),
        &[],
        used(UNSETTLED).repaired(COUNT - UNSETTLED),
        Ends::Pass,
    );
    let rows = moved(|_, t| (t * 100.0 + 1e-6).floor() / 100.0);
    text.row("stamps of 10 ms", csv(&rows), &[], used(COUNT), Ends::Pass);
    let twice = |k: u64| k % 8 == 3;
    let rows = moved(|k, t| if twice(k) { t - 0.02 } else { t });
    // The fit is that of all stamps, 2.5 ms before the most of them.
    text.row(
        "one stamp in eight is that of the row before",
        csv(&rows),
        &[],
        used(UNSETTLED).repaired(COUNT - UNSETTLED),
        Ends::Pass,
    );
    // Rows twice, and in another order.
    let mut rows = regular();
    for k in [2500, 2000, 1500, 1000, 500] {
        rows.insert(k, rows[k]);
    }
    text.row("five rows twice", csv(&rows), &[], used(COUNT).left_out(5), Ends::Pass);
    let mut rows = regular();
    rows.swap(1000, 1001);
    text.row(
        "two rows in the wrong order",
        csv(&rows),
        &[],
        used(COUNT - 2).repaired(2),
        Ends::Pass,
    );
    let mut rows = regular();
    let late = rows.remove(1000);
    rows.insert(1005, late);
    text.row("a row five rows too late", csv(&rows), &[], used(COUNT - 6).repaired(6), Ends::Pass);
    // Clocks that are set.
    let rows = moved(|k, t| if (1000..1100).contains(&k) { t - 1.9 } else { t });
    text.refused(
        "the clock goes back by 1.9 s for 2 s",
        csv(&rows),
        &[],
        "line 1002: the clock goes back from ",
    );
    let unix = 1.740_564_858e9;
    let rows = moved(|k, t| if (1000..1100).contains(&k) { 315_965_235.05 + t } else { unix + t });
    text.refused(
        "Unix stamps; the clock is in 1980 for 2 s",
        csv(&rows),
        &[],
        "line 1002: the clock goes back from ",
    );
    let rows = moved(|k, t| if k < 1000 { t } else { unix + t });
    text.refused(
        "the clock is set to the date within the file",
        csv(&rows),
        &[],
        "line 1002: the clock jumps ahead from ",
    );
    let rows = moved(|k, t| if k < 1000 { t } else { t - 30.0 + BEGIN_S });
    text.refused(
        "the unit restarts: the clock begins again",
        csv(&rows),
        &[],
        "line 1002: the clock goes back from ",
    );
    // Resolutions.
    let rows = moved(|_, t| f64::from((unix + t) as f32));
    text.refused(
        "Unix stamps in float32: one for 128 s",
        csv(&rows),
        &[],
        "the stamps stand still at ",
    );
    let rows = moved(|_, t| f64::from((10_000.0 + t) as f32));
    text.row("seconds of the day in float32: 1 ms", csv(&rows), &[], used(COUNT), Ends::Pass);
    let rows = moved(|_, _| 0.0);
    text.refused(
        "all stamps 0",
        csv(&rows),
        &[],
        "the stamps stand still at 0 s: they are too coarse for 50 Hz",
    );
    let rows = moved(|_, t| t.floor());
    text.refused("stamps of whole seconds", csv(&rows), &[], "the stamps stand still at ");
    // Units of the stamps.
    for (unit, name, per_s, digits) in [
        ("ms", "milliseconds", 1e3, 3),
        ("us", "microseconds", 1e6, 1),
        ("ns", "nanoseconds", 1e9, 0),
    ] {
        let content = stamped(&regular(), |row| format!("{:.digits$}", row.time_s * per_s));
        let set = format!("source.text.time_unit={unit}");
        text.row(&format!("stamps in {name}"), content, &[&set], used(COUNT), Ends::Pass);
    }
    let content = stamped(&regular(), |row| format!("{:.6}", row.time_s + unix));
    text.row("Unix stamps in s", content, &[], used(COUNT), Ends::Pass);
    let content = stamped(&regular(), |row| format!("{:.3}", row.time_s * 1e3));
    text.refused("stamps in milliseconds, taken as s", content, &[], "");
    let content = stamped(&regular(), |row| format!("{:.9}", row.time_s - 30.0));
    text.refused("stamps from -20 s on", content, &[], "expected a time from 0 to");
    let content = stamped(&regular(), |row| {
        format!("2025-02-26T10:{:02}:{:06.3}Z", row.time_s as u64 / 60, row.time_s % 60.0)
    });
    text.row("stamps as ISO 8601", content, &[], used(COUNT), Ends::Pass);
    text.part.finish(20);
}
