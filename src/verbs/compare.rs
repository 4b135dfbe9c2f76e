//! `qcar compare`: two parameter sets, two models or two campaigns side by side.

use std::path::PathBuf;

use clap::Args;
use clap_complete::engine::ArgValueCompleter;

use crate::completion;
use crate::failure::Failure;
use crate::files::{folder_for_results, put};
use crate::json;
use crate::parameters::Setting;
use crate::report::{Report, page};
use crate::results::Results;
use crate::terminal::prose;
use crate::verbs::Format;
use crate::verbs::frf::Frequencies;

// The two things that are compared.
mod subject;
// A model with its values and measurements.
mod sides;
// Parameters whose values differ.
mod parameters;
// Modes.
mod modes;
// Transmissibilities.
mod ratios;
// Aligned records of cleat runs.
mod records;
// Cleat runs.
mod cleat_runs;
// Gradients of K&C curves.
mod gradients;
// The whole comparison.
mod gather;
// The comparison for the report, and without curves for JSON.
mod contents;
// The comparison as text and CSV.
mod render;

use subject::Subject;

/// Compare two parameter sets, two models or two campaigns, and write a report
///
/// A and B are of the same kind: parameter files (.toml, the fit.json of a fit, or its folder), models (by name or
/// path), or campaign folders, each fitted with its own model. The comparison shows what changed, and its consequences
/// for modes, transmissibilities and peaks over cleats: those of --campaign, those that both campaigns measured, or
/// else 20, 30 and 40 km/h over 10 to 40 mm.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar compare axle_c axle_c_rigid_tm --params models/campaigns/axle_c_study --out compared\n  qcar compare models/campaigns/axle_a_rig models/campaigns/axle_c_study --format json\n  qcar compare models/campaigns/axle_a_rig/campaign.toml models/campaigns/axle_a_rig/truth.toml --campaign models/campaigns/axle_a_rig"
)]
pub struct Arguments {
    /// Parameter file, model or campaign folder
    #[arg(value_name = "A")]
    first: String,
    /// The other one, of the same kind
    #[arg(value_name = "B")]
    second: String,
    /// The model of both parameter sets or campaigns, by name or path, instead of their own
    #[arg(long, add = ArgValueCompleter::new(completion::models))]
    model: Option<String>,
    /// Compare both with the runs of this campaign; all other values take precedence over its values
    #[arg(long, value_name = "DIR")]
    campaign: Option<PathBuf>,
    /// Parameter values of both, over which those of A and B take precedence: a TOML file with [parameters], fit.json
    /// or a campaign folder
    #[arg(long, value_name = "FILE")]
    params: Option<PathBuf>,
    /// A single value for both, which takes precedence over all files; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<Setting>,
    /// Frequencies of channels that no run measures: first and last in Hz and the number of lines, spaced
    /// logarithmically
    #[arg(long, value_name = "FROM:TO:LINES", default_value = "0.5:50:300")]
    frequencies: Frequencies,
    /// Write report.html, compare.json and the tables as CSV into this folder
    #[arg(long, value_name = "DIR", value_parser = folder_for_results)]
    out: Option<PathBuf>,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// The files of a comparison.
const RESULTS: Results = Results {
    record: "compare.json",
    names: ["/a/name", "/b/name"],
    between: "beside",
    files: &["parameters.csv", "transmissibility.csv", "cleat.csv", "report.html"],
};

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let subject = Subject::of(&arguments.first, &arguments.second)?;
    if let Some(folder) = &arguments.out {
        let names = subject.names();
        RESULTS.check(folder, names.each_ref().map(String::as_str), None)?;
    }
    let comparison = gather::gather(&subject, arguments)?;
    let contents = contents::Contents::of(&comparison);
    let json = || json::line(&contents.result);
    if let Some(folder) = &arguments.out {
        put(folder, "compare.json", &json())?;
        put(folder, "parameters.csv", &render::parameters_csv(&comparison))?;
        put(folder, "transmissibility.csv", &render::ratios_csv(&comparison))?;
        put(folder, "cleat.csv", &render::cleat_runs_csv(&comparison))?;
        let title = format!("{} beside {}", contents.result.a.name, contents.result.b.name);
        put(
            folder,
            "report.html",
            &page(Report::Comparison, &title, &contents, None),
        )?;
    }
    Ok(match arguments.format {
        Format::Text => prose(&render::text(&comparison, &contents.result, arguments.out.as_deref())),
        Format::Json => json(),
    })
}
