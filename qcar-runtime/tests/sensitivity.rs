//! Sobol indices against closed forms.

use std::f64::consts::PI;

use qcar_runtime::progress::NO_PROGRESS;
use qcar_runtime::sensitivity::{Indices, Plan, indices};

const PLAN: Plan = Plan {
    designs: 40_000,
    seed: 1,
};

/// Standard deviation of the estimators at this plan is some 0.01; three of them.
const TOLERANCE: f64 = 0.03;

fn hold(found: &Indices, exact: &[[f64; 2]]) {
    for (found, [first, total]) in found.of[0].iter().zip(exact) {
        assert!((found.first - first).abs() < TOLERANCE, "{found:?}, first {first}");
        assert!((found.total - total).abs() < TOLERANCE, "{found:?}, total {total}");
    }
}

/// T. Ishigami and T. Homma, "An importance quantification technique in uncertainty analysis for computer models",
/// ISUMA 1990; the closed form of its indices with a = 7, b = 0.1.
#[test]
fn ishigami() {
    let [a, b]: [f64; 2] = [7.0, 0.1];
    let design = |u: &Vec<f64>| {
        let x: Vec<f64> = u.iter().map(|u| PI * (2.0 * u - 1.0)).collect();
        Some(vec![
            x[0].sin() + a * x[1].sin().powi(2) + b * x[2].powi(4) * x[0].sin(),
        ])
    };
    let found = indices(3, PLAN, NO_PROGRESS, |designs| designs.iter().map(design).collect());
    let (one, two) = (0.5 * (1.0 + b * PI.powi(4) / 5.0).powi(2), a * a / 8.0);
    let together = 8.0 * b * b * PI.powi(8) / 225.0;
    let all = one + two + together;
    assert!((found.moments[0][1].powi(2) / all - 1.0).abs() < 0.03);
    hold(
        &found,
        &[
            [one / all, (one + together) / all],
            [two / all; 2],
            [0.0, together / all],
        ],
    );
}

/// Shares of a sum are the squares of its factors, and its intervals hold them.
#[test]
fn a_sum() {
    let factors = [3.0, -2.0, 1.0, 0.0];
    let design = |u: &Vec<f64>| Some(vec![5.0 + u.iter().zip(factors).map(|(u, f)| u * f).sum::<f64>()]);
    let found = indices(4, PLAN, NO_PROGRESS, |designs| designs.iter().map(design).collect());
    let exact = factors.map(|factor| [factor * factor / 14.0; 2]);
    hold(&found, &exact);
    for (found, [first, total]) in found.of[0].iter().zip(exact) {
        // A third more than the interval: one in twenty may lie beside it.
        let wide = |[low, high]: [f64; 2]| (high - low) / 3.0 + 1e-12;
        let inside =
            |interval: [f64; 2], value| interval[0] - wide(interval) <= value && value <= interval[1] + wide(interval);
        assert!(inside(found.first_interval, first), "{found:?} {first}");
        assert!(inside(found.total_interval, total), "{found:?} {total}");
    }
}

#[test]
fn designs_without_results_are_left_out_and_counted() {
    let design = |u: &Vec<f64>| (u[0] < 0.9).then(|| vec![u[1]]);
    let plan = Plan { designs: 400, seed: 3 };
    let found = indices(2, plan, NO_PROGRESS, |designs| designs.iter().map(design).collect());
    assert!((10..40).contains(&found.failed), "{}", found.failed);
    assert!(found.of[0][1].total > 0.9);
}
