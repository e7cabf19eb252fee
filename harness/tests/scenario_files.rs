//! The scenarios that ship with Octant: each is read, resolved and read again.
#![allow(clippy::unwrap_used)]

use octant::scenario::resolve::{Draws, Variates};
use octant::scenario::{Method, Scenario};
use octant_earth::Vector3;
use std::path::{Path, PathBuf};

/// Numbers that depend on stream and index, and look drawn.
struct Numbers;

impl Variates for Numbers {
    fn normal(&mut self, stream: &str, index: u64) -> f64 {
        6.0 * self.uniform(stream, index) - 3.0
    }

    fn uniform(&mut self, stream: &str, index: u64) -> f64 {
        let start = 0x9E37_79B9_7F4A_7C15u64 ^ index;
        let hash = stream.bytes().fold(start, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3).rotate_left(23)
        });
        (hash >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn files() -> Vec<PathBuf> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../fixtures/scenarios");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(files.len() >= 6);
    files
}

fn both_configurations(scenario: &Scenario) -> String {
    let draws = Draws::of(scenario, &mut Numbers);
    let plant = scenario.plant(scenario.seed, &draws);
    let core = |method| scenario.core(method, &draws, &scenario.mean_attitude(), &Vector3::zeros());
    // Debug prints every field, and floats so that they read back to the same bits.
    format!(
        "{plant:?} {:?} {:?} {:?} {:?} {:?}",
        core(Method::Primary),
        core(Method::Baseline),
        scenario.requirements,
        scenario.record,
        scenario.source
    )
}

#[test]
fn every_shipped_scenario_is_one() {
    for file in files() {
        let scenario = Scenario::load(&file, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert_ne!(scenario.title, "untitled", "{}", file.display());
        assert!(std::fs::read_to_string(&file).unwrap().starts_with("# "), "{}", file.display());
    }
}

#[test]
fn a_resolved_scenario_makes_the_same_run_and_resolves_to_itself() {
    for file in files() {
        let scenario = Scenario::load(&file, &[]).unwrap();
        let draws = Draws::of(&scenario, &mut Numbers);
        let resolved = scenario.to_resolved_toml(scenario.seed, &draws);
        let again = Scenario::parse(&resolved, "resolved", Path::new("/elsewhere"), &[])
            .unwrap_or_else(|error| panic!("{error}\n{resolved}"));
        assert_eq!(both_configurations(&again), both_configurations(&scenario), "{resolved}");
        let draws = Draws::of(&again, &mut Numbers);
        assert_eq!(again.to_resolved_toml(again.seed, &draws), resolved);
    }
}
