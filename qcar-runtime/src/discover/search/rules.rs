//! What earns a name.

use super::state::{Contender, State};
use super::{Finding, Path, Rival};
use crate::campaign::Role;
use crate::discover::evidence::Evidence;
use crate::discover::explain::Explanation;

/// A gap (RMS over uncertainty) below this is noise: what differs between the sides of an axle, and what its averages
/// leave of that, come to a tenth.
const NOISE: f64 = 1.2;
/// An effect must lower the sum of squares by so much, beside the penalty of its parameters, in units of the scatter.
const SIGNIFICANT: f64 = 60.0;
/// All effects together must close so much of the excess gap of the held-out runs,
const CLOSED: f64 = 0.6;
/// and leave no more than this, or, where it is one effect, close [`ALL_CLOSED`] of the excess.
const LEFT: f64 = 1.5;
/// See [`LEFT`].
const ALL_CLOSED: f64 = 0.97;
/// A rival that is no farther behind cannot be told apart.
const ALIKE: f64 = 20.0;

/// Holds explanations against the base model's, on runs that no fit has seen where there are any.
pub struct Judge<'a> {
    before: &'a Explanation,
    held_out: bool,
}

impl<'a> Judge<'a> {
    /// With the base model's explanation.
    pub fn new(evidence: &Evidence, before: &'a Explanation) -> Self {
        Judge {
            before,
            held_out: evidence.of_role(Role::HeldOut).next().is_some(),
        }
    }

    /// True where more is left than noise.
    pub fn is_gap(&self, explanation: &Explanation) -> bool {
        explanation.gap.fit.max(explanation.gap.held_out) > NOISE
    }

    /// True where an effect lowers the sum of squares by more than chance, and is physically plausible.
    pub fn is_significant(&self, state: &State, contender: &Contender) -> bool {
        let lowered = state.explanation.refit.chi2 - contender.score;
        lowered > SIGNIFICANT * scatter(&contender.explanation)
    }

    /// True where what is left does not matter any more.
    pub fn is_enough(&self, path: &Path) -> bool {
        self.leaves_enough(&path.state.explanation, path.findings.len())
    }

    fn leaves_enough(&self, after: &Explanation, effects: usize) -> bool {
        let closed = self.closed(self.before, after);
        let little = self.gap(after) < LEFT || effects < 2 && closed > ALL_CLOSED;
        effects > 0 && little && closed > CLOSED
    }

    /// True where the effects that are left do much worse.
    pub fn is_missed(&self, with: &State, without: &State) -> bool {
        let worse = without.score() - with.score() > SIGNIFICANT * scatter(&with.explanation);
        worse && self.gap(&without.explanation) > LEFT
    }

    /// Those that cannot be told from the one that is picked, itself included. One with more unknowns that explains no
    /// more contains it, and is no other answer.
    pub fn alike<'c>(&self, contenders: &'c [Contender], pick: usize) -> impl Iterator<Item = &'c Contender> {
        let best = &contenders[pick];
        let alike = move |contender: &&Contender| {
            let explains_more = contender.explanation.refit.chi2 < best.explanation.refit.chi2;
            let is_it = std::ptr::eq(*contender, best);
            is_it || behind(contender, best) < ALIKE && (contender.unknowns() <= best.unknowns() || explains_more)
        };
        contenders[pick..].iter().filter(alike)
    }

    /// What is told of a contender.
    pub fn finding(&self, state: &State, contender: &Contender, contenders: &[Contender]) -> Finding {
        let others = contenders.iter().filter(|other| !std::ptr::eq(*other, contender));
        let rival = |other: &Contender| Rival {
            effect: other.candidate.effect.clone(),
            at: other.candidate.at.clone(),
            behind: behind(other, contender),
        };
        Finding {
            effect: contender.candidate.effect.clone(),
            at: contender.candidate.at.clone(),
            form: contender.candidate.form.clone(),
            parameters: contender.parameters.clone(),
            evidence: state.explanation.refit.chi2 - contender.explanation.refit.chi2,
            closed: self.closed(&state.explanation, &contender.explanation),
            rivals: others.map(rival).collect(),
        }
    }

    /// The gap that judges: that of the held-out runs where there are any.
    fn gap(&self, explanation: &Explanation) -> f64 {
        if self.held_out {
            explanation.gap.held_out
        } else {
            explanation.gap.fit
        }
    }

    /// Share of the excess of the squared gap over noise that is gone.
    fn closed(&self, before: &Explanation, after: &Explanation) -> f64 {
        let excess = |explanation| (self.gap(explanation).powi(2) - 1.0).max(0.0);
        1.0 - excess(after) / excess(before).max(f64::MIN_POSITIVE)
    }
}

fn behind(contender: &Contender, best: &Contender) -> f64 {
    (contender.score - best.score) / scatter(&best.explanation)
}

/// What the residuals scatter by, squared: 1 where only noise is left.
fn scatter(explanation: &Explanation) -> f64 {
    (explanation.refit.chi2 / explanation.refit.residuals as f64).max(1.0)
}
