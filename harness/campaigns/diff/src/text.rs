//! Differences as text for a terminal.

use super::cases::CampaignDiff;
use super::scores::ScoreDiff;
use super::settings::SettingDiff;
use super::side::SideAbout;
use super::{RunDiff, stream::StreamDiff};
use octant_base::number::{counted, significant};
use octant_nightly::compare::Change;
use std::fmt::Write as _;

/// Scores that are shown even where they are equal.
const MAIN: [&str; 12] = [
    "calibration.nis_mean",
    "calibration.worst_normalized_error",
    "navigation.latitude_error_arcmin.max",
    "navigation.latitude_error_arcmin.rms",
    "navigation.latitude_error_arcmin.final",
    "navigation.longitude_error_arcmin.max",
    "navigation.longitude_error_arcmin.rms",
    "navigation.longitude_error_arcmin.final",
    "navigation.radial_error_nmi.max",
    "navigation.radial_error_nmi.rms",
    "navigation.radial_error_nmi.final",
    "navigation.radial_error_nmi.rate_per_h",
];

/// Scores that are shown: the main ones, and others that differ.
pub(crate) fn shown(scores: &[ScoreDiff]) -> impl Iterator<Item = &ScoreDiff> {
    scores.iter().filter(|score| MAIN.contains(&score.score.as_str()) || !score.is_equal())
}

/// Renders the difference between two runs.
#[must_use]
pub fn of_runs(diff: &RunDiff) -> String {
    let mut out = String::new();
    for (name, about) in ["A", "B"].iter().zip(&diff.runs) {
        let _ = writeln!(out, "{name}  {}", in_words(about));
    }
    out.push('\n');
    settings(&mut out, &diff.settings);
    let seeds = diff.runs.each_ref().map(|about| about.seed);
    // A resolved scenario names its seed; that of a run may come from the command line.
    if seeds[0] != seeds[1] && !diff.settings.iter().any(|setting| setting.key == "seed") {
        let _ = writeln!(out, "  seed: {} | {}", optional(seeds[0]), optional(seeds[1]));
    }
    stream(&mut out, diff);
    if !diff.scores.is_empty() {
        out.push_str("\nscores\n");
        table(&mut out, &diff.scores);
    }
    if diff.parameters.iter().any(|parameter| parameter.difference != 0.0) {
        parameters(&mut out, diff);
    }
    for note in &diff.notes {
        let _ = writeln!(out, "\n{note}");
    }
    let _ = writeln!(out, "\n{}", if diff.equal { "equal" } else { "different" });
    out
}

fn optional(number: Option<u64>) -> String {
    number.map_or_else(|| "unknown".to_owned(), |number| number.to_string())
}

/// Describes a run in one line.
pub(crate) fn in_words(about: &SideAbout) -> String {
    let mut words = format!("{}: octant {}", about.path.display(), about.octant);
    if let Some(numerics) = about.numerics {
        let _ = write!(words, ", numerics {numerics}");
    }
    if let Some(commit) = &about.commit {
        let _ = write!(words, ", commit {}", commit.get(..12).unwrap_or(commit));
    }
    if let Some(seed) = about.seed {
        let _ = write!(words, ", seed {seed}");
    }
    if let Some(verdict) = &about.verdict {
        let _ = write!(words, ", {verdict}");
    }
    words
}

fn settings(out: &mut String, settings: &[SettingDiff]) {
    if settings.is_empty() {
        out.push_str("settings: the same\n");
        return;
    }
    let _ = writeln!(out, "settings: {} differ", counted(settings.len() as u64, "key", "keys"));
    for setting in settings {
        let value = |value: &Option<String>| value.clone().unwrap_or_else(|| "(none)".to_owned());
        let _ = writeln!(
            out,
            "  {}: {} | {}",
            setting.key,
            value(&setting.first),
            value(&setting.second)
        );
    }
}

fn stream(out: &mut String, diff: &RunDiff) {
    out.push('\n');
    out.push_str(&stream_in_words(&diff.stream, &diff.runs));
    out.push('\n');
    for channel in &diff.stream.channels {
        if channel.differing + channel.only_first + channel.only_second > 0 {
            let _ = writeln!(
                out,
                "  {:<14} {} of {} differ, {} only in A, {} only in B",
                channel.channel,
                channel.differing,
                channel.compared,
                channel.only_first,
                channel.only_second
            );
        }
    }
}

/// Describes the comparison of the streams in a sentence.
pub(crate) fn stream_in_words(stream: &StreamDiff, runs: &[SideAbout; 2]) -> String {
    let [first, second] = runs.each_ref().map(|about| about.stream_hash.as_deref());
    match &stream.first {
        Some(found) => format!(
            "first difference: {} at {} s, {}: {} | {}",
            found.channel, found.time_s, found.field, found.first, found.second
        ),
        None if first.is_some() && first == second => {
            format!("stream: the same, stream hash {}", first.unwrap_or_default())
        }
        None if first.is_some() && second.is_some() => {
            "stream: the recorded messages are the same, the stream hashes differ: the difference is \
             between the recorded samples"
                .to_owned()
        }
        None => "stream: the recorded messages are the same".to_owned(),
    }
}

/// Writes a number with its true sign.
pub(crate) fn number(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| significant(value, 5))
}

fn table(out: &mut String, scores: &[ScoreDiff]) {
    let rows: Vec<&ScoreDiff> = shown(scores).collect();
    let width = rows.iter().map(|row| row.score.len()).max().unwrap_or(0);
    let _ = writeln!(out, "  {:width$} {:>12} {:>12} {:>12}", "", "A", "B", "B - A");
    for row in &rows {
        let _ = writeln!(
            out,
            "  {:width$} {:>12} {:>12} {:>12}",
            row.score,
            number(row.first),
            number(row.second),
            number(row.difference)
        );
    }
    let equal = scores.len() - rows.len();
    if equal > 0 {
        let _ = writeln!(out, "  {} more the same", counted(equal as u64, "score", "scores"));
    }
    out.push_str("  one pair of runs shows no significance: two campaigns do\n");
}

fn parameters(out: &mut String, diff: &RunDiff) {
    out.push_str("\nparameters\n");
    let _ = writeln!(out, "  {:<26} {:>12} {:>12} {:>12} {:>8}", "", "A", "B", "B - A", "in σ");
    for row in &diff.parameters {
        let _ = writeln!(
            out,
            "  {:<26} {:>12} {:>12} {:>12} {:>8} {}",
            row.parameter,
            number(Some(row.first)),
            number(Some(row.second)),
            number(Some(row.difference)),
            row.in_sigma
                .map_or_else(|| "–".to_owned(), |sigma| octant_base::number::fixed(sigma, 2)),
            row.unit
        );
    }
}

/// Renders the difference between two campaigns.
#[must_use]
pub fn of_campaigns(diff: &CampaignDiff) -> String {
    let mut out = String::new();
    for (name, about) in ["A", "B"].iter().zip(&diff.campaigns) {
        let program = about.program.as_deref().unwrap_or("program unknown");
        let cases = counted(about.cases as u64, "case", "cases");
        let _ = writeln!(out, "{name}  {}: {cases}, {program}", about.path.display());
    }
    out.push('\n');
    settings(&mut out, &diff.settings);
    for pairing in &diff.comparison.pairings {
        let _ = writeln!(
            out,
            "\n{} of {} and {} cases: {} with another scenario, {} with another result",
            counted(pairing.pairs as u64, "pair", "pairs"),
            pairing.baseline_cases,
            pairing.cases,
            pairing.changed_inputs,
            pairing.changed_results
        );
    }
    if let Some(case) = &diff.streams.first {
        let _ = writeln!(
            out,
            "{} of {} streams differ, the first is that of case {case}",
            diff.streams.differing, diff.streams.pairs
        );
    }
    let mut changed = 0;
    for test in diff.comparison.tests.iter().filter(|test| test.change != Change::Same) {
        if changed == 0 {
            out.push_str(
                "\nmeasures, mean of the pairs; p after Holm's correction for all tests\n",
            );
        }
        changed += 1;
        let _ = writeln!(
            out,
            "  {:<9} {} {}: {} | {}, p {}",
            significance(test.change),
            test.scenario,
            test.measure,
            significant(test.baseline, 5),
            significant(test.tonight, 5),
            significant(test.p_adjusted, 2)
        );
    }
    let same = diff.comparison.tests.len() - changed;
    if same > 0 {
        let _ = writeln!(out, "{} the same to the last bit", counted(same as u64, "test", "tests"));
    }
    let _ = writeln!(out, "\n{}", if diff.equal { "equal" } else { "different" });
    out
}

/// Tells whether a change is significant, and in which direction.
pub(crate) const fn significance(change: Change) -> &'static str {
    match change {
        Change::Worse => "worse",
        Change::Better => "better",
        Change::Changed => "not shown",
        Change::Same => "same",
    }
}
