//! The sides A and B of a comparison: each a model with values, and its measurements.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use qcar_dsl::response::Wanted;
use qcar_dsl::schedule::Compiled;
use qcar_runtime::campaign::{Campaign, Role, Test};
use qcar_runtime::fit::Level;
use qcar_runtime::response::parameters::Values;

use super::Arguments;
use super::subject::Subject;
use crate::catalogue::{self, Loaded};
use crate::failure::{Failure, flag};
use crate::parameters::{self, FileExtras};
use crate::verbs::fit::{self, Choices};
use crate::verbs::kc::{self, Gradient};

/// A side.
pub(super) struct Side {
    /// Name as the user gave it.
    pub name: String,
    /// The model, ready to run.
    pub model: Loaded,
    /// The model of the compiler.
    pub compiled: Compiled,
    /// Values of all parameters.
    pub values: Values,
    /// Standard errors, by name.
    pub errors: BTreeMap<String, f64>,
    /// Vehicle data.
    pub vehicle: Vehicle,
    /// Measurements; `None` if the side is no campaign.
    pub measured: Option<Measured>,
}

/// Vehicle data.
#[derive(Clone, Default)]
pub(super) struct Vehicle {
    /// Values by name, SI.
    pub facts: BTreeMap<String, f64>,
    /// The file with the data, for error messages.
    pub file: PathBuf,
}

/// A campaign and its measurements.
pub(super) struct Measured {
    /// The campaign.
    pub campaign: Campaign,
    /// Transmissibilities, run by run.
    pub levels: Vec<Level>,
    /// Gradients of the K&C curves.
    pub gradients: Vec<Gradient>,
}

/// Both sides of a subject.
///
/// # Errors
/// Fails if something cannot be read, compiled, resolved or fitted, or if a parameter set has no model.
pub(super) fn sides(of: &Subject, arguments: &Arguments) -> Result<[Side; 2], Failure> {
    let [a, b] = match of {
        Subject::Parameters([a, b]) => sets([a, b], arguments)?,
        Subject::Models([a, b]) => models([a, b], arguments)?,
        Subject::Campaigns([a, b]) => {
            refuse_what_a_fit_decides(arguments)?;
            [campaign(a, arguments)?, campaign(b, arguments)?]
        }
    };
    for side in [&a, &b] {
        side.model.check_inertias(side.values.as_slice())?;
    }
    Ok([a, b])
}

/// Common values of both sides: those of the campaign, overridden by those of the common file.
fn common(arguments: &Arguments) -> Vec<PathBuf> {
    let campaign = arguments.campaign.iter().map(|folder| folder.join("campaign.toml"));
    campaign.chain(arguments.params.clone()).collect()
}

impl Vehicle {
    /// Vehicle data of files; a later file takes precedence.
    fn read(files: &[PathBuf]) -> Result<Self, Failure> {
        let mut vehicle = Vehicle {
            facts: BTreeMap::new(),
            file: files.last().cloned().unwrap_or_default(),
        };
        for file in files {
            vehicle.facts.extend(FileExtras::read(file)?.vehicle);
        }
        Ok(vehicle)
    }
}

fn sets(files: [&PathBuf; 2], arguments: &Arguments) -> Result<[Side; 2], Failure> {
    let beside = [FileExtras::read(files[0])?, FileExtras::read(files[1])?];
    let model = model_of_sets(&beside, arguments)?;
    let side = |file: &PathBuf, beside: &FileExtras| {
        let (loaded, compiled) = catalogue::load_and_compile(&model, Wanted::Values)?;
        let files: Vec<PathBuf> = common(arguments).into_iter().chain([file.clone()]).collect();
        let paths = files.iter().map(PathBuf::as_path);
        Ok::<_, Failure>(Side {
            name: file.display().to_string(),
            values: parameters::resolve(loaded.about(), paths, &arguments.set)?,
            model: loaded,
            compiled,
            errors: beside.errors.clone(),
            vehicle: Vehicle::read(&files)?,
            measured: None,
        })
    };
    Ok([side(files[0], &beside[0])?, side(files[1], &beside[1])?])
}

/// The model of both sets: that of the user, otherwise that of the fits, otherwise that of the campaign.
fn model_of_sets(beside: &[FileExtras; 2], arguments: &Arguments) -> Result<String, Failure> {
    if let Some(model) = &arguments.model {
        return Ok(model.clone());
    }
    match beside.each_ref().map(|own| own.model.as_deref()) {
        [Some(a), Some(b)] if a == b && catalogue::is_shipped(a) => return Ok(a.into()),
        [Some(a), Some(b)] if a != b => {
            let found = format!("fits of `{a}` and of `{b}`");
            let remedy = "give the model of both with --model, or compare the models";
            return Err(flag("A and B", found, "parameters of one model", remedy).into());
        }
        _ => {}
    }
    let Some(folder) = &arguments.campaign else {
        let remedy = "add --model NAME, or --campaign DIR to take its model";
        return Err(flag("--model", "no model", "the model of the parameters", remedy).into());
    };
    catalogue::named_by(&Campaign::open(folder)?, None)
}

fn models(names: [&String; 2], arguments: &Arguments) -> Result<[Side; 2], Failure> {
    if let Some(model) = &arguments.model {
        let remedy = "leave --model out, or compare parameter files";
        return Err(flag("--model", format!("`{model}`"), "no third model", remedy).into());
    }
    let [first, second] = names.map(|name| catalogue::load_and_compile(name, Wanted::Values));
    let [first, second] = [first?, second?];
    let files = common(arguments);
    let paths = files.iter().map(PathBuf::as_path);
    let [a, b] = parameters::resolve_both([first.0.about(), second.0.about()], paths, &arguments.set)?;
    let side = |name: &str, (model, compiled): (Loaded, Compiled), values: Values| {
        Ok::<_, Failure>(Side {
            name: name.into(),
            model,
            compiled,
            values,
            errors: BTreeMap::new(),
            vehicle: Vehicle::read(&files)?,
            measured: None,
        })
    };
    Ok([side(names[0], first, a)?, side(names[1], second, b)?])
}

fn refuse_what_a_fit_decides(arguments: &Arguments) -> Result<(), Failure> {
    let given = [
        ("--params", arguments.params.is_some()),
        ("--set", !arguments.set.is_empty()),
        ("--campaign", arguments.campaign.is_some()),
    ];
    let Some((name, _)) = given.iter().find(|(_, given)| *given) else {
        return Ok(());
    };
    let remedy = format!("leave {name} out, or compare parameter files");
    Err(flag(
        name,
        "two campaigns",
        "campaigns without it: each is fitted to its own runs",
        &remedy,
    )
    .into())
}

/// A campaign: its model fitted to its rig runs, or with its start values without rig runs.
fn campaign(folder: &Path, arguments: &Arguments) -> Result<Side, Failure> {
    let wanted = arguments.model.as_deref();
    let campaign = Campaign::open(folder)?;
    let Rig {
        model,
        values,
        errors,
        levels,
    } = rig(&campaign, wanted)?;
    let gradients = if kc::has_curves(&campaign) {
        kc::gradients(&campaign)?
    } else {
        Vec::new()
    };
    Ok(Side {
        name: folder.display().to_string(),
        model,
        compiled: catalogue::compiled_of_campaign(&campaign, wanted, Wanted::Nothing)?,
        values,
        errors,
        vehicle: Vehicle {
            facts: campaign.vehicle.iter().cloned().collect(),
            file: campaign.manifest(),
        },
        measured: Some(Measured {
            campaign,
            levels,
            gradients,
        }),
    })
}

/// Measured ratios of the rig runs of a campaign.
struct Rig {
    model: Loaded,
    values: Values,
    errors: BTreeMap<String, f64>,
    levels: Vec<Level>,
}

fn rig(campaign: &Campaign, wanted: Option<&str>) -> Result<Rig, Failure> {
    let is_rig = |test: &Test| matches!(test, Test::Sweep(_) | Test::TimeHistory(_));
    let mut runs = campaign.runs.iter();
    if !runs.any(|run| run.role == Role::Fit && is_rig(&run.test)) {
        let model = catalogue::of_campaign(campaign, wanted, Wanted::Values)?;
        return Ok(Rig {
            values: parameters::resolve(model.about(), [campaign.manifest().as_path()], &[])?,
            model,
            errors: BTreeMap::new(),
            levels: Vec::new(),
        });
    }
    let fitted = fit::fit(&campaign.folder, &Choices::of_model(wanted))?;
    let own = fitted.fit.parameters.iter();
    Ok(Rig {
        values: fitted.values(),
        errors: own
            .filter_map(|parameter| Some((parameter.name.clone(), parameter.stderr?)))
            .collect(),
        model: fitted.model,
        levels: fitted.levels,
    })
}
