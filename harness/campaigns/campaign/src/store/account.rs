//! The account of the results in the folder of a campaign, whichever host they came from.

use super::index::CampaignResults;
use super::stored::{NotCounted, Stored};
use crate::execute::case::ResultError;
use crate::plan::{CasePlaces, Plan};
use octant_account::{Account, AccountEntry};
use octant_evidence::maker::{MadeBy, Maker};
use std::collections::BTreeMap;

impl CampaignResults {
    /// Returns the account of the results that were found: each is used as that of a case of the plan, or left out.
    ///
    /// Cases from place `end` of the plan on are those after its stopping rule.
    ///
    /// A case with two results that differ is an error of the campaign; the second is left out here.
    ///
    /// # Errors
    /// If a result has to be read to tell whether it is another one, and can't.
    pub fn account(&self, plan: &Plan, end: usize) -> Result<Account, ResultError> {
        let known = CasePlaces::of(plan);
        let cases = plan.cases.iter().take(end).map(|case| &*case.id);
        self.account_of(|id| known.get(id), cases, end)
    }

    /// Returns the account for the cases that `place` finds in a plan; `cases` are those that count.
    pub(super) fn account_of<'a>(
        &self,
        place: impl Fn(&str) -> Option<usize>,
        cases: impl Iterator<Item = &'a str>,
        end: usize,
    ) -> Result<Account, ResultError> {
        let [mut used, mut same, mut others, mut foreign, mut after] = [0; 5];
        let mut first_other = None;
        for id in self.ids() {
            let [again, differing] = self.again(id)?;
            match place(id) {
                None => {
                    foreign += 1 + again + differing;
                    continue;
                }
                Some(place) if place >= end => after += 1,
                Some(_) => used += 1,
            }
            same += again;
            others += differing;
            if differing > 0 {
                first_other.get_or_insert(id);
            }
        }
        let NotCounted { taken_back, torn } = self.not_counted;
        let without = cases.filter(|case| !self.has(case)).count();
        let mut other = AccountEntry::new(others, "other results of a case that has one");
        if let Some(id) = first_other {
            other = other.first(format!("of case {id}"));
        }
        Ok(Account::new("results of the cases", ["result", "results"])
            .used(used)
            .left_out(AccountEntry::new(same, "results that came again, equal to the last byte"))
            .left_out(other)
            .left_out(AccountEntry::new(
                after,
                "results after the point at which the campaign stopped",
            ))
            .left_out(AccountEntry::new(foreign, "results of cases that the plan doesn't have"))
            .left_out(AccountEntry::new(taken_back, "results that a later run took back"))
            .left_out(AccountEntry::new(torn, "results of which only the beginning was stored"))
            .missing(AccountEntry::new(without as u64, "results of cases of the plan")))
    }

    /// Lists who made the results of a plan's cases up to place `end`, with the number of results of each.
    #[must_use]
    pub fn made_by(&self, plan: &Plan, end: usize) -> Vec<MadeBy> {
        let mut counts: BTreeMap<Option<u16>, u64> = BTreeMap::new();
        for case in plan.cases.iter().take(end) {
            let Some((_, stored)) = self.main_at(&case.id) else { continue };
            let maker = match stored {
                Stored::Record(record) => Some(record.maker),
                Stored::File(_) => None,
            };
            *counts.entry(maker).or_default() += 1;
        }
        let mut all: BTreeMap<Option<Maker>, u64> = BTreeMap::new();
        for (maker, results) in counts {
            let maker =
                maker.and_then(|place| Maker::from_bytes(self.makers.get(usize::from(place))?));
            *all.entry(maker).or_default() += results;
        }
        all.into_iter().map(|(maker, results)| MadeBy { maker, results }).collect()
    }

    /// Counts the further results of a case: those equal to the first, and others.
    ///
    /// # Errors
    /// If a result has to be read to tell, and can't.
    fn again(&self, case: &str) -> Result<[u64; 2], ResultError> {
        let all = self.of(case);
        let (Some((main, _)), true) = (self.main_at(case), all.len() > 1) else {
            return Ok([0; 2]);
        };
        let from = self.range(case).start;
        let first = self.blake3(&self.stored[main].1)?;
        let mut counts = [0; 2];
        for (_, (_, stored)) in all.iter().enumerate().filter(|(index, _)| from + index != main) {
            let is_other = stored.is_beside() || self.blake3(stored)? != first;
            counts[usize::from(is_other)] += 1;
        }
        Ok(counts)
    }
}
