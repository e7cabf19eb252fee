//! Student's distribution.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Factor of a two-sided interval by Student's distribution; `None` without a degree of freedom.
#[must_use]
pub fn student(degrees: usize, confidence: f64) -> Option<f64> {
    if !(confidence > 0.0 && confidence < 1.0) {
        return None;
    }
    let t = StudentsT::new(0.0, 1.0, degrees as f64).ok()?;
    Some(t.inverse_cdf(0.5 * (1.0 + confidence)))
}
