//! The front end in one function: text or tokens to a checked model, or to a report of every mistake.

use proc_macro2::TokenStream;
use quote::quote_spanned;

use crate::check::{Checked, check};
use crate::diagnostic::{Diagnostic, Report, Severity, names, reading};
use crate::front::canonical::canonical;
use crate::front::parse::{Reading, parse_text, parse_tokens};
use crate::front::resolve::options::{Choices, member, members, select};
use crate::front::resolve::resolve;
use crate::front::syntax::{Axle, AxleKind, Element, File, Item, Path};
use crate::source::{Load, Source, Span};

/// Reads, resolves and checks a model file. A family is checked as the member that its defaults choose.
///
/// # Errors
/// Fails with the report of every mistake and the texts that were read.
pub fn check_text(source: Source, load: Load) -> Result<Checked, Report> {
    let mut front = Front::new(source, load);
    let file = front.file();
    let checked = front.model(&file);
    front.finish(checked)
}

/// Reads, resolves and checks the tokens of an inline macro.
///
/// # Errors
/// Fails with one `compile_error!` for each mistake, at the mistaken token.
pub fn check_tokens(tokens: TokenStream, load: Load) -> Result<Checked, TokenStream> {
    let source = Source {
        name: "axle!".to_string(),
        text: String::new(),
    };
    let mut front = Front::new(source, load);
    let reading = parse_tokens(tokens);
    let places = reading.places.clone();
    let file = front.read(reading);
    let checked = front.model(&file);
    front.finish(checked).map_err(|report| compile_errors(&report, &places))
}

/// A member of a family: its options, and the result of its check.
pub type Member = (Choices, Result<Checked, Report>);

/// Checks every valid member of a family, in the order in which its options list their values.
///
/// # Errors
/// Fails if the file is no family or cannot be read; a refused member has its own report.
pub fn check_members(source: Source, load: Load) -> Result<Vec<Member>, Report> {
    let mut front = Front::new(source, load);
    let file = front.file();
    let family = match front.one_axle(&file) {
        Some(family) if !front.partial => family,
        _ => return Err(front.report()),
    };
    let one = |choices: Choices| {
        let mut front = Front {
            sources: front.sources.clone(),
            found: vec![],
            partial: false,
            load,
        };
        let checked = front.member(&member(family, &choices), Some(family), &elements(&file));
        (choices, front.finish(checked))
    };
    Ok(members(family).into_iter().map(one).collect())
}

/// State of the front end.
struct Front<'a> {
    sources: Vec<Source>,
    found: Vec<Diagnostic>,
    /// True if a text could not be read completely.
    partial: bool,
    load: Load<'a>,
}

impl<'a> Front<'a> {
    fn new(source: Source, load: Load<'a>) -> Front<'a> {
        Front {
            sources: vec![source.without_mark()],
            found: vec![],
            partial: false,
            load,
        }
    }

    /// Stores diagnostics. If a text could not be read completely, diagnostics about missing parts are ignored.
    fn note(&mut self, found: impl IntoIterator<Item = Diagnostic>) {
        let partial = self.partial;
        self.found.extend(
            found
                .into_iter()
                .filter(|diagnostic| !partial || diagnostic.code.is_of_units()),
        );
    }

    /// The tree of the first source.
    fn file(&mut self) -> File {
        let reading = parse_text(&self.sources[0], 0);
        self.read(reading)
    }

    fn read(&mut self, reading: Reading) -> File {
        self.partial |= refuses(&reading.mistakes);
        self.found.extend(reading.mistakes);
        reading.file
    }

    fn model(&mut self, file: &File) -> Option<Checked> {
        let axle = self.one_axle(file)?;
        let AxleKind::From(path) = &axle.kind else {
            return self.member(axle, None, &elements(file));
        };
        let family_file = self.load_family(path)?;
        let family = family_file.items.iter().find_map(|item| match item {
            Item::Axle(axle) if axle.kind == AxleKind::Family => Some(axle),
            _ => None,
        });
        let Some(family) = family else {
            self.note([names::not_a_family(path.span, &path.text)]);
            return None;
        };
        let all = [elements(&family_file), elements(file)].concat();
        self.member(axle, Some(family), &all)
    }

    /// The only axle of a file.
    fn one_axle<'f>(&mut self, file: &'f File) -> Option<&'f Axle> {
        let effect = file.items.iter().find_map(|item| match item {
            Item::Effect(effect) => Some(effect),
            _ => None,
        });
        if let Some(effect) = effect {
            self.note([reading::effect_is_no_model(effect.name.span)]);
            return None;
        }
        let axles = file.items.iter().filter_map(|item| match item {
            Item::Axle(axle) => Some(axle),
            Item::Element(_) | Item::Effect(_) => None,
        });
        let axles: Vec<&Axle> = axles.collect();
        match axles.as_slice() {
            [only] => Some(only),
            others => {
                let span = others.get(1).map_or(Span::default(), |second| second.name.span);
                self.note([reading::not_one_model(span, others.len())]);
                None
            }
        }
    }

    fn load_family(&mut self, path: &Path) -> Option<File> {
        let asking = &self.sources[usize::from(path.span.source)].name;
        match (self.load)(asking, &path.text) {
            Ok(source) => {
                let source = source.without_mark();
                let reading = parse_text(&source, self.sources.len() as u16);
                self.sources.push(source);
                Some(self.read(reading))
            }
            Err(reason) => {
                self.found
                    .push(names::family_not_loaded(path.span, &path.text, &reason));
                None
            }
        }
    }

    /// Resolves options and names, and checks. No stage begins if an earlier one has refused the model, except that
    /// units are checked in the readable part of a text.
    fn member(&mut self, axle: &Axle, family: Option<&Axle>, elements: &[&Element]) -> Option<Checked> {
        let mut found = vec![];
        let member = select(axle, family, &mut found);
        let chosen = !refuses(&found);
        self.note(found);
        if !chosen {
            return None;
        }
        let (model, found) = resolve(axle, &member, elements);
        let resolved = !self.partial && !refuses(&found);
        self.note(found);
        if !resolved {
            return None;
        }
        match check(model) {
            Ok((checked, warnings)) => {
                self.found.extend(warnings);
                Some(checked.with_text(canonical(axle, &member, elements)))
            }
            Err(found) => {
                self.found.extend(found);
                None
            }
        }
    }

    fn finish(self, checked: Option<Checked>) -> Result<Checked, Report> {
        let report = self.report();
        match checked {
            Some(checked) => Ok(checked.with_warnings(report)),
            None => Err(report),
        }
    }

    /// All diagnostics without duplicates, in the order of the texts.
    fn report(self) -> Report {
        let mut report = Report {
            sources: self.sources,
            diagnostics: vec![],
        };
        report.add(self.found);
        report
    }
}

fn refuses(found: &[Diagnostic]) -> bool {
    found.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
}

fn elements(file: &File) -> Vec<&Element> {
    file.items.iter().filter_map(as_element).collect()
}

fn as_element(item: &Item) -> Option<&Element> {
    match item {
        Item::Element(element) => Some(element),
        Item::Axle(_) | Item::Effect(_) => None,
    }
}

/// The mistakes of an inline macro at the positions of the Rust compiler.
fn compile_errors(report: &Report, places: &[proc_macro2::Span]) -> TokenStream {
    let errors = report
        .diagnostics
        .iter()
        .filter(|diagnostic| diagnostic.severity == Severity::Error);
    let error = |diagnostic: &Diagnostic| {
        let place = diagnostic
            .labels
            .first()
            .map(|label| label.span)
            .filter(|span| span.source == 0);
        let token = place.and_then(|span| places.get(span.start as usize).copied());
        let message = report.compact_line(diagnostic);
        quote_spanned!(token.unwrap_or_else(proc_macro2::Span::call_site)=> ::core::compile_error!{ #message })
    };
    errors.map(error).collect()
}
