//! A model with the effects that were taken so far, and what is tried on it.

// What it is looked at with.
mod looks;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::contest::{Entrant, Finalist, contest};
use super::rules::Wanted;
use super::taken::Taken;
use super::{Finding, News, Progress, Rival};
use crate::discover::candidate::{Candidate, Change, Workshop};
use crate::discover::evidence::Evidence;
use crate::discover::explain::{Explanandum, Explanation, Given, Setting};
use crate::discover::nuisance::{Form, Nuisance};
use crate::discover::predict::PredictError;

/// How wrong a sensor under suspicion may be: a factor of e, and 20 ms.
const SUSPECT: [f64; 2] = [1.0, 0.02];
/// Evaluations of a fit from where another model ended,
const TO_FOLLOW: usize = 25;
/// and the share of the sum of squares from which on its end is another place.
const WORTH: f64 = 1e-3;
/// What is known so far.
#[derive(Clone)]
pub struct State {
    workshop: Arc<dyn Workshop>,
    setting: Setting,
    nuisance: Nuisance,
    /// What was taken.
    taken: Vec<Taken>,
    /// How well it explains the evidence.
    pub explanation: Explanation,
}

/// What came of all candidates.
pub struct Field {
    /// Those that were fitted to the end, the very best first.
    pub contenders: Vec<Contender>,
    /// The others, those that came far first.
    pub dropped: Vec<Behind>,
}

/// A candidate that is not the best.
pub struct Behind {
    /// As it is told of.
    pub rival: Rival,
    /// Whether it is a sensor.
    pub is_sensor: bool,
}

impl Behind {
    /// By so much; `early` where it was left behind before the end.
    pub fn new(candidate: &Candidate, behind: f64, early: bool) -> Self {
        Behind {
            rival: Rival {
                effect: candidate.effect.clone(),
                at: candidate.at.clone(),
                behind,
                early,
            },
            is_sensor: candidate.is_sensor(),
        }
    }
}

/// A candidate that did well, and how well it explains.
pub struct Contender {
    /// What it is.
    pub candidate: Candidate,
    /// How well it explains.
    pub explanation: Explanation,
    /// Sum of squares with the penalty of its unknowns.
    pub score: f64,
    /// What the evidence says of its parameters.
    pub parameters: Vec<(String, f64, f64)>,
    taken: Taken,
    nuisance: Nuisance,
}

impl Contender {
    /// Number of its unknowns.
    pub fn unknowns(&self) -> usize {
        self.candidate.unknowns()
    }

    /// True where all it says of its unknowns lies in their ranges: a fit may be free to leave that of a sensor.
    fn is_plausible(&self) -> bool {
        let ranges = self.candidate.parameters().iter();
        let mut values = ranges.zip(&self.parameters).filter(|(own, _)| !own.known);
        values.all(|(unknown, (_, value, _))| (unknown.range.0..=unknown.range.1).contains(value))
    }
}

impl State {
    /// The base model, refitted.
    ///
    /// # Errors
    /// Where it lacks what was measured, or a parameter has no value.
    pub fn base(
        workshop: Box<dyn Workshop>,
        setting: &Setting,
        evidence: &Evidence,
        progress: Progress<'_>,
    ) -> Result<Self, PredictError> {
        setting.check(workshop.model().about())?;
        let workshop: Arc<dyn Workshop> = Arc::from(workshop);
        let nuisance = Nuisance::of(evidence);
        let explanandum = Explanandum {
            model: workshop.model(),
            added: &[],
            setting,
            known: None,
            nuisance: nuisance.clone(),
        };
        let explanation = alone(explanandum, evidence, progress)?;
        Ok(State {
            workshop,
            setting: setting.clone(),
            nuisance,
            taken: Vec::new(),
            explanation,
        })
    }

    /// The best of all candidates that are wanted, the very best first.
    ///
    /// # Errors
    /// Where a parameter has no value.
    pub fn contenders(
        &self,
        wanted: &Wanted,
        evidence: &Evidence,
        progress: Progress<'_>,
    ) -> Result<Field, PredictError> {
        let mut candidates = self.workshop.candidates();
        candidates.retain(|candidate| candidate.is_sensor() || !wanted.sensor);
        let what = format!("trying {} effects at their places", candidates.len());
        progress(News::Doing(&what));
        let known = self.known();
        let mut entrants = vec![Entrant {
            explanandum: self.unchanged(Some(&known)),
            unknowns: 0,
            name: "no change".into(),
        }];
        let mut entered = vec![candidates.len()];
        for (place, candidate) in candidates.iter().enumerate() {
            if let Some(explanandum) = self.explanandum(candidate, &known) {
                entrants.push(Entrant {
                    explanandum,
                    unknowns: candidate.unknowns(),
                    name: format!("{} at {}", candidate.effect, candidate.at),
                });
                entered.push(place);
            }
        }
        let (finalists, dropped) = contest(&entrants, &self.looks(wanted, evidence), progress)?;
        let nuisance = |finalist: &Finalist| entrants[finalist.entrant].explanandum.nuisance.clone();
        let finalists: Vec<_> = finalists
            .into_iter()
            .map(|f| (entered[f.entrant], nuisance(&f), f))
            .collect();
        drop(entrants);
        let dropped = dropped
            .iter()
            .filter_map(|of| Some((candidates.get(entered[of.entrant])?, of.behind)));
        let dropped = dropped
            .map(|(candidate, behind)| Behind::new(candidate, behind, true))
            .collect();
        let mut candidates: Vec<Option<Candidate>> = candidates.into_iter().map(Some).collect();
        let mut contenders = Vec::new();
        // The best form stands for the effect.
        let mut met = BTreeSet::new();
        for (place, nuisance, finalist) in finalists {
            let Some(candidate) = candidates.get_mut(place).and_then(Option::take) else {
                continue;
            };
            let contender = Contender::new(candidate, nuisance, finalist);
            let effect = (contender.candidate.effect.clone(), contender.candidate.at.clone());
            if contender.is_plausible() && met.insert(effect) {
                contenders.push(contender);
            }
        }
        Ok(Field { contenders, dropped })
    }

    /// A candidate with what is known; `None` for a sensor that the evidence does not have.
    fn explanandum<'a>(
        &'a self,
        candidate: &'a Candidate,
        known: &'a BTreeMap<String, f64>,
    ) -> Option<Explanandum<'a>> {
        let (model, added, nuisance) = match &candidate.change {
            Change::Model { model, parameters } => (&**model, parameters.as_slice(), self.nuisance.clone()),
            Change::Sensor { .. } => (self.workshop.model(), &[][..], suspecting(&self.nuisance, candidate)?),
        };
        Some(Explanandum {
            model,
            added,
            setting: &self.setting,
            known: Some(known),
            nuisance,
        })
    }

    /// The present model itself.
    fn unchanged<'a>(&'a self, known: Option<&'a BTreeMap<String, f64>>) -> Explanandum<'a> {
        Explanandum {
            model: self.workshop.model(),
            added: &[],
            setting: &self.setting,
            known,
            nuisance: self.nuisance.clone(),
        }
    }

    /// Values of the parameters that the explanation has found.
    fn known(&self) -> BTreeMap<String, f64> {
        self.explanation.named.iter().cloned().collect()
    }

    /// Sum of squares with the penalty of all that was taken.
    pub fn score(&self) -> f64 {
        let unknowns: usize = self.taken.iter().map(|taken| taken.unknowns.len()).sum();
        self.explanation.refit.chi2 + self.penalty(unknowns)
    }

    /// The penalty of so many unknowns.
    pub fn penalty(&self, unknowns: usize) -> f64 {
        (self.explanation.refit.residuals as f64).ln() * unknowns as f64
    }

    /// All effects at all their places.
    pub fn candidates(&self) -> Vec<Candidate> {
        self.workshop.candidates()
    }

    /// The residuals of the explanation and their Jacobian along all that was fitted.
    pub fn linearised(&self, evidence: &Evidence) -> (DVector<f64>, DMatrix<f64>) {
        self.explanation.refit.linearised(self.workshop.model(), evidence)
    }

    /// The residuals of the data with an effect at its start beside the explanation; `None` where that gives no number.
    pub fn residuals_with(&self, candidate: &Candidate, evidence: &Evidence) -> Option<DVector<f64>> {
        let known = self.known();
        let explanandum = self.explanandum(candidate, &known)?;
        let beside_known = explanandum.starts().ok()?.into_iter().nth(1)?;
        let refit = &self.explanation.refit;
        refit.residuals_of(
            explanandum.model,
            &beside_known,
            (refit.nuisance.clone(), &refit.coefficients),
            self.workshop.model(),
            evidence,
        )
    }

    /// By how much a contender lowers the sum of squares, beside the penalty of its unknowns.
    pub fn lowered(&self, contender: &Contender) -> f64 {
        self.explanation.refit.chi2 - contender.score
    }

    /// With a contender in the model.
    pub fn with(&self, contender: &Contender) -> Self {
        let mut state = self.assuming(&contender.candidate, &contender.taken, &contender.nuisance);
        state.explanation = contender.explanation.clone();
        state
    }

    fn assuming(&self, candidate: &Candidate, taken: &Taken, nuisance: &Nuisance) -> Self {
        let mut state = self.clone();
        state.nuisance = nuisance.clone();
        if let Some(workshop) = self
            .workshop
            .with(&candidate.effect, &candidate.at, candidate.form.as_deref())
        {
            state.workshop = Arc::from(workshop);
        }
        if let Change::Model { parameters, .. } = &candidate.change {
            let unknown = parameters.iter().filter(|p| !p.known);
            state.setting.given.extend(unknown.map(|p| Given {
                name: p.name.clone(),
                value: p.start,
                range: Some(p.range),
            }));
        }
        state.taken.push(taken.clone());
        state
    }

    /// The same model refitted from where a contender ended, if that is a better place: what an effect gains by leading a
    /// search there is not its own. Where the model without the effect gives no number there, it stays.
    pub fn led_by(&self, contender: Option<&Contender>, evidence: &Evidence) -> Self {
        let known = self.known();
        let explanandum = self.unchanged(Some(&known));
        let present = &self.explanation.refit;
        let steady = evidence.less(&present.unsteady);
        let led = contender
            .and_then(|own| explanandum.refit_from(&own.explanation, &steady, TO_FOLLOW).ok())
            .filter(|refit| refit.chi2 < (1.0 - WORTH) * present.chi2)
            .and_then(|refit| explanandum.explanation(refit, evidence).ok())
            .filter(|led| led.refit.chi2 < present.chi2);
        let mut state = self.clone();
        state.explanation = led.unwrap_or(state.explanation);
        state
    }

    /// With all of these effects in the model, refitted from `known` values and those of the campaign; `None` where they do
    /// not go together.
    ///
    /// # Errors
    /// Where a parameter has no value.
    pub fn with_all(
        &self,
        findings: &[Finding],
        known: Option<&State>,
        evidence: &Evidence,
        progress: Progress<'_>,
    ) -> Result<Option<Self>, PredictError> {
        let mut state = self.clone();
        for finding in findings {
            let candidates = state.workshop.candidates();
            let wanted = |c: &&Candidate| c.effect == finding.effect && c.at == finding.at && c.form == finding.form;
            let Some(candidate) = candidates.iter().find(wanted) else {
                return Ok(None);
            };
            let sensor = suspecting(&state.nuisance, candidate);
            let nuisance = sensor.unwrap_or_else(|| state.nuisance.clone());
            let taken = Taken::new(candidate, &nuisance);
            state = state.assuming(candidate, &taken, &nuisance);
        }
        let values = known.map(State::known);
        let explanandum = state.unchanged(values.as_ref());
        state.explanation = alone(explanandum, evidence, progress)?;
        Ok(Some(state))
    }

    /// Gives findings the values that the present explanation has for them.
    pub fn update(&self, findings: &mut [Finding]) {
        for finding in findings {
            let taken = self
                .taken
                .iter()
                .find(|t| t.effect == finding.effect && t.at == finding.at);
            if let Some(taken) = taken {
                finding.parameters = taken.parameters(&self.explanation);
            }
        }
    }
}

/// The best fit of one model.
fn alone(explanandum: Explanandum, evidence: &Evidence, progress: Progress<'_>) -> Result<Explanation, PredictError> {
    // What cannot be predicted at all is an error here, where among many it only drops out.
    let start = explanandum.starts()?.swap_remove(0);
    explanandum.refit(&start, None, evidence, 1)?;
    let entrant = Entrant {
        explanandum,
        unknowns: 0,
        name: "the model alone".into(),
    };
    let best = contest(&[entrant], &looks::of_one(evidence), progress)?
        .0
        .into_iter()
        .next();
    best.map(|finalist| finalist.explanation).ok_or(PredictError::NoNumber)
}

/// With the sensor of a candidate under suspicion; `None` where it is none, or not in the evidence.
fn suspecting(nuisance: &Nuisance, candidate: &Candidate) -> Option<Nuisance> {
    let Change::Sensor {
        location, axis, form, ..
    } = &candidate.change
    else {
        return None;
    };
    let sigma = SUSPECT[usize::from(*form == Form::Delay)];
    nuisance.clone().suspecting(location, *axis, *form, sigma)
}

impl Contender {
    fn new(candidate: Candidate, nuisance: Nuisance, finalist: Finalist) -> Self {
        let taken = Taken::new(&candidate, &nuisance);
        let explanation = finalist.explanation;
        Contender {
            candidate,
            score: finalist.score,
            parameters: taken.parameters(&explanation),
            explanation,
            taken,
            nuisance,
        }
    }
}

#[cfg(test)]
pub(super) mod made;
#[cfg(test)]
mod tests;
