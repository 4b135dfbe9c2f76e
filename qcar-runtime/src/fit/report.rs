//! The result as values to print or to serialise.

use super::quality::{Quality, quality};
use super::search::Search;
use super::setup::Setup;
pub use super::uncertainty::StandardError;
use super::uncertainty::Uncertainty;
use crate::campaign::Role;
use crate::least_squares::Stop;
use crate::least_squares::information::Unseen;
use crate::model::Model;
use crate::response::parameters::Values;
use crate::response::ratio::Ratios;
use serde::Serialize;
use std::collections::BTreeMap;

/// Smallest correlation that is reported.
pub const NOTEWORTHY: f64 = 0.9;

/// The result of a fit.
#[derive(Clone, Debug, Serialize)]
pub struct Fit {
    /// The model's name.
    pub model: String,
    /// All parameters of the model, in its order.
    pub parameters: Vec<ParameterFit>,
    /// Pairs whose errors correlate by more than 0.9.
    pub correlations: Vec<Correlation>,
    /// Correlation of every pair of parameters that the data determine.
    pub all_correlations: Vec<Correlation>,
    /// Every measured channel of every run, fitted or not.
    pub channels: Vec<ChannelFit>,
    /// Objective J of the thesis, the sum of squared weighted errors, at the fitted values.
    pub cost: f64,
    /// Objective at the start values.
    pub start_cost: f64,
    /// Stopping reason of the best search.
    pub stopped: Stop,
    /// Stopping reason as a sentence.
    pub stopped_because: &'static str,
    /// True if it stopped at a minimum.
    pub converged: bool,
    /// Number of model evaluations in all searches.
    pub evaluations: usize,
    /// Number of local searches.
    pub starts: usize,
    /// Distinct minima, lowest first.
    pub minima: Vec<LocalMinimum>,
    /// Typical relative shift of the parameters by the difference between the sides of the axle.
    pub asymmetry: f64,
}

/// A parameter of the model after the fit.
#[derive(Clone, Debug, Serialize)]
pub struct ParameterFit {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Fitted value, or the start value if it was not estimated.
    pub value: f64,
    /// The start value.
    pub start: f64,
    /// Bounds; `None` without any.
    pub range: Option<(f64, f64)>,
    /// True if it was fitted; false if it is known, tied, or influences no channel.
    pub fitted: bool,
    /// Standard error, in the parameter's unit.
    pub stderr: Option<f64>,
    /// Relative standard error.
    pub relative_stderr: Option<f64>,
    /// Parts of the standard error.
    pub stderr_parts: Option<StandardError>,
    /// The bound at which it is; `None` inside its range.
    pub at_bound: Option<Bound>,
    /// Why it has no standard error; `None` if it has one.
    pub why_no_stderr: Option<NoError>,
    /// The parameter that it is tied to.
    pub tied_to: Option<String>,
    /// The K&C test that gave its value, if no fitted channel depends on it.
    pub curve: Option<&'static str>,
}

/// An end of a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[expect(missing_docs, reason = "each says it")]
pub enum Bound {
    Lower,
    Upper,
}

/// Why a parameter has no standard error.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "reason")]
pub enum NoError {
    /// It is known.
    Known,
    /// It is tied to another parameter.
    Tied,
    /// No fitted channel depends on it, so it keeps its start value.
    NotSeen,
    /// The runs do not determine it within its range.
    Undetermined,
    /// It is at a bound, where its error is not symmetric.
    AtBound,
    /// The channels determine it only in combination with others.
    OnlyTogether {
        /// Names of the others.
        with: Vec<String>,
    },
    /// The search did not end at a minimum.
    NotConverged,
}

impl ParameterFit {
    /// True if the channels determine the parameter only in combination with others.
    pub fn is_only_in_combination(&self) -> bool {
        matches!(self.why_no_stderr, Some(NoError::OnlyTogether { .. }))
    }
}

impl NoError {
    /// The reason as a sentence.
    pub fn sentence(&self) -> String {
        match self {
            Self::Known => "known, not fitted".to_owned(),
            Self::Tied => "takes the value of another parameter".to_owned(),
            Self::NotSeen => "no fitted channel depends on it: keeps its start value".to_owned(),
            Self::Undetermined => "the runs do not determine it within its range".to_owned(),
            Self::AtBound => "at its bound".to_owned(),
            Self::OnlyTogether { with } => format!("determined only in combination with {}", with.join(", ")),
            Self::NotConverged => "the search did not end at a minimum".to_owned(),
        }
    }
}

/// Two parameters with correlated errors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Correlation {
    /// Their names.
    pub between: (String, String),
    /// Between −1 and 1.
    pub value: f64,
}

/// A channel of a run, measured and modelled.
#[derive(Clone, Debug, Serialize)]
pub struct ChannelFit {
    /// Name, such as `pad_to_body`.
    pub name: String,
    /// The file of the run.
    pub run: String,
    /// `fit` or `held_out`.
    pub role: &'static str,
    /// True if it is part of the cost.
    pub fitted: bool,
    /// Its fit percentages and errors.
    #[serde(flatten)]
    pub quality: Quality,
}

/// A local minimum.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LocalMinimum {
    /// Objective J at the minimum.
    pub cost: f64,
    /// Number of searches that ended there.
    pub starts: usize,
    /// Fitted parameters at the minimum.
    pub parameters: BTreeMap<String, f64>,
}

pub(super) fn report<M: Model + ?Sized>(setup: &Setup<'_, M>, search: &Search, uncertainty: &Uncertainty) -> Fit {
    let best = &search.best;
    let mut values = setup.values.clone();
    setup
        .free
        .iter()
        .zip(&best.x)
        .for_each(|(&place, &value)| values.set(place, value));
    let name = |variable: usize| setup.model.about().parameters[setup.free[variable]].name.to_string();
    let correlations = |least: f64| -> Vec<Correlation> {
        let known = best.stop.converged().then(|| uncertainty.correlations(least));
        let named = |(a, b, value): (usize, usize, f64)| Correlation {
            between: (name(a), name(b)),
            value,
        };
        known.into_iter().flatten().map(named).collect()
    };
    Fit {
        model: setup.model.about().name.to_string(),
        parameters: (0..values.as_slice().len())
            .map(|k| parameter(setup, search, uncertainty, &values, k))
            .collect(),
        correlations: correlations(NOTEWORTHY),
        all_correlations: correlations(0.0),
        channels: channels(setup, &values),
        cost: 2.0 * best.cost,
        start_cost: setup.cost().at(&setup.start()).0.norm_squared(),
        stopped: best.stop,
        stopped_because: best.stop.sentence(),
        converged: best.stop.converged(),
        evaluations: search.evaluations,
        starts: search.starts,
        minima: minima(search, name),
        asymmetry: uncertainty.asymmetry,
    }
}

fn parameter<M: Model + ?Sized>(
    setup: &Setup<'_, M>,
    search: &Search,
    uncertainty: &Uncertainty,
    values: &Values,
    place: usize,
) -> ParameterFit {
    let about = &setup.model.about().parameters;
    let variable = setup.free.iter().position(|&free| free == place);
    let converged = search.best.stop.converged();
    let error = variable
        .filter(|_| converged)
        .and_then(|variable| uncertainty.standard_error(variable));
    let value = values.as_slice()[place];
    let given = setup
        .plan
        .parameters
        .iter()
        .find(|given| given.name == about[place].name);
    let tied = values.leader(place) != place;
    ParameterFit {
        name: about[place].name.to_string(),
        unit: about[place].unit.to_string(),
        value,
        start: setup.values.as_slice()[place],
        range: given.and_then(|given| given.range).or(about[place].range),
        fitted: variable.is_some(),
        stderr: error.map(|error| error.total),
        relative_stderr: error.map(|error| error.total / value.abs()),
        stderr_parts: error,
        at_bound: variable.and_then(|variable| bound(search.best.at_bound[variable])),
        why_no_stderr: error
            .is_none()
            .then(|| why(setup, search, uncertainty, place, variable, tied)),
        tied_to: tied.then(|| about[values.leader(place)].name.to_string()),
        curve: None,
    }
}

fn bound(side: i8) -> Option<Bound> {
    match side {
        0 => None,
        side if side < 0 => Some(Bound::Lower),
        _ => Some(Bound::Upper),
    }
}

fn why<M: Model + ?Sized>(
    setup: &Setup<'_, M>,
    search: &Search,
    uncertainty: &Uncertainty,
    place: usize,
    variable: Option<usize>,
    tied: bool,
) -> NoError {
    let Some(variable) = variable else {
        return match (tied, setup.unseen.contains(&place)) {
            (true, _) => NoError::Tied,
            (false, true) => NoError::NotSeen,
            (false, false) => NoError::Known,
        };
    };
    if !search.best.stop.converged() {
        return NoError::NotConverged;
    }
    let name = |&other: &usize| setup.model.about().parameters[setup.free[other]].name.to_string();
    match uncertainty.unseen(variable) {
        Some(Unseen::Nowhere) => NoError::NotSeen,
        Some(Unseen::Combination { with }) => NoError::OnlyTogether {
            with: with.iter().map(name).collect(),
        },
        None => NoError::AtBound,
    }
}

fn channels<M: Model + ?Sized>(setup: &Setup<'_, M>, values: &Values) -> Vec<ChannelFit> {
    let mut channels = Vec::new();
    let mut ratios = Ratios::new(setup.model, values);
    for level in setup.levels {
        for observation in &level.observations {
            let channel = &observation.channel;
            let lines = &observation.frequency;
            let model = ratios.ratio(level.excitation, [&channel.numerator, &channel.denominator], lines);
            let model = model.expect("the setup has found both signals").value;
            channels.push(ChannelFit {
                name: channel.name.to_string(),
                run: level.name.clone(),
                role: role(level.role),
                fitted: observation.fitted && level.role == Role::Fit,
                quality: quality(lines, &model, &observation.value),
            });
        }
    }
    channels
}

fn role(role: Role) -> &'static str {
    match role {
        Role::Fit => "fit",
        Role::HeldOut => "held_out",
    }
}

fn minima(search: &Search, name: impl Fn(usize) -> String) -> Vec<LocalMinimum> {
    let parameters = |x: &[f64]| x.iter().enumerate().map(|(k, &value)| (name(k), value)).collect();
    let minimum = |minimum: &super::search::Minimum| LocalMinimum {
        cost: 2.0 * minimum.cost,
        starts: minimum.starts.len(),
        parameters: parameters(&minimum.x),
    };
    search.minima.iter().map(minimum).collect()
}
