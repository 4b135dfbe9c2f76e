//! `qcar study`: all verbs on one campaign, and a report.

use std::path::PathBuf;

use clap::Args;
use clap_complete::engine::ArgValueCompleter;
use qcar_dsl::response::Wanted;
use qcar_runtime::campaign::Campaign;

use crate::catalogue;
use crate::completion;
use crate::failure::Failure;
use crate::files::{folder_for_results, put};
use crate::histories::Kind;
use crate::json;
use crate::report::{Report, page};
use crate::results::Results;
use crate::terminal::prose;
use crate::verbs::simulate::names::{FileNames, spare_records};
use crate::verbs::{Format, discover, fit};

// All verbs on one campaign.
mod gather;
// The masses and links of a model.
pub(crate) mod axle;
// K&C cycles.
mod loops;
// The predicted ratios of the sweeps.
pub(crate) mod level_responses;
// Measured and modelled ratios.
pub(crate) mod rig;
// Mode shapes.
pub(crate) mod shapes;
// Cleat runs with their errors and variants.
mod track;
// Records over time.
mod records;
// The residuals and their explanation.
mod residuals;
// The result in a few numbers.
mod summary;
// Inputs and versions of the study.
mod record;
// The numbers as a workbook.
mod workbook;
// The model as JavaScript for the report.
mod program;
// The study for the report, and without curves for JSON.
mod contents;

use gather::{CURVES, DISCOVERY, ERRORS, FIT, GRADIENTS, TRACK};

/// Fit, simulate and discover at once, and write a report
///
/// Fits the model of a campaign to its rig runs, takes the gradients of its K&C curves, searches for what the model
/// lacks, and simulates the model, before and after, over the cleats. The report is one HTML file that needs no
/// network.
#[derive(Args)]
#[command(after_help = "Example:\n  qcar study models/campaigns/axle_c_study --out results")]
pub struct Arguments {
    /// Folder with a campaign.toml
    campaign: PathBuf,
    /// Start from this model, by name or path, instead of the campaign's
    #[arg(long, add = ArgValueCompleter::new(completion::models))]
    model: Option<String>,
    /// Write report.html, study.json, results.xlsx and the files of each step into this folder
    #[arg(long, value_name = "DIR", value_parser = folder_for_results)]
    out: PathBuf,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// The files of a study besides those of its steps.
const RESULTS: Results = Results {
    record: "study.json",
    names: ["/model", "/campaign"],
    between: "for",
    files: &["report.html", fit::workbook::FILE],
};

/// Checks that a study replaces nothing but its own results, and no measured file of the campaign.
///
/// # Errors
/// Fails as [`Results::check`] and [`spare_records`] do, and if the campaign or its model cannot be read.
fn check_folder(arguments: &Arguments) -> Result<(), Failure> {
    let out = &arguments.out;
    let campaign = Campaign::open(&arguments.campaign)?;
    let model = catalogue::of_campaign(&campaign, arguments.model.as_deref(), Wanted::Nothing)?;
    let names: [&str; 2] = [&model.about().name, &campaign.name];
    RESULTS.check(out, names, None)?;
    discover::check_folder(&out.join(DISCOVERY), names[0], names[1])?;
    // The fit is written first, and says of what the files of the other steps are results.
    let (runs, track) = (FileNames::of(&campaign), out.join(TRACK));
    let rides: Vec<String> = runs.all().map(|name| Kind::Csv.file(name)).collect();
    let rides_there = rides.iter().map(|file| track.join(file));
    let others = [out.join(CURVES).join(GRADIENTS), track.join(ERRORS)];
    fit::RESULTS.check(&out.join(FIT), names, rides_there.chain(others))?;
    spare_records(&campaign, &track, rides)
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    check_folder(arguments)?;
    let study = gather::gather(&arguments.campaign, arguments.model.as_deref(), &arguments.out)?;
    let contents = contents::Contents::of(&study);
    let json = json::line(&contents.result);
    put(&arguments.out, "study.json", &json)?;
    workbook::write(&study, &arguments.out)?;
    let title = format!("{}: study of {}", contents.result.campaign, contents.result.model);
    let program = program::program(&study);
    put(
        &arguments.out,
        "report.html",
        &page(Report::Study, &title, &contents, program.as_deref()),
    )?;
    let result = match arguments.format {
        Format::Text => prose(&summary::text(&study, &contents.result.summary, &arguments.out)),
        Format::Json => json,
    };
    if study.fitted.fit.converged {
        Ok(result)
    } else {
        Err(Failure::Finding(result))
    }
}
