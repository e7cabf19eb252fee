//! Known answers, each computed again.

use octant_selftest::answers::cases;
use octant_selftest::bench::CaseBench;
use octant_selftest::judge::Expectation;

#[test]
fn every_number_that_is_known_is_found_and_the_other_way_round() {
    let folder = tempfile::tempdir().unwrap();
    let cancel = std::sync::atomic::AtomicBool::new(false);
    let mut all_wrong = Vec::new();
    for case in cases() {
        // These cases need the program.
        if matches!(case.id, "answers-navigation" | "answers-campaign") {
            continue;
        }
        let Expectation::Numbers { known, .. } = &case.expectation else { panic!() };
        let bench = CaseBench::new(std::path::Path::new("octant"), folder.path(), &cancel).unwrap();
        let found = (case.run)(&bench).unwrap().numbers;
        let mut names: Vec<&str> = known.iter().map(|k| k.name.as_str()).collect();
        names.sort_unstable();
        let ours: Vec<&str> = found.keys().map(String::as_str).collect();
        assert_eq!(names, ours, "{}", case.id);
        assert!(names.len() >= 3, "{}", case.id);
        let wrong =
            known.iter().filter(|k| !((found[&k.name] - k.value).abs() <= k.tolerance)).map(|k| {
                format!("{}: {:e} of {:e} ± {:e}", k.name, found[&k.name], k.value, k.tolerance)
            });
        all_wrong.extend(wrong.map(|words| format!("{}: {words}", case.id)));
    }
    assert!(all_wrong.is_empty(), "{}", all_wrong.join("\n"));
}
