//! `qcar show`: each stage of a model, as text.

use clap::{Args, ValueEnum};
use clap_complete::engine::ArgValueCompleter;
use qcar_dsl::response::Wanted;
use qcar_dsl::show;

use crate::catalogue;
use crate::completion;
use crate::failure::Failure;
use crate::table::Table;

/// Show a stage of a model: its text, its equations, its matrices, its code
///
/// Without a name, the shipped models are listed.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar show\n  qcar show axle_a --stage equations\n  qcar show models/axles/quarter_car.axle --stage dot"
)]
pub struct Arguments {
    /// Name of a shipped model, or path of a model file
    #[arg(add = ArgValueCompleter::new(completion::models))]
    model: Option<String>,
    /// The stage to show
    #[arg(long, value_enum, default_value_t = Stage::Equations)]
    stage: Stage,
}

/// The stages, in the order of the data.
#[derive(Clone, Copy, ValueEnum)]
enum Stage {
    /// The model as a file, with its options resolved
    Model,
    /// The equations of motion
    Equations,
    /// The nonzeros of A, B, C and D
    Matrices,
    /// The generated module
    Rust,
    /// Equations and matrices as a LaTeX document
    Latex,
    /// Masses and links as a graph for Graphviz
    Dot,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    match &arguments.model {
        Some(model) => {
            let compiled = catalogue::compiled_wanted(model, arguments.stage.wants())?;
            Ok(show::show(&compiled, arguments.stage.into()))
        }
        None => list(),
    }
}

impl Stage {
    /// Only the generated module shows derivatives of responses.
    fn wants(self) -> Wanted<'static> {
        match self {
            Stage::Rust => Wanted::Jacobian,
            _ => Wanted::Values,
        }
    }
}

impl From<Stage> for show::Stage {
    fn from(stage: Stage) -> Self {
        match stage {
            Stage::Model => show::Stage::Model,
            Stage::Equations => show::Stage::Equations,
            Stage::Matrices => show::Stage::Matrices,
            Stage::Rust => show::Stage::Rust,
            Stage::Latex => show::Stage::Latex,
            Stage::Dot => show::Stage::Dot,
        }
    }
}

fn list() -> Result<String, Failure> {
    let mut table = Table::new(["model", "description"]);
    for name in catalogue::names() {
        let model = catalogue::load(name)?;
        table.row(vec![name.into(), model.about().doc.to_string()]);
    }
    Ok(table.text())
}
