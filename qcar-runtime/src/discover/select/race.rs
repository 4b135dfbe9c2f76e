//! Selects the best of many candidates by successive halving on the evidence (Jamieson and Talwalkar, AISTATS 2016).
//!
//! Each round roughly doubles the budget and halves the number of candidates. Besides the few best, a candidate stays
//! only if its last search gained at least the difference between its log evidence and the best.

use std::collections::{BTreeMap, HashSet};

use rayon::prelude::*;

use super::assembly::{Assembly, Hypothesis, Place};
use super::fidelity::Fidelity;
use super::screen::{Entrant, Screened};
use super::{BEAM, Progress, Update};
use crate::discover::candidate::Candidate;
use crate::discover::observe::Evidence;
use crate::discover::posterior::Refit;
use crate::least_squares::Stop;

/// One round of successive halving.
struct Round {
    evidence: fn(&Fidelity) -> &Evidence,
    /// Windows of records that are fitted before it, one after the other.
    before: fn(&Fidelity) -> &[Evidence],
    /// Number of searches, each followed by an update of the discrepancy, and evaluations of each search.
    budget: (usize, usize),
    /// Number of effects at their places that go on.
    kept: usize,
    /// Number of starts kept for each candidate.
    starts: usize,
}

/// Searches and evaluations of each in a fit to all fitted runs. A choice that limits the time.
pub const FINE_BUDGET: (usize, usize) = (2, 15);

/// The rounds. Their numbers are choices: each has about twice the work for each candidate and fewer candidates.
const ROUNDS: [Round; 4] = [
    Round {
        evidence: |all| &all.coarse,
        before: |_| &[],
        budget: (1, 3),
        kept: 8,
        starts: 2,
    },
    Round {
        evidence: |all| &all.coarse,
        before: |_| &[],
        budget: (2, 6),
        kept: 5,
        starts: 1,
    },
    Round {
        evidence: |all| &all.medium,
        before: |all| &all.longer[0],
        budget: (2, 8),
        kept: 3,
        starts: 1,
    },
    Round {
        evidence: |all| &all.fine,
        before: |all| &all.longer[1],
        budget: FINE_BUDGET,
        kept: 3,
        starts: 1,
    },
];

/// Log evidence difference up to which a candidate counts as no worse than the best, whatever its search gained: odds
/// of one to twenty thousand. A search that gained more than this before its limit of evaluations has not converged.
const NOT_SEPARATED: f64 = 10.0;
/// Number of candidates with the largest gain that enter, whatever their place and form. A choice.
const ENTRANTS: usize = 6;
/// Factor on the number of evaluations that are cheap: those of a linear model, and of records in windows. Without it,
/// a light mass on mounts would be dropped before the fit finds its mode.
const CHEAP_FACTOR: usize = 3;

/// A candidate after its fit to all fitted runs.
pub struct Finalist {
    /// Its position among the candidates.
    pub candidate: usize,
    pub refit: Refit,
}

/// A candidate that was dropped before the last round.
pub struct Dropped {
    /// Its position among the candidates.
    pub candidate: usize,
    /// Log evidence of the best minus its own, in its last round; at least 0.
    pub behind: f64,
}

/// One start of one candidate in the race.
struct Runner<'a> {
    candidate: usize,
    hypothesis: &'a Hypothesis<'a>,
    place: Place,
    refit: Option<Refit>,
}

impl<'a> Runner<'a> {
    /// A hypothesis outside a race.
    fn at(place: &Place, hypothesis: &'a Hypothesis<'a>) -> Self {
        Self {
            candidate: 0,
            hypothesis,
            place: place.clone(),
            refit: None,
        }
    }

    fn evidence(&self) -> f64 {
        self.refit
            .as_ref()
            .map_or(f64::NEG_INFINITY, |refit| refit.log_evidence)
    }

    fn gained(&self) -> f64 {
        self.refit.as_ref().map_or(0.0, |refit| refit.gained)
    }
}

/// Runs all rounds. Returns the finalists, best first, fitted to all fitted runs, and the dropped candidates, the
/// latest and best first.
pub fn race(
    assembly: &Assembly,
    candidates: &[Candidate],
    entering: &[Entrant],
    fidelity: &Fidelity,
    progress: Progress<'_>,
) -> (Vec<Finalist>, Vec<Dropped>) {
    let hypotheses: Vec<Option<Hypothesis<'_>>> = entering
        .iter()
        .map(|own| assembly.hypothesis_with(&candidates[own.candidate]))
        .collect();
    let runners = entering.iter().zip(&hypotheses).flat_map(|(own, hypothesis)| {
        let runner = |(hypothesis, place): (_, &Place)| Runner {
            candidate: own.candidate,
            hypothesis,
            place: place.clone(),
            refit: None,
        };
        let starts = hypothesis
            .iter()
            .flat_map(|hypothesis| own.starts.iter().map(move |place| (hypothesis, place)));
        starts.map(runner)
    });
    let mut field: Vec<Runner<'_>> = runners.collect();
    let mut dropped = Vec::new();
    for (number, round) in ROUNDS.iter().enumerate() {
        progress(Update::Done(number, ROUNDS.len()));
        let last = number + 1 == ROUNDS.len();
        let is_cut = fidelity.has_windows && !last;
        field = field
            .into_par_iter()
            .filter_map(|runner| advance(runner, fidelity, round, is_cut))
            .collect();
        let (stay, left) = best(field, candidates, round, number > 0);
        field = stay;
        if !last {
            dropped.splice(0..0, left);
        }
    }
    let finalists = converged(field, fidelity).into_iter().filter_map(|runner| {
        Some(Finalist {
            candidate: runner.candidate,
            refit: runner.refit?,
        })
    });
    (finalists.collect(), dropped)
}

/// Candidates for the first round: those with the largest gains, the best at each place, and the best of each form of
/// each effect. Only effects that gain at a place in some form enter. Rank alone does not decide, because the model's
/// parameters may have to change much before the right effect gains much: the screening shows that something is
/// missing, the fits show what. Nuisance effects enter at every place even without a gain: every real axle has them,
/// and another effect must not explain their part of the residual.
pub fn entrants<'p>(candidates: &[Candidate], screened: &'p [Screened]) -> Vec<&'p Screened> {
    let effect = |entry: &Screened| {
        let own = &candidates[entry.candidate];
        (own.effect.as_str(), own.at.as_str())
    };
    let gaining = screened.iter().filter(|entry| entry.gain > 0.0);
    let gaining: HashSet<_> = gaining.map(effect).collect();
    let (mut places, mut forms) = (HashSet::new(), HashSet::new());
    let enters = |(rank, entry): &(usize, &Screened)| {
        let own = &candidates[entry.candidate];
        let is_first_there = places.insert(own.at.as_str());
        let is_first_of_its_form = forms.insert((own.effect.as_str(), own.form.as_deref()));
        let is_chosen = *rank < ENTRANTS || is_first_there || is_first_of_its_form;
        own.nuisance || is_chosen && gaining.contains(&effect(entry))
    };
    let entering = screened.iter().enumerate().filter(enters);
    entering.map(|(_, entry)| entry).collect()
}

/// Repeats a fit that ended at its limit of evaluations as long as it is worth it; `None` if a fit fails.
pub fn continued(
    hypothesis: &Hypothesis<'_>,
    mut refit: Refit,
    evidence: &Evidence,
    is_worth_it: impl Fn(&Refit) -> bool,
) -> Option<Refit> {
    for _ in 0..MOST_REPETITIONS {
        if !may_gain_more(&refit) || !is_worth_it(&refit) {
            break;
        }
        refit = hypothesis.fit(&hypothesis.place(&refit), evidence, FINE_BUDGET).ok()?;
    }
    Some(refit)
}

/// Fits a hypothesis from a place to windows of the records, each time twice as long as before, and to all fitted runs.
/// `None` if an evidence is not finite.
pub fn through_windows(hypothesis: &Hypothesis<'_>, from: &Place, windows: &Fidelity) -> Option<Refit> {
    let [.., medium, fine] = &ROUNDS;
    let runner = advance(Runner::at(from, hypothesis), windows, medium, true)?;
    advance(runner, windows, fine, false)?.refit
}

/// True if a fit may still become as probable as this log evidence: it will hardly make up more in its next search than
/// it gained in the last one.
pub fn may_catch_up(refit: &Refit, with: f64) -> bool {
    with - refit.log_evidence <= refit.gained.max(NOT_SEPARATED)
}

/// Fits a runner to the data of a round; `is_cut` tells that the records are in windows.
fn advance<'a>(mut runner: Runner<'a>, fidelity: &Fidelity, round: &Round, is_cut: bool) -> Option<Runner<'a>> {
    let (rounds, evaluations) = round.budget;
    for windows in (round.before)(fidelity) {
        runner = run(runner, windows, (1, CHEAP_FACTOR * evaluations))?;
    }
    let times = if runner.hypothesis.model().about().linear || is_cut {
        CHEAP_FACTOR
    } else {
        1
    };
    run(runner, (round.evidence)(fidelity), (rounds, times * evaluations))
}

/// Fits a runner from where it is; `None` if its evidence is not finite.
fn run<'a>(mut runner: Runner<'a>, evidence: &Evidence, budget: (usize, usize)) -> Option<Runner<'a>> {
    let refit = runner.hypothesis.fit(&runner.place, evidence, budget).ok()?;
    if !refit.log_evidence.is_finite() {
        return None;
    }
    runner.place = runner.hypothesis.place(&refit);
    runner.refit = Some(refit);
    Some(runner)
}

/// Most repetitions of a fit that has not converged. A choice, which limits the time for hopeless candidates.
const MOST_REPETITIONS: usize = 4;

/// True if the last search of a fit ended at its limit of evaluations and was still gaining.
fn may_gain_more(refit: &Refit) -> bool {
    refit.stop == Stop::Evaluations && refit.gained > NOT_SEPARATED
}

/// Repeats the last round for finalists whose fit ended at its limit of evaluations, as long as another search may make
/// one of them the best. Returns them best first.
fn converged<'a>(mut field: Vec<Runner<'a>>, fidelity: &Fidelity) -> Vec<Runner<'a>> {
    let last = &ROUNDS[ROUNDS.len() - 1];
    for _ in 0..MOST_REPETITIONS {
        let first = field.first().map_or(0.0, Runner::evidence);
        let is_open = |runner: &Runner<'_>| {
            let may_gain = runner.refit.as_ref().is_some_and(may_gain_more);
            may_gain && first - runner.evidence() <= runner.gained()
        };
        if !field.iter().any(is_open) {
            break;
        }
        let again = |runner: Runner<'a>| match is_open(&runner) {
            true => run(runner, &fidelity.fine, last.budget),
            false => Some(runner),
        };
        field = field.into_par_iter().filter_map(again).collect();
        field.sort_by(|a, b| b.evidence().total_cmp(&a.evidence()));
    }
    field
}

/// The runners that go on, best first, and the dropped candidates. A nuisance effect goes on beside them, since it may
/// be needed for the right effect to become the best.
fn best<'a>(
    mut field: Vec<Runner<'a>>,
    candidates: &[Candidate],
    round: &Round,
    late: bool,
) -> (Vec<Runner<'a>>, Vec<Dropped>) {
    field.sort_by(|a, b| b.evidence().total_cmp(&a.evidence()));
    let first = field.first().map_or(0.0, Runner::evidence);
    let mut starts: BTreeMap<usize, usize> = BTreeMap::new();
    let mut names: Vec<(&str, &str)> = Vec::new();
    let mut places: Vec<&str> = Vec::new();
    let (mut stay, mut dropped) = (Vec::new(), Vec::new());
    for runner in field {
        let own = &candidates[runner.candidate];
        let name = (own.effect.as_str(), own.at.as_str());
        let known = names.contains(&name);
        let behind = first - runner.evidence();
        let improves = runner.refit.as_ref().is_some_and(|refit| may_catch_up(refit, first));
        let is_best_there = !late && !places.contains(&name.1);
        let is_of_beam = names.len() < BEAM;
        let wanted = own.nuisance
            || improves && (known || names.len() < round.kept)
            || is_best_there && names.len() < 2 * round.kept
            || !known && is_of_beam;
        let count = starts.entry(runner.candidate).or_default();
        if wanted && *count < round.starts {
            *count += 1;
            if !own.nuisance {
                places.push(name.1);
                if !known {
                    names.push(name);
                }
            }
            stay.push(runner);
        } else if *count == 0 {
            dropped.push(Dropped {
                candidate: runner.candidate,
                behind,
            });
        }
    }
    (stay, dropped)
}

#[cfg(test)]
mod tests {
    use super::{ENTRANTS, entrants};
    use crate::discover::candidate::{Added, Candidate, Change, ParameterRole};
    use crate::discover::noise::Form;
    use crate::discover::select::screen::Screened;

    fn candidate(effect: &str, at: &str) -> Candidate {
        let parameter = Added {
            name: String::new(),
            effect_name: String::new(),
            start: 0.0,
            range: (-1.0, 1.0),
            known: false,
            role: ParameterRole::Shape,
            scales_force: false,
        };
        Candidate {
            effect: effect.into(),
            at: at.into(),
            form: None,
            nuisance: false,
            change: Change::Sensor {
                location: at.into(),
                axis: None,
                form: Form::Delay,
                parameter,
            },
        }
    }

    /// The friction ranks below all that enter by their gain, and enters as the best of its form, `with_memory` even
    /// without a gain. The stop has no gain and stays out. The bending has none either, but it is a nuisance effect and
    /// enters at both places.
    #[test]
    fn each_form_each_place_and_each_nuisance_enters() {
        let law = |k: usize| (candidate(&format!("law {k}"), "damper"), 100.0 - k as f64);
        let [in_damper, with_memory] = ["in_damper", "with_memory"].map(|form| Candidate {
            form: Some(form.into()),
            ..candidate("friction", "damper")
        });
        let [bending, bending_again] = ["body", "damper"].map(|at| Candidate {
            nuisance: true,
            ..candidate("bending", at)
        });
        let later = [
            (candidate("friction", "damper"), 5.0),
            (candidate("law 0", "spring"), 4.0),
            (candidate("friction", "spring"), 3.0),
            (in_damper, 2.0),
            (with_memory, -1.0),
            (candidate("stop", "top_mount"), 0.0),
            (bending, 0.0),
            (bending_again, -1.0),
        ];
        let all = (0..ENTRANTS).map(law).chain(later);
        let (candidates, gains): (Vec<Candidate>, Vec<f64>) = all.unzip();
        let entry = |(candidate, gain)| Screened {
            candidate,
            gain,
            trials: Vec::new(),
        };
        let screened: Vec<Screened> = gains.into_iter().enumerate().map(entry).collect();
        let later = entrants(&candidates, &screened).into_iter().skip(ENTRANTS);
        let later: Vec<usize> = later.map(|own| own.candidate - ENTRANTS).collect();
        assert_eq!(later, [0, 1, 3, 4, 6, 7]);
    }
}
