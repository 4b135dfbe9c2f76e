//! `qcar plan`: the further sensor, run or level with the most information about the parameters of a fit.

use std::path::PathBuf;

use clap::Args;
use clap_complete::engine::ArgValueCompleter;
use qcar_dsl::response::Wanted;
use qcar_runtime::campaign::Campaign;
use qcar_runtime::discover::candidate::Workshop;
use qcar_runtime::discover::posterior;
use qcar_runtime::error::InputError;
use qcar_runtime::fit::design::{ExpectedGains, Kind, expected_gains};
use qcar_runtime::model::About;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::spelling;
use serde::Serialize;

use crate::catalogue::{self, Loaded};
use crate::completion;
use crate::failure::{Failure, flag};
use crate::json::{self, Ordered};
use crate::progress::while_counting;
use crate::table::{Table, counted, noted, number, or_dash};
use crate::terminal::prose;
use crate::units;
use crate::verbs::Format;
use crate::verbs::fit::{self, Choices, nonlinear};

/// Print which further sensor, run or level would give the most information about the parameters of a campaign
///
/// The model is fitted. Each candidate measurement is then judged by the rise of the log determinant of the Fisher
/// information about the parameters (D-optimality), and the standard errors to expect are printed. Candidates are: a
/// sensor at each output of the model that no fitted run records, a run driven by an unused excitation, and a fitted
/// run repeated at its level, at twice its level, or beyond either end of its band. A new sensor is assumed as noisy as
/// the existing ones. A nonlinear model is fitted to all runs; its candidates are sensors, repeated runs, sines at
/// twice their level, and a dynamometer's table of each link.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar plan models/campaigns/axle_a_rig\n  qcar plan models/campaigns/axle_a_rig --parameters c_wheel_z,c_tire --format json"
)]
pub struct Arguments {
    /// Folder with a campaign.toml
    campaign: PathBuf,
    /// Fit this model, by name or path, instead of the campaign's
    #[arg(long, add = ArgValueCompleter::new(completion::models))]
    model: Option<String>,
    /// Consider these parameters only; the others are still estimated
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    parameters: Vec<String>,
    /// Fit these parameters too
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    free: Vec<String>,
    /// Keep these parameters at their start values
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    fix: Vec<String>,
    /// Fit a linear model like a nonlinear one: to all runs, each with its own uncertainty
    #[arg(long)]
    all_runs: bool,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// Present errors and candidates.
#[derive(Serialize)]
struct Planned {
    campaign: String,
    model: String,
    parameters: Ordered<Parameter>,
    further: Vec<CandidateMeasurement>,
    notices: Vec<String>,
}

/// A parameter of the fit.
#[derive(Serialize)]
struct Parameter {
    unit: String,
    value: f64,
    stderr: Option<f64>,
    /// True if it was requested.
    asked: bool,
}

/// A measurement that could be added.
#[derive(Serialize)]
struct CandidateMeasurement {
    kind: Kind,
    what: String,
    rise: f64,
    /// Expected standard errors, by parameter.
    stderr: Ordered<Option<f64>>,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let campaign = Campaign::open(&arguments.campaign)?;
    let model = catalogue::of_campaign(&campaign, arguments.model.as_deref(), Wanted::Jacobian)?;
    let choices = Choices {
        model: arguments.model.clone(),
        free: arguments.free.clone(),
        fix: arguments.fix.clone(),
        all_runs: arguments.all_runs,
        ..Choices::default()
    };
    let planned = match fit::is_by_transmissibilities(&campaign, model.about(), &choices) {
        true => of_channels(&model, arguments, &choices)?,
        false => of_runs(campaign, arguments, &choices)?,
    };
    Ok(match arguments.format {
        Format::Text => prose(&planned.text()),
        Format::Json => json::line(&planned),
    })
}

/// Candidates for a fit to transmissibilities. A sensor may be added anywhere, so `model` has the derivatives of all
/// outputs.
fn of_channels(model: &Loaded, arguments: &Arguments, choices: &Choices) -> Result<Planned, Failure> {
    let fitted = fit::fit(&arguments.campaign, choices)?;
    let plan = fitted.as_plan(choices)?;
    let names: Vec<&str> = plan
        .parameters
        .iter()
        .filter(|own| own.fit)
        .map(|own| &*own.name)
        .collect();
    check_names(&names, &arguments.parameters)?;
    let found = while_counting(work(&fitted.campaign), |on_progress| {
        expected_gains(&**model, &plan, &fitted.levels, &arguments.parameters, on_progress)
    })?;
    let (about, values) = (fitted.model.about(), fitted.values());
    Ok(planned(
        &fitted.campaign,
        (about, &values),
        found,
        &arguments.parameters,
    ))
}

/// Candidates for a fit to all runs.
fn of_runs(campaign: Campaign, arguments: &Arguments, choices: &Choices) -> Result<Planned, Failure> {
    let fitted = nonlinear::fit(campaign, choices)?;
    let names: Vec<&str> = fitted
        .parameters
        .iter()
        .filter(|own| own.fitted)
        .map(|own| &*own.name)
        .collect();
    check_names(&names, &arguments.parameters)?;
    let (bench, refit) = (
        fitted.bench().clone().with_every_link_alone(),
        &fitted.found.explanation.refit,
    );
    let found = while_counting(work(&fitted.campaign), |on_progress| {
        posterior::expected_gains(
            bench.model(),
            refit,
            &fitted.found.evidence,
            &arguments.parameters,
            on_progress,
        )
    });
    let found =
        found.map_err(|error| Failure::Input(format!("{}: {error}\n", fitted.campaign.manifest().display())))?;
    let about = bench.model().about();
    Ok(planned(
        &fitted.campaign,
        (about, &refit.values),
        found,
        &arguments.parameters,
    ))
}

fn work(campaign: &Campaign) -> String {
    format!("{}: further measurement", campaign.name)
}

/// # Errors
/// Fails if a name is not that of a fitted parameter.
fn check_names(fitted: &[&str], names: &[String]) -> Result<(), InputError> {
    let unknown = names.iter().filter(|name| !fitted.contains(&name.as_str()));
    let problem = |name: &String| {
        let remedy = spelling::remedy(name, fitted.iter().copied());
        flag(
            "--parameters",
            format!("`{name}`"),
            "a parameter that is fitted",
            &remedy,
        )
    };
    InputError::unless_empty(unknown.map(problem).collect(), Some(()))
}

fn planned(campaign: &Campaign, (about, values): (&About, &Values), found: ExpectedGains, asked: &[String]) -> Planned {
    let name = |place: usize| about.parameters[place].name.to_string();
    let parameter = |(&place, stderr): (&usize, &Option<f64>)| {
        let own = Parameter {
            unit: about.parameters[place].unit.to_string(),
            value: values.as_slice()[place],
            stderr: *stderr,
            asked: asked.is_empty() || asked.contains(&name(place)),
        };
        (name(place), own)
    };
    let names: Vec<String> = found.parameters.iter().map(|&place| name(place)).collect();
    Planned {
        campaign: campaign.name.clone(),
        model: about.name.to_string(),
        parameters: found.parameters.iter().zip(&found.errors).map(parameter).collect(),
        further: found
            .further
            .into_iter()
            .map(|own| CandidateMeasurement {
                kind: own.kind,
                what: own.what,
                rise: own.rise,
                stderr: names.iter().cloned().zip(own.errors).collect(),
            })
            .collect(),
        notices: campaign.notices.clone(),
    }
}

/// Number of measurements whose errors are printed side by side.
const ACROSS: usize = 4;

impl Planned {
    fn text(&self) -> String {
        let count = counted(self.parameters.0.len(), "parameter");
        let mut out = format!(
            "{}: candidates by their information about {count} of {}\n",
            self.campaign, self.model
        );
        out += &noted(&self.notices);
        if self.further.is_empty() {
            return out + "Nothing can be added: every output and excitation of the model is in use.\n";
        }
        out += "\n";
        out += &self.measurements().text();
        out += "\nStandard errors in percent, now and as expected with each of the first candidates:\n\n";
        out + &self.errors().text()
    }

    fn measurements(&self) -> Table {
        let mut table = Table::new(["no", "added", "kind", "rise of log det", "helps most"]);
        for (at, own) in self.further.iter().enumerate() {
            table.row(vec![
                (at + 1).to_string(),
                own.what.clone(),
                own.kind.word().into(),
                number(own.rise, 3),
                self.relief(own),
            ]);
        }
        table
    }

    /// The two parameters whose errors decrease most, as text.
    fn relief(&self, of: &CandidateMeasurement) -> String {
        let mut falls: Vec<(f64, String)> = Vec::new();
        for ((name, own), (_, then)) in self
            .parameters
            .0
            .iter()
            .zip(&of.stderr.0)
            .filter(|((_, own), _)| own.asked)
        {
            match (own.stderr, *then) {
                (None, Some(_)) => falls.push((0.0, format!("{name}, now unknown"))),
                (Some(now), Some(then)) if then < NOTABLE * now => {
                    let less = number(100.0 * (1.0 - then / now), 2);
                    falls.push((then / now, format!("{name} −{less} %")));
                }
                _ => {}
            }
        }
        falls.sort_by(|a, b| a.0.total_cmp(&b.0));
        let words: Vec<String> = falls.into_iter().take(2).map(|(_, words)| words).collect();
        if words.is_empty() { "-".into() } else { words.join(", ") }
    }

    fn errors(&self) -> Table {
        let shown = &self.further[..self.further.len().min(ACROSS)];
        let with = (1..=shown.len()).map(|at| format!("with {at}"));
        let headings = ["parameter", "unit", "value", "now"].map(String::from);
        let mut table = Table::with_headings(headings.into_iter().chain(with).collect());
        for (at, (name, own)) in self.parameters.0.iter().enumerate() {
            let percent = |error: Option<f64>| or_dash(error.map(|error| 100.0 * error / own.value.abs()), 2);
            let named = [
                name.clone(),
                units::name(&own.unit).into(),
                number(units::value(own.value, &own.unit), 4),
                percent(own.stderr),
            ];
            let then = shown.iter().map(|further| percent(further.stderr.0[at].1));
            table.row(named.into_iter().chain(then).collect());
        }
        table
    }
}

/// An error is mentioned if it decreases to less than this share.
const NOTABLE: f64 = 0.98;
