//! `qcar fit`: the parameters of a model from the rig runs of a campaign.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use clap_complete::engine::ArgValueCompleter;
use nalgebra::Complex;
use qcar_dsl::check::Unseen;
use qcar_dsl::response::Wanted;
use qcar_runtime::campaign::{Campaign, Role, Run, Test};
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::fit::bootstrap::Bootstrap;
use qcar_runtime::fit::measure::levels;
use qcar_runtime::fit::observation::{Observation, outputs};
use qcar_runtime::fit::profile::ParameterProfile;
use qcar_runtime::fit::report::ParameterFit;
use qcar_runtime::fit::{Fit, Level, Plan, Setup};
use qcar_runtime::model::{About, Model};
use qcar_runtime::progress::OnProgress;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::spelling;
use qcar_runtime::statics::contradictions;
use qcar_runtime::transmissibility::Options;

use crate::catalogue::{self, Loaded};
use crate::completion;
use crate::failure::{Failure, flag};
use crate::files::folder_for_results;
use crate::parameters::{bound, out_of_range, own};
use crate::progress::while_counting;
use crate::results::Results;
use crate::terminal::prose;
use crate::verbs::{Format, each_once};

// Parameters that only a K&C curve determines.
mod from_kc;
// The distinct minima as text.
mod minima;
// Notes and warnings about a fit.
mod notices;
// The result as text and JSON.
pub(crate) mod render;
// The result as files.
pub(crate) mod files;
// The result as a workbook.
pub(crate) mod workbook;
// The fit of a nonlinear model.
pub(crate) mod nonlinear;
// Transmissibilities beside such a fit.
mod records;

/// Fit a model to the sweeps and time histories of a campaign
///
/// A linear model is fitted to transmissibilities, with all levels in one cost. A nonlinear model is fitted to all runs
/// that it predicts, including cleats, K&C curves and dynamometer tables: to the first three harmonics of sweeps by
/// harmonic balance, and to records sample by sample, each with its own uncertainty. `--all-runs` fits a linear model
/// in this way. Without that flag a linear model is fitted so only if the campaign has time histories but no sweeps to
/// fit, and neither `--channels` nor `--bootstrap` asks for transmissibilities. Runs with the role `fit` are fitted;
/// `held_out` runs are only compared. The fit estimates the parameters with `fit = true` in the campaign. It also
/// estimates those that the campaign does not name, if the model gives a default and a range and does not call them
/// `known`. A parameter that no fitted channel depends on takes its value from the K&C curve that determines it, if the
/// campaign has one. The exit status is 1 if the search does not end at a minimum, or if every parameter ends at a
/// bound of its range.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar fit models/campaigns/axle_a_rig --out fitted\n  qcar fit models/campaigns/axle_a_rig --starts 4 --fix c_tire --channels pad_to_wheel,wheel_to_body\n  qcar fit models/campaigns/axle_a_rig --profile k_tire,c_tire\n  qcar fit models/campaigns/axle_a_rig --bootstrap 1000\n  qcar fit models/campaigns/silverbox --format json"
)]
pub struct Arguments {
    /// Folder with a campaign.toml
    campaign: PathBuf,
    #[command(flatten)]
    choices: Choices,
    /// Write parameters.toml, fit.json and, for a linear model, transmissibility.csv, transmissibility.svg and
    /// results.xlsx into this folder
    #[arg(long, value_name = "DIR", value_parser = folder_for_results)]
    out: Option<PathBuf>,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// Choices that differ from the plan of the campaign.
#[derive(Args, Default)]
pub struct Choices {
    /// Fit this model, by name or path, instead of the campaign's
    #[arg(long, add = ArgValueCompleter::new(completion::models))]
    pub model: Option<String>,
    /// Number of searches: the first from the campaign's start values, the others from random points in the ranges
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=10_000))]
    pub starts: Option<u16>,
    /// Fit to these channels, such as pad_to_wheel, instead of those across the model's force elements
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub channels: Vec<String>,
    /// Fit these parameters too
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub free: Vec<String>,
    /// Keep these parameters at their start values
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub fix: Vec<String>,
    /// Fit a linear model like a nonlinear one: to all runs, each with its own uncertainty
    #[arg(long)]
    pub all_runs: bool,
    /// Also find intervals of these parameters by profile likelihood; `all` for every fitted one
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub profile: Vec<String>,
    /// Also find intervals by fitting a linear model again to N resamples of what was measured
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(100..=1_000_000))]
    pub bootstrap: Option<u32>,
}

impl Choices {
    /// The plan of the campaign, for this model or for that of the campaign.
    pub fn of_model(model: Option<&str>) -> Self {
        Choices {
            model: model.map(String::from),
            ..Choices::default()
        }
    }
}

/// The files of a fit.
pub(crate) const RESULTS: Results = Results {
    record: "fit.json",
    names: ["/model", "/campaign"],
    between: "fitted to",
    files: &[
        "parameters.toml",
        "transmissibility.csv",
        "transmissibility.svg",
        workbook::FILE,
    ],
};

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let campaign = Campaign::open(&arguments.campaign)?;
    let model = catalogue::of_campaign(&campaign, arguments.choices.model.as_deref(), Wanted::Values)?;
    if let Some(folder) = &arguments.out {
        RESULTS.check(folder, [&model.about().name, &campaign.name], None)?;
    }
    if !is_by_transmissibilities(&campaign, model.about(), &arguments.choices) {
        return nonlinear::run(campaign, arguments);
    }
    let fitted = fit(&arguments.campaign, &arguments.choices)?;
    if let Some(folder) = &arguments.out {
        files::write(&fitted, folder)?;
        workbook::write(&fitted, folder)?;
    }
    let result = match arguments.format {
        Format::Text => prose(&render::text(&fitted)),
        Format::Json => render::json(&fitted),
    };
    if fitted.fit.converged && notices::all_at_bounds(&fitted.fit).is_none() {
        Ok(result)
    } else {
        Err(Failure::Finding(result))
    }
}

/// True for a linear model that is fitted to its transmissibilities. Time histories alone are compared sample by
/// sample, unless something is requested that only the cost of transmissibilities has.
pub(crate) fn is_by_transmissibilities(campaign: &Campaign, about: &About, choices: &Choices) -> bool {
    let fitted = || campaign.runs.iter().filter(|run| run.role == Role::Fit);
    let only_records = fitted().any(|run| matches!(run.test, Test::TimeHistory(_)))
        && !fitted().any(|run| matches!(run.test, Test::Sweep(_)));
    let of_channels = !choices.channels.is_empty() || choices.bootstrap.is_some();
    about.linear && !choices.all_runs && (of_channels || !only_records)
}

/// A campaign, the model that was fitted to it, and the result.
pub struct Fitted {
    /// The campaign.
    pub campaign: Campaign,
    /// The fitted model; if it is a file, with derivatives of the measured signals only.
    pub model: Loaded,
    /// The measured ratios.
    pub levels: Vec<Level>,
    /// The result.
    pub fit: Fit,
    /// Profiles of the requested parameters.
    pub profiles: Vec<ParameterProfile>,
    /// Results of fits to resamples; `None` if they were not requested.
    pub bootstrap: Option<Bootstrap>,
    /// Number of other minima of a fit to all runs as they are; `None` without a search, and for a fit to
    /// transmissibilities, which lists its minima itself.
    pub other_minima: Option<usize>,
    /// Duration of reading, estimating and fitting, s.
    pub seconds: f64,
}

/// A measured ratio beside that of the fitted model, line by line.
pub struct Ratio<'a> {
    /// File of the run.
    pub run: &'a str,
    /// Role of the run.
    pub role: Role,
    /// Measured values.
    pub observation: &'a Observation,
    /// Values of the fitted model.
    pub fitted: Vec<Complex<f64>>,
}

impl Fitted {
    /// The result as JSON, see `docs/json.md`.
    pub fn json(&self) -> String {
        render::json(self)
    }

    /// Measured and modelled ratios of the first run, as SVG.
    pub fn figure(&self) -> String {
        files::figure(self, &files::compare(self)).svg()
    }

    /// Every measured ratio, fitted or not.
    pub fn ratios(&self) -> Vec<Ratio<'_>> {
        let compared = files::compare(self).into_iter();
        let ratios = compared.map(|own| Ratio {
            run: &own.level.name,
            role: own.level.role,
            observation: own.observation,
            fitted: own.after,
        });
        ratios.collect()
    }

    /// The parameters before the fit.
    pub fn start(&self) -> Values {
        self.with(|parameter| parameter.start)
    }

    /// The fitted parameters.
    pub fn values(&self) -> Values {
        self.with(|parameter| parameter.value)
    }

    /// The plan of a fit that starts at the result of this one.
    ///
    /// # Errors
    /// Fails if the choices are invalid.
    pub(crate) fn as_plan(&self, choices: &Choices) -> Result<Plan, InputError> {
        let mut plan = plan(&self.campaign, self.model.about(), choices)?;
        for own in &mut plan.parameters {
            let found = self.fit.parameters.iter().find(|found| found.name == own.name);
            own.value = found.map_or(own.value, |found| found.value);
        }
        Ok(plan)
    }

    fn with(&self, value: fn(&ParameterFit) -> f64) -> Values {
        let stated = self
            .fit
            .parameters
            .iter()
            .filter(|parameter| parameter.tied_to.is_none());
        let given = stated
            .map(|parameter| (parameter.name.clone(), value(parameter)))
            .collect();
        Values::resolve(self.model.about(), &given, &BTreeMap::new())
            .expect("the fit has given every parameter a value")
    }
}

/// Reads a campaign, fits a model to it as `qcar fit` does, and compares the transmissibilities.
///
/// # Errors
/// Fails if something cannot be read, or if the campaign has no data for the model.
pub fn fit(folder: &std::path::Path, choices: &Choices) -> Result<Fitted, Failure> {
    let begun = Instant::now();
    let mut campaign = Campaign::open(folder)?;
    let model = catalogue::of_campaign(&campaign, choices.model.as_deref(), Wanted::Values)?;
    let plan = plan(&campaign, model.about(), choices)?;
    let of_all_runs = records::fit(&campaign, model.about(), choices)?;
    let plan = match &of_all_runs {
        Some(found) => records::known(plan, found),
        None => plan,
    };
    let has_more = of_all_runs.is_none() && campaign.runs.iter().any(is_beyond_sweeps);
    refuse_unseen(&model, &plan, has_more)?;
    let levels = match &of_all_runs {
        Some(found) if !found.is_driven() => Vec::new(),
        _ => measure(&campaign, model.about(), choices)?,
    };
    let measured = outputs(model.about(), &levels);
    let wanted = Wanted::JacobianOf(&measured);
    let model = catalogue::of_campaign(&campaign, choices.model.as_deref(), wanted)?;
    let setup = Setup::new(&*model, &plan, &levels)?;
    model.check_inertias(setup.values())?;
    campaign.notices.extend(notices::silent_runs(&campaign, &levels));
    if of_all_runs.is_none() {
        campaign.notices.extend(notices::unused_runs(&campaign, &levels));
    }
    campaign.notices.extend(out_of_range(model.about(), setup.values()));
    let contradictions = contradictions(model.about(), &campaign);
    campaign.notices.extend(contradictions);
    let profiled = match of_all_runs {
        Some(_) => Vec::new(),
        None => profiled(&plan, model.about(), setup.free(), &choices.profile)?,
    };
    let searches = format!("{}: fitting {}, search", campaign.name, model.about().name);
    let fit = while_counting(searches, |on_progress| setup.fit_with_progress(on_progress));
    let profiles = profiles(&setup, &fit, &profiled, &campaign.name);
    let bootstrap = bootstrap(&setup, &fit, choices.bootstrap, &campaign.name);
    let mut fitted = Fitted {
        seconds: begun.elapsed().as_secs_f64(),
        campaign,
        model,
        levels,
        fit,
        profiles,
        bootstrap,
        other_minima: None,
    };
    match of_all_runs {
        Some(found) => records::take_over(&mut fitted, found),
        None => from_kc::take_over(&mut fitted)?,
    }
    if has_more {
        fitted.campaign.notices.extend(notices::in_combination(&fitted.fit));
    }
    fitted.campaign.notices.extend(notices::all_at_bounds(&fitted.fit));
    Ok(fitted)
}

/// Checks that the runs of a campaign can be fitted to its model, as a fit does before it searches. A campaign without
/// a run to fit is not refused: it serves other verbs.
///
/// # Errors
/// Fails as the fit does.
pub(crate) fn check(campaign: &Campaign, model: &Loaded) -> Result<(), Failure> {
    let (about, choices) = (model.about(), Choices::default());
    if !is_by_transmissibilities(campaign, about, &choices) {
        return nonlinear::check(campaign, about, &choices);
    }
    let is_measured = |run: &Run| matches!(run.test, Test::Sweep(_) | Test::TimeHistory(_));
    let mut fitted = campaign.runs.iter().filter(|run| run.role == Role::Fit);
    if !fitted.any(is_measured) {
        return Ok(());
    }
    let plan = plan(campaign, about, &choices)?;
    refuse_unseen(model, &plan, campaign.runs.iter().any(is_beyond_sweeps))?;
    let levels = measure(campaign, about, &choices)?;
    let setup = Setup::new(&**model, &plan, &levels)?;
    Ok(model.check_inertias(setup.values())?)
}

/// The measured ratios of all runs.
fn measure(campaign: &Campaign, about: &About, choices: &Choices) -> Result<Vec<Level>, InputError> {
    let channels = each_once(choices.channels.iter().cloned());
    let wanted = (!channels.is_empty()).then_some(channels.as_slice());
    while_counting(format!("{}: transmissibilities of run", campaign.name), |on_progress| {
        levels(campaign, about, wanted, &Options::default(), on_progress)
    })
}

/// Fits to resamples, if they are requested and the fit has a minimum.
fn bootstrap(
    setup: &Setup<'_, dyn Model + '_>,
    fit: &Fit,
    resamples: Option<u32>,
    campaign: &str,
) -> Option<Bootstrap> {
    let resamples = resamples.filter(|_| fit.converged)?;
    let repeat = |on_progress: OnProgress<'_>| setup.bootstrap(fit, resamples as usize, on_progress);
    Some(while_counting(format!("{campaign}: bootstrap, fit"), repeat))
}

/// Names of the parameters to profile.
///
/// # Errors
/// Fails if a name is not that of a fitted parameter.
fn profiled(plan: &Plan, about: &About, free: &[usize], names: &[String]) -> Result<Vec<String>, InputError> {
    let fitted = || free.iter().map(|&place| &*about.parameters[place].name);
    if names.iter().any(|name| name == "all") {
        return Ok(fitted().map(String::from).collect());
    }
    let problem = |name: &String| {
        let unseen = plan.parameters.iter().any(|own| own.fit && own.name == *name);
        let expected = "a parameter that is fitted, or `all`";
        let (found, remedy) = match unseen {
            true => (
                format!("`{name}`, on which no fitted channel depends"),
                "leave it out".into(),
            ),
            false => (format!("`{name}`"), spelling::remedy(name, fitted())),
        };
        flag("--profile", found, expected, &remedy)
    };
    let unknown = names.iter().filter(|name| fitted().all(|own| own != *name));
    InputError::unless_empty(unknown.map(problem).collect(), Some(names.to_vec()))
}

fn profiles(setup: &Setup<'_, dyn Model + '_>, fit: &Fit, names: &[String], campaign: &str) -> Vec<ParameterProfile> {
    if names.is_empty() || !fit.converged {
        return Vec::new();
    }
    while_counting(format!("{campaign}: profile"), |on_progress| {
        setup.profiles(fit, names, on_progress)
    })
}

/// True for a fitted run that a fit to transmissibilities does not use.
fn is_beyond_sweeps(run: &Run) -> bool {
    run.role == Role::Fit && !matches!(run.test, Test::Sweep(_))
}

/// `has_more` tells that further runs may determine them. A parameter on which no output depends keeps its start value,
/// or takes that of a K&C curve.
///
/// # Errors
/// Fails if the outputs determine only combinations of parameters that are to be fitted together.
fn refuse_unseen(model: &Loaded, plan: &Plan, has_more: bool) -> Result<(), InputError> {
    let known = "set `fit = false` for those that are known from elsewhere, or name them with --fix";
    let remedy = match has_more {
        true => format!("fit all runs of the campaign with --all-runs, {known}"),
        false => known.into(),
    };
    let is_fitted = |name: &&String| plan.parameters.iter().any(|own| own.fit && own.name == **name);
    let problem = |unseen: &Unseen| {
        let fitted: Vec<String> = unseen
            .parameters
            .iter()
            .filter(is_fitted)
            .map(|name| format!("`{name}`"))
            .collect();
        let wrong = || {
            Problem::new(
                format!("model {}", model.about().name),
                Place::Name("parameters".into()),
                format!(
                    "{}, of which its outputs determine {} combinations",
                    fitted.join(", "),
                    unseen.seen
                ),
                "parameters that the outputs can distinguish",
                remedy.clone(),
            )
        };
        (unseen.seen > 0 && fitted.len() > unseen.seen).then(wrong)
    };
    InputError::unless_empty(model.unseen().iter().filter_map(problem).collect(), Some(()))
}

/// The plan of the campaign with further parameters of the model, the choices of the user, and a range for every fitted
/// parameter.
fn plan(campaign: &Campaign, about: &About, choices: &Choices) -> Result<Plan, InputError> {
    let mut plan = Plan::new(campaign);
    plan.parameters.extend(own(about, campaign));
    plan.starts = choices.starts.map_or(plan.starts, usize::from);
    let mut problems = Vec::new();
    for (name, fit) in choices
        .free
        .iter()
        .map(|name| (name, true))
        .chain(choices.fix.iter().map(|name| (name, false)))
    {
        match plan.parameters.iter_mut().find(|parameter| parameter.name == *name) {
            Some(parameter) => parameter.fit = fit,
            None => {
                let remedy = spelling::choice(name, plan.parameters.iter().map(|own| own.name.as_str()));
                let found = format!("`{name}`");
                let name = if fit { "--free" } else { "--fix" };
                problems.push(flag(name, found, "a parameter that may be fitted", &remedy));
            }
        }
    }
    let both = choices.free.iter().filter(|name| choices.fix.contains(name));
    problems.extend(both.map(|name| {
        let remedy = "leave one of them out";
        flag(
            "--free",
            format!("`{name}`, which --fix names too"),
            "a parameter in one of them",
            remedy,
        )
    }));
    InputError::unless_empty(problems, Some(()))?;
    bound(&mut plan.parameters, about, campaign)?;
    Ok(plan)
}
