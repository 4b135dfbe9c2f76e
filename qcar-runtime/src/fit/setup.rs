//! Checks plan, model and measurement against each other, so that no later step of the fit can fail.

use super::cost::{Cost, GridPlan, Target};
use super::observation::{Level, Observation};
use super::plan::Plan;
use crate::campaign::{self, Role};
use crate::error::{InputError, Place, Problem};
use crate::least_squares::Bounds;
use crate::model::Model;
use crate::response::Response;
use crate::response::parameters::Values;
use crate::response::signal::{SignalError, Term, locate};
use std::collections::BTreeMap;

/// A checked fit, ready to run.
pub struct Setup<'a, M: ?Sized> {
    pub(super) model: &'a M,
    pub(super) plan: &'a Plan,
    pub(super) levels: &'a [Level],
    /// Start values of all parameters.
    pub(super) values: Values,
    /// The fitted parameters: those to fit on which a channel depends.
    pub(super) free: Vec<usize>,
    /// Parameters to fit on which no channel depends.
    pub(super) unseen: Vec<usize>,
    pub(super) bounds: Bounds,
    pub(super) grids: Vec<GridPlan>,
    pub(super) targets: Vec<Target>,
    /// Level and observation of each target.
    pub(super) origins: Vec<(usize, usize)>,
}

impl<'a, M: Model + ?Sized> Setup<'a, M> {
    /// Checks a plan and measurements against a model.
    ///
    /// # Errors
    /// Fails if a parameter is not in the model, has no value, another unit, or a start outside its range, if the model
    /// lacks a signal, or if the campaign has no data to fit. Reports all errors at once.
    pub fn new(model: &'a M, plan: &'a Plan, levels: &'a [Level]) -> Result<Self, InputError> {
        let mut problems = check_parameters(model, plan);
        let values = resolve(model, plan).map_err(|found| problems.extend(found)).ok();
        let (grids, targets, origins) = place_targets(model, plan, levels, &mut problems);
        let fits = plan.parameters.iter().any(|parameter| parameter.fit);
        if fits && targets.is_empty() && problems.is_empty() {
            problems.push(nothing_to_fit_to(plan));
        }
        let values = InputError::unless_empty(problems, values)?;
        let asked = asked_for(model, plan);
        let (_, jacobian) = Cost::new(model, &grids, &targets, &values, &asked).at(&start(&values, &asked));
        let is_seen = |&column: &usize| jacobian.column(column).iter().any(|slope| *slope != 0.0);
        let (seen, unseen): (Vec<usize>, Vec<usize>) = (0..asked.len()).partition(is_seen);
        let places = |columns: Vec<usize>| columns.into_iter().map(|column| asked[column]).collect::<Vec<_>>();
        let (free, unseen) = (places(seen), places(unseen));
        let bounds = bounds(model, plan, &free);
        Ok(Self {
            model,
            plan,
            levels,
            values,
            free,
            unseen,
            bounds,
            grids,
            targets,
            origins,
        })
    }

    /// Start values of the free parameters, in the order of [`Setup::local`].
    pub fn start(&self) -> Vec<f64> {
        start(&self.values, &self.free)
    }

    /// The start values of all parameters, in the order of the model.
    pub fn values(&self) -> &[f64] {
        self.values.as_slice()
    }

    /// Positions of the free parameters in the model.
    pub fn free(&self) -> &[usize] {
        &self.free
    }

    pub(super) fn cost(&self) -> Cost<'a, '_, M> {
        Cost::new(self.model, &self.grids, &self.targets, &self.values, &self.free)
    }

    pub(super) fn observation(&self, target: usize) -> &Observation {
        let (level, observation) = self.origins[target];
        &self.levels[level].observations[observation]
    }
}

fn start(values: &Values, places: &[usize]) -> Vec<f64> {
    places.iter().map(|&place| values.as_slice()[place]).collect()
}

fn resolve<M: Model + ?Sized>(model: &M, plan: &Plan) -> Result<Values, Vec<Problem>> {
    let given: BTreeMap<String, f64> = plan.parameters.iter().map(|p| (p.name.clone(), p.value)).collect();
    Values::resolve(model.about(), &given, &plan.vehicle)
        .map_err(|errors| errors.iter().map(|error| error.problem(&plan.source)).collect())
}

/// Checks units and ranges of the start values.
fn check_parameters<M: Model + ?Sized>(model: &M, plan: &Plan) -> Vec<Problem> {
    let problem = |name: &str, found: String, expected: String, remedy: &str| {
        Problem::new(
            &plan.source,
            Place::Name(format!("parameters.{name}")),
            found,
            expected,
            remedy,
        )
    };
    let mut problems = Vec::new();
    for given in &plan.parameters {
        let Some(parameter) = model.about().parameters.iter().find(|p| p.name == given.name.as_str()) else {
            continue;
        };
        if campaign::dimension(&given.unit) != campaign::dimension(&parameter.unit) {
            let expected = format!("the unit `{}` of the model", parameter.unit);
            problems.push(problem(
                &given.name,
                format!("unit `{}`", given.unit),
                expected,
                "convert the value",
            ));
        }
        if let Some((lower, upper)) = given.range.or(parameter.range).filter(|_| given.fit)
            && !(lower..=upper).contains(&given.value)
        {
            let found = format!("the start value {}", given.value);
            let expected = format!("one from {lower} to {upper}");
            problems.push(problem(
                &given.name,
                found,
                expected,
                "correct the value or widen `range`",
            ));
        }
    }
    problems
}

/// The parameters to fit, in the order of the model.
fn asked_for<M: Model + ?Sized>(model: &M, plan: &Plan) -> Vec<usize> {
    let wanted = |name: &str| plan.parameters.iter().any(|given| given.fit && given.name == name);
    let parameters = model.about().parameters.iter().enumerate();
    parameters
        .filter(|(_, parameter)| wanted(&parameter.name))
        .map(|(place, _)| place)
        .collect()
}

fn bounds<M: Model + ?Sized>(model: &M, plan: &Plan, free: &[usize]) -> Bounds {
    let range = |&place: &usize| {
        let parameter = &model.about().parameters[place];
        let given = plan.parameters.iter().find(|given| given.name == parameter.name);
        let range = given.and_then(|given| given.range).or(parameter.range);
        range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY))
    };
    let (lower, upper) = free.iter().map(range).unzip();
    Bounds { lower, upper }
}

fn nothing_to_fit_to(plan: &Plan) -> Problem {
    let found = "no run with role `fit` that records an excitation and a response";
    let remedy = "give a sweep or time history the role `fit`; a record without excitation is fitted by --all-runs";
    Problem::new(
        &plan.source,
        Place::Name("run".to_owned()),
        found,
        "at least one",
        remedy,
    )
}

type Placed = (Vec<GridPlan>, Vec<Target>, Vec<(usize, usize)>);

/// Finds the signals of every observation in the model, and gives rows to those that are fitted.
fn place_targets<M: Model + ?Sized>(model: &M, plan: &Plan, levels: &[Level], problems: &mut Vec<Problem>) -> Placed {
    let (mut grids, mut targets, mut origins): Placed = Placed::default();
    let mut row = 0;
    for (at, level) in levels.iter().enumerate() {
        for (place, observation) in level.observations.iter().enumerate() {
            let terms = match find_terms(model, level, observation) {
                Ok(terms) => terms,
                Err(error) => {
                    let problem = error.problem(&plan.source, &observation.channel.name);
                    if !problems.contains(&problem) {
                        problems.push(problem);
                    }
                    continue;
                }
            };
            if level.role != Role::Fit || !observation.fitted {
                continue;
            }
            let grid = grid(&mut grids, level.excitation, &observation.frequency);
            let terms = (
                term(&mut grids[grid].terms, terms.0),
                term(&mut grids[grid].terms, terms.1),
            );
            let weight = plan.weight(&observation.channel.name);
            targets.push(Target::new(observation, weight, plan.weighting, grid, terms, row));
            origins.push((at, place));
            row += 2 * observation.frequency.len();
        }
    }
    (grids, targets, origins)
}

fn find_terms<M: Model + ?Sized>(
    model: &M,
    level: &Level,
    observation: &Observation,
) -> Result<(Term, Term), SignalError> {
    let layout = Response::new(model, level.excitation, &[]);
    let find = |signal| locate(model.about(), layout.layout(), level.excitation, signal);
    Ok((
        find(&observation.channel.numerator)?,
        find(&observation.channel.denominator)?,
    ))
}

fn grid(grids: &mut Vec<GridPlan>, excitation: usize, frequency: &[f64]) -> usize {
    let same = |grid: &GridPlan| grid.excitation == excitation && grid.frequency == frequency;
    grids.iter().position(same).unwrap_or_else(|| {
        grids.push(GridPlan {
            excitation,
            frequency: frequency.to_vec(),
            terms: Vec::new(),
        });
        grids.len() - 1
    })
}

fn term(terms: &mut Vec<Term>, term: Term) -> usize {
    terms.iter().position(|other| *other == term).unwrap_or_else(|| {
        terms.push(term);
        terms.len() - 1
    })
}
