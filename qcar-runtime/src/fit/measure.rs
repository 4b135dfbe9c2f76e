//! Observations of a fit from the runs of a campaign.

use super::channels::{Channels, across_links, is_excitation};
use super::observation::{Difference, Level, Observation, Pair};
use crate::campaign::{Campaign, Channel as Sensor, History, Run, Side, Test};
use crate::error::{InputError, Place, Problem};
use crate::model::{About, Channel, Signal};
use crate::progress::{self, OnProgress};
use crate::transmissibility::{Options, Point, Related, Transmissibility, check_sweep, points};
use nalgebra::Complex;

/// Measures the channels of every sweep and time history of a campaign that excites the model.
///
/// `wanted` names the channels to fit, as `near_to_far` of two measured places; without it, they are the channels
/// across the force elements of the model (see [`across_links`]). Beside other runs, a time history without any
/// excitation is left out: it is a free decay. `on_progress` receives the progress after each run.
///
/// # Errors
/// Fails if [`Campaign::history`] or the estimator of transmissibilities fails, if a sweep, or each time history,
/// records no excitation of the model, or if a wanted channel was not measured.
pub fn levels(
    campaign: &Campaign,
    about: &About,
    wanted: Option<&[String]>,
    options: &Options,
    on_progress: OnProgress<'_>,
) -> Result<Vec<Level>, InputError> {
    let runs: Vec<&Run> = campaign
        .runs
        .iter()
        .filter(|run| matches!(run.test, Test::Sweep(_) | Test::TimeHistory(_)))
        .collect();
    let measured = progress::map(&runs, on_progress, |run| level(campaign, run, about, wanted, options));
    let (mut levels, mut problems, mut free) = (Vec::new(), Vec::new(), Vec::new());
    for result in measured {
        match result {
            Ok(Measured::Level(level)) => levels.push(level),
            Ok(Measured::FreeDecay(error)) => free.extend(error.problems),
            // What is wrong with the request is wrong in every run.
            Err(error) => problems.extend(
                error
                    .problems
                    .into_iter()
                    .filter(|new| !problems.contains(new))
                    .collect::<Vec<_>>(),
            ),
        }
    }
    if levels.is_empty() {
        problems.extend(free);
    }
    InputError::unless_empty(problems, Some(levels))
}

/// Checks that the excitation of every sweep is the one that the campaign states, as [`levels`] does before it estimates
/// responses.
///
/// # Errors
/// Fails as [`check_sweep`] does, or if a sweep cannot be read or records no excitation of the model.
pub fn check_sweeps(campaign: &Campaign, about: &About) -> Result<(), InputError> {
    let sweeps = campaign.runs.iter().filter(|run| matches!(run.test, Test::Sweep(_)));
    let check = |run: &Run| {
        let history = campaign.history(run)?;
        let (_, reference) = excitation(&history, about, &points(&history))?;
        check_sweep(&history, &reference)
    };
    let refused = sweeps.filter_map(|run| check(run).err());
    InputError::unless_empty(refused.flat_map(|error| error.problems).collect(), Some(()))
}

/// What a run gives.
enum Measured {
    Level(Level),
    /// Nothing, for this reason.
    FreeDecay(InputError),
}

fn level(
    campaign: &Campaign,
    run: &Run,
    about: &About,
    wanted: Option<&[String]>,
    options: &Options,
) -> Result<Measured, InputError> {
    let history = campaign.history(run)?;
    let measured = points(&history);
    one_road_moves(&history, about)?;
    let (excitation, reference) = match excitation(&history, about, &measured) {
        Ok(found) => found,
        Err(error) if matches!(run.test, Test::TimeHistory(_)) => return Ok(Measured::FreeDecay(error)),
        Err(error) => return Err(error),
    };
    let along: Vec<Point> = measured
        .into_iter()
        .filter(|point| point.axis == reference.axis)
        .collect();
    let signals: Vec<Signal> = along.iter().map(|point| signal(about, point)).collect();
    let channels = match wanted {
        None => across_links(about, &about.excitations[excitation], &signals),
        Some(wanted) => named(campaign, about, excitation, &signals, wanted)?,
    };
    let all: Vec<(&Channel, bool)> = channels
        .fitted
        .iter()
        .map(|channel| (channel, true))
        .chain(channels.compared.iter().map(|channel| (channel, false)))
        .collect();
    let place = |signal: &Signal| along[signals.iter().position(|s| s == signal).expect("taken from there")].clone();
    let pairs: Vec<_> = all
        .iter()
        .map(|(channel, _)| (place(&channel.denominator), place(&channel.numerator)))
        .collect();
    let ends: Vec<&Point> = pairs.iter().flat_map(|(from, to)| [from, to]).collect();
    let doubled = PAIRS.map(|(_, sides)| doubled(&history, &reference, &ends, sides));
    let of_sides = PAIRS.iter().zip(&doubled);
    let of_sides: Vec<Point> = of_sides
        .flat_map(|((_, sides), points)| points.iter().flat_map(|point| sides.map(|side| point.on(side))))
        .collect();
    let related = Related::new(&history, &reference, ends.into_iter().chain(&of_sides), options)?;
    let ratios = pairs.iter().map(|pair| related.ratio(&history, pair));
    let differences: Vec<Vec<Difference>> = pairs.iter().map(|pair| differences(&related, &doubled, pair)).collect();
    sides_agree(&history, &reference, &pairs, &differences)?;
    let observations = all.iter().zip(ratios).zip(differences);
    let observations = observations
        .map(|(((channel, fitted), ratio), differences)| observation(&history, channel, *fitted, ratio, differences));
    Ok(Measured::Level(Level {
        name: run.name.clone(),
        role: run.role,
        excitation,
        observations: observations.collect(),
    }))
}

/// A road counts as moving if its mean square is at least this share of the largest: a tenth of its amplitude.
const MOVES: f64 = 0.01;

/// Checks that one road moves: a response is related to one road, as if the others were at rest.
///
/// # Errors
/// Fails if several roads move.
fn one_road_moves(history: &History, about: &About) -> Result<(), InputError> {
    let roads = about.excitations.iter().filter(|excitation| excitation.road);
    let recorded = roads.filter_map(|road| {
        let mut own = history.signals.iter();
        let (_, values) = own.find(|(sensor, _)| road.name == *sensor.location && road.axis == *sensor.axis.name())?;
        Some((&*road.name, values.iter().map(|value| value * value).sum()))
    });
    let recorded: Vec<(&str, f64)> = recorded.collect();
    let most = recorded.iter().fold(0.0, |most: f64, (_, size)| most.max(*size));
    let moving: Vec<String> = recorded
        .iter()
        .filter(|(_, size)| *size > MOVES * most)
        .map(|(name, _)| format!("`{name}`"))
        .collect();
    if moving.len() < 2 {
        return Ok(());
    }
    let found = format!("several moving roads: {}", moving.join(", "));
    let expected = format!("one moving road of model `{}` in a run", about.name);
    let remedy = "move one at a time, or use a model with one tyre";
    Err(Problem::new(&history.file, Place::File, found, expected, remedy).into())
}

/// The excitation of the model that a run records, and the point at which it was measured.
fn excitation(history: &History, about: &About, measured: &[Point]) -> Result<(usize, Point), InputError> {
    for (place, excitation) in about.excitations.iter().enumerate() {
        if let Some(point) = measured
            .iter()
            .find(|point| is_excitation(excitation, &signal(about, point)))
        {
            return Ok((place, point.clone()));
        }
    }
    let measured: Vec<String> = measured.iter().map(|point| format!("`{}`", point.location)).collect();
    let excitations: Vec<String> = about.excitations.iter().map(|e| format!("`{}`", e.name)).collect();
    let expected = format!(
        "a channel of {}, which excite model `{}`",
        excitations.join(" or "),
        about.name
    );
    let remedy = "record the excitation, or choose another model";
    Err(Problem::new(
        &history.file,
        Place::File,
        format!("channels of {}", measured.join(", ")),
        expected,
        remedy,
    )
    .into())
}

/// The channels with these names, and the channels from the excitation.
fn named(
    campaign: &Campaign,
    about: &About,
    excitation: usize,
    measured: &[Signal],
    wanted: &[String],
) -> Result<Channels, InputError> {
    let default = across_links(about, &about.excitations[excitation], measured);
    let (mut fitted, mut problems) = (Vec::new(), Vec::new());
    for name in wanted {
        let pair = measured
            .iter()
            .flat_map(|near| measured.iter().map(move |far| (near, far)));
        let mut same =
            pair.filter(|(near, far)| near != far && *name == format!("{}_to_{}", near.location, far.location));
        match same.next() {
            Some((near, far)) => fitted.push(Channel {
                name: name.clone().into(),
                numerator: far.clone(),
                denominator: near.clone(),
            }),
            None => problems.push(unknown_channel(campaign, name, measured)),
        }
    }
    let compared = default.fitted.into_iter().chain(default.compared);
    let compared = compared
        .filter(|channel| fitted.iter().all(|other| other.name != channel.name))
        .collect();
    InputError::unless_empty(problems, Some(Channels { fitted, compared }))
}

fn unknown_channel(campaign: &Campaign, name: &str, measured: &[Signal]) -> Problem {
    let places: Vec<String> = measured.iter().map(|signal| format!("`{}`", signal.location)).collect();
    let expected = format!("`near_to_far` of two measured places, which are {}", places.join(", "));
    let remedy = "correct the name of the channel";
    Problem::new(
        campaign.manifest(),
        Place::Name(name.to_owned()),
        "a channel that was not measured",
        expected,
        remedy,
    )
}

/// The signal of the model at a measured point.
fn signal(about: &About, point: &Point) -> Signal {
    Signal {
        location: point.location.clone().into(),
        axis: point.axis.name().to_owned().into(),
        kind: point.kind(about),
    }
}

fn observation(
    history: &History,
    channel: &Channel,
    fitted: bool,
    ratio: Transmissibility,
    differences: Vec<Difference>,
) -> Observation {
    let relative_variance = ratio
        .variance
        .iter()
        .zip(&ratio.value)
        .map(|(variance, value)| variance / value.norm_sqr());
    let band = match &history.test {
        Test::Sweep(sweep) => (sweep.start_frequency, sweep.end_frequency),
        _ => (ratio.frequency[0], ratio.frequency[ratio.frequency.len() - 1]),
    };
    let sensors = |point: &Point| history.signals.iter().filter(|(sensor, _)| point.has(sensor)).count();
    Observation {
        channel: channel.clone(),
        fitted,
        relative_variance: relative_variance.collect(),
        coherence: ratio.coherence,
        sensors: (sensors(&ratio.to), sensors(&ratio.from)),
        frequency: ratio.frequency,
        value: ratio.value,
        band,
        differences,
    }
}

/// The sides of an axle that should be alike.
const PAIRS: [(Pair, [Side; 2]); 2] = [
    (Pair::LeftRight, [Side::Left, Side::Right]),
    (Pair::FrontRear, [Side::Front, Side::Rear]),
];

/// The points with sensors on both sides. The reference stays the mean of its sensors, the virtual centre pad.
fn doubled<'a>(history: &History, reference: &Point, points: &[&'a Point], sides: [Side; 2]) -> Vec<&'a Point> {
    let is_doubled = |point: &Point| sides.iter().all(|&side| point.on(side).is_measured(history));
    let doubled = points.iter().copied();
    doubled
        .filter(|&point| point != reference && is_doubled(point))
        .collect()
}

/// Differences between the symmetric sensors of two points, for each of [`PAIRS`] that a run has `doubled`.
fn differences(related: &Related, doubled: &[Vec<&Point>], (from, to): &(Point, Point)) -> Vec<Difference> {
    // A point without a sensor on a side uses those of both.
    let response = |point: &Point, side: Side| {
        let own = related.response(&point.on(side));
        own.or_else(|| related.response(point)).expect("all were estimated")
    };
    let ratio = |side: Side| response(to, side).zip(response(from, side)).map(|(to, from)| to / from);
    let measured = PAIRS.iter().zip(doubled).filter(|(_, points)| !points.is_empty());
    let difference = |(&(pair, [first, second]), _): (&(Pair, [Side; 2]), _)| {
        let half = ratio(first)
            .zip(ratio(second))
            .map(|(a, b)| (a / b).ln() * Complex::from(0.5));
        let half = half.collect();
        Difference { pair, half }
    };
    measured.map(difference).collect()
}

/// Checks that the sensors of two sides agree: their mean has no meaning if units or signs differ.
fn sides_agree(
    history: &History,
    reference: &Point,
    pairs: &[(Point, Point)],
    differences: &[Vec<Difference>],
) -> Result<(), InputError> {
    /// A factor of two or 40 degrees at half of the lines: the sides of an axle differ by percents.
    const CONTRADICTION: f64 = std::f64::consts::LN_2;
    let typical = |difference: &Difference| {
        let mut sizes: Vec<f64> = difference.half.iter().map(|half| 2.0 * half.norm()).collect();
        sizes.sort_by(f64::total_cmp);
        sizes.get(sizes.len() / 2).copied().unwrap_or(0.0)
    };
    let contradict = |of: &Vec<Difference>| of.iter().any(|difference| typical(difference) > CONTRADICTION);
    let problem = |((from, to), of): (&(Point, Point), &Vec<Difference>)| {
        let has = |sensor: &Sensor| [from, to].iter().any(|&point| point != reference && point.has(sensor));
        let sensors = history.signals.iter().filter(|(sensor, _)| has(sensor));
        let names: Vec<String> = sensors.map(|(sensor, _)| format!("`{}`", sensor.name)).collect();
        let wrong = || {
            let found = "sensors of two sides that differ by more than a factor of two or 40 degrees";
            let remedy = format!(
                "correct unit, sign or calibration among {}, or leave one out",
                names.join(", ")
            );
            Problem::new(
                &history.file,
                Place::Name(format!("{} to {}", from.location, to.location)),
                found,
                "similar motion on both sides of an axle",
                remedy,
            )
        };
        contradict(of).then(wrong)
    };
    let problems = pairs.iter().zip(differences).filter_map(problem).collect();
    InputError::unless_empty(problems, Some(()))
}
