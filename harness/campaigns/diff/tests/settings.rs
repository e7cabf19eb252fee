//! Differences between resolved scenarios.

use octant_diff::settings::compare;

fn differences(first: &str, second: &str) -> Vec<(String, Option<String>, Option<String>)> {
    let parsed = |text: &str| text.parse::<toml::Table>().unwrap();
    let found = compare(&parsed(first), &parsed(second));
    found.into_iter().map(|d| (d.key, d.first, d.second)).collect()
}

#[test]
fn keys_are_told_with_both_values() {
    let first = "seed = 1\n[site]\nlatitude = \"30 deg\"\nheight = \"0 m\"\n";
    let second = "seed = 1\n[site]\nlatitude = \"31 deg\"\n[imu]\nrate = 200\n";
    let some = |text: &str| Some(text.to_owned());
    assert_eq!(
        differences(first, second),
        [
            ("imu.rate".to_owned(), None, some("200")),
            ("site.height".to_owned(), some("\"0 m\""), None),
            ("site.latitude".to_owned(), some("\"30 deg\""), some("\"31 deg\"")),
        ]
    );
    assert!(differences(first, first).is_empty());
}

#[test]
fn faults_are_compared_by_their_ids() {
    let one = "[[faults]]\nid = \"a\"\nx = 1\n";
    let two = "[[faults]]\nid = \"b\"\nx = 1\n[[faults]]\nid = \"a\"\nx = 2\n";
    let keys: Vec<String> = differences(one, two).into_iter().map(|d| d.0).collect();
    assert_eq!(keys, ["faults[a].x", "faults[b].id", "faults[b].x"]);
}
