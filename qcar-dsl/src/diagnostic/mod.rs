//! Catalogue of mistakes: every diagnostic has a code, a message, labels at its positions and a hint with the remedy.
//! There is one file of constructors for each stage of the front end.

use std::collections::BTreeSet;

use strsim::levenshtein;

use crate::source::{Source, Span};

mod code;
// Then the constructors, in the order of the stages.
pub mod reading;
// Options, names and elements.
pub mod names;
// Units, stretches and laws.
pub mod units;
// Curves through points.
pub mod tables;
// Support, solvability and passivity.
pub mod structure;
// Outputs and identifiability.
pub mod outputs;
// Effects and their places.
pub mod effects;
// The form of a report.
mod render;

pub use code::Code;

/// How severe a mistake is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Severity {
    /// The model is refused.
    Error,
    /// The model compiles, but something in it is probably a mistake.
    Warning,
}

/// A position with a short text.
#[derive(Clone, Debug)]
pub struct Label {
    /// The position.
    pub span: Span,
    /// A few words.
    pub text: String,
}

/// A mistake.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// The kind of mistake.
    pub code: Code,
    /// Error or warning.
    pub severity: Severity,
    /// One sentence without a full stop.
    pub message: String,
    /// Labels; the first is at the position of the mistake.
    pub labels: Vec<Label>,
    /// The remedy, as a sentence that says what to write.
    pub hint: String,
}

impl Diagnostic {
    /// True if both report the same at the same position.
    pub(crate) fn repeats(&self, other: &Diagnostic) -> bool {
        let place = |of: &Diagnostic| {
            let first = of.labels.first();
            first.map(|Label { span, .. }| (span.source, span.start, span.end))
        };
        self.code == other.code && place(self) == place(other) && self.message == other.message
    }

    fn error(code: Code, message: impl Into<String>) -> Diagnostic {
        let (labels, hint) = (Vec::new(), String::new());
        Diagnostic {
            code,
            severity: Severity::Error,
            message: message.into(),
            labels,
            hint,
        }
    }

    fn warning(code: Code, message: impl Into<String>) -> Diagnostic {
        Diagnostic {
            severity: Severity::Warning,
            ..Diagnostic::error(code, message)
        }
    }

    fn label(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.labels.push(Label {
            span,
            text: text.into(),
        });
        self
    }

    fn hint(mut self, hint: impl Into<String>) -> Diagnostic {
        self.hint = hint.into();
        self
    }
}

/// The mistakes of one compilation, with the texts that contain them.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// The model file first, then what it loads.
    pub sources: Vec<Source>,
    /// In the order of the stages, then of the text.
    pub diagnostics: Vec<Diagnostic>,
}

impl Report {
    /// True if the model is refused.
    pub fn refuses(&self) -> bool {
        self.diagnostics
            .iter()
            .any(|diagnostic| diagnostic.severity == Severity::Error)
    }

    /// Adds diagnostics without duplicates, and sorts all in the order of the texts.
    pub(crate) fn add(&mut self, found: Vec<Diagnostic>) {
        let place = |diagnostic: &Diagnostic| {
            let span = diagnostic.labels.first().map(|label| label.span).unwrap_or_default();
            (span.source, span.start)
        };
        let mut known = BTreeSet::new();
        self.diagnostics.extend(found);
        self.diagnostics
            .retain(|diagnostic| known.insert((diagnostic.code, place(diagnostic), diagnostic.message.clone())));
        self.diagnostics.sort_by_key(place);
    }
}

impl std::error::Error for Report {}

/// Words in backticks, joined by commas and a last `or`.
pub(crate) fn one_of<Word: AsRef<str>>(words: &[Word]) -> String {
    listed(words, "or")
}

/// Words in backticks, joined by commas and a last `and`.
fn all_of<Word: AsRef<str>>(words: &[Word]) -> String {
    listed(words, "and")
}

fn listed<Word: AsRef<str>>(words: &[Word], last: &str) -> String {
    let quoted: Vec<String> = words.iter().map(|word| format!("`{}`", word.as_ref())).collect();
    match quoted.split_last() {
        None => "nothing".to_string(),
        Some((only, [])) => only.clone(),
        Some((end, rest)) => format!("{} {last} {end}", rest.join(", ")),
    }
}

/// The candidate that a misspelt name most likely means. `None` if no candidate is near enough, or if the name has one
/// or two letters, which resemble any other name.
fn nearest<'a, Word: AsRef<str>>(name: &str, candidates: &'a [Word]) -> Option<&'a str> {
    let distance = |word: &&str| levenshtein(name, word);
    let best = candidates.iter().map(AsRef::as_ref).min_by_key(distance)?;
    let length = name.chars().count();
    (length > 2 && levenshtein(name, best) <= 1 + length / 4).then_some(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_name_finds_its_neighbour() {
        assert_eq!(nearest("k_tyre", &["c_tire", "k_tire"]), Some("k_tire"));
        assert_eq!(nearest("mass", &["k_tire"]), None);
        assert_eq!(nearest("c", &["s", "c_tire"]), None);
        assert_eq!(nearest("k2", &["k1"]), None);
        assert_eq!(nearest("pda", &["pad"]), None);
        assert_eq!(nearest("pat", &["pad"]), Some("pad"));
    }
}
