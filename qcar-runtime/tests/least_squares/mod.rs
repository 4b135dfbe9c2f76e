//! The least-squares solver against published problems: certified estimates and standard errors (NIST Statistical
//! Reference Datasets, nonlinear regression) and the collection of Moré, Garbow & Hillstrom, "Testing unconstrained
//! optimization software", ACM TOMS 7 (1981), with and without bounds.

// A number type that carries derivatives, and residuals written with it.
mod dual;
// Every data set of NIST, from every start.
mod nist;
// Some variables held.
mod holding;
// How far a variable may be moved.
mod profile;

use nalgebra::{DMatrix, DVector};
use qcar_runtime::least_squares::{Bounds, Options, Outcome, Stop, minimize};

use dual::{Dual, Functions};

const TIGHT: Options = Options {
    gradient: 1e-12,
    cost: 1e-15,
    step: 1e-12,
    decrement: 0.0,
    evaluations: 2000,
};

fn solve<F: Fn(&[Dual], usize) -> Dual>(residuals: usize, start: &[f64], bounds: &Bounds, residual: F) -> Outcome {
    minimize(
        &mut Functions {
            variables: start.len(),
            residuals,
            residual,
        },
        start,
        bounds,
        &TIGHT,
    )
}

fn unbounded<F: Fn(&[Dual], usize) -> Dual>(residuals: usize, start: &[f64], residual: F) -> Outcome {
    solve(residuals, start, &Bounds::none(start.len()), residual)
}

#[track_caller]
fn assert_close(actual: &[f64], expected: &[f64], relative: f64) {
    for (actual, expected) in actual.iter().zip(expected) {
        let size = if *expected == 0.0 { 1.0 } else { expected.abs() };
        assert!(
            (actual - expected).abs() <= relative * size,
            "{actual} is not {expected}"
        );
    }
}

fn rosenbrock(x: &[Dual], row: usize) -> Dual {
    if row == 0 {
        (x[1] - x[0] * x[0]) * 10.0
    } else {
        x[0] * -1.0 + 1.0
    }
}

#[test]
fn rosenbrock_with_and_without_bounds() {
    let none = f64::INFINITY;
    let usual = [-1.2, 1.0];
    // With y on its bound the slope along x vanishes at the roots of x³ - 1.495 x - 0.005: a minimum on either side.
    let right = 1.2243707487363527;
    let cases = [
        (usual, [-none, -none], [none, none], [1.0, 1.0]),
        (usual, [-none, -1.5], [none, none], [1.0, 1.0]),
        (usual, [-2.0, -1.5], [0.8, none], [0.8, 0.64]),
        (usual, [-2.0, -2.0], [0.5, 3.0], [0.5, 0.25]),
        ([1.5, 2.0], [-none, 1.5], [none, none], [right, 1.5]),
    ];
    for (start, lower, upper, expected) in cases {
        let bounds = Bounds {
            lower: lower.to_vec(),
            upper: upper.to_vec(),
        };
        let outcome = solve(2, &start, &bounds, rosenbrock);
        assert!(outcome.stop.converged(), "{:?}", outcome.stop);
        assert_close(&outcome.x, &expected, 1e-6);
        for k in 0..2 {
            let side = i8::from(expected[k] == upper[k]) - i8::from(expected[k] == lower[k]);
            assert_eq!(outcome.at_bound[k], side, "{expected:?}");
        }
    }
}

#[test]
fn powell_badly_scaled() {
    let outcome = unbounded(2, &[0.0, 1.0], |x, row| match row {
        0 => x[0] * x[1] * 1e4 - 1.0,
        _ => (x[0] * -1.0).exp() + (x[1] * -1.0).exp() - 1.0001,
    });
    assert!(outcome.stop.converged(), "{:?}", outcome.stop);
    assert_close(&outcome.x, &[1.0981593e-5, 9.1061467], 1e-6);
}

#[test]
fn osborne_1() {
    let y = [
        0.844, 0.908, 0.932, 0.936, 0.925, 0.908, 0.881, 0.850, 0.818, 0.784, 0.751, 0.718, 0.685, 0.658, 0.628, 0.603,
        0.580, 0.558, 0.538, 0.522, 0.506, 0.490, 0.478, 0.467, 0.457, 0.448, 0.438, 0.431, 0.424, 0.420, 0.414, 0.411,
        0.406,
    ];
    let outcome = unbounded(y.len(), &[0.5, 1.5, -1.0, 0.01, 0.02], |x, row| {
        let t = -10.0 * row as f64;
        x[0] + x[1] * (x[3] * t).exp() + x[2] * (x[4] * t).exp() - y[row]
    });
    assert!(outcome.stop.converged(), "{:?}", outcome.stop);
    assert_close(&[2.0 * outcome.cost], &[5.46489e-5], 1e-5);
}

#[test]
fn units_do_not_matter() {
    let plain = unbounded(2, &[-1.2, 1.0], rosenbrock);
    // Powers of two, so that not even rounding differs.
    let (large, small) = (f64::powi(2.0, 20), f64::powi(2.0, -30));
    let units = |x: &[Dual]| [x[0] * large.recip(), x[1] * small.recip()];
    let scaled = unbounded(2, &[-1.2 * large, small], |x, row| rosenbrock(&units(x), row));
    assert_eq!(plain.evaluations, scaled.evaluations);
    assert_close(&[scaled.x[0] / large, scaled.x[1] / small], &plain.x, 0.0);
}

#[test]
fn a_variable_that_nothing_depends_on_stays_where_it_started() {
    let outcome = unbounded(2, &[-1.2, 1.0, 7.5], |x, row| rosenbrock(&x[..2], row));
    assert!(outcome.stop.converged());
    assert_eq!(outcome.x[2], 7.5);
}

#[test]
fn a_product_that_cannot_be_told_apart_is_still_fitted() {
    let outcome = unbounded(4, &[1.0, 1.0], |x, row| {
        x[0] * x[1] * (1.0 + row as f64) - 6.0 * (1.0 + row as f64)
    });
    assert!(outcome.stop.converged(), "{:?}", outcome.stop);
    assert_close(&[outcome.x[0] * outcome.x[1]], &[6.0], 1e-8);
}

#[test]
fn values_that_are_not_finite_are_never_a_success() {
    let start = unbounded(1, &[1.0], |x, _| x[0] * f64::NAN);
    assert_eq!(start.stop, Stop::NotFinite);
    // Finite at the start alone: every way down is barred.
    let cliff = unbounded(1, &[1.0], |x, _| if x[0].0 < 1.0 { x[0] * f64::NAN } else { x[0] });
    assert_eq!(cliff.stop, Stop::NotFinite);
}

#[test]
fn running_out_of_evaluations_is_said() {
    let options = Options {
        evaluations: 5,
        ..TIGHT
    };
    let mut problem = Functions {
        variables: 2,
        residuals: 2,
        residual: rosenbrock,
    };
    let outcome = minimize(&mut problem, &[-1.2, 1.0], &Bounds::none(2), &options);
    assert_eq!((outcome.stop, outcome.evaluations), (Stop::Evaluations, 5));
    assert!(!outcome.stop.converged());
}

/// Residuals in standard deviations: a search that ends by the decrement is within a tenth of a standard error of the
/// minimum. If the minimum is at a bound, it still ends there.
#[test]
fn the_decrement_ends_a_search_near_its_minimum_but_not_short_of_a_bound() {
    let early = Options {
        decrement: 0.005,
        ..TIGHT
    };
    let search = |bounds: &Bounds, options: &Options| {
        let mut problem = Functions {
            variables: 2,
            residuals: 2,
            residual: rosenbrock,
        };
        minimize(&mut problem, &[-1.2, 1.0], bounds, options)
    };
    let free = Bounds::none(2);
    let [early_end, end] = [&early, &TIGHT].map(|options| search(&free, options));
    assert_eq!(early_end.stop, Stop::Gradient);
    assert!(early_end.evaluations < end.evaluations);
    let change = &early_end.jacobian * (DVector::from_vec(early_end.x) - DVector::from_vec(end.x));
    assert!(change.norm() < 0.1, "{change}");
    let bounded = Bounds {
        upper: vec![0.97, f64::INFINITY],
        ..Bounds::none(2)
    };
    let [early_end, end] = [&early, &TIGHT].map(|options| search(&bounded, options));
    assert_eq!((&early_end.at_bound, &end.at_bound), (&vec![1, 0], &vec![1, 0]));
    assert_close(&early_end.x, &end.x, 1e-9);
}

#[test]
fn the_cost_never_rises_and_the_jacobian_is_that_of_the_optimum() {
    let outcome = unbounded(2, &[-1.2, 1.0], rosenbrock);
    assert!(outcome.cost <= outcome.start_cost);
    let expected = DMatrix::from_row_slice(2, 2, &[-20.0 * outcome.x[0], 10.0, -1.0, 0.0]);
    assert!((outcome.jacobian - expected).norm() < 1e-12);
}
