//! Intervals of coefficients by the rise of the deviance, and the models over which they span.

use super::choice::{Chosen, Rival};
use super::scoring::{Fixed, Rows};
use super::uncertainty::Uncertainty;
use crate::freedom::Covariances;
use crate::kernel::TERMS;

/// Fall of the deviance, as χ², above which a term that isn't shown widens the intervals of the others.
const WIDENS: f64 = 1.0;
/// 95th percentile of χ² with one degree of freedom.
const TWO_SIDED: f64 = 3.841_458_820_694_124;

/// The interval that holds both.
pub(super) fn span(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// The model with the terms that aren't shown and may be there all the same.
pub(super) fn widened(rows: &Rows, covariances: &Covariances, chosen: &Chosen) -> Chosen {
    let mut wider = Chosen { free: chosen.free.clone(), model: chosen.model };
    for index in (0..TERMS - 1).filter(|index| !chosen.free.contains(index)) {
        let mut free = wider.free.clone();
        free.push(index);
        free.sort_unstable();
        let Some(found) = rows.fit_time(&free, None, wider.model.time_s) else { continue };
        let a = Uncertainty::of(rows, covariances, &wider.model, &free).factor(index);
        let kept = chosen.free.iter().all(|index| found.squares[*index] > 0.0);
        if kept && wider.model.deviance - found.deviance > WIDENS * a {
            wider = Chosen { free, model: found };
        }
    }
    wider
}

/// Parameter whose interval is looked for.
#[derive(Clone, Copy)]
pub(super) enum Parameter {
    Square(usize),
    Time,
}

/// Interval of 95 % by the profile of the deviance.
pub(super) fn profile(
    rows: &Rows,
    covariances: &Covariances,
    chosen: &Chosen,
    parameter: Parameter,
) -> [f64; 2] {
    let Chosen { free, model } = chosen;
    let (value, column) = match parameter {
        Parameter::Square(index) => (model.squares[index], index),
        Parameter::Time => (model.time_s, TERMS),
    };
    let outside = |value: f64| {
        let found = match parameter {
            Parameter::Square(index) => {
                let rest: Vec<usize> = free.iter().copied().filter(|i| *i != index).collect();
                rows.fit_time(&rest, Some(Fixed { index, value }), model.time_s)
            }
            Parameter::Time => rows.fit(free, None, value),
        };
        let Some(found) = found else { return true };
        let a = Uncertainty::of(rows, covariances, &found, free).factor(column);
        !(found.deviance - model.deviance <= TWO_SIDED * a)
    };
    [end(value, 0.5, &outside), end(value, 2.0, &outside)]
}

/// Upper end of the interval of 95 % of the squared coefficient of a term that isn't shown.
pub(super) fn limit(rows: &Rows, covariances: &Covariances, chosen: &Chosen, index: usize) -> f64 {
    let mut all = chosen.free.clone();
    all.push(index);
    all.sort_unstable();
    let Some(best) = rows.fit_time(&all, None, chosen.model.time_s) else { return f64::NAN };
    let outside = |value: f64| {
        let fixed = Some(Fixed { index, value });
        let Some(found) = rows.fit_time(&chosen.free, fixed, chosen.model.time_s) else {
            return true;
        };
        let a = Uncertainty::of(rows, covariances, &found, &all).factor(index);
        !(found.deviance - best.deviance <= TWO_SIDED * a)
    };
    let least = rows.least(index);
    end(best.squares[index].max(least), 2.0, &outside)
}

/// Place where the deviance has risen, going from a value by a factor; 0 where it never does downwards.
fn end(value: f64, factor: f64, outside: &dyn Fn(f64) -> bool) -> f64 {
    let (mut inside, mut beyond) = (value, value * factor);
    let mut steps = 0;
    while !outside(beyond) {
        (inside, beyond) = (beyond, beyond * factor);
        steps += 1;
        if steps > 60 {
            return if factor < 1.0 { 0.0 } else { f64::INFINITY };
        }
    }
    for _ in 0..24 {
        let middle = libm::sqrt(inside * beyond);
        if outside(middle) { beyond = middle } else { inside = middle }
    }
    libm::sqrt(inside * beyond)
}

impl Rival {
    /// Interval of the squared coefficient of a term under this model.
    pub(super) fn interval(&self, rows: &Rows, index: usize) -> [f64; 2] {
        let Self { chosen, covariances } = self;
        if chosen.shows(index) {
            profile(rows, covariances, chosen, Parameter::Square(index))
        } else {
            [0.0, limit(rows, covariances, chosen, index)]
        }
    }
}
