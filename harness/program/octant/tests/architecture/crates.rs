//! The graph of crates: no circle, and no crate depends on one that it must know nothing of.

use super::{Member, circles, graph, members};
use std::collections::{BTreeMap, BTreeSet};

#[test]
fn the_graph_of_crates_has_no_circle() {
    // Cargo itself refuses a circle of what is built, but not one through what tests need.
    let tested = members()
        .iter()
        .map(|(name, member)| (name.clone(), &member.needs | &member.tests_need))
        .collect();
    assert_eq!(circles(&tested), Vec::<Vec<String>>::new());
    assert_eq!(circles(&graph(&["a: b", "b: c", "c: b", "d: d"])), [vec!["b", "c"], vec!["d"]]);
}

#[test]
fn the_core_never_sees_the_truth_and_the_plant_never_an_estimate() {
    let members: BTreeMap<String, Member> = members().into_iter().collect();
    let reach = |from: &str| {
        let mut found = BTreeSet::new();
        let mut open = vec![from.to_owned()];
        while let Some(name) = open.pop() {
            for next in &members[&name].needs {
                if found.insert(next.clone()) {
                    open.push(next.clone());
                }
            }
        }
        found
    };
    for (from, never) in [
        ("calibration", &["plant", "faults", "random"][..]),
        ("plant", &["calibration"][..]),
        ("scenario", &["source", "endpoint", "host", "unit", "run", "score"][..]),
        ("score", &["source", "endpoint", "run", "scenario"][..]),
        ("report", &["run", "campaign", "source", "endpoint"][..]),
    ] {
        for name in never {
            assert!(members.contains_key(*name), "{name} is no crate");
            assert!(!reach(from).contains(*name), "{from} reaches {name}");
        }
    }
}
