//! Mistakes of what can be seen.

use super::{Code, Diagnostic, all_of};
use crate::source::Span;

/// A model with nothing to see.
pub fn nothing_to_see(span: Span) -> Diagnostic {
    Diagnostic::error(Code::NothingToSee, "there is nothing to see: no mass, and no output")
        .label(span, "this model")
        .hint("write an output, such as `output damper.force;`")
}

/// A model that no input moves.
pub fn nothing_moves(span: Span) -> Diagnostic {
    Diagnostic::warning(Code::NothingMoves, "no road, motion or force moves this model")
        .label(span, "only free vibrations")
        .hint("write `road pad;`, `motion rod;` or `force f on body;`")
}

/// A parameter that no response depends on.
pub fn parameter_not_seen(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error(Code::ParameterNotSeen, format!("no output can see parameter `{name}`"))
        .label(span, "changes no response")
        .hint(format!(
            "write `known param {name}: …` if it is given, or an output that depends on it"
        ))
}

/// Parameters of which outputs see a combination only.
pub fn only_together(parameters: &[(Span, &str)], combination: Option<&str>) -> Diagnostic {
    let names: Vec<&str> = parameters.iter().map(|(_, name)| *name).collect();
    let what = combination.map_or("a combination of them".to_string(), |combination| {
        format!("`{combination}`")
    });
    let last = names.last().copied().unwrap_or_default();
    let message = format!("no output can tell {} apart: it sees {what} only", all_of(&names));
    let diagnostic = Diagnostic::error(Code::OnlyTogether, message).hint(format!(
        "write one parameter instead, or declare one as given: `known param {last}: …`"
    ));
    parameters.iter().fold(diagnostic, |diagnostic, (span, _)| {
        diagnostic.label(*span, "not to be told from the others")
    })
}
