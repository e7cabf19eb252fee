//! `octant new`: scenarios that are valid, commented, and never replace another.

use crate::common::program::{ended, octant_in};
use clap::ValueEnum;
use octant::new::{InstrumentGrade, NewArguments, NewMotion, answers, scenario};
use octant_scenario::{GRADES, Scenario};
use std::path::{Path, PathBuf};

fn arguments() -> NewArguments {
    NewArguments {
        file: PathBuf::from("bench.toml"),
        instrument: None,
        motion: None,
        positions: None,
        calibration: Some("2 h".to_owned()),
        navigation: None,
        limit: None,
        title: None,
        defaults: false,
        force: false,
    }
}

#[test]
fn every_choice_has_the_sheet_of_its_name() {
    let names: Vec<String> = InstrumentGrade::value_variants()
        .iter()
        .filter_map(ValueEnum::to_possible_value)
        .map(|value| value.get_name().to_owned())
        .collect();
    assert_eq!(names, GRADES.map(|sheet| sheet.name));
    for (grade, sheet) in InstrumentGrade::value_variants().iter().zip(GRADES) {
        assert_eq!(grade.sheet().name, sheet.name);
    }
}

#[test]
fn what_is_not_given_is_asked_until_it_is_a_known_name() {
    let lines = "my bench\n\n6 h\n0.5 nmi\nmems\ntactical-mems\n\n";
    let found = answers(&arguments(), Some(lines.as_bytes())).expect("has all answers");
    assert_eq!((found.title.as_str(), found.positions.as_str()), ("my bench", "eight"));
    assert_eq!((found.calibration.as_str(), found.navigation.as_str()), ("2 h", "6 h"));
    assert_eq!(found.instrument, InstrumentGrade::TacticalMems);
    assert_eq!(found.limit.as_deref(), Some("0.5 nmi"));
    let ended = answers(&arguments(), Some("a\n".as_bytes()));
    assert!(ended.is_err_and(|failure| failure.to_string().contains("end of the input")));
}

#[test]
fn every_grade_gives_a_scenario() {
    for grade in InstrumentGrade::value_variants() {
        for motion in [NewMotion::Static, NewMotion::Dockside] {
            let given =
                NewArguments { instrument: Some(*grade), motion: Some(motion), ..arguments() };
            let found = answers(&given, None::<&[u8]>).expect("defaults");
            let text = scenario(&found);
            let parsed = Scenario::parse(&text, "new.toml", Path::new(""), &[]);
            let parsed = parsed.unwrap_or_else(|error| panic!("{grade:?}: {error}\n{text}"));
            assert!(parsed.requirements.is_empty() && parsed.baseline.is_none());
            assert!(text.contains("# Source: "), "{text}");
        }
    }
}

#[test]
fn a_new_scenario_is_valid_and_needs_force_to_be_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let new = |more: &[&str], status: i32| {
        ended(octant_in(folder.path(), &[&["new", "bench.toml"][..], more].concat()), status)
    };
    let (said, _) = new(&["--instrument", "tactical-mems", "--limit", "300 nmi"], 0);
    assert_eq!(said, "bench.toml\nnext: octant observe bench.toml\nnext: octant run bench.toml\n");
    let (said, _) = ended(octant_in(folder.path(), &["new", "a bench.toml", "--defaults"]), 0);
    let next = "next: octant observe 'a bench.toml'\nnext: octant run 'a bench.toml'\n";
    assert_eq!(said, format!("a bench.toml\n{next}"));
    let file = folder.path().join("bench.toml");
    let scenario = Scenario::load(&file, &[]).unwrap();
    assert_eq!((scenario.title.as_str(), scenario.requirements.len()), ("bench", 1));
    // 0.15 deg/sqrt(h) of the data sheet, by hand: 0.15 pi / 180 / 60 rad/sqrt(s).
    let walk = 0.15 * std::f64::consts::PI / 180.0 / 60.0;
    assert!((scenario.imu.angle_random_walk / walk - 1.0).abs() < 1e-12);
    let (_, said) = new(&[], 2);
    assert!(said.contains("found bench.toml already") && said.contains("--force"), "{said}");
    new(&["--force"], 0);
    assert!(
        std::fs::read_to_string(&file).unwrap().contains("Zheng, Han and Zheng (2015), Table 1")
    );
}

/// The first run of a preset has a result; what its comments say of the noise that is left out is true.
#[test]
fn a_mems_instrument_calibrates_at_once_and_is_refused_with_its_bias_instability() {
    let folder = tempfile::tempdir().unwrap();
    let options =
        ["--instrument", "tactical-mems", "--calibration", "1 h", "--navigation", "10 min"];
    ended(octant_in(folder.path(), &[&["new", "mems.toml"][..], &options].concat()), 0);
    let file = folder.path().join("mems.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let (said, _) = ended(octant_in(folder.path(), &["run", "mems.toml"]), 0);
    assert!(said.contains("calibration 1 h: NIS") && said.contains("navigation"), "{said}");
    assert!(!said.contains("refused"), "{said}");

    let scenario = Scenario::load(&file, &[]).unwrap();
    assert_eq!(scenario.imu.extensions.gyro_bias_instability, 0.0);
    assert!(text.contains("Take the # before the two keys away"), "{text}");
    let noisy = text.replace("# extensions.", "extensions.");
    assert_eq!(noisy.matches("\nextensions.").count(), 2, "{text}");
    std::fs::write(&file, noisy).unwrap();
    let expected = 0.753 * std::f64::consts::PI / 180.0 / 3600.0;
    let scenario = Scenario::load(&file, &[]).unwrap();
    assert!((scenario.imu.extensions.gyro_bias_instability / expected - 1.0).abs() < 1e-12);
    let (said, _) = ended(octant_in(folder.path(), &["run", "mems.toml"]), 1);
    assert!(said.contains("refused"), "{said}");
}

#[test]
fn a_wrong_answer_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    for (option, value, expected) in [
        ("--calibration", "4 m", "a length; expected a time"),
        ("--positions", "seven", "procedure.calibration.positions: found \"seven\""),
        ("--limit", "1 deg", "expected a quantity that is comparable with nmi"),
        ("--instrument", "mems", "tactical-mems"),
    ] {
        let output = octant_in(folder.path(), &["new", "a.toml", option, value]);
        let (_, said) = ended(output, 2);
        assert!(said.contains(expected), "{option}: {said}");
        assert!(!folder.path().join("a.toml").exists());
    }
}

#[cfg(target_os = "linux")]
#[test]
fn defaults_take_the_place_of_questions_on_a_terminal() {
    use crate::common::program::program;
    use crate::operator_ways::on_terminal;
    use std::io::Write;
    use std::process::Stdio;
    let folder = tempfile::tempdir().unwrap();
    let new = |more: &[&str]| {
        let mut command = program(&["new", "a.toml"]);
        command.args(more).current_dir(folder.path()).stdout(Stdio::null());
        on_terminal(&mut command)
    };
    let (mut keys, asked) = new(&[]);
    asked.hears("title [a]:", 1);
    // The end of the input.
    keys.write_all(b"\x04").unwrap();
    assert_eq!(asked.end().0, Some(2));
    assert!(!folder.path().join("a.toml").exists());
    let (_keys, written) = new(&["--defaults"]);
    let (status, words) = written.end();
    assert_eq!((status, words.as_str()), (Some(0), ""));
    assert!(folder.path().join("a.toml").exists());
}
