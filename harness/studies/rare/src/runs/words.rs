//! Doubts and counts in words.

use crate::estimators::estimate::{EFFECTIVE_MIN, RareDoubt};
use crate::estimators::point::RareStage;
use crate::runs::many::StageCounts;
use octant_base::number::{counted, fixed, significant};
use std::collections::BTreeMap;

/// A doubt as a sentence.
pub(crate) fn doubt(doubt: &RareDoubt) -> String {
    match doubt {
        RareDoubt::NotReached { reached, replicates } => format!(
            "{reached} of {} found failures within their share of the runs",
            counted(*replicates, "replicate", "replicates")
        ),
        RareDoubt::FewFailures { effective } => format!(
            "too few failures among the weighted samples: as many as {} of equal weight, expected {} or more; more --runs help",
            fixed(*effective, 1),
            fixed(EFFECTIVE_MIN, 0)
        ),
        RareDoubt::Uncovered { share } => format!(
            "{} % of the failures that the chains met are where the weighted samples hardly go",
            fixed(100.0 * share, 1)
        ),
        RareDoubt::Variance { ratio } => format!(
            "the failures of the chains predict {} times the variance that the weighted samples show",
            significant(*ratio, 2)
        ),
        RareDoubt::Replicates { subset, error } => format!(
            "the replicates disagree with the estimate: {} by subset simulation, standard error of its logarithm {}",
            significant(*subset, 3),
            significant(*error, 2)
        ),
        RareDoubt::Plain { interval: [low, high] } => format!(
            "the plain samples disagree with the estimate: {} to {} by Clopper and Pearson",
            significant(*low, 3),
            significant(*high, 3)
        ),
        RareDoubt::NotMixed { accepted } => format!(
            "chains hardly moved: {} % of the steps in the last level were accepted",
            fixed(100.0 * accepted, 1)
        ),
    }
}

/// The counts of all stages together.
pub(crate) fn together(counts: &BTreeMap<RareStage, StageCounts>) -> StageCounts {
    counts.values().fold(StageCounts::default(), |sum, stage| StageCounts {
        runs: sum.runs + stage.runs,
        judged: sum.judged + stage.judged,
        refused: sum.refused + stage.refused,
        unpublished: sum.unpublished + stage.unpublished,
        noticed: sum.noticed + stage.noticed,
        broken: sum.broken + stage.broken,
    })
}

/// Runs by their stage, and those without a measure.
pub(crate) fn counts(counts: &BTreeMap<RareStage, StageCounts>) -> String {
    let of = |stage: RareStage| counts.get(&stage).map_or(0, |stage| stage.runs);
    let all = together(counts);
    let mut out = format!(
        "  {}: {} plain, {} of chains, {} weighted\n",
        counted(all.runs, "run", "runs"),
        of(RareStage::Plain),
        of(RareStage::Chain),
        of(RareStage::Weighted)
    );
    let classes = [
        (all.refused, "refused the calibration"),
        (all.unpublished, "ended without the measure"),
        (all.noticed, "published with a report of the core"),
        (all.broken, "broke down"),
    ];
    for (count, words) in classes.iter().filter(|(count, _)| *count > 0) {
        out += &format!("  {count} {words}\n");
    }
    out
}
