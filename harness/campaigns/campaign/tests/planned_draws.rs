//! Plans with factors that are drawn: their ids, and what is checked of their cases.

use octant_campaign::plan::Plan;
use octant_campaign::plan::progress::PlanStage;
use std::cell::RefCell;
use tempfile::TempDir;

const SCENARIO: &str = r#"schema = 1
title = "short"
seed = 1
[imu.extensions.temperature]
ramp = "1 K/min"
plateau = "1 K"
[procedure.calibration]
positions = "eight"
duration = "24 min"
[procedure.navigation]
duration = "10 min"
[[faults]]
id = "spike-1"
kind = "spike"
trigger = { at = "500 s" }
duration = "10 samples"
channels = "gyro x"
amplitude = "100 deg/h"
[[requirements]]
id = "NAV-1"
text = "It stays near."
measure = "navigation.radial_error_nmi.max"
limit = "10 nmi"
"#;

const MEMBER: &str = r#"[[scenarios]]
id = "short"
file = "short.toml"
"#;

/// Grid, faults that are drawn, two correlated numbers.
const MIXED: &str = r#"design = "latin-hypercube"
[[scenarios]]
id = "short"
file = "short.toml"
[[scenarios]]
id = "six"
file = "short.toml"
set = { "procedure.calibration.positions" = "six" }
[[factors]]
name = "latitude"
key = "site.latitude"
values = ["0 deg", "60 deg"]
[[factors]]
name = "fault"
faults = [[], ["spike-1"]]
draw = true
[[factors]]
name = "amplitude"
key = "faults.spike-1.amplitude"
unit = "deg/h"
uniform = [10, 1000]
[[factors]]
name = "plateau"
key = "imu.extensions.temperature.plateau"
unit = "K"
normal = [2, 0.5]
within = [1, 3]
[[correlations]]
first = "amplitude"
second = "plateau"
value = 0.5
"#;

/// Stages that were told, with how many cases were done of how many.
type Told = Vec<(PlanStage, usize, usize)>;

/// Plans a campaign; returns the plan or the error as text, and what was told.
fn planned(replicates: u32, rest: &str) -> (Result<Plan, String>, Told) {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("short.toml"), SCENARIO).unwrap();
    let path = folder.path().join("campaign.toml");
    let head = format!("schema = 1\ntitle = \"draws\"\nseed = 1\nreplicates = {replicates}\n");
    std::fs::write(&path, head + rest).unwrap();
    let told = RefCell::new(Told::new());
    let tell = |stage, done, total| told.borrow_mut().push((stage, done, total));
    let plan = Plan::of_told(&path, &tell).map_err(|error| error.to_string());
    if let Ok(plan) = &plan {
        assert!(plan.is_of(&path));
        assert_eq!(*plan, Plan::of(&path).unwrap());
    }
    (plan, told.into_inner())
}

/// Returns a factor that is drawn uniformly.
fn uniform(key: &str, unit: &str, [low, high]: [f64; 2]) -> String {
    format!("[[factors]]\nname = {key:?}\nunit = {unit:?}\nuniform = [{low:?}, {high:?}]\n")
}

const RAMP: &str = "imu.extensions.temperature.ramp";
const PLATEAU: &str = "imu.extensions.temperature.plateau";

/// Returns the number of times that a case was checked.
fn checks(told: &Told) -> usize {
    told.iter().filter(|(stage, ..)| *stage == PlanStage::Checking).count()
}

/// The ids are of the program that set up each case on its own. The id of a plan is the hash of all of its bytes but names of files.
#[test]
fn plans_are_those_of_the_program_that_set_up_each_case() {
    let latitude = MEMBER.to_owned() + &uniform("site.latitude", "deg", [-70.0, 70.0]);
    let ids = [(300, MIXED), (300, latitude.as_str()), (300, MEMBER), (5, MIXED)].map(
        |(replicates, rest)| {
            let plan = planned(replicates, rest).0.unwrap();
            (plan.cases.len(), plan.id)
        },
    );
    let expected = [
        (1200, "0278f833fb6983d6dd51c369953733744ddc1424949399c5a223b7e923ad0158"),
        (300, "c8b14170f7d64fd047cd6c576e732b6e1f20ff3f0447cce00749a55b44289937"),
        (300, "9dac8c06a610e51c86fbb7ecac8c5606cc060f46a00f298e72adc0d50b8843cc"),
        (20, "74386fb5d82cd39feb27a3e3db180a8354938a7b72419e7956fb20a7abd03e9d"),
    ];
    assert_eq!(ids, expected.map(|(cases, id)| (cases, id.to_owned())));
}

#[test]
fn cases_between_the_edges_cost_no_check() {
    let latitude = MEMBER.to_owned() + &uniform("site.latitude", "deg", [-70.0, 70.0]);
    let few = checks(&planned(200, &latitude).1);
    let many = checks(&planned(10_000, &latitude).1);
    assert!((64..80).contains(&few) && (64..80).contains(&many), "{few} and {many}");
    assert_eq!(checks(&planned(10_000, MEMBER).1), 1);
}

#[test]
fn all_stages_are_told_in_order() {
    let (plan, told) = planned(2500, MEMBER);
    assert_eq!(plan.unwrap().cases.len(), 2500);
    assert!(told.is_sorted_by_key(|(stage, done, _)| (*stage, *done)), "{told:?}");
    for stage in [PlanStage::Making, PlanStage::Hashing] {
        let of: Vec<_> = told.iter().filter(|(of, ..)| *of == stage).collect();
        assert_eq!(of, [&(stage, 0, 2500), &(stage, 1000, 2500), &(stage, 2000, 2500)]);
    }
}

/// The first case of the plan that can't be set up is named, however few there are.
#[test]
fn a_draw_beyond_a_bound_is_refused_with_its_value() {
    let rest = MEMBER.to_owned() + &uniform("site.latitude", "deg", [0.0, 89.4]);
    let (refused, told) = planned(5000, &rest);
    // A draw in 900 is beyond the bound; the first of them is no edge.
    assert_eq!(
        refused.unwrap_err(),
        "--set site.latitude=\"89.37879661949394 deg\": site.latitude: found \"89.37879661949394 deg\", \
         expected a value within ±89.3 deg: at the poles east has no direction"
    );
    let (stage, _, total) = told.last().unwrap();
    assert_eq!((*stage, *total), (PlanStage::Checking, 5000));
}

/// Ramp and plateau have to have the same sign: neither has a bound of its own.
#[test]
fn draws_that_exclude_each_other_are_refused() {
    let campaign = |ramp| {
        let factors = uniform(RAMP, "K/min", ramp) + &uniform(PLATEAU, "K", [-3.0, 3.0]);
        planned(500, &(MEMBER.to_owned() + &factors))
    };
    let refused = campaign([-1.0, 1.0]).0.unwrap_err();
    assert!(refused.contains("which never gets there"), "{refused}");
    assert!(campaign([0.1, 1.0]).0.is_err());
}

/// Edges that no case has prove nothing: here ramp and plateau have the same sign in each case.
#[test]
fn cases_are_what_decides_where_an_edge_is_refused() {
    let factors = uniform(RAMP, "K/min", [-1.0, 1.0]) + &uniform(PLATEAU, "K", [-3.0, 3.0]);
    let correlation = |value: f64| {
        format!("[[correlations]]\nfirst = {RAMP:?}\nsecond = {PLATEAU:?}\nvalue = {value:?}\n")
    };
    let rest = MEMBER.to_owned() + &factors + &correlation(0.999);
    let (plan, told) = planned(20, &rest);
    assert_eq!(plan.unwrap().cases.len(), 20);
    assert!(checks(&told) > 20, "each case is checked after an edge was refused");
    let rest = MEMBER.to_owned() + &factors + &correlation(-0.999);
    assert!(planned(20, &rest).0.is_err());
}
