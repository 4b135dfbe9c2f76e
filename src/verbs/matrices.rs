//! `qcar matrices`: the state-space matrices and their parameter Jacobians.

use clap::Args;
use qcar_dsl::response::Wanted;
use qcar_runtime::model::About;

use crate::catalogue;
use crate::failure::{Failure, flag};
use crate::json;
use crate::parameters;
use crate::state_space::{Rows, StateSpace, state_space, without_sensitivities};
use crate::table::{Table, number};
use crate::terminal::prose;
use crate::verbs::{Format, ModelArguments};

/// Print A, B, C, D and their derivatives by every parameter
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar matrices quarter_car --set k_tire=2e5\n  qcar matrices axle_a --params models/campaigns/axle_a_rig --axis z --format json"
)]
pub struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    /// Only this axis, such as z or x
    #[arg(long)]
    axis: Option<String>,
    /// Output format; JSON includes the parameter Jacobians
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let model = catalogue::load_wanted(&arguments.model.model, Wanted::Values)?;
    let about = model.about();
    check_axis(about, arguments.axis.as_deref())?;
    let values = parameters::resolve(about, arguments.model.params.as_deref(), &arguments.model.set)?;
    model.check_inertias(values.as_slice())?;
    let evaluate = match arguments.format {
        Format::Text => without_sensitivities,
        Format::Json => state_space,
    };
    let matrices = evaluate(&*model, &values, arguments.axis.as_deref());
    parameters::require_finite(&about.name, matrices.matrices.values().flatten().flatten())?;
    Ok(match arguments.format {
        Format::Text => prose(&text(&matrices)),
        Format::Json => json::line(&matrices),
    })
}

fn check_axis(about: &About, axis: Option<&str>) -> Result<(), Failure> {
    let axes: Vec<_> = about
        .states
        .iter()
        .map(|s| &*s.axis)
        .chain(about.inputs.iter().map(|i| &*i.axis))
        .collect();
    match axis {
        Some(axis) if !axes.contains(&axis) => {
            let found = format!("`{axis}`");
            let expected = format!("a direction of `{}`", about.name);
            Err(flag(
                "--axis",
                found,
                &expected,
                "name one that the model file declares, such as z",
            )
            .into())
        }
        _ => Ok(()),
    }
}

fn text(of: &StateSpace) -> String {
    let rows: Vec<&str> = of.states.iter().map(|s| &*s.name).collect();
    let inputs: Vec<&str> = of.inputs.iter().map(|i| &*i.variable).collect();
    let outputs: Vec<&str> = of.outputs.iter().map(|o| &*o.name).collect();
    let blocks = [
        ("A", &rows, &rows),
        ("B", &rows, &inputs),
        ("C", &outputs, &rows),
        ("D", &outputs, &inputs),
    ];
    let tables = blocks.map(|(name, rows, columns)| block(name, rows, columns, &of.matrices[name]));
    let note = if of.linear { "" } else { "Linearised at rest.\n\n" };
    format!("{note}{}", tables.join("\n"))
}

fn block(name: &str, rows: &[&str], columns: &[&str], values: &Rows) -> String {
    let mut table = Table::with_headings([name].iter().chain(columns).map(|c| c.to_string()).collect());
    for (row, values) in rows.iter().zip(values) {
        let numbers = values.iter().map(|&value| number(value, 6));
        table.row(std::iter::once(row.to_string()).chain(numbers).collect());
    }
    table.text()
}
