//! Loops against their closed-form solutions.

use octant_cosim::solve::{IterationLimits, SolveError, Solved, solve};
use std::convert::Infallible;

fn run(
    u: &mut [f64],
    continuous: bool,
    g: impl Fn(&[f64]) -> Vec<f64>,
) -> Result<Solved, SolveError<Infallible>> {
    let nominal = vec![1.0; u.len()];
    solve(u, &nominal, continuous, &IterationLimits::default(), |u, back| {
        back.copy_from_slice(&g(u));
        Ok(())
    })
}

#[test]
fn a_linear_loop_has_its_solution_though_applying_it_diverges() {
    // x = a·y, y = b·x + c: x = a·c/(1 − a·b), with a·b = −12.
    let (a, b, c) = (3.0, -4.0, 5.0);
    let mut u = [0.0, 0.0];
    let solved = run(&mut u, true, |u| vec![a * u[1], b * u[0] + c]).unwrap();
    let x = a * c / (1.0 - a * b);
    assert!((u[0] - x).abs() < 1e-9 && (u[1] - x / a).abs() < 1e-9, "{u:?}");
    assert!(!solved.exact && solved.residual <= 1e-10);
}

#[test]
fn what_only_looks_like_a_loop_is_exact() {
    let mut u = [9.0, 9.0, 9.0];
    let solved = run(&mut u, true, |u| vec![u[1] + 0.1, u[2] * 3.0, 0.7]).unwrap();
    assert!(solved.exact);
    assert_eq!(u, [0.7 * 3.0 + 0.1, 0.7 * 3.0, 0.7]);
}

#[test]
fn a_curved_loop_is_solved() {
    let mut u = [1.0];
    run(&mut u, true, |u| vec![u[0].cos()]).unwrap();
    // The Dottie number.
    assert!((u[0] - 0.739_085_133_215_160_6).abs() < 1e-9, "{u:?}");
    // From here Newton's full step leads out of the domain of the root.
    let mut u = [30.0];
    run(&mut u, true, |u| vec![10.0 - u[0].powi(3)]).unwrap();
    assert!((u[0].powi(3) + u[0] - 10.0).abs() < 1e-8, "{u:?}");
}

#[test]
fn loops_without_a_single_solution_are_told() {
    let singular = run(&mut [0.0], true, |u| vec![u[0] + 1.0]);
    assert_eq!(singular, Err(SolveError::Singular));
    let flips = run(&mut [0.0], false, |u| vec![1.0 - u[0]]);
    assert!(matches!(flips, Err(SolveError::NotSettled(_))), "{flips:?}");
    let infinite = run(&mut [0.0], true, |u| vec![1.0 / u[0]]);
    assert_eq!(infinite, Err(SolveError::NotFinite));
    let latch = run(&mut [0.0, 0.0], false, |u| vec![1.0, u[0].max(u[1])]).unwrap();
    assert!(latch.exact);
}
