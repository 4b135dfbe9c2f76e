//! Cleat runs of both sides and the measurements: peaks, after-shakes and traces.

use qcar_runtime::campaign::{Campaign, Quantity, Role};
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::model::{self, SignalKind};
use qcar_runtime::roles::Roles;
use qcar_runtime::simulate::{Cleat, Drive, Ride, Standard, Variant, tyre_of};

use super::records::{Compared, Key, Record, compared};
use super::sides::Side;
use crate::verbs::simulate::simulate_rides;

/// A cleat run of both sides.
pub(super) struct CleatRun {
    /// File of the run, or description of the ride.
    pub name: String,
    /// Speed, m/s.
    pub speed: f64,
    /// Height of the cleat, m.
    pub height: f64,
    /// Role of a run of a campaign: `fit` or `held_out`.
    pub role: Option<&'static str>,
    /// Peaks, after-shakes and traces.
    pub compared: Compared,
}

/// A cleat run before its simulation.
enum Run {
    Standard(Standard),
    /// Measured run of the campaign or of A, and of B if it is a campaign.
    Measured(Box<Cleat>, Option<Box<Cleat>>),
}

impl Run {
    fn drive(&self) -> Drive<'_> {
        match self {
            Run::Standard(own) => own.drive(),
            Run::Measured(own, _) => own.drive(),
        }
    }

    fn height(&self) -> f64 {
        match self {
            Run::Standard(own) => own.height,
            Run::Measured(own, _) => height(own),
        }
    }

    fn name(&self) -> String {
        match self {
            Run::Standard(own) => format!("{:.0} km/h over {:.0} mm", 3.6 * own.speed, 1e3 * own.height),
            Run::Measured(own, _) => own.run.name.clone(),
        }
    }

    fn measured(&self) -> Vec<&Cleat> {
        match self {
            Run::Standard(_) => Vec::new(),
            Run::Measured(own, other) => std::iter::once(&**own).chain(other.as_deref()).collect(),
        }
    }
}

/// The twelve runs of the thesis.
///
/// # Errors
/// Fails as [`driven`] does.
pub(super) fn standard(sides: &[Side; 2], roles: &[Roles; 2]) -> Result<Vec<CleatRun>, InputError> {
    let runs = Standard::all().expect("the standard cleats are roads");
    driven(sides, roles, runs.into_iter().map(Run::Standard).collect())
}

/// The runs of a campaign.
///
/// # Errors
/// Fails if a run or road cannot be read, and as [`driven`] does.
pub(super) fn of_campaign(
    sides: &[Side; 2],
    roles: &[Roles; 2],
    campaign: &Campaign,
) -> Result<Vec<CleatRun>, InputError> {
    let runs = cleats(campaign)?
        .into_iter()
        .map(|own| Run::Measured(Box::new(own), None));
    driven(sides, roles, runs.collect())
}

/// The common runs of two campaigns: equal speed and height of the cleat.
///
/// # Errors
/// Fails if a run or road cannot be read, and as [`driven`] does.
pub(super) fn of_campaigns(
    sides: &[Side; 2],
    roles: &[Roles; 2],
    [a, b]: [&Campaign; 2],
) -> Result<Vec<CleatRun>, InputError> {
    let mut others = cleats(b)?;
    let mut runs = Vec::new();
    for own in cleats(a)? {
        if let Some(place) = others.iter().position(|other| alike(&own, other)) {
            runs.push(Run::Measured(Box::new(own), Some(Box::new(others.remove(place)))));
        }
    }
    driven(sides, roles, runs)
}

fn cleats(campaign: &Campaign) -> Result<Vec<Cleat>, InputError> {
    let all = campaign.runs.iter().map(|run| Cleat::read(campaign, run));
    Ok(all.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

fn alike(a: &Cleat, b: &Cleat) -> bool {
    let near = |a: f64, b: f64, share: f64| (a - b).abs() <= share * a.abs().max(b.abs());
    near(a.speed, b.speed, 0.02) && near(height(a), height(b), 0.02) && a.measured.sample_rate == b.measured.sample_rate
}

fn height(of: &Cleat) -> f64 {
    let heights = of.road.vertices().iter().map(|point| point[1]);
    heights.fold(f64::NEG_INFINITY, f64::max) - of.road.vertices()[0][1]
}

/// Simulates and compares both sides.
///
/// # Errors
/// Fails if the vehicle has no tyre, or if a ride cannot be simulated or compared.
fn driven(sides: &[Side; 2], roles: &[Roles; 2], runs: Vec<Run>) -> Result<Vec<CleatRun>, InputError> {
    let [a, b] = [rides_of(&sides[0], &runs)?, rides_of(&sides[1], &runs)?];
    let cleat_runs = runs.iter().zip(a.iter().zip(&b));
    let feeling = feeling(roles);
    cleat_runs
        .map(|(run, rides)| cleat_run(sides, &feeling, run, rides))
        .collect()
}

fn rides_of(side: &Side, runs: &[Run]) -> Result<Vec<Ride>, InputError> {
    let tyre = tyre_of(&|name| side.vehicle.facts.get(name).copied(), &side.vehicle.file)?;
    let drives: Vec<Drive> = runs.iter().map(Run::drive).collect();
    let what = format!("{}: ride", side.name);
    let all = simulate_rides(what, &*side.model, &side.values, tyre, &drives, Variant::Complete);
    let checked = runs
        .iter()
        .zip(all)
        .map(|(run, ride)| ride.map_err(|error| refused(run, &error.to_string())));
    checked.collect()
}

fn refused(run: &Run, error: &str) -> InputError {
    Problem::refused(
        run.name(),
        Place::File,
        "this run cannot be simulated for both sides",
        error,
    )
    .into()
}

fn cleat_run(sides: &[Side; 2], feeling: &[Key], run: &Run, (a, b): (&Ride, &Ride)) -> Result<CleatRun, InputError> {
    let simulated = [simulated(&sides[0], a), simulated(&sides[1], b)];
    let cleats = run.measured();
    let measured: Vec<Record> = cleats.iter().map(|cleat| recorded(cleat)).collect();
    let rate = run.drive().sample_rate;
    let compared = compared(&simulated, &measured, feeling, rate).map_err(|error| refused(run, &error.to_string()))?;
    let role = |cleat: &&Cleat| if cleat.run.role == Role::Fit { "fit" } else { "held_out" };
    Ok(CleatRun {
        name: run.name(),
        speed: run.drive().speed,
        height: run.height(),
        role: cleats.first().map(role),
        compared,
    })
}

/// The masses of both sides, the wheel first.
fn feeling(roles: &[Roles; 2]) -> Vec<Key> {
    let keys = |roles: &Roles| -> Vec<Key> {
        let masses = roles.feeling();
        masses.map(|mass| (mass.to_string(), roles.axis.clone())).collect()
    };
    roles.iter().flat_map(keys).collect()
}

/// Accelerations of a ride.
fn simulated<'a>(side: &'a Side, ride: &'a Ride) -> Record<'a> {
    let outputs = side.model.about().outputs.iter().zip(&ride.outputs);
    let accelerations =
        outputs.filter(|(output, _)| output.signal.kind == SignalKind::Motion(model::Quantity::Acceleration));
    let keyed = accelerations.map(|(output, values)| {
        let key: Key = (output.signal.location.to_string(), output.signal.axis.to_string());
        (key, values.as_slice())
    });
    keyed.collect()
}

/// Accelerations of a measured run.
fn recorded(cleat: &Cleat) -> Record<'_> {
    let accelerations = cleat
        .measured
        .signals
        .iter()
        .filter(|(sensor, _)| sensor.quantity == Quantity::Acceleration);
    let keyed = accelerations.map(|(sensor, values)| {
        let key: Key = (sensor.location.clone(), sensor.axis.name().to_string());
        (key, values.as_slice())
    });
    keyed.collect()
}
