//! What earns a name.

use std::collections::BTreeSet;

use super::state::{Behind, Contender, Field, State};
use super::{Finding, Path, Rival};
use crate::campaign::Role;
use crate::discover::evidence::Evidence;
use crate::discover::explain::Explanation;

/// A gap (RMS over uncertainty) below this is noise: what differs between the sides of an axle, and what its averages
/// leave of that, come to a tenth.
pub const NOISE: f64 = 1.2;
/// The same of one sensor in values of one kind: high harmonics, which are next to nothing, scatter by more than their
/// noise.
const LOCAL: f64 = 2.5;
/// Sensors whose gains and delays have to be wrong by more than this together (sum of squares over what is usual) are no
/// better than a gap.
const STRAIN: f64 = 20.0;
/// An effect must lower the sum of squares by so much, beside the penalty of its parameters, in units of the scatter.
const SIGNIFICANT: f64 = 60.0;
/// Where nothing is left but noise, it must lower the sum of squares by this share of it beside: what the errors of sensors
/// and sides let an effect gain on a clean campaign is a fraction of that.
const FAINT: f64 = 0.1;
/// A second effect is followed instead of the first where it lowers the sum of squares by this share of what that does.
const CLOSE: f64 = 0.5;
/// All effects together must close so much of the excess gap of the held-out runs,
const CLOSED: f64 = 0.6;
/// and leave no more than this, or close [`ALL_CLOSED`] of the excess, where it is one effect; several bend to much that
/// they are not the cause of, and must do both, or leave no more than noise.
const LEFT: f64 = 1.5;
/// See [`LEFT`].
const ALL_CLOSED: f64 = 0.97;
/// A model with one effect is good that accounts for so much of the variance of records over time: hardware does not repeat
/// itself to the precision of its sensors.
const ACCOUNTED: f64 = 0.95;
/// A rival that is no farther behind cannot be told apart.
const ALIKE: f64 = 20.0;
/// An explanation that leaves something unexplained is no judge of differences below this share of it.
const VAGUE: f64 = 0.05;
/// So many rivals are told of at least, those that were left behind early among them.
const RIVALS: usize = 3;

/// What would be of use.
pub struct Wanted {
    /// The share of the sum of squares that it must take.
    pub least: f64,
    /// Whether only a sensor can be it.
    pub sensor: bool,
}

/// Holds explanations against the base model's, on runs that no fit has seen where there are any.
pub struct Judge<'a> {
    evidence: &'a Evidence,
    before: &'a Explanation,
    /// The runs that judge: held-out ones where there are any.
    role: Role,
}

impl<'a> Judge<'a> {
    /// With the base model's explanation.
    pub fn new(evidence: &'a Evidence, before: &'a Explanation) -> Self {
        let held_out = evidence.of_role(Role::HeldOut).next().is_some();
        Judge {
            evidence,
            before,
            role: if held_out { Role::HeldOut } else { Role::Fit },
        }
    }

    /// True where more is left than noise, or where the calibrations of the sensors are strained.
    pub fn is_gap(&self, explanation: &Explanation) -> bool {
        self.is_clear(explanation) || explanation.strain() > STRAIN
    }

    /// True where more is left than noise, in all values or in those of one sensor and kind.
    pub fn is_clear(&self, explanation: &Explanation) -> bool {
        let gap = &explanation.gap;
        gap.fit.max(gap.held_out) > NOISE || gap.local(self.evidence) > LOCAL
    }

    /// True where an effect lowers the sum of squares by more than chance.
    pub fn is_significant(&self, state: &State, contender: &Contender) -> bool {
        state.lowered(contender) > self.least(state, &contender.explanation)
    }

    /// By how much an effect must lower the sum of squares, beside the penalty of its unknowns.
    fn least(&self, state: &State, with: &Explanation) -> f64 {
        let is_faint = !self.is_gap(&state.explanation);
        let least = if is_faint {
            FAINT * state.explanation.refit.chi2
        } else {
            0.0
        };
        least.max(SIGNIFICANT * with.scatter())
    }

    /// By how much an effect of so many unknowns would have had to lower the sum of squares in all.
    pub fn least_to_name(&self, state: &State, unknowns: usize) -> f64 {
        self.least(state, &state.explanation) + state.penalty(unknowns)
    }

    /// What may be the first effect. Where there is no gap, little is worth a look.
    pub fn wanted_first(&self, state: &State) -> Wanted {
        Wanted {
            least: if self.is_gap(&state.explanation) { 0.0 } else { FAINT },
            sensor: false,
        }
    }

    /// What may come beside the effects of a path: a step, or, where these are enough, what closes as much again. If it is
    /// the calibrations alone that are strained then, nothing but a sensor is to blame.
    pub fn wanted_beside(&self, path: &Path, effects: usize) -> Wanted {
        let explanation = &path.state.explanation;
        let enough = self.is_enough(path);
        let excess = 1.0 - explanation.refit.residuals as f64 / explanation.refit.chi2;
        let share = if enough { CLOSED } else { CLOSED / effects as f64 };
        Wanted {
            least: share * excess.max(0.0),
            sensor: enough && !self.is_clear(explanation),
        }
    }

    /// True where an effect is a step on the way to an explanation: of what the present model leaves, it takes its share, so
    /// that as many effects as may be taken, itself included, come to what all must close.
    pub fn is_step(&self, state: &State, contender: &Contender, effects: usize) -> bool {
        let refit = &state.explanation.refit;
        let excess = refit.chi2 - refit.residuals as f64;
        self.is_significant(state, contender) && state.lowered(contender) > CLOSED / effects as f64 * excess
    }

    /// True where an effect lowers the sum of squares by about as much as the best: a search may go on from it instead.
    pub fn comes_close(&self, state: &State, contender: &Contender, best: &Contender) -> bool {
        state.lowered(contender) >= CLOSE * state.lowered(best)
    }

    /// True where an effect earns a place beside others that explain enough: it closes as much of what they leave as a
    /// first one must, the data determine all of its parameters, and it makes one of so many `effects` that explain enough.
    /// Where calibrations alone are strained, it gains more than it would on a clean campaign.
    pub fn adds_much(&self, state: &State, contender: &Contender, effects: usize) -> bool {
        let determined = contender.parameters.iter().all(|(_, _, error)| error.is_finite());
        let closes = self.closed(&state.explanation, &contender.explanation) > CLOSED;
        let explains = self.leaves_enough(&contender.explanation, effects);
        let is_faint = state.lowered(contender) < FAINT * state.explanation.refit.chi2;
        let shows = self.is_clear(&state.explanation) || !is_faint;
        determined && closes && explains && shows && self.is_significant(state, contender)
    }

    /// True where a further effect is looked for. What several that explain enough leave beside noise is the difference of
    /// their laws from the true ones, to which a third would only bend; a strained calibration may still be a sensor's.
    pub fn wants_more(&self, path: &Path) -> bool {
        let explanation = &path.state.explanation;
        let is_of_laws = path.findings.len() > 1 && self.is_enough(path) && self.is_clear(explanation);
        self.is_gap(explanation) && !is_of_laws
    }

    /// True where what is left does not matter any more.
    pub fn is_enough(&self, path: &Path) -> bool {
        self.leaves_enough(&path.state.explanation, path.findings.len())
    }

    fn leaves_enough(&self, after: &Explanation, effects: usize) -> bool {
        let (gap, closed) = (self.gap(after), self.closed(self.before, after));
        let missed = after.gap.missed(self.evidence, self.role);
        let is_good = missed.is_some_and(|missed| 1.0 - missed > ACCOUNTED);
        let is_little = match effects {
            0 => false,
            1 => gap < LEFT || closed > ALL_CLOSED || is_good,
            _ => gap < LEFT && closed > ALL_CLOSED || gap < NOISE,
        };
        is_little && closed > CLOSED
    }

    /// True where the effects that are left do much worse.
    pub fn is_missed(&self, with: &State, without: &State) -> bool {
        let worse = without.score() - with.score() > SIGNIFICANT * with.explanation.scatter();
        worse && self.gap(&without.explanation) > LEFT
    }

    /// Brings the simplest of those to the front that explain as much as the best, as far as that can judge.
    pub fn simplest_first(&self, contenders: &mut [Contender]) {
        let Some(best) = contenders.first() else { return };
        let limit = best.score + vague(best);
        let as_good = contenders.iter().take_while(|contender| contender.score <= limit);
        let simplest = as_good.enumerate().min_by_key(|(_, contender)| contender.unknowns());
        let place = simplest.map_or(0, |(place, _)| place);
        contenders[..=place].rotate_right(1);
    }

    /// Those that cannot be told from the one that is picked, itself included. One with more unknowns that are not worth
    /// their penalty contains it, and is no other answer.
    pub fn alike<'c>(&self, contenders: &'c [Contender], pick: usize) -> impl Iterator<Item = &'c Contender> {
        let best = &contenders[pick];
        let near = (ALIKE * best.explanation.scatter()).max(vague(best));
        let alike = move |contender: &&Contender| {
            let lowered = best.explanation.refit.chi2 - contender.explanation.refit.chi2;
            let explains_more = lowered > vague(best) && contender.score < best.score;
            let is_it = std::ptr::eq(*contender, best);
            let is_near = contender.score - best.score < near;
            is_it || is_near && (contender.unknowns() <= best.unknowns() || explains_more)
        };
        contenders[pick..].iter().filter(alike)
    }

    /// What is told of a contender, from which some others cannot be told.
    pub fn finding(&self, state: &State, contender: &Contender, alike: &[&Contender], field: &Field) -> Finding {
        Finding {
            effect: contender.candidate.effect.clone(),
            at: contender.candidate.at.clone(),
            form: contender.candidate.form.clone(),
            parameters: contender.parameters.clone(),
            evidence: state.explanation.refit.chi2 - contender.explanation.refit.chi2,
            closed: self.closed(&state.explanation, &contender.explanation),
            rivals: rivals(contender, alike, field),
        }
    }

    /// The gap that judges.
    fn gap(&self, explanation: &Explanation) -> f64 {
        match self.role {
            Role::HeldOut => explanation.gap.held_out,
            Role::Fit => explanation.gap.fit,
        }
    }

    /// Share of the excess of the squared gap over noise that is gone. Where the gap shows in a part of the values, or in
    /// the calibrations alone, it is closed if that is gone; one that does not show at all, if the fit gains by it.
    pub fn closed(&self, before: &Explanation, after: &Explanation) -> f64 {
        if self.gap(before) <= NOISE {
            let is_gone = self.is_gap(before) && !self.is_gap(after);
            let gains = after.refit.chi2 < (1.0 - FAINT) * before.refit.chi2 && !self.is_clear(after);
            return if is_gone || gains { 1.0 } else { 0.0 };
        }
        let excess = |explanation| (self.gap(explanation).powi(2) - 1.0).max(0.0);
        1.0 - excess(after) / excess(before).max(f64::MIN_POSITIVE)
    }
}

/// The difference of sums of squares that an explanation cannot judge, since it leaves more than noise itself.
fn vague(contender: &Contender) -> f64 {
    let refit = &contender.explanation.refit;
    VAGUE * (refit.chi2 - refit.residuals as f64).max(0.0)
}

/// All that was fitted to the end beside the chosen one and those like it, and the best of the others: some, and a sensor in
/// any case.
fn rivals(chosen: &Contender, alike: &[&Contender], field: &Field) -> Vec<Rival> {
    let names = alike.iter().map(|own| (&own.candidate.effect, &own.candidate.at));
    let mut met: BTreeSet<_> = names.collect();
    let (mut rivals, mut has_sensor) = (Vec::new(), alike.iter().any(|own| own.candidate.is_sensor()));
    for other in &field.contenders {
        if met.insert((&other.candidate.effect, &other.candidate.at)) {
            let behind = (other.score - chosen.score) / chosen.explanation.scatter();
            let other = Behind::new(&other.candidate, behind, false);
            has_sensor |= other.is_sensor;
            rivals.push(other.rival);
        }
    }
    for other in &field.dropped {
        let wanted = rivals.len() < RIVALS || other.is_sensor && !has_sensor;
        if wanted && met.insert((&other.rival.effect, &other.rival.at)) {
            has_sensor |= other.is_sensor;
            rivals.push(other.rival.clone());
        }
    }
    rivals
}

#[cfg(test)]
mod tests;
