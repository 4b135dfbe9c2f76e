//! What a search answers, and what it tells of itself meanwhile.

use super::posterior::Explanation;

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
    /// By how much all that was found raises the logarithm of the evidence.
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
    /// How much lower its logarithm of the evidence is than that of the best.
    pub behind: f64,
    /// True where it was dropped before the last round: `behind` is of a fit to a part of the lines.
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
    /// How probable it is; `None` of `unknown`.
    pub probability: Option<f64>,
    /// The most probable effects, the most probable first.
    pub candidates: Vec<Probable>,
    /// What every real car has some of, as far as the runs show it: what was fitted with the base model, and with the
    /// findings.
    pub nuisances: [Vec<Finding>; 2],
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
    /// The longest run, s: later than that no law over time is determined.
    pub longest: f64,
    /// The explanation with them.
    pub explanation: Explanation,
}

/// An effect that was not found, and whether it would have been.
#[derive(Clone, Debug, PartialEq)]
pub struct Visible {
    /// Its name.
    pub effect: String,
    /// Its place.
    pub at: String,
    /// Its usual size: parameters and values, SI.
    pub usual: Vec<(String, f64)>,
    /// Its trace at this size over the least that earns a name (RMS): below 1 it would not have been seen.
    pub times: f64,
}

impl Discovery {
    /// What was found, and the members of a class beside it; none where there is no class.
    pub fn told_apart(&self) -> (&[Finding], &[Finding]) {
        self.findings.split_at(self.findings.len() - self.alike)
    }
}

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

/// The gap of the runs that judge, in words.
pub(super) fn told(of: &Explanation) -> String {
    let gap = if of.gap.held_out.is_finite() {
        of.gap.held_out
    } else {
        of.gap.fit
    };
    format!("{gap:.2} times its uncertainty")
}
