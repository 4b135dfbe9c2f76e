//! Simulated records beside measured ones: every mass and axis that both have.

use std::collections::BTreeMap;

use qcar_runtime::campaign::{Axis, Quantity, Role};
use qcar_runtime::compare::{Alignment, CompareError, Errors, Summary, Windows};
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::model::{self, About, SignalKind};
use qcar_runtime::simulate::{Cleat, Ride};
use serde::Serialize;

/// What the wheel is called whose peak aligns the records (thesis section 3.6.2).
const ALIGNING: (&str, Axis) = ("wheel", Axis::Z);

/// All runs, and the size of their errors.
#[derive(Debug, Serialize)]
pub struct Compared {
    /// One for each run, mass and axis.
    pub runs: Vec<Difference>,
    /// Over all runs, by `mass_axis`.
    pub summary: BTreeMap<String, Sizes>,
}

/// A mass along an axis in a run.
#[derive(Debug, Serialize)]
pub struct Difference {
    /// The file of the run.
    pub run: String,
    /// `fit` or `held_out`.
    pub role: &'static str,
    /// The mass.
    pub mass: String,
    /// `z` or `x`.
    pub axis: &'static str,
    /// Largest acceleration in the impact, m/s².
    pub measured_peak: f64,
    /// The same of the simulation.
    pub simulated_peak: f64,
    /// Relative.
    pub peak_error: f64,
    /// Root mean square of the acceleration in the after-shake, m/s².
    pub measured_after_shake: f64,
    /// The same of the simulation.
    pub simulated_after_shake: f64,
    /// Relative.
    pub after_shake_error: f64,
}

/// Median and worst of the relative errors, whatever their sign.
#[derive(Debug, Serialize)]
pub struct Sizes {
    /// Of the peaks.
    pub peak: Option<Summary>,
    /// Of the after-shakes.
    pub after_shake: Option<Summary>,
}

pub(super) fn compare(about: &About, cleats: &[Cleat], rides: &[Ride]) -> Result<Compared, InputError> {
    let mut runs = Vec::new();
    for (cleat, ride) in cleats.iter().zip(rides) {
        let of_run = differences(about, cleat, ride).map_err(|error| incomparable(cleat, &error))?;
        runs.extend(of_run);
    }
    Ok(Compared {
        summary: summary(&runs),
        runs,
    })
}

fn incomparable(cleat: &Cleat, error: &CompareError) -> Problem {
    let remedy = "record the whole passage of the obstacle";
    Problem::new(
        &cleat.measured.file,
        Place::File,
        error.to_string(),
        "a run over an obstacle",
        remedy,
    )
}

fn differences(about: &About, cleat: &Cleat, ride: &Ride) -> Result<Vec<Difference>, CompareError> {
    let pairs = pairs(about, cleat, ride);
    let Some(alignment) = alignment(&pairs)? else {
        return Ok(Vec::new());
    };
    let difference = |pair: &Pair| {
        let rate = cleat.measured.sample_rate;
        let errors = Errors::between(pair.measured, pair.simulated, &alignment, rate, &Windows::default())?;
        Ok(Difference {
            run: cleat.run.file.clone(),
            role: if cleat.run.role == Role::Fit { "fit" } else { "held_out" },
            mass: pair.mass.into(),
            axis: pair.axis.name(),
            measured_peak: errors.peaks[0],
            simulated_peak: errors.peaks[1],
            peak_error: errors.peak(),
            measured_after_shake: errors.after_shakes[0],
            simulated_after_shake: errors.after_shakes[1],
            after_shake_error: errors.after_shake(),
        })
    };
    pairs.iter().map(difference).collect()
}

/// How the two records of a run lie to each other; `None` where no wheel was measured and simulated.
///
/// # Errors
/// A wheel that does not feel an obstacle.
pub(crate) fn alignment(pairs: &[Pair]) -> Result<Option<Alignment>, CompareError> {
    let wheel = pairs.iter().find(|pair| (pair.mass, pair.axis) == ALIGNING);
    wheel
        .map(|wheel| Alignment::at_peak(wheel.measured, wheel.simulated))
        .transpose()
}

/// An acceleration that was measured and simulated.
pub(crate) struct Pair<'a> {
    /// Where.
    pub mass: &'a str,
    /// Along which axis.
    pub axis: Axis,
    /// m/s².
    pub measured: &'a [f64],
    /// m/s².
    pub simulated: &'a [f64],
}

/// All accelerations of a run that were measured and simulated.
pub(crate) fn pairs<'a>(about: &About, cleat: &'a Cleat, ride: &'a Ride) -> Vec<Pair<'a>> {
    let accelerations = cleat
        .measured
        .signals
        .iter()
        .filter(|(sensor, _)| sensor.quantity == Quantity::Acceleration);
    let simulated = |location: &str, axis: Axis| {
        let kind = SignalKind::Motion(model::Quantity::Acceleration);
        let is =
            |signal: &model::Signal| signal.location == *location && signal.axis == *axis.name() && signal.kind == kind;
        about
            .outputs
            .iter()
            .position(|output| is(&output.signal))
            .map(|at| ride.outputs[at].as_slice())
    };
    let both = accelerations.filter_map(|(sensor, measured)| {
        Some(Pair {
            mass: &sensor.location,
            axis: sensor.axis,
            measured,
            simulated: simulated(&sensor.location, sensor.axis)?,
        })
    });
    both.collect()
}

fn summary(of: &[Difference]) -> BTreeMap<String, Sizes> {
    let mut groups: BTreeMap<String, Vec<&Difference>> = BTreeMap::new();
    for difference in of {
        groups
            .entry(format!("{}_{}", difference.mass, difference.axis))
            .or_default()
            .push(difference);
    }
    let sizes = |group: Vec<&Difference>| Sizes {
        peak: Summary::of(&group.iter().map(|d| d.peak_error).collect::<Vec<_>>()),
        after_shake: Summary::of(&group.iter().map(|d| d.after_shake_error).collect::<Vec<_>>()),
    };
    groups.into_iter().map(|(name, group)| (name, sizes(group))).collect()
}
