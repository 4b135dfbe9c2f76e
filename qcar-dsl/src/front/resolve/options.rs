//! Options: which statements of a family belong to one member.

use std::collections::{BTreeMap, BTreeSet};

use crate::diagnostic::{Diagnostic, names, reading};
use crate::front::syntax::{Axle, Choice, If, LawStatement, Link, Logic, Name, OptionTest, Requirement, Statement};
use crate::source::Span;

/// An option with its value, in the order of the family.
pub type Choices = Vec<(String, String)>;

/// One member of a family, or a plain axle: its statements without any `option`, `require` and `if`.
pub struct Member {
    /// In the order of the text.
    pub body: Vec<Statement>,
    /// The value of each option.
    pub choices: Choices,
    /// Names that are declared only in branches that were not chosen, with the options that decided this.
    pub off: BTreeMap<String, String>,
}

/// Selects the statements that the options of an axle choose: those of the family, then those of the axle.
pub fn select(axle: &Axle, family: Option<&Axle>, found: &mut Vec<Diagnostic>) -> Member {
    let options = Options::of(family.unwrap_or(axle), found);
    let choices = options.chosen_by(axle, found);
    options.select(&choices, axle, family, found)
}

/// Every choice of options that fulfils each `require`, in the order in which the family lists the values.
pub fn members(family: &Axle) -> Vec<Choices> {
    let options = Options::of(family, &mut Vec::new());
    let mut all: Vec<Choices> = vec![vec![]];
    for choice in &options.options {
        let with = |values: &Choices, value: &Name| {
            [values.clone(), vec![(choice.name.text.clone(), value.text.clone())]].concat()
        };
        all = all
            .iter()
            .flat_map(|values| choice.values.iter().map(move |value| with(values, value)))
            .collect();
    }
    all.retain(|choices| options.requirements.iter().all(|rule| holds(&rule.condition, choices)));
    all
}

/// The axle that chooses one member of a family.
pub fn member(family: &Axle, choices: &Choices) -> Axle {
    let statement = |(option, value): &(String, String)| Statement::Choose(Name::new(option), Name::new(value));
    Axle {
        body: choices.iter().map(statement).collect(),
        ..family.clone()
    }
}

struct Options<'a> {
    options: Vec<&'a Choice>,
    requirements: Vec<&'a Requirement>,
}

impl<'a> Options<'a> {
    fn of(family: &'a Axle, found: &mut Vec<Diagnostic>) -> Options<'a> {
        let mut options = Options {
            options: vec![],
            requirements: vec![],
        };
        for statement in &family.body {
            match statement {
                Statement::Option(choice) => options.declare(choice, found),
                Statement::Require(rule) => options.requirements.push(rule),
                _ => {}
            }
        }
        options.check_conditions(family, found);
        options
    }

    fn declare(&mut self, choice: &'a Choice, found: &mut Vec<Diagnostic>) {
        if let Some(first) = self.find(&choice.name.text) {
            let place = "the options";
            found.push(names::duplicate_name(
                choice.name.span,
                first.name.span,
                &choice.name.text,
                place,
            ));
        }
        if let Some(default) = &choice.default {
            check_value(choice, default, found);
        }
        self.options.push(choice);
    }

    fn find(&self, name: &str) -> Option<&'a Choice> {
        self.options.iter().copied().find(|choice| choice.name.text == name)
    }

    fn names(&self) -> Vec<String> {
        self.options.iter().map(|choice| choice.name.text.clone()).collect()
    }

    /// Checks that every test in every branch names an option and one of its values.
    fn check_conditions(&self, family: &Axle, found: &mut Vec<Diagnostic>) {
        let mut tests = Vec::new();
        self.requirements
            .iter()
            .for_each(|rule| tests_of(&rule.condition, &mut tests));
        tests_of_statements(&family.body, &mut tests, found);
        for test in &tests {
            match self.find(&test.option.text) {
                Some(choice) => check_value(choice, &test.value, found),
                None => found.push(names::unknown_option(
                    test.option.span,
                    &test.option.text,
                    &self.names(),
                )),
            }
        }
        let asked: BTreeSet<&str> = tests.iter().map(|test| test.option.text.as_str()).collect();
        let unused = self
            .options
            .iter()
            .filter(|choice| !asked.contains(choice.name.text.as_str()));
        found.extend(unused.map(|choice| names::unused_option(choice.name.span, &choice.name.text)));
    }

    /// The choices of an axle; options that it does not choose have their defaults.
    fn chosen_by(&self, axle: &Axle, found: &mut Vec<Diagnostic>) -> Choices {
        let mut chosen: BTreeMap<&str, &Name> = BTreeMap::new();
        for statement in &axle.body {
            let Statement::Choose(option, value) = statement else {
                continue;
            };
            match self.find(&option.text) {
                Some(choice) => check_value(choice, value, found),
                None => found.push(names::unknown_option(option.span, &option.text, &self.names())),
            }
            if let Some(first) = chosen.insert(&option.text, value) {
                found.push(names::duplicate_name(
                    option.span,
                    first.span,
                    &option.text,
                    "the choices",
                ));
            }
        }
        let mut choices = Vec::new();
        for choice in &self.options {
            let value = chosen
                .get(choice.name.text.as_str())
                .copied()
                .or(choice.default.as_ref());
            match value {
                Some(value) => choices.push((choice.name.text.clone(), value.text.clone())),
                None => found.push(names::option_not_chosen(
                    axle.name.span,
                    &choice.name.text,
                    &texts(&choice.values),
                )),
            }
        }
        choices
    }

    fn select(&self, choices: &Choices, axle: &Axle, family: Option<&Axle>, found: &mut Vec<Diagnostic>) -> Member {
        for rule in &self.requirements {
            let decided = choices.len() == self.options.len();
            if decided && !holds(&rule.condition, choices) {
                found.push(broken(rule, choices, axle.name.span));
            }
        }
        let mut selection = Selection {
            choices,
            off: BTreeMap::new(),
        };
        let of_family = family.map(|family| family.body.as_slice()).unwrap_or_default();
        let body = of_family
            .iter()
            .chain(&axle.body)
            .flat_map(|statement| selection.statement(statement))
            .collect();
        Member {
            body,
            choices: choices.clone(),
            off: selection.off,
        }
    }
}

fn broken(rule: &Requirement, choices: &Choices, axle: Span) -> Diagnostic {
    let state = state(&rule.condition, choices);
    names::requirement_failed(axle, rule.span, &rule.message, &rule.condition.to_string(), &state)
}

fn check_value(choice: &Choice, value: &Name, found: &mut Vec<Diagnostic>) {
    if !choice.values.iter().any(|known| known.text == value.text) {
        let values = texts(&choice.values);
        found.push(names::unknown_value(
            value.span,
            &choice.name.text,
            &value.text,
            &values,
        ));
    }
}

fn texts(names: &[Name]) -> Vec<String> {
    names.iter().map(|name| name.text.clone()).collect()
}

fn tests_of<'a>(condition: &'a Logic<OptionTest>, tests: &mut Vec<&'a OptionTest>) {
    match condition {
        Logic::Test(test) => tests.push(test),
        Logic::Not(part) => tests_of(part, tests),
        Logic::And(a, b) | Logic::Or(a, b) => {
            tests_of(a, tests);
            tests_of(b, tests);
        }
    }
}

/// Collects the tests, and reports options that are declared inside a branch.
fn tests_of_statements<'a>(body: &'a [Statement], tests: &mut Vec<&'a OptionTest>, found: &mut Vec<Diagnostic>) {
    for statement in body {
        match statement {
            Statement::If(choice) => {
                choice
                    .branches
                    .iter()
                    .for_each(|(condition, _)| tests_of(condition, tests));
                for part in parts(choice).flatten() {
                    if let Statement::Option(Choice { name, .. }) = part {
                        found.push(reading::misplaced_statement(
                            name.span,
                            "option",
                            "the family, outside of `if`",
                        ));
                    }
                }
                parts(choice).for_each(|part| tests_of_statements(part, tests, found));
            }
            Statement::Direction(direction) => tests_of_statements(&direction.body, tests, found),
            Statement::Link(link) => tests_of_law(&link.body, tests),
            _ => {}
        }
    }
}

fn tests_of_law<'a>(body: &'a [LawStatement], tests: &mut Vec<&'a OptionTest>) {
    for statement in body {
        match statement {
            LawStatement::If(choice) => {
                choice
                    .branches
                    .iter()
                    .for_each(|(condition, _)| tests_of(condition, tests));
                parts(choice).for_each(|part| tests_of_law(part, tests));
            }
            LawStatement::Rolling(_, body) => tests_of_law(body, tests),
            _ => {}
        }
    }
}

/// The blocks of an `if`.
fn parts<Part>(choice: &If<Part>) -> impl Iterator<Item = &Vec<Part>> {
    choice.branches.iter().map(|(_, part)| part).chain([&choice.otherwise])
}

fn holds(condition: &Logic<OptionTest>, choices: &Choices) -> bool {
    match condition {
        Logic::Test(test) => {
            let value = choices.iter().find(|(option, _)| *option == test.option.text);
            value.is_some_and(|(_, value)| (*value == test.value.text) == test.equal)
        }
        Logic::Not(part) => !holds(part, choices),
        Logic::And(a, b) => holds(a, choices) && holds(b, choices),
        Logic::Or(a, b) => holds(a, choices) || holds(b, choices),
    }
}

/// The options in a condition with their values, `subframe = off`.
fn state(condition: &Logic<OptionTest>, choices: &Choices) -> Vec<String> {
    let mut tests = Vec::new();
    tests_of(condition, &mut tests);
    let asked = |option: &str| tests.iter().any(|test| test.option.text == option);
    choices
        .iter()
        .filter(|(option, _)| asked(option))
        .map(|(option, value)| format!("{option} = {value}"))
        .collect()
}

/// Selects branches, and collects the names that the others would have declared.
struct Selection<'a> {
    choices: &'a Choices,
    off: BTreeMap<String, String>,
}

impl Selection<'_> {
    fn statement(&mut self, statement: &Statement) -> Vec<Statement> {
        match statement {
            Statement::Option(_) | Statement::Require(_) | Statement::Choose(..) => vec![],
            Statement::If(choice) => {
                let chosen = self.branch(choice, |off, part, why| declared(part, why, off));
                chosen.iter().flat_map(|part| self.statement(part)).collect()
            }
            Statement::Direction(direction) => {
                let body = direction.body.iter().flat_map(|part| self.statement(part)).collect();
                vec![Statement::Direction(crate::front::syntax::Direction {
                    body,
                    ..direction.clone()
                })]
            }
            Statement::Link(link) => {
                let body = self.law(&link.body);
                vec![Statement::Link(Link { body, ..link.clone() })]
            }
            other => vec![other.clone()],
        }
    }

    fn law(&mut self, body: &[LawStatement]) -> Vec<LawStatement> {
        let mut chosen = Vec::new();
        for statement in body {
            match statement {
                LawStatement::If(choice) => {
                    let branch = self.branch(choice, |_, _, _| {});
                    chosen.extend(self.law(branch));
                }
                LawStatement::Rolling(span, body) => chosen.push(LawStatement::Rolling(*span, self.law(body))),
                other => chosen.push(other.clone()),
            }
        }
        chosen
    }

    /// The first branch whose condition holds; the others are switched off.
    fn branch<'b, Part>(
        &mut self,
        choice: &'b If<Part>,
        switch_off: impl Fn(&mut BTreeMap<String, String>, &[Part], &str),
    ) -> &'b [Part] {
        let first = choice
            .branches
            .iter()
            .position(|(condition, _)| holds(condition, self.choices));
        let why = choice
            .branches
            .iter()
            .flat_map(|(condition, _)| state(condition, self.choices));
        let why: BTreeSet<String> = why.map(|state| format!("option {state}")).collect();
        let why = why.into_iter().collect::<Vec<_>>().join(" and ");
        for (index, part) in parts(choice).enumerate() {
            if index != first.unwrap_or(choice.branches.len()) {
                switch_off(&mut self.off, part, &why);
            }
        }
        first.map_or(&choice.otherwise, |index| &choice.branches[index].1)
    }
}

/// Collects all names that statements and their inner statements declare.
fn declared(body: &[Statement], why: &str, off: &mut BTreeMap<String, String>) {
    for statement in body {
        match statement {
            Statement::Direction(direction) => declared(&direction.body, why, off),
            Statement::If(choice) => parts(choice).for_each(|part| declared(part, why, off)),
            _ => {}
        }
        if let Some(name) = statement.name() {
            off.entry(name.text.clone()).or_insert_with(|| why.to_string());
        }
    }
}
