//! The axle whose metrics are computed: a model with values, its tyre and roads, and the uncertainty of its values.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use qcar_dsl::response::Wanted;
use qcar_runtime::campaign::{Campaign, Role, RoleNames, Test};
use qcar_runtime::metric::{Course, Ground};
use qcar_runtime::response::parameters::Values;
use qcar_runtime::roles::Roles;
use qcar_runtime::simulate::{Cleat, tyre_of};
use qcar_runtime::statics::contradictions;
use qcar_runtime::tyre::Tyre;

use crate::catalogue::{self, Loaded};
use crate::failure::{Failure, flag};
use crate::parameters::{self, FileExtras, Setting, out_of_range};
use crate::roads::{RequestedRoad, check_rolls, courses};
use crate::stability::unstable;
use crate::verbs::fit::{self, Choices, nonlinear};

/// A model with values on its tyre.
pub(crate) struct Subject {
    /// Name as the user gave it.
    pub name: String,
    /// The name or path of its model.
    pub source: String,
    /// The model, ready to run.
    pub model: Loaded,
    /// Values of all parameters.
    pub values: Values,
    /// Masses that a campaign names.
    pub roles: RoleNames,
    /// Vehicle data that are no parameters of the model.
    pub vehicle: BTreeMap<String, f64>,
    /// Notices on its values, as sentences.
    pub notes: Vec<String>,
    /// The tyre and its load, N; `None` without vehicle data.
    pub tyre: Option<(Tyre, f64)>,
    /// The cleat runs of the campaign, else the standard ones; then roads.
    pub courses: Vec<Course>,
    /// Measured runs on the first of these courses; none for the standard ones.
    pub measured: Vec<Cleat>,
    /// Uncertainty of the values.
    pub errors: Errors,
}

/// Standard errors of parameters, by name.
#[derive(Default)]
pub(crate) struct Errors {
    pub deviations: BTreeMap<String, f64>,
    /// Correlations of pairs, in both orders.
    pub correlations: BTreeMap<(String, String), f64>,
}

/// Input of the user besides the subject.
pub(crate) struct SubjectOptions<'a> {
    /// Campaign with start values, vehicle data and cleat runs.
    pub campaign: Option<&'a Path>,
    /// Files with values that take precedence over those.
    pub params: Option<&'a Path>,
    /// Single values that take precedence over those of files.
    pub set: &'a [Setting],
    /// Roads in addition to the cleats.
    pub roads: &'a [RequestedRoad],
}

impl Errors {
    /// Adds correlations, each in both orders.
    fn correlate(&mut self, pairs: impl IntoIterator<Item = ((String, String), f64)>) {
        for ((a, b), value) in pairs {
            self.correlations.insert((a.clone(), b.clone()), value);
            self.correlations.insert((b, a), value);
        }
    }
}

impl Subject {
    /// Reads a subject: a model by name or path, the folder of a campaign, or the results of a fit.
    ///
    /// # Errors
    /// Fails if something cannot be read, compiled, resolved or fitted, if the argument is none of these, or if there
    /// are roads but no tyre.
    pub fn of(text: &str, beneath: &SubjectOptions<'_>) -> Result<Self, Failure> {
        let mut subject = Self::over_cleats(text, beneath)?;
        if !beneath.roads.is_empty() {
            check_rolls(subject.model.about(), &subject.roles, &subject.name)?;
        }
        if subject.tyre.is_none() && !beneath.roads.is_empty() {
            let found = "a road, and no tyre that could roll over it";
            let expected = "r_tire, static_tire_def and static_tire_load";
            let remedy = "give a campaign, or parameter values with [vehicle], or leave the road out";
            return Err(flag(&subject.name, found, expected, remedy).into());
        }
        let roads = courses(beneath.roads, &subject.courses)?;
        subject.courses.extend(roads);
        Ok(subject)
    }

    fn over_cleats(text: &str, beneath: &SubjectOptions<'_>) -> Result<Self, Failure> {
        let path = Path::new(text);
        let answer = answer(path);
        if path.join("campaign.toml").is_file() && !catalogue::is_shipped(text) {
            of_campaign(path, beneath)
        } else if let Some(answer) = answer {
            of_answer(text, &answer, beneath)
        } else if path.is_dir() && !catalogue::is_shipped(text) {
            let found = format!("`{text}`, a folder without campaign.toml or fit.json");
            let expected = "a model, a campaign's folder, or the folder of a fit's results";
            Err(flag(
                "SUBJECT",
                found,
                expected,
                "name a folder that has one of them, or a model",
            )
            .into())
        } else {
            of_model(text, text, &[], beneath)
        }
    }

    /// The ground on which its metrics are computed.
    pub fn ground(&self) -> Ground<'_> {
        Ground::new(&*self.model, &self.values, &self.roles, self.tyre, self.courses.clone())
            .refusing(|p| self.model.check_inertias(p).err().map(|error| error.to_string()))
    }
}

/// The `fit.json` at a path or in a folder.
fn answer(path: &Path) -> Option<PathBuf> {
    let inside = path.join("fit.json");
    let own = path.extension().is_some_and(|ending| ending == "json") && path.is_file();
    inside.is_file().then_some(inside).or(own.then(|| path.into()))
}

fn of_answer(text: &str, answer: &Path, beneath: &SubjectOptions<'_>) -> Result<Subject, Failure> {
    let beside = FileExtras::read(answer)?;
    let Some(model) = beside.model else {
        let expected = "the model that was fitted";
        return Err(flag(
            "SUBJECT",
            format!("`{text}`, which names no model"),
            expected,
            "give the model and --params",
        )
        .into());
    };
    of_model(text, &model, &[answer.to_path_buf()], beneath)
}

fn of_model(name: &str, model: &str, own: &[PathBuf], beneath: &SubjectOptions<'_>) -> Result<Subject, Failure> {
    let (source, model) = (model, catalogue::load(model)?);
    let folder = beneath.campaign.map(|folder| folder.join("campaign.toml"));
    let files: Vec<PathBuf> = folder
        .into_iter()
        .chain(own.to_vec())
        .chain(beneath.params.map(PathBuf::from))
        .collect();
    let campaign = beneath.campaign.map(Campaign::open).transpose()?;
    let values = resolved(&model, &files, campaign.as_ref(), beneath.set)?;
    let (mut facts, mut errors) = (BTreeMap::new(), Errors::default());
    for file in &files {
        let beside = FileExtras::read(file)?;
        facts.extend(beside.vehicle);
        errors.deviations.extend(beside.errors);
        errors.correlate(beside.correlations);
    }
    finish((name, source), model, values, facts, campaign, errors)
}

/// Values of a model from files. If one is the campaign of another model, values that the model lacks are ignored.
fn resolved(
    model: &Loaded,
    files: &[PathBuf],
    campaign: Option<&Campaign>,
    set: &[Setting],
) -> Result<Values, Failure> {
    let paths = files.iter().map(PathBuf::as_path);
    let own = campaign
        .map(|campaign| catalogue::of_campaign(campaign, None, Wanted::Nothing))
        .transpose()?;
    let other = own.filter(|own| own.about().name != model.about().name);
    Ok(match other {
        Some(other) => {
            let [values, _] = parameters::resolve_both([model.about(), other.about()], paths, set)?;
            values
        }
        None => parameters::resolve(model.about(), paths, set)?,
    })
}

/// A campaign: its model, fitted to its rig runs unless the user gives values. Without rig runs it has its start
/// values.
fn of_campaign(folder: &Path, beneath: &SubjectOptions<'_>) -> Result<Subject, Failure> {
    if beneath.campaign.is_some() {
        let remedy = "leave --campaign out, or name its model as SUBJECT";
        return Err(flag("--campaign", "a second campaign", "one campaign", remedy).into());
    }
    let campaign = Campaign::open(folder)?;
    let model = catalogue::named_by(&campaign, None)?;
    let loaded = catalogue::load(&model)?;
    let linear = loaded.about().linear;
    let says = |test: &Test| !linear || matches!(test, Test::Sweep(_) | Test::TimeHistory(_));
    let is_fitted = campaign.runs.iter().any(|run| run.role == Role::Fit && says(&run.test));
    if beneath.params.is_some() || !beneath.set.is_empty() || !is_fitted {
        let beneath = SubjectOptions {
            campaign: Some(folder),
            ..*beneath
        };
        return of_model(&folder.display().to_string(), &model, &[], &beneath);
    }
    let facts = campaign.vehicle.iter().cloned().collect();
    let (values, parameters, pairs) = if fit::is_by_transmissibilities(&campaign, loaded.about(), &Choices::default()) {
        let fitted = fit::fit(folder, &Choices::default())?;
        (fitted.values(), fitted.fit.parameters, fitted.fit.all_correlations)
    } else {
        let fitted = nonlinear::fit(campaign.clone(), &Choices::default())?;
        let (values, pairs) = (fitted.found.explanation.refit.values.clone(), fitted.correlations());
        (values, fitted.parameters, pairs)
    };
    let deviations = parameters.into_iter().filter_map(|own| Some((own.name, own.stderr?)));
    let mut errors = Errors {
        deviations: deviations.collect(),
        ..Errors::default()
    };
    errors.correlate(pairs.into_iter().map(|pair| (pair.between, pair.value)));
    let name = folder.display().to_string();
    finish((&name, &model), loaded, values, facts, Some(campaign), errors)
}

fn finish(
    (name, source): (&str, &str),
    model: Loaded,
    values: Values,
    facts: BTreeMap<String, f64>,
    campaign: Option<Campaign>,
    errors: Errors,
) -> Result<Subject, Failure> {
    model.check_inertias(values.as_slice())?;
    let named = model.about().parameters.iter().zip(values.as_slice());
    let own: BTreeMap<&str, f64> = named.map(|(own, value)| (&*own.name, *value)).collect();
    let fact = |name: &str| facts.get(name).or_else(|| own.get(name)).copied();
    // Without any of these facts nothing rolls; with some of them, the others were forgotten.
    let beyond: BTreeMap<String, f64> = facts
        .iter()
        .filter(|(name, _)| !own.contains_key(name.as_str()))
        .map(|(name, value)| (name.clone(), *value))
        .collect();
    let mut notes = out_of_range(model.about(), values.as_slice());
    notes.extend(unstable(&*model, &values));
    notes.extend(campaign.iter().flat_map(|own| contradictions(model.about(), own)));
    let roles = campaign
        .as_ref()
        .map_or_else(RoleNames::default, |own| own.roles.clone());
    let rolls = Roles::of(model.about(), &roles).is_ok();
    let tyre = match (fact("r_tire"), fact("static_tire_def")) {
        (None, _) | (_, None) => None,
        _ if !rolls => None,
        _ => Some(tyre_of(&fact, Path::new("[vehicle]"))?),
    };
    let measured = match (&tyre, &campaign) {
        (Some(_), Some(campaign)) => cleats(campaign)?,
        _ => Vec::new(),
    };
    let courses = match &tyre {
        Some(_) if measured.is_empty() => Course::standard().expect("the standard cleats are roads"),
        _ => measured.iter().map(Course::measured).collect(),
    };
    Ok(Subject {
        name: name.into(),
        source: source.into(),
        model,
        values,
        vehicle: beyond,
        notes,
        roles,
        tyre,
        courses,
        measured,
        errors,
    })
}

fn cleats(campaign: &Campaign) -> Result<Vec<Cleat>, Failure> {
    let mut cleats = Vec::new();
    for run in &campaign.runs {
        cleats.extend(Cleat::read(campaign, run)?);
    }
    Ok(cleats)
}
