//! Which effect is missing: candidates are refitted jointly with the base model, compared on the fitted runs, and judged
//! on those that no fit has seen.
//!
//! An answer is given only where it is earned. `none`: what is left is noise. `found`: one set of effects explains what
//! is left, on held-out runs too, each of them is missed when it is taken away, and no rival comes close. `class`:
//! several explain it, and the data cannot tell them apart. `unknown`: there is a gap, and nothing explains it.

// The best of many explanations.
mod contest;
// What earns a name.
mod rules;
// An effect in the model.
mod taken;
// A model with effects in it, and what is tried on it.
mod state;
// What `none` is worth.
mod visible;

use super::candidate::Workshop;
use super::evidence::Evidence;
use super::explain::{Explanation, Setting};
use super::predict::PredictError;
use crate::campaign::Role;
use rules::Judge;
use state::{Contender, Field, State};
pub use taken::Taken;
pub use visible::Visible;
use visible::visible;

/// The answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// What is left is noise.
    None,
    /// The missing effects are named.
    Found,
    /// Several effects explain it alike.
    Class,
    /// Nothing explains it.
    Unknown,
}

/// An effect that was found, or one of several that cannot be told apart.
#[derive(Clone, Debug)]
pub struct Finding {
    /// Its name.
    pub effect: String,
    /// Its place.
    pub at: String,
    /// Which of its forms fits best; `None` where it has only one.
    pub form: Option<String>,
    /// Its parameters: name, value and standard error, SI. The error is 0 for one that is given.
    pub parameters: Vec<(String, f64, f64)>,
    /// By how much it lowers the sum of squares of the fitted runs.
    pub evidence: f64,
    /// Share of the excess gap of the held-out runs that it closes; of the fitted runs where none is held out.
    pub closed: f64,
    /// The next best explanations, the best first.
    pub rivals: Vec<Rival>,
}

/// Another explanation.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Rival {
    /// Its name.
    pub effect: String,
    /// Its place.
    pub at: String,
    /// How much worse it explains the fitted runs: difference of the penalised sums of squares, in units of the scatter
    /// that the best explanation leaves.
    pub behind: f64,
    /// True where it was left behind before the end: `behind` is what it was then, in a fit that saw a part of the lines
    /// or large features only.
    pub early: bool,
}

/// An effect that might be missing, and how probable that is.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Probable {
    /// Its name.
    pub effect: String,
    /// Its place.
    pub at: String,
    /// Its form that explains best; `None` where it has only one.
    pub form: Option<String>,
    /// Probability that it is missing, given that one of the sets of effects that were fitted is the truth.
    pub probability: f64,
    /// Share of the excess gap of the runs that judge that it closes.
    pub explained: f64,
    /// By how much it raises the logarithm of the evidence.
    pub log_evidence: f64,
}

/// What was found, and what is left.
pub struct Discovery {
    /// The answer.
    pub verdict: Verdict,
    /// How probable it is; `None` of a search by rules.
    pub probability: Option<f64>,
    /// The most probable effects, the first first; none of a search by rules.
    pub candidates: Vec<Probable>,
    /// In the order in which they were found; of a class, what was found before it and then its members, the best first.
    pub findings: Vec<Finding>,
    /// So many of the last findings stand in each other's place: the members of a class.
    pub alike: usize,
    /// The base model's explanation.
    pub before: Explanation,
    /// The explanation with all findings, with the best of a class; the same as `before` without any.
    pub after: Explanation,
    /// Where nothing is missing: which effects would have been seen.
    pub visible: Vec<Visible>,
    /// Where no effect of the catalogue explains the gap: what the law would be that does.
    pub learned: Option<Learned>,
}

/// Laws that name no cause, fitted to what the model leaves.
pub struct Learned {
    /// Each with its place and coefficients.
    pub laws: Vec<Finding>,
    /// Share of the excess gap of the runs that judge that they close.
    pub explained: f64,
    /// The explanation with them.
    pub explanation: Explanation,
}

impl Discovery {
    /// What was found, and the members of a class beside it; none where there is no class.
    pub fn told_apart(&self) -> (&[Finding], &[Finding]) {
        self.findings.split_at(self.findings.len() - self.alike)
    }
}

/// Effects that are looked for one after the other.
const MOST_EFFECTS: usize = 3;
/// First effects from which a search goes on: of two effects the stronger need not be the one that shows first.
const FIRST_PICKS: usize = 2;

/// What a search tells of itself meanwhile.
#[derive(Clone, Copy, Debug)]
pub enum News<'a> {
    /// What is being done.
    Doing(&'a str),
    /// How much of that is done, and of how much.
    Far(usize, usize),
    /// What is known by now, and stays so if the search is stopped: in words, the effects that were taken, and the
    /// explanation with them. The first is that of the base model.
    Known(&'a str, &'a [Finding], &'a Explanation),
}

/// Told how the search goes, from any thread.
pub type Progress<'a> = &'a (dyn Fn(News<'_>) + Sync);

/// Searches for what is missing. `progress` is told how it goes.
///
/// # Errors
/// Where the model lacks what was measured, or a parameter has no value.
pub fn discover(
    workshop: Box<dyn Workshop>,
    setting: &Setting,
    evidence: &Evidence,
    progress: Progress<'_>,
) -> Result<Discovery, PredictError> {
    if evidence.of_role(Role::Fit).next().is_none() {
        return Err(PredictError::NothingToFit);
    }
    progress(News::Doing("fitting the base model"));
    let base = State::base(workshop, setting, evidence, progress)?;
    let alone = format!("the model alone leaves a gap of {}", told(&base.explanation));
    progress(News::Known(&alone, &[], &base.explanation));
    let start = base.explanation.clone();
    let judge = Judge::new(evidence, &start);
    let mut first = base.contenders(&judge.wanted_first(&base), evidence, progress)?;
    judge.simplest_first(&mut first.contenders);
    let base = base.led_by(first.contenders.first(), evidence);
    let before = base.explanation.clone();
    let judge = Judge::new(evidence, &before);
    let verdict = |verdict, (findings, alike), after: &Explanation| Discovery {
        visible: match verdict {
            Verdict::None => visible(&base, &judge, evidence),
            _ => Vec::new(),
        },
        learned: None,
        verdict,
        probability: None,
        candidates: Vec::new(),
        findings,
        alike,
        before: before.clone(),
        after: after.clone(),
    };
    // A strained calibration that nothing explains is an unlucky one.
    let unexplained = if judge.is_clear(&before) {
        Verdict::Unknown
    } else {
        Verdict::None
    };
    let mut best: Option<Path> = None;
    for pick in (0..first.contenders.len())
        .filter(|&pick| judge.is_significant(&base, &first.contenders[pick]))
        .filter(|&pick| judge.comes_close(&base, &first.contenders[pick], &first.contenders[0]))
        .take(FIRST_PICKS)
    {
        let path = Path::begin(&base, &first, pick, &judge);
        path.tell(progress);
        let path = path.follow(&judge, evidence, progress)?;
        let enough = judge.is_enough(&path);
        if best.as_ref().is_none_or(|best| path.score() < best.score()) {
            best = Some(path);
        }
        if enough {
            break;
        }
    }
    let Some(path) = best else {
        return Ok(verdict(unexplained, (Vec::new(), 0), &before));
    };
    let path = match judge.is_enough(&path) {
        true => path,
        false => path.afresh(&base, &judge, evidence, progress),
    };
    if !judge.is_enough(&path) {
        return Ok(verdict(unexplained, (Vec::new(), 0), &path.state.explanation));
    }
    let path = path.without_what_is_not_missed(&base, &judge, evidence, progress);
    if !judge.is_enough(&path) {
        return Ok(verdict(unexplained, (Vec::new(), 0), &path.state.explanation));
    }
    let after = path.state.explanation.clone();
    let findings = path.named();
    let answer = match findings.1 {
        0 => Verdict::Found,
        _ => Verdict::Class,
    };
    Ok(verdict(answer, findings, &after))
}

/// The gap of the runs that judge, in words.
pub(super) fn told(of: &Explanation) -> String {
    let gap = if of.gap.held_out.is_finite() {
        of.gap.held_out
    } else {
        of.gap.fit
    };
    format!("{gap:.2} times its uncertainty")
}

/// Effects that were taken one after the other.
pub(super) struct Path {
    state: State,
    findings: Vec<Finding>,
    /// Those that cannot be told from the last effect, itself included.
    class: Vec<Finding>,
}

impl Path {
    fn begin(base: &State, field: &Field, pick: usize, judge: &Judge) -> Self {
        let empty = Path {
            state: base.clone(),
            findings: Vec::new(),
            class: Vec::new(),
        };
        empty.taking(field, pick, judge)
    }

    /// Goes on with one of the contenders.
    fn taking(mut self, field: &Field, pick: usize, judge: &Judge) -> Self {
        let chosen = &field.contenders[pick];
        let alike: Vec<&Contender> = judge.alike(&field.contenders, pick).collect();
        let finding = |contender: &Contender| judge.finding(&self.state, contender, &alike, field);
        self.class = alike.iter().copied().map(finding).collect();
        self.findings.push(finding(chosen));
        self.state = self.state.with(chosen);
        self
    }

    /// Takes further effects until nothing that matters is left, or nothing helps.
    fn follow(mut self, judge: &Judge, evidence: &Evidence, progress: Progress<'_>) -> Result<Self, PredictError> {
        while self.findings.len() < MOST_EFFECTS && judge.wants_more(&self) && self.class.len() < 2 {
            let more = MOST_EFFECTS - self.findings.len();
            let wanted = judge.wanted_beside(&self, more);
            let mut field = self.state.contenders(&wanted, evidence, progress)?;
            judge.simplest_first(&mut field.contenders);
            let led = self.state.led_by(field.contenders.first(), evidence);
            self = self.moved_to(led, judge);
            let enough = judge.is_enough(&self);
            let helps = |best: &&Contender| match enough {
                true => judge.adds_much(&self.state, best, self.findings.len() + 1),
                false => judge.is_step(&self.state, best, more),
            };
            if field.contenders.first().filter(helps).is_none() {
                break;
            }
            self = self.taking(&field, 0, judge);
            self.tell(progress);
        }
        Ok(self)
    }

    /// Tells how far it has come.
    fn tell(&self, progress: Progress<'_>) {
        let names = self.findings.iter().map(|own| format!("{} at {}", own.effect, own.at));
        let left = told(&self.state.explanation);
        let words = format!("with {} it leaves {left}", names.collect::<Vec<_>>().join(" and "));
        progress(News::Known(&words, &self.findings, &self.state.explanation));
    }

    fn score(&self) -> f64 {
        self.state.score()
    }

    /// Fitted from the campaign's values, where that ends at a better place: what the model without its effects came to,
    /// from which they were looked for, may lie beyond a ridge.
    fn afresh(self, base: &State, judge: &Judge, evidence: &Evidence, progress: Progress<'_>) -> Self {
        progress(News::Doing("fitting all of it from the start"));
        // What gives no number from there has no better place there.
        let afresh = base.with_all(&self.findings, None, evidence, progress).ok().flatten();
        match afresh.filter(|state| state.score() < self.score()) {
            Some(state) => self.moved_to(state, judge),
            None => self,
        }
    }

    /// The same effects at another place of their model; what it explains more is told of the last.
    fn moved_to(mut self, state: State, judge: &Judge) -> Self {
        let [before, after] = [&self.state, &state].map(|state| &state.explanation);
        if let Some(last) = self.findings.last_mut() {
            last.evidence += before.refit.chi2 - after.refit.chi2;
            last.closed = 1.0 - (1.0 - last.closed) * (1.0 - judge.closed(before, after));
        }
        self.state = state;
        self.state.update(&mut self.findings);
        self
    }

    /// What was found, and how many of the last cannot be told apart; none of one alone.
    fn named(mut self) -> (Vec<Finding>, usize) {
        let alike = Some(self.class.len()).filter(|&alike| alike > 1).unwrap_or(0);
        // The first is the one that was taken.
        self.findings.extend(self.class.into_iter().take(alike).skip(1));
        (self.findings, alike)
    }

    /// Takes each effect but the last away again, the rest refitted: what is not missed then was only a step on the way.
    fn without_what_is_not_missed(
        mut self,
        base: &State,
        judge: &Judge,
        evidence: &Evidence,
        progress: Progress<'_>,
    ) -> Self {
        let mut place = 0;
        while self.findings.len() > 1 && place + 1 < self.findings.len() {
            let others: Vec<Finding> = self
                .findings
                .iter()
                .enumerate()
                .filter(|(k, _)| *k != place)
                .map(|(_, f)| f.clone())
                .collect();
            progress(News::Doing(&format!(
                "trying without {} at {}",
                self.findings[place].effect, self.findings[place].at
            )));
            // What gives no number without an effect misses it.
            let state = base.with_all(&others, Some(&self.state), evidence, progress).ok();
            match state.flatten() {
                Some(state) if !judge.is_missed(&self.state, &state) => {
                    self.state = state;
                    self.findings = others;
                }
                _ => place += 1,
            }
        }
        self.state.update(&mut self.findings);
        self
    }
}

#[cfg(test)]
mod tests;
