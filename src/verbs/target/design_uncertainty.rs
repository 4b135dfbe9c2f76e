//! Uncertainty of the results of a design, and the share of draws in which it meets its targets.

use qcar_runtime::metric::Ground;
use qcar_runtime::sensitivity::{Interval, Source, direction};
use qcar_runtime::target::{Axle, Designs, Found, Task, is_met, search};
use serde::Serialize;

use super::plan::Plan;
use crate::json::Ordered;
use crate::progress::while_counting;
use crate::verbs::sensitivity::subject::Subject;

/// Number of draws for the probability of targets.
const DRAWS: usize = 200;
/// Design and margins are computed alternately: the largest number of rounds, and the relative change of the margins
/// that ends them.
const TURNS: usize = 4;
const SETTLED: f64 = 0.02;

/// Uncertainty of the parameters, and of the results of the design.
#[derive(Serialize)]
pub(super) struct DesignUncertainty {
    /// Required probability of each target, if the file states one.
    pub wanted: Option<f64>,
    /// Share of draws in which all targets that must hold are met.
    pub all: f64,
    pub draws: usize,
    /// Uncertain parameters by source.
    pub parameters: Ordered<Vec<String>>,
    /// For each limit, the share of draws in which it is met.
    #[serde(skip)]
    pub each: Vec<f64>,
}

/// The uncertainty of the results of a design; `None` if all parameters are certain.
pub(super) fn intervals(
    subject: &Subject,
    (ground, axle): (&Ground<'_>, &Axle<'_>),
    plan: &Plan,
    design: &[f64],
) -> Option<Vec<Interval>> {
    let places = plan.sources.places(subject);
    let uncertainty = plan.sources.uncertainty(subject, &places)?;
    let values = axle.values_of(design);
    let directions: Vec<Vec<f64>> = places.iter().map(|&place| direction(&values, place)).collect();
    let found = ground.measure_with(&values, &directions).ok()?;
    Some(found.slopes.iter().map(|slopes| uncertainty.of(slopes)).collect())
}

/// The design of least cost at which each target holds with a required probability. The margins of the limits follow
/// from draws about the last design, repeatedly (after Du and Chen, J. Mech. Des. 126, 2004, who compute them to first
/// order).
pub(super) fn design(task: &mut Task<'_>, axle: &Axle<'_>, seed: u64, probability: Option<f64>) -> Option<Found> {
    let searched = |task: &Task<'_>| {
        while_counting("searching the design of lowest cost: step".into(), |on_progress| {
            search(task, seed, on_progress)
        })
    };
    let mut found = searched(task)?;
    let Some(probability) = probability else {
        return Some(found);
    };
    for _ in 0..TURNS {
        if !keep_away(task, axle, &found, probability) {
            break;
        }
        found = searched(task)?;
    }
    Some(found)
}

/// Sets the margin of each limit so that it holds with the required probability about a design. Returns false if the
/// margins hardly change.
pub(super) fn keep_away(task: &mut Task<'_>, axle: &Axle<'_>, about: &Found, probability: f64) -> bool {
    if axle.is_certain() {
        return false;
    }
    let drawn = draws(axle, &about.design, 0);
    let last = ((probability * DRAWS as f64).ceil() as usize).min(DRAWS) - 1;
    let mut changes = false;
    for limit in task.limits.iter_mut().filter(|limit| limit.wish.is_none()) {
        let worse = |own: &Option<Vec<f64>>| match own {
            Some(own) => limit.sign() * (own[limit.result] - about.values[limit.result]),
            None => f64::INFINITY,
        };
        let mut worse: Vec<f64> = drawn.iter().map(worse).collect();
        worse.sort_by(f64::total_cmp);
        let margin = worse[last].max(0.0);
        changes |= (margin - limit.margin).abs() > SETTLED * margin;
        limit.margin = margin;
    }
    changes
}

/// Random results of a design, from the draw with this number on.
fn draws(axle: &Axle<'_>, design: &[f64], first: u64) -> Vec<Option<Vec<f64>>> {
    let numbers = first..first + DRAWS as u64;
    let draws: Vec<(Vec<f64>, u64)> = numbers.map(|number| (design.to_vec(), number)).collect();
    axle.drawn_of_all(&draws)
}

/// Share of draws in which targets hold at a design.
pub(super) fn sureness(
    subject: &Subject,
    plan: &Plan,
    task: &Task<'_>,
    axle: &Axle<'_>,
    design: &[f64],
) -> Option<DesignUncertainty> {
    if axle.is_certain() {
        return None;
    }
    let real = task.without_margins();
    let excess = |values: Option<Vec<f64>>| Some(real.excesses(design, &values?));
    // Draws other than those for the margins.
    let drawn: Vec<_> = draws(axle, design, DRAWS as u64).into_iter().map(excess).collect();
    let share = |holds: &dyn Fn(&Vec<f64>) -> bool| {
        drawn.iter().filter(|own| own.as_ref().is_some_and(holds)).count() as f64 / DRAWS as f64
    };
    Some(DesignUncertainty {
        wanted: plan.sure,
        all: share(&|excess| real.holds(excess)),
        draws: DRAWS,
        parameters: sources(subject, plan),
        each: (0..plan.wanted.len())
            .map(|at| share(&|excess| is_met(excess[at])))
            .collect(),
    })
}

fn sources(subject: &Subject, plan: &Plan) -> Ordered<Vec<String>> {
    let sources = &plan.sources;
    let name = |place: usize| subject.model.about().parameters[place].name.to_string();
    let fitted = sources.fitted(subject).into_iter().map(name).collect();
    let tolerances = sources.tolerances.keys().map(|&place| name(place)).collect();
    let per_kelvin = sources.per_kelvin.keys().map(|&place| name(place)).collect();
    let lists: [Vec<String>; 3] = [fitted, tolerances, per_kelvin];
    Source::ALL
        .iter()
        .map(|source| source.name().to_string())
        .zip(lists)
        .collect()
}
