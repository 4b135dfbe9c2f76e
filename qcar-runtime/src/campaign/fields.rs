//! Reads TOML key by key. A getter records a problem and continues, so that one reading finds every problem.

use std::cell::RefCell;
use std::ops::Range;
use std::path::{Path, PathBuf};

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::contents::Axis;
use super::unit::{Declared, examples};
use crate::bounded;
use crate::error::{InputError, Place, Problem};
use crate::spelling;
use crate::syntax;

/// A TOML file with the problems found so far.
pub(super) struct Document {
    file: PathBuf,
    text: String,
    problems: RefCell<Vec<Problem>>,
}

/// A table of the document. After its getters, [`Section::finish`] refuses keys that were not read.
pub(super) struct Section<'a> {
    document: &'a Document,
    /// Prefix of its keys, such as `run[2].`; empty at the top.
    prefix: String,
    span: Range<usize>,
    table: &'a DeTable<'a>,
    asked: RefCell<Vec<&'static str>>,
}

impl Document {
    /// Reads a text file, which is TOML if [`Document::parse`] says so.
    pub fn read(file: &Path) -> Result<Document, InputError> {
        match bounded::text(file) {
            Ok(text) => Ok(Document {
                file: file.into(),
                text,
                problems: RefCell::default(),
            }),
            Err(error) => {
                let remedy = "give the folder of a campaign, and save its campaign.toml as UTF-8 text";
                Err(Problem::new(file, Place::File, error.to_string(), "a readable text file", remedy).into())
            }
        }
    }

    /// The syntax tree.
    pub fn parse(&self) -> Result<Spanned<DeTable<'_>>, InputError> {
        DeTable::parse(&self.text)
            .map_err(|error| syntax::of_toml(&self.file, &self.text, &error, "correct this line").into())
    }

    /// The top of the document.
    pub fn top<'a>(&'a self, tree: &'a Spanned<DeTable<'a>>) -> Section<'a> {
        self.section(String::new(), 0..0, tree.get_ref())
    }

    /// `value`, unless the document has problems.
    pub fn finish<T>(self, value: Option<T>) -> Result<T, InputError> {
        InputError::unless_empty(self.problems.into_inner(), value)
    }

    fn section<'a>(&'a self, prefix: String, span: Range<usize>, table: &'a DeTable<'a>) -> Section<'a> {
        Section {
            document: self,
            prefix,
            span,
            table,
            asked: RefCell::default(),
        }
    }

    fn place(&self, span: Range<usize>, key: String) -> Place {
        Place::in_text(&self.text, span.start, key)
    }

    fn note(&self, span: Range<usize>, key: String, found: String, expected: String, remedy: String) {
        let place = self.place(span, key);
        self.problems
            .borrow_mut()
            .push(Problem::new(&self.file, place, found, expected, remedy));
    }
}

impl<'a> Section<'a> {
    /// Records a problem of the value of `key`, or of the section if it has no such key.
    pub fn wrong(&self, key: &str, found: impl Into<String>, expected: impl Into<String>, remedy: impl Into<String>) {
        let span = self.table.get(key).map_or(self.span.clone(), Spanned::span);
        self.document
            .note(span, self.path(key), found.into(), expected.into(), remedy.into());
    }

    /// The value of a key as it stands in the document, with its unit; messages quote it so that it can be found.
    pub fn written(&self, key: &str) -> &str {
        let span = self.table.get(key).map_or(0..0, Spanned::span);
        self.document.text.get(span).unwrap_or("")
    }

    /// Records problems of a file that this one names.
    pub fn adopt(&self, error: InputError) {
        self.document.problems.borrow_mut().extend(error.problems);
    }

    /// A text.
    pub fn text(&self, key: &'static str) -> Option<String> {
        let value = self.required(key, "a text in quotes")?;
        self.typed(key, value.as_str().map(str::to_string), value, "a text in quotes")
    }

    /// A text; `None` if the key is missing.
    pub fn optional_text(&self, key: &'static str) -> Option<String> {
        self.optional(key).and_then(|_| self.text(key))
    }

    /// A text; empty if the key is missing.
    pub fn remark(&self, key: &'static str) -> String {
        self.optional_text(key).unwrap_or_default()
    }

    /// Texts; empty if the key is missing.
    pub fn texts(&self, key: &'static str) -> Vec<String> {
        let Some(value) = self.optional(key) else {
            return Vec::new();
        };
        let members = value
            .as_array()
            .map(|array| array.iter().map(|member| member.get_ref().as_str()));
        let texts = members.and_then(|members| members.map(|text| text.map(String::from)).collect());
        self.typed(key, texts, value, "texts in quotes, `[\"...\"]`")
            .unwrap_or_default()
    }

    /// True if the key exists.
    pub fn has(&self, key: &'static str) -> bool {
        self.optional(key).is_some()
    }

    /// A finite number; `None` if the key is missing.
    pub fn optional_number(&self, key: &'static str) -> Option<f64> {
        self.optional(key).and_then(|_| self.number(key))
    }

    /// A finite number.
    pub fn number(&self, key: &'static str) -> Option<f64> {
        let value = self.required(key, "a number")?;
        self.typed(key, number(value), value, "a finite number")
    }

    /// A finite number in a coherent SI unit, or a text of a number with a unit of its kind, such as `"30 km/h"`.
    pub fn quantity(&self, key: &'static str, si: &str) -> Option<f64> {
        let value = self.required(key, "a number")?;
        self.valued(key, value, Some(si))
    }

    /// A quantity; `None` if the key is missing.
    pub fn optional_quantity(&self, key: &'static str, si: &str) -> Option<f64> {
        self.optional(key).and_then(|_| self.quantity(key, si))
    }

    /// A number, or a text with a unit of the kind of `si` if that is known.
    fn valued(&self, key: &str, value: &DeValue<'_>, si: Option<&str>) -> Option<f64> {
        let Some(text) = value.as_str() else {
            return self.typed(key, number(value), value, "a finite number");
        };
        let quantity = Declared::quantity(text).filter(|(_, unit)| si.is_none_or(|si| unit.is_like(si)));
        if quantity.is_none() {
            let kind = si.map_or("a unit of mechanics".into(), examples);
            let expected = format!("a number with {kind}");
            self.wrong(key, format!("\"{text}\""), expected, "correct the value or its unit");
        }
        quantity.map(|(value, _)| value)
    }

    /// A quantity above zero.
    pub fn positive(&self, key: &'static str, si: &str) -> Option<f64> {
        let number = self.quantity(key, si)?;
        if number > 0.0 {
            return Some(number);
        }
        self.wrong(key, self.written(key), "a number above zero", "correct the value");
        None
    }

    /// `true` or `false`.
    pub fn boolean(&self, key: &'static str) -> Option<bool> {
        let value = self.required(key, "true or false")?;
        self.typed(key, value.as_bool(), value, "true or false")
    }

    /// `true` or `false`; the given default if the key is missing.
    pub fn flag(&self, key: &'static str) -> bool {
        self.optional(key).and_then(|_| self.boolean(key)).unwrap_or(false)
    }

    /// Lower and upper bound; `None` if the key is missing.
    pub fn range(&self, key: &'static str) -> Option<(f64, f64)> {
        let value = self.optional(key)?;
        let bounds = value
            .as_array()
            .and_then(|array| match array.iter().collect::<Vec<_>>()[..] {
                [lower, upper] => Some((number(lower.get_ref())?, number(upper.get_ref())?)),
                _ => None,
            });
        let (lower, upper) = self.typed(key, bounds, value, "two finite numbers, `[lower, upper]`")?;
        if lower < upper {
            return Some((lower, upper));
        }
        self.wrong(
            key,
            self.written(key),
            "the lower bound below the upper",
            "put them in that order",
        );
        None
    }

    /// One of several words.
    pub fn choice<T: Copy>(&self, key: &'static str, names: &[(&'static str, T)]) -> Option<T> {
        let words: Vec<_> = names.iter().map(|(name, _)| format!("\"{name}\"")).collect();
        let words = words.join(" or ");
        self.required(key, &words)?;
        let text = self.text(key)?;
        let choice = names.iter().find(|(name, _)| *name == text).map(|&(_, choice)| choice);
        if choice.is_none() {
            let remedy = match spelling::nearest(&text, names.iter().map(|(name, _)| *name)) {
                Some(nearest) => format!("did you mean \"{nearest}\"?"),
                None => "write one of these words".into(),
            };
            self.wrong(key, format!("\"{text}\""), words, remedy);
        }
        choice
    }

    /// The direction `axis`. Whether a model has it is not checked here: a campaign may be compared with several models.
    pub fn axis(&self) -> Option<Axis> {
        let name = self.text("axis")?;
        let is_name = spelling::is_name(&name);
        if !is_name {
            self.wrong(
                "axis",
                format!("\"{name}\""),
                "a direction of the model, such as \"z\" or \"x\"",
                "write the name of the direction as the model does, in lower case",
            );
        }
        is_name.then(|| Axis::new(name))
    }

    /// The sections of `[[key]]`, in the order of the file; empty if it is missing.
    pub fn sections(&self, key: &'static str) -> Vec<Section<'a>> {
        let Some(value) = self.optional(key) else {
            return Vec::new();
        };
        let Some(array) = value.as_array() else {
            self.typed(key, None::<()>, value, "an array of tables");
            return Vec::new();
        };
        let member = |(at, member): (usize, &'a Spanned<DeValue<'a>>)| {
            let path = format!("{}[{}]", self.path(key), at + 1);
            match member.get_ref().as_table() {
                Some(table) => Some(self.document.section(format!("{path}."), member.span(), table)),
                None => {
                    let found = member.get_ref().type_str().to_string();
                    self.document
                        .note(member.span(), path, found, "a table".into(), format!("write [[{key}]]"));
                    None
                }
            }
        };
        array.iter().enumerate().filter_map(member).collect()
    }

    /// The section `[key]`; `None` if it is missing.
    pub fn section(&self, key: &'static str) -> Option<Section<'a>> {
        let value = self.optional(key)?;
        let table = self.typed(key, value.as_table(), value, "a table")?;
        Some(
            self.document
                .section(format!("{}.", self.path(key)), self.table.get(key)?.span(), table),
        )
    }

    /// The sections `[this.NAME]` with their names, in the order of the file; this section may contain nothing else.
    pub fn named_sections(&self) -> Vec<(String, Section<'a>)> {
        let member = |name: &'a str| {
            let value = self.table.get(name)?;
            let table = self.typed(name, value.get_ref().as_table(), value.get_ref(), "a table")?;
            Some((
                name.to_string(),
                self.document
                    .section(format!("{}.", self.path(name)), value.span(), table),
            ))
        };
        self.names().into_iter().filter_map(member).collect()
    }

    /// The quantities of this section with their names, in the order of the file; it may contain nothing else. `si`
    /// gives the units of some names.
    pub fn quantities(&self, si: fn(&str) -> Option<&'static str>) -> Vec<(String, f64)> {
        let member = |name: &'a str| {
            let value = self.table.get(name)?.get_ref();
            Some((name.to_string(), self.valued(name, value, si(name))?))
        };
        self.names().into_iter().filter_map(member).collect()
    }

    /// Refuses keys that no getter has read.
    pub fn finish(&self) {
        let asked = self.asked.borrow();
        for name in self.names().into_iter().filter(|name| !asked.contains(name)) {
            let known: Vec<_> = asked.iter().map(|key| format!("`{key}`")).collect();
            let remedy = spelling::remedy(name, asked.iter().copied());
            self.wrong(name, "an unknown key", format!("one of {}", known.join(", ")), remedy);
        }
    }

    fn path(&self, key: &str) -> String {
        format!("{}{key}", self.prefix)
    }

    /// Keys in the order of the file; the tree sorts them by name.
    fn names(&self) -> Vec<&'a str> {
        let mut keys: Vec<_> = self.table.keys().collect();
        keys.sort_by_key(|key| key.span().start);
        keys.into_iter().map(|key| key.get_ref().as_ref()).collect()
    }

    fn optional(&self, key: &'static str) -> Option<&'a DeValue<'a>> {
        if !self.asked.borrow().contains(&key) {
            self.asked.borrow_mut().push(key);
        }
        self.table.get(key).map(Spanned::get_ref)
    }

    fn required(&self, key: &'static str, expected: &str) -> Option<&'a DeValue<'a>> {
        let value = self.optional(key);
        if value.is_none() {
            self.wrong(key, "no such key", expected, format!("add `{key} = ...`"));
        }
        value
    }

    fn typed<T>(&self, key: &str, value: Option<T>, raw: &DeValue<'_>, expected: &str) -> Option<T> {
        if value.is_none() {
            let found = match raw {
                DeValue::Float(number) => number.to_string(),
                other => format!("a value of type {}", other.type_str()),
            };
            self.wrong(key, found, expected, "correct the value");
        }
        value
    }
}

/// A decimal number, whole or not.
fn number(value: &DeValue<'_>) -> Option<f64> {
    let number = match value {
        DeValue::Integer(number) if number.radix() == 10 => number.as_str().parse().ok()?,
        DeValue::Float(number) => number.as_str().parse::<f64>().ok()?,
        _ => return None,
    };
    number.is_finite().then_some(number)
}
