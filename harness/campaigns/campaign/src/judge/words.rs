//! State of a campaign as text.

use super::status::{Bad, CampaignStatus};
use octant_statistics::proportion::Needed;
use octant_verdict::Verdict;
use std::collections::BTreeMap;
use std::fmt::Write as _;

impl CampaignStatus {
    /// Describes the parts of the design without effect.
    #[must_use]
    pub fn idle_in_words(&self) -> Vec<String> {
        let idle = self.idle_factors.iter().map(|factor| {
            format!(
                "factor {factor} changes nothing: cases that differ in it have the same streams"
            )
        });
        let cases: usize = self.repeated.iter().map(Vec::len).sum();
        let repeated = (cases > 0).then(|| {
            let streams = self.repeated.len();
            format!(
                "{cases} cases came to {streams} stream{}: cases of the same stream are one run and count \
                 once, the first are {}",
                if streams == 1 { "" } else { "s" },
                self.repeated.iter().flatten().take(3).cloned().collect::<Vec<_>>().join(", ")
            )
        });
        idle.chain(repeated).collect()
    }

    /// Renders the state as text.
    #[must_use]
    pub fn text(&self) -> String {
        let counts = |counts: &BTreeMap<&'static str, usize>| {
            let one = |verdict: &Verdict| {
                let count = counts.get(verdict.name())?;
                Some(format!("{count} {}", verdict.name()))
            };
            Verdict::ALL.iter().filter_map(one).collect::<Vec<_>>().join(", ")
        };
        let mut text = format!(
            "{}: {}\n  {} of {} cases have run: {}\n",
            self.title,
            self.verdict().name(),
            self.cases - self.open,
            self.cases,
            if self.looks.is_due { counts(&self.verdicts) } else { "not looked at yet".to_owned() }
        );
        _ = writeln!(text, "  {}", self.looks.in_words());
        let many = |count: usize| if count == 1 { "" } else { "s" };
        _ = writeln!(text, "  {} independent draw{}", self.draws, many(self.draws));
        for found in self.idle_in_words() {
            _ = writeln!(text, "  {found}");
        }
        for (id, requirement) in &self.requirements {
            _ = writeln!(text, "  {id}: {}: {}", requirement.verdict.name(), requirement.reason);
            match requirement.needed {
                None | Some(Needed::Runs(0)) => {}
                Some(Needed::Runs(runs)) if !self.looks.is_open() => {
                    let plan = requirement.draws.known() + runs;
                    _ = writeln!(
                        text,
                        "    draws that are added to this plan don't count; a new plan with {plan} draws shows it with as \
                         many failures"
                    );
                }
                Some(Needed::Runs(runs)) => {
                    _ = writeln!(
                        text,
                        "    {runs} more independent draws would show it, if all of them pass"
                    );
                }
                Some(Needed::CannotBeMet) => {
                    text += "    no number of further draws can show it\n";
                }
            }
        }
        if let Some(joint) = self.joint.as_ref().filter(|joint| joint.requirements > 1) {
            _ = writeln!(text, "  all together: {}", joint.in_words());
        }
        if !self.not_by_test.is_empty() {
            let ids = self.not_by_test.join(", ");
            _ = writeln!(text, "  not verified by runs: {ids}");
        }
        if self.requirements.is_empty() {
            text += "  no requirement checked\n";
        }
        for doubt in &self.doubts {
            _ = writeln!(text, "  requirements may be missing: {doubt}");
        }
        for told in &self.numerics {
            _ = writeln!(text, "  {told}");
        }
        if let Some(stopped) = &self.stopped {
            _ = writeln!(text, "  {stopped}");
        }
        for Bad { case, verdict, reason } in &self.bad {
            _ = writeln!(text, "  case {case}: {}: {reason}", verdict.name());
        }
        let bad: usize = [Verdict::Fail, Verdict::Error]
            .iter()
            .filter_map(|verdict| self.verdicts.get(verdict.name()))
            .sum();
        if bad > self.bad.len() {
            _ = writeln!(text, "  and {} more", bad - self.bad.len());
        }
        for case in &self.differing {
            _ = writeln!(
                text,
                "  case {case} came to two results: this is no deterministic program"
            );
        }
        text
    }
}
