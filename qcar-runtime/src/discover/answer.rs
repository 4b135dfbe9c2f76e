//! Results of a search, and its progress messages.

use super::observe::Evidence;
use super::posterior::Explanation;

/// Verdict of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The base model explains the data: no effect is certain, and the residuals show that none is missing.
    None,
    /// The missing effects are identified.
    Found,
    /// Several effects explain the data equally well.
    Class,
    /// Something is missing, but no effect explains the data.
    Unknown,
}

/// An effect of the answer, or of one of several alternatives that the data cannot distinguish.
#[derive(Clone, Debug)]
pub struct Finding {
    /// Name of the effect.
    pub effect: String,
    /// Link, mass or sensor location.
    pub at: String,
    /// Form that fits best; `None` if the effect has only one.
    pub form: Option<String>,
    /// The alternative of a class to which it belongs, 0 for the most probable one; `None` if it is certain. Effects of
    /// one alternative explain the runs together.
    pub alternative: Option<usize>,
    /// Parameters: name, value and standard error, SI. The error is 0 for a fixed parameter.
    pub parameters: Vec<(String, f64, f64)>,
    /// Increase of the log evidence by all findings together.
    pub evidence: f64,
    /// Share of the excess residual that the findings explain, on the held-out runs, or on the fitted runs if none is
    /// held out. `None` if the base model leaves no excess there, so that there is nothing to explain.
    pub explained: Option<f64>,
    /// Next best explanations, best first.
    pub rivals: Vec<Rival>,
}

/// An alternative explanation: a candidate that was dropped before the last round of fits.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Rival {
    /// Name of the effect.
    pub effect: String,
    /// Link, mass or sensor location.
    pub at: String,
    /// Log evidence of the best candidate minus its own, from its last fit, which had not converged and may be to a
    /// part of the data; at least 0.
    pub behind: f64,
}

/// An effect that may be missing, with its probability.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Probable {
    /// Name of the effect.
    pub effect: String,
    /// Link, mass or sensor location.
    pub at: String,
    /// Form that fits best; `None` if the effect has only one.
    pub form: Option<String>,
    /// Probability that the effect is missing, given that one of the fitted sets is true. Sets that the held-out runs
    /// do not support, and limiting cases of simpler sets, do not count.
    pub probability: f64,
    /// Share of the excess residual that the effect explains alone, as in [`Finding::explained`]; `None` also if it was
    /// only fitted beside others.
    pub explained: Option<f64>,
    /// Increase of the log evidence by the effect alone; `None` if it was only fitted beside others.
    pub log_evidence: Option<f64>,
}

/// Result of a search.
pub struct Discovery {
    /// The verdict.
    pub verdict: Verdict,
    /// Probability of the verdict. It has none for [`Verdict::Unknown`], nor for [`Verdict::None`] if the fitted runs
    /// prefer an effect that the held-out runs do not show.
    pub probability: Option<f64>,
    /// Most probable effects, most probable first.
    pub candidates: Vec<Probable>,
    /// Nuisance effects that the data show: those fitted with the base model, and those fitted with the findings.
    pub nuisances: [Vec<Finding>; 2],
    /// Effects of the answer. For a class, the effects common to all alternatives come first, then those of each
    /// alternative, most probable first.
    pub findings: Vec<Finding>,
    /// Explanation by the base model.
    pub before: Explanation,
    /// Explanation with all findings, or with the best of a class; equal to `before` without findings.
    pub after: Explanation,
    /// Detection limits of the effects if the verdict is `None`; empty otherwise.
    pub detection_limits: Vec<DetectionLimit>,
    /// Learned law if no effect of the catalogue explains the data; `None` otherwise.
    pub learned: Option<Learned>,
}

/// Laws without a named cause, fitted to the residual of the model.
pub struct Learned {
    /// The laws with their places and coefficients.
    pub laws: Vec<Finding>,
    /// Share of the excess residual that they explain, as in [`Finding::explained`].
    pub explained: Option<f64>,
    /// Duration of the longest run, s; a law over time is not determined beyond it.
    pub longest: f64,
    /// Explanation with the laws.
    pub explanation: Explanation,
}

/// Detection limit of an effect that was not found.
#[derive(Clone, Debug, PartialEq)]
pub struct DetectionLimit {
    /// Name of the effect.
    pub effect: String,
    /// Link, mass or sensor location.
    pub at: String,
    /// Default size: parameter names and values, SI.
    pub default_size: Vec<(String, f64)>,
    /// RMS change of the measured values by the effect at this size, relative to the smallest change that makes it
    /// certain. Below 1 the search would not have found it.
    pub over_limit: f64,
}

impl Discovery {
    /// Splits the findings into those that are certain and the alternatives of a class.
    pub fn certain_and_alternatives(&self) -> (&[Finding], Vec<&[Finding]>) {
        let certain = self.findings.partition_point(|own| own.alternative.is_none());
        let (certain, others) = self.findings.split_at(certain);
        (
            certain,
            others.chunk_by(|a, b| a.alternative == b.alternative).collect(),
        )
    }
}

/// Progress message of a search.
#[derive(Clone, Copy, Debug)]
pub enum Update<'a> {
    /// The current step.
    Step(&'a str),
    /// Completed and total parts of the current step.
    Done(usize, usize),
    /// An intermediate result, valid even if the search is stopped: a description, the current effects and their
    /// explanation. The first one is that of the base model.
    Interim(&'a str, &'a [Finding], &'a Explanation),
}

/// Receives progress messages, from any thread.
pub type Progress<'a> = &'a (dyn Fn(Update<'_>) + Sync);

/// RMS of the normalised residual on the runs that judge the model, as text.
pub(super) fn rms_text(of: &Explanation, evidence: &Evidence) -> String {
    let rms = of.misfit.judged(evidence);
    format!("an RMS residual of {rms:.2} standard deviations")
}
