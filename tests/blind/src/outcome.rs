//! What was answered to a case of the matrix, and what the answers come to.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde_json::Value;

use crate::hidden::Hidden;
use crate::matrix::{Case, Kind};

/// An answer, held against the truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    kind: Kind,
    case: String,
    /// What no parameter can imitate, in units of the noise.
    strength: f64,
    verdict: String,
    /// What was named, `effect@place` joined by `+`.
    named: String,
    /// Of the hidden effects, how many are among what was found, by name and place; by name alone.
    right: usize,
    right_names: usize,
    hidden: usize,
    /// Share of the excess of the squared held-out gap that is gone.
    closed: f64,
    /// Largest relative error of the parameters of what was found rightly, and how many of them lie within two standard
    /// errors, of how many.
    error: f64,
    covered: (usize, usize),
    seconds: f64,
}

/// What stands clear of noise and calibration: below this the data hardly hold the effect.
const SEPARABLE: f64 = 0.5;

impl Outcome {
    /// From the JSON of `qcar discover`.
    pub fn new(case: &Case, answer: &Value, strength: f64) -> Self {
        let effects = answer["effects"].as_array().cloned().unwrap_or_default();
        let is = |effect: &Value, hidden: &Hidden| effect["name"] == *hidden.name && effect["at"] == *hidden.at;
        let verdict = answer["verdict"].as_str().unwrap_or_default().to_owned();
        let hidden = &case.order.effects;
        let found = |h: &&Hidden| effects.iter().any(|effect| is(effect, h));
        let named = |h: &&Hidden| effects.iter().any(|effect| effect["name"] == *h.name);
        let words = |effect: &Value| Some(format!("{}@{}", effect["name"].as_str()?, effect["at"].as_str()?));
        let gap = |when: &str| (answer["gap"]["held_out"][when].as_f64().unwrap_or(1.0).powi(2) - 1.0).max(0.0);
        let mut outcome = Self {
            kind: case.kind,
            case: case.name.clone(),
            strength,
            right: hidden.iter().filter(found).count(),
            right_names: hidden.iter().filter(named).count(),
            hidden: hidden.len(),
            named: effects.iter().filter_map(words).collect::<Vec<_>>().join("+"),
            verdict,
            closed: if gap("before") > 0.0 {
                1.0 - gap("after") / gap("before")
            } else {
                0.0
            },
            error: 0.0,
            covered: (0, 0),
            seconds: answer["seconds"].as_f64().unwrap_or(f64::NAN),
        };
        for hidden in hidden {
            if let Some(effect) = effects.iter().find(|effect| is(effect, hidden)) {
                outcome.compare(hidden, effect);
            }
        }
        outcome
    }

    fn compare(&mut self, hidden: &Hidden, effect: &Value) {
        for (name, truth) in &hidden.parameters {
            let Some(value) = effect["parameters"][name].as_f64() else {
                continue;
            };
            self.error = self.error.max((value / truth - 1.0).abs());
            if let Some(error) = effect["stderr"][name].as_f64() {
                self.covered.0 += usize::from((value - truth).abs() <= 2.0 * error);
                self.covered.1 += 1;
            }
        }
    }

    /// As a line of a file.
    pub fn line(&self) -> String {
        format!(
            "{:?}\t{}\t{:.3}\t{}\t{}\t{}\t{}\t{}\t{:.4}\t{:.4}\t{}\t{}\t{:.1}",
            self.kind,
            self.case,
            self.strength,
            self.verdict,
            self.named,
            self.right,
            self.right_names,
            self.hidden,
            self.closed,
            self.error,
            self.covered.0,
            self.covered.1,
            self.seconds
        )
    }

    /// Reads such a line.
    ///
    /// # Errors
    /// A line that is none.
    pub fn parse(line: &str) -> Result<Self, String> {
        let cells: Vec<&str> = line.split('\t').collect();
        let [
            kind,
            case,
            strength,
            verdict,
            named,
            right,
            names,
            hidden,
            closed,
            error,
            covered,
            of,
            seconds,
        ] = cells[..]
        else {
            return Err(format!("{line}: 13 columns expected"));
        };
        let number = |text: &str| text.parse::<f64>().map_err(|e| format!("{line}: {text}: {e}"));
        let count = |text: &str| text.parse::<usize>().map_err(|e| format!("{line}: {text}: {e}"));
        Ok(Self {
            kind: match kind {
                "Single" => Kind::Single,
                "Clean" => Kind::Clean,
                "Outside" => Kind::Outside,
                "Pair" => Kind::Pair,
                _ => return Err(format!("{line}: what is {kind}?")),
            },
            case: case.into(),
            strength: number(strength)?,
            verdict: verdict.into(),
            named: named.into(),
            right: count(right)?,
            right_names: count(names)?,
            hidden: count(hidden)?,
            closed: number(closed)?,
            error: number(error)?,
            covered: (count(covered)?, count(of)?),
            seconds: number(seconds)?,
        })
    }

    fn is_found(&self) -> bool {
        self.verdict == "found"
    }

    fn separable(&self) -> bool {
        self.strength >= SEPARABLE
    }

    /// Named and placed, and nothing beside.
    fn is_right(&self) -> bool {
        self.is_found() && self.right == self.hidden && self.named.split('+').count() == self.hidden
    }
}

/// The tables in Markdown: totals, effect by effect, and every miss.
pub fn table(outcomes: &[Outcome]) -> String {
    let of = |kind: Kind| outcomes.iter().filter(move |o| o.kind == kind);
    let mut text = String::from("| what | cases | result |\n|---|---|---|\n");
    let mut row = |what: &str, cases: usize, result: String| {
        let _ = writeln!(text, "| {what} | {cases} | {result} |");
    };
    let singles: Vec<&Outcome> = of(Kind::Single).filter(|o| o.separable()).collect();
    let count = |wanted: &dyn Fn(&Outcome) -> bool| singles.iter().filter(|o| wanted(o)).count();
    row(
        "separable single effects named and placed",
        singles.len(),
        share(count(&Outcome::is_right), singles.len()),
    );
    row(
        "the same, by name alone",
        singles.len(),
        share(count(&|o| o.is_found() && o.right_names == 1), singles.len()),
    );
    row(
        "the same, answered by a class with it",
        singles.len(),
        share(count(&|o| o.verdict == "class" && o.right == 1), singles.len()),
    );
    row(
        "the same, given a wrong effect",
        singles.len(),
        share(count(&|o| o.is_found() && o.right == 0), singles.len()),
    );
    let weak: Vec<&Outcome> = of(Kind::Single).filter(|o| !o.separable()).collect();
    let wrong = weak.iter().filter(|o| o.is_found() && o.right == 0).count();
    row(
        "weaker single effects given a wrong effect",
        weak.len(),
        share(wrong, weak.len()),
    );
    for (kind, what, wanted) in [
        (
            Kind::Clean,
            "clean campaigns given an effect",
            (|o| o.is_found() || o.verdict == "class") as fn(&Outcome) -> bool,
        ),
        (
            Kind::Outside,
            "effects outside the catalogue called unknown, or none",
            |o| o.verdict == "unknown" || o.verdict == "none",
        ),
        (Kind::Outside, "the same, given a single name", Outcome::is_found),
        (
            Kind::Pair,
            "pairs with both effects named and placed",
            Outcome::is_right,
        ),
    ] {
        row(
            what,
            of(kind).count(),
            share(of(kind).filter(|o| wanted(o)).count(), of(kind).count()),
        );
    }
    let right: Vec<&Outcome> = outcomes.iter().filter(|o| o.hidden > 0 && o.is_right()).collect();
    row(
        "share of the excess held-out gap closed, median of what was found",
        right.len(),
        format!("{:.3}", median(right.iter().map(|o| o.closed))),
    );
    row(
        "largest relative error of a parameter, median of what was found",
        right.len(),
        format!("{:.3}", median(right.iter().map(|o| o.error))),
    );
    let (covered, all) = right
        .iter()
        .fold((0, 0), |(a, b), o| (a + o.covered.0, b + o.covered.1));
    row("parameters within two standard errors", all, share(covered, all));
    let seconds = outcomes.iter().map(|o| o.seconds);
    row(
        "seconds, median and longest",
        outcomes.len(),
        format!("{:.0}, {:.0}", median(seconds.clone()), seconds.fold(0.0, f64::max)),
    );
    text + &by_effect(outcomes) + &misses(outcomes)
}

fn by_effect(outcomes: &[Outcome]) -> String {
    let mut rows: BTreeMap<&str, Vec<&Outcome>> = BTreeMap::new();
    for outcome in outcomes.iter().filter(|o| o.kind == Kind::Single) {
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
        Kind::Single => o.separable() && !o.is_right(),
        Kind::Pair => !o.is_right(),
        Kind::Clean => o.verdict != "none",
        Kind::Outside => o.is_found() || o.verdict == "class",
    };
    for o in outcomes.iter().filter(is_miss) {
        let _ = writeln!(
            text,
            "| {} | {:.2} | {} | {} | {:.2} |",
            o.case, o.strength, o.verdict, o.named, o.closed
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

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
