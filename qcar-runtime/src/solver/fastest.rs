//! The fastest mode of a system, which limits the steps of an explicit method for any tolerance.

use super::System;

pub(super) const ITERATIONS: usize = 12;
/// Number of the last iterations over which the growth is averaged; even, since a vibration exchanges position and
/// velocity over two iterations.
const AVERAGED: usize = 4;

/// The largest modulus, 1/s, of the eigenvalues of the Jacobian at `x`, where the derivative is `slope`. It takes
/// [`ITERATIONS`] evaluations.
///
/// Power iteration with difference quotients, as in codes of stabilised Runge–Kutta methods (B. P. Sommeijer, L. F.
/// Shampine, J. G. Verwer, "RKC", J. Comp. Appl. Math. 88, 1998). `scales` are displacements of the states that are
/// too small to matter. Zero, infinite or NaN if the derivative has no such eigenvalue.
pub(super) fn fastest_rate<S: System>(
    system: &mut S,
    t: f64,
    (x, slope): (&[f64], &[f64]),
    scales: &[f64],
    (moved, moved_slope): (&mut [f64], &mut [f64]),
) -> f64 {
    let norm = |v: &[f64]| {
        let scaled = v.iter().zip(scales).map(|(v, scale)| v / scale);
        scaled.map(|v| v * v).sum::<f64>().sqrt()
    };
    // If all states moved equally, a system might be at rest again; with a ramp this is unlikely.
    for (i, (moved, scale)) in moved.iter_mut().zip(scales).enumerate() {
        *moved = scale * (1.0 + i as f64);
    }
    let mut growth = 1.0;
    for iteration in 0..ITERATIONS {
        let shrink = 1.0 / norm(moved);
        moved
            .iter_mut()
            .zip(x)
            .for_each(|(moved, x)| *moved = x + *moved * shrink);
        system.derivative(t, moved, moved_slope);
        for (moved, (there, here)) in moved.iter_mut().zip(moved_slope.iter().zip(slope)) {
            *moved = there - here;
        }
        if iteration >= ITERATIONS - AVERAGED {
            growth *= norm(moved);
        }
    }
    growth.powf(1.0 / AVERAGED as f64)
}
