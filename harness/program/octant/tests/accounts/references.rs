//! References that were measured beside the samples, whole and damaged.

use super::rest::{BEGIN_S, COUNT, RATE_HZ, readings, scenario};
use super::table::{Case, Counts, Ends, Part};
use super::text::{SOURCE, csv};

const NAME: &str = "gnss.csv, reference";
/// Number of measurements, one a second.
const SECONDS: u64 = 60;

/// Scenario with a velocity that was measured beside the samples.
fn measured() -> String {
    scenario(SOURCE).replace(
        "kind = \"static\"",
        "kind = \"velocity\"
file = \"gnss.csv\"
header = true
delimiter = \"comma\"
time_column = \"t\"
north = \"vn\"
east = \"ve\"
down = \"vd\"
unit = \"m/s\"",
    )
}

/// A row at each time, s: an instrument that rests.
fn velocities(times_s: impl Iterator<Item = f64>) -> Vec<String> {
    times_s.map(|time_s| format!("{time_s:.3},0,0,0")).collect()
}

/// Times at the samples at which measurements are due.
fn seconds() -> impl Iterator<Item = f64> {
    (1..=SECONDS).map(|k| BEGIN_S + k as f64 - 1.0 / RATE_HZ)
}

struct References {
    part: Part,
    samples: String,
    input: &'static str,
}

impl References {
    fn row(
        &mut self,
        holds: &str,
        rows: &[String],
        counts: Counts,
        ends: Ends,
    ) -> super::table::Parameters {
        let content = format!("t,vn,ve,vd\n{}\n", rows.join("\n"));
        let scenario = measured();
        let files: [(&str, &[u8]); 3] = [
            ("s.toml", scenario.as_bytes()),
            ("unit.csv", self.samples.as_bytes()),
            ("gnss.csv", content.as_bytes()),
        ];
        let counts: &[_] = if matches!(ends, Ends::Refused(_)) { &[] } else { &[(NAME, counts)] };
        self.part.run(&Case { input: self.input, holds, files: &files, set: &[], counts, ends })
    }
}

#[test]
fn measured_references() {
    let mut part = References {
        part: Part::new("references"),
        samples: csv(&readings(RATE_HZ, COUNT)),
        input: "a velocity in a file of its own",
    };
    let used = Counts::used;
    let all = velocities(seconds());
    let clean = part.row("one a second", &all, used(SECONDS), Ends::Pass);
    part.part.clean = Some(clean);
    let late = velocities(seconds().map(|t| t + 0.008));
    part.row("8 ms behind the samples", &late, used(SECONDS), Ends::Pass);
    let early: Vec<String> =
        velocities((1..=5).map(f64::from)).into_iter().chain(all.clone()).collect();
    part.row("five measurements before the samples", &early, used(SECONDS).left_out(5), Ends::Pass);
    // The run ends with the last measurement: the row behind it isn't read.
    let empty: Vec<String> = all
        .iter()
        .flat_map(|row| [row.clone(), format!("{},,,", row.split(',').next().unwrap())])
        .collect();
    part.row("an empty row behind each", &empty, used(SECONDS).left_out(SECONDS - 1), Ends::Pass);
    let again: Vec<String> = all.iter().flat_map(|row| [row.clone(), row.clone()]).collect();
    part.row("each one twice", &again, used(SECONDS).left_out(SECONDS - 1), Ends::Pass);
    let mut gap = all.clone();
    gap.drain(20..30);
    part.row(
        "10 s of it lost",
        &gap,
        used(SECONDS - 10),
        Ends::Inconclusive("references for the calibration: planned 60, done 50"),
    );
    let lacks =
        Ends::Inconclusive("the calibration was refused for the measurements that it lacks");
    part.row("the last 40 s lost", &all[..20], used(20), lacks);
    let lost: String = {
        let rows = readings(RATE_HZ, COUNT).into_iter().zip(0_u64..);
        csv(&rows
            .filter(|(_, k)| !(1000..1050).contains(k))
            .map(|(row, _)| row)
            .collect::<Vec<_>>())
    };
    let whole = std::mem::replace(&mut part.samples, lost);
    part.row("1 s of the samples lost", &all, used(SECONDS - 1).left_out(1), Ends::Pass);
    part.samples = whole;
    part.row(
        "a clock of its own, 100 s ahead",
        &velocities(seconds().map(|t| t + 100.0)),
        used(0).left_out(1),
        lacks,
    );
    part.row(
        "ten a second, one a second is due",
        &velocities((0..600).map(|k| BEGIN_S + f64::from(k) / 10.0)),
        used(0),
        Ends::Refused("is 0.1 s after the one before"),
    );
    let mut swapped = all.clone();
    swapped.swap(20, 21);
    part.row(
        "two rows in the wrong order",
        &swapped,
        used(0),
        Ends::Refused("is not after the one before"),
    );
    let mut two = all.clone();
    two[20] = two[20].replace(",0,0,0", ",0,,0");
    part.row(
        "one of three numbers missing",
        &two,
        used(0),
        Ends::Refused("found no east beside the others"),
    );
    let mut nan = all.clone();
    nan[20] = nan[20].replace(",0,0,0", ",0,nan,0");
    part.row("not a number", &nan, used(0), Ends::Refused("line 22: column 3: found \"nan\""));
    part.row("no rows", &[], used(0), lacks);
    part.part.finish(12);
}
