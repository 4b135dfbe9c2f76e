//! The fit of a nonlinear model to all runs of a campaign, each at its own level.
//!
//! The residuals and the sensor errors are those of discovery.

// Its result as text and JSON.
mod render;

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use qcar_runtime::campaign::{Campaign, Role};
use qcar_runtime::discover::Evidence;
use qcar_runtime::discover::answer::Update;
use qcar_runtime::discover::candidate::Workshop;
use qcar_runtime::discover::posterior::{Explanation, Refit, Setting};
use qcar_runtime::discover::select::{self, MultiStart};
use qcar_runtime::error::InputError;
use qcar_runtime::fit::profile::ParameterProfile;
use qcar_runtime::fit::report::{Bound, NoError, ParameterFit};
use qcar_runtime::least_squares::information::Unseen;
use qcar_runtime::model::{About, Model};
use qcar_runtime::progress::{self, OnProgress};
use qcar_runtime::response::parameters::Values;
use qcar_runtime::spelling;

use super::{Arguments, Choices, files, plan};
use crate::failure::{Failure, flag};
use crate::files::put;
use crate::parameters::campaign_out_of_range;
use crate::progress::{Showing, while_counting};
use crate::sensor_residuals;
use crate::terminal::prose;
use crate::verbs::Format;
use crate::workshop::{Bench, given};

/// Result of the fit of a nonlinear model.
pub(crate) struct Nonlinear {
    pub(crate) campaign: Campaign,
    bench: Bench,
    model: String,
    pub(crate) parameters: Vec<ParameterFit>,
    pub(super) starts: usize,
    pub(crate) found: MultiStart,
    pub(super) profiles: Vec<ParameterProfile>,
    seconds: f64,
}

/// Runs the verb.
pub(super) fn run(campaign: Campaign, arguments: &Arguments) -> Result<String, Failure> {
    refuse_choices(&arguments.choices)?;
    let fitted = fit(campaign, &arguments.choices)?;
    if let Some(folder) = &arguments.out {
        fitted.write(folder)?;
    }
    let text = match arguments.format {
        Format::Text => prose(&fitted.text()),
        Format::Json => fitted.json(),
    };
    if fitted.found.explanation.refit.stop.converged() {
        Ok(text)
    } else {
        Err(Failure::Finding(text))
    }
}

/// # Errors
/// Fails if channels or resamples are requested, which only the cost of a linear fit has.
fn refuse_choices(choices: &Choices) -> Result<(), InputError> {
    let expected = "a linear model, whose cost consists of channels";
    let remedy = "leave it out: a nonlinear model is fitted to all sensors";
    let channels =
        (!choices.channels.is_empty()).then(|| flag("--channels", choices.channels.join(","), expected, remedy));
    let alone = "a linear model, fitted to its transmissibilities alone";
    let resamples = choices.bootstrap.map(|own| {
        let remedy = "use `--profile`, which finds intervals of every fit";
        flag("--bootstrap", own, alone, remedy)
    });
    InputError::unless_empty(channels.into_iter().chain(resamples).collect(), Some(()))
}

/// Fits the model.
///
/// # Errors
/// Fails if something cannot be read, or if the campaign has no data for the model.
pub(crate) fn fit(mut campaign: Campaign, choices: &Choices) -> Result<Nonlinear, Failure> {
    let begun = Instant::now();
    let bench = Bench::of_campaign(&campaign, choices.model.as_deref())?;
    let about = bench.model().about().clone();
    let plan = plan(&campaign, &about, choices)?;
    let setting = given(&plan.parameters, &campaign);
    check_profiled(&setting, &about, &choices.profile)?;
    let showing = Showing::new();
    showing.step(format!("{}: reading", campaign.name));
    let evidence = Evidence::from_campaign(&campaign, &about)?;
    let on_update = |update: Update<'_>| {
        if let Update::Step(what) = update {
            showing.step(format!("{}: {what}", campaign.name));
        }
    };
    let found = select::fit_from_starts(Box::new(bench.clone()), &setting, &evidence, plan.starts, &on_update);
    drop(showing);
    let found = found.map_err(|error| Failure::Input(format!("{}: {error}\n", campaign.manifest().display())))?;
    campaign.notices.extend(evidence.notices.iter().cloned());
    let outside = campaign_out_of_range(&about, &campaign);
    campaign.notices.extend(outside);
    campaign
        .notices
        .extend(unpredicted(&found.evidence, &found.explanation));
    let profiles = profiles(
        bench.model(),
        &found.explanation.refit,
        &found.evidence,
        &choices.profile,
    );
    Ok(Nonlinear {
        profiles,
        bench,
        model: about.name.to_string(),
        parameters: parameters(&about, &setting, &found.explanation),
        starts: plan.starts,
        found,
        seconds: begun.elapsed().as_secs_f64(),
        campaign,
    })
}

/// Checks that the runs of a campaign can be fitted; see [`check`](super::check).
///
/// # Errors
/// Fails as the fit does.
pub(super) fn check(campaign: &Campaign, about: &About, choices: &Choices) -> Result<(), Failure> {
    if !campaign.runs.iter().any(|run| run.role == Role::Fit) {
        return Ok(());
    }
    plan(campaign, about, choices)?;
    Evidence::from_campaign(campaign, about)?;
    Ok(())
}

/// A sentence on the sensors whose residual is unknown, because the model has no finite prediction of a run.
fn unpredicted(evidence: &Evidence, explanation: &Explanation) -> Option<String> {
    let left = sensor_residuals::left(evidence, [explanation; 2]);
    let unknown = left.iter().filter(|own| !own.after_percent.is_finite());
    let unknown: Vec<String> = unknown
        .map(|own| format!("`{}` in a {}", own.channel, own.kind))
        .collect();
    (!unknown.is_empty()).then(|| {
        format!(
            "with these values the model does not predict {}: its motion diverges, or its steady state is not found",
            unknown.join(", ")
        )
    })
}

/// # Errors
/// Fails if a name is not that of a fitted parameter.
fn check_profiled(setting: &Setting, about: &About, names: &[String]) -> Result<(), InputError> {
    let of_model = |name: &str| about.parameters.iter().any(|own| own.name == name);
    let fitted = || {
        setting
            .given
            .iter()
            .filter(|own| own.range.is_some() && of_model(&own.name))
            .map(|own| &*own.name)
    };
    let unknown = names
        .iter()
        .filter(|own| *own != ALL && !fitted().any(|name| name == **own));
    let problem = |own: &String| {
        let remedy = spelling::remedy(own, fitted());
        flag(
            "--profile",
            format!("`{own}`"),
            "a parameter that is fitted, or `all`",
            &remedy,
        )
    };
    InputError::unless_empty(unknown.map(problem).collect(), Some(()))
}

/// Profiles of the requested parameters.
fn profiles(model: &dyn Model, refit: &Refit, evidence: &Evidence, names: &[String]) -> Vec<ParameterProfile> {
    let parameters = &model.about().parameters;
    let is_asked = |k: &usize| {
        let own = &parameters[refit.free[*k].parameter].name;
        names.iter().any(|name| name == ALL || *name == **own)
    };
    let wanted: Vec<usize> = (0..refit.free.len()).filter(is_asked).collect();
    if wanted.is_empty() || !refit.stop.converged() {
        return Vec::new();
    }
    let fitted = refit.fitted_of(evidence);
    let all = |on_progress: OnProgress<'_>| progress::map(&wanted, on_progress, |&k| refit.profile(model, &fitted, k));
    while_counting("profile".into(), all)
}

/// The word for all names.
const ALL: &str = "all";

fn parameters(about: &About, setting: &Setting, of: &Explanation) -> Vec<ParameterFit> {
    let refit = &of.refit;
    let given: BTreeMap<String, f64> = setting.given.iter().map(|own| (own.name.clone(), own.value)).collect();
    let start = Values::resolve(about, &given, &setting.vehicle).unwrap_or_else(|_| refit.values.clone());
    let errors = refit.stderr();
    let parameter = |(place, own): (usize, &qcar_runtime::model::Parameter)| {
        let value = refit.values.as_slice()[place];
        let free = refit.free.iter().position(|free| free.parameter == place);
        let leader = refit.values.leader(place);
        let at_bound = free.and_then(|free| match refit.at_bound[free] {
            0 => None,
            side if side < 0 => Some(Bound::Lower),
            _ => Some(Bound::Upper),
        });
        // A parameter that the data determine no better than a uniform distribution over its range counts as
        // undetermined.
        let width = |free: usize| (refit.free[free].upper - refit.free[free].lower) / 12.0_f64.sqrt();
        let error = free.filter(|&free| errors[free] < width(free)).map(|free| errors[free]);
        let why = match (free, at_bound) {
            _ if leader != place => NoError::Tied,
            (None, _) => NoError::Known,
            (_, Some(_)) => NoError::AtBound,
            (Some(free), None) => why_unseen(about, refit, free),
        };
        ParameterFit {
            name: own.name.to_string(),
            unit: own.unit.to_string(),
            value,
            start: start.as_slice()[place],
            range: free
                .map(|free| (refit.free[free].lower, refit.free[free].upper))
                .or(own.range),
            fitted: free.is_some(),
            stderr: error,
            relative_stderr: error.map(|error| error / value.abs()),
            stderr_parts: None,
            at_bound,
            why_no_stderr: error.is_none().then_some(why),
            tied_to: (leader != place).then(|| about.parameters[leader].name.to_string()),
            curve: None,
        }
    };
    about.parameters.iter().enumerate().map(parameter).collect()
}

/// Why a fitted parameter inside its bounds has no standard error.
fn why_unseen(about: &About, refit: &Refit, free: usize) -> NoError {
    match &refit.unseen[free] {
        Some(Unseen::Combination { with }) if !with.is_empty() => {
            let name = |&other: &usize| about.parameters[refit.free[other].parameter].name.to_string();
            NoError::OnlyTogether {
                with: with.iter().map(name).collect(),
            }
        }
        _ => NoError::Undetermined,
    }
}

impl Nonlinear {
    /// The fitted model.
    pub(crate) fn bench(&self) -> &Bench {
        &self.bench
    }

    /// Writes the parameters and the result.
    ///
    /// # Errors
    /// Fails if the folder cannot be written to.
    fn write(&self, folder: &Path) -> Result<(), InputError> {
        let values = files::parameters(&self.model, &self.campaign.name, &self.parameters);
        put(folder, "fit.json", &self.json())?;
        put(folder, "parameters.toml", &values)
    }
}
