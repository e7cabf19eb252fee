//! The smallest form of the worst fault: as few faults as it takes, and as few digits.

use crate::bench::SearchBench;
use crate::candidate::Candidate;
use crate::error::SearchError;
use crate::space::{Form, Space};
use crate::trial::Trial;
use octant_base::control::Control;

/// Harm of the smaller fault, at least, as a share of the harm of the one that was found.
const HARM_KEPT: f64 = 0.8;

/// A fault as it was found, made smaller.
#[derive(Clone, Debug)]
pub struct MinimalFault {
    /// Its trial.
    pub trial: Trial,
    /// The space in which its candidate is written: with fewer digits than that of the search.
    pub space: Space,
    /// Runs that it took.
    pub runs: usize,
}

/// Makes the fault of a trial smaller, as long as it stays harmful and unnoticed, with four fifths of its harm:
/// one fault in place of two, then values of one or two digits.
///
/// # Errors
/// If a run fails, or the end was asked for.
pub fn minimal(
    bench: &SearchBench,
    space: &Space,
    found: &Trial,
    control: &Control,
) -> Result<MinimalFault, SearchError> {
    let least = (HARM_KEPT * found.unnoticed_harm().unwrap_or(0.0)).max(1.0);
    let mut smallest = MinimalFault { trial: found.clone(), space: space.clone(), runs: 0 };
    if found.candidate.faults.len() > 1 {
        let alone =
            |fault: &crate::candidate::PlacedFault| Candidate { faults: vec![fault.clone()] };
        let singles = found.candidate.faults.iter().map(alone).collect();
        smallest.runs += found.candidate.faults.len();
        let tried = bench.run(space, singles, control)?;
        if let Some(one) = tried.into_iter().find(|trial| is_kept(trial, least)) {
            smallest.trial = one;
        }
    }
    // Each fault gets a form of its own, so that fewer digits for one don't change the other.
    let forms: Vec<Form> = (smallest.trial.candidate.faults.iter())
        .map(|fault| space.forms[fault.form].clone())
        .collect();
    smallest.space = Space { forms };
    for (form, fault) in smallest.trial.candidate.faults.iter_mut().enumerate() {
        fault.form = form;
    }
    for form in 0..smallest.space.forms.len() {
        for key in 0..smallest.space.forms[form].keys.len() {
            for digits in [1, 2] {
                if let Some(trial) =
                    with_digits(bench, &mut smallest, [form, key], digits, least, control)?
                {
                    smallest.trial = trial;
                    break;
                }
            }
        }
    }
    Ok(smallest)
}

/// Tries a key with fewer digits; the space has them where the fault is kept.
fn with_digits(
    bench: &SearchBench,
    smallest: &mut MinimalFault,
    [form, key]: [usize; 2],
    digits: i32,
    least: f64,
    control: &Control,
) -> Result<Option<Trial>, SearchError> {
    let candidate = smallest.trial.candidate.clone();
    let mut space = smallest.space.clone();
    let Some(range) = space.forms[form].keys[key].values.range_mut() else { return Ok(None) };
    if range.digits <= digits {
        return Ok(None);
    }
    range.digits = digits;
    if candidate.to_toml(&space) == candidate.to_toml(&smallest.space) {
        return Ok(None);
    }
    smallest.runs += 1;
    let tried = bench.run(&space, vec![candidate], control)?;
    let kept = tried.into_iter().find(|trial| is_kept(trial, least));
    if kept.is_some() {
        smallest.space = space;
    }
    Ok(kept)
}

fn is_kept(trial: &Trial, least: f64) -> bool {
    trial.unnoticed_harm().is_some_and(|harm| harm >= least)
}
