//! Text or tokens to a syntax tree. `syn` reads the tokens, so that one grammar serves files and macros.

use std::cell::{Cell, RefCell};
use std::str::FromStr;
use std::sync::Mutex;

use proc_macro2::TokenStream;
use syn::buffer::TokenBuffer;

use crate::diagnostic::{Diagnostic, reading};
use crate::front::syntax::{Axle, AxleKind, File, Item, Path};
use crate::source::{Source, Span};

mod scan;
// A cursor over the tokens.
mod tokens;
// Units and numbers.
mod unit;
// Expressions and conditions.
mod expression;
// Syntax that models and laws share.
mod block;
// Statements of laws.
mod law;
// Statements of models.
mod statement;
// Statements of effects.
mod effect;

use statement::Scope;
pub use tokens::FUNCTIONS;
use tokens::{Context, Parsed, Tokens};

/// A syntax tree of the readable part of a text, and every mistake in it.
pub struct Reading {
    /// The readable part.
    pub file: File,
    /// In the order of the text.
    pub mistakes: Vec<Diagnostic>,
    /// The Rust compiler's positions of the tokens of an inline macro, indexed by [`Span::start`]; empty for a text.
    pub places: Vec<proc_macro2::Span>,
}

/// Reads a text. `index` is the place of the source in the list of sources, for the spans.
pub fn parse_text(source: &Source, index: u16) -> Reading {
    let mistakes = scan::scan(source, index);
    if !mistakes.is_empty() {
        return Reading {
            file: File::default(),
            mistakes,
            places: vec![],
        };
    }
    with_own_lexer(|| match TokenStream::from_str(&source.text) {
        Ok(tokens) => parse(tokens, index, Some(source.text.len() as u32)),
        Err(error) => {
            let range = error.span().byte_range();
            let span = Span {
                source: index,
                start: range.start as u32,
                end: range.end as u32,
            };
            let mistakes = vec![reading::unreadable(span, &error.to_string())];
            Reading {
                file: File::default(),
                mistakes,
                places: vec![],
            }
        }
    })
}

/// Reads the tokens of an inline macro.
pub fn parse_tokens(tokens: TokenStream) -> Reading {
    parse(tokens, 0, None)
}

/// Runs a function with the lexer of proc_macro2. Inside a procedural macro, the lexer of the Rust compiler would be
/// used, which gives the tokens of a string no positions. The choice of the lexer holds for the whole process, so
/// threads take turns.
fn with_own_lexer<Result>(read: impl FnOnce() -> Result) -> Result {
    static SWITCH: Mutex<()> = Mutex::new(());
    let _turn = SWITCH.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    proc_macro2::fallback::force();
    let result = read();
    proc_macro2::fallback::unforce();
    result
}

fn parse(tokens: TokenStream, source: u16, length: Option<u32>) -> Reading {
    let (places, found) = (RefCell::default(), RefCell::default());
    let context = Context {
        source,
        length,
        places,
        found,
        parts: Cell::new(0),
    };
    let buffer = TokenBuffer::new2(tokens);
    let items = Tokens::new(buffer.begin(), &context).each(item);
    Reading {
        file: File { items },
        mistakes: context.found.into_inner(),
        places: context.places.into_inner(),
    }
}

fn item(tokens: &mut Tokens) -> Parsed<Item> {
    const EXAMPLE: &str = "axle name { … }";
    match tokens.peek().as_deref() {
        Some("axle") => Ok(Item::Axle(axle(tokens)?)),
        Some("family") => Ok(Item::Axle(family(tokens)?)),
        Some("element") => {
            tokens.take_word("element");
            let name = tokens.new_name("the name of an element", "element maxwell(k: N/m, c: N s/m) { … }")?;
            Ok(Item::Element(law::element(tokens, name)?))
        }
        Some("effect") => {
            tokens.take_word("effect");
            Ok(Item::Effect(Box::new(effect::effect(tokens)?)))
        }
        _ => tokens.expected("`axle`, `family`, `element` or `effect`", EXAMPLE),
    }
}

fn axle(tokens: &mut Tokens) -> Parsed<Axle> {
    const EXAMPLE: &str = "axle name { … }` or `axle name from \"../families/corner.axle\" { … }";
    tokens.take_word("axle");
    let name = tokens.new_name("the name of an axle", EXAMPLE)?;
    if !tokens.take_word("from") {
        return rest_of_axle(tokens, AxleKind::Plain, Scope::Axle, name);
    }
    let (text, span) = tokens.text("the path of a family's file", EXAMPLE)?;
    rest_of_axle(tokens, AxleKind::From(Path { text, span }), Scope::Chosen, name)
}

fn family(tokens: &mut Tokens) -> Parsed<Axle> {
    tokens.take_word("family");
    let name = tokens.new_name("the name of a family", "family corner { … }")?;
    rest_of_axle(tokens, AxleKind::Family, Scope::Family, name)
}

fn rest_of_axle(tokens: &mut Tokens, kind: AxleKind, scope: Scope, name: crate::front::syntax::Name) -> Parsed<Axle> {
    let mut inside = tokens.block("axle name { … }")?;
    let doc = inside.sentence();
    Ok(Axle {
        kind,
        name,
        doc,
        body: statement::body(inside, scope),
    })
}
