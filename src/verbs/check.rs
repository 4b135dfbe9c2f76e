//! `qcar check`: the rules of the compiler for models, and the flaws of the data of campaigns.

use std::path::Path;

use crate::catalogue;
use crate::completion;
use crate::failure::Failure;
use crate::terminal::prose;
use clap::Args;
use clap_complete::engine::ArgValueCompleter;
use qcar_dsl::resolve::options::Choices;
use qcar_dsl::response::Wanted;

// Checks of a campaign.
mod campaign;

/// Check models for mistakes and suggest remedies, or campaigns for flaws of their samples
///
/// Without a name, all shipped models are checked. The exit status is 1 if a model is refused, or if a fit or another
/// verb would refuse a run of the campaign. Other flaws of a measurement (clipping, spikes, drift, dead channels) are
/// warnings.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar check models/axles/quarter_car.axle\n  qcar check models/campaigns/axle_a_rig\n  qcar check --members models/families/corner.axle"
)]
pub struct Arguments {
    /// Names of shipped models, paths of model files, or folders of campaigns
    #[arg(add = ArgValueCompleter::new(completion::models))]
    models: Vec<String>,
    /// For the file of a family, check every member that its options allow
    #[arg(long)]
    members: bool,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let named: Vec<&str> = match arguments.models.as_slice() {
        [] => catalogue::names().collect(),
        some => some.iter().map(String::as_str).collect(),
    };
    if arguments.members {
        return members(&named);
    }
    let verdicts = named.iter().map(|name| verdict(name)).collect::<Result<Vec<_>, _>>()?;
    let all_well = verdicts.iter().all(|(well, _)| *well);
    let text = prose(&verdicts.into_iter().map(|(_, text)| text).collect::<String>());
    if all_well {
        Ok(text)
    } else {
        Err(Failure::Finding(text))
    }
}

/// True if a model or a campaign has no fault, and the text to print.
fn verdict(name: &str) -> Result<(bool, String), Failure> {
    let path = Path::new(name);
    if path.is_dir() || path.ends_with("campaign.toml") {
        return campaign::verdict(path);
    }
    Ok(match catalogue::compile(name, Wanted::Values)? {
        Err(report) => (false, format!("{name}: refused\n{report}\n")),
        Ok(compiled) => match compiled.model.warnings() {
            warnings if warnings.diagnostics.is_empty() => (true, format!("{name}: ok\n")),
            warnings => (true, format!("{name}: ok, with warnings\n{warnings}\n")),
        },
    })
}

/// All members of all families; members that are refused with their options.
fn members(files: &[&str]) -> Result<String, Failure> {
    let mut text = String::new();
    let mut all_well = true;
    for file in files {
        let members = catalogue::members(file)?;
        let refused: Vec<_> = members
            .iter()
            .filter_map(|(choices, result)| Some((choices, result.as_ref().err()?)))
            .collect();
        all_well &= refused.is_empty();
        text += &format!("{file}: {} members, {} refused\n", members.len(), refused.len());
        text.extend(
            refused
                .iter()
                .map(|(choices, report)| format!("{}\n{report}\n", options(choices))),
        );
    }
    if all_well {
        Ok(text)
    } else {
        Err(Failure::Finding(text))
    }
}

fn options(choices: &Choices) -> String {
    choices
        .iter()
        .map(|(option, value)| format!("{option} = {value}; "))
        .collect()
}
