//! Statistics of the answers to the matrix, in Markdown.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::matrix::{Kind, LITTLE};
use crate::outcome::{Outcome, Place};

/// Least separable strength, in units of the noise. Below it the data hardly show the effect.
const SEPARABLE: f64 = 0.5;
/// Bins of the stated probability.
const BINS: [f64; 7] = [0.0, 0.5, 0.8, 0.9, 0.95, 0.99, 1.0];

impl Outcome {
    fn is(&self, verdict: &str) -> bool {
        self.verdict == verdict
    }

    fn separable(&self) -> bool {
        self.strength >= SEPARABLE
    }

    fn gives_a_name(&self) -> bool {
        self.is("found") || self.is("class")
    }

    /// Whether the answer names all hidden effects at their places, and no other.
    pub fn is_right(&self) -> bool {
        let named = |truth: &Place| self.named.iter().any(|own| truth.is_named_by(own));
        self.is("found") && self.named.len() == self.truth.len() && self.truth.iter().all(named)
    }

    /// Whether each named effect is of the hidden family.
    fn is_of_family(&self) -> bool {
        self.is("found") && !self.named.is_empty() && !self.is_wrong()
    }

    /// Whether nothing is named, but the place is right.
    fn is_unknown_there(&self) -> bool {
        let learned = self.learned.iter().map(|(at, _)| at);
        let mut places = learned.chain(&self.places).take(1);
        self.is("unknown") && places.any(|at| self.truth.iter().any(|truth| truth.at == *at))
    }

    /// Whether the answer names all hidden effects and no other, at any places.
    fn is_right_by_name(&self) -> bool {
        let named = |truth: &Place| self.named.iter().any(|own| truth.has_name_of(own));
        self.is("found") && self.named.len() == self.truth.len() && self.truth.iter().all(named)
    }

    /// Whether the answer is a class that contains the hidden effect.
    fn is_class_with_it(&self) -> bool {
        let holds = |truth: &Place| self.named.iter().chain(&self.alike).any(|own| truth.is_named_by(own));
        self.is("class") && !self.truth.is_empty() && self.truth.iter().all(holds)
    }

    /// Whether the answer names an effect that is not hidden, or is a class without the hidden one.
    fn is_wrong(&self) -> bool {
        let is_hidden = |own: &Place| self.truth.iter().any(|truth| truth.is_named_by(own));
        (self.is("found") && !self.named.iter().all(is_hidden)) || (self.is("class") && !self.is_class_with_it())
    }

    /// Whether the answer is acceptable.
    fn is_true(&self) -> bool {
        match self.verdict.as_str() {
            "found" if self.kind == Kind::OtherLaw => self.is_of_family(),
            "found" => self.is_right(),
            "class" => self.is_class_with_it(),
            "none" => !self.separable(),
            "unknown" => matches!(self.kind, Kind::Outside | Kind::OtherLaw),
            _ => false,
        }
    }
}

/// All tables: totals, reliability, effect by effect, and every miss.
pub fn tables(outcomes: &[Outcome]) -> String {
    let mut table = Table::new("what");
    catalogue(outcomes, &mut table);
    clean(outcomes, &mut table);
    outside(outcomes, &mut table);
    hardware(outcomes, &mut table);
    minimal(outcomes, &mut table);
    other_laws(outcomes, &mut table);
    parameters(outcomes, &mut table);
    seconds(outcomes, &mut table);
    table.text + &reliability(outcomes) + &by_effect(outcomes) + &misses(outcomes)
}

/// Rows of statistic, number of cases and result.
struct Table {
    text: String,
}

impl Table {
    fn new(what: &str) -> Self {
        Self {
            text: format!("| {what} | cases | result |\n|---|---|---|\n"),
        }
    }

    fn row(&mut self, what: &str, cases: usize, result: &str) {
        if cases > 0 {
            let _ = writeln!(self.text, "| {what} | {cases} | {result} |");
        }
    }

    /// Number and share of the cases that meet a condition.
    fn count(&mut self, what: &str, cases: &[&Outcome], wanted: impl Fn(&Outcome) -> bool) {
        let count = cases.iter().filter(|outcome| wanted(outcome)).count();
        self.row(what, cases.len(), &share(count, cases.len()));
    }
}

fn of(outcomes: &[Outcome], kind: Kind) -> Vec<&Outcome> {
    outcomes.iter().filter(|outcome| outcome.kind == kind).collect()
}

fn catalogue(outcomes: &[Outcome], table: &mut Table) {
    let (clear, weak): (Vec<&Outcome>, Vec<&Outcome>) = of(outcomes, Kind::Single)
        .into_iter()
        .partition(|outcome| outcome.separable());
    table.count("separable single effects named and placed", &clear, Outcome::is_right);
    table.count("the same, by name alone", &clear, Outcome::is_right_by_name);
    table.count(
        "the same, answered by a class with it",
        &clear,
        Outcome::is_class_with_it,
    );
    table.count("the same, given a wrong effect", &clear, Outcome::is_wrong);
    table.count("weaker single effects given a wrong effect", &weak, Outcome::is_wrong);
    table.count(
        "pairs with both effects named and placed",
        &of(outcomes, Kind::Pair),
        Outcome::is_right,
    );
}

fn clean(outcomes: &[Outcome], table: &mut Table) {
    for (kind, what) in [
        (Kind::Clean, "clean campaigns given an effect"),
        (Kind::FastClean, "clean fast campaigns given an effect"),
    ] {
        table.count(what, &of(outcomes, kind), Outcome::gives_a_name);
        let unknown = format!("{}unknown", what.trim_end_matches("given an effect"));
        table.count(&unknown, &of(outcomes, kind), |outcome| outcome.is("unknown"));
    }
}

fn outside(outcomes: &[Outcome], table: &mut Table) {
    let outside = of(outcomes, Kind::Outside);
    table.count("effects outside the catalogue given no name", &outside, |outcome| {
        outcome.is("unknown") || outcome.is("none")
    });
    learned("effects outside the catalogue", &outside, table);
}

fn hardware(outcomes: &[Outcome], table: &mut Table) {
    let is_mild = |outcome: &&Outcome| !outcome.case.contains("Cams");
    let (mild, more): (Vec<&Outcome>, Vec<&Outcome>) = of(outcomes, Kind::HardwareClean).into_iter().partition(is_mild);
    table.count("clean hardware given an effect", &mild, Outcome::gives_a_name);
    table.count("clean hardware unknown", &mild, |outcome| outcome.is("unknown"));
    table.count(
        "clean, but with a tyre of cams: given an effect",
        &more,
        Outcome::gives_a_name,
    );
    let single = of(outcomes, Kind::HardwareSingle);
    table.count("single effects in hardware named, or in a class", &single, |outcome| {
        outcome.is_right() || outcome.is_class_with_it()
    });
    table.count("the same, named alone", &single, Outcome::is_right);
    table.count("the same, given a wrong effect", &single, Outcome::is_wrong);
}

fn minimal(outcomes: &[Outcome], table: &mut Table) {
    for words in LITTLE {
        let mut own = of(outcomes, Kind::Minimal);
        own.retain(|outcome| outcome.case.starts_with(words));
        let mut count = |what: &str, wanted: &dyn Fn(&Outcome) -> bool| {
            table.count(&format!("{words}: {what}"), &own, wanted);
        };
        count("named and placed", &Outcome::is_right);
        count("a class with it", &Outcome::is_class_with_it);
        count("none", &|outcome| outcome.is("none"));
        count("unknown", &|outcome| outcome.is("unknown"));
        count("wrong", &Outcome::is_wrong);
    }
}

fn other_laws(outcomes: &[Outcome], table: &mut Table) {
    let all = of(outcomes, Kind::OtherLaw);
    let mut count = |what: &str, wanted: &dyn Fn(&Outcome) -> bool| {
        table.count(&format!("laws of another form: {what}"), &all, wanted);
    };
    count("named by their family", &Outcome::is_of_family);
    count("a class with it", &Outcome::is_class_with_it);
    count("unknown at their place", &Outcome::is_unknown_there);
    count("unknown elsewhere", &|outcome| {
        outcome.is("unknown") && !outcome.is_unknown_there()
    });
    count("none", &|outcome| outcome.is("none"));
    count("wrong", &Outcome::is_wrong);
    learned("laws of another form", &all, table);
}

/// Share of the excess gap that the learned laws close.
fn learned(what: &str, outcomes: &[&Outcome], table: &mut Table) {
    let closed = outcomes.iter().filter_map(|outcome| Some(outcome.learned.as_ref()?.1));
    let closed: Vec<f64> = closed.collect();
    let least = closed.iter().copied().fold(f64::INFINITY, f64::min);
    table.row(
        &format!("{what}: share of the excess gap closed by the learned law, median and least"),
        closed.len(),
        &format!("{:.2}, {least:.2}", median(&closed)),
    );
}

fn parameters(outcomes: &[Outcome], table: &mut Table) {
    let right = |outcome: &&Outcome| !outcome.truth.is_empty() && outcome.kind != Kind::OtherLaw && outcome.is_right();
    let right: Vec<&Outcome> = outcomes.iter().filter(right).collect();
    let median_of =
        |value: fn(&Outcome) -> f64| median(&right.iter().map(|outcome| value(outcome)).collect::<Vec<_>>());
    table.row(
        "share of the excess gap closed, median of what was found",
        right.len(),
        &format!("{:.3}", median_of(|outcome| outcome.closed)),
    );
    table.row(
        "largest relative error of a parameter, median of what was found",
        right.len(),
        &format!("{:.3}", median_of(|outcome| outcome.error)),
    );
    let sum = |value: fn(&Outcome) -> usize| right.iter().map(|outcome| value(outcome)).sum::<usize>();
    let (covered, all) = (sum(|outcome| outcome.covered.0), sum(|outcome| outcome.covered.1));
    table.row("parameters within two standard errors", all, &share(covered, all));
}

fn seconds(outcomes: &[Outcome], table: &mut Table) {
    let all: Vec<f64> = outcomes
        .iter()
        .map(|outcome| outcome.seconds)
        .filter(|s| s.is_finite())
        .collect();
    let longest = all.iter().copied().fold(0.0, f64::max);
    table.row(
        "seconds, median and longest",
        all.len(),
        &format!("{:.0}, {longest:.0}", median(&all)),
    );
    let all: Vec<&Outcome> = outcomes.iter().collect();
    table.count("searches that failed", &all, |outcome| outcome.is("failed"));
}

/// How often answers are right, by the probability that they state.
fn reliability(outcomes: &[Outcome]) -> String {
    let mut text = String::from("\n| stated probability | answers | right | mean stated |\n|---|---|---|---|\n");
    let stated: Vec<(f64, bool)> = outcomes
        .iter()
        .filter_map(|outcome| Some((outcome.probability?, outcome.is_true())))
        .collect();
    for bin in BINS.windows(2) {
        let is_in = |p: f64| p >= bin[0] && (p < bin[1] || bin[1] == 1.0);
        let own: Vec<&(f64, bool)> = stated.iter().filter(|(p, _)| is_in(*p)).collect();
        let right = own.iter().filter(|(_, right)| *right).count();
        let mean = own.iter().map(|(p, _)| p).sum::<f64>() / own.len() as f64;
        if !own.is_empty() {
            let right = share(right, own.len());
            let _ = writeln!(
                text,
                "| {} to {} | {} | {right} | {mean:.3} |",
                bin[0],
                bin[1],
                own.len()
            );
        }
    }
    if stated.is_empty() { String::new() } else { text }
}

fn by_effect(outcomes: &[Outcome]) -> String {
    let mut rows: BTreeMap<&str, Vec<&Outcome>> = BTreeMap::new();
    for outcome in of(outcomes, Kind::Single) {
        rows.entry(outcome.case.split(' ').next().unwrap_or_default())
            .or_default()
            .push(outcome);
    }
    let mut text =
        String::from("\n| effect | cases | separable | of these right | strengths |\n|---|---|---|---|---|\n");
    for (effect, outcomes) in rows {
        let separable: Vec<&&Outcome> = outcomes.iter().filter(|o| o.separable()).collect();
        let right = separable.iter().filter(|o| o.is_right()).count();
        let strengths: Vec<String> = outcomes.iter().map(|o| format!("{:.2}", o.strength)).collect();
        let _ = writeln!(
            text,
            "| {effect} | {} | {} | {right} | {} |",
            outcomes.len(),
            separable.len(),
            strengths.join(", ")
        );
    }
    text
}

fn misses(outcomes: &[Outcome]) -> String {
    let mut text = String::from("\n| missed | strength | verdict | named | gap closed |\n|---|---|---|---|---|\n");
    let is_miss = |o: &&Outcome| match o.kind {
        Kind::Single => (o.separable() && !o.is_right()) || o.is_wrong(),
        Kind::Pair => !o.is_right(),
        Kind::Clean | Kind::FastClean | Kind::HardwareClean => !o.is("none"),
        Kind::Outside => o.gives_a_name(),
        Kind::HardwareSingle | Kind::Minimal => !(o.is_right() || o.is_class_with_it()),
        Kind::OtherLaw => !(o.is_of_family() || o.is_class_with_it() || o.is_unknown_there()),
    };
    for o in outcomes.iter().filter(is_miss) {
        let named: Vec<String> = o.named.iter().chain(&o.alike).map(Place::words).collect();
        let _ = writeln!(
            text,
            "| {} | {:.2} | {} | {} | {:.2} |",
            o.case,
            o.strength,
            o.verdict,
            named.join("+"),
            o.closed
        );
    }
    text
}

fn share(part: usize, of: usize) -> String {
    if of == 0 {
        return "-".into();
    }
    format!("{part} ({:.0} %)", 100.0 * part as f64 / of as f64)
}

fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
