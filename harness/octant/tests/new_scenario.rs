//! `octant new`: scenarios that are valid, commented, and never replace another.

use crate::common::program::{ended, octant_in};
use octant_scenario::Scenario;

#[test]
fn a_new_scenario_is_valid_and_needs_force_to_be_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let new = |more: &[&str], status: i32| {
        ended(octant_in(folder.path(), &[&["new", "bench.toml"][..], more].concat()), status)
    };
    let (said, _) = new(&["--instrument", "tactical-mems", "--limit", "300 nmi"], 0);
    assert_eq!(said, "bench.toml\nnext: octant observe bench.toml\nnext: octant run bench.toml\n");
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
