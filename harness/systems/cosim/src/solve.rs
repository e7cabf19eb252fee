//! Solves for values that depend on themselves: u = g(u).
//!
//! First g is applied n + 1 times for n values: if a loop is only apparent, because a description does not
//! state an output's dependencies, this settles it to the last bit. Then follows Newton's method
//! with difference quotients as derivatives, and shorter steps where a full one increases the
//! residual. Loops through whole numbers and Booleans have no derivatives: there g is applied until
//! nothing changes.

/// Limits at which an iteration ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IterationLimits {
    /// Largest |g(u) − u| of a value over its size (or its nominal, where that is larger).
    pub tolerance: f64,
    /// Maximum number of iterations.
    pub iterations: u32,
}

impl Default for IterationLimits {
    fn default() -> Self {
        Self { tolerance: 1e-10, iterations: 100 }
    }
}

/// A solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved {
    /// Number of iterations.
    pub iterations: u32,
    /// Largest |g(u) − u| over the size of the value.
    pub residual: f64,
    /// True if g returned the same bits: no value really depends on itself, or all have settled.
    pub exact: bool,
}

/// Reasons why there is no solution.
#[derive(Clone, Debug, PartialEq)]
pub enum SolveError<E> {
    /// g failed.
    Failed(E),
    /// The values go on changing; the largest residual.
    NotSettled(f64),
    /// The solution isn't unique: the derivatives don't determine some value.
    Singular,
    /// A value is not finite.
    NotFinite,
}

impl<E> From<E> for SolveError<E> {
    fn from(error: E) -> Self {
        Self::Failed(error)
    }
}

/// Finds u = g(u) from a start. `nominal` is the usual size of each value; `continuous` tells that
/// all are real numbers.
///
/// # Errors
/// If g fails, or there is no solution within the limits.
pub fn solve<E>(
    u: &mut [f64],
    nominal: &[f64],
    continuous: bool,
    limits: &IterationLimits,
    mut g: impl FnMut(&[f64], &mut [f64]) -> Result<(), E>,
) -> Result<Solved, SolveError<E>> {
    let n = u.len();
    let start = u.to_vec();
    let mut back = vec![0.0; n];
    let plain = if continuous { n as u32 + 1 } else { limits.iterations };
    let mut iterations = 0;
    for _ in 0..plain {
        iterations += 1;
        g(u, &mut back)?;
        if u.iter().zip(&back).all(|(a, b)| a.to_bits() == b.to_bits()) {
            return Ok(Solved { iterations, residual: 0.0, exact: true });
        }
        u.copy_from_slice(&back);
    }
    if !continuous {
        g(u, &mut back)?;
        return Err(SolveError::NotSettled(residual(u, &back, nominal)));
    }
    // Applying g may have led far away.
    u.copy_from_slice(&start);
    g(u, &mut back)?;
    let mut matrix = vec![0.0; n * n];
    let (mut ahead, mut moved, mut trial) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    for _ in 0..limits.iterations {
        iterations += 1;
        let now = residual(u, &back, nominal);
        if now.is_nan() {
            return Err(SolveError::NotFinite);
        }
        if now <= limits.tolerance {
            return Ok(Solved { iterations, residual: now, exact: false });
        }
        // I − ∂g/∂u, a column at a time.
        for column in 0..n {
            trial.copy_from_slice(u);
            let size = u[column].abs().max(nominal[column].abs());
            trial[column] += f64::EPSILON.sqrt() * size;
            let step = trial[column] - u[column];
            g(&trial, &mut ahead)?;
            for row in 0..n {
                let slope = (ahead[row] - back[row]) / step;
                matrix[row * n + column] = f64::from(u8::from(row == column)) - slope;
            }
        }
        for ((moved, back), u) in moved.iter_mut().zip(&back).zip(&*u) {
            *moved = back - u;
        }
        eliminate(&mut matrix, &mut moved).ok_or(SolveError::Singular)?;
        // A full step, or a shorter one where the full step increases the residual.
        let mut part = 1.0;
        loop {
            for i in 0..n {
                trial[i] = u[i] + part * moved[i];
            }
            g(&trial, &mut ahead)?;
            let there = residual(&trial, &ahead, nominal);
            if there < now || part < 1e-3 {
                u.copy_from_slice(&trial);
                back.copy_from_slice(&ahead);
                break;
            }
            part *= 0.5;
        }
    }
    Err(SolveError::NotSettled(residual(u, &back, nominal)))
}

/// Returns the largest |g(u) − u| of a value over its size; NaN if one isn't finite.
fn residual(u: &[f64], back: &[f64], nominal: &[f64]) -> f64 {
    let mut worst = 0.0f64;
    for ((u, back), nominal) in u.iter().zip(back).zip(nominal) {
        let one = (back - u).abs() / u.abs().max(nominal.abs()).max(f64::MIN_POSITIVE);
        if !one.is_finite() {
            return f64::NAN;
        }
        worst = worst.max(one);
    }
    worst
}

/// Solves a system of linear equations in place, with partial pivoting; `None` if it is singular to
/// working precision.
fn eliminate(matrix: &mut [f64], right: &mut [f64]) -> Option<()> {
    let n = right.len();
    let size = matrix.iter().fold(0.0f64, |size, x| size.max(x.abs()));
    for column in 0..n {
        let (pivot, largest) = (column..n)
            .map(|row| (row, matrix[row * n + column].abs()))
            .max_by(|a, b| a.1.total_cmp(&b.1))?;
        // Difference quotients have only half the digits.
        if !(largest > 1e-7 * size) {
            return None;
        }
        if pivot != column {
            for k in 0..n {
                matrix.swap(pivot * n + k, column * n + k);
            }
            right.swap(pivot, column);
        }
        for row in column + 1..n {
            let factor = matrix[row * n + column] / matrix[column * n + column];
            for k in column..n {
                matrix[row * n + k] -= factor * matrix[column * n + k];
            }
            right[row] -= factor * right[column];
        }
    }
    for row in (0..n).rev() {
        let known: f64 = (row + 1..n).map(|k| matrix[row * n + k] * right[k]).sum();
        right[row] = (right[row] - known) / matrix[row * n + row];
    }
    Some(())
}
