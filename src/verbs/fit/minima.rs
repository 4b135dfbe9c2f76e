//! The distinct minima of a fit as text, the parameters of one beside those of the others.

use qcar_runtime::fit::report::ParameterFit;

use crate::table::{Table, number};
use crate::units;

/// Number of other minima in the text output; JSON has all.
const SHOWN: usize = 4;

/// A minimum that is not the result.
pub(super) struct Other {
    /// Measures of its quality, under the headings of [`text`].
    pub figures: Vec<String>,
    /// Fitted parameters, SI; `None` for a name that the model lacks.
    pub values: Vec<Option<f64>>,
}

/// A row for each measure of the minima, then one for each fitted parameter; empty if there is only one minimum.
///
/// The values of an [`Other`] are in the order of the fitted ones of `parameters`.
pub(super) fn text(figures: &[(&str, String)], parameters: &[ParameterFit], others: &[Other]) -> String {
    if others.is_empty() {
        return String::new();
    }
    let shown = &others[..others.len().min(SHOWN)];
    let numbers = (2..shown.len() + 2).map(|at| at.to_string());
    let headings = ["minimum", "unit", "1"].map(String::from).into_iter().chain(numbers);
    let mut table = Table::with_headings(headings.collect());
    for (at, (name, best)) in figures.iter().enumerate() {
        let there = shown.iter().map(|own| own.figures[at].clone());
        let here = [name.to_string(), String::new(), best.clone()];
        table.row(here.into_iter().chain(there).collect());
    }
    for (at, own) in parameters.iter().filter(|own| own.fitted).enumerate() {
        let value = |value: f64| number(units::value(value, &own.unit), 5);
        let here = [own.name.clone(), units::name(&own.unit).into(), value(own.value)];
        let there = shown.iter().map(|other| other.values[at].map_or("-".into(), value));
        table.row(here.into_iter().chain(there).collect());
    }
    let left = match others.len() - shown.len() {
        0 => String::new(),
        more => format!("{more} more minima are in the JSON\n"),
    };
    format!("distinct minima, of which 1 is the result\n{}{left}", table.text())
}
