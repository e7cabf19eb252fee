//! Units that tell parameters which are no numbers, or hardly: each folder is read by every command.

use super::unit::{HONEST, Over, SCENARIO, Served, Twist, scenario};
use crate::common::program::{json, octant_in};
use octant_sample::parameters::PARAMETER_COUNT;
use octant_score::summary::{NOT_FINITE, Summary, WITH_FINDINGS};
use std::path::Path;

type Values = [f64; PARAMETER_COUNT];
type Tells = fn(u64, &mut Values, &mut Values);

/// Numbers of which each is told as every parameter, every σ, or both.
const TOLD: [(&str, Tells); 9] = [
    ("nan values", |_, values, _| values.fill(f64::NAN)),
    ("nan sigma", |_, _, sigma| sigma.fill(f64::NAN)),
    ("all nan", |_, values, sigma| {
        values.fill(f64::NAN);
        sigma.fill(f64::NAN);
    }),
    ("infinite values", |_, values, _| values.fill(f64::INFINITY)),
    ("one infinity", |_, values, _| values[7] = f64::NEG_INFINITY),
    ("infinite sigma", |_, _, sigma| sigma.fill(f64::INFINITY)),
    ("huge values", |_, values, _| values.fill(f64::MAX)),
    ("huge in the user's unit", |_, values, _| values.fill(1e303)),
    ("subnormal", |_, values, sigma| {
        values.fill(5e-324);
        sigma.fill(5e-324);
    }),
];

/// Runs a command on a folder, which has to read it: the status isn't that of bad input or a broken bench.
#[track_caller]
fn reads(at: &Path, about: &str, arguments: &[&str]) {
    let output = octant_in(at, arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    let is_read = matches!(output.status.code(), Some(0 | 1 | 3));
    assert!(is_read && !error.contains("null"), "{about}: {arguments:?}: {error}");
}

#[test]
fn folders_with_parameters_that_are_no_numbers_are_read_by_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let text = format!("{SCENARIO}[record]\nsamples = \"full\"\n");
    std::fs::write(at.join("s.toml"), text).unwrap();
    let mut schemas = Vec::new();
    for (about, parameters) in TOLD {
        let served = Served::new(Over::Udp, &scenario(""), Twist { parameters, ..HONEST });
        // The common helper reads the folder within this process.
        let output =
            octant_in(at, &["run", "s.toml", "--out", "run", "--force", "--endpoint", &served.uri]);
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(matches!(output.status.code(), Some(1 | 3)), "{about}: {said}");
        for arguments in [
            &["verify", "run"][..],
            &["report", "run", "--out", "again.html"],
            &["rejudge", "run", "--out", "rejudged.json"],
            &["diff", "run", "run"],
            &["score", "run/recording.mcap"],
            &["replay", "run/recording.mcap"],
            &["export", "run", "--to", "csv", "--out", "exported"],
            &["watch", "run", "--once"],
        ] {
            reads(at, about, arguments);
            let _ = std::fs::remove_dir_all(at.join("exported"));
            let _ = std::fs::remove_file(at.join("rejudged.json"));
        }
        // A summary that an older program can read is of the older schema.
        let text = std::fs::read_to_string(at.join("run/summary.json")).unwrap();
        let is_finite = serde_json::from_str::<Summary>(&text).is_ok();
        let schema = json(&at.join("run/summary.json"))["schema"].as_u64().unwrap();
        let expected = if is_finite { WITH_FINDINGS } else { NOT_FINITE };
        assert_eq!(schema, u64::from(expected), "{about}");
        schemas.push(expected);
    }
    schemas.sort_unstable();
    schemas.dedup();
    assert_eq!(schemas, [WITH_FINDINGS, NOT_FINITE], "both kinds are among them");
}
