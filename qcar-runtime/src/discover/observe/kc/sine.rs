//! Reads a K&C sine: the harmonics of the force over the amplitude of the travel.
//!
//! The first harmonic is the dynamic stiffness and damping at that speed. Dry friction and stops cause the third, and
//! differences between the two directions the second. Comparison with the slow cycle and with sines of other
//! speeds separates a damper, whose force grows with speed, from friction, whose force does not.

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix, DVector};

use super::travel::{FLOOR, sensor};
use crate::campaign::{Axis, Campaign, DynamicCurve};
use crate::discover::observe::series::LEAST_NOISE;
use crate::discover::observe::{Evidence, Kind, Run, Series, Stimulus};
use crate::error::InputError;
use crate::model::About;

/// Number of harmonics in the evidence.
const ORDERS: usize = 3;
/// Number of harmonics that are removed before the noise is estimated.
const FITTED: usize = 7;
/// Largest share of the displacement's variance that the specified sine leaves.
const OTHER: f64 = 0.01;

impl Evidence {
    /// Reads a sine with `amplitude` (m) and `peak_velocity` (m/s).
    pub(in crate::discover::observe) fn add_sine(
        &mut self,
        campaign: &Campaign,
        about: &About,
        run: &crate::campaign::Run,
        (amplitude, peak_velocity): (f64, f64),
    ) -> Result<(), InputError> {
        let curve = campaign.dynamic_curve(run)?;
        let Some(on) = self.on_rig(campaign, about, run, &Axis::Z) else {
            return Ok(());
        };
        let frequency = peak_velocity / amplitude / TAU;
        let Some((reach, series)) = harmonics(self.runs.len(), &curve, frequency) else {
            let what = format!("no whole cycle of a sine of {frequency:.3} Hz; the run is left out");
            self.notices.push(format!("{}: {what}", run.name));
            return Ok(());
        };
        self.series.extend(series);
        self.runs.push(Run {
            name: run.name.clone(),
            role: run.role,
            level: reach,
            stimulus: Stimulus::Sine {
                on,
                axis: Axis::Z,
                frequency,
            },
        });
        Ok(())
    }
}

/// Amplitude of the travel (m), and a series for each harmonic, from as many whole cycles as the record ends with.
/// `None` if they cannot be fitted.
fn harmonics(run: usize, curve: &DynamicCurve, frequency: f64) -> Option<(f64, Vec<Series>)> {
    let end = *curve.time.last()?;
    let cycles = ((end - curve.time[0]) * frequency).floor();
    let first = curve
        .time
        .iter()
        .position(|t| cycles >= 1.0 && *t >= end - cycles / frequency)?;
    let time = &curve.time[first..];
    let travel = fitted(time, &curve.displacement[first..], frequency, 1)?;
    let force = fitted(time, &curve.force[first..], frequency, FITTED)?;
    let reach = travel.harmonic[0].norm();
    if travel.remainder.powi(2) > OTHER * reach * reach / 2.0 {
        return None;
    }
    let most = curve.force[first..].iter().fold(0.0, |most: f64, f| most.max(f.abs()));
    let noise = 2.0 * force.remainder / (time.len() as f64).sqrt();
    let rotation = travel.harmonic[0].conj() / reach;
    let series = |order: usize| Series {
        run,
        sensor: sensor(Axis::Z),
        kind: Kind::Cycle(order),
        at: vec![frequency],
        value: vec![force.harmonic[order - 1] * rotation.powi(order as i32) / reach],
        sigma: vec![noise.hypot(FLOOR * most) / reach],
        noise: vec![noise.hypot(LEAST_NOISE * most) / reach],
        least_discrepancy: FLOOR,
    };
    Some((reach, (1..=ORDERS).map(series).collect()))
}

/// Harmonics of a periodic signal.
struct Periodic {
    /// Complex amplitudes of the harmonics, from the first on.
    harmonic: Vec<Complex<f64>>,
    /// RMS of the remaining signal.
    remainder: f64,
}

/// Least-squares fit of a mean and `orders` harmonics; `None` if the normal matrix is singular.
fn fitted(time: &[f64], signal: &[f64], frequency: f64, orders: usize) -> Option<Periodic> {
    let entry = |sample: usize, column: usize| {
        let angle = TAU * frequency * time[sample] * column.div_ceil(2) as f64;
        if column.is_multiple_of(2) {
            angle.cos()
        } else {
            -angle.sin()
        }
    };
    let columns = DMatrix::from_fn(time.len(), 1 + 2 * orders, entry);
    let signal = DVector::from_column_slice(signal);
    let parts = (columns.transpose() * &columns)
        .cholesky()?
        .solve(&(columns.transpose() * &signal));
    let harmonic = (1..=orders).map(|order| Complex::new(parts[2 * order], parts[2 * order - 1]));
    Some(Periodic {
        harmonic: harmonic.collect(),
        remainder: (signal - columns * &parts).norm() / (time.len() as f64).sqrt(),
    })
}
