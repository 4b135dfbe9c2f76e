//! The design of least cost that meets all limits, or the one with the smallest violation.
//!
//! Sequential quadratic programming under an exact penalty in a trust region (Fletcher, "Practical Methods of
//! Optimization", 2nd ed., section 14.4), from today's design and from the most promising of a Latin hypercube.

use rayon::prelude::*;

use super::quadratic::Quadratic;
use super::task::Task;
use crate::progress::OnProgress;
use crate::random::SplitMix;

/// Result of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// A value for each design variable.
    pub design: Vec<f64>,
    /// Its results.
    pub values: Vec<f64>,
    /// Its cost, including that of missed wishes.
    pub cost: f64,
    /// Violation of each limit and coupling, relative to its size; at most zero if it is met.
    pub excess: Vec<f64>,
    /// Decrease of the cost if a limit were looser by its own size. If not all limits are met: the share of each limit
    /// in the conflict, from 0 to 1, also of those that are met at the expense of others; zero for wishes.
    pub multipliers: Vec<f64>,
    /// True if all limits and couplings are met.
    pub met: bool,
    /// Numbers of evaluations of designs and of derivatives.
    pub effort: [usize; 2],
}

/// Designs that are evaluated before the searches begin, and the number of searches.
const SURVEYED: usize = 120;
const STARTS: usize = 3;
const ITERATIONS: usize = 25;
/// First and smallest size of a step relative to the ranges, and smallest size as long as a limit is violated.
const FIRST: f64 = 0.3;
const SMALLEST: f64 = 1e-4;
const FINEST: f64 = 1e-8;
/// Share of the predicted gain that a step must reach to be accepted.
const GAIN: f64 = 0.05;
/// Relative distance inside a limit at which the search aims: a search that aims at the limit itself would often end
/// beyond it.
const MARGIN: f64 = 1e-4;
/// Least cost of a design variable, which makes every step unique.
const LEAST_COST: f64 = 1e-4;

/// Searches, and reports its rounds to `on_progress`. `None` if neither an evaluated design nor today's has results.
pub fn search(task: &Task<'_>, seed: u64, on_progress: OnProgress<'_>) -> Option<Found> {
    let starts = starts(task, seed);
    on_progress(0, 2);
    let ends: Vec<State> = starts.into_par_iter().map(|start| settle(task, start)).collect();
    on_progress(1, 2);
    let effort = ends.iter().fold([SURVEYED, 0], |sum, end| {
        [sum[0] + end.effort[0], sum[1] + end.effort[1]]
    });
    let mut best = ends.into_iter().min_by(|a, b| a.rank().total_cmp(&b.rank()))?;
    best.effort = effort;
    if task.variables.iter().any(|variable| variable.step.is_some()) {
        best = to_available(task, best);
    }
    on_progress(2, 2);
    Some(found(task, best))
}

/// State of a search.
#[derive(Clone)]
struct State {
    places: Vec<f64>,
    values: Vec<f64>,
    /// Cost, including that of missed wishes.
    cost: f64,
    excess: Vec<f64>,
    /// Sum of the violations of all constraints.
    broken: f64,
    met: bool,
    multipliers: Vec<f64>,
    price: f64,
    effort: [usize; 2],
}

impl State {
    fn at(task: &Task<'_>, places: Vec<f64>, price: f64) -> Option<Self> {
        let values = task.designs.values(&task.design(&places))?;
        Some(Self::with(task, places, values, price))
    }

    fn with(task: &Task<'_>, places: Vec<f64>, values: Vec<f64>, price: f64) -> Self {
        let design = task.design(&places);
        let excess = task.excesses(&design, &values);
        Self {
            cost: task.cost(&design) + task.missed(&excess),
            broken: task.broken(&excess, &task.margins(MARGIN)),
            met: task.holds(&excess),
            multipliers: vec![0.0; excess.len()],
            places,
            values,
            excess,
            price,
            effort: [1, 0],
        }
    }

    fn merit(&self) -> f64 {
        self.cost + self.price * self.broken
    }

    /// Orders designs: feasible ones first, then by cost.
    fn rank(&self) -> f64 {
        if self.met {
            self.cost
        } else {
            1e12 * (1.0 + self.broken)
        }
    }
}

/// The price of violating a limit by its own size: more than any move could cost.
fn price(task: &Task<'_>) -> f64 {
    10.0 * (1.0 + task.variables.iter().map(|variable| variable.cost).sum::<f64>())
}

fn starts(task: &Task<'_>, seed: u64) -> Vec<State> {
    let price = price(task);
    let today = task.places(&task.today());
    let points = SplitMix::new(seed).hypercube(SURVEYED, task.variables.len());
    let designs: Vec<Vec<f64>> = points.iter().map(|places| task.design(places)).collect();
    let looked = points.into_iter().zip(task.designs.values_of_all(&designs));
    let mut looked: Vec<State> = looked
        .filter_map(|(places, values)| Some(State::with(task, places, values?, price)))
        .collect();
    looked.sort_by(|a, b| a.merit().total_cmp(&b.merit()));
    looked.truncate(STARTS);
    State::at(task, today, price).into_iter().chain(looked).collect()
}

/// Minimises the merit function, and raises the penalties as long as limits are violated.
fn settle(task: &Task<'_>, mut state: State) -> State {
    for _ in 0..3 {
        state = descend(task, state, &vec![true; task.variables.len()]);
        if state.met {
            break;
        }
        state.price *= 10.0;
    }
    state
}

fn descend(task: &Task<'_>, mut state: State, free: &[bool]) -> State {
    let mut radius = FIRST;
    let mut slopes = None;
    for _ in 0..ITERATIONS {
        if slopes.is_none() {
            state.effort[1] += 1;
            slopes = slopes_at(task, &state.places);
        }
        let Some(rows) = &slopes else { break };
        let (step, multipliers) = solve(task, &state, rows, radius, free);
        state.multipliers = multipliers;
        let length = step.iter().fold(0.0, |most: f64, d| most.max(d.abs()));
        let smallest = if state.met { SMALLEST } else { FINEST };
        if length < smallest {
            break;
        }
        let expected = state.merit() - expected(task, &state, rows, &step);
        let places = state
            .places
            .iter()
            .zip(&step)
            .map(|(place, d)| (place + d).clamp(0.0, 1.0))
            .collect();
        let next = State::at(task, places, state.price);
        state.effort[0] += 1;
        match next {
            Some(next) if expected > 0.0 && state.merit() - next.merit() > GAIN * expected => {
                let gain = (state.merit() - next.merit()) / expected;
                radius = if gain > 0.5 { (2.0 * radius).min(1.0) } else { radius };
                let (multipliers, effort) = (state.multipliers, state.effort);
                state = State {
                    multipliers,
                    effort,
                    ..next
                };
                slopes = None;
            }
            _ => radius = 0.3 * radius.min(length),
        }
        if radius < smallest {
            break;
        }
    }
    state
}

/// For each limit and coupling, its derivative by the position of each design variable.
fn slopes_at(task: &Task<'_>, places: &[f64]) -> Option<Vec<Vec<f64>>> {
    let by_variable = task.designs.slopes(&task.design(places))?;
    let limits = task.limits.iter().map(|limit| {
        let slopes = by_variable[limit.result].iter().zip(&task.variables);
        slopes
            .map(|(slope, variable)| limit.slope(*slope) * variable.span())
            .collect()
    });
    let couplings = task.couplings.iter().map(|coupling| {
        let variables = task.variables.iter().enumerate();
        variables
            .map(|(k, variable)| coupling.slope(k, &task.variables) * variable.span())
            .collect()
    });
    Some(limits.chain(couplings).collect())
}

fn solve(task: &Task<'_>, state: &State, slopes: &[Vec<f64>], radius: f64, free: &[bool]) -> (Vec<f64>, Vec<f64>) {
    let variables = || task.variables.iter().zip(&state.places).zip(free);
    let weights: Vec<f64> = task
        .variables
        .iter()
        .map(|variable| variable.cost.max(LEAST_COST))
        .collect();
    let wanted = variables().map(|((variable, place), _)| match variable.cost {
        0.0 => 0.0,
        _ => (variable.today - variable.lower) / variable.span() - place,
    });
    let radius = |free: bool| if free { radius } else { 0.0 };
    let margins = task.margins(MARGIN);
    let excess: Vec<f64> = state
        .excess
        .iter()
        .zip(&margins)
        .map(|(excess, margin)| excess + margin)
        .collect();
    let prices: Vec<f64> = (0..excess.len())
        .map(|at| task.wish(at).unwrap_or(state.price))
        .collect();
    let quadratic = Quadratic {
        weights: &weights,
        wanted: &wanted.collect::<Vec<_>>(),
        low: &variables()
            .map(|((_, place), free)| (-place).max(-radius(*free)))
            .collect::<Vec<_>>(),
        high: &variables()
            .map(|((_, place), free)| (1.0 - place).min(radius(*free)))
            .collect::<Vec<_>>(),
        excess: &excess,
        slopes,
        prices: &prices,
    };
    quadratic.solve()
}

/// Predicted merit after a step, from the linearisation.
fn expected(task: &Task<'_>, state: &State, slopes: &[Vec<f64>], step: &[f64]) -> f64 {
    let places: Vec<f64> = state.places.iter().zip(step).map(|(place, d)| place + d).collect();
    let after = state.excess.iter().zip(slopes).map(|(excess, slopes)| {
        let moved: f64 = slopes.iter().zip(step).map(|(slope, d)| slope * d).sum();
        excess + moved
    });
    let after: Vec<f64> = after.collect();
    task.cost(&task.design(&places)) + task.missed(&after) + state.price * task.broken(&after, &task.margins(MARGIN))
}

/// Moves to available values: rounds each design variable, tries its neighbours, and optimises the
/// others again.
fn to_available(task: &Task<'_>, from: State) -> State {
    let rounded = |places: &[f64]| task.places(&task.available(&task.design(places)));
    let follow = |state: State| {
        let free: Vec<bool> = task.variables.iter().map(|variable| variable.step.is_none()).collect();
        if free.contains(&true) {
            descend(task, state, &free)
        } else {
            state
        }
    };
    let Some(start) = State::at(task, rounded(&from.places), from.price) else {
        return from;
    };
    let multipliers = from.multipliers.clone();
    let mut best = follow(start);
    let mut better = true;
    while better {
        better = false;
        for (k, step) in task
            .variables
            .iter()
            .enumerate()
            .filter_map(|(k, variable)| Some((k, variable.step? / variable.span())))
        {
            for moved in [-step, step] {
                let mut places = best.places.clone();
                places[k] += moved;
                if !(-1e-9..=1.0 + 1e-9).contains(&places[k]) {
                    continue;
                }
                let next = State::at(task, rounded(&places), best.price).map(follow);
                if let Some(next) = next.filter(|next| next.rank() < best.rank() * (1.0 - 1e-6)) {
                    (best, better) = (next, true);
                }
            }
        }
    }
    State {
        multipliers,
        effort: from.effort,
        ..best
    }
}

fn found(task: &Task<'_>, state: State) -> Found {
    let met = state.met;
    // A limit that is met may stand in the way too: what is missed would shrink if it were looser.
    let own = |at: usize| match task.wish(at) {
        Some(_) => 0.0,
        None => state.multipliers[at],
    };
    let total: f64 = (0..state.multipliers.len()).map(own).sum();
    let multiplier = |at: usize| match met {
        true => state.multipliers[at],
        false => own(at) / total.max(f64::MIN_POSITIVE),
    };
    Found {
        design: task.design(&state.places),
        multipliers: (0..state.multipliers.len()).map(multiplier).collect(),
        values: state.values,
        cost: state.cost,
        excess: state.excess,
        met,
        effort: state.effort,
    }
}
