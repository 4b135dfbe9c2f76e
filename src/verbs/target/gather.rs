//! The results of a task: a design, a front and a box.

use qcar_runtime::metric::Ground;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::sensitivity::{Chance, Interval};
use qcar_runtime::target::{
    Axle, Cut, Designs, Dot, Found, Front, FrontSettings, Sense, Space, SpaceSettings, Task, cut, front, is_met, space,
};
use serde::Serialize;

use super::design_uncertainty::{self, DesignUncertainty};
use super::plan::Plan;
use crate::json::Ordered;
use crate::progress::while_counting;
use crate::verbs::sensitivity::gather::{UncertainMetric, rounded, uncertain_metric};
use crate::verbs::sensitivity::subject::Subject;

/// The result.
#[derive(Serialize)]
pub(super) struct Answer {
    pub subject: String,
    pub model: String,
    /// True if the design meets all targets and couplings that must hold.
    pub met: bool,
    /// Cost of the design.
    pub cost: f64,
    /// Notices on the present values, as sentences.
    pub notices: Vec<String>,
    pub parameters: Vec<Parameter>,
    pub targets: Vec<Target>,
    /// Elasticities of each metric of the targets.
    pub sensitivity: Vec<Sensitivity>,
    /// For each target and parameter, percent of its value at the design per percent of the parameter. Empty without
    /// derivatives.
    #[serde(skip)]
    pub elasticities: Vec<Vec<f64>>,
    pub front: Option<FrontAnswer>,
    pub space: Option<SpaceAnswer>,
    pub uncertainty: Option<DesignUncertainty>,
}

/// A parameter that may change.
#[derive(Serialize)]
pub(super) struct Parameter {
    pub name: String,
    pub unit: String,
    pub range: [f64; 2],
    pub today: f64,
    /// Value in the design.
    pub design: f64,
    /// Interval in the solution space.
    pub interval: Option<[f64; 2]>,
    /// True if the design is at an end of the range.
    pub at_bound: Option<&'static str>,
}

/// A target on a run.
#[derive(Serialize)]
pub(super) struct Target {
    pub metric: String,
    pub run: Option<String>,
    pub unit: String,
    /// `at_most` or `at_least`.
    pub sense: &'static str,
    pub limit: f64,
    /// For a wish, the cost of missing it by its own size.
    pub wish: Option<f64>,
    pub today: f64,
    pub design: f64,
    pub met: bool,
    /// Violation by the design, relative to the limit; negative if it is met.
    pub excess: f64,
    /// Decrease of the cost if the limit were looser by its own size. If not all targets are met: the share of this
    /// target in the conflict.
    pub multiplier: f64,
    /// Uncertainty of the design's value, if parameters are uncertain.
    pub uncertainty: Option<UncertainMetric>,
    /// Share of draws in which the design meets the target.
    pub holds: Option<f64>,
    /// Share of the designs in the solution space that meet it.
    pub in_space: Option<f64>,
}

/// Elasticities of a metric at the design, as means over its targets.
#[derive(Serialize)]
pub(super) struct Sensitivity {
    pub metric: String,
    /// For each parameter, percent of the metric per percent of the parameter.
    pub elasticities: Ordered<f64>,
}

/// The front.
#[derive(Serialize)]
pub(super) struct FrontAnswer {
    pub metrics: Vec<FrontMetric>,
    pub points: Vec<FrontPoint>,
    pub evaluated: usize,
}

/// A metric of the front, mean over the runs.
#[derive(Serialize)]
pub(super) struct FrontMetric {
    pub name: String,
    pub unit: String,
    /// `smallest` or `largest`.
    pub best: &'static str,
    pub today: f64,
    pub design: f64,
}

/// A design of the front.
#[derive(Serialize)]
pub(super) struct FrontPoint {
    pub values: Vec<f64>,
    pub cost: f64,
    pub parameters: Ordered<f64>,
}

/// The box.
#[derive(Serialize)]
pub(super) struct SpaceAnswer {
    /// Required probability.
    pub wanted: f64,
    /// Share of good designs among those that judged it.
    pub probability: f64,
    /// Lower bound of the probability with 95 % confidence.
    pub at_least: f64,
    /// Its volume, relative to that of the whole ranges.
    pub volume: f64,
    pub evaluated: usize,
    pub cuts: Vec<CutAnswer>,
}

/// A slice in the plane of two parameters.
#[derive(Serialize)]
pub(super) struct CutAnswer {
    pub parameters: [String; 2],
    /// Values of both, and the target that is exceeded most.
    pub dots: Vec<(f64, f64, Option<String>)>,
}

/// Number of designs in a slice.
const DOTS: usize = 250;

/// Searches for a design and, if requested, a front and a box. `None` if no design can be simulated.
pub(super) fn gather(
    (subject, ground): (&Subject, &Ground<'_>),
    plan: &Plan,
    chance: Chance,
    seed: u64,
    wanted: [bool; 2],
) -> Option<Answer> {
    let axle = plan.axle(subject, ground, chance);
    let mut task = plan.task(&axle);
    let intervals = |design: &[f64]| design_uncertainty::intervals(subject, (ground, &axle), plan, design);
    let found = design_uncertainty::design(&mut task, &axle, seed, plan.sure)?;
    let known = [found.design.clone()];
    let front = wanted[0].then(|| search_front(&task, plan, &known, seed));
    let uncertain = intervals(&found.design);
    let sureness = design_uncertainty::sureness(subject, plan, &task, &axle, &found.design);
    let space = match wanted[1] && found.met {
        true => search_space(task.clone(), (&axle, &found), plan, &known, seed),
        false => None,
    };
    let cuts = space.as_ref().map_or(Vec::new(), |space| {
        let cut = |&variables| cut(&task, space, variables, DOTS, seed);
        plan.cuts.iter().map(cut).collect()
    });
    let slopes = axle.slopes(&found.design);
    let certain = sureness.as_ref().zip(uncertain);
    Some(Answer {
        subject: subject.name.clone(),
        model: subject.model.about().name.to_string(),
        met: found.met,
        cost: found.cost,
        notices: subject.notes.clone(),
        parameters: parameters(plan, &found, space.as_ref()),
        targets: targets((subject, plan), &task, &found, space.as_ref(), certain),
        uncertainty: sureness,
        sensitivity: slopes
            .as_ref()
            .map_or(Vec::new(), |slopes| sensitivity(plan, slopes, &found)),
        elasticities: slopes.map_or(Vec::new(), |slopes| elasticities(plan, &slopes, &found)),
        front: front.map(|front| front_answer(plan, &found, front)),
        space: space.map(|space| space_answer(plan, &space, cuts)),
    })
}

/// The Pareto front of the plan's aims, with progress in a terminal.
fn search_front(task: &Task<'_>, plan: &Plan, known: &[Vec<f64>], seed: u64) -> Front {
    let aims: Vec<(usize, Sense)> = plan.aims.iter().map(|aim| (aim.result, aim.sense)).collect();
    let settings = FrontSettings {
        seed,
        generations: plan.generations,
        ..FrontSettings::default()
    };
    while_counting("the front: generation".into(), |on_progress| {
        front(task, &aims, known, settings, on_progress)
    })
}

/// The solution space, whose limits have margins for the plan's probability, with progress in a terminal. `None` if no
/// box is found.
fn search_space(
    mut task: Task<'_>,
    (axle, found): (&Axle<'_>, &Found),
    plan: &Plan,
    known: &[Vec<f64>],
    seed: u64,
) -> Option<Space> {
    design_uncertainty::keep_away(&mut task, axle, found, plan.probability);
    let settings = SpaceSettings {
        probability: plan.probability,
        seed,
        ..SpaceSettings::default()
    };
    while_counting("the solution space: round".into(), |on_progress| {
        space(&task, known, settings, on_progress)
    })
}

fn parameters(plan: &Plan, found: &Found, space: Option<&Space>) -> Vec<Parameter> {
    let all = plan.variables.iter().zip(&plan.units).zip(&found.design).enumerate();
    all.map(|(k, ((variable, unit), &design))| Parameter {
        name: variable.name.clone(),
        unit: unit.clone(),
        range: [variable.lower, variable.upper],
        today: variable.today,
        design,
        interval: space.map(|space| space.intervals[k]),
        at_bound: match variable.place(design) {
            place if place < 1e-3 => Some("lower"),
            place if place > 1.0 - 1e-3 => Some("upper"),
            _ => None,
        },
    })
    .collect()
}

fn elasticities(plan: &Plan, slopes: &[Vec<f64>], found: &Found) -> Vec<Vec<f64>> {
    let relative = |value: f64, slopes: &[f64]| -> Vec<f64> {
        let pairs = slopes.iter().zip(&found.design);
        pairs.map(|(slope, own)| rounded(slope * own / value)).collect()
    };
    let limits = plan
        .limits
        .iter()
        .map(|limit| relative(found.values[limit.result], &slopes[limit.result]));
    let couplings = plan
        .couplings
        .iter()
        .map(|own| relative(own.sum(&found.design), &own.factors));
    limits.chain(couplings).collect()
}

fn sensitivity(plan: &Plan, slopes: &[Vec<f64>], found: &Found) -> Vec<Sensitivity> {
    let mut metrics: Vec<&str> = Vec::new();
    for wanted in &plan.wanted[..plan.limits.len()] {
        if !metrics.contains(&&*wanted.metric) {
            metrics.push(&wanted.metric);
        }
    }
    let of = |metric: &&str| {
        let own = plan
            .limits
            .iter()
            .zip(&plan.wanted)
            .filter(|(_, wanted)| wanted.metric == **metric);
        let results: Vec<usize> = own.map(|(limit, _)| limit.result).collect();
        let elasticity = |k: usize| {
            let all = results
                .iter()
                .map(|&at| slopes[at][k] * found.design[k] / found.values[at]);
            rounded(all.sum::<f64>() / results.len() as f64)
        };
        let names = plan.variables.iter().map(|variable| variable.name.clone()).enumerate();
        Sensitivity {
            metric: metric.to_string(),
            elasticities: names.map(|(k, name)| (name, elasticity(k))).collect(),
        }
    };
    metrics.iter().map(of).collect()
}

/// The values of the design.
pub(super) fn design(plan: &Plan, answer: &Answer, subject: &Subject) -> Values {
    let mut values = subject.values.clone();
    for own in &plan.moves {
        values.set(
            own.parameter,
            own.factor * answer.parameters[own.variable].design + own.constant,
        );
    }
    values
}

fn targets(
    (subject, plan): (&Subject, &Plan),
    task: &Task<'_>,
    found: &Found,
    space: Option<&Space>,
    sure: Option<(&DesignUncertainty, Vec<Interval>)>,
) -> Vec<Target> {
    let places = plan.sources.places(subject);
    let names: Vec<String> = places
        .iter()
        .map(|&place| subject.model.about().parameters[place].name.to_string())
        .collect();
    let today: Vec<f64> = plan.variables.iter().map(|variable| variable.today).collect();
    let target = |at: usize| {
        let wanted = &plan.wanted[at];
        let (sense, limit, values) = match plan.limits.get(at) {
            Some(own) => (own.sense, own.value, [plan.today[own.result], found.values[own.result]]),
            None => {
                let coupling = at - plan.limits.len();
                let own = &plan.couplings[coupling];
                (Sense::AtMost, own.most, [own.sum(&today), own.sum(&found.design)])
            }
        };
        Target {
            metric: wanted.metric.clone(),
            run: wanted.run.clone(),
            unit: wanted.unit.clone(),
            sense: if sense == Sense::AtMost { "at_most" } else { "at_least" },
            limit,
            wish: task.wish(at),
            today: values[0],
            design: values[1],
            met: is_met(found.excess[at]),
            excess: found.excess[at],
            multiplier: found.multipliers[at],
            uncertainty: sure
                .as_ref()
                .zip(plan.limits.get(at))
                .map(|((_, intervals), limit)| uncertain_metric(values[1], &names, &intervals[limit.result])),
            holds: sure.as_ref().map(|(sureness, _)| sureness.each[at]),
            in_space: space.map(|space| space.each[at]),
        }
    };
    (0..plan.wanted.len()).map(target).collect()
}

fn front_answer(plan: &Plan, found: &Found, front: Front) -> FrontAnswer {
    let metric = |aim: &super::plan::Aim| FrontMetric {
        name: aim.metric.clone(),
        unit: aim.unit.clone(),
        best: if aim.sense == Sense::AtMost {
            "smallest"
        } else {
            "largest"
        },
        today: plan.today[aim.result],
        design: found.values[aim.result],
    };
    let names = || plan.variables.iter().map(|variable| variable.name.clone());
    let point = |own: qcar_runtime::target::Point| FrontPoint {
        values: plan.aims.iter().map(|aim| own.values[aim.result]).collect(),
        cost: own.cost,
        parameters: names().zip(own.design).collect(),
    };
    FrontAnswer {
        metrics: plan.aims.iter().map(metric).collect(),
        points: front.points.into_iter().map(point).collect(),
        evaluated: front.evaluated,
    }
}

fn space_answer(plan: &Plan, space: &Space, cuts: Vec<Cut>) -> SpaceAnswer {
    let words = |at: usize| {
        let own = &plan.wanted[at];
        own.run
            .as_ref()
            .map_or(own.metric.clone(), |run| format!("{} on {run}", own.metric))
    };
    let dot = |dot: Dot| (dot.at[0], dot.at[1], dot.broken.map(words));
    SpaceAnswer {
        wanted: plan.probability,
        probability: space.probability,
        at_least: space.at_least,
        volume: space.volume,
        evaluated: space.evaluated,
        cuts: cuts
            .into_iter()
            .map(|cut| CutAnswer {
                parameters: cut.variables.map(|variable| plan.variables[variable].name.clone()),
                dots: cut.dots.into_iter().map(dot).collect(),
            })
            .collect(),
    }
}
