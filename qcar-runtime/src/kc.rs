//! Gradients of K&C curves (thesis section 3.4.4.1): start values of stiffness, damping and friction.
//!
//! A loop is the sum of a spring, a damper and a dry friction that changes sign with the direction of travel:
//! `F = F0 + k x + c v + f sign(v)`. All are found at once by least squares that give outliers less weight (Huber),
//! over the linear range: the middle half of the travel for a quasi-static cycle, which leaves out bump stops and the
//! elastic reversal of the friction; where the velocity is above a tenth of its peak for a sine.
//!
//! A gradient is that between wheel and body. If a sub-frame yields under the load, it is that of both springs in
//! series, and [`value_for`] determines one of them with a model.

mod regression;
// A model's own gradients on the K&C rig.
mod rig;

pub use regression::Estimate;
pub(crate) use rig::of_unit_force;
pub use rig::{Slope, gradient, parameter_for, value_for};

use crate::campaign::DynamicCurve;
use crate::shown::shown;

/// Gradients of a slow cycle.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Cycle {
    /// Gradient of force over displacement, N/m.
    pub stiffness: Estimate,
    /// Half the width of the loop, N: dry friction, and the damper force at the speed of the cycle. 8 mm/s and
    /// 2000 N s/m give 16 N.
    pub half_width: Estimate,
}

/// Gradients of vertical sines.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Sine {
    /// Gradient of force over displacement, N/m.
    pub stiffness: Estimate,
    /// Gradient of force over velocity, N s/m.
    pub damping: Estimate,
    /// Half the step of the force where the velocity changes sign, N.
    pub friction: Estimate,
}

/// Samples of a sine.
#[derive(Clone, Copy, Debug)]
pub struct SineSamples<'a> {
    /// Displacement, m.
    pub displacement: &'a [f64],
    /// Velocity, m/s.
    pub velocity: &'a [f64],
    /// Force, N.
    pub force: &'a [f64],
}

impl<'a> From<&'a DynamicCurve> for SineSamples<'a> {
    fn from(curve: &'a DynamicCurve) -> Self {
        SineSamples {
            displacement: &curve.displacement,
            velocity: &curve.velocity,
            force: &curve.force,
        }
    }
}

/// Reason why a curve has no gradients.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the message says it")]
pub enum KcError {
    #[error("columns of {first} and {second} values")]
    Lengths { first: usize, second: usize },
    #[error("{found} samples in the linear range of the curve")]
    TooFew { found: usize, expected: usize },
    #[error("travel in one direction only")]
    OneWay,
    #[error(
        "a force that does not increase with the displacement: slope {:.3e}, standard error {:.1e}",
        shown(*.slope, "N/m"),
        shown(*.error, "N/m")
    )]
    NoSlope { slope: f64, error: f64 },
}

impl KcError {
    /// Requirement for a curve with gradients.
    pub fn expected(&self) -> String {
        match self {
            KcError::Lengths { .. } => "columns of one length".to_string(),
            KcError::TooFew { expected, .. } => format!("at least {expected}, from a whole cycle"),
            KcError::OneWay => "travel in both directions".to_string(),
            KcError::NoSlope { .. } => {
                "displacement and force that increase together, both positive in compression or forwards".to_string()
            }
        }
    }
}

/// Middle share of the travel that counts as linear.
const LINEAR_SHARE: f64 = 0.5;
/// Share of the peak velocity below which the friction of a sine may be changing sign.
const SLOW_SHARE: f64 = 0.1;
/// Number of parts of a curve; the direction of travel is taken over one part before and one after a sample.
const DIRECTION_PARTS: usize = 100;
/// A slope with fewer standard errors is not significant.
const CLEAR: f64 = 3.0;

/// Stiffness and half width of the loop of a slow cycle: displacement in m, force in N, one value for each sample.
///
/// # Errors
/// Fails if the columns differ in length, if there are too few samples in the middle of the travel, if the travel has
/// one direction only, or if the force does not increase with the displacement.
pub fn cycle(displacement: &[f64], force: &[f64]) -> Result<Cycle, KcError> {
    same_length(displacement, force)?;
    let (low, high) = extent(displacement);
    let (middle, reach) = ((low + high) / 2.0, LINEAR_SHARE * (high - low) / 2.0);
    let rows: Vec<[f64; 4]> = (0..displacement.len())
        .filter(|&i| (displacement[i] - middle).abs() <= reach)
        .map(|i| [1.0, displacement[i] - middle, direction(displacement, i), force[i]])
        .collect();
    let [_, stiffness, half_width] = regression::huber(&rows)?;
    let (slope, error) = (stiffness.value, stiffness.standard_error);
    if slope <= CLEAR * error {
        return Err(KcError::NoSlope { slope, error });
    }
    Ok(Cycle { stiffness, half_width })
}

/// Stiffness, damping and friction of one or several sines of one suspension, each with its own mean force.
///
/// # Errors
/// Fails if the columns differ in length, if there are too few samples away from the reversals, or if the travel has
/// one direction only.
pub fn sines(runs: &[SineSamples<'_>]) -> Result<Sine, KcError> {
    let mut rows: Vec<[f64; 4]> = Vec::new();
    for run in runs {
        same_length(run.displacement, run.velocity)?;
        same_length(run.displacement, run.force)?;
        rows.extend(centred(&moving(run)));
    }
    let [stiffness, damping, friction] = regression::huber(&rows)?;
    Ok(Sine {
        stiffness,
        damping,
        friction,
    })
}

/// Displacement, velocity, direction and force while the wheel moves.
fn moving(run: &SineSamples<'_>) -> Vec<[f64; 4]> {
    let (low, high) = extent(run.velocity);
    let slow = SLOW_SHARE * high.max(-low);
    (0..run.velocity.len())
        .filter(|&i| run.velocity[i].abs() > slow)
        .map(|i| {
            [
                run.displacement[i],
                run.velocity[i],
                run.velocity[i].signum(),
                run.force[i],
            ]
        })
        .collect()
}

/// The rows minus their mean: the same least squares as with an unknown mean force.
fn centred(rows: &[[f64; 4]]) -> Vec<[f64; 4]> {
    let mean = |column: usize| rows.iter().map(|row| row[column]).sum::<f64>() / rows.len() as f64;
    let means = [mean(0), mean(1), mean(2), mean(3)];
    rows.iter()
        .map(|row| std::array::from_fn(|column| row[column] - means[column]))
        .collect()
}

/// 1 if the displacement increases around a sample, -1 if it decreases.
fn direction(displacement: &[f64], i: usize) -> f64 {
    let reach = (displacement.len() / DIRECTION_PARTS).max(1);
    let last = displacement.len() - 1;
    (displacement[(i + reach).min(last)] - displacement[i.saturating_sub(reach)]).signum()
}

fn extent(values: &[f64]) -> (f64, f64) {
    values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(*v), high.max(*v))
        })
}

fn same_length(first: &[f64], second: &[f64]) -> Result<(), KcError> {
    let (first, second) = (first.len(), second.len());
    if first == second {
        Ok(())
    } else {
        Err(KcError::Lengths { first, second })
    }
}
