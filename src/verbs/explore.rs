//! `qcar explore`: metrics of thousands of parameter sets over the same rides.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use qcar_dsl::response::Wanted;
use qcar_runtime::campaign::RoleNames;
use qcar_runtime::ensemble::{self, Axis, DIMENSIONS, Design, Ensemble, Metrics, POINTS, Posterior, Scheme, Track};
use qcar_runtime::error::InputError;
use qcar_runtime::model::{About, Model};
use qcar_runtime::response::parameters::Values;
use qcar_runtime::response::unit::unit;
use qcar_runtime::simulate::{Variant, tyre_of};

use crate::catalogue::{self, Loaded};
use crate::failure::{Failure, flag};
use crate::parameters::{self, FileExtras};
use crate::roads::check_rolls;
use crate::stability::unstable;
use crate::table::number;
use crate::verbs::{ModelArguments, each_once, frf};

// The parameters that vary.
mod vary;
// The cleats.
mod ride_name;
// The part of the ensemble that this machine computes.
mod part;
// Rows of an earlier run that was stopped.
mod existing_rows;
// Rows as CSV.
mod csv;
// Rows as Parquet, in row groups.
mod parquet_rows;
// The output file in either format.
mod sink;
// The description of an ensemble, by which a run is resumed.
mod ledger;
// All rows, block after block.
mod row_file;

use ledger::Choice;
use part::Part;
use ride_name::RideName;
use vary::Vary;

/// Compute metrics of many parameter sets over the same cleats, as a table
///
/// A row is a parameter set and a ride: its number, the varied parameters, and the metrics. Rows are in the order of
/// the design and do not depend on the number of threads. An interrupted command resumes when it is repeated: rows are
/// in FILE.part until all are complete, and FILE.design.json describes them. Rides need the vehicle data r_tire,
/// static_tire_def and static_tire_load, in the file or campaign of --params.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar explore quarter_car --vary k_tire=180..220N/mm --vary m_wheel=-10%..10% --count 1000 --out sets.csv\n  qcar explore axle_a --params models/campaigns/axle_a_rig --vary k_tire=-10%..10% --vary c_wheel_z=-30%..30% --count 16 --rides 20mm@30km/h,standard --out rides.parquet\n  qcar explore axle_a --params models/campaigns/axle_a_rig --vary k_tire=-10%..10% --design grid --count 5 --metrics modes --part 2/4 --out part-2.csv"
)]
pub struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    /// A parameter to vary between two values, with their unit or in percent of its value; may be repeated
    #[arg(
        long,
        value_name = "NAME=LO..HI",
        required_unless_present = "posterior",
        conflicts_with = "posterior"
    )]
    vary: Vec<Vary>,
    /// Draw parameter sets from the distribution that a fit has estimated: its fit.json
    #[arg(long, value_name = "FILE")]
    posterior: Option<PathBuf>,
    /// How the sets are chosen [default: sobol, or posterior with --posterior]
    #[arg(long, value_enum)]
    design: Option<DesignKind>,
    /// Number of sets; for a grid, number of values of each parameter
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    count: u64,
    /// Seed of the design; 0 is the published Sobol sequence
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Cleats to drive over: `standard` (three speeds, four heights), or HEIGHT@SPEED with units, such as 20mm@30km/h
    #[arg(long, value_delimiter = ',', value_name = "RIDES")]
    rides: Vec<RideName>,
    /// The metrics to compute [default: peak, after-shake and vdv of rides; without rides transmissibility and modes]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "NAMES")]
    metrics: Vec<Metric>,
    /// Transmissibilities of these channels only
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    channels: Vec<String>,
    /// Compute the K-th of N equal parts of the design, to share it among N machines
    #[arg(long, value_name = "K/N", default_value = "1/1", hide_default_value = true)]
    part: Part,
    /// Write the rows into this file: .csv or .parquet
    #[arg(long, value_name = "FILE", value_parser = sink::table_for_results)]
    out: PathBuf,
}

/// The designs by name.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum DesignKind {
    /// Every combination of equally spaced values
    Grid,
    /// A Latin hypercube: as many intervals as sets, and each parameter has one value in each interval
    Lhs,
    /// Sobol's sequence, which fills the space evenly for any number of points
    Sobol,
    /// Draws from the distribution of a fit
    Posterior,
}

/// The metrics by name.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Metric {
    /// Largest acceleration of each mass and axis in the impact
    Peak,
    /// Root mean square of each acceleration in the after-shake
    AfterShake,
    /// Vibration dose of each acceleration, weighted by ISO 2631-1
    Vdv,
    /// Largest magnitude of each channel from 0.5 to 50 Hz, and its frequency
    Transmissibility,
    /// Natural frequencies and damping ratios, lowest frequency first
    Modes,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    // Metrics need no derivatives.
    let (model, compiled) = catalogue::load_and_compile(&arguments.model.model, Wanted::Values)?;
    let drawn = arguments.posterior.as_deref().map(parameters::posterior).transpose()?;
    check_same_model(
        arguments,
        model.about(),
        drawn.as_ref().map(|(_, model)| model.as_str()),
    )?;
    let files = arguments.model.params.iter().chain(&arguments.posterior);
    let values = parameters::resolve(model.about(), files.map(PathBuf::as_path), &arguments.model.set)?;
    parameters::require_in_range(model.about(), &arguments.model.set)?;
    model.check_inertias(values.as_slice())?;
    let mut notices = parameters::out_of_range(model.about(), values.as_slice());
    notices.extend(unstable(&*model, &values));
    let design = design(arguments, model.about(), &values, drawn.map(|(posterior, _)| posterior))?;
    let possible = |p: &[f64]| model.check_inertias(p).err().map(|error| error.to_string());
    let ensemble = Ensemble {
        model: &*model,
        track: track(arguments, model.about())?,
        metrics: metrics(arguments, &model)?,
        values,
        design,
        possible: &possible,
    };
    let program = qcar_dsl::rust::module(&compiled);
    let choice = Choice {
        scheme: scheme(arguments).name(),
        seed: arguments.seed,
        part: arguments.part,
        program: &program,
        notices: &notices,
    };
    row_file::fill(&ensemble, &choice, &arguments.out)
}

/// # Errors
/// Fails if the posterior is that of another model.
fn check_same_model(arguments: &Arguments, about: &About, fitted: Option<&str>) -> Result<(), InputError> {
    match (fitted, &arguments.posterior) {
        (Some(fitted), Some(file)) if *fitted != *about.name => {
            let found = format!("{}, a fit of model `{fitted}`", file.display());
            let expected = format!("a fit of model `{}`", about.name);
            Err(flag(
                "--posterior",
                found,
                &expected,
                "name the model that was fitted, or another fit",
            )
            .into())
        }
        _ => Ok(()),
    }
}

fn scheme(arguments: &Arguments) -> DesignKind {
    let usual = match arguments.posterior {
        Some(_) => DesignKind::Posterior,
        None => DesignKind::Sobol,
    };
    arguments.design.unwrap_or(usual)
}

impl DesignKind {
    fn name(self) -> &'static str {
        match self {
            DesignKind::Grid => "grid",
            DesignKind::Lhs => "lhs",
            DesignKind::Sobol => "sobol",
            DesignKind::Posterior => "posterior",
        }
    }
}

/// # Errors
/// Fails if the bounds are no range, if the design does not suit its parameters, or if more sets are requested than it
/// has.
fn design(
    arguments: &Arguments,
    about: &About,
    values: &Values,
    posterior: Option<Posterior>,
) -> Result<Design, InputError> {
    let count = arguments.count;
    let axes = match &posterior {
        Some(posterior) => axes_of(about, posterior),
        None => vary::axes(about, values, &arguments.vary)?,
    };
    let scheme = match (scheme(arguments), posterior) {
        (DesignKind::Posterior, Some(posterior)) => Scheme::Posterior(count, posterior),
        (DesignKind::Posterior, None) => {
            let remedy = "add --posterior with the fit.json of `qcar fit --out`";
            return Err(flag("--design", "`posterior` without a fit", "a fit to draw from", remedy).into());
        }
        (other, Some(_)) => {
            let found = format!("`{}` with --posterior", other.name());
            return Err(flag(
                "--design",
                found,
                "`posterior`",
                "leave --design out, or vary with --vary",
            )
            .into());
        }
        (DesignKind::Grid, None) => Scheme::Grid(count),
        (DesignKind::Lhs, None) => Scheme::LatinHypercube(count),
        (DesignKind::Sobol, None) => Scheme::Sobol(count),
    };
    check_size(&scheme, axes.len())?;
    Ok(Design::new(axes, scheme, arguments.seed))
}

/// # Errors
/// Fails if there are more sets than numbers can distinguish, or more parameters than Sobol's sequence has dimensions.
fn check_size(scheme: &Scheme, axes: usize) -> Result<(), InputError> {
    // Larger whole numbers are not exact in a column of floating-point numbers.
    const MOST: u64 = 1 << 53;
    let count = match scheme {
        Scheme::Grid(values) => (*values as f64).powi(axes as i32),
        Scheme::LatinHypercube(count) | Scheme::Sobol(count) | Scheme::Posterior(count, _) => *count as f64,
    };
    let sobol = matches!(scheme, Scheme::Sobol(_));
    let most = if sobol { POINTS } else { MOST };
    if count > most as f64 {
        let found = format!("{} sets", number(count, 4));
        let expected = format!("at most {most} sets");
        return Err(flag(
            "--count",
            found,
            &expected,
            "take a smaller number, or vary fewer parameters",
        )
        .into());
    }
    if sobol && axes > DIMENSIONS {
        let expected = format!("at most {DIMENSIONS} parameters for Sobol's sequence");
        let remedy = "vary fewer, or take --design lhs";
        return Err(flag("--vary", format!("{axes} parameters"), &expected, remedy).into());
    }
    Ok(())
}

/// The estimated parameters of a fit.
fn axes_of(about: &About, posterior: &Posterior) -> Vec<Axis> {
    let place = |name: &str| about.parameters.iter().position(|parameter| parameter.name == *name);
    let axis = |own: &ensemble::Estimate| Axis {
        parameter: place(&own.name).expect("the file was resolved for the model"),
        range: own.range,
    };
    posterior.estimates().iter().map(axis).collect()
}

/// Tyre, load and roads of the rides; `None` without rides.
///
/// # Errors
/// Fails if the model does not roll, if the vehicle has no tyre, or if a parameter varies on which the tyre depends.
fn track(arguments: &Arguments, about: &About) -> Result<Option<Track>, Failure> {
    if arguments.rides.is_empty() {
        return Ok(None);
    }
    check_rolls(about, &RoleNames::default(), "--rides")?;
    vary::refuse_facts(&arguments.vary)?;
    let Some(file) = &arguments.model.params else {
        let remedy = "add --params with a campaign, or a file that has [vehicle]";
        return Err(flag(
            "--rides",
            "no --params",
            "r_tire, static_tire_def and static_tire_load",
            remedy,
        )
        .into());
    };
    let vehicle: BTreeMap<String, f64> = FileExtras::read(file)?.vehicle;
    let shown = if file.is_dir() {
        file.join("campaign.toml")
    } else {
        file.clone()
    };
    let (tyre, load) = tyre_of(&|name| vehicle.get(name).copied(), Path::new(&shown))?;
    Ok(Some(Track {
        rides: ride_name::rides(&arguments.rides, tyre.radius())?,
        tyre,
        load,
        variant: Variant::Complete,
    }))
}

/// # Errors
/// Fails if a metric needs rides and there are none, if a channel is unknown, or if the model lacks a metric.
fn metrics<'a>(arguments: &Arguments, model: &'a Loaded) -> Result<Metrics<'a, dyn Model + 'a>, Failure> {
    let chosen: Vec<ensemble::Metric> = match (&arguments.metrics[..], arguments.rides.is_empty()) {
        ([], true) => vec![ensemble::Metric::Transmissibility, ensemble::Metric::Modes],
        ([], false) => vec![
            ensemble::Metric::Peak,
            ensemble::Metric::AfterShake,
            ensemble::Metric::Dose,
        ],
        (named, _) => each_once(named.iter().map(|own| (*own).into())),
    };
    if arguments.rides.is_empty() && chosen.iter().any(|own| own.of_rides()) {
        let remedy = "add --rides such as standard or 20mm@30km/h";
        return Err(flag(
            "--metrics",
            "metrics of rides, and no --rides",
            "rides to measure",
            remedy,
        )
        .into());
    }
    let about = model.about();
    let wanted = chosen.contains(&ensemble::Metric::Transmissibility);
    let channels = if wanted {
        frf::chosen(about, &arguments.channels)?
    } else {
        Vec::new()
    };
    let ratio = |channel: &qcar_runtime::model::Channel| {
        Ok::<_, Failure>(ensemble::Ratio {
            name: channel.name.to_string(),
            unit: unit(about, channel),
            excitation: frf::excitation(about, channel)?,
            numerator: channel.numerator.clone(),
            denominator: channel.denominator.clone(),
        })
    };
    let ratios = channels.into_iter().map(ratio).collect::<Result<_, _>>()?;
    let remedy = "choose other metrics, or another model";
    Ok(Metrics::new(&**model, &chosen, ratios)
        .map_err(|error| flag("--metrics", error, "metrics of the model", remedy))?)
}

impl From<Metric> for ensemble::Metric {
    fn from(own: Metric) -> Self {
        match own {
            Metric::Peak => Self::Peak,
            Metric::AfterShake => Self::AfterShake,
            Metric::Vdv => Self::Dose,
            Metric::Transmissibility => Self::Transmissibility,
            Metric::Modes => Self::Modes,
        }
    }
}
