//! Page of all attacks, generated from the tests themselves.

use super::{Row, answers, bench, campaigns, fmu, honest, sessions};
use octant_verdict::Verdict;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/qualification/attacks.md");

fn rows() -> Vec<Row> {
    let parts = [answers::rows(), sessions::rows(), fmu::rows(), bench::rows(), campaigns::rows()];
    parts.concat()
}

fn ended(status: u8) -> &'static str {
    let verdict = Verdict::ALL.into_iter().rev().find(|verdict| verdict.exit_code() == status);
    match status {
        2 => "refused before the run",
        _ => verdict.map_or("?", Verdict::name),
    }
}

fn page() -> String {
    let rows = rows();
    let tries = |row: &Row| row.over.split(", ").count();
    let all: usize = rows.iter().map(tries).sum();
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    rows.iter().for_each(|row| *counts.entry(ended(row.ends.status)).or_default() += tries(row));
    let mut text = format!(
        "# What a hostile unit can do, and how it ends\n\n\
         Written by the tests (`harness/program/octant/tests/hostile`, `tests/attacks` writes it anew), each row of which is run\n\
         over each of its ports whenever the tests are. {} attacks, {all} tries: ",
        rows.len()
    );
    let counted: Vec<String> = counts.iter().map(|(how, n)| format!("{n} {how}")).collect();
    let _ = writeln!(
        text,
        "{}; none ends in pass.\n\n\
         The unit is the core itself with its answers altered, in 20 s of calibration through a move and 10 s of\n\
         navigation at 50 Hz. Without the alteration it passes, over each port: the honest neighbour of each.\n\
         Of a campaign the attacker is a person who has its folder, which is unsigned. Refused is the command that would use\n\
         it; `octant verify` ends as fail where a folder isn't whole.\n",
        counted.join(", ")
    );
    let mut groups: Vec<&str> = Vec::new();
    for row in &rows {
        if !groups.contains(&row.group) {
            groups.push(row.group);
        }
    }
    for group in groups {
        let _ = writeln!(
            text,
            "## {group}\n\n| A {} … | over | ends as | because of |\n|---|---|---|---|",
            if campaigns::is_of_person(group) { "person who" } else { "unit that" }
        );
        for row in rows.iter().filter(|row| row.group == group) {
            let because = row.ends.because.replace('|', "\\|");
            let _ = writeln!(
                text,
                "| {} | {} | {} | {because} |",
                row.about,
                row.over,
                ended(row.ends.status)
            );
        }
        text.push('\n');
    }
    text += &super::studies::section();
    text += "\n## What raises nothing\n\nHonest units, written in other ways; each is a test and passes.\n\n";
    for about in honest::list() {
        let _ = writeln!(text, "- {about}");
    }
    text += "- a navigation that is new every 2, 10 or 50 s, in 20, 60 and 300 s\n";
    text += "\n## What no harness sees\n\n\
             A unit that computes a right navigation from other sensors than those it is given, or that replays a \
             recorded one of\nthe same scenario with the same seed, answers as a good one does. Seeds that the maker \
             doesn't know, and faults in the\nsamples, tell them apart: such a unit doesn't follow what was altered.\n\
             Where the true position moves, answers between two seconds are compared with it only from a step of \
             0.6 m, 0.05 m/s\nor 2 mrad on: a unit that goes away and comes back within a second in smaller steps, each \
             of which fits its samples, isn't seen.\n\
             Uncertainties that are too large make every normalized error small: require the uncertainties \
             too\n(`calibration.parameters.gyro_bias_x.sigma`).\n";
    text
}

#[test]
fn the_page_is_that_of_the_tests() {
    let page = page();
    if std::env::var_os("OCTANT_WRITE_FIXTURES").is_some() {
        std::fs::write(Path::new(PAGE), &page).unwrap();
    }
    let found = std::fs::read_to_string(PAGE).unwrap_or_default();
    assert_eq!(found, page, "tests/attacks writes {PAGE} anew");
}

#[test]
fn there_are_enough_of_them_and_none_passes() {
    let rows = rows();
    assert!(rows.len() >= 60, "{}", rows.len());
    assert!(honest::list().len() >= 20);
    for row in &rows {
        assert!(row.ends.status > Verdict::Pass.exit_code(), "{}", row.about);
        assert!(!row.ends.because.is_empty());
    }
}
