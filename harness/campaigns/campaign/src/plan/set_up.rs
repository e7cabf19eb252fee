//! Checks that the cases of a plan can be set up with their scenarios, before any is run.

use super::draw::At;
use super::make::PlanMaker;
use super::progress::{PlanStage, Tell};
use super::{Case, Plan, PlanError, PlannedScenario};
use octant_scenario::campaign::{Levels, Member};
use std::collections::{BTreeMap, HashSet};

/// Number of cases between the edges that are checked where numbers are drawn, at equal distances in the plan.
const BETWEEN: usize = 64;

/// Value of each factor, in the order of the campaign; those of a factor of the grid have no meaning.
type DrawnRow = Vec<At>;

impl PlanMaker {
    /// Checks that each case can be set up with its scenario.
    ///
    /// A scenario is read in 0.3 ms, forty times what a case takes otherwise. It refuses a number
    /// that is beyond a bound, its own or one of several together, so what can be set up at all edges of what is drawn can
    /// be in between. The edges are set up, and some cases between them. If one of these can't be, each case is, and the
    /// first that can't be is named. A case is also checked when it's run.
    ///
    /// # Errors
    /// If a case can't be set up.
    pub(super) fn check_set_up(
        &self,
        head: &Plan,
        cases: &[Case],
        tell: Tell<'_>,
    ) -> Result<(), PlanError> {
        if self.can_stand(head, cases, tell)? {
            return Ok(());
        }
        let mut seen = HashSet::new();
        for (done, case) in cases.iter().enumerate() {
            tell(PlanStage::Checking, done, cases.len());
            if seen.insert((&case.scenario, &case.set, &case.faults)) {
                head.can_set_up(head.planned(case)?, case)?;
            }
        }
        Ok(())
    }

    /// Returns whether all cases that stand for the others can be set up.
    ///
    /// # Errors
    /// If one of them has no id.
    fn can_stand(&self, head: &Plan, cases: &[Case], tell: Tell<'_>) -> Result<bool, PlanError> {
        let rows = self.rows();
        let members = || self.campaign.scenarios.iter().zip(&self.scenarios);
        let every = if self.distributed().is_empty() { cases.len() } else { cases.len() / BETWEEN };
        let between = || cases.iter().step_by(every.max(1)).skip(1);
        let edges = members().count() * self.grid as usize * rows.len();
        let total = edges + between().count();
        let mut done = 0..;
        let mut is_fine = |planned: &PlannedScenario, case: &Case| {
            tell(PlanStage::Checking, done.next().unwrap_or(total), total);
            head.can_set_up(planned, case).is_ok()
        };
        for (member, planned) in members() {
            for (row, cell) in
                rows.iter().flat_map(|row| (0..self.grid).map(move |cell| (row, cell)))
            {
                if !is_fine(planned, &self.case_at(member, planned, cell, row)?) {
                    return Ok(false);
                }
            }
        }
        for case in between() {
            if !is_fine(head.planned(case)?, case) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Makes a case of a cell of the grid with these draws, whether the plan has it or not.
    fn case_at(
        &self,
        member: &Member,
        planned: &PlannedScenario,
        cell: u64,
        row: &[At],
    ) -> Result<Case, PlanError> {
        self.case_with(0, member, planned, cell, |index| row[index])
    }

    /// Returns the draws at the edges. Replicates that drew the same levels have edges of their own: a bound can be of
    /// one level.
    fn rows(&self) -> Vec<DrawnRow> {
        let mut groups: BTreeMap<Vec<usize>, Vec<u32>> = BTreeMap::new();
        for replicate in 0..self.campaign.replicates {
            let levels = (0..self.campaign.factors.len())
                .filter_map(|index| match self.draws.at(index, replicate) {
                    At::Level(level) => Some(level),
                    At::Number(_) => None,
                })
                .collect();
            groups.entry(levels).or_default().push(replicate);
        }
        groups.values().flat_map(|replicates| self.edges(replicates)).collect()
    }

    /// Returns all combinations of the smallest and the largest number of each factor, and the numbers next to zero; all
    /// draws if these are fewer.
    fn edges(&self, replicates: &[u32]) -> Vec<DrawnRow> {
        let row = |replicate: &u32| -> DrawnRow {
            let factors = 0..self.campaign.factors.len();
            factors.map(|index| self.draws.at(index, *replicate)).collect()
        };
        let distributed = self.distributed();
        let corners =
            u32::try_from(distributed.len()).ok().and_then(|count| 1_usize.checked_shl(count));
        if corners.is_none_or(|corners| replicates.len() <= corners) {
            return replicates.iter().map(row).collect();
        }
        let mut rows: Vec<DrawnRow> = replicates.first().map(row).into_iter().collect();
        let mut next_to_zero = Vec::new();
        for index in distributed {
            let number = |replicate: &u32| match self.draws.at(index, *replicate) {
                At::Number(number) => number,
                At::Level(_) => 0.0,
            };
            let by_number = |a: &&u32, b: &&u32| number(a).total_cmp(&number(b));
            let all = || replicates.iter();
            let ends = [all().min_by(by_number), all().max_by(by_number)];
            let at = |replicate: &u32| self.draws.at(index, *replicate);
            let with = |row: &DrawnRow, end: &u32| {
                let mut row = row.clone();
                row[index] = at(end);
                row
            };
            rows = (rows.iter())
                .flat_map(|row| ends.into_iter().flatten().map(|end| with(row, end)))
                .collect();
            let below = all().filter(|replicate| number(replicate) <= 0.0).max_by(by_number);
            let above = all().filter(|replicate| number(replicate) >= 0.0).min_by(by_number);
            next_to_zero.extend(below.zip(above).map(|(below, above)| [row(below), row(above)]));
        }
        rows.extend(next_to_zero.into_iter().flatten());
        rows
    }

    /// Returns the indices of the factors that are drawn from a distribution.
    fn distributed(&self) -> Vec<usize> {
        let factors = self.campaign.factors.iter().enumerate();
        let is = |levels: &Levels| matches!(levels, Levels::Distributed { .. });
        factors.filter(|(_, factor)| is(&factor.levels)).map(|(index, _)| index).collect()
    }
}

impl Plan {
    /// Checks that a case can be set up with its scenario.
    fn can_set_up(&self, planned: &PlannedScenario, case: &Case) -> Result<(), PlanError> {
        let scenario = planned.with(case)?;
        if scenario.source.has_plant() && !scenario.realtime.by_clock {
            return Ok(());
        }
        Err(PlanError::Contradiction {
            campaign: self.campaign.clone(),
            reason: format!(
                "scenario {:?} is not simulated: a campaign needs source.uri = \"plant\", and \
                 realtime.pace = \"free\"",
                case.scenario
            ),
        })
    }
}
