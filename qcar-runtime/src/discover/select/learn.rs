//! Learns a law that the catalogue lacks: fits free curves at every place like effects. The evidence penalises each
//! coefficient of a curve.

use rayon::prelude::*;

use super::assembly::Placed;
use super::extend::{SearchStart, explains_fitted};
use super::held_out::predicts_better;
use super::race::{Finalist, race};
use super::reduce::Reduction;
use super::screen::Entrant;
use super::set::{Set, by_log_posterior, explained_share, is_missing, stated_share};
use super::{Progress, Update, finite_explanation};
use crate::discover::answer::{Finding, Learned};
use crate::discover::candidate::Candidate;
use crate::discover::observe::Evidence;

/// Most laws that are learned together, for example one in travel and one in speed.
const MOST_LAWS: usize = 2;

/// The set with the laws that the evidence supports beside `base`, starting with the `first`; `None` if it supports
/// none. `plain` is the base model without nuisance effects. The laws must predict the held-out runs better than
/// `base`, or explain most of the excess residual there if `base` is far off.
pub fn learn(base: &Set, first: Option<Set>, plain: &Set, evidence: &Evidence, progress: Progress<'_>) -> Option<Set> {
    let mut best: Option<Set> = None;
    let mut next = first;
    while let Some(more) = next.take() {
        let from = best.as_ref().unwrap_or(base);
        if more.log_posterior() <= from.log_posterior() {
            break;
        }
        let laws = more.assembly.effects().len() - base.assembly.effects().len();
        let enough = explained_share(base, &more, evidence) >= evidence.numbers.explained();
        if laws < MOST_LAWS && !enough {
            next = with_law(&more, evidence, progress);
        }
        best = Some(more);
    }
    let best = best.map(|laws| without_needless_law(laws, base, plain, evidence));
    // The held-out score neglects the parameter uncertainty of the law, so it is too strict outside the range of the
    // fitted runs. If an effect is missing, a law that explains most of the excess residual is still useful.
    let explains_most =
        |best: &Set| stated_share(base, best, evidence).is_some_and(|share| share >= evidence.numbers.explained());
    best.filter(|best| is_supported(best, base, evidence) || is_missing(base, evidence) && explains_most(best))
}

/// The set without a law that a later one has made unnecessary; the set itself if there is none.
fn without_needless_law(laws: Set, base: &Set, plain: &Set, evidence: &Evidence) -> Set {
    let learned = base.assembly.effects().len()..laws.assembly.effects().len();
    if learned.len() < 2 {
        return laws;
    }
    let reduction = Reduction::of(&laws, plain, evidence);
    let less = learned.into_par_iter().filter_map(|place| reduction.without(place));
    let best = less.max_by(by_log_posterior);
    match best {
        Some(less) if less.log_posterior() > laws.log_posterior() => less,
        _ => laws,
    }
}

/// True if the evidence supports the learned laws and they predict the held-out runs better than `base`. If `base` leaves
/// no more than noise there, the laws must explain the fitted runs instead.
pub fn is_supported(learned: &Set, base: &Set, evidence: &Evidence) -> bool {
    let is_more_probable = learned.log_posterior() > base.log_posterior();
    let explains = match stated_share(base, learned, evidence) {
        Some(share) => share > 0.0,
        None => explains_fitted(base, learned, evidence),
    };
    is_more_probable && explains && predicts_better(learned, base, evidence)
}

/// The set with the most probable law at its most probable place; `None` if no law can be fitted.
pub fn with_law(set: &Set, evidence: &Evidence, progress: Progress<'_>) -> Option<Set> {
    let laws = set.assembly.laws();
    progress(Update::Step(&format!("learning a law at {} places", laws.len())));
    let steady = evidence.minus(&set.explanation.refit.unsteady).with_step_limit();
    let law = most_probable_law(set, &laws, &SearchStart::of(set, &steady), evidence, progress);
    if !is_missing(set, evidence) || law.as_ref().is_some_and(|law| explains_fitted(set, law, evidence)) {
        return law;
    }
    let in_windows = SearchStart::in_windows(set, &steady)
        .and_then(|start| most_probable_law(set, &laws, &start, evidence, progress));
    let both = law.into_iter().chain(in_windows);
    both.max_by(by_log_posterior)
}

/// The set with the most probable one of some laws; `None` if none can be fitted.
pub fn most_probable_law(
    set: &Set,
    laws: &[Candidate],
    start: &SearchStart,
    evidence: &Evidence,
    progress: Progress<'_>,
) -> Option<Set> {
    let here = set.assembly.hypothesis().place(&start.refit);
    // At its start values a law changes the model little, so a screening could not rank the laws.
    let unchanged = |candidate: usize| Entrant {
        candidate,
        starts: vec![here.clone()],
    };
    let entering: Vec<Entrant> = (0..laws.len()).map(unchanged).collect();
    let (finalists, _) = race(&set.assembly, laws, &entering, &start.fidelity, progress);
    let prior = set.log_prior - (laws.len() as f64).ln() + set.odds_of_another(&evidence.numbers).ln();
    let fitted = finalists.into_par_iter().filter_map(|Finalist { candidate, refit }| {
        let candidate = &laws[candidate];
        let hypothesis = set.assembly.hypothesis_with(candidate)?;
        let explanation = finite_explanation(&hypothesis, refit, evidence)?;
        Some(Set::new(set.assembly.with(candidate)?, explanation, prior))
    });
    fitted.max_by(by_log_posterior)
}

/// The learned laws for the report.
pub fn summary(base: &Set, learned: Set, evidence: &Evidence) -> Learned {
    let explained = stated_share(base, &learned, evidence);
    let laws = learned.assembly.effects().iter();
    let law = |own: &Placed| Finding {
        effect: own.effect.clone(),
        at: own.at.clone(),
        form: own.form.clone(),
        alternative: None,
        parameters: own.unknowns.parameters(&learned.explanation),
        evidence: learned.explanation.refit.log_evidence - base.explanation.refit.log_evidence,
        explained,
        rivals: Vec::new(),
    };
    Learned {
        laws: laws.skip(base.assembly.effects().len()).map(law).collect(),
        explained,
        longest: evidence.longest(),
        explanation: learned.explanation,
    }
}
