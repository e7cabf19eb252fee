//! The way of the errors from one measurement that was used to the next: what a smoother needs beside the covariance.

use crate::covariance::{CovarianceRow, MOVING, STATE_COUNT, Transition};

/// Transition of the errors since the last measurement that was used.
#[derive(Clone, Debug)]
pub struct Passage {
    transition: Transition,
    broken: bool,
    ended: bool,
}

impl Passage {
    pub(super) fn new() -> Self {
        Self { transition: Transition::identity(), broken: false, ended: false }
    }

    /// Transition over all of the passage.
    #[must_use]
    pub fn transition(&self) -> &Transition {
        &self.transition
    }

    /// Returns whether the filter went back or opened its covariance in it: what came before tells
    /// less of what follows than the transition says.
    #[must_use]
    pub fn is_broken(&self) -> bool {
        self.broken
    }

    /// Goes on by a transition.
    pub(super) fn go_on(&mut self, transition: &Transition) {
        if self.ended {
            *self = Self { transition: transition.clone(), broken: false, ended: false };
        } else {
            self.transition = after(transition, &self.transition);
        }
    }

    pub(super) fn break_off(&mut self) {
        if self.ended {
            *self = Self::new();
        }
        self.broken = true;
    }

    /// A measurement is used: what follows is the next passage.
    pub(super) fn end(&mut self) {
        self.ended = true;
    }
}

/// The transition `later` after the transition `earlier`.
fn after(later: &Transition, earlier: &Transition) -> Transition {
    let mut rows: [CovarianceRow; MOVING] = later.rows;
    for (row, later) in rows.iter_mut().zip(&later.rows) {
        row[..MOVING].fill(0.0);
        for (factor, earlier) in later[..MOVING].iter().zip(&earlier.rows) {
            for (out, value) in row[..STATE_COUNT].iter_mut().zip(earlier) {
                *out += factor * value;
            }
        }
    }
    Transition { rows }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_passage_is_the_product_of_its_transitions_and_begins_anew_after_a_measurement() {
        let mut first = Transition::identity();
        let mut second = Transition::identity();
        (first.rows[0][4], first.rows[0][12]) = (2.0, 0.5);
        (second.rows[4][0], second.rows[4][12]) = (3.0, -1.0);
        let mut passage = Passage::new();
        passage.go_on(&first);
        passage.go_on(&second);
        // x4 ← x4 + 3 (x0 + 2 x4 + x12/2) − x12.
        let row = passage.transition().rows[4];
        assert_eq!((row[0], row[4], row[12]), (3.0, 7.0, 0.5));
        assert_eq!(passage.transition().rows[0], first.rows[0]);
        passage.break_off();
        assert!(passage.is_broken());
        passage.end();
        passage.go_on(&second);
        assert!(!passage.is_broken());
        assert_eq!(*passage.transition(), second);
    }
}
