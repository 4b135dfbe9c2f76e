//! A law where the catalogue has none: free curves, held against the data at every place like the effects of the
//! catalogue, and paying for each of their coefficients.

use rayon::prelude::*;

use super::assembly::Placed;
use super::judging::predicts;
use super::race::{Finalist, race};
use super::screen::Prospect;
use super::set::{Set, closed, is_missing};
use super::{News, Progress, explained, fidelity};
use crate::discover::answer::{Finding, Learned};
use crate::discover::observe::Evidence;

/// Laws that act at once: one of the travel and one of the speed, say.
const MOST_LAWS: usize = 2;

/// The laws that the evidence wants beside a set, of which the `first` is known; `None` where it wants none. They must predict
/// the runs that judge, or close most of the gap there where the set is far off.
pub fn learn(base: &Set, first: Option<Set>, evidence: &Evidence, progress: Progress<'_>) -> Option<Set> {
    let mut best: Option<Set> = None;
    let mut next = first;
    while let Some(more) = next.take() {
        let from = best.as_ref().unwrap_or(base);
        if more.log_posterior() <= from.log_posterior() {
            break;
        }
        let laws = more.assembly.effects().len() - base.assembly.effects().len();
        let enough = closed(&base.explanation, &more.explanation, evidence) >= evidence.numbers.explained();
        if laws < MOST_LAWS && !enough {
            next = with_law(&more, evidence, progress);
        }
        best = Some(more);
    }
    // The score leaves out the uncertainty of the law's parameters, so a law is overconfident on runs beyond the range of the
    // fitted ones. Where the model alone is far off, a law that closes most of the gap there still says what is missing.
    let closes_most =
        |best: &Set| closed(&base.explanation, &best.explanation, evidence) >= evidence.numbers.explained();
    best.filter(|best| holds(best, base, evidence) || is_missing(base, evidence) && closes_most(best))
}

/// True where the evidence wants laws, and they predict the runs that judge.
pub fn holds(learned: &Set, base: &Set, evidence: &Evidence) -> bool {
    let is_wanted = learned.log_posterior() > base.log_posterior();
    let closes = closed(&base.explanation, &learned.explanation, evidence) > 0.0;
    is_wanted && closes && predicts(learned, base, evidence)
}

/// The most probable law at the most probable place beside a set.
pub fn with_law(set: &Set, evidence: &Evidence, progress: Progress<'_>) -> Option<Set> {
    let laws = set.assembly.laws();
    progress(News::Doing(&format!("learning a law at {} places", laws.len())));
    let refit = &set.explanation.refit;
    let here = set.assembly.hypothesis().place(refit);
    // At its start no law changes much: nothing is known yet that one of them could be dropped by.
    let start = |candidate: usize| Prospect {
        candidate,
        starts: vec![(here.clone(), 0.0)],
        afresh: None,
    };
    let all: Vec<Prospect> = (0..laws.len()).map(start).collect();
    let steady = evidence.less(&refit.unsteady).hurried();
    let (finalists, _) = race(
        &set.assembly,
        &laws,
        &all.iter().collect::<Vec<_>>(),
        &fidelity(&steady),
        progress,
    );
    let prior = set.log_prior - (laws.len() as f64).ln() + set.odds_of_another(&evidence.numbers).ln();
    let fitted = finalists.into_par_iter().filter_map(|Finalist { candidate, refit }| {
        let candidate = &laws[candidate];
        let hypothesis = set.assembly.hypothesis_with(candidate)?;
        let explanation = explained(&hypothesis, refit, evidence)?;
        Some(Set::new(set.assembly.with(candidate)?, explanation, prior))
    });
    fitted.max_by(|a, b| a.log_posterior().total_cmp(&b.log_posterior()))
}

/// What is told of the laws that were learned.
pub fn told(base: &Set, learned: Set, evidence: &Evidence) -> Learned {
    let explained = closed(&base.explanation, &learned.explanation, evidence);
    let laws = learned.assembly.effects().iter();
    let law = |own: &Placed| Finding {
        effect: own.effect.clone(),
        at: own.at.clone(),
        form: own.form.clone(),
        parameters: own.unknowns.parameters(&learned.explanation),
        evidence: learned.explanation.refit.log_evidence - base.explanation.refit.log_evidence,
        closed: explained,
        rivals: Vec::new(),
    };
    Learned {
        laws: laws.skip(base.assembly.effects().len()).map(law).collect(),
        explained,
        longest: evidence.longest(),
        explanation: learned.explanation,
    }
}
