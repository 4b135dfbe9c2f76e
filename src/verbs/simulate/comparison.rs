//! Simulated and measured records of every common mass and axis.

use std::collections::BTreeMap;

use qcar_runtime::campaign::{Axis, Channel, Quantity, Role, RoleNames};
use qcar_runtime::compare::{Alignment, CompareError, Errors, Summary, Windows};
use qcar_runtime::discover::observe::nearest_place;
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::model::{self, About, SignalKind, StateKind};
use qcar_runtime::roles::Roles;
use qcar_runtime::simulate::{Cleat, Ride};
use qcar_runtime::transmissibility::Point;
use serde::Serialize;

/// All runs and their errors.
#[derive(Debug, Serialize)]
pub struct Compared {
    /// One entry for each run, mass and axis.
    pub runs: Vec<Difference>,
    /// Errors over all runs, by `mass_axis`.
    pub summary: BTreeMap<String, Sizes>,
    /// Measured signals that are not compared, as sentences.
    pub notices: Vec<String>,
}

/// A mass along an axis in a run.
#[derive(Debug, Serialize)]
pub struct Difference {
    /// File of the run.
    pub run: String,
    /// Role: `fit` or `held_out`.
    pub role: &'static str,
    /// The mass.
    pub mass: String,
    /// Direction of the model.
    pub axis: String,
    /// Largest measured acceleration during the impact, m/s².
    pub measured_peak: f64,
    /// Largest simulated acceleration, m/s².
    pub simulated_peak: f64,
    /// Relative error of the peak.
    pub peak_error: f64,
    /// RMS of the measured acceleration during the after-shake, m/s².
    pub measured_after_shake: f64,
    /// RMS of the simulated acceleration, m/s².
    pub simulated_after_shake: f64,
    /// Relative error of the after-shake.
    pub after_shake_error: f64,
}

/// Median and largest absolute value of the relative errors.
#[derive(Debug, Serialize)]
pub struct Sizes {
    /// Errors of the peaks.
    pub peak: Option<Summary>,
    /// Errors of the after-shakes.
    pub after_shake: Option<Summary>,
}

pub(super) fn compare(
    about: &About,
    named: &RoleNames,
    cleats: &[Cleat],
    rides: &[Ride],
) -> Result<Compared, InputError> {
    let mut runs = Vec::new();
    for (cleat, ride) in cleats.iter().zip(rides) {
        let of_run = differences(about, named, cleat, ride).map_err(|error| incomparable(cleat, &error))?;
        if of_run.is_empty() {
            return Err(nothing_in_common(about, cleat).into());
        }
        runs.extend(of_run);
    }
    let mut notices: Vec<String> = cleats.iter().flat_map(|cleat| not_simulated(about, cleat)).collect();
    notices.sort_unstable();
    notices.dedup();
    Ok(Compared {
        summary: summary(&runs),
        runs,
        notices,
    })
}

/// The output of a model that a sensor measures.
fn output(about: &About, sensor: &Channel) -> Option<usize> {
    let kind = SignalKind::Motion(model::Quantity::Acceleration);
    let is = |signal: &model::Signal| {
        signal.location == *sensor.location && signal.axis == *sensor.axis.name() && signal.kind == kind
    };
    about.outputs.iter().position(|output| is(&output.signal))
}

/// The sensors of acceleration of a run.
fn accelerometers(cleat: &Cleat) -> impl Iterator<Item = &(Channel, Vec<f64>)> {
    let signals = cleat.measured.signals.iter();
    signals.filter(|(sensor, _)| sensor.quantity == Quantity::Acceleration)
}

fn not_simulated(about: &About, cleat: &Cleat) -> Vec<String> {
    let unknown = accelerometers(cleat).filter(|(sensor, _)| output(about, sensor).is_none());
    let say = |(sensor, _): &(Channel, Vec<f64>)| {
        let (mass, axis, model) = (&sensor.location, sensor.axis.name(), &about.name);
        let left_out = format!("`{mass}` along {axis} is measured but not compared, because");
        if moves(about, mass, axis) {
            let output = format!("add `output {mass}.acceleration;` to its direction {axis}");
            return format!("{left_out} its acceleration is not an output of model `{model}`; {output}");
        }
        let remedy = match nearest_place(about, &Point::new(mass, sensor.axis.clone(), sensor.quantity)) {
            Some(nearest) => format!("did you mean `{nearest}`?"),
            None => "name the location as the model does".into(),
        };
        format!("{left_out} model `{model}` has no `{mass}` along {axis}; {remedy}")
    };
    unknown.map(say).collect()
}

/// True for a mass, node or further point of a model.
fn moves(about: &About, place: &str, axis: &str) -> bool {
    let states = about.states.iter().filter(|state| state.kind != StateKind::Inner);
    let outputs = about
        .outputs
        .iter()
        .map(|output| (&output.signal.location, &output.signal.axis));
    let mut all = states.map(|state| (&state.location, &state.axis)).chain(outputs);
    all.any(|(location, own)| *location == *place && *own == *axis)
}

fn nothing_in_common(about: &About, cleat: &Cleat) -> Problem {
    let measured: Vec<String> = accelerometers(cleat)
        .map(|(sensor, _)| format!("`{}` along {}", sensor.location, sensor.axis.name()))
        .collect();
    let outputs: Vec<String> = about
        .outputs
        .iter()
        .map(|output| format!("`{}`", output.name))
        .collect();
    let list = |names: Vec<String>| {
        if names.is_empty() {
            "none".into()
        } else {
            names.join(", ")
        }
    };
    Problem::new(
        &cleat.measured.file,
        Place::File,
        format!("no acceleration that the model gives (measured: {})", list(measured)),
        format!(
            "at least one of the outputs of model `{}`: {}",
            about.name,
            list(outputs)
        ),
        "name the channel's location as the model does, or add an `output` to the model",
    )
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

fn differences(about: &About, named: &RoleNames, cleat: &Cleat, ride: &Ride) -> Result<Vec<Difference>, CompareError> {
    let pairs = pairs(about, cleat, ride);
    let Some(alignment) = alignment(about, named, &pairs)? else {
        return Ok(Vec::new());
    };
    let difference = |pair: &Pair| {
        let rate = cleat.measured.sample_rate;
        let errors = Errors::between(pair.measured, pair.simulated, &alignment, rate, &Windows::default())?;
        Ok(Difference {
            run: cleat.run.name.clone(),
            role: if cleat.run.role == Role::Fit { "fit" } else { "held_out" },
            mass: pair.mass.into(),
            axis: pair.axis.name().into(),
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

/// Time shift between the two records of a run, from the peaks (thesis section 3.6.2) of the wheel or, if it was not
/// measured and simulated, of the mass nearest to the tyre. `None` without any mass on the axis of the tyre.
///
/// # Errors
/// Fails if a mass has no impact.
pub(crate) fn alignment(about: &About, named: &RoleNames, pairs: &[Pair]) -> Result<Option<Alignment>, CompareError> {
    let roles = Roles::of(about, named).ok();
    let first = roles.and_then(|roles| {
        let is = |pair: &&Pair, mass: &str| pair.mass == mass && pair.axis.name() == roles.axis;
        let mut feeling = roles.feeling();
        feeling.find_map(|mass| pairs.iter().find(|pair| is(pair, mass)))
    });
    first
        .map(|wheel| Alignment::at_peak(wheel.measured, wheel.simulated))
        .transpose()
}

/// An acceleration that was measured and simulated.
pub(crate) struct Pair<'a> {
    /// Location.
    pub mass: &'a str,
    /// Axis.
    pub axis: Axis,
    /// Measured, m/s².
    pub measured: &'a [f64],
    /// Simulated, m/s².
    pub simulated: &'a [f64],
}

/// All accelerations of a run that were measured and simulated.
pub(crate) fn pairs<'a>(about: &About, cleat: &'a Cleat, ride: &'a Ride) -> Vec<Pair<'a>> {
    let both = accelerometers(cleat).filter_map(|(sensor, measured)| {
        Some(Pair {
            mass: &sensor.location,
            axis: sensor.axis.clone(),
            measured,
            simulated: &ride.outputs[output(about, sensor)?],
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
