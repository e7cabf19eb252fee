//! Direction in which the severity grows, by regression.

/// Regularization, as a share of the mean of the diagonal.
const RIDGE: f64 = 1e-3;

/// Slope of a number over points, by weighted linear regression; `None` if it has none.
#[must_use]
pub fn slope(points: &[(&[f64], f64, f64)]) -> Option<Vec<f64>> {
    let dimension = points.first().map(|(u, ..)| u.len()).filter(|dimension| *dimension > 0)?;
    let total: f64 = points.iter().map(|(_, weight, _)| weight).sum();
    if !(total > 0.0) {
        return None;
    }
    let mut centre = vec![0.0; dimension];
    let mut middle = 0.0;
    for (u, weight, value) in points {
        middle += weight / total * value;
        centre.iter_mut().zip(*u).for_each(|(centre, u)| *centre += weight / total * u);
    }
    let mut matrix = vec![0.0; dimension * dimension];
    let mut right = vec![0.0; dimension];
    let mut apart = vec![0.0; dimension];
    for (u, weight, value) in points {
        for ((apart, u), centre) in apart.iter_mut().zip(*u).zip(&centre) {
            *apart = u - centre;
        }
        for row in 0..dimension {
            let scaled = weight * apart[row];
            right[row] += scaled * (value - middle);
            let line = &mut matrix[row * dimension..=row * dimension + row];
            line.iter_mut().zip(&apart).for_each(|(entry, apart)| *entry += scaled * apart);
        }
    }
    let trace: f64 = (0..dimension).map(|row| matrix[row * dimension + row]).sum();
    for row in 0..dimension {
        matrix[row * dimension + row] += RIDGE * trace / dimension as f64;
    }
    solved(&mut matrix, &mut right, dimension)?;
    right.iter().any(|slope| *slope != 0.0).then_some(right)
}

/// Solves a symmetric positive definite system by Cholesky's root of its lower triangle.
fn solved(matrix: &mut [f64], right: &mut [f64], dimension: usize) -> Option<()> {
    let at = |row: usize, column: usize| row * dimension + column;
    for row in 0..dimension {
        for column in 0..=row {
            let mut sum = matrix[at(row, column)];
            for k in 0..column {
                sum -= matrix[at(row, k)] * matrix[at(column, k)];
            }
            if row == column {
                if !(sum > 0.0) {
                    return None;
                }
                matrix[at(row, row)] = libm::sqrt(sum);
            } else {
                matrix[at(row, column)] = sum / matrix[at(column, column)];
            }
        }
    }
    for row in 0..dimension {
        for k in 0..row {
            right[row] -= matrix[at(row, k)] * right[k];
        }
        right[row] /= matrix[at(row, row)];
    }
    for row in (0..dimension).rev() {
        for k in row + 1..dimension {
            right[row] -= matrix[at(k, row)] * right[k];
        }
        right[row] /= matrix[at(row, row)];
    }
    Some(())
}
