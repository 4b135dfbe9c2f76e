//! A cursor over tokens. It is `Copy`, so that looking ahead and starting over are assignments.

use std::cell::{Cell, RefCell};

use proc_macro2::{Delimiter, Spacing, TokenTree};
use syn::buffer::Cursor;
use syn::{Lit, ext::IdentExt};

use crate::diagnostic::{Diagnostic, reading};
use crate::front::syntax::Name;
use crate::source::Span;

/// The result of parsing: a value or a mistake, which is boxed because it is large and rare.
pub type Parsed<T> = Result<T, Box<Diagnostic>>;

/// Marks of two characters. If one follows, its first character is not read as a mark of its own.
const PAIRS: [&str; 7] = ["==", "!=", "<=", ">=", "&&", "||", ".."];

/// Expressions with more parts than this are refused, since later stages recurse over them.
const LONGEST: u32 = 250;

/// State that all cursors over one source share.
pub struct Context {
    /// The index of the source.
    pub source: u16,
    /// The length of its text; `None` for the tokens of an inline macro.
    pub length: Option<u32>,
    /// The Rust compiler's positions of an inline macro's tokens, in the order in which they were requested.
    pub places: RefCell<Vec<proc_macro2::Span>>,
    /// The mistakes so far.
    pub found: RefCell<Vec<Diagnostic>>,
    /// Number of parts of the current expression so far.
    pub parts: Cell<u32>,
}

impl Context {
    fn place(&self, span: proc_macro2::Span) -> Span {
        let (start, end) = match self.length {
            Some(_) => (span.byte_range().start as u32, span.byte_range().end as u32),
            None => {
                let mut places = self.places.borrow_mut();
                places.push(span);
                (places.len() as u32 - 1, places.len() as u32)
            }
        };
        Span {
            source: self.source,
            start,
            end,
        }
    }
}

/// A position among the tokens of a source, and the end of the enclosing block.
#[derive(Clone, Copy)]
pub struct Tokens<'a> {
    cursor: Cursor<'a>,
    context: &'a Context,
    /// Position of the closing bracket; `None` at the outermost level.
    close: Option<Span>,
}

impl<'a> Tokens<'a> {
    /// The outermost level of a source.
    pub fn new(cursor: Cursor<'a>, context: &'a Context) -> Tokens<'a> {
        Tokens {
            cursor,
            context,
            close: None,
        }
    }

    /// True if no token is left in the block.
    pub fn at_end(&self) -> bool {
        self.cursor.eof()
    }

    /// The position of the next token, or of the end of the block.
    pub fn span(&self) -> Span {
        let end = self.context.length.unwrap_or(0);
        match (self.at_end(), self.close, self.context.length) {
            (true, Some(close), _) => close,
            (true, None, Some(_)) => Span {
                source: self.context.source,
                start: end,
                end,
            },
            _ => self.context.place(self.cursor.span()),
        }
    }

    /// From a position to the end of the last token that was taken.
    pub fn span_from(&self, start: Span) -> Span {
        start.join(self.context.place(self.cursor.prev_span()))
    }

    /// The next token in words, for messages.
    pub fn found(&self) -> String {
        match self.cursor.token_tree() {
            None if self.close.is_some() => "the end of the block".to_string(),
            None => "the end of the file".to_string(),
            Some((TokenTree::Group(group), _)) => match group.delimiter() {
                Delimiter::Parenthesis => "`(`".to_string(),
                Delimiter::Bracket => "`[`".to_string(),
                _ => "`{`".to_string(),
            },
            Some((TokenTree::Literal(literal), _)) if literal.to_string().starts_with('"') => "a sentence".to_string(),
            Some((token, _)) => PAIRS
                .into_iter()
                .find(|pair| self.after(pair).is_some())
                .map_or_else(|| format!("`{token}`"), |pair| format!("`{pair}`")),
        }
    }

    /// Records a mistake; parsing continues.
    pub fn report(&self, diagnostic: Diagnostic) {
        self.context.found.borrow_mut().push(diagnostic);
    }

    /// Fails because `expected` is not at this position.
    pub fn expected<T>(&self, expected: &str, example: &str) -> Parsed<T> {
        Err(Box::new(reading::expected(
            self.span(),
            expected,
            &self.found(),
            example,
        )))
    }

    /// The next token, if it is a word.
    pub fn peek(&self) -> Option<String> {
        self.cursor.ident().map(|(ident, _)| ident.unraw().to_string())
    }

    /// Takes the next token if it is this word.
    pub fn take_word(&mut self, word: &str) -> bool {
        let next = self.cursor.ident().filter(|(ident, _)| ident == word);
        next.map(|(_, after)| self.cursor = after).is_some()
    }

    /// Takes a word, whatever it is.
    pub fn any_word(&mut self) -> Option<Name> {
        let span = self.span();
        let (ident, after) = self.cursor.ident()?;
        self.cursor = after;
        Some(Name {
            text: ident.unraw().to_string(),
            span,
        })
    }

    /// Takes a name that is declared elsewhere.
    pub fn name(&mut self, what: &str, example: &str) -> Parsed<Name> {
        let at = *self;
        self.any_word().map_or_else(|| at.expected(what, example), Ok)
    }

    /// Takes a name that is declared here; reserved names are reported.
    pub fn new_name(&mut self, what: &str, example: &str) -> Parsed<Name> {
        let name = self.name(what, example)?;
        if let Some(owner) = owner(&name.text) {
            self.report(reading::reserved_name(name.span, &name.text, owner));
        } else if name.text.chars().any(|c| c.is_uppercase()) {
            self.report(reading::name_not_lower_case(name.span, &name.text));
        }
        Ok(name)
    }

    /// The cursor after a mark, if it is next.
    fn after(&self, mark: &str) -> Option<Cursor<'a>> {
        let mut cursor = self.cursor;
        for (place, expected) in mark.chars().enumerate() {
            let (punct, after) = cursor.punct().filter(|(punct, _)| punct.as_char() == expected)?;
            if place + 1 < mark.len() && punct.spacing() == Spacing::Alone {
                return None;
            }
            cursor = after;
        }
        let is_half = mark.len() == 1
            && PAIRS
                .iter()
                .any(|pair| pair.starts_with(mark) && self.after(pair).is_some());
        (!is_half).then_some(cursor)
    }

    /// True if a mark is next.
    pub fn sees(&self, mark: &str) -> bool {
        self.after(mark).is_some()
    }

    /// Takes a mark if it is next.
    pub fn take(&mut self, mark: &str) -> bool {
        self.after(mark).map(|after| self.cursor = after).is_some()
    }

    /// Takes a mark that must be next.
    pub fn expect(&mut self, mark: &str, example: &str) -> Parsed<()> {
        if self.take(mark) {
            Ok(())
        } else {
            self.expected(&format!("`{mark}`"), example)
        }
    }

    /// Takes a sentence if it is next; empty otherwise.
    pub fn sentence(&mut self) -> String {
        let Some((literal, after)) = self.cursor.literal() else {
            return String::new();
        };
        let Lit::Str(text) = Lit::new(literal) else {
            return String::new();
        };
        self.cursor = after;
        text.value()
    }

    /// Takes a text that must be next.
    pub fn text(&mut self, what: &str, example: &str) -> Parsed<(String, Span)> {
        let span = self.span();
        let is_text = self
            .cursor
            .literal()
            .is_some_and(|(literal, _)| matches!(Lit::new(literal), Lit::Str(_)));
        if is_text {
            Ok((self.sentence(), span))
        } else {
            self.expected(what, example)
        }
    }

    /// Takes a number if it is next: its digits as written, its value, and the letters that follow without a space.
    pub fn digits(&mut self) -> Option<(String, f64, String)> {
        let (literal, after) = self.cursor.literal()?;
        let (digits, value, suffix) = match Lit::new(literal) {
            Lit::Int(lit) => (lit.to_string(), lit.base10_digits().parse(), lit.suffix().to_string()),
            Lit::Float(lit) => (lit.to_string(), lit.base10_digits().parse(), lit.suffix().to_string()),
            _ => return None,
        };
        self.cursor = after;
        Some((
            digits.strip_suffix(&suffix).unwrap_or(&digits).to_string(),
            value.unwrap_or(f64::INFINITY),
            suffix,
        ))
    }

    /// If a group of brackets is next, moves behind it and returns a cursor over its content.
    pub fn group(&mut self, delimiter: Delimiter) -> Option<Tokens<'a>> {
        let (inside, span, after) = self.cursor.group(delimiter)?;
        self.cursor = after;
        Some(Tokens {
            cursor: inside,
            context: self.context,
            close: Some(self.context.place(span.close())),
        })
    }

    /// Moves behind a block that must be next and returns a cursor over its content.
    pub fn block(&mut self, example: &str) -> Parsed<Tokens<'a>> {
        let at = *self;
        self.group(Delimiter::Brace)
            .map_or_else(|| at.expected("`{`", example), Ok)
    }

    /// Fails if tokens are left in a group.
    pub fn finished(&self, example: &str) -> Parsed<()> {
        if self.at_end() {
            Ok(())
        } else {
            self.expected("nothing more", example)
        }
    }

    /// Moves behind the next `;` or block, where the next statement begins.
    pub fn skip_statement(&mut self) {
        while let Some((token, after)) = self.cursor.token_tree() {
            self.cursor = after;
            let is_block = matches!(&token, TokenTree::Group(group) if group.delimiter() == Delimiter::Brace);
            let is_semicolon = matches!(&token, TokenTree::Punct(punct) if punct.as_char() == ';');
            if is_semicolon || (is_block && self.peek().as_deref() != Some("else")) {
                self.take(";");
                return;
            }
        }
    }

    /// Parses parts to the end of a block. A part with a mistake is left out; the others are kept.
    pub fn each<Part>(mut self, mut parse: impl FnMut(&mut Tokens<'a>) -> Parsed<Part>) -> Vec<Part> {
        let mut parts = Vec::new();
        while !self.at_end() {
            let start = self;
            match parse(&mut self) {
                Ok(part) => parts.push(part),
                Err(diagnostic) => {
                    self.report(*diagnostic);
                    self = start;
                    self.skip_statement();
                }
            }
        }
        parts
    }

    /// Counts one more part of the current expression.
    pub fn count_part(&self) -> Parsed<()> {
        let parts = self.context.parts.get() + 1;
        self.context.parts.set(parts);
        if parts > LONGEST {
            Err(Box::new(reading::nested_too_deep(self.span())))
        } else {
            Ok(())
        }
    }

    /// Parses an entry of a list. Entries are not nested, so the parts of one do not count for the next.
    pub fn entry<Part>(&mut self, parse: impl FnOnce(&mut Self) -> Parsed<Part>) -> Parsed<Part> {
        let parts = self.context.parts.get();
        let part = parse(self);
        self.context.parts.set(parts);
        part
    }

    /// Sets the count of parts to zero.
    pub fn reset_parts(&self) {
        self.context.parts.set(0);
    }
}

/// The owner of a reserved name; `None` for a free one.
fn owner(name: &str) -> Option<&'static str> {
    match name {
        "s" => Some("the stretch of a link"),
        "v" => Some("the rate of a link's stretch"),
        _ if FUNCTIONS.contains(&name) => Some("a function"),
        _ if syn::parse_str::<syn::Ident>(name).is_err() => Some("a word of Rust, into which models are compiled"),
        _ => None,
    }
}

/// The functions of the language.
pub const FUNCTIONS: [&str; 14] = [
    "abs", "sign", "sqrt", "exp", "ln", "sin", "cos", "tan", "atan", "tanh", "min", "max", "pow", "table",
];
