//! Mistakes of outputs and identifiability.

use super::{Code, Diagnostic, all_of};
use crate::source::Span;

/// A model without outputs.
pub fn no_outputs(span: Span) -> Diagnostic {
    Diagnostic::error(Code::NoOutputs, "the model has no output: no mass, and no `output`")
        .label(span, "this model")
        .hint("write an output, such as `output damper.force;`")
}

/// A model that no input moves.
pub fn no_excitation(span: Span) -> Diagnostic {
    Diagnostic::warning(Code::NoExcitation, "no road, motion or force excites this model")
        .label(span, "only free vibrations")
        .hint("write `road pad;`, `motion rod;` or `force f on body;`")
}

/// A parameter that no response depends on.
pub fn parameter_undetermined(span: Span, name: &str) -> Diagnostic {
    Diagnostic::warning(
        Code::ParameterUndetermined,
        format!("no output depends on parameter `{name}`"),
    )
    .label(span, "changes no response")
    .hint(format!(
        "write `known param {name}: …` if it is given, or an output that depends on it"
    ))
}

/// Parameters of which the outputs determine fewer combinations than there are parameters.
pub fn only_in_combination(parameters: &[(Span, &str)], seen: usize, combination: Option<&str>) -> Diagnostic {
    let names: Vec<&str> = parameters.iter().map(|(_, name)| *name).collect();
    let what = match (combination, seen) {
        (Some(combination), _) => format!("`{combination}`"),
        (None, 1) => "one combination of them".to_string(),
        (None, _) => format!("{seen} combinations of them"),
    };
    let given = all_of(&names[seen.min(names.len())..]);
    let message = format!(
        "no output can distinguish {}: it depends only on {what}",
        all_of(&names)
    );
    let diagnostic = Diagnostic::warning(Code::OnlyInCombination, message).hint(format!(
        "write `known param …` for {given} if given elsewhere, or replace them by one parameter"
    ));
    parameters.iter().fold(diagnostic, |diagnostic, (span, _)| {
        diagnostic.label(*span, "not distinguishable from the others")
    })
}
