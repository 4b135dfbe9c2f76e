//! `qcar matrices`: the state-space matrices and their parameter Jacobians.

use clap::Args;
use qcar_dsl::response::Wanted;
use qcar_runtime::model::About;

use crate::catalogue;
use crate::failure::{Failure, flag};
use crate::json;
use crate::parameters;
use crate::state_space::{Rows, StateSpace, state_space, without_sensitivities};
use crate::table::{Table, noted_below, number};
use crate::terminal::prose;
use crate::units;
use crate::verbs::{Format, ModelArguments};

/// Print A, B, C, D and their derivatives by every parameter
///
/// A row of A and B is the rate of a state, its unit per second.
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
        Format::Text => prose(&(text(&matrices) + &noted_below(&matrices.notices))),
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

/// A state, input or output, and its SI unit.
type Named<'a> = (&'a str, &'a str);

fn text(of: &StateSpace) -> String {
    let states: Vec<Named> = of.states.iter().map(|state| (&*state.name, &*state.unit)).collect();
    let inputs: Vec<Named> = of.inputs.iter().map(|input| (&*input.variable, &*input.unit)).collect();
    let outputs: Vec<Named> = of.outputs.iter().map(|output| (&*output.name, &*output.unit)).collect();
    let blocks = [
        ("A", &states, &states),
        ("B", &states, &inputs),
        ("C", &outputs, &states),
        ("D", &outputs, &inputs),
    ];
    let tables = blocks.map(|(name, rows, columns)| block(name, rows, columns, &of.matrices[name]));
    let note = if of.linear { "" } else { "Linearised at rest.\n\n" };
    format!("{note}{}", tables.join("\n"))
}

fn block(name: &str, rows: &[Named], columns: &[Named], values: &Rows) -> String {
    let heading = |&(name, unit): &Named| units::heading(name, unit);
    let headings = std::iter::once(name.into()).chain(columns.iter().map(heading));
    let mut table = Table::with_headings(headings.collect());
    for (row, values) in rows.iter().zip(values) {
        let numbers = columns.iter().zip(values).map(|(column, &value)| {
            let per_column = value / units::value(1.0, column.1);
            number(units::value(per_column, row.1), 6)
        });
        table.row(std::iter::once(heading(row)).chain(numbers).collect());
    }
    table.text()
}
