//! Extends a set by one more effect.

use rayon::prelude::*;

use super::assembly::{Hypothesis, Place};
use super::base::BASE;
use super::fidelity::{DECIMATION, Fidelity};
use super::finite_explanation;
use super::race::{Dropped, Finalist, entrants, race};
use super::screen::{Entrant, Point, Screened, Screening, WITH_ALL_STARTS};
use super::set::{Set, above_noise, is_missing, keep_best};
use super::{Progress, Update};
use crate::discover::answer::Rival;
use crate::discover::candidate::Candidate;
use crate::discover::noise::AccuracyClass;
use crate::discover::observe::Evidence;
use crate::discover::posterior::Refit;

/// Fitted sets with one more effect. If the set explains the data well, or a learned law leads it, at least one
/// candidate must pass the screening: its gain must exceed the false-alarm threshold and the `lead` of the law. Empty
/// if none does.
pub fn extensions(set: &Set, lead: f64, evidence: &Evidence, progress: Progress<'_>) -> Vec<Set> {
    let candidates = set.assembly.candidates();
    progress(Update::Step(&format!(
        "screening {} effects at their places",
        candidates.len()
    )));
    // One more effect hardly changes the non-steady part of a sweep response, so it is subtracted once.
    let steady = evidence.minus(&set.explanation.refit.unsteady).with_step_limit();
    let mut sets = extended(
        set,
        &candidates,
        &SearchStart::of(set, &steady),
        lead,
        evidence,
        progress,
    );
    for (step, start) in FAR_OFF {
        let is_open = is_missing(set, evidence) && sets.iter().all(|own| !explains_fitted(set, own, evidence));
        if let Some(start) = is_open.then(|| start(set, &steady)).flatten() {
            progress(Update::Step(step));
            for own in extended(set, &candidates, &start, lead, evidence, progress) {
                keep_best(own, &mut sets);
            }
        }
    }
    sets
}

/// Makes a start of a search from a set; `None` if there is none of this kind.
type MakeStart = fn(&Set, &Evidence) -> Option<SearchStart>;

/// Further starts of the search from a set that leaves a large residual, as long as no extension explains nearly all of
/// it.
const FAR_OFF: [(&str, MakeStart); 2] = [
    ("screening in short windows of the records", SearchStart::in_windows),
    ("screening from the least-squares fit", SearchStart::by_least_squares),
];

/// True if `after` explains nearly all of the excess residual that `before` leaves in the fitted runs.
pub fn explains_fitted(before: &Set, after: &Set, evidence: &Evidence) -> bool {
    let [before, after] = [before, after].map(|set| above_noise(set.explanation.misfit.fit));
    after <= evidence.numbers.error_probability * before
}

/// Data of a search that starts from a set, and the fit of the set to the coarse part.
pub struct SearchStart {
    pub fidelity: Fidelity,
    pub refit: Refit,
    /// True if the fit is one by least squares. Some candidates of a set with effects then start from the given values
    /// too: without the right candidate, the fit may have moved the parameters so far that no fit from there finds it.
    is_by_least_squares: bool,
}

impl SearchStart {
    /// For a set that is nearly right. A missing effect makes the sensors seem less accurate than they are, so a search
    /// starts with sensors as accurate as their data sheets.
    pub fn of(set: &Set, steady: &Evidence) -> Self {
        let fidelity = Fidelity::of(steady);
        let own = &set.explanation.refit;
        let calibrated = || {
            let hypothesis = set.assembly.hypothesis();
            let from = hypothesis.place(own);
            hypothesis.fit_with_calibrated_sensors(from, &fidelity.coarse, BASE[0])
        };
        let is_calibrated = own.nuisance.accuracy == AccuracyClass::default();
        let refit = if is_calibrated { None } else { calibrated().ok() };
        Self {
            refit: refit.unwrap_or_else(|| own.clone()),
            fidelity,
            is_by_least_squares: false,
        }
    }

    /// For a set that leaves a large residual: the phase errors that add up over whole records then hide what is
    /// missing. `None` without records that can be cut into windows.
    pub fn in_windows(set: &Set, steady: &Evidence) -> Option<Self> {
        let fidelity = Fidelity::in_windows(steady)?;
        let hypothesis = set.assembly.hypothesis();
        let from = hypothesis.place(&set.explanation.refit);
        let refit = hypothesis.fit(&from, &fidelity.coarse, BASE[0]).ok()?;
        Some(Self {
            fidelity,
            refit,
            is_by_least_squares: false,
        })
    }

    /// For a set that leaves a large residual: where an effect is missing, a discrepancy makes a large smooth residual
    /// more probable than a small one with sharp features, so the parameters may be far off, even though those of least
    /// squares are not (Tuo and Wu, Annals of Statistics 43, 2015). `None` if the fit fails.
    pub fn by_least_squares(set: &Set, steady: &Evidence) -> Option<Self> {
        let fidelity = Fidelity::of(steady);
        let hypothesis = set.assembly.hypothesis();
        let from = hypothesis.place(&set.explanation.refit);
        let refit = hypothesis.fit_by_least_squares(from, &fidelity.coarse, BASE[0]).ok()?;
        Some(Self {
            fidelity,
            refit,
            is_by_least_squares: true,
        })
    }
}

/// Adds starts from the given values of the model, with the fitted values of the effects of the set; sensor errors start
/// at zero. Every candidate of a base model has such a start. So have the first candidates of a set with effects, if the
/// search is from its least-squares fit.
fn add_starts_from_given(set: &Set, start: &SearchStart, candidates: &[Candidate], entering: &mut [Entrant]) {
    let fitted = set.assembly.hypothesis().place(&start.refit).named;
    let of_effects = set.named().flat_map(|own| own.unknowns.parameter_names());
    let named = of_effects.filter_map(|name| Some((name.to_owned(), *fitted.get(name)?)));
    let given = Place {
        named: named.collect(),
        ..Place::given(&start.fidelity.coarse)
    };
    let hypothesis = |entrant: &Entrant| set.assembly.hypothesis_with(&candidates[entrant.candidate]);
    let place = |entrant: &Entrant, hypothesis: &Hypothesis<'_>| {
        let candidate = &candidates[entrant.candidate];
        Point::at_start(candidate).at(&given, hypothesis, candidate)
    };
    if set.names().is_empty() {
        for entrant in entering {
            let place = hypothesis(entrant).map(|hypothesis| place(entrant, &hypothesis));
            entrant.starts.extend(place);
        }
    } else if start.is_by_least_squares {
        entering.par_iter_mut().take(WITH_ALL_STARTS).for_each(|entrant| {
            // Without this fit the first rounds of the race would drop a start so far from its optimum, beside those of
            // a model that is already fitted with other effects.
            let fitted = hypothesis(entrant).and_then(|hypothesis| {
                let from = place(entrant, &hypothesis);
                let refit = hypothesis.fit_by_least_squares(from, &start.fidelity.coarse, BASE[0]);
                Some(hypothesis.place(&refit.ok()?))
            });
            entrant.starts.extend(fitted);
        });
    }
}

fn extended(
    set: &Set,
    candidates: &[Candidate],
    start: &SearchStart,
    lead: f64,
    evidence: &Evidence,
    progress: Progress<'_>,
) -> Vec<Set> {
    let SearchStart { fidelity, refit, .. } = start;
    let screening = Screening::new(&set.assembly, refit, &fidelity.coarse);
    let screened = screening.of(candidates);
    // A model with a large residual has poor parameters, which makes a first-order gain unreliable. So the candidates
    // are fitted whatever their gain, unless a learned law explains that residual.
    let is_far_off = lead == 0.0 && is_missing(set, evidence);
    let least = (candidates.len() as f64 / evidence.numbers.false_alarms).ln();
    // The screening uses every sixth line of the sweeps only, while the lead counts all lines.
    let least = least.max(lead / DECIMATION[0] as f64);
    let is_worth_fitting = |own: &Screened| own.gain > least;
    if !is_far_off && !screened.iter().any(is_worth_fitting) {
        return Vec::new();
    }
    let mut entering = screening.with_starts(&entrants(candidates, &screened), candidates);
    if is_far_off {
        add_starts_from_given(set, start, candidates, &mut entering);
    }
    let (finalists, dropped) = race(&set.assembly, candidates, &entering, fidelity, progress);
    let of_finalist = |finalist: Finalist| {
        let candidate = &candidates[finalist.candidate];
        let hypothesis = set.assembly.hypothesis_with(candidate)?;
        let explanation = finite_explanation(&hypothesis, finalist.refit, evidence)?;
        // A nuisance effect has no prior odds against it, since every real car has some of it.
        let prior = if candidate.nuisance {
            set.log_prior
        } else {
            set.log_prior + log_prior(candidate, candidates) + set.odds_of_another(&evidence.numbers).ln()
        };
        Some(Set::new(set.assembly.with(candidate)?, explanation, prior))
    };
    let mut sets: Vec<Set> = finalists.into_par_iter().filter_map(of_finalist).collect();
    let rivals = rivals(candidates, &dropped);
    for own in &mut sets {
        own.rivals.clone_from(&rivals);
    }
    sets
}

/// Number of dropped candidates in the report.
const RIVALS: usize = 3;

/// The best dropped candidates. Each effect and place appears once: forms of one effect are not rivals of each other.
fn rivals(candidates: &[Candidate], dropped: &[Dropped]) -> Vec<Rival> {
    let mut rivals: Vec<Rival> = Vec::new();
    for left in dropped {
        let own = rival(&candidates[left.candidate], left.behind);
        let is_it = |known: &Rival| (&known.effect, &known.at) == (&own.effect, &own.at);
        let is_answer = !candidates[left.candidate].nuisance && !rivals.iter().any(is_it);
        if rivals.len() < RIVALS && is_answer {
            rivals.push(own);
        }
    }
    rivals
}

fn rival(candidate: &Candidate, behind: f64) -> Rival {
    Rival {
        effect: candidate.effect.clone(),
        at: candidate.at.clone(),
        behind,
    }
}

/// Log prior odds of a candidate: even odds that something is missing, shared equally among effects, and within an
/// effect among its places and forms.
pub fn log_prior(candidate: &Candidate, all: &[Candidate]) -> f64 {
    let of_effect = all.iter().filter(|other| other.effect == candidate.effect).count();
    let mut effects: Vec<&str> = all.iter().map(|other| other.effect.as_str()).collect();
    effects.sort_unstable();
    effects.dedup();
    -((effects.len() * of_effect) as f64).ln()
}
