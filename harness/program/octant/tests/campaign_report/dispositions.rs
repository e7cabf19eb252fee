//! Dispositions of discrepancies.

use super::bench::{Bench, CAMPAIGN, check, files, put, synthetic, troubled};
use octant_campaign::report::CampaignReport;

#[test]
fn dispositions_survive_to_the_letter_and_change_no_verdict() {
    let (bench, plan, out) = Bench::filled(CAMPAIGN, troubled);
    assert_eq!(bench.report().0, 4);
    let written = bench.read("dispositions.toml");
    assert_eq!(written.matches("[[discrepancies]]").count(), 5);
    // A user fills in a disposition, in a form of their own.
    let fault = CampaignReport::of(&plan, &out).unwrap().statistics.discrepancies.pop().unwrap();
    assert_eq!(fault.kind, "fault");
    let (head, tail) = written.split_once(&format!("id = \"{}\"", fault.id)).unwrap();
    let tail = tail
        .replacen(
            "disposition = \"\"",
            "disposition   = '''Not <relevant>:\n the trigger is late.'''  # ok",
            1,
        )
        .replacen("by = \"\"", "by = \"A. Person\"", 1);
    let filled = format!("# mine\n{head}id = \"{}\"{tail}\n\n# the end\n", fault.id);
    let path = out.join("dispositions.toml");
    std::fs::write(&path, &filled).unwrap();
    let (status, said) = bench.report();
    assert_eq!(status, 4, "{said}");
    assert!(said.contains("5 discrepancies, 4 without a disposition"), "{said}");
    assert_eq!(bench.read("dispositions.toml"), filled);
    let page = bench.read("report.html");
    assert!(
        page.contains("Not &lt;relevant&gt;:\n the trigger is late.") && page.contains("A. Person")
    );
    assert!(!page.contains("not occurring"));

    // Another case fails, and a failed one passes now.
    let mut result = synthetic(&plan, 5, &plan.cases[5]);
    put(&out, &plan.cases[5], &result);
    result = synthetic(&plan, 2, &plan.cases[2]);
    check(&mut result, "CAL-1", 77.0, 50.0);
    put(&out, &plan.cases[2], &result);
    let (status, _) = bench.report();
    assert_eq!(status, 4);
    let now = bench.read("dispositions.toml");
    assert!(now.starts_with(&filled), "what was there stays to the letter");
    // The failed check has other cases now: the old disposition doesn't apply to the new
    // discrepancy.
    assert_eq!(now.matches("[[discrepancies]]").count(), 6);
    let page = bench.read("report.html");
    assert_eq!(page.matches(">not occurring<").count(), 2);
    assert!(page.contains("the trigger is late."), "what was said is still shown");
    assert!(page.contains("4 without a disposition"));
}

/// File as the first version wrote it; later versions must read it.
const FIRST_VERSION: &str = "# Discrepancies of this campaign, and what is said of them.
schema = 1

[[discrepancies]]
id = \"D-0123456789\"
what = \"NAV-1 failed in 2 cases of static; latitude 0 deg\"
requirement = \"NAV-1\"
cases = [\"00112233445566aa\", \"00112233445566ab\"]
disposition = \"Accepted for the prototype, see PR-12.\"
by = \"A. Person\"

[[discrepancies]]
id = \"D-9876543210\"
what = \"1 case has no result\"
disposition = \"\"
by = \"\"
";

#[test]
fn dispositions_of_the_first_version_are_read() {
    use octant_evidence::disposition::Dispositions;
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("dispositions.toml"), FIRST_VERSION).unwrap();
    let read = Dispositions::read(&folder.path().join("dispositions.toml")).unwrap();
    let entry = read.of("D-0123456789").unwrap();
    assert_eq!(
        (entry.disposition.as_str(), entry.by.as_str(), entry.cases.len(), entry.is_open()),
        ("Accepted for the prototype, see PR-12.", "A. Person", 2, false)
    );
    assert!(read.of("D-9876543210").unwrap().is_open());
}

#[test]
fn dispositions_that_cannot_be_read_are_left_alone() {
    let (bench, _, out) = Bench::filled(CAMPAIGN, troubled);
    assert_eq!(bench.report().0, 4);
    let path = out.join("dispositions.toml");
    let good = bench.read("dispositions.toml");
    let twice = good.clone() + "\n" + good.split_once("\n\n").unwrap().1;
    for (text, words) in [
        (
            good.replace("schema = 1", "schema = 2"),
            "found version 2, this program reads version 1: a newer Octant",
        ),
        (good.replacen("by = ", "bye = ", 1), "unknown field `bye`"),
        (good.replacen("[[discrepancies]]", "[[discrepancy]]", 1), "unknown field `discrepancy`"),
        (good.replacen("by = \"\"", "by = \"", 1), "line 1"),
        (good.replace("schema = 1\n", ""), "missing field `schema`"),
        (twice, "a second time"),
        ("schema = 1\ndiscrepancies = []\n".to_owned(), "nothing can be added to it"),
    ] {
        std::fs::write(&path, &text).unwrap();
        let before = files(&out);
        let (status, said) = bench.report();
        assert_eq!(status, 2, "{said}");
        assert!(said.contains("dispositions.toml: ") && said.contains(words), "{words}: {said}");
        assert!(files(&out) == before, "{words}: something was written");
    }
    std::fs::write(&path, [0xff, 0xfe]).unwrap();
    let (status, said) = bench.report();
    assert!(status == 4 && said.contains("failed to read out/dispositions.toml"), "{said}");
    assert_eq!(std::fs::read(&path).unwrap(), [0xff, 0xfe]);
}
