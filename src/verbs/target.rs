//! `qcar target`: designs that meet targets.

use std::path::{Path, PathBuf};

use clap::Args;
use qcar_runtime::metric::Ground;
use qcar_runtime::response::parameters::Values;

use crate::catalogue;
use crate::export;
use crate::export::javascript::{declared, responses};
use crate::failure::Failure;
use crate::files::{folder_for_results, put};
use crate::json;
use crate::parameters::Setting;
use crate::report::{Report, page};
use crate::results::Results;
use crate::terminal::prose;
use crate::verbs::sensitivity::subject::{Subject, SubjectOptions};
use crate::verbs::{Format, fit};

// The targets file.
mod file;
// The targets as an optimisation task.
mod plan;
// The probability that targets hold.
mod design_uncertainty;
// The result.
mod gather;
// The result as text and CSV.
mod render;
// The result as a workbook.
mod workbook;
// The result for the report.
mod contents;

use contents::Contents;
use file::Read;
use gather::Answer;
use plan::Plan;

/// Find designs that meet targets: the cheapest one, the Pareto front, and the box of good designs
///
/// The file names a model or campaign, targets for its metrics (`qcar sensitivity MODEL --list` prints their names),
/// and the parameters that may change, with ranges, steps, costs and couplings; docs/targets.md describes it. The exit
/// status is 1 if no design is found that meets all targets.
#[derive(Args)]
#[command(after_help = "Example:\n  qcar target models/targets/axle_a.toml --out design")]
pub struct Arguments {
    /// A file with targets and parameters
    targets: PathBuf,
    /// A single value, which takes precedence over those of the files; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<Setting>,
    /// Seed of the random numbers
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Write report.html, target.json, results.xlsx and parameters.toml with the design into this folder
    #[arg(long, value_name = "DIR", value_parser = folder_for_results)]
    out: Option<PathBuf>,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// The files of a design.
const RESULTS: Results = Results {
    record: "target.json",
    names: ["/model", "/subject"],
    between: "for",
    files: &["parameters.toml", fit::workbook::FILE, "report.html"],
};

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let read = Read::of(&arguments.targets)?;
    let campaign = read.file.campaign.as_ref().map(|path| read.beside(path));
    let params = read.file.params.as_ref().map(|path| read.beside(path));
    let roads = read.roads()?;
    let beneath = SubjectOptions {
        campaign: campaign.as_deref(),
        params: params.as_deref(),
        set: &arguments.set,
        roads: &roads,
    };
    let subject = Subject::of(&read.subject(), &beneath)?;
    if let Some(folder) = &arguments.out {
        RESULTS.check(folder, [&subject.model.about().name, &subject.name], None)?;
    }
    let mut ground = subject.ground();
    let plan = Plan::of(&read, &subject, &mut ground)?;
    let wanted = [read.file.front.is_some(), read.file.space.is_some()];
    let chance = plan.sources.chance(&subject)?;
    let answer = gather::gather((&subject, &ground), &plan, chance, arguments.seed, wanted).ok_or_else(|| {
        let (found, expected) = (
            "no design in range that is stable and can be simulated",
            "ranges that contain such designs",
        );
        read.problem(
            &read.file.subject,
            "parameter.range",
            found,
            expected,
            "narrow the ranges",
        )
    })?;
    if let Some(folder) = &arguments.out {
        write(&answer, &plan, &subject, &ground, folder)?;
    }
    let result = match arguments.format {
        Format::Text => prose(&render::text(&answer)),
        Format::Json => json::line(&answer),
    };
    if answer.met {
        Ok(result)
    } else {
        Err(Failure::Finding(result))
    }
}

fn write(answer: &Answer, plan: &Plan, subject: &Subject, ground: &Ground<'_>, folder: &Path) -> Result<(), Failure> {
    let design = gather::design(plan, answer, subject);
    let contents = Contents::of(answer, &plan.moves, (subject, ground), [&subject.values, &design]);
    put(folder, "target.json", &json::line(answer))?;
    put(
        folder,
        "parameters.toml",
        &render::parameter_file(ground.about(), &design, &subject.vehicle),
    )?;
    workbook::write(answer, folder)?;
    let title = format!("{}: targets", answer.model);
    let program = program(subject, &design)?;
    Ok(put(
        folder,
        "report.html",
        &page(Report::Targets, &title, &contents, program.as_deref()),
    )?)
}

/// A linear model as JavaScript for the report, which computes its ratios with other values.
fn program(subject: &Subject, design: &Values) -> Result<Option<String>, Failure> {
    let about = subject.model.about();
    let ratios = declared(about);
    if ratios.is_empty() {
        return Ok(None);
    }
    let compiled = catalogue::compiled(&subject.source)?;
    let exported = export::Subject {
        compiled: &compiled,
        values: design.as_slice(),
    };
    Ok(Some(responses(exported, about, design, &ratios)))
}
