//! The classical Runge-Kutta method at a fixed step.

use crate::corner::{STATES, State};

/// One step of length `h` from time `t`.
pub fn step(t: f64, y: &State, h: f64, f: &dyn Fn(f64, &State) -> State) -> State {
    let k1 = f(t, y);
    let k2 = f(t + h / 2.0, &along(y, &k1, h / 2.0));
    let k3 = f(t + h / 2.0, &along(y, &k2, h / 2.0));
    let k4 = f(t + h, &along(y, &k3, h));
    std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

fn along(y: &State, k: &State, h: f64) -> State {
    let mut next = [0.0; STATES];
    for i in 0..STATES {
        next[i] = y[i] + h * k[i];
    }
    next
}
