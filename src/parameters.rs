//! Parameter values from files, from `--set`, and from the defaults of the model.

// Values in a parameter file.
mod file;
// Values in the results of a fit.
mod fitted;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use qcar_runtime::campaign::{self, Campaign, Declared, FACTS, examples};
use qcar_runtime::ensemble::Posterior;
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::model::{self, About, Default};
use qcar_runtime::response::parameters::{ParameterError, Values};
use qcar_runtime::roles::{RoleError, Roles};
use qcar_runtime::shown::six_digits;
use qcar_runtime::spelling;
use qcar_runtime::statics::contradictions;

use crate::failure;
use crate::sensors;
use crate::units;
use file::{ParameterFile, numbers};
use fitted::Answer;

/// `name=value` of `--set`; the value may have a unit.
#[derive(Clone, Debug)]
pub struct Setting {
    name: String,
    /// Value, SI.
    value: f64,
    /// The unit as written, if it has one.
    unit: Option<Declared>,
}

impl Setting {
    /// A value in SI.
    pub fn new(name: &str, value: f64) -> Self {
        Setting {
            name: name.into(),
            value,
            unit: None,
        }
    }
}

impl FromStr for Setting {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let named = text.split_once('=').filter(|(name, _)| !name.trim().is_empty());
        let (name, value) = named.ok_or("expected name=value, such as k_tm=6e5")?;
        let number = value.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        let quantity = || Declared::quantity(value).map(|(value, unit)| (value, Some(unit)));
        let (value, unit) = number.map(|value| (value, None)).or_else(quantity).ok_or_else(|| {
            format!("expected a number after `=`, and perhaps its unit such as N/mm, found `{value}`")
        })?;
        Ok(Setting {
            name: name.trim().into(),
            value,
            unit,
        })
    }
}

/// The value of every parameter of a model. Values of `settings` take precedence over those of `paths`, later paths
/// over earlier ones, and all of them over defaults.
///
/// # Errors
/// Fails with all errors at once: a file that cannot be read, a name that the model lacks, another unit, or a parameter
/// without a value.
pub fn resolve<'a>(
    about: &About,
    paths: impl IntoIterator<Item = &'a Path>,
    settings: &[Setting],
) -> Result<Values, InputError> {
    resolved(about, overlaid(paths)?, settings)
}

fn resolved(about: &About, file: ParameterFile, settings: &[Setting]) -> Result<Values, InputError> {
    let mut problems = misused(about, &file, settings);
    let resolved = Values::resolve(about, &with(&file, settings), &numbers(&file.vehicle));
    let values = resolved.map_err(|errors| problems.extend(errors.iter().map(|error| problem(error, &file))));
    InputError::unless_empty(problems, values.ok())
}

/// The values that a file and settings give parameters of a model, and the vehicle data of the file.
///
/// # Errors
/// Fails as [`resolve`] does, but parameters may have no value.
pub fn stated(about: &About, path: Option<&Path>, settings: &[Setting]) -> Result<BTreeMap<String, f64>, InputError> {
    let file = overlaid(path)?;
    let mut problems = misused(about, &file, settings);
    let (vehicle, given) = (numbers(&file.vehicle), with(&file, settings));
    let errors = Values::resolve(about, &given, &vehicle).err().unwrap_or_default();
    let wrong = errors
        .iter()
        .filter(|error| !matches!(error, ParameterError::Missing { .. }));
    problems.extend(wrong.map(|error| problem(error, &file)));
    InputError::unless_empty(problems, Some(vehicle.into_iter().chain(given).collect()))
}

/// The values of parameters in a file, and those of settings, which take precedence.
fn with(file: &ParameterFile, settings: &[Setting]) -> BTreeMap<String, f64> {
    let mut given = numbers(&file.parameters);
    given.extend(settings.iter().map(|setting| (setting.name.clone(), setting.value)));
    given
}

/// Problems besides names that the model lacks: units of another kind, settings that contradict each other, and unknown
/// vehicle data.
fn misused(about: &About, file: &ParameterFile, settings: &[Setting]) -> Vec<Problem> {
    let mut problems = wrong_units(about, file);
    problems.extend(wrong_settings(about, settings));
    problems.extend(set_twice(settings));
    problems.extend(unknown_facts(about, file));
    problems
}

/// Checks that the vehicle data of a campaign are used, that its roles name masses of the model, and that its sensors
/// have the units of the model.
///
/// # Errors
/// Fails with every key of its `[vehicle]` that is neither one of [`FACTS`] nor a parameter of the model, with a name in
/// its `[roles]` that is no mass on the axis of the tyre, and with a sensor whose unit is of another kind.
pub fn check_campaign(about: &About, campaign: &Campaign) -> Result<(), InputError> {
    let file = ParameterFile::read(&campaign.manifest())?;
    let mut problems = unknown_facts(about, &file);
    problems.extend(sensors::of_other_units(about, campaign));
    if let Err(RoleError::NoSuchMass { name, axis, masses, .. }) = Roles::of(about, &campaign.roles) {
        let (place, found) = (Place::Name("roles".into()), format!("`{name}`"));
        let expected = format!("a mass of model `{}` along {axis}", about.name);
        let remedy = format!("write one of {}", masses.join(", "));
        problems.push(Problem::new(campaign.manifest(), place, found, expected, remedy));
    }
    InputError::unless_empty(problems, Some(()))
}

/// The same for two models: a name must be that of a parameter of one of them.
///
/// # Errors
/// Fails as [`resolve`] does.
pub fn resolve_both<'a>(
    abouts: [&About; 2],
    paths: impl IntoIterator<Item = &'a Path> + Clone,
    settings: &[Setting],
) -> Result<[Values; 2], InputError> {
    let knows = |about: &About, name: &str| about.parameters.iter().any(|parameter| parameter.name == *name);
    let one = |own: &About, other: &About| {
        let concerns = |name: &str| knows(own, name) || !knows(other, name);
        let mut file = overlaid(paths.clone())?;
        file.parameters.retain(|name, _| concerns(name));
        let settings: Vec<Setting> = settings.iter().filter(|own| concerns(&own.name)).cloned().collect();
        resolved(own, file, &settings)
    };
    Ok([one(abouts[0], abouts[1])?, one(abouts[1], abouts[0])?])
}

/// Contents of a parameter file besides the values.
pub struct FileExtras {
    /// Name of the model to which they were fitted.
    pub model: Option<String>,
    /// Standard errors, if the file has them.
    pub errors: BTreeMap<String, f64>,
    /// Correlations of pairs.
    pub correlations: Vec<((String, String), f64)>,
    /// Vehicle data.
    pub vehicle: BTreeMap<String, f64>,
}

impl FileExtras {
    /// Reads a parameter file.
    ///
    /// # Errors
    /// Fails if the file cannot be read.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let file = read(path)?;
        let errors = file.parameters.iter();
        let answer = is_answer(path).then(|| Answer::read(path)).transpose()?;
        Ok(FileExtras {
            correlations: answer.as_ref().map_or(Vec::new(), Answer::correlations),
            model: answer.map(|answer| answer.model),
            errors: errors
                .filter_map(|(name, own)| Some((name.clone(), own.stderr?)))
                .collect(),
            vehicle: numbers(&file.vehicle),
        })
    }
}

/// The distribution of the estimates of a fit, and the name of its model.
///
/// # Errors
/// Fails if the file cannot be read, is not the result of `qcar fit`, or gives no distribution.
pub fn posterior(path: &Path) -> Result<(Posterior, String), InputError> {
    let answer = Answer::read(path)?;
    Ok((answer.posterior(path)?, answer.model))
}

fn overlaid<'a>(paths: impl IntoIterator<Item = &'a Path>) -> Result<ParameterFile, InputError> {
    let mut file = ParameterFile::default();
    for path in paths {
        file.overlay(read(path)?);
    }
    Ok(file)
}

fn read(path: &Path) -> Result<ParameterFile, InputError> {
    if is_answer(path) {
        Ok(Answer::read(path)?.parameters(path))
    } else {
        ParameterFile::read(path)
    }
}

/// The result of a fit is JSON.
fn is_answer(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "json")
}

/// A sentence for each value `p` outside the plausible range of the model, most often because of its unit.
pub fn out_of_range(about: &About, p: &[f64]) -> Vec<String> {
    beyond_ranges(about, about.parameters.iter().zip(p.iter().copied()))
}

/// The same for parameters of which some have no value: those in `stated`, by name.
pub fn stated_out_of_range(about: &About, stated: &BTreeMap<String, f64>) -> Vec<String> {
    let known = about.parameters.iter();
    let known = known.filter_map(|own| Some((own, *stated.get(&*own.name)?)));
    beyond_ranges(about, known)
}

/// The same for the values of a campaign, and for vehicle data that contradict each other.
pub fn campaign_out_of_range(about: &About, campaign: &Campaign) -> Vec<String> {
    let start = campaign.parameters.iter().map(|own| (own.name.clone(), own.value));
    let stated = campaign.vehicle.iter().cloned().chain(start).collect();
    let mut sentences = stated_out_of_range(about, &stated);
    sentences.extend(contradictions(about, campaign));
    sentences
}

fn beyond_ranges<'a>(about: &'a About, values: impl Iterator<Item = (&'a model::Parameter, f64)>) -> Vec<String> {
    let beyond = values.filter_map(|(parameter, value)| {
        let (low, high) = parameter.range?;
        let (name, model) = (&parameter.name, &about.name);
        let [value_shown, range] = [&[value][..], &[low, high]].map(|values| quoted(values, &parameter.unit, None));
        let sentence = format!("{name} = {value_shown} is outside {range}, the plausible range of model {model}");
        (!(low..=high).contains(&value)).then_some(sentence)
    });
    beyond.collect()
}

/// Checks that settings are in the ranges of the model, for results that outlive the command.
///
/// # Errors
/// Fails with every setting outside.
pub fn require_in_range(about: &About, settings: &[Setting]) -> Result<(), InputError> {
    let outside = settings.iter().filter_map(|own| {
        let parameter = about.parameters.iter().find(|parameter| *parameter.name == own.name)?;
        let (low, high) = parameter
            .range
            .filter(|(low, high)| !(*low..=*high).contains(&own.value))?;
        let name = format!("--set {}", own.name);
        let [found, range] =
            [&[own.value][..], &[low, high]].map(|values| quoted(values, &parameter.unit, own.unit.as_ref()));
        let expected = format!("a value from {range}, for which the model is declared");
        let remedy = "correct the value or its unit, or change `range` in the model";
        Some(failure::flag(&name, found, &expected, remedy))
    });
    InputError::unless_empty(outside.collect(), Some(()))
}

/// A value in the SI unit `si`, or the ends of a range, with the unit, as messages show them: in the unit in which the
/// user wrote a value, otherwise in the shown one.
pub fn quoted(values: &[f64], si: &str, written: Option<&Declared>) -> String {
    let (unit, numbers): (Cow<'_, str>, Vec<f64>) = match written {
        Some(own) => (
            own.written.as_str().into(),
            values.iter().map(|value| own.shown(*value)).collect(),
        ),
        None => (
            units::name(si),
            values.iter().map(|value| units::value(*value, si)).collect(),
        ),
    };
    let numbers: Vec<String> = numbers
        .into_iter()
        .map(|number| six_digits(number).to_string())
        .collect();
    match &*unit {
        "1" | "" => numbers.join(" to "),
        unit => format!("{} {unit}", numbers.join(" to ")),
    }
}

/// Parameters of the model that are estimated although the campaign does not mention them: those with a default and a
/// range that are not `known`.
pub fn own(about: &About, campaign: &Campaign) -> Vec<campaign::Parameter> {
    let is_given = |name: &str| campaign.parameter(name).is_some() || campaign.vehicle(name).is_some();
    let open = about.parameters.iter().filter(|own| !own.known && !is_given(&own.name));
    let parameter = |own: &model::Parameter| match own.default {
        Default::Value(value) => Some(campaign::Parameter {
            name: own.name.to_string(),
            value,
            unit: own.unit.to_string(),
            range: Some(own.range?),
            fit: true,
            comment: "the default of the model".into(),
        }),
        Default::None | Default::Same(_) => None,
    };
    open.filter_map(parameter).collect()
}

/// Gives every parameter to fit without a range that of the model.
///
/// # Errors
/// Fails if the model has no range either, or if the start value is outside it. An estimate needs bounds, and a
/// parameter to fit must not silently keep its start value.
pub fn bound(parameters: &mut [campaign::Parameter], about: &About, campaign: &Campaign) -> Result<(), InputError> {
    let file = ParameterFile::read(&campaign.manifest())?;
    let mut problems = Vec::new();
    for own in parameters.iter_mut().filter(|own| own.fit && own.range.is_none()) {
        let Some(of_model) = about.parameters.iter().find(|p| p.name == own.name) else {
            continue;
        };
        let expected = match of_model.range {
            None => "`range = [lower, upper]`, because the model gives none".into(),
            Some((low, high)) if !(low..=high).contains(&own.value) => {
                let range = quoted(&[low, high], &of_model.unit, None);
                format!("`range = [lower, upper]`, or a value from {range}, the range of the model")
            }
            Some(range) => {
                own.range = Some(range);
                continue;
            }
        };
        let place = file
            .parameters
            .get(&own.name)
            .map_or(Place::File, |own| own.place.clone());
        let start = quoted(&[own.value], &own.unit, None);
        let found = format!("`fit = true` without a range, from {start} on");
        let remedy = format!("add the range to [parameters.{}], or write `fit = false`", own.name);
        problems.push(Problem::new(campaign.manifest(), place, found, expected, remedy));
    }
    InputError::unless_empty(problems, Some(()))
}

/// Checks that constants computed from the parameter values of the model `model` are finite.
///
/// # Errors
/// Fails if one is not finite.
pub fn require_finite<'a>(model: &str, mut computed: impl Iterator<Item = &'a f64>) -> Result<(), InputError> {
    match computed.find(|value| !value.is_finite()) {
        None => Ok(()),
        Some(value) => {
            let (place, found) = (Place::Name("parameters".into()), format!("a result that is {value}"));
            let remedy = "correct the values, of which one is too large or makes the model divide by zero";
            let expected = "parameter values that give finite numbers";
            Err(Problem::new(format!("model {model}"), place, found, expected, remedy).into())
        }
    }
}

/// The values of a file, for any model.
///
/// # Errors
/// Fails if the file cannot be read.
pub fn given(path: &Path) -> Result<BTreeMap<String, f64>, InputError> {
    let file = read(path)?;
    let mut values = numbers(&file.vehicle);
    values.extend(numbers(&file.parameters));
    Ok(values)
}

/// A problem at the parameter in its file, or on the command line.
fn problem(error: &ParameterError, file: &ParameterFile) -> Problem {
    let of_file = error.problem(&file.path);
    if let Some(stated) = file.parameters.get(error.name()) {
        return Problem {
            file: stated.file.clone(),
            place: stated.place.clone(),
            ..of_file
        };
    }
    if let Some((workbook, place)) = file.blanks.get(error.name()) {
        return Problem {
            file: workbook.clone(),
            place: place.clone(),
            remedy: "fill in the cell, with its unit to the right".into(),
            ..of_file
        };
    }
    match error {
        ParameterError::Missing { name, .. } if file.path.as_os_str().is_empty() => Problem {
            file: PathBuf::from("command line"),
            remedy: format!("name a file with --params, or add --set {name}=…"),
            ..of_file
        },
        ParameterError::Missing { .. } => of_file,
        ParameterError::Unknown { name, .. } | ParameterError::NotFinite { name, .. } => Problem {
            file: PathBuf::from("command line"),
            place: Place::Name(format!("--set {name}")),
            ..of_file
        },
    }
}

fn wrong_units(about: &About, file: &ParameterFile) -> Vec<Problem> {
    let declared = about.parameters.iter().filter_map(|parameter| {
        let stated = [&file.parameters, &file.vehicle]
            .into_iter()
            .find_map(|own| own.get(&*parameter.name))?;
        Some((parameter, stated, stated.unit.as_ref()?))
    });
    let wrong = declared.filter(|(parameter, _, unit)| !is_like(unit, &parameter.unit));
    wrong
        .map(|(parameter, stated, unit)| {
            let (found, expected) = (format!("the unit \"{unit}\""), examples(&parameter.unit));
            let remedy = "declare the unit in which the value is";
            Problem::new(&stated.file, stated.place.clone(), found, expected, remedy)
        })
        .collect()
}

/// True if a unit as written is of the kind of another.
fn is_like(written: &str, unit: &str) -> bool {
    Declared::of(written).is_some_and(|own| own.is_like(unit))
}

fn wrong_settings(about: &About, settings: &[Setting]) -> Vec<Problem> {
    let declared = settings.iter().filter_map(|own| {
        let parameter = about.parameters.iter().find(|parameter| *parameter.name == own.name)?;
        Some((parameter, own, own.unit.as_ref()?))
    });
    let wrong = declared.filter(|(parameter, _, unit)| !unit.is_like(&parameter.unit));
    wrong
        .map(|(parameter, own, unit)| {
            let (name, found) = (
                format!("--set {}", own.name),
                format!("a value in \"{}\"", unit.written),
            );
            let remedy = "correct the unit, or leave it out for a value in SI";
            failure::flag(&name, found, &examples(&parameter.unit), remedy)
        })
        .collect()
}

/// Settings of a name that an earlier one has.
fn set_twice(settings: &[Setting]) -> Vec<Problem> {
    let is_second = |(at, own): &(usize, &Setting)| settings[..*at].iter().any(|other| other.name == own.name);
    let twice = settings.iter().enumerate().filter(is_second);
    twice
        .map(|(_, own)| {
            let name = format!("--set {}", own.name);
            failure::flag(
                &name,
                "a second value",
                "one value for each name",
                "leave one of them out",
            )
        })
        .collect()
}

fn unknown_facts(about: &About, file: &ParameterFile) -> Vec<Problem> {
    let parameters = about.parameters.iter().map(|parameter| &*parameter.name);
    let known: Vec<&str> = FACTS.into_iter().chain(parameters).collect();
    let unknown = file.vehicle.iter().filter(|(name, _)| !known.contains(&name.as_str()));
    unknown
        .map(|(name, stated)| {
            let expected = format!("one of {}, or a parameter of model `{}`", FACTS.join(", "), about.name);
            let remedy = spelling::remedy(name, known.iter().copied());
            Problem::new(&stated.file, stated.place.clone(), "an unknown key", expected, remedy)
        })
        .collect()
}
