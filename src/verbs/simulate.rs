//! `qcar simulate`: the cleat runs, sweeps and time histories of a campaign, simulated and compared with the
//! measurement.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use clap_complete::engine::ArgValueCompleter;
use qcar_runtime::campaign::{Campaign, Test};
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::model::Model;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::simulate::{Car, Cleat, Drive, Ride, Settings, SimulateError, Variant, rides, tyre};
use qcar_runtime::statics::contradictions;
use qcar_runtime::tyre::Tyre;

use crate::catalogue::{self, Loaded};
use crate::completion;
use crate::failure::Failure;
use crate::files::{folder_for_results, put};
use crate::histories::{History, Kind};
use crate::parameters::{self, Setting};
use crate::progress::while_counting;
use crate::results::Results;
use crate::roads;
use crate::table::noted;
use crate::terminal::{aside, prose};
use crate::verbs::TableFormat;

// Names of the files.
pub(crate) mod names;
// Simulated and measured cleat runs compared.
pub(crate) mod comparison;
// Sweeps and time histories, replayed.
mod records;
// Figures of sweeps and time histories.
mod figure;
// The result as text, JSON and CSV.
pub(crate) mod render;
// Power spectral densities of rides.
mod spectra;
// Rides over roads without a measured run.
mod ground;

use comparison::Compared;
use names::{FileNames, spare_records};
use qcar_dsl::response::Wanted;
use records::Record;

/// Simulate the runs of a campaign and compare them with the measurement
///
/// Sweeps and time histories are replayed: the recorded inputs drive the model, for a time history from an estimated
/// initial state. Their error is the RMS of the difference over the RMS of the measured signal without its mean (NRMS).
/// The errors of cleat runs are those of section 3.6.2 of the thesis, after both records are aligned at the peak of the
/// wheel: the error of the peak during the impact, and that of the RMS after-shake. With `--road` the model rolls over
/// roads instead of the runs, on the tyre of the campaign. This gives the vibration of each mass on a class of ISO 8608
/// or a measured profile, weighted by ISO 2631-1, and the load of the tyre.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar simulate models/campaigns/axle_a_rig --out rides\n  qcar simulate models/campaigns/axle_a_rig --set k_tire=2.3e5 --variant vertical --format csv\n  qcar simulate models/campaigns/silverbox --out replays\n  qcar simulate models/campaigns/axle_a_rig --out viewer --as mdf\n  qcar simulate models/campaigns/axle_a_rig --road C@80km/h --road B#3@120km/h:20s --out spectra"
)]
pub struct Arguments {
    /// Folder with a campaign.toml
    campaign: PathBuf,
    #[command(flatten)]
    choices: Choices,
    /// Roll over this road in place of the campaign's runs; may be repeated: a class of ISO 8608 such as C@80km/h,
    /// C#7@80km/h with a seed of its own, or a measured profile such as road.crg#v=0.5@50km/h; each perhaps with a
    /// duration, `:20s`
    #[arg(long, value_name = "ROAD@SPEED")]
    road: Vec<roads::RequestedRoad>,
    /// Write the time histories into this folder, a file for each run, and their errors as JSON; replaces only its own files. For
    /// a sweep or time history a file has the measured and the simulated signals, with an SVG; for a road there are power
    /// spectral densities too, as CSV and SVG
    #[arg(long, value_name = "DIR", value_parser = folder_for_results)]
    out: Option<PathBuf>,
    /// Format of the files
    #[arg(long = "as", value_enum, value_name = "KIND", default_value_t = Kind::Csv, requires = "out")]
    kind: Kind,
    /// Output format
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    format: TableFormat,
}

/// The model and its values.
#[derive(Args, Default)]
pub struct Choices {
    /// Simulate this model, by name or path, instead of the campaign's
    #[arg(long, add = ArgValueCompleter::new(completion::models))]
    pub model: Option<String>,
    /// Parameter values that take precedence over the start values of the campaign: a TOML file with [parameters]
    #[arg(long, value_name = "FILE")]
    pub params: Option<PathBuf>,
    /// A single value, which takes precedence over that of the files; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<Setting>,
    /// Which part of the model is simulated over cleats
    #[arg(long, value_enum, default_value_t = VariantName::Complete)]
    pub variant: VariantName,
}

/// Part of a model that is simulated over cleats.
#[derive(Clone, Copy, Default, ValueEnum)]
pub enum VariantName {
    /// All of it
    #[default]
    Complete,
    /// Everything moves along the road at constant speed
    Locked,
    /// Locked, and the tyre follows the height below the wheel's centre only
    Vertical,
}

/// The files of simulated runs.
const RUNS: Results = Results {
    record: "simulation.json",
    names: ["/model", "/campaign"],
    between: "for",
    files: &[],
};

/// The files of rides over roads.
const ROADS: Results = Results {
    record: "roads.json",
    ..RUNS
};

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    if !arguments.road.is_empty() {
        return over_roads(arguments);
    }
    let opened = open(&arguments.campaign, &arguments.choices)?;
    if let Some(folder) = &arguments.out {
        let names = FileNames::of(&opened.campaign);
        let files = names
            .all()
            .flat_map(|name| [arguments.kind.file(name), render::figure_of(name)]);
        check_folder(&RUNS, folder, (&opened.campaign, &opened.model), files.collect())?;
    }
    let simulated = simulated(opened, arguments.choices.variant)?;
    if let Some(folder) = &arguments.out {
        put(folder, RUNS.record, &simulated.json())?;
        simulated.put(folder, arguments.kind)?;
    }
    Ok(match arguments.format {
        TableFormat::Text => prose(&simulated.result().text()),
        TableFormat::Json => simulated.json(),
        TableFormat::Csv => {
            aside(&noted(&simulated.campaign.notices));
            simulated.result().csv()
        }
    })
}

/// Rolls over roads instead of the runs of the campaign.
fn over_roads(arguments: &Arguments) -> Result<String, Failure> {
    let Opened {
        campaign,
        model,
        values,
    } = open(&arguments.campaign, &arguments.choices)?;
    roads::check_rolls(model.about(), &campaign.roles, "--road")?;
    let variant = arguments.choices.variant.into();
    let courses = roads::courses(&arguments.road, &[])?;
    if let Some(folder) = &arguments.out {
        let files = courses
            .iter()
            .flat_map(|course| ground::files(&course.name, arguments.kind));
        check_folder(&ROADS, folder, (&campaign, &model), files.collect())?;
    }
    let rolled = ground::roll(&campaign, &model, &values, &courses, variant)?;
    if let Some(folder) = &arguments.out {
        put(folder, ROADS.record, &rolled.json())?;
        rolled.put(folder, arguments.kind)?;
    }
    Ok(match arguments.format {
        TableFormat::Text => prose(&rolled.text()),
        TableFormat::Json => rolled.json(),
        TableFormat::Csv => {
            aside(&noted(&campaign.notices));
            rolled.csv()
        }
    })
}

/// Checks that these files of simulated runs replace nothing but results of the same model and campaign, and no measured
/// file of the campaign.
///
/// # Errors
/// Fails as [`spare_records`] and [`Results::check`] do.
fn check_folder(
    results: &Results,
    folder: &Path,
    (campaign, model): (&Campaign, &Loaded),
    files: Vec<String>,
) -> Result<(), Failure> {
    let paths: Vec<PathBuf> = files.iter().map(|file| folder.join(file)).collect();
    spare_records(campaign, folder, files)?;
    Ok(results.check(folder, [&model.about().name, &campaign.name], paths)?)
}

/// A campaign with its model and the parameter values.
struct Opened {
    campaign: Campaign,
    model: Loaded,
    values: Values,
}

fn open(campaign: &Path, choices: &Choices) -> Result<Opened, Failure> {
    let mut campaign = Campaign::open(campaign)?;
    let model = catalogue::of_campaign(&campaign, choices.model.as_deref(), Wanted::Values)?;
    let manifest = campaign.manifest();
    let files = std::iter::once(manifest.as_path()).chain(choices.params.as_deref());
    let values = parameters::resolve(model.about(), files, &choices.set)?;
    let outside = parameters::out_of_range(model.about(), values.as_slice());
    let contradictions = contradictions(model.about(), &campaign);
    campaign.notices.extend(outside.into_iter().chain(contradictions));
    Ok(Opened {
        campaign,
        model,
        values,
    })
}

/// The runs of a campaign, simulated.
pub struct Simulated {
    campaign: Campaign,
    model: Loaded,
    values: Values,
    cleats: Option<(Vec<Cleat>, CleatResults)>,
    records: Vec<Record>,
}

/// Simulates the cleat runs, sweeps and time histories of a campaign.
///
/// # Errors
/// Fails if the campaign has no such run, or if a run cannot be read or simulated.
pub fn simulate(campaign: &Path, choices: &Choices) -> Result<Simulated, Failure> {
    simulated(open(campaign, choices)?, choices.variant)
}

fn simulated(opened: Opened, variant: VariantName) -> Result<Simulated, Failure> {
    let Opened {
        mut campaign,
        model,
        values,
    } = opened;
    let cleats = over_cleats(&campaign, &model, &values, variant.into())?;
    let (records, left_out) = records::records(&campaign, &*model, &values)?;
    campaign.notices.extend(left_out);
    if cleats.is_none() && records.is_empty() {
        let expected = "at least one run of kind cleat, sweep or time_history";
        return Err(nothing_to_simulate(&campaign, expected).into());
    }
    Ok(Simulated {
        campaign,
        model,
        values,
        cleats,
        records,
    })
}

impl Simulated {
    /// The errors as JSON, see `docs/json.md`.
    pub fn json(&self) -> String {
        self.result().json()
    }

    /// Signals of each run: all outputs and the tyre force of a cleat run; measured and simulated signals of others.
    pub fn histories(&self) -> Vec<History> {
        let names = FileNames::of(&self.campaign);
        let driven = self.cleats.as_ref();
        let mut histories = driven.map_or_else(Vec::new, |(cleats, driven)| {
            render::histories(self.model.about(), &names, cleats, &driven.rides)
        });
        let records = self.records.iter();
        histories.extend(records.map(|record| render::beside(record, names.get(&record.run))));
        histories
    }

    /// Writes the time histories, and the figure of each sweep and time history.
    fn put(&self, folder: &Path, kind: Kind) -> Result<(), InputError> {
        self.histories()
            .iter()
            .try_for_each(|history| history.put(folder, kind))?;
        let names = FileNames::of(&self.campaign);
        let mut records = self.records.iter();
        records.try_for_each(|record| render::put_figure(record, names.get(&record.run), folder))
    }

    fn result(&self) -> render::Result<'_> {
        render::Result {
            campaign: &self.campaign.name,
            model: &self.model.about().name,
            notices: &self.campaign.notices,
            at_start: guessed(&self.campaign, &self.model, &self.values),
            cleats: self.cleats.as_ref().map(|(_, driven)| &driven.compared),
            records: &self.records,
        }
    }
}

/// The runs over cleats; `None` without any.
fn over_cleats(
    campaign: &Campaign,
    model: &Loaded,
    values: &Values,
    variant: Variant,
) -> Result<Option<(Vec<Cleat>, CleatResults)>, InputError> {
    if !campaign.runs.iter().any(|run| matches!(run.test, Test::Cleat { .. })) {
        return Ok(None);
    }
    let cleats = cleats(campaign)?;
    let driven = drive(campaign, model, values, &cleats, variant)?;
    Ok(Some((cleats, driven)))
}

fn nothing_to_simulate(campaign: &Campaign, expected: &str) -> Problem {
    let (place, remedy) = (Place::Name("run".into()), "list such a run");
    Problem::new(campaign.manifest(), place, "none that is simulated", expected, remedy)
}

/// Parameters to fit that still have their start values. Until they are fitted, errors cannot be attributed to the
/// model.
pub(crate) fn guessed(campaign: &Campaign, model: &Loaded, values: &Values) -> Vec<String> {
    let parameters = model.about().parameters.iter().zip(values.as_slice());
    let is_start = |name: &str, value: f64| {
        campaign
            .parameter(name)
            .is_some_and(|own| own.fit && own.value == value)
    };
    parameters
        .filter(|(parameter, value)| is_start(&parameter.name, **value))
        .map(|(parameter, _)| parameter.name.to_string())
        .collect()
}

/// Every cleat run, simulated and compared.
pub(crate) struct CleatResults {
    /// A ride for each run.
    pub rides: Vec<Ride>,
    /// Their errors.
    pub compared: Compared,
}

/// Drives a model over the cleats of a campaign.
///
/// # Errors
/// Fails if a mass is not positive, if the vehicle has no tyre, or if a ride cannot be simulated or compared.
pub(crate) fn drive(
    campaign: &Campaign,
    model: &Loaded,
    values: &Values,
    cleats: &[Cleat],
    variant: Variant,
) -> Result<CleatResults, InputError> {
    model.check_inertias(values.as_slice())?;
    let drives: Vec<Drive> = cleats.iter().map(Cleat::drive).collect();
    let what = format!("{}: ride", campaign.name);
    let rides = simulate_rides(what, &**model, values, tyre(campaign)?, &drives, variant);
    let rides = checked(cleats, rides)?;
    let compared = comparison::compare(model.about(), &campaign.roles, cleats, &rides)?;
    Ok(CleatResults { rides, compared })
}

/// Simulates rides of a model on a tyre that carries a load (N), with progress in a terminal.
pub(crate) fn simulate_rides(
    what: String,
    model: &dyn Model,
    values: &Values,
    (tyre, load): (Tyre, f64),
    drives: &[Drive<'_>],
    variant: Variant,
) -> Vec<Result<Ride, SimulateError>> {
    let car = Car {
        model,
        parameters: values.as_slice(),
        tyre,
        load,
        variant,
    };
    while_counting(what, |on_progress| {
        rides(&car, drives, &Settings::default(), on_progress)
    })
}

impl From<VariantName> for Variant {
    fn from(name: VariantName) -> Self {
        match name {
            VariantName::Complete => Variant::Complete,
            VariantName::Locked => Variant::LongitudinallyLocked,
            VariantName::Vertical => Variant::PureVertical,
        }
    }
}

/// The cleat runs of a campaign.
///
/// # Errors
/// Fails if the campaign has no cleat runs, or if a record or road cannot be read.
pub(crate) fn cleats(campaign: &Campaign) -> Result<Vec<Cleat>, InputError> {
    let (mut found, mut problems) = (Vec::new(), Vec::new());
    for run in &campaign.runs {
        match Cleat::read(campaign, run) {
            Ok(cleat) => found.extend(cleat),
            Err(error) => problems.extend(error.problems),
        }
    }
    if found.is_empty() && problems.is_empty() {
        problems.push(nothing_to_simulate(campaign, "at least one run of kind cleat"));
    }
    InputError::unless_empty(problems, Some(found))
}

/// Message for a run that cannot be simulated.
const NO_RIDE: &str = "this run cannot be simulated";

/// The rides, if all succeeded. Equal errors of several rides are reported once.
fn checked(cleats: &[Cleat], rides: Vec<Result<Ride, SimulateError>>) -> Result<Vec<Ride>, InputError> {
    let (mut done, mut problems): (Vec<Ride>, Vec<Problem>) = (Vec::new(), Vec::new());
    for (cleat, ride) in cleats.iter().zip(rides) {
        match ride {
            Ok(ride) => done.push(ride),
            Err(error) => {
                let problem = Problem::refused(&cleat.measured.file, Place::File, NO_RIDE, error);
                if problems.iter().all(|known| known.found != problem.found) {
                    problems.push(problem);
                }
            }
        }
    }
    InputError::unless_empty(problems, Some(done))
}
