//! `qcar sensitivity`: how metrics of an axle depend on parameters, and how uncertain they are.

use std::collections::HashSet;
use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use clap_complete::engine::ArgValueCompleter;
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::metric::{Ground, MetricError};
use qcar_runtime::sensitivity::Plan;

use crate::completion;
use crate::failure::{Failure, flag};
use crate::files::{folder_for_results, put};
use crate::json;
use crate::parameters::Setting;
use crate::progress::while_counting;
use crate::report::{Report, page};
use crate::results::Results;
use crate::roads;
use crate::table::{Table, noted};
use crate::terminal::{aside, prose};
use crate::units;
use crate::verbs::TableFormat;

// The axle with its values and roads.
pub(crate) mod subject;
// Metrics and parameters by name.
pub(crate) mod selection;
// Uncertainty of the parameters.
pub(crate) mod uncertainty;
// All sensitivities.
pub(crate) mod gather;
// The result as text and CSV.
pub(crate) mod render;
// The result as figures.
mod figure;

use gather::AnalysisSettings;
use subject::{Subject, SubjectOptions};
use uncertainty::{Temperatures, UncertaintySources};

/// Print how metrics of an axle depend on its parameters: elasticities, shares of variance, and uncertainty
///
/// Metrics are peaks and after-shakes of each mass, weighted vibration (ISO 2631-1), dynamic tyre load and suspension
/// travel over cleats, peaks of transmissibilities, and frequencies and damping ratios of modes; `--list` prints their
/// names. The cleats are those of the campaign, or else twelve standard ones. A campaign is fitted first, unless values
/// are given; its standard errors then give the uncertainty of each metric.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar sensitivity models/campaigns/axle_a_rig --out sensitivities\n  qcar sensitivity axle_a --campaign models/campaigns/axle_a_rig --metrics body_x.peak,wheel_z.* --tolerance k_tire=5%\n  qcar sensitivity quarter_car --list"
)]
pub struct Arguments {
    /// A model, by name or path, a campaign's folder, or the folder of a fit's results
    #[arg(add = ArgValueCompleter::new(completion::models))]
    subject: String,
    /// Take start values, vehicle data and cleat runs from this campaign
    #[arg(long, value_name = "DIR")]
    campaign: Option<PathBuf>,
    /// Parameter values that take precedence over those of the campaign or model: a TOML file with [parameters] and
    /// perhaps [vehicle], or the fit.json of a fit
    #[arg(long, value_name = "FILE")]
    params: Option<PathBuf>,
    /// A single value, which takes precedence over that of the files; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<Setting>,
    /// A road beside the cleats: a class of ISO 8608 or a measured profile, such as C@60km/h or road.crg#v=0.5@50km/h;
    /// may be repeated
    #[arg(long, value_name = "ROAD@SPEED")]
    road: Vec<roads::RequestedRoad>,
    /// Only these runs; a * stands for any characters
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    runs: Vec<String>,
    /// Only these metrics; a * stands for any characters
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    metrics: Vec<String>,
    /// Only these parameters, instead of all that are not `known` in the model
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    parameters: Vec<String>,
    /// Tolerance of a part relative to its value, such as k_tire=5%; may be repeated
    #[arg(long, value_name = "NAME=PERCENT")]
    tolerance: Vec<Tolerance>,
    /// Lowest and highest temperature of the parts, in kelvin above the temperature for which the values hold, such as
    /// -30..50
    #[arg(long, value_name = "LOW..HIGH", requires = "per_kelvin", allow_hyphen_values = true)]
    temperature: Option<Temperatures>,
    /// Relative change of a parameter per kelvin, such as c_wheel_z=-0.3%; may be repeated
    #[arg(long, value_name = "NAME=PERCENT", requires = "temperature")]
    per_kelvin: Vec<PerKelvin>,
    /// Compute Sobol indices from this number of designs
    #[arg(long, value_name = "DESIGNS", value_parser = clap::value_parser!(u32).range(50..=10_000_000))]
    sobol: Option<u32>,
    /// Range of each parameter for the Sobol indices, in percent of its value
    #[arg(long, value_name = "PERCENT", default_value = "10%")]
    spread: Percent,
    /// Seed of the random numbers of these designs
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Print the names of all metrics and stop
    #[arg(long)]
    list: bool,
    /// Write report.html, sensitivity.json, sensitivity.csv and sensitivity.svg into this folder
    #[arg(long, value_name = "DIR", value_parser = folder_for_results)]
    out: Option<PathBuf>,
    /// Output format
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    format: TableFormat,
}

/// A fraction, written as percent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Percent(pub f64);

impl FromStr for Percent {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = text.trim().trim_end_matches('%').trim_end().parse::<f64>().ok();
        let number = number.filter(|number| *number > 0.0 && *number < 100.0);
        let part = number.map(|number| Percent(number / 100.0));
        part.ok_or_else(|| format!("expected percent between 0 and 100, such as 10%, found `{text}`"))
    }
}

/// A parameter and its relative tolerance.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tolerance {
    name: String,
    part: Percent,
}

impl FromStr for Tolerance {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, part) = text.split_once('=').ok_or("expected name=percent, such as k_tire=5%")?;
        Ok(Tolerance {
            name: name.trim().into(),
            part: part.parse()?,
        })
    }
}

/// A parameter and its relative change per kelvin.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PerKelvin {
    name: String,
    part: f64,
}

impl FromStr for PerKelvin {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, part) = text
            .split_once('=')
            .ok_or("expected name=percent, such as c_wheel_z=-0.3%")?;
        Ok(PerKelvin {
            name: name.trim().into(),
            part: per_kelvin(part)?,
        })
    }
}

/// A relative change per kelvin, written as percent.
///
/// # Errors
/// Fails with the expected form, in words.
pub(crate) fn per_kelvin(text: &str) -> Result<f64, String> {
    const MOST: f64 = 10.0;
    let number = text.trim().trim_end_matches('%').trim_end().parse::<f64>().ok();
    let number = number.filter(|number| *number != 0.0 && number.abs() <= MOST);
    number.map(|number| number / 100.0).ok_or_else(|| {
        format!("expected percent per kelvin, not zero and between -{MOST} and {MOST}, such as -0.3%, found `{text}`")
    })
}

/// The files of an analysis.
const RESULTS: Results = Results {
    record: "sensitivity.json",
    names: ["/model", "/subject"],
    between: "for",
    files: &["sensitivity.csv", "sensitivity.svg", "report.html"],
};

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let beneath = SubjectOptions {
        campaign: arguments.campaign.as_deref(),
        params: arguments.params.as_deref(),
        set: &arguments.set,
        roads: &arguments.road,
    };
    let mut subject = Subject::of(&arguments.subject, &beneath)?;
    if let Some(folder) = &arguments.out {
        RESULTS.check(folder, [&subject.model.about().name, &subject.name], None)?;
    }
    selection::keep_runs(&mut subject.courses, &arguments.runs)?;
    let mut ground = subject.ground();
    if arguments.list {
        return Ok(list(&ground));
    }
    let metrics = match &arguments.metrics[..] {
        [] => selection::usual(&ground, &subject.roles),
        names => selection::metrics(&ground, names)?,
    };
    let (metrics, infinite) = selection::without_infinite(&ground, &subject.values, metrics);
    let parameters = selection::parameters(subject.model.about(), &subject.values, &arguments.parameters)?;
    let sources = sources(&subject, &parameters, arguments)?;
    let plan = arguments.sobol.map(|designs| Plan {
        designs: designs as usize,
        seed: arguments.seed,
    });
    let asked = AnalysisSettings {
        metrics: &metrics,
        parameters: &parameters,
        sources: &sources,
        global: plan.map(|plan| (plan, arguments.spread.0)),
    };
    let found = while_counting(format!("{}: design", subject.name), |on_progress| {
        gather::gather(&subject, &mut ground, &asked, on_progress)
    });
    let mut found = found.map_err(|error| refused(&subject.name, &error))?;
    found.notices.extend(infinite);
    if let Some(folder) = &arguments.out {
        put(folder, "sensitivity.json", &json::line(&found))?;
        put(folder, "sensitivity.csv", &render::csv(&found))?;
        put(folder, "sensitivity.svg", &figure::svg(&found))?;
        let title = format!("{}: sensitivities", found.model);
        put(
            folder,
            "report.html",
            &page(Report::Sensitivities, &title, &found, None),
        )?;
    }
    Ok(match arguments.format {
        TableFormat::Text => prose(&render::text(&found)),
        TableFormat::Json => json::line(&found),
        TableFormat::Csv => {
            aside(&noted(&found.notices));
            render::csv(&found)
        }
    })
}

fn list(ground: &Ground<'_>) -> String {
    if ground.metrics().is_empty() {
        let name = &ground.about().name;
        return format!("{name} has no metric: it has no vibrating mode, no road and no channel\n");
    }
    let mut table = Table::new(["metric", "unit", "meaning"]);
    for metric in ground.metrics() {
        table.row(vec![
            metric.name.clone(),
            units::name(&metric.unit).into(),
            metric.doc.clone(),
        ]);
    }
    table.text()
}

/// A problem for each parameter that a flag names twice.
fn named_twice(arguments: &Arguments) -> Vec<Problem> {
    let tolerances = arguments.tolerance.iter().map(|own| ("--tolerance", &*own.name));
    let per_kelvin = arguments.per_kelvin.iter().map(|own| ("--per-kelvin", &*own.name));
    let mut seen = HashSet::new();
    let twice = tolerances.chain(per_kelvin).filter(|own| !seen.insert(*own));
    let problem = |(option, name)| {
        flag(
            option,
            format!("`{name}` twice"),
            "each parameter once",
            "leave one of them out",
        )
    };
    twice.map(problem).collect()
}

/// The choices of the user.
fn sources(subject: &Subject, parameters: &[usize], arguments: &Arguments) -> Result<UncertaintySources, InputError> {
    let mut problems = named_twice(arguments);
    let mut place = |name: &str, option: &'static str| {
        let problem = |found: &str, expected: &str, remedy: &str| flag(option, found, expected, remedy);
        match selection::parameter(subject.model.about(), &subject.values, name, problem) {
            Ok(place) if parameters.contains(&place) => return Some(place),
            Ok(_) => {
                let found = format!("`{name}`, which is not among the parameters");
                problems.push(problem(&found, "one of the parameters", "add it to --parameters"));
            }
            Err(error) => problems.extend(error.problems),
        }
        None
    };
    let mut sources = UncertaintySources {
        fit: true,
        temperatures: arguments.temperature.map_or([0.0; 2], |own| own.0),
        ..UncertaintySources::default()
    };
    for own in &arguments.tolerance {
        let place = place(&own.name, "--tolerance");
        sources.tolerances.extend(place.map(|place| (place, own.part.0)));
    }
    for own in &arguments.per_kelvin {
        let place = place(&own.name, "--per-kelvin");
        sources.per_kelvin.extend(place.map(|place| (place, own.part)));
    }
    InputError::unless_empty(problems, Some(sources))
}

/// The problem of a metric that cannot be computed.
pub(crate) fn refused(subject: &str, error: &MetricError) -> Failure {
    let place = Place::Name(subject.into());
    Problem::refused("command line", place, "its metrics cannot be computed", error).into()
}
