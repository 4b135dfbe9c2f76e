//! From where a model sets out when it is driven by a record, and where it is set right on the way.
//!
//! The place of a mass that nothing holds remembers every force that ever acted on it: the smallest error of a force
//! ends as a drift. A fit lives on that, since nothing tells the parameters better. A run that judges does not: there
//! such a mass is put back to where its sensor saw it at the beginning of each of [`WINDOWS`] windows, and within a
//! window the model is on its own (multiple shooting: Bock, H. G., Plitt, K. J., IFAC world congress, 1984).

use std::f64::consts::TAU;

use crate::campaign::{Quantity, Role};
use crate::discover::observe::{Restart, Spread, is_seen};
use crate::model::{About, Matrix, StateKind};
use crate::spectrum::{Trend, transform};
use crate::transmissibility::Point;

/// The offset of a sensor that tells where a record begins, over the RMS value of what it reads.
const OFFSET: f64 = 0.1;
/// How much farther than its record shows a motion may begin: next to nothing is known before.
const WIDE: f64 = 3.0;

impl Spread {
    /// Of a record with these responses, the noise of each, and these inputs.
    pub(super) fn of(recorded: &[(Point, Vec<f64>)], noise: &[f64], inputs: &[(Point, Vec<f64>)], rate: f64) -> Self {
        let shows = |point: &Point| matches!(point.quantity, Quantity::Displacement | Quantity::Velocity);
        let seen = recorded.iter().zip(noise).filter(|((point, _), _)| shows(point));
        let seen = seen.map(|((point, y), noise)| {
            let power = y.iter().map(|y| y * y).sum::<f64>() / y.len() as f64;
            (point.clone(), noise.hypot(OFFSET * power.sqrt()))
        });
        let mut unseen = [0.0_f64; 3];
        for (point, y) in recorded.iter().chain(inputs) {
            let (far, omega) = (excursion(y), TAU * middle(y, rate));
            let of_signal = match point.quantity {
                Quantity::Displacement => [far, far * omega, 0.0],
                Quantity::Velocity => [far / omega, far, 0.0],
                Quantity::Acceleration => [far / (omega * omega), far / omega, 0.0],
                Quantity::Force => [0.0, 0.0, far],
            };
            for (unseen, own) in unseen.iter_mut().zip(of_signal) {
                *unseen = unseen.max(WIDE * own);
            }
        }
        Self {
            seen: seen.collect(),
            unseen,
        }
    }
}

/// The farthest from the mean.
fn excursion(y: &[f64]) -> f64 {
    let mean = y.iter().sum::<f64>() / y.len() as f64;
    y.iter().map(|y| (y - mean).abs()).fold(0.0, f64::max)
}

/// The frequency (Hz) below which half of a signal's power is, noise and trend aside; at least a line of the spectrum.
fn middle(y: &[f64], rate: f64) -> f64 {
    let mut about = y.to_vec();
    Trend::Linear.remove(&mut about);
    let power: Vec<f64> = transform(&about).iter().map(|line| line.norm_sqr()).collect();
    let half = power.iter().sum::<f64>() / 2.0;
    let mut sum = 0.0;
    let line = power.iter().position(|power| {
        sum += power;
        sum >= half
    });
    line.unwrap_or(0).max(1) as f64 * rate / y.len() as f64
}

/// Windows of a record.
const WINDOWS: usize = 20;

/// Where a model begins that is driven by a record with these responses, and where it is set right.
pub fn restarts(about: &About, role: Role, responses: &[(Point, Vec<f64>)], rate: f64) -> Vec<Restart> {
    let moving =
        |(point, _): &&(Point, Vec<f64>)| matches!(point.quantity, Quantity::Displacement | Quantity::Velocity);
    let seen = responses.iter().filter(moving).map(|(point, y)| (point.clone(), y[0]));
    let start = Restart {
        sample: 0,
        seen: seen.collect(),
    };
    let drifting = |(point, _): &&(Point, Vec<f64>)| role == Role::HeldOut && shows_drift(about, point);
    let drifting: Vec<_> = responses.iter().filter(drifting).collect();
    let length = drifting.first().map_or(0, |(_, y)| y.len());
    let window = length.div_ceil(WINDOWS);
    let later = (1..WINDOWS).map(|k| k * window).take_while(|&sample| sample < length);
    let again = later.map(|sample| Restart {
        sample,
        seen: drifting
            .iter()
            .flat_map(|(point, y)| at_sample(point, y, sample, rate))
            .collect(),
    });
    std::iter::once(start).chain(again).collect()
}

/// True of the sensor that shows where a mass is that no link holds.
fn shows_drift(about: &About, point: &Point) -> bool {
    let state = about.states.iter().position(|state| is_seen(state, point));
    state.is_some_and(|state| drifts(about, state))
}

/// True of the position of a mass on which nothing depends: no link holds it.
pub fn drifts(about: &About, state: usize) -> bool {
    let matters = |entry: &crate::model::Entry| entry.matrix == Matrix::A && usize::from(entry.column) == state;
    about.states[state].kind == StateKind::Position && !about.matrices.iter().any(matters)
}

/// Position and velocity there; this is the slope of the straight line through the samples around.
fn at_sample(point: &Point, y: &[f64], sample: usize, rate: f64) -> [(Point, f64); 2] {
    const AROUND: usize = 5;
    let around = AROUND.min(y.len() - 1 - sample).min(sample);
    let (mut slope, mut weight) = (0.0, f64::MIN_POSITIVE);
    for k in 1..=around {
        slope += k as f64 * (y[sample + k] - y[sample - k]);
        weight += 2.0 * (k * k) as f64;
    }
    let velocity = Point {
        quantity: Quantity::Velocity,
        ..point.clone()
    };
    [(point.clone(), y[sample]), (velocity, slope / weight * rate)]
}
