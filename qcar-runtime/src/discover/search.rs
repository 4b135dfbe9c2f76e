//! Which effect is missing: candidates are refitted jointly with the base model, compared on the fitted runs, and judged
//! on those that no fit has seen.
//!
//! An answer is given only where it is earned. `none`: what is left is noise. `found`: one candidate explains what is
//! left, on held-out runs too, and no rival comes close. `class`: several do, and the data cannot tell them apart.
//! `unknown`: there is a gap, and nothing explains it.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use super::candidate::{Added, Candidate, Change, Workshop};
use super::evidence::Evidence;
use super::explain::{Explanandum, Explanation, Given, Setting};
use super::nuisance::{Form, Nuisance};
use super::predict::PredictError;
use super::refit::Refit;
use crate::campaign::Role;

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
    /// Its parameters: name, value and standard error, SI.
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
}

/// What was found, and what is left.
pub struct Discovery {
    /// The answer.
    pub verdict: Verdict,
    /// In the order in which they were found; of a class, its members, the best first.
    pub findings: Vec<Finding>,
    /// The base model's explanation.
    pub before: Explanation,
    /// The explanation with all findings; the same as `before` without any.
    pub after: Explanation,
}

/// Effects that are looked for one after the other.
const MOST_EFFECTS: usize = 3;
/// A gap (RMS over uncertainty) below this is noise: what differs between the sides of an axle, and what its averages
/// leave of that, come to a tenth.
const NOISE: f64 = 1.2;
/// An effect must lower the sum of squares by so much, beside the penalty of its parameters.
const SIGNIFICANT: f64 = 60.0;
/// It must close so much of the excess gap of the held-out runs.
const CLOSED: f64 = 0.6;
/// All effects together must leave no more than this, or close [`ALL_CLOSED`] of the excess.
const LEFT: f64 = 1.5;
/// See [`LEFT`].
const ALL_CLOSED: f64 = 0.97;
/// A rival that is no farther behind cannot be told apart.
const ALIKE: f64 = 20.0;
/// How wrong a sensor under suspicion may be: a factor of e, and 20 ms.
const SUSPECT: [f64; 2] = [1.0, 0.02];
/// Candidates that are fitted sharply, the best of the coarse fits.
const LOOKED_INTO: usize = 8;
/// Rivals that are listed.
const LISTED: usize = 6;

/// Searches for what is missing. `progress` is told what is being done.
///
/// # Errors
/// Where the model lacks what was measured, or a parameter has no value.
pub fn discover(
    workshop: Box<dyn Workshop>,
    setting: &Setting,
    evidence: &Evidence,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Discovery, PredictError> {
    progress("fitting the base model");
    let nuisance = Nuisance::of(evidence);
    let base = Explanandum {
        model: workshop.model(),
        added: &[],
        setting,
        known: None,
        nuisance: nuisance.clone(),
    };
    let before = base.sharp(&base.coarse(evidence)?, evidence)?;
    let before = before.ok_or(PredictError::NoNumber)?;
    let mut state = State {
        workshop,
        setting: setting.clone(),
        nuisance,
        explanation: before.clone(),
    };
    let mut findings = Vec::new();
    while is_gap(&state.explanation) && findings.len() < MOST_EFFECTS {
        let Some(round) = state.round(evidence, progress)? else {
            break;
        };
        if round.class.len() > 1 {
            let after = round.explanation;
            let earned = findings.is_empty() && is_enough(&before, &after, evidence);
            let verdict = if earned { Verdict::Class } else { Verdict::Unknown };
            let findings = if earned { round.class } else { findings };
            return Ok(Discovery {
                verdict,
                findings,
                before,
                after,
            });
        }
        findings.extend(round.class);
        state.adopt(round.candidate, round.explanation);
    }
    let verdict = match () {
        () if !is_gap(&before) => Verdict::None,
        () if findings.is_empty() || !is_enough(&before, &state.explanation, evidence) => Verdict::Unknown,
        () => Verdict::Found,
    };
    Ok(Discovery {
        verdict,
        findings: if verdict == Verdict::Found {
            findings
        } else {
            Vec::new()
        },
        before,
        after: state.explanation,
    })
}

/// True where more is left than noise.
fn is_gap(explanation: &Explanation) -> bool {
    explanation.gap.fit.max(explanation.gap.held_out) > NOISE
}

/// True where what is left does not matter any more.
fn is_enough(before: &Explanation, after: &Explanation, evidence: &Evidence) -> bool {
    let gap = judged(after, evidence);
    gap < LEFT || closed(before, after, evidence) > ALL_CLOSED
}

/// The gap that judges: that of the held-out runs where there are any.
fn judged(explanation: &Explanation, evidence: &Evidence) -> f64 {
    let held_out = evidence.of_role(Role::HeldOut).next().is_some();
    if held_out {
        explanation.gap.held_out
    } else {
        explanation.gap.fit
    }
}

/// Share of the excess of the squared gap over noise that is gone.
fn closed(before: &Explanation, after: &Explanation, evidence: &Evidence) -> f64 {
    let excess = |explanation| (judged(explanation, evidence).powi(2) - 1.0).max(0.0);
    1.0 - excess(after) / excess(before).max(f64::MIN_POSITIVE)
}

/// What is known so far.
struct State {
    workshop: Box<dyn Workshop>,
    setting: Setting,
    nuisance: Nuisance,
    explanation: Explanation,
}

/// The outcome of a round: the best candidate, and those that cannot be told from it.
struct Round {
    candidate: Candidate,
    explanation: Explanation,
    class: Vec<Finding>,
}

/// A candidate and how well it explains.
struct Trial {
    candidate: Candidate,
    explanation: Explanation,
    /// Sum of squares with the penalty of the added parameters.
    score: f64,
}

impl State {
    /// Tries every candidate. `None` where none earns its name.
    fn round(&self, evidence: &Evidence, progress: &(dyn Fn(&str) + Sync)) -> Result<Option<Round>, PredictError> {
        let candidates = self.workshop.candidates();
        let count = candidates.len();
        progress(&format!("trying {count} effects at their places"));
        let known = self.known();
        let looks = candidates.into_par_iter().filter_map(|candidate| {
            let coarse = self.explanandum(&candidate, &known)?.coarse(evidence).ok()?;
            (!coarse.is_empty()).then_some((candidate, coarse))
        });
        let mut looks: Vec<(Candidate, Vec<Refit>)> = looks.collect();
        looks.sort_by(|a, b| a.1[0].chi2.total_cmp(&b.1[0].chi2));
        looks.truncate(LOOKED_INTO);
        progress(&format!("looking into the best {} of them", looks.len()));
        let trials = looks.into_par_iter();
        let trials = trials.filter_map(|(candidate, coarse)| self.try_out(candidate, &coarse, &known, evidence));
        let mut trials: Vec<Trial> = trials.collect();
        trials.sort_by(|a, b| a.score.total_cmp(&b.score));
        // The best form stands for the effect.
        let mut met = BTreeSet::new();
        trials.retain(|trial| met.insert((trial.candidate.effect.clone(), trial.candidate.at.clone())));
        let Some(best) = trials.first() else { return Ok(None) };
        if !self.is_earned(best, evidence) {
            return Ok(None);
        }
        let scatter = (best.explanation.refit.chi2 / best.explanation.refit.residuals as f64).max(1.0);
        let behind = |trial: &Trial| (trial.score - best.score) / scatter;
        let alike = trials.iter().take_while(|trial| behind(trial) < ALIKE).count();
        let rivals: Vec<Rival> = trials
            .iter()
            .skip(1)
            .take(LISTED)
            .map(|trial| trial.rival(behind(trial)))
            .collect();
        let class = trials[..alike]
            .iter()
            .map(|trial| self.finding(trial, &rivals, evidence))
            .collect();
        let Trial {
            candidate, explanation, ..
        } = trials.swap_remove(0);
        Ok(Some(Round {
            candidate,
            explanation,
            class,
        }))
    }

    /// A candidate with what is known; `None` for a sensor that the evidence does not have.
    fn explanandum<'a>(
        &'a self,
        candidate: &'a Candidate,
        known: &'a BTreeMap<String, f64>,
    ) -> Option<Explanandum<'a>> {
        let (model, added, nuisance) = match &candidate.change {
            Change::Model { model, parameters } => (&**model, parameters.as_slice(), self.nuisance.clone()),
            Change::Sensor {
                location, axis, form, ..
            } => {
                let sigma = SUSPECT[usize::from(*form == Form::Delay)];
                let nuisance = self.nuisance.clone().suspecting(location, *axis, *form, sigma)?;
                (self.workshop.model(), &[][..], nuisance)
            }
        };
        Some(Explanandum {
            model,
            added,
            setting: &self.setting,
            known: Some(known),
            nuisance,
        })
    }

    fn try_out(
        &self,
        candidate: Candidate,
        coarse: &[Refit],
        known: &BTreeMap<String, f64>,
        evidence: &Evidence,
    ) -> Option<Trial> {
        let explanation = self.explanandum(&candidate, known)?.sharp(coarse, evidence).ok()?;
        // A candidate that predicts no number where others do is no explanation.
        let explanation = explanation.filter(|e| e.refit.chi2.is_finite())?;
        let penalty = (explanation.refit.residuals as f64).ln();
        let score = explanation.refit.chi2 + penalty * candidate.unknowns().len() as f64;
        Some(Trial {
            candidate,
            explanation,
            score,
        })
    }

    /// Values of the parameters that the last explanation has found.
    fn known(&self) -> BTreeMap<String, f64> {
        self.explanation.named.iter().cloned().collect()
    }

    /// The rules by which an effect may be named.
    fn is_earned(&self, trial: &Trial, evidence: &Evidence) -> bool {
        let lowered = self.explanation.refit.chi2 - trial.score;
        lowered > SIGNIFICANT && closed(&self.explanation, &trial.explanation, evidence) > CLOSED
    }

    fn finding(&self, trial: &Trial, rivals: &[Rival], evidence: &Evidence) -> Finding {
        let others = rivals
            .iter()
            .filter(|r| (&r.effect, &r.at) != (&trial.candidate.effect, &trial.candidate.at));
        Finding {
            effect: trial.candidate.effect.clone(),
            at: trial.candidate.at.clone(),
            form: trial.candidate.form.clone(),
            parameters: trial.parameters(),
            evidence: self.explanation.refit.chi2 - trial.explanation.refit.chi2,
            closed: closed(&self.explanation, &trial.explanation, evidence),
            rivals: others.cloned().collect(),
        }
    }

    /// Goes on with a candidate in the model.
    fn adopt(&mut self, candidate: Candidate, explanation: Explanation) {
        self.nuisance = explanation.refit.nuisance.clone();
        if let Some(workshop) = self
            .workshop
            .with(&candidate.effect, &candidate.at, candidate.form.as_deref())
        {
            self.workshop = workshop;
        }
        if let Change::Model { model, parameters } = &candidate.change {
            let value = |name: &str| {
                let place = model.about().parameters.iter().position(|p| p.name == name);
                place.map(|place| explanation.refit.values.as_slice()[place])
            };
            let given = parameters.iter().map(|p| Given {
                name: p.name.clone(),
                value: value(&p.name).unwrap_or(p.start),
                range: Some(p.range),
            });
            self.setting.given.extend(given);
        }
        self.explanation = explanation;
    }
}

impl Candidate {
    /// What is to be found.
    fn unknowns(&self) -> &[Added] {
        match &self.change {
            Change::Model { parameters, .. } => parameters,
            Change::Sensor { parameter, .. } => std::slice::from_ref(parameter),
        }
    }
}

impl Trial {
    fn rival(&self, behind: f64) -> Rival {
        Rival {
            effect: self.candidate.effect.clone(),
            at: self.candidate.at.clone(),
            behind,
        }
    }

    /// The effect's parameters with their standard errors.
    fn parameters(&self) -> Vec<(String, f64, f64)> {
        let refit = &self.explanation.refit;
        match &self.candidate.change {
            Change::Model { model, parameters } => {
                let errors = refit.stderr();
                let of = |added: &Added| {
                    let place = model.about().parameters.iter().position(|p| p.name == added.name)?;
                    let free = refit.free.iter().position(|free| free.parameter == place)?;
                    Some((added.effect_name.clone(), refit.estimate[free], errors[free]))
                };
                parameters.iter().filter_map(of).collect()
            }
            Change::Sensor { form, parameter, .. } => {
                let place = refit.nuisance.suspect.map_or(0, |(place, _)| place);
                let coefficient = refit.coefficients[place];
                let value = if *form == Form::Delay {
                    coefficient
                } else {
                    coefficient.exp()
                };
                vec![(parameter.effect_name.clone(), value, f64::NAN)]
            }
        }
    }
}
