//! Form of a report: with the lines of the file, or one line per mistake for build scripts.

use std::fmt;

use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, NamedSource, SourceSpan};

use super::{Diagnostic, Label, Report, Severity};
use crate::source::{Source, Span};

impl fmt::Display for Report {
    /// Without colour, the same on every machine.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let handler = GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor()).with_width(110);
        for (index, diagnostic) in self.diagnostics.iter().take(MOST).enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            handler.render_report(f, &Rendered::new(diagnostic, &self.sources))?;
        }
        f.write_str(&self.further())
    }
}

impl Report {
    /// One line for each mistake: `file:line:column: message; write: …`.
    pub fn compact(&self) -> String {
        let line = |diagnostic| self.compact_line(diagnostic) + "\n";
        self.diagnostics.iter().take(MOST).map(line).collect::<String>() + &self.further()
    }

    /// A line that counts the omitted mistakes.
    fn further(&self) -> String {
        match self.diagnostics.len().saturating_sub(MOST) {
            0 => String::new(),
            more => format!("and {more} more mistakes; correct the first ones and try again\n"),
        }
    }

    /// The line of one mistake.
    pub fn compact_line(&self, diagnostic: &Diagnostic) -> String {
        let place = diagnostic
            .labels
            .first()
            .map_or(String::new(), |label| self.place(label.span) + ": ");
        format!("{place}{}; {}", diagnostic.message, diagnostic.hint.replace('\n', " "))
    }

    /// `file:line:column`, or nothing but the name for a source without text.
    fn place(&self, span: Span) -> String {
        self.sources
            .get(usize::from(span.source))
            .map_or(String::new(), |source| place(source, span))
    }
}

fn place(source: &Source, span: Span) -> String {
    if source.text.is_empty() {
        return source.name.clone();
    }
    let (line, column) = source.line_column(span.start);
    format!("{}:{line}:{column}", source.name)
}

/// Largest number of mistakes in a report: further ones most often follow from the first.
const MOST: usize = 25;

/// Longest line that is shown, bytes; the width of a formatted number is limited to 65 535.
const LONGEST_LINE: usize = 2000;

/// True if the lines around a position can be shown.
fn is_shown(source: &Source, span: Span) -> bool {
    let first = source.line_column(span.start).0;
    let last = source.line_column(span.end).0;
    let lines = source.text.lines().skip(first.saturating_sub(2)).take(last - first + 3);
    !source.text.is_empty() && lines.map(str::len).all(|length| length <= LONGEST_LINE)
}

/// A diagnostic as miette wants it: one source, its labels as byte ranges, everything else in the help text.
#[derive(Debug)]
struct Rendered {
    code: String,
    message: String,
    severity: miette::Severity,
    help: String,
    source: Option<NamedSource<String>>,
    labels: Vec<LabeledSpan>,
}

impl Rendered {
    fn new(diagnostic: &Diagnostic, sources: &[Source]) -> Rendered {
        let home = diagnostic.labels.first().map_or(0, |label| label.span.source);
        let own = diagnostic.labels.iter().filter(|label| label.span.source == home);
        let is_shown = |source: &&Source| own.clone().all(|label| is_shown(source, label.span));
        let source = sources.get(usize::from(home)).filter(is_shown);
        let here = |label: &&Label| label.span.source == home && source.is_some();
        let elsewhere = diagnostic.labels.iter().filter(|label| !here(label));
        let notes = elsewhere.filter_map(|label| {
            let source = sources.get(usize::from(label.span.source))?;
            Some(format!("\n{}: {}", place(source, label.span), label.text))
        });
        Rendered {
            code: format!("qcar::{}", diagnostic.code.name()),
            message: diagnostic.message.clone(),
            severity: match diagnostic.severity {
                Severity::Error => miette::Severity::Error,
                Severity::Warning => miette::Severity::Warning,
            },
            help: diagnostic.hint.clone() + &notes.collect::<String>(),
            source: source.map(|source| NamedSource::new(&source.name, source.text.clone())),
            labels: diagnostic.labels.iter().filter(here).map(labeled).collect(),
        }
    }
}

fn labeled(label: &Label) -> LabeledSpan {
    let Span { start, end, .. } = label.span;
    let range = SourceSpan::new((start as usize).into(), end.saturating_sub(start) as usize);
    LabeledSpan::new_with_span(Some(label.text.clone()), range)
}

impl fmt::Display for Rendered {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Rendered {}

impl miette::Diagnostic for Rendered {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(&self.code))
    }

    fn severity(&self) -> Option<miette::Severity> {
        Some(self.severity)
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        (!self.help.is_empty()).then(|| Box::new(&self.help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        self.source.as_ref().map(|source| source as &dyn miette::SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.labels.iter().cloned()))
    }
}
