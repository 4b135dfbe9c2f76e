//! `qcar check`: every rule of the compiler, on shipped models or on files.

use clap::Args;
use qcar_dsl::diagnostic::Report;
use qcar_dsl::resolve::options::Choices;
use qcar_dsl::schedule::Compiled;

use crate::catalogue;
use crate::failure::Failure;

/// Check models and say what to write instead
///
/// Without a name, all shipped models are checked. The exit status is 1 where a model is refused.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar check models/axles/quarter_car.axle\n  qcar check --members models/families/corner.axle"
)]
pub struct Arguments {
    /// Names of shipped models, or paths of model files
    models: Vec<String>,
    /// Of a family's file, check every member that its options allow
    #[arg(long)]
    members: bool,
}

/// Does it.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let named: Vec<&str> = match arguments.models.as_slice() {
        [] => catalogue::names().collect(),
        some => some.iter().map(String::as_str).collect(),
    };
    if arguments.members {
        return members(&named);
    }
    let results = named
        .iter()
        .map(|name| catalogue::compile(name))
        .collect::<Result<Vec<_>, _>>()?;
    let all_well = results.iter().all(Result::is_ok);
    let text = named
        .iter()
        .zip(results)
        .map(|(name, result)| verdict(name, result))
        .collect();
    if all_well {
        Ok(text)
    } else {
        Err(Failure::Finding(text))
    }
}

fn verdict(name: &str, result: Result<Compiled, Report>) -> String {
    match result {
        Err(report) => format!("{name}: refused\n{report}\n"),
        Ok(compiled) => match compiled.model.warnings() {
            warnings if warnings.diagnostics.is_empty() => format!("{name}: ok\n"),
            warnings => format!("{name}: ok, with warnings\n{warnings}\n"),
        },
    }
}

/// All members of all families, those that are refused with their options.
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
