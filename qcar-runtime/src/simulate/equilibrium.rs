//! The equilibrium of a model: the root of its derivative, by Newton's method.

use nalgebra::{DMatrix, DVector};

/// Error: no equilibrium was found.
#[derive(Debug, PartialEq)]
pub(super) struct Unbalanced {
    /// The state with the largest rate.
    pub state: usize,
    /// Its rate.
    pub rate: f64,
}

const MOST_ITERATIONS: usize = 100;
/// Largest rate at equilibrium, relative to the size of the state.
const REST: f64 = 1e-9;
/// Relative rate below which only rounding remains.
const ROUNDING: f64 = 1e-12;
/// Relative singular value of the scaled Jacobian below which a direction is free: a model may float in x, and dry
/// friction may rest at any force. It is above the rounding of the difference quotients and below any spring.
const FREE: f64 = 1e-9;

/// Moves `x` to the nearest zero of `derivative`; `scales` are the sizes of the states.
///
/// If the equilibrium is not unique, the nearest is taken, so that states without a force keep their values.
pub(super) fn settle(
    scales: &[f64],
    mut derivative: impl FnMut(&[f64], &mut [f64]),
    x: &mut [f64],
) -> Result<(), Unbalanced> {
    let mut rate = vec![0.0; x.len()];
    derivative(x, &mut rate);
    let mut weights = vec![1.0; x.len()];
    for _ in 0..MOST_ITERATIONS {
        let mut jacobian = differences(scales, &mut derivative, x);
        weights = row_weights(&jacobian);
        if largest(&rate, &weights).1 < ROUNDING {
            break;
        }
        for (i, weight) in weights.iter().enumerate() {
            jacobian.row_mut(i).scale_mut(*weight);
        }
        let residual = DVector::from_iterator(x.len(), rate.iter().zip(&weights).map(|(r, w)| -r * w));
        let Some(step) = shortest_solution(jacobian, &residual) else {
            break;
        };
        if !descend(scales, &weights, step.as_slice(), &mut derivative, x, &mut rate) {
            break;
        }
    }
    judge(&rate, &weights)
}

/// The shortest step that solves `jacobian * step = residual`; `None` if the Jacobian is not finite.
fn shortest_solution(jacobian: DMatrix<f64>, residual: &DVector<f64>) -> Option<DVector<f64>> {
    const MOST_SWEEPS: usize = 1000;
    if !jacobian.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    only_solution(&jacobian, residual).or_else(|| {
        let decomposition = jacobian.try_svd(true, true, f64::EPSILON, MOST_SWEEPS)?;
        decomposition.solve(residual, FREE).ok()
    })
}

/// The step if no direction is free, which is much cheaper than a singular value decomposition: no singular value is
/// smaller than the reciprocal of the norm of the inverse.
fn only_solution(jacobian: &DMatrix<f64>, residual: &DVector<f64>) -> Option<DVector<f64>> {
    let inverse = jacobian.clone().try_inverse()?;
    (FREE * inverse.norm() < 1.0).then(|| inverse * residual)
}

/// Moves along `step` as long as the largest weighted rate decreases. False if it does not decrease at all.
fn descend(
    scales: &[f64],
    weights: &[f64],
    step: &[f64],
    derivative: &mut impl FnMut(&[f64], &mut [f64]),
    x: &mut [f64],
    rate: &mut [f64],
) -> bool {
    let before = largest(rate, weights).1;
    let start = x.to_vec();
    let mut trial = vec![0.0; x.len()];
    for halvings in 0..40 {
        let part = 0.5_f64.powi(halvings);
        for i in 0..x.len() {
            x[i] = start[i] + part * scales[i] * step[i];
        }
        derivative(x, &mut trial);
        if largest(&trial, weights).1 < before {
            rate.copy_from_slice(&trial);
            return true;
        }
    }
    x.copy_from_slice(&start);
    false
}

/// Central differences, with one column for each state.
fn differences(scales: &[f64], derivative: &mut impl FnMut(&[f64], &mut [f64]), x: &[f64]) -> DMatrix<f64> {
    let n = x.len();
    let (mut there, mut up, mut down) = (x.to_vec(), vec![0.0; n], vec![0.0; n]);
    let mut jacobian = DMatrix::zeros(n, n);
    for j in 0..n {
        const PART: f64 = 1e-5;
        there[j] = x[j] + PART * scales[j];
        derivative(&there, &mut up);
        there[j] = x[j] - PART * scales[j];
        derivative(&there, &mut down);
        there[j] = x[j];
        for i in 0..n {
            jacobian[(i, j)] = (up[i] - down[i]) / (2.0 * PART);
        }
    }
    jacobian
}

/// Reciprocal of the largest entry of each row, so that rates of all units have equal weight; 1 for a row of zeros.
fn row_weights(jacobian: &DMatrix<f64>) -> Vec<f64> {
    let weight = |largest: f64| if largest > 0.0 { largest.recip() } else { 1.0 };
    jacobian.row_iter().map(|row| weight(row.amax())).collect()
}

/// Position and value of the largest weighted rate; infinite if one is NaN.
fn largest(rate: &[f64], weights: &[f64]) -> (usize, f64) {
    let weighted = rate.iter().zip(weights).map(|(r, w)| (r * w).abs());
    let weighted = weighted.map(|size| if size.is_nan() { f64::INFINITY } else { size });
    weighted
        .enumerate()
        .fold((0, 0.0), |most, here| if here.1 > most.1 { here } else { most })
}

fn judge(rate: &[f64], weights: &[f64]) -> Result<(), Unbalanced> {
    let (state, size) = largest(rate, weights);
    if size <= REST {
        Ok(())
    } else {
        Err(Unbalanced {
            state,
            rate: rate[state],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hardening_spring_rests_where_it_carries_the_load() {
        let fall = |x: &[f64], dx: &mut [f64]| {
            dx[0] = x[1];
            dx[1] = -9.81 - 1e3 * x[0] - 1e7 * x[0].powi(3) - x[1];
        };
        let mut x = [0.0, 0.0];
        settle(&[0.01, 0.1], fall, &mut x).expect("it rests");
        let load = -1e3 * x[0] - 1e7 * x[0].powi(3);
        assert!((load - 9.81).abs() < 1e-9 && x[1].abs() < 1e-12, "{x:?}");
    }

    #[test]
    fn what_floats_stays_where_it_is() {
        let chain = |x: &[f64], dx: &mut [f64]| {
            dx[0] = x[2];
            dx[1] = x[3];
            dx[2] = -400.0 * (x[0] - x[1]);
            dx[3] = 300.0 * (x[0] - x[1]);
        };
        let mut x = [0.02, 0.02, 0.0, 0.0];
        settle(&[0.01, 0.01, 0.1, 0.1], chain, &mut x).expect("it rests anywhere");
        assert_eq!(x, [0.02, 0.02, 0.0, 0.0]);
    }

    #[test]
    fn a_mass_that_nothing_holds_is_named() {
        let fall = |x: &[f64], dx: &mut [f64]| {
            dx[0] = x[1];
            dx[1] = -9.81;
        };
        let unbalanced = settle(&[0.01, 0.1], fall, &mut [0.0, 0.0]);
        assert_eq!(unbalanced, Err(Unbalanced { state: 1, rate: -9.81 }));
    }

    #[test]
    fn a_load_beyond_what_a_law_can_carry_has_no_rest() {
        let weak = |x: &[f64], dx: &mut [f64]| {
            dx[0] = x[1];
            dx[1] = -9.81 - 5.0 * (100.0 * x[0]).tanh() - x[1];
        };
        assert!(settle(&[0.01, 0.1], weak, &mut [0.0, 0.0]).is_err());
    }
}
