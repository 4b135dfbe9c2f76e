//! `qcar sensitivity`: what metrics of an axle depend on, and how sure they are.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use clap_complete::engine::ArgValueCompleter;
use qcar_runtime::error::InputError;
use qcar_runtime::metric::{Ground, MetricError};
use qcar_runtime::sensitivity::Plan;

use crate::completion;
use crate::failure::{Failure, flag};
use crate::files::{folder_for_results, put};
use crate::json;
use crate::parameters::Setting;
use crate::progress::while_counting;
use crate::roads;
use crate::table::Table;
use crate::terminal::prose;
use crate::verbs::TableFormat;

// The axle.
pub(crate) mod subject;
// Names of metrics and parameters.
pub(crate) mod chosen;
// What they say.
pub(crate) mod gather;
// As text and CSV.
mod render;
// And drawn.
mod figure;

use gather::Asked;
use subject::{Beneath, Subject};

/// Print what metrics of an axle depend on: elasticities, shares of variance, and how sure they are
///
/// Metrics are peaks and after-shakes of each mass, weighted vibration (ISO 2631-1), dynamic tyre load and suspension travel over
/// cleats, peaks of transmissibilities, and frequencies and damping ratios of vibrations; `--list` prints their names.
/// The cleats are those of the campaign, else twelve standard ones. A campaign is fitted first, unless values are given; its
/// standard errors then say how sure each metric is.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar sensitivity models/campaigns/axle_a_rig --out results\n  qcar sensitivity axle_a --campaign models/campaigns/axle_a_rig --metrics body_x.peak,wheel_z.* --tolerance k_tire=5%\n  qcar sensitivity quarter_car --list"
)]
pub struct Arguments {
    /// A model, by name or path, a campaign's folder, or the folder of a fit's results
    #[arg(add = ArgValueCompleter::new(completion::models))]
    subject: String,
    /// Start values, facts of the vehicle and cleat runs of this campaign
    #[arg(long, value_name = "DIR")]
    campaign: Option<PathBuf>,
    /// Parameter values above those: a TOML file with [parameters] and perhaps [vehicle], or the fit.json of a fit
    #[arg(long, value_name = "FILE")]
    params: Option<PathBuf>,
    /// One value, in place of that of the files; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<Setting>,
    /// A road beside the cleats: a class of ISO 8608 or a measured profile, such as C@60km/h or road.crg#v=0.5@50km/h; may be repeated
    #[arg(long, value_name = "ROAD@SPEED")]
    road: Vec<roads::Asked>,
    /// Only these runs; a * stands for any letters
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    runs: Vec<String>,
    /// These metrics; a * stands for any letters
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    metrics: Vec<String>,
    /// By these parameters, in place of all that the model does not call known
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    parameters: Vec<String>,
    /// A part lies within so much of its value, such as k_tire=5%; may be repeated
    #[arg(long, value_name = "NAME=PERCENT")]
    tolerance: Vec<Tolerance>,
    /// Find Sobol indices by so many designs
    #[arg(long, value_name = "DESIGNS", value_parser = clap::value_parser!(u32).range(50..=10_000_000))]
    sobol: Option<u32>,
    /// For these, each parameter lies within so many percent of its value
    #[arg(long, value_name = "PERCENT", default_value = "10%")]
    spread: Percent,
    /// Of the random numbers of these designs
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Print the names of all metrics instead
    #[arg(long)]
    list: bool,
    /// Write sensitivity.json, sensitivity.csv and sensitivity.svg into this folder
    #[arg(long, value_name = "DIR", value_parser = folder_for_results)]
    out: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    format: TableFormat,
}

/// A part of one, written as percent.
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

/// A parameter and how far it may be off.
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

/// Does it.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let beneath = Beneath {
        campaign: arguments.campaign.as_deref(),
        params: arguments.params.as_deref(),
        set: &arguments.set,
        roads: &arguments.road,
    };
    let mut subject = Subject::of(&arguments.subject, &beneath)?;
    chosen::keep_runs(&mut subject.courses, &arguments.runs)?;
    let mut ground = subject.ground();
    if arguments.list {
        return Ok(list(&ground));
    }
    let metrics = match &arguments.metrics[..] {
        [] => chosen::usual(&ground, &subject.roles),
        names => chosen::metrics(&ground, names)?,
    };
    let parameters = chosen::parameters(subject.model.about(), &subject.values, &arguments.parameters)?;
    let tolerances = tolerances(&subject, &parameters, arguments)?;
    let plan = arguments.sobol.map(|designs| Plan {
        designs: designs as usize,
        seed: arguments.seed,
    });
    let asked = Asked {
        metrics: &metrics,
        parameters: &parameters,
        tolerances: &tolerances,
        global: plan.map(|plan| (plan, arguments.spread.0)),
    };
    let found = while_counting(format!("{}: design", subject.name), |told| {
        gather::gather(&subject, &mut ground, &asked, told)
    });
    let found = found.map_err(|error| refused(&subject.name, &error))?;
    if let Some(folder) = &arguments.out {
        put(folder, "sensitivity.json", &json::line(&found))?;
        put(folder, "sensitivity.csv", &render::csv(&found))?;
        put(folder, "sensitivity.svg", &figure::svg(&found))?;
    }
    Ok(match arguments.format {
        TableFormat::Text => prose(&render::text(&found)),
        TableFormat::Json => json::line(&found),
        TableFormat::Csv => render::csv(&found),
    })
}

fn list(ground: &Ground<'_>) -> String {
    if ground.metrics().is_empty() {
        let name = &ground.about().name;
        return format!(
            "{name} has no metric: nothing of it vibrates, no road drives it, and it declares no channel\n"
        );
    }
    let mut table = Table::new(["metric", "unit", "meaning"]);
    for metric in ground.metrics() {
        table.row(vec![metric.name.clone(), metric.unit.into(), metric.doc.clone()]);
    }
    table.text()
}

/// By name, in the unit of the parameter.
fn tolerances(
    subject: &Subject,
    parameters: &[usize],
    arguments: &Arguments,
) -> Result<BTreeMap<String, f64>, InputError> {
    let about = subject.model.about();
    let (mut tolerances, mut problems) = (BTreeMap::new(), Vec::new());
    for own in &arguments.tolerance {
        let problem = |found: &str, expected: &str, remedy: &str| flag("--tolerance", found, expected, remedy);
        match chosen::parameter(about, &subject.values, &own.name, problem) {
            Ok(place) if !parameters.contains(&place) => {
                let found = format!("`{}`, which is not looked at", own.name);
                problems.push(problem(&found, "one of the parameters", "name it in --parameters, too"));
            }
            Ok(place) => {
                let size = (own.part.0 * subject.values.as_slice()[place]).abs();
                tolerances.insert(own.name.clone(), size);
            }
            Err(error) => problems.extend(error.problems),
        }
    }
    InputError::unless_empty(problems, Some(tolerances))
}

/// A metric that cannot be measured.
pub(crate) fn refused(subject: &str, error: &MetricError) -> Failure {
    let remedy = "correct the run, the vehicle or the parameters, or leave the metric out";
    flag(subject, error, "an axle whose metrics can be measured", remedy).into()
}
