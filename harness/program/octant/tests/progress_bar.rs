//! The bar of progress on a terminal.

#[cfg(target_os = "linux")]
use crate::common::program::{ended, octant_in, program};
#[cfg(target_os = "linux")]
use crate::operator_ways::on_terminal;
use octant::progress_bar::bar_line;
#[cfg(target_os = "linux")]
use std::process::Stdio;

#[test]
fn a_line_has_the_share_that_is_done_and_fits() {
    let line = |done, total, columns| bar_line(done, total, "1 of 4", columns);
    assert_eq!(line(1, Some(4), 15), "██░░░░░░ 1 of 4");
    assert_eq!(line(4, Some(4), 15), "████████ 1 of 4");
    assert_eq!(line(9, Some(4), 15), "████████ 1 of 4");
    assert_eq!(line(0, Some(0), 9), "░░ 1 of 4");
    assert_eq!(line(1, None, 15), "1 of 4");
    assert_eq!(line(1, Some(4), 3), "1 o");
    assert_eq!(bar_line(0, None, "a\u{1b}b", 40).matches('\u{1b}').count(), 0);
}

#[cfg(target_os = "linux")]
#[test]
fn the_stages_of_a_plan_are_shown_on_a_terminal_alone() {
    let folder = tempfile::tempdir().unwrap();
    let quick = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/scenarios/quick.toml");
    let campaign = format!(
        "schema = 1\ntitle = \"long\"\nseed = 1\nreplicates = 20000\n[[scenarios]]\nid = \"quick\"\nfile = {quick:?}\n\
         [[factors]]\nname = \"latitude\"\nkey = \"site.latitude\"\nunit = \"deg\"\nuniform = [0, 70]\n"
    );
    std::fs::write(folder.path().join("long.toml"), campaign).unwrap();
    let plan = |out| ["campaign", "plan", "long.toml", "--out", out];
    let mut command = program(&plan("shown"));
    let (_keys, run) = on_terminal(command.current_dir(folder.path()).stdout(Stdio::null()));
    let (status, shown) = run.end();
    assert_eq!(status, Some(0), "{shown}");
    for words in ["0 of 20000, making cases", "writing shown/plan.json"] {
        assert!(shown.contains(words), "{words:?} isn't in {shown:?}");
    }
    // The last thing is an empty line.
    assert!(shown.ends_with(" \r"), "{shown:?}");
    let (said, error) = ended(octant_in(folder.path(), &plan("silent")), 0);
    assert_eq!(
        (said.as_str(), error.as_str()),
        ("20000 cases\nseed 1, given in the campaign's file\nsilent/plan.json\n", "")
    );
    let bytes = |out: &str| std::fs::read(folder.path().join(out).join("plan.json")).unwrap();
    assert!(bytes("shown") == bytes("silent"));
}
