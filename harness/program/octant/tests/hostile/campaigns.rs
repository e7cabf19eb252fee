//! Attacks on the claim of a campaign and on its evidence, by a person who has the folder: none ends in a pass that stays.
//!
//! Results are synthetic, and each attack is tried by the commands of the program.

use super::campaign_content as content;
use super::{Ends, Row};
use crate::campaign_looks::Looked;
use octant_campaign::journal::FILE_NAME as JOURNAL;
use octant_evidence::Manifest;
use octant_verdict::Verdict;
use sha2::Digest;
use std::path::{Path, PathBuf};

/// Attack, and how it ends.
pub struct Attack {
    pub group: &'static str,
    pub about: &'static str,
    pub ends: Ends,
    /// Carries it out, and returns the status and the words of the command that ends it.
    tries: fn() -> (i32, String),
}

const fn refused(because: &'static str) -> Ends {
    Ends { status: 2, because }
}

/// End of `octant verify`: the folder isn't whole.
const fn found(because: &'static str) -> Ends {
    Ends { status: Verdict::Fail.exit_code(), because }
}

const fn open(because: &'static str) -> Ends {
    Ends { status: Verdict::Inconclusive.exit_code(), because }
}

/// Campaign of 22 draws, all of which pass, as one look needs them; and its report.
fn reported() -> Looked {
    let looked = Looked::of(22, "");
    looked.fill(0..22, &[]);
    looked.octant(&["campaign", "report", "out"], 0);
    looked.octant(&["verify", "out"], 0);
    looked
}

/// Runs a command, and returns its status and its words.
pub(super) fn says(looked: &Looked, arguments: &[&str]) -> (i32, String) {
    let output = looked.bench.octant(arguments);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    (output.status.code().unwrap(), said + &String::from_utf8_lossy(&output.stderr))
}

pub(super) fn verify(looked: &Looked) -> (i32, String) {
    says(looked, &["verify", "out"])
}

pub(super) fn out(looked: &Looked, name: &str) -> PathBuf {
    looked.bench.at("out").join(name)
}

pub(super) fn edit(path: &Path, change: impl FnOnce(String) -> String) {
    let text = std::fs::read_to_string(path).unwrap();
    let changed = change(text.clone());
    assert_ne!(text, changed, "nothing was changed in {}", path.display());
    std::fs::write(path, changed).unwrap();
}

/// Writes an unsigned manifest anew, with the hashes of the files as they are now.
pub(super) fn forge(looked: &Looked) {
    let folder = looked.bench.at("out");
    let manifest = Manifest::read(&folder).unwrap();
    let path = folder.join("manifest.json");
    let mut value = serde_json::to_value(&manifest).unwrap();
    for file in value["files"].as_array_mut().unwrap() {
        let bytes = std::fs::read(folder.join(file["path"].as_str().unwrap())).unwrap();
        let sha256 = sha2::Sha256::digest(&bytes);
        file["bytes"] = bytes.len().into();
        file["blake3"] = blake3::hash(&bytes).to_hex().as_str().into();
        file["sha256"] = sha256.iter().map(|byte| format!("{byte:02x}")).collect::<String>().into();
    }
    std::fs::write(path, format!("{value:#}\n")).unwrap();
}

/// Chains the lines of a journal anew.
fn chained(lines: &[&str]) -> String {
    let mut before = String::new();
    let mut text = String::new();
    for line in lines {
        let content = line.split_once(' ').map_or(*line, |(_, content)| content);
        let content = content.trim_end();
        let hash = blake3::hash(format!("{before}{content}").as_bytes()).to_hex();
        before = hash.chars().take(32).collect();
        text += &format!("{before} {content}\n");
    }
    text
}

fn extends_until_it_passes() -> (i32, String) {
    let mut looked = Looked::of(22, "");
    looked.fill(0..22, &[3]);
    looked.status(3);
    looked.extend(200, "");
    looked.fill(22..200, &[]);
    looked
        .status(3)
        .contains("199 of 200 passed")
        .then(|| says(&looked, &["campaign", "report", "out"]))
        .map(|(status, _)| (status, looked.bench.read("report.html")))
        .unwrap()
}

fn looks_early() -> (i32, String) {
    let looked = Looked::of(22, "");
    looked.fill(0..10, &[3]);
    says(&looked, &["campaign", "status", "out"])
}

fn opens_one_case_early() -> (i32, String) {
    let looked = Looked::of(22, "");
    looked.fill(0..22, &[]);
    // One case has no result yet.
    let partly = Looked::of(22, "");
    partly.fill(0..21, &[3]);
    let id = partly.plan.cases[3].id.to_string();
    partly.octant(&["campaign", "result", "out", &id], 0);
    says(&partly, &["campaign", "report", "out"])
        .1
        .contains("without a disposition")
        .then_some(())
        .unwrap();
    (3, partly.bench.read("dispositions.toml"))
}

fn extends_the_last_of_several_looks() -> (i32, String) {
    let mut looked = Looked::of(44, "looks = 2\n");
    looked.fill(0..44, &[0, 1, 2, 3]);
    looked.status(3);
    looked.extend(400, "looks = 2\n");
    looked.fill(44..400, &[]);
    says(&looked, &["campaign", "status", "out"])
}

fn extends_with(
    looked: &Looked,
    change: impl FnOnce(String) -> String,
    file: &str,
) -> (i32, String) {
    edit(&looked.bench.at(file), change);
    edit(&looked.bench.at("campaign.toml"), |text| {
        text.replace("replicates = 22", "replicates = 200")
    });
    says(looked, &["campaign", "plan", "campaign.toml", "--out", "out", "--extend"])
}

fn changes_the_way_of_looking() -> (i32, String) {
    let looked = Looked::of(22, "seed = 1\n");
    looked.fill(0..22, &[3]);
    looked.status(3);
    // The same draws, which a claim at any time would count all.
    extends_with(
        &looked,
        |text| text.replace("seed = 1\n", "seed = 1\nlooks = \"open\"\n"),
        "campaign.toml",
    )
}

fn asks_for_less_after_the_look() -> (i32, String) {
    let looked = Looked::of(22, "seed = 1\n");
    looked.fill(0..22, &[3]);
    looked.status(3);
    extends_with(
        &looked,
        |text| text.replace("pass = \"90 %\"", "pass = \"80 %\""),
        "requirements.toml",
    )
}

fn adds_combinations_to_draws_that_were_seen() -> (i32, String) {
    let factor = "seed = 1\nfactors = [{ name = \"latitude\", key = \"site.latitude\", values = [\"0 deg\"] }]\n";
    let looked = Looked::of(22, factor);
    looked.fill(0..22, &[3]);
    looked.status(3);
    edit(&looked.bench.at("campaign.toml"), |text| {
        text.replace("[\"0 deg\"]", "[\"0 deg\", \"60 deg\"]")
    });
    says(&looked, &["campaign", "plan", "campaign.toml", "--out", "out", "--extend"])
}

fn leaves_a_journal_line_out() -> (i32, String) {
    let looked = reported();
    edit(&out(&looked, JOURNAL), |text| {
        let lines: Vec<&str> = text.split_inclusive('\n').collect();
        [lines[0], lines[2]].concat()
    });
    forge(&looked);
    verify(&looked)
}

fn edits_a_journal_line() -> (i32, String) {
    let looked = reported();
    edit(&out(&looked, JOURNAL), |text| {
        text.replace("\"cases\":22,\"results\":22", "\"cases\":99,\"results\":22")
    });
    forge(&looked);
    verify(&looked)
}

/// The journal of before the extension is put back, with a manifest that fits.
fn replays_an_older_journal() -> (i32, String) {
    let mut looked = Looked::of(22, "");
    looked.fill(0..22, &[3]);
    let before = std::fs::read(out(&looked, JOURNAL)).unwrap();
    looked.status(3);
    looked.extend(60, "");
    looked.fill(22..60, &[]);
    looked.octant(&["campaign", "report", "out"], 3);
    std::fs::write(out(&looked, JOURNAL), before).unwrap();
    forge(&looked);
    verify(&looked)
}

/// The journal is cut before the look, and chained anew.
fn forgets_a_look() -> (i32, String) {
    let looked = reported();
    edit(&out(&looked, JOURNAL), |text| {
        let lines: Vec<&str> = text.lines().collect();
        chained(&lines[..lines.len() - 1])
    });
    forge(&looked);
    verify(&looked)
}

fn removes_the_journal() -> (i32, String) {
    let looked = reported();
    std::fs::remove_file(out(&looked, JOURNAL)).unwrap();
    verify(&looked)
}

/// A journal of a plan that was made after the results.
fn plans_after_the_results() -> (i32, String) {
    let looked = reported();
    edit(&out(&looked, JOURNAL), |text| {
        let year = text.lines().nth(1).unwrap().split("\"at\":\"").nth(1).unwrap()[..4].to_owned();
        let later = text.replacen(&format!("\"at\":\"{year}"), "\"at\":\"2999", 1);
        chained(&later.lines().collect::<Vec<_>>())
    });
    forge(&looked);
    verify(&looked)
}

const ATTACKS: [Attack; 25] = [
    Attack {
        group: "looks",
        about: "looks at a campaign before its look, to see whether to go on",
        ends: open("not looked at yet"),
        tries: looks_early,
    },
    Attack {
        group: "looks",
        about: "looks, and extends the plan until it passes",
        ends: open("no part of the claim"),
        tries: extends_until_it_passes,
    },
    Attack {
        group: "looks",
        about: "opens the result of one case before the look",
        ends: open("outcomes of single cases were shown before the look"),
        tries: opens_one_case_early,
    },
    Attack {
        group: "looks",
        about: "extends the plan after the last of several looks",
        ends: open("no look is left"),
        tries: extends_the_last_of_several_looks,
    },
    Attack {
        group: "looks",
        about: "plans to look openly after the look",
        ends: refused("this plan has other looks or requirements"),
        tries: changes_the_way_of_looking,
    },
    Attack {
        group: "looks",
        about: "asks for a smaller probability after the look",
        ends: refused("this plan has other looks or requirements"),
        tries: asks_for_less_after_the_look,
    },
    Attack {
        group: "looks",
        about: "adds combinations to draws that were seen",
        ends: refused("more cases of the draws that were seen"),
        tries: adds_combinations_to_draws_that_were_seen,
    },
    Attack {
        group: "journal",
        about: "leaves a line of the journal out, with a manifest that fits",
        ends: found("the checksum doesn't fit: a line was changed or left out"),
        tries: leaves_a_journal_line_out,
    },
    Attack {
        group: "journal",
        about: "edits a line of the journal, with a manifest that fits",
        ends: found("the checksum doesn't fit: a line was changed or left out"),
        tries: edits_a_journal_line,
    },
    Attack {
        group: "journal",
        about: "puts the journal of before an extension back, with a manifest that fits",
        ends: found("it is an older one, or of another campaign"),
        tries: replays_an_older_journal,
    },
    Attack {
        group: "journal",
        about: "cuts a look off and chains the journal anew, with a manifest that fits",
        ends: found("looks, the manifest tells of 1"),
        tries: forgets_a_look,
    },
    Attack {
        group: "journal",
        about: "removes the journal",
        ends: found("campaign.journal is missing"),
        tries: removes_the_journal,
    },
    Attack {
        group: "journal",
        about: "makes a journal after the results, with a manifest that fits",
        ends: found("begins after the first result was stored"),
        tries: plans_after_the_results,
    },
    Attack {
        group: "plan of a campaign",
        about: "writes another seed into the plan",
        ends: refused("it was changed after it was made"),
        tries: content::chooses_a_seed_in_the_plan,
    },
    Attack {
        group: "plan of a campaign",
        about: "says that a chosen seed comes from the plan",
        ends: refused("it was changed after it was made"),
        tries: content::chooses_a_seed_and_an_id,
    },
    Attack {
        group: "plan of a campaign",
        about: "takes the failing case out of the plan",
        ends: refused("it was changed after it was made"),
        tries: content::takes_a_case_out_of_the_plan,
    },
    Attack {
        group: "plan of a campaign",
        about: "plans fewer draws after the last one has failed",
        ends: refused("another plan is there"),
        tries: content::plans_fewer_draws_afterwards,
    },
    Attack {
        group: "plan of a campaign",
        about: "makes the limit wider after the results",
        ends: refused("it was changed after the campaign was planned"),
        tries: content::edits_the_limit_of_a_requirement,
    },
    Attack {
        group: "results of a campaign",
        about: "leaves the failing case without a result",
        ends: open("1 case has no result"),
        tries: content::leaves_a_failing_case_without_a_result,
    },
    Attack {
        group: "results of a campaign",
        about: "runs a failing case until it passes",
        ends: Ends { status: Verdict::Error.exit_code(), because: "came to two results" },
        tries: content::repeats_a_case_until_it_passes,
    },
    Attack {
        group: "results of a campaign",
        about: "stores the result of another draw for the one that fails",
        ends: Ends { status: Verdict::Error.exit_code(), because: "its case_blake3" },
        tries: content::copies_a_result_of_another_draw,
    },
    Attack {
        group: "results of a campaign",
        about: "adds the part of another plan",
        ends: refused("results of 22 cases that the plan doesn't have"),
        tries: content::adds_a_part_of_another_plan,
    },
    Attack {
        group: "evidence of a campaign",
        about: "writes pass into the statistics, with a manifest that fits",
        ends: found("statistics.json: its verdict is pass, the results give inconclusive"),
        tries: content::edits_statistics,
    },
    Attack {
        group: "evidence of a campaign",
        about: "edits a number of the page",
        ends: found("report.html was changed"),
        tries: content::edits_the_page,
    },
    Attack {
        group: "evidence of a campaign",
        about: "writes pass into the manifest",
        ends: found("manifest.json: its verdict is pass, the results give inconclusive"),
        tries: content::edits_the_verdict_of_the_manifest,
    },
];

/// Returns the rows of the table.
pub fn rows() -> Vec<Row> {
    let row = |attack: &Attack| Row {
        group: attack.group,
        about: attack.about,
        over: "folder",
        ends: attack.ends,
    };
    ATTACKS.iter().map(row).collect()
}

/// Returns whether a group of rows is of a person, and not of a unit.
pub fn is_of_person(group: &str) -> bool {
    ATTACKS.iter().any(|attack| attack.group == group)
}

#[test]
fn no_attack_on_a_campaign_ends_in_a_pass() {
    for attack in &ATTACKS {
        let (status, said) = (attack.tries)();
        assert_eq!(status, i32::from(attack.ends.status), "{}: {said}", attack.about);
        assert!(said.contains(attack.ends.because), "{}: {said}", attack.about);
    }
}

/// An honest campaign passes, and its folder is whole.
#[test]
fn an_honest_campaign_passes() {
    let looked = reported();
    assert!(verify(&looked).1.contains("verdict: pass"));
    content::edits_junit();
}
