//! Profiles against closed forms: a line in several unknowns, an exponential, a bound, and a product of which only one
//! is seen.

use nalgebra::{DMatrix, DVector};
use qcar_runtime::least_squares::profile::{Profile, Profiled, profile};
use qcar_runtime::least_squares::{Bounds, minimize};

use super::TIGHT;
use super::dual::{Dual, Functions};

/// Half of the 95 % quantile of chi-square: of residuals of unit variance the rise at an end.
const RISE: f64 = 0.5 * 1.96 * 1.96;

fn profiled<F: Fn(&[Dual], usize) -> Dual>(residuals: usize, start: &[f64], bounds: &Bounds, residual: F) -> Profile {
    let mut problem = Functions {
        variables: start.len(),
        residuals,
        residual,
    };
    let minimum = minimize(&mut problem, start, bounds, &TIGHT);
    let of = Profiled {
        variable: 0,
        rise: RISE,
        step: 0.1,
    };
    profile(&mut problem, &minimum, bounds, of, &TIGHT)
}

/// The measured values of a straight line with a hump, at ten places.
fn places() -> impl Iterator<Item = (f64, f64)> {
    (0..10).map(|i| (f64::from(i) / 3.0, 2.0 - 0.4 * f64::from(i) + 0.3 * f64::from(i % 3)))
}

#[test]
fn of_a_linear_problem_the_interval_is_that_of_the_standard_error() {
    let data: Vec<(f64, f64)> = places().collect();
    let found = profiled(10, &[0.0, 0.0], &Bounds::none(2), |x, row| {
        x[0] + x[1] * Dual::from(data[row].0) - Dual::from(data[row].1)
    });
    let slopes = DMatrix::from_fn(10, 2, |row, column| if column == 0 { 1.0 } else { data[row].0 });
    let values = DVector::from_iterator(10, data.iter().map(|own| own.1));
    let inverse = (slopes.transpose() * &slopes).try_inverse().unwrap();
    let estimate = &inverse * slopes.transpose() * values;
    let half = 1.96 * inverse[(0, 0)].sqrt();
    for (end, side) in found.ends.iter().zip([-1.0, 1.0]) {
        let wanted = estimate[0] + side * half;
        // An end is known to a thousandth of its distance.
        assert!((end.unwrap() - wanted).abs() < 2e-3 * half, "{found:?}, {wanted}");
    }
    assert!(found.points.is_sorted_by(|a, b| a[0] <= b[0]), "{found:?}");
}

/// `½ (eˣ - 3)²` rises by half of 1.96² where `eˣ = 3 ± 1.96`: the interval is not symmetric.
#[test]
fn of_an_exponential_the_ends_are_logarithms() {
    let found = profiled(1, &[0.5], &Bounds::none(1), |x, _| x[0].exp() - Dual::from(3.0));
    let wanted = [1.04_f64.ln(), 4.96_f64.ln()];
    for (end, wanted) in found.ends.iter().zip(wanted) {
        assert!((end.unwrap() - wanted).abs() < 2e-3, "{found:?}, {wanted}");
    }
}

#[test]
fn an_end_beyond_a_bound_is_open() {
    let bounds = Bounds {
        lower: vec![-10.0],
        upper: vec![1.5],
    };
    let found = profiled(1, &[0.5], &bounds, |x, _| x[0].exp() - Dual::from(3.0));
    assert!(found.ends[0].is_some() && found.ends[1].is_none(), "{found:?}");
    assert!((found.points.last().unwrap()[0] - 1.5).abs() < 1e-9, "{found:?}");
}

#[test]
fn what_is_seen_in_a_product_alone_is_open_at_both_ends() {
    let bounds = Bounds {
        lower: vec![0.1, 0.01],
        upper: vec![10.0, 100.0],
    };
    let found = profiled(1, &[1.0, 2.0], &bounds, |x, _| x[0] * x[1] - Dual::from(2.0));
    assert_eq!(found.ends, [None, None], "{found:?}");
}
