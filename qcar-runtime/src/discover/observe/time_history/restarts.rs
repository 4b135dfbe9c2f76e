//! Initial states of a model that a record drives, and its restarts within the record.
//!
//! The position of a mass that no link holds depends on all earlier forces, so the smallest force error becomes a
//! drift. A fit uses this drift, since nothing determines the parameters better. In a held-out run the drift would hide
//! all other errors. There such a mass is reset to its measured position and velocity, with an estimated error, at the
//! beginning of each of [`WINDOWS`] windows, and the model runs freely within a window (multiple shooting: Bock, H. G.,
//! Plitt, K. J., IFAC world congress, 1984).

use std::f64::consts::TAU;

use crate::campaign::{Quantity, Role};
use crate::discover::observe::{Restart, Spread, measures};
use crate::mean::deviation;
use crate::model::{About, Matrix, StateKind};
use crate::spectrum::{Trend, transform};
use crate::transmissibility::Point;

/// Offset of a sensor that measures an initial state, relative to the RMS of its readings.
const OFFSET: f64 = 0.1;
/// Change of the zero of a sensor or of a recorded force from run to run, relative to the deviation of its readings. A
/// choice: one percent, as of a gain. The zero of a recorded motion needs none: it is integrated without its mean.
const ZERO: f64 = 0.01;
/// Factor on the size of a motion in its record, for the prior standard deviation of an initial state: it is nearly
/// uninformative.
const WIDE: f64 = 3.0;

impl Spread {
    /// Standard deviations of the initial states, from a record with these responses, their noise, and these inputs;
    /// `rate` in Hz.
    pub(super) fn of(recorded: &[(Point, Vec<f64>)], noise: &[f64], inputs: &[(Point, Vec<f64>)], rate: f64) -> Self {
        let shows = |point: &Point| matches!(point.quantity, Quantity::Displacement | Quantity::Velocity);
        let measured = recorded.iter().zip(noise).filter(|((point, _), _)| shows(point));
        let measured = measured.map(|((point, y), noise)| {
            let power = y.iter().map(|y| y * y).sum::<f64>() / y.len() as f64;
            (point.clone(), noise.hypot(OFFSET * power.sqrt()))
        });
        let mut unmeasured = [0.0_f64; 4];
        for (point, y) in recorded.iter().chain(inputs) {
            let (far, omega) = (excursion(y), TAU * middle(y, rate));
            let of_signal = match point.quantity {
                Quantity::Displacement => [far, far * omega, far * omega * omega, 0.0],
                Quantity::Velocity => [far / omega, far, far * omega, 0.0],
                Quantity::Acceleration => [far / (omega * omega), far / omega, far, 0.0],
                Quantity::Force => [0.0, 0.0, 0.0, far],
            };
            for (unmeasured, own) in unmeasured.iter_mut().zip(of_signal) {
                *unmeasured = unmeasured.max(WIDE * own);
            }
        }
        Self {
            measured: measured.collect(),
            unmeasured,
            zeros: recorded
                .iter()
                .chain(inputs.iter().filter(|(point, _)| point.quantity == Quantity::Force))
                .map(|(point, y)| (point.clone(), ZERO * deviation(y)))
                .collect(),
        }
    }
}

/// Largest distance from the mean.
fn excursion(y: &[f64]) -> f64 {
    let mean = y.iter().sum::<f64>() / y.len() as f64;
    y.iter().map(|y| (y - mean).abs()).fold(0.0, f64::max)
}

/// Frequency (Hz) below which half of a signal's power lies, without noise and trend; at least one line of the
/// spectrum.
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

/// Number of windows of a held-out record. A choice.
const WINDOWS: usize = 20;

/// Initial states and restarts of a model for a record with these responses; `rate` in Hz.
pub fn restarts(about: &About, role: Role, responses: &[(Point, Vec<f64>)], rate: f64) -> Vec<Restart> {
    let moving =
        |(point, _): &&(Point, Vec<f64>)| matches!(point.quantity, Quantity::Displacement | Quantity::Velocity);
    let readings = responses.iter().filter(moving).map(|(point, y)| (point.clone(), y[0]));
    let start = Restart {
        sample: 0,
        readings: readings.collect(),
    };
    let drifting = |(point, _): &&(Point, Vec<f64>)| role == Role::HeldOut && shows_drift(about, point);
    let drifting: Vec<_> = responses.iter().filter(drifting).collect();
    let length = drifting.first().map_or(0, |(_, y)| y.len());
    let window = length.div_ceil(WINDOWS);
    let later = (1..WINDOWS).map(|k| k * window).take_while(|&sample| sample < length);
    let again = later.map(|sample| Restart {
        sample,
        readings: drifting
            .iter()
            .flat_map(|(point, y)| at_sample(point, y, sample, rate))
            .collect(),
    });
    std::iter::once(start).chain(again).collect()
}

/// True for a sensor of the position of a mass that no link holds.
fn shows_drift(about: &About, point: &Point) -> bool {
    let state = about.states.iter().position(|state| measures(state, point));
    state.is_some_and(|state| drifts(about, state))
}

/// True for the position of a mass that no link holds: no equation depends on it.
pub fn drifts(about: &About, state: usize) -> bool {
    let matters = |entry: &crate::model::Entry| entry.matrix == Matrix::A && usize::from(entry.column) == state;
    about.states[state].kind == StateKind::Position && !about.matrices.iter().any(matters)
}

/// Position and velocity at a sample. The velocity is the gradient of a straight line through the samples around.
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
