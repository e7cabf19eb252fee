//! Lost rows of rates and increments.

use super::super::rest::{COUNT, Rest};
use super::super::table::{Counts, Ends};
use super::{INCREMENTS, LACKING, Text, UNSETTLED, csv, increments, regular, untimed, without};

#[test]
fn gaps() {
    let mut text = Text::new("gaps of text");
    for is_rates in [true, false] {
        text.input = if is_rates { "rates" } else { "increments" };
        let set: &[&str] = if is_rates { &[] } else { &INCREMENTS };
        let write = |rows: &[Rest]| if is_rates { csv(rows) } else { increments(rows) };
        if !is_rates {
            text.row("regular", write(&regular()), set, Counts::used(COUNT), Ends::Pass);
        }
        for (lost, holds) in [
            (1, "one row lost"),
            (2, "2 rows lost"),
            (15, "0.3 s lost"),
            (25, "0.5 s lost"),
            (50, "1 s lost"),
            (250, "5 s lost"),
        ] {
            let rows = without(|k| (1000..1000 + lost).contains(&k));
            let counts = Counts::used(COUNT - lost).missing(lost);
            let ends = if lost < 250 { Ends::Pass } else { LACKING };
            text.row(holds, write(&rows), set, counts, ends);
        }
        let rows =
            without(|k| [600, 1200, 1800, 2400].iter().any(|from| (*from..from + 25).contains(&k)));
        text.row(
            "0.5 s lost four times",
            write(&rows),
            set,
            Counts::used(COUNT - 100).missing(100),
            LACKING,
        );
        let rows = without(|k| (1000..1400).contains(&k));
        let ends = Ends::Inconclusive("unit.csv has gaps: 400 rows missing");
        text.row("8 s lost", write(&rows), set, Counts::used(COUNT - 400).missing(400), ends);
        let rows = without(|k| (3..28).contains(&k));
        text.row(
            "0.5 s lost behind the third row",
            write(&rows),
            set,
            Counts::used(COUNT - 25).missing(25),
            Ends::Pass,
        );
        let rows = without(|k| (2970..2995).contains(&k));
        text.row(
            "0.5 s lost before the last five rows",
            write(&rows),
            set,
            Counts::used(COUNT - 25).missing(25),
            Ends::Pass,
        );
        let rows = without(|k| k >= 2500);
        text.row(
            "10 s missing at the end",
            write(&rows),
            set,
            Counts::used(2500),
            Ends::Inconclusive(""),
        );
        let rows = without(|k| k % 20 == 7);
        text.row(
            "one row in twenty lost",
            write(&rows),
            set,
            Counts::used(2850).missing(150),
            LACKING,
        );
        let rows = without(|k| k % 5 == 2);
        text.row(
            "one row in five lost",
            write(&rows),
            set,
            Counts::used(2400).missing(600),
            Ends::Inconclusive(""),
        );
        text.refused(
            "every other row lost",
            write(&without(|k| k % 2 == 1)),
            set,
            "rows come at 25 Hz",
        );
    }
    text.input = "rates";
    let rows: Vec<Rest> = without(|k| (1000..1050).contains(&k));
    let rows: Vec<Rest> = rows
        .iter()
        .zip(0..)
        .map(|(row, k)| Rest { time_s: row.time_s + if k % 2 == 0 { 4e-3 } else { -4e-3 }, ..*row })
        .collect();
    text.row(
        "1 s lost, stamps that jitter by ±4 ms",
        csv(&rows),
        &[],
        Counts::used(UNSETTLED).repaired(COUNT - 50 - UNSETTLED).missing(50),
        Ends::Pass,
    );
    let rows: Vec<Rest> = without(|k| (1000..1004).contains(&k))
        .iter()
        .map(|row| Rest { time_s: (row.time_s * 12.5 + 1e-6).floor() / 12.5, ..*row })
        .collect();
    text.row(
        "four rows lost in a file of bursts",
        csv(&rows),
        &[],
        Counts::used(UNSETTLED).repaired(COUNT - 4 - UNSETTLED).missing(4),
        Ends::Pass,
    );
    text.scenario = untimed();
    let rows = without(|k| (1000..1050).contains(&k));
    text.row(
        "1 s lost, no times",
        csv(&rows),
        &[],
        Counts::used(COUNT - 50),
        Ends::Inconclusive(""),
    );
    text.part.finish(30);
}
