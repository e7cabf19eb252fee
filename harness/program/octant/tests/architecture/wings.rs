//! Wings: the folders of crates, in the order in which a reader meets them. Each uses only those above it, and itself.
//!
//! What tests use keeps to the same order, with two exceptions. Tools for tests stand in `support`, and the tests of the
//! models, which are above it, use them too. The tests of `test_loop` compare the core with whole runs, so they use what is
//! below.

use super::{Graph, circles, graph, members, root};
use std::collections::{BTreeMap, BTreeSet};

/// Wings, from the first to the last.
pub(super) const WINGS: [&str; 11] = [
    "models",
    "support",
    "devices",
    "scenario",
    "fmu",
    "results",
    "line",
    "studies",
    "campaigns",
    "systems",
    "program",
];
/// Crates that no product is built with.
const FOR_TESTS: [&str; 3] = ["json_schema", "test_loop", "test_processes"];

/// What crates take from a wing below their own, as `"crate of wing takes crate of wing"`.
fn against_the_order(wing_of: &BTreeMap<String, String>, needs: &Graph) -> Vec<String> {
    let place = |name: &str| {
        let wing = wing_of.get(name).unwrap_or_else(|| panic!("{name} has no wing"));
        let place = WINGS.iter().position(|of_order| of_order == wing);
        (place.unwrap_or_else(|| panic!("{wing} is no wing")), wing)
    };
    let mut found = Vec::new();
    for (from, all) in needs {
        for to in all {
            let ((here, wing), (there, below)) = (place(from), place(to));
            if there > here {
                found.push(format!("{from} of {wing} takes {to} of {below}"));
            }
        }
    }
    found
}

/// The graph of wings, without what a wing takes from itself.
pub(super) fn graph_of_wings(wing_of: &BTreeMap<String, String>, needs: &Graph) -> Graph {
    let mut wings = Graph::new();
    for (from, all) in needs {
        let wing = &wing_of[from];
        let others = all.iter().map(|to| wing_of[to].clone()).filter(|other| other != wing);
        wings.entry(wing.clone()).or_default().extend(others);
    }
    wings
}

/// Wings of the crates.
pub(super) fn wings() -> BTreeMap<String, String> {
    members().iter().map(|(name, member)| (name.clone(), member.wing().to_owned())).collect()
}

/// What the crates are built with.
pub(super) fn built() -> Graph {
    members().into_iter().map(|(name, member)| (name, member.needs)).collect()
}

/// So the graph of wings has no circle.
#[test]
fn each_wing_uses_only_those_above_it() {
    assert_eq!(against_the_order(&wings(), &built()), Vec::<String>::new());
}

#[test]
fn tests_keep_to_the_order_of_wings() {
    let needs = members().into_iter().filter(|(name, _)| name != "test_loop");
    let needs = needs.map(|(name, mut member)| {
        member.tests_need.retain(|name| !FOR_TESTS.contains(&name.as_str()));
        (name, member.tests_need)
    });
    assert_eq!(against_the_order(&wings(), &needs.collect()), Vec::<String>::new());
}

#[test]
fn nothing_is_built_with_what_is_for_tests() {
    let built = built();
    for name in FOR_TESTS {
        assert!(built.contains_key(name), "{name} is no crate");
        let with: Vec<&String> =
            built.iter().filter(|(_, all)| all.contains(name)).map(|(from, _)| from).collect();
        assert!(with.is_empty(), "{with:?} are built with {name}");
    }
}

#[test]
fn a_wing_that_uses_one_below_it_is_found() {
    let wing_of = [
        ("plant", "models"),
        ("wire", "devices"),
        ("score", "results"),
        ("run", "line"),
        ("source", "line"),
    ];
    let wing_of = wing_of.map(|(name, wing)| (name.to_owned(), wing.to_owned())).into();
    let straight = graph(&[
        "plant:",
        "wire: plant",
        "score: wire",
        "source: score plant",
        "run: source score",
    ]);
    assert_eq!(against_the_order(&wing_of, &straight), Vec::<String>::new());
    assert_eq!(circles(&graph_of_wings(&wing_of, &straight)), Vec::<Vec<String>>::new());
    // No circle of crates, and none the less a circle of wings.
    let twisted = graph(&["score: source", "source: wire", "run: score"]);
    assert_eq!(against_the_order(&wing_of, &twisted), ["score of results takes source of line"]);
    assert_eq!(circles(&twisted), Vec::<Vec<String>>::new());
    assert_eq!(circles(&graph_of_wings(&wing_of, &twisted)), [["line", "results"]]);
}

/// A reader of the root manifest and one of `ls` see the same wings.
#[test]
fn the_wings_are_the_folders_of_the_repository() {
    let of_members: BTreeSet<String> = wings().into_values().collect();
    assert_eq!(of_members, WINGS.map(str::to_owned).into());
    let folders = std::fs::read_dir(root().join("harness")).unwrap();
    for folder in folders.map(|entry| entry.unwrap().file_name().into_string().unwrap()) {
        assert!(WINGS.contains(&folder.as_str()), "harness/{folder} is no wing");
    }
    let places = members()
        .into_iter()
        .map(|(_, member)| WINGS.iter().position(|wing| *wing == member.wing()).unwrap());
    assert!(places.is_sorted(), "members of the workspace by the order of their wings");
}
