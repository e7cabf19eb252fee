//! The smallest set of faults that breaks a run.

use octant_run::minimise::{SearchStep, SetOutcome, minimise};

/// Minimises with a run that fails if all of `needed` are in the set.
fn minimal(count: usize, needed: &[usize]) -> (Option<Vec<usize>>, Vec<SearchStep>) {
    minimise(count, |set| {
        Ok::<_, ()>(if needed.iter().all(|fault| set.contains(fault)) {
            SetOutcome::Breaks
        } else {
            SetOutcome::Holds
        })
    })
    .unwrap()
}

#[test]
fn it_finds_what_is_needed_and_nothing_else() {
    for needed in [vec![0], vec![7], vec![2, 5], vec![0, 7], vec![1, 3, 6], (0..8).collect()] {
        let (found, trail) = minimal(8, &needed);
        assert_eq!(found, Some(needed));
        let mut tried: Vec<_> = trail.iter().map(|step| &step.faults).collect();
        tried.sort();
        tried.dedup();
        assert_eq!(tried.len(), trail.len(), "a set was run twice");
    }
}

#[test]
fn a_set_that_holds_or_breaks_without_faults_has_no_culprit() {
    assert_eq!(minimal(4, &[9]).0, None);
    assert_eq!(minimal(4, &[]).0, None);
}

#[test]
fn any_one_fault_is_enough_where_each_breaks_alone() {
    let (found, _) = minimise(5, |set| {
        Ok::<_, ()>(if set.is_empty() { SetOutcome::Holds } else { SetOutcome::Breaks })
    })
    .unwrap();
    assert_eq!(found, Some(vec![0]));
}

#[test]
fn a_fault_that_waits_for_another_stays_with_it() {
    // Fault 3 makes the run fail, and can't be run without fault 1.
    let (found, trail) = minimise(6, |set| {
        Ok::<_, ()>(match (set.contains(&1), set.contains(&3)) {
            (true, true) => SetOutcome::Breaks,
            (false, true) => SetOutcome::Impossible,
            _ => SetOutcome::Holds,
        })
    })
    .unwrap();
    assert_eq!(found, Some(vec![1, 3]));
    assert!(trail.iter().any(|step| step.outcome == SetOutcome::Impossible));
}
